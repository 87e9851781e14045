// SPDX-License-Identifier: BSD-3-Clause
// Robot models and shapes beside MoveIt's own forward kinematics and sizes.
#include <iostream>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <octomap/octomap.h>

#include "fcl_artic_moveit/robot.h"
#include "fcl_artic_moveit/shapes.h"
#include "models.h"

namespace fcl_artic_moveit {
namespace {

/// All kinds of joints, with origins that turn and slide.
std::string allJoints(const std::string& virtual_joint) {
  std::string urdf = "<robot name='zoo'>";
  for (const char* link : {"base", "a", "b", "c", "d", "e", "f", "g", "h", "i"}) urdf += boxLink(link, 0.1, 0.1, 0.1);
  const std::string axis = "<axis xyz='0.6 0 0.8'/>";
  urdf += joint("hinge", "revolute", "base", "a", axis, "0.1 0.2 0.3", "0.1 0.2 0.3");
  // Named and placed before its master in the file, and mimics a mimic joint.
  urdf += joint("copy2", "prismatic", "a", "g", axis + "<mimic joint='copy' multiplier='-0.5' offset='0.2'/>", "0 1 0");
  urdf += joint("copy", "revolute", "b", "f", axis + "<mimic joint='slide' multiplier='2' offset='0.1'/>", "0 0 1");
  urdf += joint("wheel", "continuous", "a", "b", axis, "0 0.1 0", "1 0 0");
  urdf += joint("slide", "prismatic", "b", "c", axis, "0 0 0.2", "0 1 0");
  urdf += joint("drive", "planar", "base", "d", "<axis xyz='1 0 0'/>", "0.5 0 0", "0 0 1");
  urdf += joint("fly", "floating", "base", "e", "", "0 0.5 0", "0.5 0 0");
  urdf += joint("glue", "fixed", "c", "h", "", "0 0.5 0", "0.5 0 0.1");
  urdf += joint("bolt", "fixed", "h", "i", "<mimic joint='glue'/>", "0 0.5 0");  // as the Panda's fingers have it
  return urdf + "</robot>" + virtual_joint;
}

int comparePoses(const moveit::core::RobotModelConstPtr& model) {
  const RobotTree robot = toTree(*model, {"a"});
  EXPECT_EQ(robot.tree->numLinks(),
            static_cast<int>(model->getLinkModelCount()) + 1 + (model->getModelFrame() == "base" ? 0 : 1));
  moveit::core::RobotState state(model);
  random_numbers::RandomNumberGenerator random(42);
  int compared = 0;
  for (int i = 0; i < 50; ++i) {
    state.setToRandomPositions();
    for (const char* joint : {"drive", "fly"}) {  // unbounded: random values are far away
      const auto* one = model->getJointModel(joint);
      for (int k = 0; k < 3 && one; ++k) {
        state.setVariablePosition(one->getFirstVariableIndex() + static_cast<std::size_t>(k),
                                  random.uniformReal(-2, 2));
      }
    }
    state.update();
    const Eigen::VectorXd q = robot.configuration(state);
    for (const moveit::core::LinkModel* link : model->getLinkModels()) {
      const auto pose = robot.tree->linkPose(robot.tree->linkId(link->getName()), q);
      EXPECT_TRUE(pose.isApprox(state.getGlobalLinkTransform(link), 1e-9))
          << link->getName() << '\n'
          << pose.matrix() << '\n'
          << state.getGlobalLinkTransform(link).matrix();
      ++compared;
    }
    EXPECT_EQ(robot.tree->linkPose(robot.tree->linkId(mountName("a")), q).matrix(),
              robot.tree->linkPose(robot.tree->linkId("a"), q).matrix());
  }
  return compared;
}

TEST(Robot, PosesOfAllJointKindsAreMoveIts) {
  int compared = 0;
  for (const char* type : {"", "fixed", "planar", "floating"}) {
    SCOPED_TRACE(type);
    const std::string name(type);
    const std::string srdf =
        name.empty() ? "" : "<virtual_joint name='virtual' type='" + name + "' parent_frame='odom' child_link='base'/>";
    const auto model = modelOf(allJoints(""), "<robot name='zoo'>" + srdf + "</robot>");
    compared += comparePoses(model);
    const RobotTree robot = toTree(*model);
    for (int v = 0; v < robot.tree->dof(); ++v) {
      EXPECT_EQ(robot.tree->variableName(v), model->getVariableNames()[robot.variables[static_cast<std::size_t>(v)]]);
    }
    EXPECT_EQ(robot.followers.size(), 2U);
    const int own = name == "planar" ? 3 : name == "floating" ? 7 : 0;
    EXPECT_EQ(robot.tree->dof(), 3 + 3 + 7 + own);
    EXPECT_EQ(robot.tree->hasLink("odom"), own > 0);  // MoveIt keeps the root link's frame for a fixed joint
  }
  std::cout << compared << " poses of links compared\n";
  EXPECT_EQ(compared, 4 * 50 * 10);
}

TEST(Robot, LimitsAreTheModels) {
  const auto model = modelOf(allJoints(""), "<robot name='zoo'/>");
  const RobotTree robot = toTree(*model);
  EXPECT_EQ(robot.tree->joint("hinge").lower, -3);
  EXPECT_EQ(robot.tree->joint("hinge").upper, 3);
  EXPECT_EQ(robot.tree->joint("wheel").type, fcl_artic::JointType::continuous);
  EXPECT_FALSE(hasLimits(robot.tree->joint("wheel")));
}

TEST(Robot, MimicJointElsewhereIsRefused) {
  const auto model = modelOf(allJoints(""), "<robot name='zoo'/>");
  const RobotTree robot = toTree(*model);
  moveit::core::RobotState state(model);
  state.setToDefaultValues();
  state.update();
  (void)robot.configuration(state);
  double values[64];
  std::copy(state.getVariablePositions(), state.getVariablePositions() + model->getVariableCount(), values);
  state.getVariablePositions()[model->getVariableIndex("copy")] += 0.01;
  expectContains(refusal([&] { (void)robot.configuration(state); }), "joint 'copy' is at 0.11");
  std::copy(values, values + model->getVariableCount(), state.getVariablePositions());
  state.getVariablePositions()[model->getVariableIndex("hinge")] = std::numeric_limits<double>::quiet_NaN();
  expectContains(refusal([&] { (void)robot.configuration(state); }), "'hinge' is nan");
}

TEST(Shapes, SizesAreMoveIts) {
  const auto box = std::dynamic_pointer_cast<fcl::Boxd>(toFcl(shapes::Box(1, 2, 3)));
  ASSERT_TRUE(box);
  EXPECT_EQ(box->side, Eigen::Vector3d(1, 2, 3));
  const auto sphere = std::dynamic_pointer_cast<fcl::Sphered>(toFcl(shapes::Sphere(0.5)));
  ASSERT_TRUE(sphere);
  EXPECT_EQ(sphere->radius, 0.5);
  const auto cylinder = std::dynamic_pointer_cast<fcl::Cylinderd>(toFcl(shapes::Cylinder(0.1, 0.7)));
  ASSERT_TRUE(cylinder);
  EXPECT_EQ(cylinder->radius, 0.1);
  EXPECT_EQ(cylinder->lz, 0.7);
  const auto cone = std::dynamic_pointer_cast<fcl::Coned>(toFcl(shapes::Cone(0.1, 0.7)));
  ASSERT_TRUE(cone);
  EXPECT_EQ(cone->radius, 0.1);
  EXPECT_EQ(cone->lz, 0.7);
  const auto mesh = std::dynamic_pointer_cast<fcl::BVHModel<fcl::OBBRSSd>>(toFcl(*boxMesh(1, 2, 3)));
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->num_tris, 12);
  EXPECT_EQ(mesh->vertices[7], Eigen::Vector3d(0.5, 1, 1.5));
  // 2 z - 3 = 0: the points with z = 1.5.
  const auto plane = std::dynamic_pointer_cast<fcl::Planed>(toFcl(shapes::Plane(0, 0, 2, -3)));
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->n, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(plane->d, 1.5);
  const auto cells = std::make_shared<const octomap::OcTree>(0.1);
  const auto tree = std::dynamic_pointer_cast<fcl::OcTreed>(toFcl(shapes::OcTree(cells)));
  ASSERT_TRUE(tree);
}

TEST(Shapes, WhatIsNoneIsRefused) {
  expectContains(refusal([] { (void)toFcl(shapes::Plane(0, 0, 0, 1)); }), "plane whose normal is 0");
  expectContains(refusal([] { (void)toFcl(shapes::OcTree()); }), "octree shape without an octree");
  expectContains(refusal([] { (void)toFcl(shapes::Mesh(3, 0)); }), "mesh without triangles");
  shapes::Mesh mesh(3, 1);
  std::fill(mesh.vertices, mesh.vertices + 9, 0.0);
  mesh.triangles[0] = 0;
  mesh.triangles[1] = 1;
  mesh.triangles[2] = 3;
  expectContains(refusal([&] { (void)toFcl(mesh); }), "triangle 0 has a vertex 3 of 3");
  shapes::Box unknown(1, 1, 1);
  unknown.type = shapes::UNKNOWN_SHAPE;
  expectContains(refusal([&] { (void)toFcl(unknown); }), "not known");
}

}  // namespace
}  // namespace fcl_artic_moveit
