// SPDX-License-Identifier: BSD-3-Clause
//
// Tables of two links over two joint variables. A ball, carried by two joints, beside a slanted plate that is the
// robot's base. The ball never leaves the plate's box in the world, so if the pair is left out, the table has done it.
// Distances in closed form.
#include <cmath>
#include <iostream>
#include <random>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>

#include "expect_time.h"
#include "fcl_artic/clearance.h"
#include "fcl_artic/trajectory.h"

namespace pair_table_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double kBall = 0.01, kPi = 3.14159265358979323846;
const Vector3d kHalf(1, 1, 0.1);
const Eigen::Isometry3d kElbow = pose({0.2, 0.05, 0}, 0.4, {1, 2, 3});
const Eigen::Isometry3d kPlate = pose({0, 0, 0}, kPi / 4, Vector3d::UnitX());

Joint limited(Joint joint, double lower, double upper) {
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

struct Arm {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::shared_ptr<fcl::CollisionObjectd> plate = object(std::make_shared<fcl::Boxd>(2 * kHalf));
  std::shared_ptr<fcl::CollisionObjectd> tip = ball(kBall);
  std::unique_ptr<ArticulatedCollisionManager> manager;
  const Eigen::Isometry3d on_tip = pose({0.14, 0.03, 0.02});

  /// @param further  hangs a third joint on the second one, "elbow" to "tip".
  Arm(Joint first, Joint second, const Joint* further = nullptr) {
    for (const char* link : {"plate", "upper", "elbow", "tip"}) tree->addLink(link);
    first.name = "first", first.parent = "plate", first.child = "upper";
    first.origin = pose({0, -0.25, 0.25});
    second.name = "second", second.parent = "upper", second.child = "elbow";
    second.origin = kElbow;
    tree->addJoint(first);
    tree->addJoint(second);
    tree->addJoint(further ? *further : makeJoint("fixed", JointType::fixed, "elbow", "tip", Vector3d::UnitX()));
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("plate", plate.get(), kPlate);
    manager->bind("tip", tip.get(), on_tip);
    manager->setup();
  }

  /// Distance of the ball from the plate, -1 where they meet.
  double distance(const VectorXd& q) const {
    std::vector<Eigen::Isometry3d> M_0;
    tree->forwardKinematics(q, M_0);
    const Vector3d p = kPlate.inverse() * M_0.back() * on_tip.translation();
    const double d = (p.cwiseAbs() - kHalf).cwiseMax(0).norm() - kBall;
    return d > 0 ? d : -1;
  }
  /// Whether a motion's pair is left out at once.
  bool leftOut(const VectorXd& q0, const VectorXd& q1, double margin = 0) const {
    CertifiedRequest request;
    request.margin = margin;
    return ask(*manager, q0, q1, request).statistics.pairs_after_culling == 0;
  }
  bool leftOut(const VectorXd& q) const { return leftOut(q, q); }
};

Joint turn(double lower, double upper, const Vector3d& axis) {
  return limited(makeJoint("", JointType::revolute, "", "", axis), lower, upper);
}
Joint endless(const Vector3d& axis) {
  return makeJoint("", JointType::continuous, "", "", axis);
}
Joint slide(double lower, double upper, const Vector3d& axis) {
  return limited(makeJoint("", JointType::prismatic, "", "", axis), lower, upper);
}
Joint follower(JointType type, double multiplier, double offset) {
  Joint joint = makeJoint("third", type, "elbow", "tip", Vector3d::UnitY(), pose({0.02, 0, 0.01}));
  joint.mimics = true;
  joint.mimic = {"first", multiplier, offset};
  return joint;
}

const Vector3d kAxis1(0.2, 1, 0.1), kAxis2(0.1, -0.3, 1);

struct Shares {
  double left_out = 0, meets = 0;
};

/// No state whose pair is left out has the ball within the margin; all states are answered as they are.
/// @param range  of both variables.
Shares check(const Arm& arm, const Vector3d& lower, const Vector3d& upper, double margin, int states = 4000) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(0, 1);
  Shares shares;
  const auto draw = [&] {
    VectorXd q(arm.tree->dof());
    for (Eigen::Index v = 0; v < q.size(); ++v) q[v] = lower[v] + u(random) * (upper[v] - lower[v]);
    return q;
  };
  for (int i = 0; i < states; ++i) {
    const VectorXd q = draw();
    const double distance = arm.distance(q);
    const bool left_out = arm.leftOut(q);
    if (left_out) EXPECT_GT(distance, margin) << q.transpose();
    EXPECT_FALSE(arm.leftOut(q, q, margin + 1e-6)) << "another stage left the pair out: the cases say little";
    shares.left_out += 1.0 * left_out / states;
    shares.meets += 1.0 * (distance <= margin) / states;
  }
  int free = 0, open = 0;
  for (int i = 0; i < 300; ++i) {
    const VectorXd q0 = draw(), q1 = q0 + (i % 2 ? 0.2 : 1.0) * (draw() - q0);
    const CertifiedResult result = ask(*arm.manager, q0, q1);
    free += result.isFree();
    open += result.isFree() && result.statistics.pairs_after_culling > 0;
    double least = 1;
    for (int k = 0; k <= 200; ++k) least = std::min(least, arm.distance(q0 + k / 200.0 * (q1 - q0)));
    if (result.isFree()) EXPECT_GT(least, margin) << q0.transpose() << " to " << q1.transpose();
  }
  EXPECT_GT(free, 30);
  std::cout << "left out " << shares.left_out << ", meets " << shares.meets << "; free motions " << free
            << ", of them not by the table " << open << '\n';
  return shares;
}

}  // namespace

