// SPDX-License-Identifier: BSD-3-Clause
//
// A query that throws leaves nothing of the previous answer: no `free`, no time, no contact. This holds with every kind
// of bad input, and if callers' own code throws in the midst of it.
#include <cmath>
#include <functional>
#include <limits>

#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "arms.h"
#include "fcl_artic/bounded_motion.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/continuous_manager.h"
#include "meshes.h"

namespace throwing_query_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Moving = fcl::ContinuousCollisionObjectd;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Comes from (3, y, 0) across to (-1, y + 4, 0), until it throws.
struct Moody : fcl::MotionBased, BoundedMotion {
  bool integrate(double) const override { return true; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
  void getCurrentTransform(fcl::Transform3d& M) const override { M.setIdentity(); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
  State state(double t) const override {
    if (throws) throw std::runtime_error("not today");
    State s;
    s.pose.translation() = Vector3d(3 - 4 * t, y + 4 * t, 0);
    s.velocity = {-4, 4, 0};
    return s;
  }
  Bounds bounds(double, double) const override {
    Bounds b;
    b.speed = 6;
    return b;
  }
  bool throws = false;
  double y = 0;
};

struct Thrown {};

CertifiedRequest badTolerance() {
  CertifiedRequest request;
  request.tolerance_time = kNaN;
  return request;
}
CertifiedRequest badMargin() {
  CertifiedRequest request;
  request.margin = -1;
  return request;
}
CertifiedRequest badLevel() {
  CertifiedRequest request;
  request.redon.refinement_level = 9;
  return request;
}
CertifiedRequest throwingProgress() {
  CertifiedRequest request;
  request.progress = [](double) -> bool { throw Thrown(); };
  return request;
}

testing::AssertionResult claimsNothing(const CertifiedResult& r, double begin = 0, double end = 1) {
  if (r.status != Status::undecided) return testing::AssertionFailure() << "it has a verdict";
  if (r.t_lower != begin || r.t_upper != end || r.certain) {
    return testing::AssertionFailure() << "it has times: " << r.t_lower << " to " << r.t_upper;
  }
  if (!r.contacts.empty() || !r.M_0_at_lower.empty() || !r.ignored_initial_contacts.empty()) {
    return testing::AssertionFailure() << "it has contacts, poses or pairs";
  }
  if (r.statistics.pairs != 0 || r.statistics.leaf_tests != 0 || !r.statistics.visibility_executor.empty()) {
    return testing::AssertionFailure() << "it has statistics";
  }
  return testing::AssertionSuccess();
}

testing::AssertionResult claimsNothing(const CertifiedPairsResult& r) {
  if (r.status != Status::undecided || r.t_lower != 0 || r.t_upper != 1 || r.certain || !r.pairs.empty() ||
      !r.ignored_initial_contacts.empty() || r.statistics.pairs != 0) {
    return testing::AssertionFailure() << "it claims something: t_lower " << r.t_lower << ", t_upper " << r.t_upper
                                       << ", " << r.pairs.size() << " pairs";
  }
  return testing::AssertionSuccess();
}

template <class F>
bool throwsAnything(F&& f) {
  try {
    f();
  } catch (...) {
    return true;
  }
  return false;
}

/// A cart before a wall, and a ball that flies by 0.7 m from the cart at x = 0: near enough that it has to be asked.
struct Yard {
  Cart cart;
  std::shared_ptr<fcl::CollisionObjectd> wall = object(std::make_shared<fcl::Boxd>(1, 1, 1), pose({1, 0, 0}));
  std::shared_ptr<Moody> moody = std::make_shared<Moody>();
  Moving flies{std::make_shared<fcl::Sphered>(0.1), moody};
  ArticulatedCollisionManager& manager = *cart.manager;
  Yard() {
    moody->y = -2;
    manager.registerObject(wall.get(), "wall");
    manager.registerObject(&flies, "ball");
    manager.setup();
  }
  JointMotion motion(double from, double to) const {
    return JointMotion::linear(*cart.tree, VectorXd::Constant(1, from), VectorXd::Constant(1, to));
  }
  JointTrajectory trajectory(double from, double to) const {
    return JointTrajectory::linear(
        *cart.tree, {-5, -4, -2},
        {VectorXd::Constant(1, from), VectorXd::Constant(1, 0.5 * (from + to)), VectorXd::Constant(1, to)});
  }
  /// A result that says free, one that says contact, and one with an ignored pair.
  std::vector<CertifiedResult> usedResults() const {
    std::vector<CertifiedResult> used(3);
    manager.continuousCollide(motion(0, 0.3), {}, used[0]);
    manager.continuousCollide(motion(0, 1), {}, used[1]);
    CertifiedRequest ignoring;
    ignoring.ignore_initial_contact = true;
    manager.continuousCollide(motion(0.6, 0), ignoring, used[2]);
    EXPECT_TRUE(used[0].isFree());
    EXPECT_EQ(used[1].contacts.size(), 1u);
    EXPECT_EQ(used[2].ignored_initial_contacts.size(), 1u);
    EXPECT_TRUE(used[2].isFree());
    return used;
  }
};

/// Runs a query that throws into each of the used results.
void expectNothingLeft(const Yard& yard, const char* what, const std::function<void(CertifiedResult&)>& query,
                       double begin = 0, double end = 1) {
  const bool threw_before = yard.moody->throws;
  yard.moody->throws = false;
  std::vector<CertifiedResult> used = yard.usedResults();
  yard.moody->throws = threw_before;
  for (CertifiedResult& result : used) {
    EXPECT_TRUE(throwsAnything([&] { query(result); })) << what;
    EXPECT_TRUE(claimsNothing(result, begin, end)) << what;
  }
}

std::shared_ptr<KinematicTree> otherTree() {
  auto tree = std::make_shared<KinematicTree>("other");
  tree->addLink("base");
  tree->addLink("tip");
  tree->addJoint(makeJoint("turn", JointType::revolute, "base", "tip", Vector3d::UnitZ()));
  return tree;
}

}  // namespace

TEST(ThrowingQuery, MotionLeavesNothing) {
  Yard yard;
  const JointMotion motion = yard.motion(0, 0.2);
  const JointMotion strange = JointMotion::linear(*otherTree(), VectorXd::Zero(1), VectorXd::Ones(1));
  const auto with = [&](const CertifiedRequest& request) {
    return [&yard, &motion, request](CertifiedResult& r) { yard.manager.continuousCollide(motion, request, r); };
  };
  expectNothingLeft(yard, "tolerance", with(badTolerance()));
  expectNothingLeft(yard, "margin", with(badMargin()));
  expectNothingLeft(yard, "level", with(badLevel()));
  expectNothingLeft(yard, "another tree's",
                    [&](CertifiedResult& r) { yard.manager.continuousCollide(strange, {}, r); });
  yard.moody->throws = true;
  expectNothingLeft(yard, "an obstacle's motion", with({}));
}

TEST(ThrowingQuery, ManagerThatIsNotSetUpLeavesNothing) {
  Yard yard;
  std::vector<CertifiedResult> used = yard.usedResults();
  std::vector<CertifiedResult> many = used;
  yard.manager.unregisterObject(yard.wall.get());
  for (CertifiedResult& result : used) {
    EXPECT_THROW(yard.manager.continuousCollide(yard.motion(0, 0.2), {}, result), std::logic_error);
    EXPECT_TRUE(claimsNothing(result));
  }
  EXPECT_THROW(yard.manager.continuousCollide({yard.motion(0, 0.2)}, {}, many), std::logic_error);
  for (const CertifiedResult& result : many) EXPECT_TRUE(claimsNothing(result));
}

// A crank that grazes posts for long, so that there is progress to tell.
TEST(ThrowingQuery, ProgressThatThrowsLeavesNothing) {
  const Yard yard;
  auto tree = std::make_shared<KinematicTree>("crank");
  tree->addLink("base");
  tree->addLink("arm");
  tree->addJoint(makeJoint("turn", JointType::continuous, "base", "arm", Vector3d::UnitZ()));
  const auto arm = object(cubeMesh(0.5));
  ArticulatedCollisionManager crank(tree);
  crank.bind("arm", arm.get());
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> posts;
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.5236 * i;
    posts.push_back(object(cubeMesh(0.1), pose({0.808 * std::cos(angle), 0.808 * std::sin(angle), 0.6001})));
    crank.registerObject(posts.back().get());
  }
  crank.setup();
  const VectorXd begin = VectorXd::Zero(1), end = VectorXd::Constant(1, 300.0);
  const JointMotion motion = JointMotion::linear(*tree, begin, end);
  int calls = 0;
  CertifiedResult looked_at = yard.usedResults()[0];
  CertifiedRequest looking;
  looking.progress = [&](double) {
    ++calls;
    EXPECT_EQ(looked_at.status, Status::undecided) << "while the query runs";
    EXPECT_EQ(looked_at.t_lower, 0);
    return true;
  };
  crank.continuousCollide(motion, looking, looked_at);
  EXPECT_GT(calls, 0);
  EXPECT_TRUE(looked_at.isFree());
  expectNothingLeft(yard, "progress",
                    [&](CertifiedResult& r) { crank.continuousCollide(motion, throwingProgress(), r); });
  const JointTrajectory trajectory = JointTrajectory::linear(*tree, {-5, -4, -2}, {begin, begin, end});
  expectNothingLeft(
      yard, "progress of a trajectory",
      [&](CertifiedResult& r) { crank.continuousCollide(trajectory, throwingProgress(), r); }, -5, -2);
  expectNothingLeft(yard, "progress by the paper's method", [&](CertifiedResult& r) {
    CertifiedRequest request = throwingProgress();
    request.method = Method::redon2004;
    crank.continuousCollide(motion, request, r);
  });
}

