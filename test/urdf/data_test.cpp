// SPDX-License-Identifier: BSD-3-Clause
// Real robots, from the folder that FCL_ARTIC_DATA names.
#include <fcl/geometry/bvh/BVH_model.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {
namespace data_test {
namespace {

struct Expected {
  const char* robot;
  int variables, mimics, meshes, boxes, triangles;
  int disabled_pairs;  ///< in its SRDF; -1: it has none
};

std::ostream& operator<<(std::ostream& out, const Expected& expected) {
  return out << expected.robot;
}

class RealRobot : public testing::TestWithParam<Expected> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("FCL_ARTIC_DATA");
    const std::string robot = GetParam().robot;
    if (data) base_ = std::filesystem::path(data) / "robots" / robot / robot;
    if (!data || !std::filesystem::exists(base_.string() + ".urdf")) {
      GTEST_SKIP() << "RealRobot." << robot << ": FCL_ARTIC_DATA does not name a folder with this robot";
    }
  }
  std::filesystem::path base_;
};

TEST_P(RealRobot, LoadsWithItsJointsAndTriangles) {
  const Robot robot = loadUrdf(base_.string() + ".urdf");
  EXPECT_EQ(robot.tree->dof(), GetParam().variables);
  int mimics = 0;
  for (JointId j = 0; j < robot.tree->numJoints(); ++j) mimics += robot.tree->joint(j).mimics;
  EXPECT_EQ(mimics, GetParam().mimics);
  int meshes = 0, boxes = 0, triangles = 0;
  for (const LinkGeometry& g : robot.geometry) {
    const auto* mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(g.object->collisionGeometry().get());
    meshes += mesh != nullptr;
    boxes += g.source == "box";
    if (mesh) triangles += mesh->num_tris;
  }
  EXPECT_EQ(meshes, GetParam().meshes);
  EXPECT_EQ(boxes, GetParam().boxes);
  EXPECT_EQ(meshes + boxes, static_cast<int>(robot.geometry.size()));
  EXPECT_EQ(triangles, GetParam().triangles);
  for (const std::string& note : robot.notes) {
    // The Panda's link6.obj has edges of its own.
    const bool edges = note.find("link6.obj': its lines, 19, have no surface") != note.npos ||
                       note.find("link6.obj': 24 of 966 vertices belong to no triangle") != note.npos;
    if (!edges) ADD_FAILURE() << "unexpected note: " << note;
  }
}

TEST_P(RealRobot, SrdfPairsAreRead) {
  if (GetParam().disabled_pairs < 0) GTEST_SKIP() << "RealRobot." << GetParam().robot << ": it comes without SRDF";
  const Robot robot = loadUrdf(base_.string() + ".urdf");
  EXPECT_EQ(static_cast<int>(loadSrdf(base_.string() + ".srdf", *robot.tree).pairs().size()),
            GetParam().disabled_pairs);
}

TEST_P(RealRobot, GeneratedPairsHoldTheAdjacentOnes) {
  const Robot robot = loadUrdf(base_.string() + ".urdf");
  LinkPairOptions quick;
  quick.samples = 20;
  quick.work = 100000;
  const LinkPairReport report = generateAllowedCollisions(robot, quick);
  const auto neighbours = std::count_if(report.pairs.begin(), report.pairs.end(),
                                        [](const LinkPairFinding& pair) { return pair.neighbours; });
  EXPECT_GE(neighbours, robot.tree->dof() - 1) << "each link has one";
  EXPECT_GT(report.count(LinkPairKind::never), 0u);
}

// Housings overlap in their joints: without an SRDF each pair of neighbours is proven apart or left out, so that none
// is in contact here and free there.
TEST_P(RealRobot, NeighboursAreApartOrTouchThroughout) {
  const Robot robot = loadUrdf(base_.string() + ".urdf");
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  manager.setup();
  EXPECT_GE(static_cast<int>(manager.neighbours().size()), robot.tree->dof() - 1);
  for (const LinkPairFinding& pair : manager.neighbours())
    EXPECT_TRUE(pair.kind == LinkPairKind::never || pair.touchThroughout()) << pair;
}

INSTANTIATE_TEST_SUITE_P(
    All, RealRobot,
    testing::Values(Expected{"puma560", 6, 0, 7, 0, 8116, -1}, Expected{"panda", 8, 1, 11, 0, 2364, 34},
                    Expected{"panda_mbm", 7, 0, 11, 0, 3472, 34}, Expected{"fanuc_m10ia", 6, 0, 7, 0, 6934, 10},
                    Expected{"ur5", 6, 0, 17, 1, 104185, 88}, Expected{"ur5_coarse", 6, 0, 17, 1, 51077, 88}),
    [](const auto& info) { return std::string(info.param.robot); });

}  // namespace
}  // namespace data_test
}  // namespace fcl_artic