TEST(PairTable, TwoTurnsWithLimits) {
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2));
  const Shares shares = check(arm, {-1.5, -2, 0}, {2.5, 1, 0}, 0);
  EXPECT_GT(shares.meets, 0.05);
  EXPECT_GT(shares.left_out, 0.9 * (1 - shares.meets));
}

TEST(PairTable, AtTheLimitsAndBeyond) {
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2));
  int at = 0;
  for (const double q : {-1.5, 2.5}) {
    for (int i = 0; i <= 10; ++i) {
      at += arm.leftOut(Eigen::Vector2d(q, -2 + 0.3 * i));
      EXPECT_FALSE(arm.leftOut(Eigen::Vector2d(q * 1.1, -2 + 0.3 * i)));
      EXPECT_EQ(
          ask(*arm.manager, Eigen::Vector2d(q * 1.1, -2 + 0.3 * i), Eigen::Vector2d(q * 1.1, -2 + 0.3 * i)).isFree(),
          arm.distance(Eigen::Vector2d(q * 1.1, -2 + 0.3 * i)) > 0);
    }
  }
  EXPECT_GT(at, 5);
}

TEST(PairTable, EndlessJointsWrap) {
  const Arm arm(endless(kAxis1), endless(kAxis2));
  const double far = 21 * kPi;
  const Shares shares = check(arm, {-far, -far, 0}, {far, far, 0}, 0);
  EXPECT_GT(shares.meets, 0.05);
  EXPECT_GT(shares.left_out, 0.85 * (1 - shares.meets));
  // Over the seam at pi, and by whole turns.
  int seam = 0;
  for (double q = -3; q < 3; q += 0.1) {
    seam += arm.leftOut(Eigen::Vector2d(kPi - 0.05, q), Eigen::Vector2d(kPi + 0.05, q));
    EXPECT_EQ(arm.leftOut(Eigen::Vector2d(kPi - 0.05, q), Eigen::Vector2d(kPi + 0.05, q)),
              arm.leftOut(Eigen::Vector2d(-kPi - 0.05, q + 2 * kPi), Eigen::Vector2d(-kPi + 0.05, q + 2 * kPi)));
  }
  EXPECT_GT(seam, 5);
  // Joint values as large as they may be.
  for (double q = 0; q < 6.3; q += 0.1) {
    const Eigen::Vector2d x(99990 + q, -99900 - 3 * q);
    if (arm.leftOut(x)) EXPECT_GT(arm.distance(x), 0);
  }
}