TEST(ThrowingQuery, ConfigurationLeavesNothing) {
  Yard yard;
  const auto at = [&](const VectorXd& q) { return [&yard, q](CertifiedResult& r) { yard.manager.collide(q, {}, r); }; };
  expectNothingLeft(yard, "size", at(VectorXd::Zero(2)));
  expectNothingLeft(yard, "no number", at(VectorXd::Constant(1, kNaN)));
  expectNothingLeft(yard, "beyond 1e5", at(VectorXd::Constant(1, 1e6)));
  expectNothingLeft(yard, "tolerance",
                    [&](CertifiedResult& r) { yard.manager.collide(VectorXd::Zero(1), badTolerance(), r); });
}

// The times of what claims nothing are the trajectory's own: 0 would be later than its beginning here.
TEST(ThrowingQuery, TrajectoryLeavesNothing) {
  Yard yard;
  const JointTrajectory trajectory = yard.trajectory(0, 0.2);
  const auto with = [&](const CertifiedRequest& request) {
    return
        [&yard, &trajectory, request](CertifiedResult& r) { yard.manager.continuousCollide(trajectory, request, r); };
  };
  expectNothingLeft(yard, "tolerance", with(badTolerance()), -5, -2);
  expectNothingLeft(yard, "margin", with(badMargin()), -5, -2);
  const JointTrajectory strange = JointTrajectory::linear(*otherTree(), {7, 8}, {VectorXd::Zero(1), VectorXd::Ones(1)});
  expectNothingLeft(
      yard, "another tree's", [&](CertifiedResult& r) { yard.manager.continuousCollide(strange, {}, r); }, 7, 8);
  yard.moody->throws = true;
  expectNothingLeft(yard, "an obstacle's motion", with({}), -5, -2);
}

