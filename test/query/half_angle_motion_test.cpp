// SPDX-License-Identifier: BSD-3-Clause
//
// Motions whose angles go by the tangent of their half: their values, who refuses them, and that no query misses a
// contact on them. FCL's static checks along the way and polylines next to it are the judges.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/narrowphase/collision.h>

#include "arms.h"
#include "fcl_artic/fcl_link_motion.h"
#include "fcl_artic/visibility.h"

namespace fcl_artic {
namespace half_angle_motion_test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using test::makeJoint;
using test::object;
using test::pose;

constexpr double kPi = 3.14159265358979323846;

VectorXd vector(std::initializer_list<double> values) {
  VectorXd q(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), q.data());
  return q;
}

/// A turn about z, a slide on it, and a turn that mimics the first.
std::shared_ptr<KinematicTree> mixedTree() {
  auto tree = std::make_shared<KinematicTree>("mixed");
  for (const char* link : {"base", "a", "b", "c"}) tree->addLink(link);
  tree->addJoint(makeJoint("turn", JointType::revolute, "base", "a", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("slide", JointType::prismatic, "a", "b", Vector3d::UnitX(), pose({0.3, 0, 0})));
  Joint mimic = makeJoint("half", JointType::revolute, "b", "c", Vector3d::UnitY(), pose({0.3, 0, 0}));
  mimic.mimics = true;
  mimic.mimic = {"turn", -0.5, 0.25};
  tree->addJoint(mimic);
  return tree;
}

TEST(TangentHalfAngle, AnglesGoByTheTangentOfTheirHalfAndSlidesStraight) {
  const auto tree = mixedTree();
  const JointMotion motion = JointMotion::tangentHalfAngle(*tree, vector({-0.5, 0.1}), vector({2.5, 0.5}));
  EXPECT_FALSE(motion.isPolynomial());
  EXPECT_GE(motion.degree(), 2);
  EXPECT_NEAR(motion.configuration(0)[0], -0.5, 1e-15);
  EXPECT_NEAR(motion.configuration(1)[0], 2.5, 1e-15);
  const double s = 0.75 * std::tan(-0.25) + 0.25 * std::tan(1.25);
  EXPECT_NEAR(motion.configuration(0.25)[0], 2 * std::atan(s), 1e-15);
  EXPECT_NEAR(motion.configuration(0.25)[1], 0.2, 1e-15);

  const VectorXd reference = vector({2, 77});  // a slide's is not looked at
  const JointMotion about = JointMotion::tangentHalfAngle(*tree, vector({-0.5, 0.1}), vector({4.5, 0.5}), reference);
  EXPECT_NEAR(about.configuration(0)[0], -0.5, 1e-14);
  EXPECT_NEAR(about.configuration(1)[0], 4.5, 1e-14);
  EXPECT_NEAR(about.configuration(0.5)[0], 2, 1e-14) << "as far from the reference on either side";

  Eigen::MatrixXd coefficients(2, 4);
  coefficients << 0.5, 0, -1, 2, 0.1, 0.2, 0, 0.3;
  const JointMotion cubic = JointMotion::tangentHalfAnglePolynomial(*tree, coefficients);
  EXPECT_NEAR(cubic.configuration(0.5)[0], 2 * std::atan(0.5), 1e-15);
  EXPECT_NEAR(cubic.configuration(0.5)[1], 0.1 + 0.1 + 0.3 / 8, 1e-15);
  EXPECT_EQ(cubic.coefficients(), coefficients);
}

TEST(TangentHalfAngle, WhatCannotBeSaidIsRefused) {
  const auto tree = mixedTree();
  const auto make = [&](const VectorXd& q0, const VectorXd& q1, const VectorXd& reference = {}) {
    return JointMotion::tangentHalfAngle(*tree, q0, q1, reference);
  };
  const VectorXd q = vector({0, 0});
  EXPECT_THROW(make(q, vector({kPi, 0})), std::invalid_argument);
  EXPECT_THROW(make(q, vector({kPi - 1e-6, 0})), std::invalid_argument);
  EXPECT_NO_THROW(make(q, vector({kPi - 3e-5, 0})));
  EXPECT_THROW(make(vector({-3.3, 0}), q), std::invalid_argument);
  EXPECT_NO_THROW(make(vector({-3.3, 0}), q, vector({-1, 0})));
  EXPECT_THROW(make(q, q, vector({1})), std::invalid_argument);
  EXPECT_THROW(make(q, q, vector({std::numeric_limits<double>::quiet_NaN(), 0})), std::invalid_argument);
  Eigen::MatrixXd large(2, 2);
  large << 6e4, -1.2e5, 0, 0;
  EXPECT_THROW(JointMotion::tangentHalfAnglePolynomial(*tree, large), std::invalid_argument);

  const JointMotion motion = make(q, vector({1, 0.1}));
  EXPECT_THROW((void)motion.dq(), std::invalid_argument);
  EXPECT_THROW(FclLinkMotion(*tree, motion, 1), std::invalid_argument) << "FCL's bounds are of constant speeds";
}

/// A rod of length 1 that turns from -60 to 150 degrees meets a small ball at 90: the time is that of its tangent.
TEST(TangentHalfAngle, ARodMeetsABallAtTheTimeOfItsTangent) {
  auto tree = std::make_shared<KinematicTree>("rod");
  tree->addLink("base");
  tree->addLink("rod");
  tree->addJoint(makeJoint("turn", JointType::continuous, "base", "rod", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  const auto rod = test::ball(0.1);
  manager.bind("rod", rod.get(), pose({1, 0, 0}));
  const auto ball = test::ball(0.05, {0, 1, 0});
  manager.registerObject(ball.get());
  manager.setup();
  const double q0 = -kPi / 3, q1 = kPi * 5 / 6, q = kPi / 2 - 2 * std::asin(0.15 / 2);  // chord of 0.15
  const auto s = [](double angle) { return std::tan(angle / 2); };
  const double t = (s(q) - s(q0)) / (s(q1) - s(q0));
  const JointMotion motion = JointMotion::tangentHalfAngle(*tree, vector({q0}), vector({q1}));
  for (const Method method : {Method::standard, Method::redon2004}) {
    CertifiedRequest request;
    request.method = method;
    request.tolerance_time = 1e-9;
    const CertifiedResult result = manager.continuousCollide(motion, request);
    ASSERT_EQ(result.status, Status::contact);
    EXPECT_TRUE(result.certain);
    EXPECT_LE(result.t_lower, t + 1e-12);
    EXPECT_GE(result.t_upper, t - 1e-12);
    EXPECT_LE(result.t_upper - result.t_lower, 2e-9);
  }
  // With the pose at t = 0 a trajectory's second piece.
  const JointTrajectory trajectory =
      JointTrajectory::tangentHalfAngle(*tree, {0, 2, 4}, {vector({-2.0}), vector({q0}), vector({q1})});
  const CertifiedResult along = manager.continuousCollide(trajectory, {});
  ASSERT_EQ(along.status, Status::contact);
  EXPECT_LE(along.t_lower, 2 + 2 * t + 1e-9);
  EXPECT_GE(along.t_upper, 2 + 2 * t - 1e-9);
  EXPECT_LE(along.t_upper - along.t_lower, 1e-5);
}

TEST(TangentHalfAngle, ACertificateSaysThatItCannotStateTheLaw) {
  const auto tree = mixedTree();
  ArticulatedCollisionManager manager(tree);
  const auto ball = test::ball(0.1), far = test::ball(0.1, {5, 0, 0});
  manager.bind("b", ball.get());
  manager.registerObject(far.get());
  manager.setup();
  CertifiedRequest request;
  request.certificate = true;
  const JointMotion motion = JointMotion::tangentHalfAngle(*tree, vector({0, 0}), vector({1, 0.1}));
  const CertifiedResult result = manager.continuousCollide(motion, request);
  EXPECT_TRUE(result.isFree());
  ASSERT_NE(result.certificate, nullptr);
  EXPECT_FALSE(*result.certificate);
  EXPECT_NE(result.certificate->missing.find("half-angle"), std::string::npos);
  EXPECT_TRUE(result.certificate->proof.empty());
  EXPECT_TRUE(
      *manager.continuousCollide(JointMotion::linear(*tree, vector({0, 0}), vector({1, 0.1})), request).certificate);
}

/// Boxes, capsules and balls; all twice, once smaller and once larger by kSkin, for FCL's static checks.
constexpr double kSkin = 2e-5;

class Bodies {
 public:
  explicit Bodies(std::mt19937_64& random) : random_(random) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  Vector3d direction() {
    for (;;) {
      const Vector3d v(in(-1, 1), in(-1, 1), in(-1, 1));
      if (v.norm() > 0.2 && v.norm() < 1) return v.normalized();
    }
  }
  /// @param sizes  the body, a smaller and a larger one.
  void make(double size, std::array<std::shared_ptr<fcl::CollisionGeometryd>, 3>& sizes) {
    const int kind = below(3);
    const Vector3d side(in(0.3, 1) * size, in(0.3, 1) * size, in(0.3, 1) * size);
    const double radius = 0.5 * size * in(0.3, 1), length = size * in(0.5, 1);
    for (int i = 0; i < 3; ++i) {
      const double skin = i == 0 ? 0 : i == 1 ? -kSkin : kSkin;
      if (kind == 0) sizes[i] = std::make_shared<fcl::Boxd>(side + Vector3d::Constant(2 * skin));
      if (kind == 1) sizes[i] = std::make_shared<fcl::Sphered>(radius + skin);
      if (kind == 2) sizes[i] = std::make_shared<fcl::Capsuled>(radius + skin, length);
    }
  }

 private:
  std::mt19937_64& random_;
};

/// A random robot amid obstacles.
struct World {
  using Sizes = std::array<std::shared_ptr<fcl::CollisionGeometryd>, 3>;
  struct Link {
    LinkId id;
    Sizes sizes;
    std::shared_ptr<fcl::CollisionObjectd> object;
  };
  struct Obstacle {
    Sizes sizes;
    std::shared_ptr<fcl::CollisionObjectd> object;
  };
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("random");
  std::vector<Link> links;
  std::vector<Obstacle> obstacles;
  std::unique_ptr<ArticulatedCollisionManager> manager;
  std::vector<std::pair<LinkId, LinkId>> pairs;
  VectorXd q0, q1, reference;
  double reach = 0.3;  ///< no point is farther from any joint

  /// @param turn  angles are within this of their references, rad.
  World(std::mt19937_64& random, double turn) {
    Bodies bodies(random);
    const int n = 2 + bodies.below(6);
    tree->addLink("link0");
    for (int i = 1; i <= n; ++i) {
      const std::string name = "link" + std::to_string(i), before = "link" + std::to_string(i - 1);
      tree->addLink(name);
      const int kind = bodies.below(10);
      const JointType type = kind < 6 ? JointType::revolute : kind < 8 ? JointType::continuous : JointType::prismatic;
      Joint joint = makeJoint("joint" + std::to_string(i), type, before, name, bodies.direction(),
                              pose(0.3 * bodies.direction(), bodies.in(-3, 3), bodies.direction()));
      if (type != JointType::continuous) {
        joint.lower = type == JointType::revolute ? -3.1 : -0.3;
        joint.upper = -joint.lower;
      }
      if (i > 1 && !tree->joint(0).mimics && tree->joint(0).type != JointType::prismatic && bodies.below(5) == 0) {
        joint.mimics = true;
        joint.mimic = {"joint1", bodies.in(-1, 1), bodies.in(-0.5, 0.5)};
        if (type == JointType::prismatic) joint.mimic.multiplier *= 0.1;
      }
      tree->addJoint(joint);
      reach += 0.3 + 0.35;
    }
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    for (LinkId i = 0; i <= n; ++i) {
      Link link{i, {}, nullptr};
      bodies.make(0.14, link.sizes);
      link.object = object(link.sizes[0]);
      manager->bind(i, link.object.get());
      links.push_back(link);
    }
    for (int i = bodies.below(9); i > 0; --i) {
      Obstacle obstacle;
      bodies.make(0.3, obstacle.sizes);
      obstacle.object =
          object(obstacle.sizes[0], pose(bodies.in(0.2, 1) * bodies.direction(), bodies.in(-3, 3), bodies.direction()));
      manager->registerObject(obstacle.object.get());
      obstacles.push_back(obstacle);
    }
    manager->setup();
    for (const auto& [a, b] : manager->checkedLinkPairs()) pairs.emplace_back(tree->linkId(a), tree->linkId(b));

    const int dof = tree->dof();
    q0.resize(dof);
    q1.resize(dof);
    reference.resize(dof);
    const double step = bodies.below(4) == 0 ? 0.6 : 3;
    for (int v = 0; v < dof; ++v) {
      const bool angle = tree->isAngle(v);
      reference[v] = angle && bodies.below(2) ? bodies.in(-1, 1) : 0;
      const double most = angle ? turn : 0.3;
      q0[v] = reference[v] + bodies.in(-most, most);
      q1[v] = std::clamp(q0[v] + bodies.in(-step, step) * (angle ? 1 : 0.1), reference[v] - most, reference[v] + most);
    }
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  JointMotion motion() const { return JointMotion::tangentHalfAngle(*tree, q0, q1, reference); }

  /// A bound on any point's distance from the polyline of n chords of the motion, to the first order, taken twice. An
  /// angle has |q''| of at most 1.3 s'^2, and a chord leaves the arc by an eighth of it times 1/n^2.
  double leavesPolyline(int n) const {
    double sum = 0;
    for (int v = 0; v < tree->dof(); ++v) {
      if (!tree->isAngle(v)) continue;
      const double rate = std::tan((q1[v] - reference[v]) / 2) - std::tan((q0[v] - reference[v]) / 2);
      double weight = 0;  // of all joints that it drives
      for (JointId j = 0; j < tree->numJoints(); ++j) {
        if (tree->jointVariable(j) != v) continue;
        weight += tree->joint(j).mimics ? std::abs(tree->joint(j).mimic.multiplier) : 1;
      }
      sum += weight * 1.3 * rate * rate / 8 / (n * n);
    }
    return 2 * reach * sum;
  }

  /// @param size  1: of the smaller bodies, 2: of the larger ones.
  bool collides(const VectorXd& q, std::size_t size, bool scene, bool self) const {
    std::vector<Eigen::Isometry3d> M_0;
    tree->forwardKinematics(q, M_0);
    const fcl::CollisionRequestd request;
    const auto meet = [&](const Sizes& a, const Eigen::Isometry3d& A, const Sizes& b, const Eigen::Isometry3d& B) {
      fcl::CollisionResultd result;
      return fcl::collide(a[size].get(), A, b[size].get(), B, request, result) > 0;
    };
    if (scene) {
      for (const Link& link : links) {
        for (const Obstacle& obstacle : obstacles) {
          if (meet(link.sizes, M_0[static_cast<std::size_t>(link.id)], obstacle.sizes, obstacle.object->getTransform()))
            return true;
        }
      }
    }
    if (self) {
      for (const auto& [a, b] : pairs) {
        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
        if (meet(links[i].sizes, M_0[i], links[j].sizes, M_0[j])) return true;
      }
    }
    return false;
  }
};

CertifiedRequest requestOf(ContactMode mode, Method method = Method::standard) {
  CertifiedRequest request;
  request.mode = mode;
  request.method = method;
  return request;
}

/// All ways of asking against FCL's static checks of 129 poses: none misses a contact, and none is late. If contact is
/// proven, the bodies are in contact, up to their skin.
TEST(TangentHalfAngle, NoQueryMissesWhatFclFindsAlongTheLaw) {
  std::mt19937_64 random(7);
  constexpr int kSamples = 128, kWorlds = 400;
  int hits = 0, free = 0, missed = 0, late = 0, untrue = 0, uncertain = 0, sampled = 0, disagree = 0;
  for (int i = 0; i < kWorlds; ++i) {
    World world(random, i % 8 == 5 ? 3.1 : 2.5);
    if (i % 4 == 0) world.manager->setLinkPairProofs(world.manager->classifyLinkPairs().proofs), world.manager->setup();
    if (world.collides(world.q0, 2, true, true)) {
      --i;
      continue;
    }
    const JointMotion motion = world.motion();
    double first = 2;  // sample in contact
    for (int k = 0; k <= kSamples && first > 1; ++k) {
      const double t = static_cast<double>(k) / kSamples;
      if (world.collides(motion.configuration(t), 1, true, true)) first = t;
    }
    sampled += first <= 1;
    std::vector<CertifiedRequest> ways = {requestOf(ContactMode::first), requestOf(ContactMode::any),
                                          requestOf(ContactMode::firstOfEveryPair)};
    if (i % 8 == 0) ways.push_back(requestOf(ContactMode::first, Method::redon2004));
    bool any_free = false, any_contact = false;
    for (const CertifiedRequest& request : ways) {
      const CertifiedResult result = world.manager->continuousCollide(motion, request);
      ASSERT_NE(result.status, Status::undecided);
      (result.isFree() ? any_free : any_contact) = true;
      missed += result.isFree() && first <= 1;
      if (result.status != Status::contact) continue;
      uncertain += !result.certain;
      late += result.t_lower > first + 1e-12;
      if (result.certain) untrue += !world.collides(motion.configuration(result.t_upper), 2, true, true);
    }
    disagree += any_free && any_contact;
    hits += any_contact;
    free += any_free;
    ASSERT_EQ(missed + late + untrue + disagree, 0) << "world " << i;
  }
  std::printf("%d worlds: %d in contact (%d by samples), %d free; missed %d, late %d, untrue %d, uncertain %d\n",
              kWorlds, hits, sampled, free, missed, late, untrue, uncertain);
  EXPECT_GT(hits, kWorlds / 5);
  EXPECT_GT(free, kWorlds / 5);
}

/// If the motion is free with a margin that pays for the chords, the chords are free, and the other way round; contact
/// likewise.
TEST(TangentHalfAngle, AFinePolylineNextToItSaysTheSame) {
  std::mt19937_64 random(11);
  constexpr int kPieces = 200, kWorlds = 60;
  int free = 0, contact = 0, close = 0;
  for (int i = 0; i < kWorlds; ++i) {
    World world(random, 2);
    if (world.collides(world.q0, 2, true, true)) {
      --i;
      continue;
    }
    const JointMotion motion = world.motion();
    const double leaves = world.leavesPolyline(kPieces);
    std::vector<double> times;
    std::vector<VectorXd> way;
    for (int k = 0; k <= kPieces; ++k) {
      times.push_back(static_cast<double>(k) / kPieces);
      way.push_back(motion.configuration(times.back()));
    }
    const JointTrajectory polyline = JointTrajectory::linear(*world.tree, times, way);
    CertifiedRequest exact, wide;
    wide.margin = leaves;
    const CertifiedResult own = world.manager->continuousCollide(motion, exact);
    const CertifiedResult own_wide = world.manager->continuousCollide(motion, wide);
    const CertifiedResult line = world.manager->continuousCollide(polyline, exact);
    const CertifiedResult line_wide = world.manager->continuousCollide(polyline, wide);
    if (own_wide.isFree()) EXPECT_TRUE(line.isFree()) << i;
    if (line_wide.isFree()) EXPECT_TRUE(own.isFree()) << i;
    // Contact of the one at a time is contact of the other, with the margin, no later.
    if (own.status == Status::contact && own.certain) {
      EXPECT_FALSE(line_wide.isFree()) << i;
      EXPECT_LE(line_wide.t_lower, own.t_upper + 1e-9) << i;
    }
    if (line.status == Status::contact && line.certain) {
      EXPECT_FALSE(own_wide.isFree()) << i;
      EXPECT_LE(own_wide.t_lower, line.t_upper + 1e-9) << i;
    }
    free += own.isFree();
    contact += !own.isFree();
    close += own.isFree() != own_wide.isFree();
  }
  std::printf("%d worlds: %d free, %d in contact, %d nearer than what chords cut off\n", kWorlds, free, contact, close);
  EXPECT_GT(free, kWorlds / 6);
  EXPECT_GT(contact, kWorlds / 6);
}

TEST(TangentHalfAngle, ClearanceTrajectoriesBatchesAndVisibilityAgreeWithTheQuery) {
  std::mt19937_64 random(13);
  int free = 0, contact = 0;
  for (int i = 0; i < 60; ++i) {
    World world(random, 2.8);
    const JointMotion motion = world.motion();
    const CertifiedResult one = world.manager->continuousCollide(motion, CertifiedRequest());
    free += one.isFree();
    contact += one.status == Status::contact;
    std::vector<CertifiedResult> many;
    world.manager->continuousCollide(std::vector<JointMotion>(3, motion), CertifiedRequest(), many);
    for (const CertifiedResult& result : many) {
      EXPECT_EQ(result.status, one.status);
      EXPECT_EQ(result.t_lower, one.t_lower);
    }
    CertifiedRequest seen;
    seen.visibility = VisibilityMode::on;
    const CertifiedResult culled = world.manager->continuousCollide(motion, seen);
    EXPECT_EQ(culled.status, one.status) << i;
    const JointTrajectory along =
        JointTrajectory::tangentHalfAngle(*world.tree, {0, 1}, {world.q0, world.q1}, world.reference);
    EXPECT_EQ(world.manager->continuousCollide(along, CertifiedRequest()).status, one.status) << i;
    const Clearance clearance = world.manager->clearance(motion);
    if (!one.isFree() && one.certain) EXPECT_EQ(clearance.lower, 0) << i;
    if (one.isFree() && clearance.lower > 0) {
      CertifiedRequest within;
      within.margin = 0.999 * clearance.lower;
      EXPECT_TRUE(world.manager->continuousCollide(motion, within).isFree()) << i;
    }
  }
  std::printf("%d free, %d in contact\n", free, contact);
  EXPECT_GT(free, 5);
  EXPECT_GT(contact, 5);
}

}  // namespace
}  // namespace half_angle_motion_test
}  // namespace fcl_artic