TEST(PairTable, MoreThanATurnOfLimitsWraps) {
  const Arm arm(turn(-2 * kPi, 2 * kPi, kAxis1), turn(-2, 1, kAxis2));
  const Shares shares = check(arm, {-2 * kPi, -2, 0}, {2 * kPi, 1, 0}, 0);
  EXPECT_GT(shares.left_out, 0.85 * (1 - shares.meets));
}

TEST(PairTable, ATurnAndASlide) {
  const Arm arm(turn(-1.5, 2.5, kAxis1), slide(-0.05, 0.15, kAxis2));
  const Shares shares = check(arm, {-1.5, -0.05, 0}, {2.5, 0.15, 0}, 0);
  EXPECT_GT(shares.meets, 0.05);
  EXPECT_GT(shares.left_out, 0.9 * (1 - shares.meets));
  const Arm other(slide(-0.1, 0.15, kAxis2), turn(-1.5, 2.5, kAxis1));
  EXPECT_GT(check(other, {-0.1, -1.5, 0}, {0.15, 2.5, 0}, 0).left_out, 0.3);
}

TEST(PairTable, FollowersCountWithTheirMasters) {
  const Joint third = follower(JointType::revolute, -1.5, 0.3), sliding = follower(JointType::prismatic, 0.03, 0.01);
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2), &third);
  const Shares shares = check(arm, {-1.5, -2, 0}, {2.5, 1, 0}, 0);
  EXPECT_GT(shares.meets, 0.05);
  EXPECT_GT(shares.left_out, 0.85 * (1 - shares.meets));
  const Arm slides(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2), &sliding);
  EXPECT_GT(check(slides, {-1.5, -2, 0}, {2.5, 1, 0}, 0).left_out, 0.3);
  // One variable only.
  Joint second = turn(0, 0, kAxis2);
  second.mimics = true;
  second.mimic = {"first", 0.7, -0.2};
  const Arm alone(turn(-1.5, 2.5, kAxis1), second);
  EXPECT_GT(check(alone, {-1.5, 0, 0}, {2.5, 0, 0}, 0).left_out, 0.3);
}

/// An endless joint's follower by half is not where it was after a turn.
TEST(PairTable, AFollowerByHalfDoesNotWrap) {
  const Joint half = follower(JointType::revolute, 0.5, 0), twice = follower(JointType::revolute, 2, 0);
  const Arm arm(endless(kAxis1), turn(-2, 1, kAxis2), &half);
  for (double q = -3; q < 10; q += 0.1) EXPECT_FALSE(arm.leftOut(Eigen::Vector2d(q, 0.3)));
  const Arm wraps(endless(kAxis1), turn(-2, 1, kAxis2), &twice);
  EXPECT_GT(check(wraps, {-9, -2, 0}, {9, 1, 0}, 0).left_out, 0.3);
}

/// A short slide behind two turns, within its limits and beyond them.
TEST(PairTable, AThirdVariableOfLittleEffect) {
  Joint third = makeJoint("third", JointType::prismatic, "elbow", "tip", {0.3, 1, 0.2});
  third = limited(third, 0, 0.03);
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2), &third);
  const Shares shares = check(arm, {-1.5, -2, -0.03}, {2.5, 1, 0.06}, 0);
  EXPECT_GT(shares.meets, 0.05);
  EXPECT_GT(shares.left_out, 0.7 * (1 - shares.meets));
  EXPECT_FALSE(arm.leftOut(Vector3d(0.1, -1.8, 0.07)));
  EXPECT_FALSE(arm.leftOut(Vector3d(0.1, -1.8, -0.04)));
}

TEST(PairTable, ThreeVariablesAreLeftToTheQuery) {
  Joint third = makeJoint("third", JointType::revolute, "elbow", "tip", Vector3d::UnitY());
  const Joint with_limits = limited(third, -1, 1);
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2), &with_limits);
  EXPECT_FALSE(arm.leftOut(Vector3d(0.1, -1.8, 0)));
}