TEST(ThrowingQuery, BatchLeavesNothingInAnyResult) {
  Yard yard;
  const std::vector<JointMotion> motions(40, yard.motion(0, 0.2));
  std::vector<JointMotion> mixed = motions;
  mixed[33] = JointMotion::linear(*otherTree(), VectorXd::Zero(1), VectorXd::Ones(1));
  const auto expectReset = [&](const char* what, const std::vector<JointMotion>& asked, const CertifiedRequest& request,
                               int threads) {
    for (const std::size_t n : {3u, 40u, 60u}) {
      std::vector<CertifiedResult> results(n, CertifiedResult());
      for (CertifiedResult& result : results) result.status = Status::free, result.t_lower = 1;
      EXPECT_TRUE(throwsAnything([&] { yard.manager.continuousCollide(asked, request, results, threads); })) << what;
      for (const CertifiedResult& result : results) EXPECT_TRUE(claimsNothing(result)) << what << ", " << n;
    }
  };
  for (const int threads : {0, 1, 2}) {
    expectReset("tolerance", motions, badTolerance(), threads);
    expectReset("another tree's", mixed, {}, threads);
  }
  expectReset("threads", motions, {}, -1);
  yard.moody->throws = true;
  for (const int threads : {1, 2}) expectReset("an obstacle's motion", motions, {}, threads);
}

