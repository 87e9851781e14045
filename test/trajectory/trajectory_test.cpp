// SPDX-License-Identifier: BSD-3-Clause
//
// Trajectories: contact times known in closed form, what the constructors make of waypoints, what goes over from piece
// to piece, and bad input.
#include <cfenv>
#include <limits>
#include <random>

#include "scene.h"

namespace trajectory_test {
namespace {

using Unwrap = JointTrajectory::Unwrap;

/// A ball of radius 0.1 on a rail along x; a wall with its face at x = 0.5: they touch at q = 0.4.
struct Slider : Scene {
  Slider() {
    add("slide", JointType::prismatic, "base", "cart", Vector3d::UnitX());
    ball("cart", 0.1);
    obstacle("wall", std::make_shared<fcl::Boxd>(1, 1, 1), translation({1, 0, 0}));
  }
  JointTrajectory linear(const std::vector<double>& times, const std::vector<double>& q) const {
    std::vector<VectorXd> waypoints;
    for (const double x : q) waypoints.push_back(values({x}));
    return JointTrajectory::linear(*tree, times, waypoints);
  }
};

JointTrajectory restToRest(const KinematicTree& tree, double begin, double end, const VectorXd& q0,
                           const VectorXd& q1) {
  const VectorXd zero = VectorXd::Zero(q0.size());
  return JointTrajectory::quintic(tree, {begin, end}, {q0, q1}, {zero, zero}, {zero, zero});
}

TEST(Trajectory, QuinticOfASliderMeetsTheWall) {
  Slider slider;
  const double s = solve(minimumJerk, 0.4L);
  expectContact(slider.run(restToRest(*slider.tree, 2, 6, values({0}), values({1}))), 2 + 4 * s);
  // To the middle, where 0.8 of the way is half way in time.
  expectContact(slider.run(restToRest(*slider.tree, 2, 6, values({0}), values({0.8}))), 4);
  EXPECT_TRUE(slider.run(restToRest(*slider.tree, 2, 6, values({0}), values({0.399}))).isFree());
  CertifiedRequest request;
  request.margin = 0.1;
  expectContact(slider.run(restToRest(*slider.tree, 2, 6, values({0}), values({1})), request),
                2 + 4 * solve(minimumJerk, 0.3L));
}

/// A ball of radius 0.1 at 1 m from the hinge, one of 0.2 at 1 m and 2 rad: they touch at 2 - 2 asin(0.15).
TEST(Trajectory, QuinticOfAnArmMeetsABall) {
  Scene scene;
  scene.add("hinge", JointType::revolute, "base", "arm", Vector3d::UnitZ());
  scene.ball("arm", 0.1, {1, 0, 0});
  scene.obstacle("ball", std::make_shared<fcl::Sphered>(0.2), translation({std::cos(2.0), std::sin(2.0), 0}));
  const double s = solve(minimumJerk, (2 - 2 * std::asin(0.15L)) / 3);
  expectContact(scene.run(restToRest(*scene.tree, 0, 0.5, values({0}), values({3}))), 0.5 * s);
}

/// Fingers 1 m apart with balls of radius 0.1: the one by q, its mimic by -q; they meet at q = 0.4.
TEST(Trajectory, QuinticWithAMimicJoint) {
  Scene scene;
  scene.add("left", JointType::prismatic, "base", "l", Vector3d::UnitX(), translation({-0.5, 0, 0}));
  const Mimic mimic = {"left", -1, 0};
  scene.add("right", JointType::prismatic, "base", "r", Vector3d::UnitX(), translation({0.5, 0, 0}), &mimic);
  scene.ball("l", 0.1);
  scene.ball("r", 0.1);
  const CertifiedResult r = scene.run(restToRest(*scene.tree, 10, 12, values({0}), values({1})));
  expectContact(r, 10 + 2 * solve(minimumJerk, 0.4L));
}

TEST(Trajectory, FirstContactIsInTheTimeOfTheTrajectory) {
  Slider slider;
  const JointTrajectory there = slider.linear({0, 1, 3, 10}, {-1, 0, 0.2, 0.9});
  std::vector<double> told;
  CertifiedRequest request;
  request.progress = [&](double t) {
    told.push_back(t);
    return true;
  };
  const CertifiedResult r = slider.run(there, request);
  expectContact(r, 5);  // 0.2 + 0.1 (t - 3) = 0.4
  EXPECT_EQ(r.contacts[0].body2.name, "wall");
  EXPECT_NEAR(r.M_0_at_lower[1].translation().x(), 0.4, 1e-6);
  for (std::size_t i = 1; i < told.size(); ++i) EXPECT_GE(told[i], told[i - 1]);
  for (const double t : told) EXPECT_TRUE(t >= 0 && t <= 5);

  // Bracket as wide as asked for, in the trajectory's time.
  request.tolerance_time = 1e-2;
  const CertifiedResult loose = slider.run(there, request);
  expectContact(loose, 5, 1e-2);
  // The same pieces a thousand times slower.
  request.tolerance_time = 1e-3;
  expectContact(slider.run(slider.linear({0, 1e3, 3e3, 1e4}, {-1, 0, 0.2, 0.9}), request), 5e3, 1e-3);

  const CertifiedResult free = slider.run(slider.linear({0, 1, 3, 10}, {-1, 0, 0.2, 0.39}));
  EXPECT_TRUE(free.isFree());
  EXPECT_EQ(free.t_lower, 10);
  EXPECT_EQ(free.t_upper, 10);
  EXPECT_TRUE(free.contacts.empty());
  EXPECT_EQ(free.statistics.pairs, 3u) << "of three pieces";
  EXPECT_TRUE(free.M_0_at_lower.empty());
}

/// The wall is touched at 0.4 in the second piece, and again in pieces after it.
TEST(Trajectory, ProgressTellsOfNothingAfterAContact) {
  Slider slider;
  slider.bind("cart", std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1),
              Isometry3d::Identity());  // a pair for the paper's method
  const JointTrajectory there = slider.linear({0, 1, 2, 3, 4, 5}, {-1, 0, 0.42, -0.2, 0.48, -1});
  for (const Method method : {Method::standard, Method::redon2004}) {
    std::vector<double> told;
    CertifiedRequest request;
    request.method = method;
    request.mode = ContactMode::firstOfEveryPair;
    request.max_contacts = 100;
    request.progress = [&](double t) {
      told.push_back(t);
      return true;
    };
    const CertifiedResult r = slider.run(there, request);
    expectContact(r, 1 + 0.4 / 0.42);
    EXPECT_GE(told.size(), 4u);
    for (const double t : told) EXPECT_LE(t, r.t_upper);
  }
}

// Pieces that swept bounds settle count no test: the caller is asked between them all the same.
TEST(Trajectory, OfEasyPiecesCanBeEnded) {
  Slider slider;
  std::vector<double> times, values;
  for (int i = 0; i <= 100; ++i) {
    times.push_back(i);
    values.push_back(i % 2 ? -3.0 : -3.1);
  }
  int told = 0;
  CertifiedRequest request;
  request.progress = [&](double t) { return ++told, t < 40; };
  const CertifiedResult ended = slider.run(slider.linear(times, values), request);
  EXPECT_EQ(ended.status, Status::undecided);
  EXPECT_EQ(ended.t_lower, 40);
  EXPECT_EQ(told, 40);
  EXPECT_EQ(ended.statistics.node_tests + ended.statistics.leaf_tests, 0u) << "not as easy as it is to be";
  request.progress = [&](double) { return true; };
  EXPECT_TRUE(slider.run(slider.linear(times, values), request).isFree());
}

/// Contact exactly where two pieces meet, q = 0.375 = 0.5 - 0.125 without rounding: coming to touch and going back, and
/// going through.
TEST(Trajectory, ContactExactlyAtAWaypoint) {
  for (const double last : {0.0, 1.0}) {
    Scene scene;
    scene.add("slide", JointType::prismatic, "base", "cart", Vector3d::UnitX());
    scene.bind("cart", std::make_shared<fcl::Boxd>(0.25, 0.25, 0.25));
    scene.obstacle("wall", std::make_shared<fcl::Boxd>(1, 1, 1), translation({1, 0, 0}));
    const CertifiedResult r = scene.run(JointTrajectory::linear(
        *scene.tree, {0, 0.5, 2, 3}, {values({0}), values({0.25}), values({0.375}), values({last})}));
    EXPECT_EQ(r.status, Status::contact);
    EXPECT_LE(r.t_lower, 2);
    EXPECT_NEAR(r.t_lower, 2, 1e-5);
    EXPECT_GE(r.t_upper, 2);
  }
}

TEST(Trajectory, BracketIsAProofAtTimesWhoseDoublesAreFarApart) {
  // The cart meets the wall at x = 0.4; the time of that in extended precision.
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  int certain = 0, wider = 0;
  for (int i = 0; i < 200; ++i) {
    Slider slider;
    const double begin = i % 2 ? 1.7e9 + 1e3 * unit(random) : -1.7e9 * unit(random), duration = 0.2 + 5 * unit(random);
    const double end = begin + duration, from = -0.6 * unit(random);
    const JointTrajectory trajectory = slider.linear({begin, end}, {from, 1});
    for (const int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      for (const ContactMode contacts : {ContactMode::first, ContactMode::any}) {
        CertifiedRequest request;
        request.mode = contacts;
        request.tolerance_time = i % 3 ? 1e-6 : 1e-8;
        std::fesetround(mode);
        const CertifiedResult r = slider.run(trajectory, request);
        std::fesetround(FE_TONEAREST);
        ASSERT_EQ(r.status, Status::contact);
        ASSERT_EQ(r.contacts.size(), 1u);
        certain += r.certain;
        const long double part = (0.4L - from) / (1.0L - from);
        const long double time = begin + part * (static_cast<long double>(end) - begin);
        // The part that the query's own proof leaves open is far below an ulp of these times.
        EXPECT_LE(r.t_lower, time);
        EXPECT_GE(r.t_upper, time);
        EXPECT_LE(r.contacts[0].t_lower, time);
        EXPECT_GE(r.contacts[0].t_upper, time);
        if (contacts == ContactMode::any) continue;
        const double ulp = std::nextafter(std::abs(begin), INFINITY) - std::abs(begin);
        EXPECT_LE(r.t_upper - r.t_lower, request.tolerance_time + 4 * ulp + 1e-14);
        wider += r.t_upper - r.t_lower > request.tolerance_time;
      }
    }
  }
  EXPECT_EQ(certain, 200 * 8);
  EXPECT_GT(wider, 50) << "not the case that is meant";
}

TEST(Trajectory, EveryPairIsReportedOnce) {
  Slider slider;
  slider.obstacle("gate", std::make_shared<fcl::Sphered>(0.1),
                  translation({0, 0.15, 0}));  // met at -sqrt(0.2^2 - 0.15^2)
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  request.max_contacts = 10;
  const JointTrajectory back_and_forth = slider.linear({0, 1, 2, 3, 4}, {-1, 0, -1, 0, 1});
  const CertifiedResult r = slider.run(back_and_forth, request);
  ASSERT_EQ(r.contacts.size(), 2u);
  const double gate = 1 - std::sqrt(0.04 - 0.0225);
  EXPECT_EQ(r.contacts[0].body2.name, "gate");
  EXPECT_NEAR(r.contacts[0].t_lower, gate, 1e-5);
  EXPECT_EQ(r.contacts[1].body2.name, "wall");
  EXPECT_NEAR(r.contacts[1].t_lower, 3.4, 1e-5);
  expectContact(r, gate);
  request.max_contacts = 1;
  EXPECT_EQ(slider.run(back_and_forth, request).contacts.size(), 1u);
}

TEST(Trajectory, InitialContactIsIgnoredUntilItIsOver) {
  Slider slider;
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  // In touch over two pieces, apart in the third, back in the fifth: 0.2 + 0.4 (t - 4) = 0.4.
  const JointTrajectory and_back = slider.linear({0, 1, 2, 3, 4, 5}, {0.55, 0.5, 0.45, 0.3, 0.2, 0.6});
  const CertifiedResult r = slider.run(and_back, request);
  expectContact(r, 4.5);
  ASSERT_EQ(r.ignored_initial_contacts.size(), 1u);
  EXPECT_EQ(r.ignored_initial_contacts[0].second.name == "wall" || r.ignored_initial_contacts[0].first.name == "wall",
            true);
  EXPECT_EQ(slider.run(and_back).t_upper, 0);
  EXPECT_TRUE(slider.run(slider.linear({0, 1, 2, 3}, {0.55, 0.5, 0.45, 0.3}), request).isFree());
  // Never apart, to the end.
  EXPECT_TRUE(slider.run(slider.linear({0, 1, 2, 3}, {0.55, 0.5, 0.45, 0.6}), request).isFree());
}

/// One pair is carried over the waypoint; another comes into contact by the jump between two pieces that passes as
/// rounding. It was never ignored, and must not be.
TEST(Trajectory, WhatIsIgnoredAtAWaypointIsOnlyWhatWasBefore) {
  Scene scene;
  scene.add("slide", JointType::prismatic, "base", "cart", Vector3d::UnitX());
  scene.bind("cart", std::make_shared<fcl::Boxd>(0.25, 0.25, 0.25));
  scene.obstacle("plate", std::make_shared<fcl::Boxd>(10, 10, 0.25), translation({0, 0, -0.2}));  // always in touch
  scene.obstacle("wall", std::make_shared<fcl::Boxd>(1, 1, 1), translation({1, 0, 0}));           // at 0.375
  const auto piece = [](double q0, double rate) {
    MatrixXd c(1, 2);
    c << q0, rate;
    return c;
  };
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  request.tolerance_distance = 1e-12;
  const double near = 4e-10;
  const CertifiedResult r = scene.run(
      JointTrajectory::piecewise(*scene.tree, {0, 1, 2}, {piece(0.375 - near - 0.25, 0.25), piece(0.375 + near, -0.5)}),
      request);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_EQ(r.t_lower, 1);
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_EQ(r.contacts[0].body2.name, "wall");
  // Without the jump nothing but the plate is near.
  const CertifiedResult free = scene.run(
      JointTrajectory::piecewise(*scene.tree, {0, 1, 2}, {piece(0.375 - near - 0.25, 0.25), piece(0.375 - near, -0.5)}),
      request);
  EXPECT_TRUE(free.isFree());
}

/// The pair that was ignored has separated, comes back nearly, and the same kind of jump brings it into contact.
TEST(Trajectory, WhatHasSeparatedIsNotIgnoredAgain) {
  Scene scene;
  scene.add("slide", JointType::prismatic, "base", "cart", Vector3d::UnitX());
  scene.bind("cart", std::make_shared<fcl::Boxd>(0.25, 0.25, 0.25));
  scene.obstacle("wall", std::make_shared<fcl::Boxd>(1, 1, 1), translation({1, 0, 0}));  // at 0.375
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  request.tolerance_distance = 1e-12;
  const double near = 4e-10;
  MatrixXd loop(1, 3), away(1, 2);
  loop << 0.4, -0.4, 0.375 - near;  // 0.293 on the way, 0.375 - near in the end
  away << 0.375 + near, -0.5;
  const CertifiedResult r = scene.run(JointTrajectory::piecewise(*scene.tree, {0, 1, 2}, {loop, away}), request);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_EQ(r.t_lower, 1);
  away(0, 0) = 0.375 - near;
  EXPECT_TRUE(scene.run(JointTrajectory::piecewise(*scene.tree, {0, 1, 2}, {loop, away}), request).isFree());
}

TEST(Trajectory, BudgetIsForAllPieces) {
  Slider slider;  // nearly touches a cylinder whose box it meets
  slider.obstacle("cylinder", std::make_shared<fcl::Cylinderd>(0.1, 1), translation({0.54, 0.15, 0}));
  std::vector<double> times, q;
  for (int i = 0; i <= 200; ++i) {
    times.push_back(i);
    q.push_back(i % 2 ? 0.39 : 0.38);
  }
  const JointTrajectory shake = slider.linear(times, q);
  const CertifiedResult full = slider.run(shake);
  ASSERT_TRUE(full.isFree());
  const std::uint64_t work = full.statistics.node_tests + full.statistics.leaf_tests;
  ASSERT_GT(work, 100u);
  CertifiedRequest request;
  request.work_budget = work / 2;
  const CertifiedResult half = slider.run(shake, request);
  EXPECT_EQ(half.status, Status::undecided);
  EXPECT_GT(half.t_lower, 20);
  EXPECT_LT(half.t_lower, 180);
  request.work_budget = work;
  EXPECT_TRUE(slider.run(shake, request).isFree());
}

/// The same for the paper's own work, which is counted elsewhere than the library's.
TEST(Trajectory, BudgetOfThePapersMethodIsForAllPieces) {
  Scene scene;
  scene.add("slide", JointType::prismatic, "base", "cart", Vector3d::UnitX());
  scene.bind("cart", std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2));
  Isometry3d turned = translation({0.55, 0, 0});
  turned.rotate(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  scene.obstacle("box", std::make_shared<fcl::Boxd>(0.4, 0.4, 0.4), turned);
  std::vector<double> times;
  std::vector<VectorXd> q;
  for (int i = 0; i <= 60; ++i) {
    times.push_back(i);
    q.push_back(values({i % 2 ? 0.1 : 0}));
  }
  const JointTrajectory shake = JointTrajectory::linear(*scene.tree, times, q);
  CertifiedRequest request;
  request.method = Method::redon2004;
  const CertifiedResult full = scene.run(shake, request);
  ASSERT_TRUE(full.isFree());
  ASSERT_EQ(full.statistics.redon.pairs_by_standard, 0u);
  const std::uint64_t work = full.statistics.redon.box_tests + full.statistics.redon.evaluations +
                             full.statistics.node_tests + full.statistics.leaf_tests;
  ASSERT_GT(full.statistics.redon.box_tests, 50u);
  request.work_budget = work / 2;
  const CertifiedResult half = scene.run(shake, request);
  EXPECT_EQ(half.status, Status::undecided);
  EXPECT_GT(half.t_lower, 10);
  EXPECT_LT(half.t_lower, 50);
  request.work_budget = work;
  EXPECT_TRUE(scene.run(shake, request).isFree());
}

// ---- constructors ----

Scene twoJoints() {
  Scene scene;
  scene.add("turn", JointType::continuous, "base", "a");
  scene.add("slide", JointType::prismatic, "a", "b");
  return scene;
}

VectorXd derivative(const JointTrajectory& x, double t, double h = 1e-6) {
  return (x.configuration(t + h) - x.configuration(t - h)) / (2 * h);
}

TEST(Trajectory, BudgetThatEndsBeforeAllPairsAreLookedAtIsUndecided) {
  Slider slider;
  slider.obstacle("gate", std::make_shared<fcl::Sphered>(0.1), translation({0, 0.15, 0}));
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  request.max_contacts = 10;
  const JointTrajectory trajectory = slider.linear({0, 1, 2, 3, 4}, {-1, 0, -1, 0, 1});
  int undecided = 0, after_a_contact = 0;
  for (request.work_budget = 1; request.work_budget < 400; ++request.work_budget) {
    const CertifiedResult r = slider.run(trajectory, request);
    EXPECT_NE(r.status, Status::free);
    if (r.status == Status::undecided) {
      ++undecided;
      after_a_contact += !r.contacts.empty();
      EXPECT_FALSE(r.certain);
    } else {
      EXPECT_EQ(r.contacts.size(), 2u) << "budget " << request.work_budget;
    }
  }
  EXPECT_GT(undecided, 0);
  EXPECT_GT(after_a_contact, 0);
}

TEST(Trajectory, CubicAndQuinticPassWaypointsAtTheirRates) {
  const Scene scene = twoJoints();
  const std::vector<double> times = {1, 1.5, 4};
  const std::vector<VectorXd> q = {values({0, 1}), values({2, -1}), values({1, 3})},
                              v = {values({1, 0}), values({-2, 3}), values({0, 1})},
                              a = {values({0, 0}), values({5, -4}), values({1, 1})};
  const JointTrajectory cubic = JointTrajectory::cubic(*scene.tree, times, q, v);
  const JointTrajectory quintic = JointTrajectory::quintic(*scene.tree, times, q, v, a);
  for (const JointTrajectory* x : {&cubic, &quintic}) {
    ASSERT_EQ(x->numPieces(), 2u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((x->configuration(times[k]) - q[k]).norm(), 1e-12);
    EXPECT_LT((derivative(*x, 1.5) - v[1]).norm(), 1e-4);
  }
  const double h = 1e-5;
  const VectorXd bend = (derivative(quintic, 1.5 + h) - derivative(quintic, 1.5 - h)) / (2 * h);
  EXPECT_LT((bend - a[1]).norm(), 2e-2);
  EXPECT_EQ(cubic.configuration(0), q[0]);  // cut to its time
}

/// Angular velocities of a cubic in orientations are the ones given, at both ends of a piece.
TEST(Trajectory, CubicOfAQuaternion) {
  Scene scene;
  scene.add("ball", JointType::spherical, "base", "a");
  const Quaterniond a(Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized())),
      b(Eigen::AngleAxisd(2.9, Vector3d(-1, 0.5, 1).normalized()));
  const VectorXd v = values({1, -2, 0.5, 0});
  const JointTrajectory x =
      JointTrajectory::cubic(*scene.tree, {0, 1, 3}, {a.coeffs(), b.coeffs(), a.coeffs()}, {v, v, v});
  const auto at = [&](double t) { return Quaterniond(Eigen::Vector4d(x.configuration(t))); };
  EXPECT_LT(at(1).angularDistance(b), 1e-7);
  const double h = 1e-5;
  for (const double t : {h, 1 - h, 1 + h, 3 - h}) {
    const Eigen::AngleAxisd step(at(t + h) * at(t - h).conjugate());
    double angle = step.angle();
    if (angle > kPi) angle -= 2 * kPi;
    EXPECT_LT((angle * step.axis() / (2 * h) - v.head<3>()).norm(), 2e-3) << t;
  }
}

TEST(Trajectory, ParabolicBlendsAreLinesWithRoundedCorners) {
  const Scene scene = twoJoints();
  const std::vector<VectorXd> q = {values({0, 0}), values({1, 2}), values({1, -2}), values({0, 0})};
  const double b = 0.25;
  const JointTrajectory x = JointTrajectory::parabolicBlends(*scene.tree, {0, 1, 3, 4}, q, b);
  ASSERT_EQ(x.numPieces(), 5u);
  EXPECT_LT((x.configuration(0.5) - 0.5 * q[1]).norm(), 1e-12) << "on the line";
  EXPECT_LT((x.configuration(4) - q[3]).norm(), 1e-12);
  // In a blend's middle: b / 4 times the change of speed off the corner.
  const VectorXd change = (q[2] - q[1]) / 2 - (q[1] - q[0]);
  EXPECT_LT((x.configuration(1) - q[1] - b / 4 * change).norm(), 1e-12);
  EXPECT_LT((derivative(x, 0.75) - q[1]).norm(), 1e-4) << "speeds agree where the blend begins";
  EXPECT_LT((derivative(x, 1.25) - (q[2] - q[1]) / 2).norm(), 1e-4);
  EXPECT_EQ(JointTrajectory::parabolicBlends(*scene.tree, {0, 1, 3, 4}, q, 0).numPieces(), 3u);
  EXPECT_EQ(JointTrajectory::parabolicBlends(*scene.tree, {0, 1, 2, 3}, q, 0.5).numPieces(), 4u)
      << "blend next to blend";
}

TEST(Trajectory, BlendsAsShortOrAsLongAsNumbersAllow) {
  const Scene scene = twoJoints();
  const std::vector<VectorXd> q = {values({0, 0}), values({1, 2}), values({1, -2}), values({0, 0})};
  for (const double t : {0.0, 1000.1, 1.7e9}) {
    const std::vector<double> times = {t, t + 1, t + 3, t + 4};
    const double ulp = std::nextafter(t, INFINITY) - t;
    for (const double blend : {1e-300, 1e-14, 0.3 * ulp, 0.7 * ulp, 2.5 * ulp}) {
      const JointTrajectory x = JointTrajectory::parabolicBlends(*scene.tree, times, q, std::max(blend, 1e-300));
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT((x.configuration(times[k]) - q[k]).norm(), 1e-5) << t << " " << blend;
    }
    // The middle segment is all blends, but for what its ends are rounded by.
    const std::vector<double> close = {t, t + 1, t + 1 + 0.2, t + 3};
    const JointTrajectory x = JointTrajectory::parabolicBlends(*scene.tree, close, q, 0.1);
    EXPECT_LT((x.configuration(t + 3) - q[3]).norm(), 1e-5) << t;
    EXPECT_EQ(x.times().back(), t + 3);
  }
  // The last segment is all blend, and ends where the last waypoint is due.
  const JointTrajectory x =
      JointTrajectory::parabolicBlends(*scene.tree, {0, 0.7, 1 - 0x1p-53}, {q[0], q[1], q[2]}, 0.3);
  EXPECT_EQ(x.times().back(), 1 - 0x1p-53);
}

/// Cox and de Boor's recursion.
double basis(const std::vector<double>& knots, std::size_t i, int degree, double t) {
  if (degree == 0) return knots[i] <= t && t < knots[i + 1];
  const std::size_t p = static_cast<std::size_t>(degree);
  double value = 0;
  if (knots[i + p] > knots[i]) value += (t - knots[i]) / (knots[i + p] - knots[i]) * basis(knots, i, degree - 1, t);
  if (knots[i + p + 1] > knots[i + 1]) {
    value += (knots[i + p + 1] - t) / (knots[i + p + 1] - knots[i + 1]) * basis(knots, i + 1, degree - 1, t);
  }
  return value;
}

TEST(Trajectory, BSplinesAreTheSumOfTheirBasis) {
  const Scene scene = twoJoints();
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int degree = 1; degree <= 5; ++degree) {
    const std::size_t p = static_cast<std::size_t>(degree), n = 9;
    for (const bool clamped : {true, false}) {
      std::vector<double> knots;
      std::vector<VectorXd> points;
      for (std::size_t i = 0; i < n; ++i) points.push_back(values({uniform(random), uniform(random)}));
      for (std::size_t i = 0; i <= n + p; ++i) {
        const double even = 0.5 * static_cast<double>(i) + 0.1 * uniform(random);
        knots.push_back(!clamped ? even : i <= p ? 0 : i >= n ? 10 : even);
      }
      if (degree > 2) knots[p + 2] = knots[p + 1];  // a knot twice
      const JointTrajectory x = JointTrajectory::bspline(*scene.tree, degree, knots, points);
      EXPECT_EQ(x.beginTime(), knots[p]);
      EXPECT_EQ(x.endTime(), knots[n]);
      for (int s = 0; s < 50; ++s) {
        const double t = knots[p] + (knots[n] - knots[p]) * s / 50;
        VectorXd sum = VectorXd::Zero(2);
        for (std::size_t i = 0; i < n; ++i) sum += basis(knots, i, degree, t) * points[i];
        EXPECT_LT((x.configuration(t) - sum).norm(), 1e-11) << degree << " at " << t;
      }
    }
  }
}