TEST(PairTable, HoldsForThePairsMargin) {
  Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2));
  const Vector3d lower(-1.5, -2, 0), upper(2.5, 1, 0);
  const double before = check(arm, lower, upper, 0).left_out;
  arm.manager->setMargin("plate", "tip", 0.05);
  arm.manager->setup();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0, 1);
  int left_out = 0, near = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d q(-1.5 + 4 * u(random), -2 + 3 * u(random));
    const double distance = arm.distance(q);
    near += distance > 0 && distance <= 0.05;
    if (!arm.leftOut(q)) continue;
    ++left_out;
    EXPECT_GT(distance, 0.05) << q.transpose();
  }
  EXPECT_GT(near, 100);
  EXPECT_GT(left_out, 1000);
  EXPECT_LT(left_out / 4000.0, before);
  arm.manager->resetMargins();
  arm.manager->setup();
  EXPECT_DOUBLE_EQ(check(arm, lower, upper, 0).left_out, before);
}

/// If a request asks for more than the table's margin, the table is not used; least of all by a clearance.
TEST(PairTable, MarginsOfRequestsAreTheirOwn) {
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(0, 1);
  int told = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d q(-1.5 + 4 * u(random), -2 + 3 * u(random));
    const double distance = arm.distance(q);
    if (distance < 0) continue;
    CertifiedRequest request;
    request.margin = distance + 1e-3;
    EXPECT_FALSE(ask(*arm.manager, q, q, request).isFree());
    request.margin = distance - 1e-4;
    if (request.margin > 0) EXPECT_TRUE(ask(*arm.manager, q, q, request).isFree());
    const Clearance clearance = arm.manager->clearance(JointMotion::linear(*arm.tree, q, q));
    EXPECT_LE(clearance.lower, distance + 1e-9);
    EXPECT_GE(clearance.upper, distance - 1e-9);
    ++told;
  }
  EXPECT_GT(told, 50);
}

/// Polynomials of degree 5: a part of the motion is left out only where all of it is in proven cells.
TEST(PairTable, PolynomialsAreBounded) {
  const Arm arm(turn(-1.5, 2.5, kAxis1), turn(-2, 1, kAxis2));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  int free = 0, by_table = 0, meets = 0;
  for (int i = 0; i < 600; ++i) {
    Eigen::MatrixXd c(2, 6);
    for (Eigen::Index k = 0; k < 12; ++k) c(k % 2, k / 2) = u(random) * (k < 2 ? 1 : 0.6);
    const JointMotion motion = JointMotion::polynomial(*arm.tree, c);
    CertifiedResult result;
    arm.manager->continuousCollide(motion, CertifiedRequest(), result);
    double first = 2;
    for (int k = 0; k <= 400 && first > 1; ++k) {
      if (arm.distance(motion.configuration(k / 400.0)) < 0) first = k / 400.0;
    }
    meets += first <= 1;
    EXPECT_LE(result.t_lower, first);
    if (!result.isFree()) continue;
    ++free;
    by_table += result.statistics.pairs_after_culling == 0;
  }
  std::cout << free << " free, by the table " << by_table << ", meets " << meets << '\n';
  EXPECT_GT(by_table, 30);
  EXPECT_GT(meets, 30);
}

