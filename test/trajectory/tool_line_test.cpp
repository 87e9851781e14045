// SPDX-License-Identifier: BSD-3-Clause
//
// How far a tool leaves its line: closed forms, and random arms judged by dense samples of the tree's own kinematics.
#include "fcl_artic/tool_line.h"

#include "scene.h"

namespace trajectory_test {
namespace tool_line_test {
namespace {

struct Judged {
  double distance = 0, angle = 0;
};

/// The largest deviations at samples, by quaternions.
Judged judge(const KinematicTree& tree, const JointTrajectory& x, LinkId link, const Isometry3d& tool, int samples) {
  const auto at = [&](double t) {
    std::vector<Isometry3d> M;
    tree.forwardKinematics(x.configuration(t), M);
    return Isometry3d(M[static_cast<std::size_t>(link)] * tool);
  };
  const Isometry3d begin = at(x.beginTime()), end = at(x.endTime());
  const Quaterniond q0(begin.linear()), q1(end.linear());
  const Vector3d along = end.translation() - begin.translation();
  Judged judged;
  for (int i = 0; i <= samples; ++i) {
    const Isometry3d M = at(x.beginTime() + (x.endTime() - x.beginTime()) * i / samples);
    const Vector3d d = M.translation() - begin.translation();
    const double s = std::min(std::max(d.dot(along) / along.squaredNorm(), 0.0), 1.0);
    judged.distance = std::max(judged.distance, (d - s * along).norm());
    judged.angle = std::max(judged.angle, q0.slerp(s, q1).angularDistance(Quaterniond(M.linear())));
  }
  return judged;
}

/// An arm of 1 m that turns by 1.2 rad about z: the arc's height, and no angle but that of its part of the turn.
TEST(ToolLine, AnArcLeavesItsChordByItsHeight) {
  Scene scene;
  scene.add("hinge", JointType::revolute, "base", "arm");
  const KinematicTree& tree = *scene.tree;
  ToolLineRequest request;
  request.tool = translation({1, 0, 0});
  const JointMotion motion = JointMotion::linear(tree, VectorXd::Constant(1, 0.3), VectorXd::Constant(1, 1.5));
  const ToolDeviation r = toolDeviation(tree, motion, "arm", request);
  const double height = 1 - std::cos(0.6);
  EXPECT_TRUE(r.within_tolerance);
  EXPECT_LE(r.distance_lower, height);
  EXPECT_GE(r.distance_upper, height);
  EXPECT_LE(r.distance_upper - r.distance_lower, request.tolerance_distance);
  EXPECT_NEAR(r.distance_time, 0.5, 2e-3);
  EXPECT_NEAR(r.length, 2 * std::sin(0.6), 1e-14);
  // At t the arm has turned by 1.2 t, and the foot of the tool has gone the part s of the chord.
  double angle = 0;
  for (int i = 0; i <= 100000; ++i) {
    const double t = i / 100000.0, s = 0.5 + std::sin(1.2 * t - 0.6) / (2 * std::sin(0.6));
    angle = std::max(angle, std::abs(1.2 * (t - s)));
  }
  EXPECT_LE(r.angle_lower, angle + 1e-9);
  EXPECT_GE(r.angle_upper, angle);
  EXPECT_LE(r.angle_upper - r.angle_lower, request.tolerance_angle);
  EXPECT_TRUE(r.certainlyKeeps(height + 1e-6, angle + 1e-4));
  EXPECT_TRUE(r.certainlyLeaves(height - 2e-6, 1));
  EXPECT_FALSE(r.certainlyLeaves(height + 1e-6, 1));
  EXPECT_FALSE(r.certainlyKeeps(height - 2e-6, 1));
}

/// A slide keeps its line, however its time goes, and a turn about that line is the shortest turn.
TEST(ToolLine, ASlideKeepsItsLine) {
  Scene scene;
  scene.add("slide", JointType::prismatic, "base", "carriage", Vector3d(1, 2, -2));
  scene.add("roll", JointType::revolute, "carriage", "tool", Vector3d(1, 2, -2));
  const KinematicTree& tree = *scene.tree;
  Eigen::MatrixXd there(2, 4);
  there << 0, 0, 3, -2, 0, 0, 3, -2;
  const ToolDeviation r = toolDeviation(tree, JointMotion::polynomial(tree, there), "tool");
  EXPECT_TRUE(r.certainlyKeeps(1e-6, 1e-4));
  EXPECT_LT(r.distance_lower, 1e-14);
  EXPECT_LT(r.angle_lower, 1e-13);
  EXPECT_NEAR(r.length, 1, 1e-14);
}

TEST(ToolLine, RandomArmsAgainstDenseSamples) {
  std::mt19937_64 random(20261127);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&](double size) -> Vector3d {
    return Vector3d(uniform(random), uniform(random), uniform(random)) * size;
  };
  static const JointType kinds[] = {JointType::revolute,  JointType::prismatic, JointType::planar,
                                    JointType::spherical, JointType::floating,  JointType::fixed,
                                    JointType::continuous};
  int asked = 0, far = 0, turned = 0;
  for (int n = 0; n < 300; ++n) {
    Scene scene;
    std::string parent = "base", master;
    for (int i = 0; i < 4; ++i) {
      const JointType type = kinds[n < 100 ? 0 : random() % 7];
      const bool simple = KinematicTree::numVariables(type) == 1;
      const Mimic mimic{master, uniform(random), uniform(random)};
      const bool follows = simple && !master.empty() && random() % 4 == 0;
      const std::string number = std::to_string(i), joint = "j" + number;
      const Isometry3d origin = translation(vector(0.4)) * Eigen::AngleAxisd(uniform(random), Vector3d::UnitY());
      scene.add(joint, type, parent, "l" + number, vector(1) + Vector3d(0, 0, 1.1), origin, follows ? &mimic : nullptr);
      if (simple && !follows) master = joint;
      parent = "l" + number;
    }
    const KinematicTree& tree = *scene.tree;
    const auto configuration = [&] {
      VectorXd q(tree.dof());
      for (int v = 0; v < tree.dof(); ++v) q[v] = 0.4 * uniform(random);
      for (JointId j = 0; j < tree.numJoints(); ++j) {
        if (const int v = tree.quaternionVariable(j); v >= 0) {
          q.segment<4>(v) = Quaterniond(1, q[v], q[v + 1], q[v + 2]).normalized().coeffs();
        }
      }
      return q;
    };
    std::vector<double> times{uniform(random)};
    std::vector<VectorXd> q{configuration()}, rates;
    for (int k = 0; k < 2; ++k) {
      times.push_back(times.back() + 0.5 + std::abs(uniform(random)));
      q.push_back(configuration());
    }
    for (int k = 0; k < 3; ++k) {
      VectorXd rate(tree.dof());
      for (int v = 0; v < tree.dof(); ++v) rate[v] = uniform(random);
      for (JointId j = 0; j < tree.numJoints(); ++j) {
        if (const int v = tree.quaternionVariable(j); v >= 0) rate[v + 3] = 0;
      }
      rates.push_back(rate);
    }
    const bool cubic = random() % 2 == 0;
    const JointTrajectory x =
        cubic ? JointTrajectory::cubic(tree, times, q, rates) : JointTrajectory::linear(tree, times, q);
    ToolLineRequest request;
    request.tool = translation(vector(0.2)) * Eigen::AngleAxisd(uniform(random), Vector3d::UnitX());
    request.tolerance_distance = 1e-5;
    request.tolerance_angle = 2e-3;
    ToolDeviation r;
    try {
      r = toolDeviation(tree, x, parent, request);
    } catch (const std::invalid_argument&) {
      continue;  // nothing moves the tool
    }
    ++asked;
    const Judged judged = judge(tree, x, tree.linkId(parent), request.tool, 2000);
    EXPECT_TRUE(r.within_tolerance || r.angle_upper > 2.5) << n;
    EXPECT_LE(judged.distance, r.distance_upper + 1e-12) << n;
    EXPECT_LE(judged.angle, r.angle_upper + 1e-7) << n;  // the judge's arc cosine
    EXPECT_GE(judged.distance, r.distance_lower - 1e-3) << n;
    EXPECT_GE(judged.angle, r.angle_lower - 1e-2) << n;
    const Isometry3d begin = [&] {
      std::vector<Isometry3d> M;
      tree.forwardKinematics(x.configuration(x.beginTime()), M);
      return Isometry3d(M[static_cast<std::size_t>(tree.linkId(parent))] * request.tool);
    }();
    EXPECT_GE(r.distance_time, x.beginTime());
    EXPECT_LE(r.distance_time, x.endTime());
    std::vector<Isometry3d> M;
    tree.forwardKinematics(x.configuration(r.distance_time), M);
    EXPECT_GE(
        (M[static_cast<std::size_t>(tree.linkId(parent))] * request.tool.translation() - begin.translation()).norm(),
        r.distance_lower - 1e-12);
    far += r.distance_lower > 0.01;
    turned += r.angle_lower > 0.05;
  }
  std::cout << asked << " motions, " << far << " leave by more than 1 cm, " << turned << " by more than 0.05 rad\n";
  EXPECT_GT(asked, 150);
  EXPECT_GT(far, 100);
  EXPECT_GT(turned, 100);
}

TEST(ToolLine, WhatIsNoLineIsRefused) {
  Scene scene;
  scene.add("hinge", JointType::revolute, "base", "arm");
  const KinematicTree& tree = *scene.tree;
  const auto turn = [&](double angle) {
    return JointMotion::linear(tree, VectorXd::Zero(1), VectorXd::Constant(1, angle));
  };
  ToolLineRequest request;
  EXPECT_THROW((void)toolDeviation(tree, turn(1), "arm", request), std::invalid_argument);  // it stays where it is
  request.tool = translation({1, 0, 0});
  EXPECT_NO_THROW((void)toolDeviation(tree, turn(2.4), "arm", request));
  const ToolDeviation far = toolDeviation(tree, turn(2.6), "arm", request);
  EXPECT_EQ(far.angle_lower, 0);
  EXPECT_GE(far.angle_upper, kPi);
  EXPECT_FALSE(far.within_tolerance);
  EXPECT_NEAR(far.distance_upper, 1 - std::cos(1.3), 1e-5);
  EXPECT_THROW((void)toolDeviation(tree, turn(1), "hand", request), std::out_of_range);
  EXPECT_THROW((void)toolDeviation(tree, turn(1), 7, request), std::out_of_range);
  EXPECT_THROW((void)toolDeviation(KinematicTree("other"), turn(1), 0, request), std::invalid_argument);
  EXPECT_THROW(
      (void)toolDeviation(tree, JointMotion::tangentHalfAngle(tree, VectorXd::Zero(1), VectorXd::Constant(1, 1)), "arm",
                          request),
      std::invalid_argument);
  request.tolerance_angle = 0;
  EXPECT_THROW((void)toolDeviation(tree, turn(1), "arm", request), std::invalid_argument);
  request.tolerance_angle = 1e-9;
  request.work_budget = 100;
  const ToolDeviation cut = toolDeviation(tree, turn(1), "arm", request);
  EXPECT_FALSE(cut.within_tolerance);
  EXPECT_GT(cut.angle_upper, cut.angle_lower);
  request.tool.linear() *= 1.001;
  EXPECT_THROW((void)toolDeviation(tree, turn(1), "arm", request), std::invalid_argument);
}

}  // namespace
}  // namespace tool_line_test
}  // namespace trajectory_test
