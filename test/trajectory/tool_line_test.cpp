// SPDX-License-Identifier: BSD-3-Clause
//
// How far a tool leaves its line: closed forms, and random arms judged by dense samples of the tree's own kinematics.
#include "fcl_artic/tool_line.h"

#include <cstdlib>
#include <optional>

#include "scene.h"

namespace trajectory_test {
namespace tool_line_test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;

struct Judged {
  double distance = 0, angle = 0;
};

/// A path by formulas of its own: its part at the nearest point, and the pose that is wanted there.
struct JudgedPath {
  Isometry3d begin, end;
  bool arc = false;
  Vector3d center, normal;
  double angle = 0;

  JudgedPath(const Isometry3d& first, const Isometry3d& last, const std::optional<Vector3d>& via)
      : begin(first), end(last), arc(via.has_value()) {
    if (!arc) return;
    // The centre is as far from all three points, and in their plane.
    const Vector3d p = begin.translation(), q = *via, r = end.translation();
    Matrix3d A;
    A << (q - p).transpose(), (r - p).transpose(), (q - p).cross(r - p).transpose();
    const Vector3d right(0.5 * (q - p).dot(q + p), 0.5 * (r - p).dot(r + p), A.row(2).dot(p));
    center = A.fullPivLu().solve(right);
    normal = A.row(2).transpose().normalized();
    angle = angleOf(r);
    if (angleOf(q) > angle) std::abort();  // the normal is that of the way through `via`
  }
  double angleOf(const Vector3d& x) const {
    const Vector3d u = (begin.translation() - center).normalized(), v = normal.cross(u);
    const double a = std::atan2(v.dot(x - center), u.dot(x - center));
    return a < 0 ? a + 2 * kPi : a;
  }
  double partAt(const Vector3d& x) const {
    const Vector3d along = end.translation() - begin.translation();
    if (!arc) return std::min(std::max(along.dot(x - begin.translation()) / along.squaredNorm(), 0.0), 1.0);
    const double a = angleOf(x);
    if (a <= angle) return a / angle;
    return (x - end.translation()).norm() < (x - begin.translation()).norm() ? 1 : 0;
  }
  Isometry3d at(double part) const {
    Isometry3d M = Isometry3d::Identity();
    const Quaterniond first(begin.linear());
    if (!arc) {
      M.translation() = begin.translation() + part * (end.translation() - begin.translation());
      M.linear() = first.slerp(part, Quaterniond(end.linear())).toRotationMatrix();
      return M;
    }
    const auto turned = [&](double by) { return Quaterniond(AngleAxisd(by, normal)); };
    M.translation() = center + turned(part * angle) * (begin.translation() - center);
    M.linear() =
        (turned(part * angle) * first.slerp(part, turned(-angle) * Quaterniond(end.linear()))).toRotationMatrix();
    return M;
  }
};

/// The largest deviations at samples, by quaternions.
Judged judge(const KinematicTree& tree, const JointTrajectory& x, LinkId link, const ToolLineRequest& request,
             int samples) {
  const auto at = [&](double t) {
    std::vector<Isometry3d> M;
    tree.forwardKinematics(x.configuration(t), M);
    return Isometry3d(M[static_cast<std::size_t>(link)] * request.tool);
  };
  const JudgedPath path(at(x.beginTime()), at(x.endTime()), request.via);
  Judged judged;
  for (int i = 0; i <= samples; ++i) {
    const Isometry3d M = at(x.beginTime() + (x.endTime() - x.beginTime()) * i / samples);
    const Isometry3d wanted = path.at(path.partAt(M.translation()));
    judged.distance = std::max(judged.distance, (M.translation() - wanted.translation()).norm());
    judged.angle = std::max(judged.angle, Quaterniond(wanted.linear()).angularDistance(Quaterniond(M.linear())));
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

/// A turn of the arm, then a slide along it, one up, and turns of the hand about the arm and about the vertical.
struct Crane {
  Scene scene;
  Crane() {
    scene.add("turn", JointType::revolute, "base", "arm");
    scene.add("reach", JointType::prismatic, "arm", "carriage", Vector3d::UnitX(), translation({1, 0, 0}));
    scene.add("lift", JointType::prismatic, "carriage", "mast");
    scene.add("roll", JointType::revolute, "mast", "wrist", Vector3d::UnitX());
    scene.add("yaw", JointType::revolute, "wrist", "tool");
  }
  /// Rows: coefficients of the joints' polynomials.
  ToolDeviation ask(const MatrixXd& coefficients, const ToolLineRequest& request) const {
    return toolDeviation(*scene.tree, JointMotion::polynomial(*scene.tree, coefficients), "tool", request);
  }
  static MatrixXd turns(double angle) {
    MatrixXd c = MatrixXd::Zero(5, 3);
    c(0, 1) = angle;
    return c;
  }
  static Vector3d onCircle(double angle, double radius = 1, double height = 0) {
    return {radius * std::cos(angle), radius * std::sin(angle), height};
  }
};

TEST(ToolLine, ATurningToolDrawsItsArc) {
  const Crane crane;
  for (const double angle : {0.01, 1.2, -1.2, 2.9, 3.3, -4.5, 6.2}) {
    for (const double part : {0.5, 0.07}) {
      ToolLineRequest request;
      request.via = Crane::onCircle(part * angle);
      const ToolDeviation r = crane.ask(Crane::turns(angle), request);
      EXPECT_TRUE(r.certainlyKeeps(1e-6, 1e-4)) << angle;
      EXPECT_TRUE(r.within_tolerance);
      EXPECT_LT(r.distance_lower, 1e-12);
      EXPECT_LT(r.angle_lower, 1e-9);
      EXPECT_NEAR(r.length, std::abs(angle), 1e-9);
      // Through a point on the other side the arc is what is left of the circle.
      request.via = Crane::onCircle(angle / 2 + kPi);
      const ToolDeviation other = crane.ask(Crane::turns(angle), request);
      const double farthest = 2 * std::sin(std::abs(angle) / 4);
      EXPECT_NEAR(other.length, 2 * kPi - std::abs(angle), 1e-9);
      EXPECT_LE(other.distance_lower, farthest + 1e-12) << angle;
      EXPECT_GE(other.distance_upper, farthest - 1e-12) << angle;
      EXPECT_LE(other.distance_upper - other.distance_lower, 1e-6);
    }
  }
}

/// Farther from the axis by 0.05 * 4 t (1 - t) m, above the circle's plane by 0.12 of that, and turned about the arm by
/// 0.3 of that: each is largest at t = 0.5, and so are all together.
TEST(ToolLine, FromAnArcInItsPlaneAndOutOfIt) {
  const Crane crane;
  for (const double angle : {1.2, -4.5}) {
    for (const Vector3d& bump :
         {Vector3d(0.05, 0, 0), Vector3d(-0.05, 0, 0), Vector3d(0, 0.12, 0), Vector3d(0.05, 0.12, 0.3)}) {
      MatrixXd c = Crane::turns(angle);
      for (int k = 0; k < 3; ++k) c.row(k + 1) << 0, 4 * bump[k], -4 * bump[k];
      ToolLineRequest request;
      request.via = Crane::onCircle(0.3 * angle);
      const ToolDeviation r = crane.ask(c, request);
      const double distance = std::hypot(bump[0], bump[1]);
      EXPECT_TRUE(r.within_tolerance);
      EXPECT_LE(r.distance_lower, distance);
      EXPECT_GE(r.distance_upper, distance);
      EXPECT_NEAR(r.distance_time, 0.5, 5e-3);
      EXPECT_LE(r.angle_lower, bump[2] + 1e-12);
      EXPECT_GE(r.angle_upper, bump[2]);
    }
  }
}

/// A tool that does not turn with its arc: seen from the arc it turns evenly, back, about the circle's axis.
TEST(ToolLine, AToolThatKeepsItsOrientationAlongAnArc) {
  const Crane crane;
  const auto ask = [&](double angle, double wrist_rate) {
    MatrixXd c = Crane::turns(angle);
    c(4, 1) = wrist_rate * angle;
    c(4, 2) = (-1 - wrist_rate) * angle;
    ToolLineRequest request;
    request.via = Crane::onCircle(0.5 * angle);
    return crane.ask(c, request);
  };
  const ToolDeviation even = ask(2, -1);
  EXPECT_TRUE(even.certainlyKeeps(1e-6, 1e-4));
  EXPECT_LT(even.angle_lower, 1e-9);
  // The hand turns back later than the arm: by angle t^2, not by angle t.
  const ToolDeviation late = ask(2, 0);
  EXPECT_LE(late.angle_lower, 0.5 + 1e-12);
  EXPECT_GE(late.angle_upper, 0.5 - 1e-12);
  EXPECT_LE(late.angle_upper - late.angle_lower, 1e-4);
  const ToolDeviation blind = ask(2.6, -1);
  EXPECT_EQ(blind.angle_lower, 0);
  EXPECT_GE(blind.angle_upper, kPi);
  EXPECT_FALSE(blind.within_tolerance);
  EXPECT_LE(blind.distance_upper, 1e-6);
}

/// Past the end of its arc by 0.2 rad, and back.
TEST(ToolLine, AnArcEnds) {
  const Crane crane;
  for (const double angle : {1.2, 5.0}) {
    MatrixXd c = Crane::turns(0);
    // q = a t + b t^2 with q(1) = angle and its largest value angle + 0.2.
    const double most = angle + 0.2, a = 2 * (most + std::sqrt(most * 0.2));
    c.row(0) << 0, a, angle - a;
    ToolLineRequest request;
    request.via = Crane::onCircle(0.5 * angle);
    const ToolDeviation r = crane.ask(c, request);
    EXPECT_LE(r.distance_lower, 2 * std::sin(0.1));
    EXPECT_GE(r.distance_upper, 2 * std::sin(0.1));
    EXPECT_NEAR(r.distance_time, a / (2 * (a - angle)), 1e-2);
    EXPECT_LE(r.angle_lower, 0.2 + 1e-9);
    EXPECT_GE(r.angle_upper, 0.2 - 1e-9);
    EXPECT_TRUE(r.within_tolerance);
  }
}

/// A tool that goes straight leaves an arc by its height, though it is on it at both ends.
TEST(ToolLine, AChordLeavesItsArcByTheArcsHeight) {
  Scene scene;
  scene.add("slide", JointType::prismatic, "base", "tool", Vector3d::UnitX());
  const JointMotion motion = JointMotion::linear(*scene.tree, VectorXd::Zero(1), VectorXd::Constant(1, 1));
  for (const double height : {1e-3, 0.2, 0.5}) {
    ToolLineRequest request;
    request.via = Vector3d(0.5, height, 0);
    const ToolDeviation r = toolDeviation(*scene.tree, motion, "tool", request);
    EXPECT_LE(r.distance_lower, height);
    EXPECT_GE(r.distance_upper, height);
    EXPECT_LE(r.distance_upper - r.distance_lower, 1e-6);
    EXPECT_NEAR(r.distance_time, 0.5, 1e-2);
  }
  // A high one: no point of the chord is as far as its ends' bisector from both sides of the arc.
  ToolLineRequest request;
  request.via = Vector3d(0.5, 2, 0);
  const ToolDeviation r = toolDeviation(*scene.tree, motion, "tool", request);
  EXPECT_NEAR(r.distance_upper, 0.5, 1e-6);
  EXPECT_NEAR(r.distance_time, 0.5, 1e-3);
}

/// One budget is for both brackets: a motion that leaves its line first, and turns afterwards, needs a pose for each.
TEST(ToolLine, OneBudgetIsForBothBrackets) {
  Scene scene;
  scene.add("x", JointType::prismatic, "base", "a", Vector3d::UnitX());
  scene.add("y", JointType::prismatic, "a", "b", Vector3d::UnitY());
  scene.add("roll", JointType::revolute, "b", "tool", Vector3d::UnitX());
  const KinematicTree& tree = *scene.tree;
  const JointTrajectory x = JointTrajectory::cubic(
      tree, {0, 1, 2, 3, 4},
      {values({0, 0, 0}), values({1, 0.3, 0}), values({2, 0, 0}), values({2, 0, 1}), values({2, 0, 0})},
      {values({0, 0, 0}), values({1, 0, 0}), values({0, 0, 0}), values({0, 0, 0}), values({0, 0, 0})});
  const auto least = [&](double tolerance_distance, double tolerance_angle) {
    std::uint64_t low = 1, high = 1 << 20;
    while (low < high) {
      ToolLineRequest request;
      request.tolerance_distance = tolerance_distance;
      request.tolerance_angle = tolerance_angle;
      request.work_budget = (low + high) / 2;
      if (toolDeviation(tree, x, "tool", request).within_tolerance) {
        high = request.work_budget;
      } else {
        low = request.work_budget + 1;
      }
    }
    return low;
  };
  const std::uint64_t distance = least(1e-8, 10), angle = least(10, 0.02), both = least(1e-8, 0.02);
  std::cout << distance << " poses for the distance, " << angle << " for the angle, " << both << " for both\n";
  EXPECT_GT(angle, 30u);
  EXPECT_GT(distance, 30u);
  EXPECT_GT(both, std::max(distance, angle) + std::min(distance, angle) / 2);
  EXPECT_LE(both, distance + 2 * angle);
}

TEST(ToolLine, WhatIsNoArcIsRefused) {
  const Crane crane;
  const auto refused = [&](const Vector3d& via) {
    ToolLineRequest request;
    request.via = via;
    return refusal([&] { (void)crane.ask(Crane::turns(1), request); });
  };
  const Vector3d begin = Crane::onCircle(0), end = Crane::onCircle(1), middle = 0.5 * (begin + end);
  expectContains(refused(begin + Vector3d(1e-7, 0, 0)), "from the tool's begin");
  expectContains(refused(end), "from the tool's end");
  expectContains(refused(middle), "nearly on a straight line");
  expectContains(refused(middle + Vector3d(0, 0, 1e-4)), "nearly on a straight line");
  EXPECT_EQ(refused(middle + Vector3d(0, 0, 1e-3)), "(not refused)");
  expectContains(refused(2 * end - begin), "nearly on a straight line");  // beyond the end
  expectContains(refused(Vector3d(0, std::nan(""), 0)), "not finite");
  expectContains(refused(Vector3d(0, 2e9, 0)), "beyond 1e9 m");
  // Far from the origin an arc of a millimetre is not known.
  Scene far;
  far.add("slide", JointType::prismatic, "base", "tool", Vector3d::UnitX(), translation({1e7, 0, 0}));
  const JointMotion motion = JointMotion::linear(*far.tree, VectorXd::Zero(1), VectorXd::Constant(1, 1e-3));
  ToolLineRequest request;
  request.via = Vector3d(1e7 + 5e-4, 1e-6, 0);
  expectContains(refusal([&] { (void)toolDeviation(*far.tree, motion, "tool", request); }), "too little");
}

/// @param arcs  the paths are arcs: by the tool's place at the middle of the time, and some way from there.
void compareWithDenseSamples(bool arcs) {
  std::mt19937_64 random(20261127);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&](double size) -> Vector3d {
    return Vector3d(uniform(random), uniform(random), uniform(random)) * size;
  };
  static const JointType kinds[] = {JointType::revolute,  JointType::prismatic, JointType::planar,
                                    JointType::spherical, JointType::floating,  JointType::fixed,
                                    JointType::continuous};
  int asked = 0, far = 0, turned = 0, long_arcs = 0, near = 0;
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
    const auto poseAt = [&](double t) {
      std::vector<Isometry3d> M;
      tree.forwardKinematics(x.configuration(t), M);
      return Isometry3d(M[static_cast<std::size_t>(tree.linkId(parent))] * request.tool);
    };
    const Isometry3d begin = poseAt(x.beginTime());
    if (arcs) request.via = poseAt(x.times()[1]).translation() + vector(n % 3 == 0 ? 1e-3 : 0.1);
    ToolDeviation r;
    try {
      r = toolDeviation(tree, x, parent, request);
    } catch (const std::invalid_argument&) {
      continue;  // nothing moves the tool
    }
    ++asked;
    const Judged judged = judge(tree, x, tree.linkId(parent), request, 2000);
    EXPECT_LE(r.distance_upper - r.distance_lower, request.tolerance_distance) << n;
    const JudgedPath path(begin, poseAt(x.endTime()), request.via);
    const double radius = arcs ? (path.center - begin.translation()).norm() : 0;
    EXPECT_NEAR(r.length, arcs ? radius * path.angle : r.length, 1e-9 * radius) << n;
    long_arcs += path.angle > kPi;
    // Nearer to an arc than its reach the angle is bracketed, too.
    const double reach = path.angle > kPi ? 0.5 * (path.end.translation() - begin.translation()).norm() : radius;
    const bool is_near = !arcs || r.distance_upper < 0.89 * reach;
    near += is_near;
    EXPECT_TRUE(!is_near || r.within_tolerance || r.angle_upper > 2.5) << n;
    EXPECT_LE(judged.distance, r.distance_upper + 1e-12) << n;
    EXPECT_LE(judged.angle, r.angle_upper + 1e-7) << n;  // the judge's arc cosine
    EXPECT_GE(judged.distance, r.distance_lower - 1e-3) << n;
    EXPECT_GE(judged.angle, r.angle_lower - 1e-2) << n;
    EXPECT_GE(r.distance_time, x.beginTime());
    EXPECT_LE(r.distance_time, x.endTime());
    const Vector3d there = poseAt(r.distance_time).translation();
    EXPECT_GE((there - path.at(path.partAt(there)).translation()).norm(), r.distance_lower - 1e-12) << n;
    far += r.distance_lower > 0.01;
    turned += r.angle_lower > 0.05;
  }
  std::cout << asked << " motions, " << far << " leave by more than 1 cm, " << turned << " by more than 0.05 rad, "
            << near << " keep within the reach, " << long_arcs << " arcs of more than half a circle\n";
  EXPECT_GT(asked, 150);
  EXPECT_GT(far, 100);
  EXPECT_GT(turned, 100);
  EXPECT_GT(near, 50);
  EXPECT_GT(long_arcs, arcs ? 20 : -1);
}
TEST(ToolLine, RandomArmsAgainstDenseSamples) {
  compareWithDenseSamples(false);
}
TEST(ToolLine, RandomArmsAlongArcsAgainstDenseSamples) {
  compareWithDenseSamples(true);
}

/// A tool in the plane of its arc, whose orientation is that of the arc at both ends.
struct Gantry {
  Scene scene;
  Gantry() {
    scene.add("x", JointType::prismatic, "base", "a", Vector3d::UnitX());
    scene.add("y", JointType::prismatic, "a", "b", Vector3d::UnitY());
    scene.add("yaw", JointType::revolute, "b", "tool");
  }
  static VectorXd at(const Vector3d& x, double yaw) { return values({x[0], x[1], yaw}); }
};

/// Near the axis the nearest point goes fast. It does so up to the end of an arc of 1 rad, where the tool is 0.15 m
/// from the axis, while the tool turns evenly, by 0.5 rad. There, at 0.3 / 0.55 of the second step, it is turned the
/// most.
TEST(ToolLine, TheNearestPointGoesFastNearTheAxis) {
  const Gantry gantry;
  const Vector3d radial = Crane::onCircle(1), along = Crane::onCircle(1 + kPi / 2);
  const JointTrajectory x =
      JointTrajectory::linear(*gantry.scene.tree, {0, 1, 2, 3},
                              {Gantry::at({1, 0, 0}, 0), Gantry::at(0.15 * radial - 0.3 * along, 0),
                               Gantry::at(0.15 * radial + 0.25 * along, 0.5), Gantry::at(radial, 1)});
  ToolLineRequest request;
  request.via = Crane::onCircle(0.5);
  const ToolDeviation r = toolDeviation(*gantry.scene.tree, x, "tool", request);
  const double most = 1 - 0.5 * 0.3 / 0.55;
  EXPECT_LE(r.angle_lower, most);
  EXPECT_GE(r.angle_upper, most);
  EXPECT_NEAR(r.angle_time, 1 + 0.3 / 0.55, 1e-3);
  EXPECT_NEAR(r.distance_upper, std::hypot(0.85, 0.25), 1e-5);
  EXPECT_TRUE(r.within_tolerance);
}

/// Within one step the tool goes beyond the axis and back, where the other end of the arc is nearer. The orientation
/// that is wanted there is 2 rad away, and is 1.5 rad away at another time.
TEST(ToolLine, TheNearestPointJumpsBeyondTheAxis) {
  const Gantry gantry;
  const Vector3d end = Crane::onCircle(2);
  const VectorXd still = VectorXd::Zero(3), inward = Gantry::at(-1.2 * end, 0), outward = -inward;
  const JointTrajectory x =
      JointTrajectory::cubic(*gantry.scene.tree, {0, 1, 2, 3, 4, 5, 6},
                             {Gantry::at({1, 0, 0}, 0), Gantry::at(end, 2), Gantry::at(end, 0.5), Gantry::at(end, 2),
                              Gantry::at(0.15 * end, 2), Gantry::at(0.15 * end, 2), Gantry::at(end, 2)},
                             {still, still, still, still, inward, outward, still});
  ToolLineRequest request;
  request.via = Crane::onCircle(1);
  request.tolerance_distance = 10;  // so that nobody looks there for the distance
  const ToolDeviation r = toolDeviation(*gantry.scene.tree, x, "tool", request);
  EXPECT_GE(r.angle_lower, 1.5 - 1e-4);
  EXPECT_LE(r.angle_lower, 2);
  EXPECT_GE(r.angle_upper, 2);
  EXPECT_FALSE(r.within_tolerance);
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