/// Random arms, at the very border between free and touching: no state on the wrong side of it is left out, nor a
/// motion that begins there.
TEST(PairTable, NothingAtTheBorderIsLeftOut) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto axis = [&] { return Vector3d(u(random), u(random), u(random)); };
  const Vector3d normal = kPlate.linear().col(2);
  int borders = 0, left_out_before = 0;
  for (int a = 0; a < 40; ++a) {
    const bool straight = a % 2;  // one of the variables takes the ball straight at the plate
    Joint first = a % 4 < 2 ? turn(-2, 2, axis()) : slide(-0.2, 0.2, straight ? normal : axis());
    if (a % 8 == 3) first = slide(-2, 2, normal);
    Joint second = a % 5 ? turn(-2, 2, axis()) : endless(axis());
    Joint third = follower(JointType::revolute, 2 * u(random), u(random));
    third.axis = axis();
    Joint finger = limited(makeJoint("finger", JointType::prismatic, "elbow", "tip", axis()), 0, 0.03);
    bool with_finger = a % 3 == 1;
    if (a % 8 == 6) {  // the finger goes straight at the plate, too
      first = slide(-0.4, 0, normal);
      second.axis = finger.axis = kElbow.linear().transpose() * normal;
      with_finger = true;
    }
    const Arm arm(first, second, with_finger ? &finger : a % 3 == 0 ? &third : nullptr);
    const auto draw = [&] {
      const double x = 0.5 * (1 + u(random));
      VectorXd q(arm.tree->dof());
      q.tail(1)[0] = 0.03 * u(random);
      q.head(2) << std::max(-2.0, first.lower) + x * std::min(4.0, first.upper - first.lower), 2 * u(random);
      return q;
    };
    for (int i = 0; i < 500; ++i) {
      VectorXd touching = draw(), free = draw();
      if (arm.distance(touching) > 0 || arm.distance(free) < 0) continue;
      const VectorXd beyond = free;
      while ((free - touching).norm() > 1e-9) {
        const VectorXd middle = 0.5 * (free + touching);
        (arm.distance(middle) > 0 ? free : touching) = middle;
      }
      ++borders;
      EXPECT_FALSE(arm.leftOut(touching)) << "arm " << a << " at " << touching.transpose();
      left_out_before += arm.leftOut(touching + 0.1 * (beyond - touching).normalized());
      // Away from there by a polynomial.
      Eigen::MatrixXd c = Eigen::MatrixXd::Zero(touching.size(), 6);
      c.col(0) = touching;
      for (int k = 1; k <= 1 + i % 5; ++k) c.col(k) = (k == 1 ? 1 : 0.4 * u(random)) * (beyond - touching);
      CertifiedResult result;
      arm.manager->continuousCollide(JointMotion::polynomial(*arm.tree, c), CertifiedRequest(), result);
      EXPECT_FALSE(result.isFree()) << "arm " << a << " from " << touching.transpose();
    }
  }
  std::cout << borders << " borders, left out a little way off " << left_out_before << '\n';
  EXPECT_GT(borders, 1000);
  EXPECT_GT(left_out_before, 700);
}

namespace {

/// A ball over a disk whose top is the plane z = 0, and which is the robot's base. A cart along the disk takes the ball
/// farthest; then come joints from "cart" to "tip", the ball's centre. The ball never comes near the disk's rim.
struct OverDisk {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("over disk");
  static constexpr double kRadius = 0.0005;
  std::shared_ptr<fcl::CollisionObjectd> disk = object(std::make_shared<fcl::Cylinderd>(7, 0.1));
  std::shared_ptr<fcl::CollisionObjectd> tip = ball(kRadius);
  std::unique_ptr<ArticulatedCollisionManager> manager;