/// A B-spline whose control points lie on a line at the knots' averages runs on that line at constant speed: q = t
/// / 10.
TEST(Trajectory, BSplineMeetsTheWall) {
  Slider slider;
  const std::vector<double> knots = {0, 0, 0, 0, 2, 3, 7, 10, 10, 10, 10};
  std::vector<VectorXd> points;
  for (std::size_t i = 0; i + 4 < knots.size(); ++i)
    points.push_back(values({(knots[i + 1] + knots[i + 2] + knots[i + 3]) / 30}));
  expectContact(slider.run(JointTrajectory::bspline(*slider.tree, 3, knots, points)), 4);
}

TEST(Trajectory, ContinuousJointsAreUnwrappedOnRequest) {
  const Scene scene = twoJoints();
  const std::vector<VectorXd> q = {values({3, 0}), values({-3, 0}), values({-1, 0}), values({2.5, 7})};
  const std::vector<double> times = {0, 1, 2, 3};
  EXPECT_EQ(JointTrajectory::linear(*scene.tree, times, q).piece(0).dq()[0], -6);
  const JointTrajectory x = JointTrajectory::linear(*scene.tree, times, q, Unwrap::yes);
  const double steps[] = {2 * kPi - 6, 2, 3.5 - 2 * kPi};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(x.piece(k).dq()[0], steps[k], 1e-14);
  EXPECT_EQ(x.piece(2).dq()[1], 7) << "a slide is not wrapped";
  EXPECT_NEAR(x.configuration(3)[0], 2.5, 1e-14) << "once around forth and back";

  Scene geared = twoJoints();
  const Mimic half = {"turn", 0.5, 0};
  geared.add("half", JointType::revolute, "base", "c", Vector3d::UnitZ(), Isometry3d::Identity(), &half);
  expectContains(refusal([&] { JointTrajectory::linear(*geared.tree, times, q, Unwrap::yes); }),
                 "joint 'half' mimics the continuous joint 'turn'");
}

