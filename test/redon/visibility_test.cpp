// SPDX-License-Identifier: BSD-3-Clause
// Stage 2 in the paper's method: the volumes that it hands over hold the links, and answers are the same bits with it.
#include <cmath>
#include <iostream>
#include <random>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <gtest/gtest.h>

#include "../visibility/recorder.h"
#include "../visibility/with_and_without.h"
#include "redon/parts.h"

namespace visibility_test {

namespace {

using namespace fcl_artic;
using Eigen::Vector3d;

std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> meshOf(const std::vector<Vector3d>& corners) {
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  mesh->beginModel();
  for (std::size_t i = 0; i < corners.size(); i += 3) mesh->addTriangle(corners[i], corners[i + 1], corners[i + 2]);
  mesh->endModel();
  return mesh;
}

/// An arm whose last link is a needle of one triangle, and a small triangle in the middle of its path over each eighth.
TEST(RedonVisibility, VolumesHoldTheLink) {
  const auto tree = test::fourJoints();
  const std::vector<Vector3d> needle{{-1e-4, 0, -0.2}, {1e-4, 0, -0.2}, {0, 0, 0.2}};
  const auto link = meshOf(needle);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  double least_room = HUGE_VAL;
  int telling = 0;
  std::vector<Eigen::Isometry3d> M_0;
  const auto poseAt = [&](const JointMotion& motion, double t) {
    tree->forwardKinematics(motion.configuration(t), M_0);
    return M_0[static_cast<std::size_t>(tree->linkId("link3"))];
  };
  for (int trial = 0; trial < 24; ++trial) {
    const Eigen::VectorXd q0 = Eigen::VectorXd::Random(4) * 2, dq = Eigen::VectorXd::Random(4) * (trial % 4 ? 0.5 : 2);
    const JointMotion motion = JointMotion::linear(*tree, q0, q0 + dq);
    std::vector<Vector3d> corners;
    for (int k = 0; k < 8; ++k) {
      const Vector3d p = poseAt(motion, (k + 0.5) / 8).translation();
      for (int i = 0; i < 3; ++i)
        corners.push_back(p + 1e-3 * Vector3d(normal(random), normal(random), normal(random)));
    }
    fcl::CollisionObjectd link_object(link), obstacle(meshOf(corners));
    ArticulatedCollisionManager manager(tree);
    manager.bind("link3", &link_object);
    manager.registerObject(&obstacle);
    manager.setup();
    visibility::Drawing drawing;
    manager.setVisibility(test::recordTo(drawing));
    for (const MotionEnclosure enclosure :
         {MotionEnclosure::intervalChain, MotionEnclosure::meanValue, MotionEnclosure::taylor}) {
      CertifiedRequest request;
      request.method = Method::redon2004;
      request.redon.enclosure = enclosure;
      request.visibility = VisibilityMode::on;
      CertifiedResult result;
      drawing.clear();
      manager.continuousCollide(motion, request, result);
      if (result.statistics.redon.pairs_by_standard || drawing.swept.size() != 8) continue;
      ++telling;
      for (int part = 0; part < 8; ++part) {
        for (int k = 0; k < 40; ++k) {
          const Vector3d n = Vector3d(normal(random), normal(random), normal(random)).normalized();
          const double held = test::support(drawing, drawing.swept[static_cast<std::size_t>(part)], n);
          for (int i = 0; i <= 16; ++i) {
            const Eigen::Isometry3d M = poseAt(motion, (part + i / 16.0) / 8);
            for (const Vector3d& x : needle) {
              const double reached = n.dot(M * x);
              ASSERT_LE(reached, held + 1e-13) << trial << " part " << part << " " << i;
              least_room = std::min(least_room, held - reached);
            }
          }
        }
      }
    }
  }
  EXPECT_GE(telling, 30);
  EXPECT_LT(least_room, 3e-4) << "not just large";
}

TEST(RedonVisibility, PartsOfTimeAreThoseThatOverlap) {
  std::mt19937_64 random(2);
  for (int level = 0; level <= 6; ++level) {
    for (int from = 0; from <= 6; ++from) {
      for (int trial = 0; trial < 20; ++trial) {
        const std::uint64_t parts = random() & random() & (from == 6 ? ~0ull : (1ull << (1 << from)) - 1);
        std::uint64_t expected = 0;
        for (int k = 0; k < 1 << level; ++k) {
          for (int j = 0; j < 1 << from; ++j) {
            const bool overlap =
                std::ldexp(k, -level) < std::ldexp(j + 1, -from) && std::ldexp(j, -from) < std::ldexp(k + 1, -level);
            if (overlap && parts >> j & 1) expected |= 1ull << k;
          }
        }
        ASSERT_EQ(redon::partsAt(level, parts, from), expected) << level << " " << from;
      }
    }
  }
}

/// FCL_ARTIC_REDON_QUERIES=10000 in the environment makes it a campaign.
TEST(RedonVisibility, SameAnswersWithTheStageAndWithout) {
  campaign::Arms arms = test::withAndWithoutStage();
  arms.draw = [without_margin = campaign::drawAnd([](campaign::Scene& scene) { scene.margin = 0; })](
                  campaign::Asked& asked, campaign::Case& c) {
    without_margin(asked, c);
    asked.question.request.method = Method::redon2004;
    asked.question.request.redon.in_time_order = c.index % 4 != 0;
  };
  arms.judges.push_back([](const campaign::Asked& asked, campaign::Case& c) {
    const auto &off = asked.result(0).statistics, &on = asked.result(1).statistics;
    if (on.redon.pairs_by_standard != off.redon.pairs_by_standard) c.fault("pairs", "others by the standard method");
    c.tally.count("fewer tests of boxes", on.redon.box_tests < off.redon.box_tests);
    c.tally.count("solved twice with more", on.visibility.repeated && on.redon.box_tests > off.redon.box_tests);
  });
  campaign::Options o;
  o.cases = campaign::fromEnvironment("FCL_ARTIC_REDON_QUERIES", 240);
  o.seed = 11;
  o.threads = 1;
  const campaign::Tally all = runWithoutFaults(campaignOf(arms), o).total;
  EXPECT_GT(all["contact"], o.cases / 10);
  EXPECT_GT(all["culled"], o.cases / 10);
  EXPECT_GT(all["fewer tests of boxes"], o.cases / 50);
  EXPECT_GT(all["solved twice with more"], o.cases / 50);
}

}  // namespace

}  // namespace visibility_test