  OverDisk(const std::vector<std::string>& links, const std::vector<Joint>& joints) {
    for (const char* link : {"disk", "cart"}) tree->addLink(link);
    for (const std::string& link : links) tree->addLink(link);
    tree->addJoint(limited(makeJoint("rail", JointType::prismatic, "disk", "cart", Vector3d::UnitY()), -5.5, 5.5));
    for (const Joint& joint : joints) tree->addJoint(joint);
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    manager->bind("disk", disk.get(), pose({0, 0, -0.05}));
    manager->bind("tip", tip.get());
    manager->setup();
  }
  /// How deep the ball is in the disk; below 0 where it is not.
  double depth(const VectorXd& q) const { return kRadius - tree->linkPose(tree->linkId("tip"), q).translation().z(); }
};

/// Short motions, in both modes: none that begins with the ball deep in the disk is free.
/// @param states  draws one.
template <class Draw>
void expectNoneFreeInTheDisk(const OverDisk& arm, int states, const Draw& draw) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> u(-1, 1);
  int deep = 0, wrong = 0, shallow_free = 0;
  double deepest = 0;
  for (int i = 0; i < states; ++i) {
    const VectorXd q = draw(random);
    const double depth = arm.depth(q);
    const VectorXd to = q + 1e-4 * VectorXd::NullaryExpr(q.size(), [&] { return u(random); });
    for (const ContactMode mode : {ContactMode::first, ContactMode::any}) {
      CertifiedRequest request;
      request.mode = mode;
      const CertifiedResult result = ask(*arm.manager, q, to, request);
      if (depth > 1e-9) EXPECT_EQ(result.status, Status::contact) << "depth " << depth << " at " << q.transpose();
      wrong += depth > 1e-9 && result.isFree();
      if (depth > 1e-9 && result.isFree()) deepest = std::max(deepest, depth);
      shallow_free += depth < 0 && depth > -0.03 && result.isFree();
    }
    deep += depth > 0.003 && depth < 0.0095;
  }
  std::cout << deep << " states 3 to 9.5 mm deep; free though in the disk: " << wrong << ", up to " << deepest << " m; "
            << shallow_free << " free within 30 mm\n";
  EXPECT_GT(deep, states / 50);
  EXPECT_GT(shallow_free, states / 50);
}

}  // namespace

/// The lever of a turn grows along the slide that it carries. With a third variable the table goes as far beyond the
/// slide's limits as its range is wide, and rows have to pay for the lever there.
TEST(PairTable, ATurnsLeverReachesAsFarAsTheSlideAfterIt) {
  // Little is left over of the margin that rows pay for a turn if the rows are wide. So its joint has wide limits, and
  // a follower's multiplier keeps the cells from being one turn.
  Joint drive = limited(makeJoint("drive", JointType::revolute, "disk", "wheel", Vector3d::UnitX()), -100, 100);
  Joint follower = makeJoint("turn", JointType::revolute, "cart", "arm", Vector3d::UnitY(), pose({0, 0, 0.0575}));
  follower.mimics = true;
  follower.mimic = {"drive", 1.5, 0};
  const OverDisk arm(
      {"wheel", "arm", "tip"},
      {drive, follower,
       limited(makeJoint("finger", JointType::prismatic, "arm", "tip", Vector3d::UnitX()), -0.029, 0.029)});
  ASSERT_EQ(arm.tree->dof(), 3);
  expectNoneFreeInTheDisk(arm, 8000, [](std::mt19937& random) {
    std::uniform_real_distribution<double> u(-1, 1);
    return VectorXd(Vector3d(5 * u(random), 99 * u(random), (u(random) > 0 ? 1 : -1) * (0.0725 + 0.0135 * u(random))));
  });
}

/// A third variable that turns the link and then slides it: its own lever grows with its value.
TEST(PairTable, AThirdVariablesOwnLeverHoldsBeyondItsLimits) {
  Joint spin = makeJoint("spin", JointType::revolute, "cross", "arm", Vector3d::UnitY(), pose({0, 0, 0.0242}));
  spin.mimics = true;
  spin.mimic = {"finger", 100, -2.854};
  const OverDisk arm(
      {"cross", "arm", "tip"},
      {limited(makeJoint("cross", JointType::prismatic, "cart", "cross", Vector3d::UnitX()), -0.05, 0.05),
       limited(makeJoint("finger", JointType::prismatic, "arm", "tip", Vector3d::UnitX()), -0.0125, 0.0125), spin});
  ASSERT_EQ(arm.tree->dof(), 3);
  expectNoneFreeInTheDisk(arm, 8000, [](std::mt19937& random) {
    std::uniform_real_distribution<double> u(-1, 1);
    return VectorXd(Vector3d(5 * u(random), 0.05 * u(random), (u(random) > 0 ? 1 : -1) * (0.03 + 0.0074 * u(random))));
  });
}

}  // namespace pair_table_test