TEST(ThrowingQuery, ManyObjectsLeaveNothing) {
  const auto slides = [](const Vector3d& from, const Vector3d& to) {
    return std::make_unique<Moving>(std::make_shared<fcl::Sphered>(0.1),
                                    std::make_shared<fcl::TranslationMotiond>(pose(from), pose(to)));
  };
  const auto moody = std::make_shared<Moody>();
  moody->y = -2.8;  // over the others
  const auto a = slides({0, 0, 0}, {0, 0, 0}), b = slides({1, 0, 0}, {0, 0, 0});
  const auto last = std::make_unique<Moving>(std::make_shared<fcl::Sphered>(0.1), moody);
  Moving still(std::make_shared<fcl::Sphered>(0.1));  // has no motion: refused
  ContinuousCollisionManager manager;
  manager.registerObjects({a.get(), b.get(), last.get()});
  manager.setup();
  CertifiedPairsResult used;
  CertifiedRequest every;
  every.mode = ContactMode::firstOfEveryPair;
  manager.continuousCollide(every, used);
  ASSERT_EQ(used.pairs.size(), 3u);
  const auto expectReset = [&](const char* what, const std::function<void(CertifiedPairsResult&)>& query) {
    for (const Status status : {Status::free, Status::contact}) {
      CertifiedPairsResult result = used;
      result.status = status;
      EXPECT_TRUE(throwsAnything([&] { query(result); })) << what;
      EXPECT_TRUE(claimsNothing(result)) << what;
    }
  };
  expectReset("tolerance", [&](CertifiedPairsResult& r) { manager.continuousCollide(badTolerance(), r); });
  expectReset("object", [&](CertifiedPairsResult& r) { manager.continuousCollide(&still, {}, r); });
  const ContinuousCollisionManager* none = nullptr;
  expectReset("manager", [&](CertifiedPairsResult& r) { manager.continuousCollide(none, {}, r); });
  moody->throws = true;  // a and b are found to touch before it is asked
  expectReset("motion", [&](CertifiedPairsResult& r) { manager.continuousCollide(every, r); });
  moody->throws = false;
  manager.unregisterObject(b.get());
  expectReset("not set up", [&](CertifiedPairsResult& r) { manager.continuousCollide(every, r); });
}

// FCL's callback gathers the answers of all pairs in one result. (The single queries' are in test/dropin.)
TEST(ThrowingQuery, CallbackOfTheDropInLeavesAContact) {
  const auto moody = std::make_shared<Moody>();
  moody->y = -1;
  Moving far(std::make_shared<fcl::Sphered>(0.1), moody);
  Moving stays(std::make_shared<fcl::Sphered>(0.1),
               std::make_shared<fcl::TranslationMotiond>(pose({0, 0, 0}), pose({0, 0, 0})));
  fcl::DefaultContinuousCollisionData<double> data;
  EXPECT_FALSE(fcl_artic::DefaultContinuousCollisionFunction<double>(&far, &stays, &data));
  EXPECT_FALSE(data.result.is_collide);
  moody->throws = true;
  EXPECT_TRUE(throwsAnything([&] { fcl_artic::DefaultContinuousCollisionFunction<double>(&far, &stays, &data); }));
  EXPECT_TRUE(data.result.is_collide);
  EXPECT_EQ(data.result.time_of_contact, 0);
}

// Two good queries of the same size: what a reset result holds as memory is used again.
TEST(ThrowingQuery, ResetKeepsMemory) {
  Yard yard;
  CertifiedResult result = yard.usedResults()[1];
  const CertifiedContact* contacts = result.contacts.data();
  const Isometry3d* poses = result.M_0_at_lower.data();
  yard.manager.continuousCollide(yard.motion(0, 1), {}, result);
  EXPECT_EQ(result.contacts.data(), contacts);
  EXPECT_EQ(result.M_0_at_lower.data(), poses);
}

}  // namespace throwing_query_test