// ---- bad input ----

TEST(Trajectory, RefusesWithPieceAndJoint) {
  const Scene scene = twoJoints();
  const KinematicTree& tree = *scene.tree;
  const VectorXd zero = VectorXd::Zero(2), one = VectorXd::Ones(2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto linear = [&](const std::vector<double>& times, const std::vector<VectorXd>& q) {
    return refusal([&] { JointTrajectory::linear(tree, times, q); });
  };
  expectContains(linear({0}, {zero}), "1 waypoints");
  expectContains(linear({0, 1, 2}, {zero, one}), "3 times for 2 waypoints");
  expectContains(linear({0, 1, 1}, {zero, one, zero}), "times[2] = 1 is not later than times[1] = 1");
  // Every piece's duration is finite, but not that of the whole.
  expectContains(linear({-1.7e308, 0, 1.7e308}, {zero, one, zero}), "from -1.7e+308 to 1.7e+308 is not finite");
  expectContains(linear({0, nan}, {zero, one}), "times[1] is not finite");
  expectContains(linear({0, 1}, {zero, VectorXd::Zero(3)}), "waypoint 1 has 3 entries, robot 'robot' has 2");
  expectContains(linear({0, 1}, {zero, values({0, nan})}), "joint 'slide' is not finite");
  expectContains(linear({0, 1}, {zero, values({0, 2e5})}), "piece 0: q1: the value 2e+05 of joint 'slide'");

  const MatrixXd still = MatrixXd::Zero(2, 1);
  MatrixXd moved = MatrixXd::Zero(2, 6), wide = MatrixXd::Zero(2, 7), huge = still;
  moved(1, 0) = 0.5;
  huge(0, 0) = 2e5;
  const auto pieces = [&](const std::vector<double>& times, const std::vector<MatrixXd>& c) {
    return refusal([&] { JointTrajectory::piecewise(tree, times, c); });
  };
  expectContains(pieces({0}, {}), "no piece");
  expectContains(pieces({0, 1}, {still, moved}), "2 times for 2 pieces");
  expectContains(pieces({0, 1, 2, 3}, {still, still, moved}),
                 "piece 2 begins elsewhere than piece 1 ends: joint 'slide' jumps");
  expectContains(pieces({0, 1}, {wide}), "piece 0: coefficients have 7 columns");
  expectContains(pieces({0, 1}, {MatrixXd::Zero(3, 2)}), "piece 0: coefficients have 3 rows");
  expectContains(pieces({0, 1}, {huge}), "joint 'turn' is beyond 1e5");
  moved(0, 3) = nan;
  expectContains(pieces({0, 1}, {moved}), "of joint 'turn' are not finite");

  expectContains(refusal([&] {
                   JointTrajectory::cubic(tree, {0, 1}, {zero, one}, {zero});
                 }),
                 "1 velocities for 2 waypoints");
  expectContains(refusal([&] {
                   JointTrajectory::cubic(tree, {0, 1}, {zero, one}, {zero, values({nan, 0})});
                 }),
                 "velocities of waypoint 1: joint 'turn'");
  expectContains(refusal([&] {
                   JointTrajectory::parabolicBlends(tree, {0, 1, 2}, {zero, one, zero}, 1.5);
                 }),
                 "overlap between waypoints 0 and 1");
  expectContains(refusal([&] { JointTrajectory::parabolicBlends(tree, {0, 1, 2}, {zero, one, zero}, -1); }), "blend");
  const std::vector<VectorXd> points = {zero, one, zero};
  expectContains(refusal([&] { JointTrajectory::bspline(tree, 6, {}, points); }), "degree 6");
  expectContains(refusal([&] { JointTrajectory::bspline(tree, 3, {}, points); }),
                 "3 control points for a B-spline of degree 3");
  expectContains(refusal([&] {
                   JointTrajectory::bspline(tree, 1, {0, 1, 2}, points);
                 }),
                 "3 knots for 3 control points, not 5");
  expectContains(refusal([&] { JointTrajectory::bspline(tree, 1, {0, 1, 0, 3, 4}, points); }), "knot 2");
  expectContains(refusal([&] { JointTrajectory::bspline(tree, 1, {0, 1, 1, 1, 4}, points); }), "span no time");
  expectContains(refusal([&] {
                   JointTrajectory::bspline(tree, 1, {0, 0, 1, 1, 2, 2}, {zero, one, zero, one});
                 }),
                 "more than 1 times");

  Scene ball;
  ball.add("ball", JointType::spherical, "base", "a");
  const std::vector<VectorXd> q(2, ball.tree->neutralConfiguration()), v(2, VectorXd::Zero(4)),
      w(2, values({0, 0, 0, 1}));
  // Only one that stands still needs no more than a quintic says.
  const JointTrajectory at_rest = JointTrajectory::quintic(*ball.tree, {0, 1}, q, v, v);
  EXPECT_EQ(at_rest.configuration(0.3), q[0]);
  std::vector<VectorXd> turned = q, rates = v;
  turned[1] = values({0, 0, 1, 0});
  rates[1] = values({0.1, 0, 0, 0});
  const auto refused = [&](const std::vector<VectorXd>& ways, const std::vector<VectorXd>& first,
                           const std::vector<VectorXd>& second) {
    expectContains(refusal([&] {
                     JointTrajectory::quintic(*ball.tree, {0, 1}, ways, first, second);
                   }),
                   "joint 'ball' turns by a quaternion at waypoint 1");
  };
  refused(turned, v, v);
  refused(q, rates, v);
  refused(q, v, rates);
  expectContains(refusal([&] { JointTrajectory::cubic(*ball.tree, {0, 1}, q, w); }), "'ball/rot_w' is not 0");
}

TEST(Trajectory, QueryRefusesAndClaimsNothing) {
  Slider slider;
  const JointTrajectory x = slider.linear({0, 1}, {0, 1});
  slider.ready().setup();
  CertifiedResult r;
  CertifiedRequest request;
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    request.tolerance_time = bad;
    r.status = Status::free;
    r.t_lower = 1;
    expectContains(refusal([&] { slider.manager->continuousCollide(x, request, r); }), "tolerance_time");
    EXPECT_EQ(r.status, Status::undecided);
    EXPECT_EQ(r.t_lower, 0);
  }
  const Scene other = twoJoints();
  const JointTrajectory foreign = JointTrajectory::linear(*other.tree, {0, 1}, {values({0, 0}), values({1, 1})});
  expectContains(refusal([&] { slider.manager->continuousCollide(foreign, {}, r); }), "the trajectory");
}

}  // namespace
}  // namespace trajectory_test
