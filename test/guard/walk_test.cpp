// SPDX-License-Identifier: BSD-3-Clause
//
// A person walks in on a robot that a guard lets move. The robot may be off by its joints' tolerance, and the person
// uses all that the limits allow: straight towards the nearest link, past it, or stop and go. The judge has kinematics
// and distances of its own. FCL_ARTIC_WALKS and FCL_ARTIC_WALKS_SEED ask for more and for others.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include <fcl/geometry/shape/capsule.h>

#include "../query/arms.h"
#include "../support/random_placing.h"
#include "fcl_artic/guard.h"

namespace fcl_artic {
namespace walk_test {
namespace {

using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPeriod = 0.01, kFrame = 1.0 / 30, kLatency = 0.012;
constexpr double kWalk = 1.6;        // m/s
constexpr double kLink = 0.06;       // m, radius
constexpr double kPerson = 0.25;     // m, radius
constexpr double kTracking = 0.005;  // rad
constexpr double kSeen = 0.02;       // m: error of the person's place
constexpr int kSteps = 4;            // of the simulation within a period
const double kLength[] = {0.35, 0.35, 0.3, 0.25};

std::size_t fromEnvironment(const char* name, std::size_t usual) {
  const char* text = std::getenv(name);
  return text ? std::strtoul(text, nullptr, 10) : usual;
}

/// Turns about z, y, y, x: a shoulder above the floor.
const Vector3d kAxes[] = {Vector3d::UnitZ(), Vector3d::UnitY(), Vector3d::UnitY(), Vector3d::UnitX()};

struct Segment {
  Vector3d a, b;
};

/// The links' middles, by their own kinematics.
std::vector<Segment> linksAt(const VectorXd& q) {
  std::vector<Segment> links;
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Vector3d at(0, 0, 0.8);
  for (int i = 0; i < 4; ++i) {
    const Vector3d half = std::sin(q[i] / 2) * kAxes[i];
    R = R * Eigen::Quaterniond(std::cos(q[i] / 2), half.x(), half.y(), half.z());
    const Vector3d next = at + R * Vector3d(kLength[i], 0, 0);
    links.push_back({at, next});
    at = next;
  }
  return links;
}

/// The least distance of two segments: at an end of one of them, or between.
double distance(const Segment& s, const Segment& t) {
  const auto fromPoint = [](const Vector3d& p, const Segment& of) {
    const Vector3d d = of.b - of.a;
    const double u = std::min(1.0, std::max(0.0, d.dot(p - of.a) / d.squaredNorm()));
    return (p - of.a - u * d).norm();
  };
  double least = std::min({fromPoint(s.a, t), fromPoint(s.b, t), fromPoint(t.a, s), fromPoint(t.b, s)});
  const Vector3d d = s.b - s.a, e = t.b - t.a, n = d.cross(e);
  if (n.squaredNorm() > 1e-12) {
    const Vector3d r = t.a - s.a;
    const double u = r.cross(e).dot(n) / n.squaredNorm(), w = r.cross(d).dot(n) / n.squaredNorm();
    if (u >= 0 && u <= 1 && w >= 0 && w <= 1) least = std::min(least, std::abs(r.dot(n)) / n.norm());
  }
  return least;
}

struct Person {
  enum class Way { straight, past, stopAndGo } way;
  Vector3d at, target;
  double pause = 0;

  Segment body() const { return {{at.x(), at.y(), 0.3}, {at.x(), at.y(), 1.5}}; }
  void step(double dt, const std::vector<Segment>& links, Random& random) {
    if (way == Way::stopAndGo) {
      pause -= dt;
      if (pause < -0.3) pause = random.uniform(0, 0.5);
      if (pause > 0) return;
    }
    Vector3d to = target;
    if (way != Way::past) {
      const Segment own = body();
      double least = 1e9;
      for (const Segment& link : links) {
        const double gap = distance(link, own);
        if (gap >= least) continue;
        least = gap;
        to = (link.a - at).norm() < (link.b - at).norm() ? link.a : link.b;
      }
    }
    Vector3d go = to - at;
    go.z() = 0;
    if (go.norm() > kWalk * dt) go *= kWalk * dt / go.norm();
    at += go;
  }
};

struct Outcome {
  bool touched = false;  ///< while the robot moved
  double stood = 0;      ///< share of the time lost
  std::size_t asked = 0, slowed = 0, stopped = 0;
  double most_us = 0, sum_us = 0;
};

struct Robot {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::unique_ptr<ArticulatedCollisionManager> manager;
  Robot() {
    tree->addLink("link0");
    const auto link = [&](int i) { return "link" + std::to_string(i); };
    for (int i = 0; i < 4; ++i) {
      tree->addLink(link(i + 1));
      tree->addJoint(makeJoint("joint" + std::to_string(i), JointType::revolute, link(i), link(i + 1), kAxes[i],
                               pose(i ? Vector3d(kLength[i - 1], 0, 0) : Vector3d(0, 0, 0.8))));
    }
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    for (int i = 0; i < 4; ++i) {
      const auto capsule = std::make_shared<fcl::Capsuled>(kLink, kLength[i]);
      manager->bind(link(i + 1), object(capsule), pose({kLength[i] / 2, 0, 0}, M_PI / 2, Vector3d::UnitY()));
    }
    manager->setJointTolerances({kTracking, 0});
  }
};

/// A way of the robot and a person, as a seed has them.
struct Walk {
  Random random;
  Robot robot;
  JointTrajectory trajectory;
  Person person;

  explicit Walk(std::uint64_t seed) : random(seed), trajectory(wayOf(*robot.tree, random)), person(personOf(random)) {}

  static JointTrajectory wayOf(const KinematicTree& tree, Random& random) {
    std::vector<VectorXd> waypoints;
    std::vector<double> times;
    for (int k = 0; k < 5; ++k) {
      VectorXd q(4);
      for (int i = 0; i < 4; ++i) q[i] = random.uniform(-1.2, 1.2);
      waypoints.push_back(q);
      times.push_back(k * random.uniform(0.95, 1.05));
    }
    const std::vector<VectorXd> still(5, VectorXd::Zero(4));
    return JointTrajectory::quintic(tree, times, waypoints, still, still);
  }
  static Person personOf(Random& random) {
    Person person{static_cast<Person::Way>(random.below(3)), {}, {}};
    const double from = random.uniform(0, 2 * M_PI), far = random.uniform(2, 4);
    person.at = Vector3d(far * std::cos(from), far * std::sin(from), 0);
    person.target = -person.at + Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    return person;
  }
};

enum class Mode { graded, onOff, margin };

Outcome walk(std::uint64_t seed, Mode mode) {
  Walk drawn(seed);
  Random& random = drawn.random;
  Robot& robot = drawn.robot;
  Person& person = drawn.person;
  const JointTrajectory& trajectory = drawn.trajectory;
  Outcome outcome;
  GuardOptions options;
  options.deceleration = VectorXd::Constant(4, 12);
  options.period = kPeriod;
  options.reaction = random.below(2) ? kPeriod : 0;
  options.most_age = 0.08;
  options.tries = mode == Mode::onOff ? 0 : 5;
  options.check_self = false;  // the walks are about the person
  // A margin for all in place of tolerances: the worst point by the tolerances of all joints.
  if (mode == Mode::margin) {
    robot.manager->resetTolerances();
    options.margin = kTracking * (1.25 + 0.9 + 0.55 + 0.25 + 4 * kLink) + kSeen;
  }
  const auto capsule = std::make_shared<fcl::Capsuled>(kPerson, 1.2);
  const auto seen = [&] {
    Vector3d at = person.at + Vector3d(0, 0, 0.9);
    const Vector3d off = random.box(1);
    at += kSeen * random.uniform(0, 1) * off.normalized();
    return object(capsule, pose(at));
  };
  robot.manager->registerObject(seen(), "person");
  if (mode != Mode::margin) robot.manager->setObjectTolerance("person", {kSeen, 0, Vector3d::Zero()});
  robot.manager->setObjectSpeed("person", {kWalk, 0});
  LiveScene live(std::move(*robot.manager), 0);
  Guard guard(robot.tree, options);
  guard.follow(trajectory);
  GuardAnswer answer;

  const VectorXd phase = VectorXd::NullaryExpr(4, [&](Eigen::Index) { return random.uniform(0, 6); });
  const auto trueAt = [&](double s, double now) {
    VectorXd q = trajectory.configuration(s);
    for (int i = 0; i < 4; ++i) q[i] += kTracking * (1 - 1e-9) * std::sin(7 * now + phase[i]);
    return q;
  };
  struct Frame {
    double seen_at;
    std::shared_ptr<fcl::CollisionObjectd> person;
  };
  std::vector<Frame> on_the_way;
  /// An answer that counts.
  struct Promise {
    double speed = 0, until = 0, braking = 1e9;
    double at(double now) const { return now >= until - 1e-9 ? 0 : speed; }
  } in_force, next;
  double s = 0, f = 0, next_frame = 0, now = 0;
  int silent = 0;
  const double end = trajectory.endTime();
  double moved = 0;
  int ticks = 0;
  for (; s < end && ticks < 600; ++ticks) {
    if (now >= next_frame) {
      if (!random.oneIn(40)) on_the_way.push_back({now, seen()});  // else a frame is lost
      next_frame += kFrame;
    }
    while (!on_the_way.empty() && now >= on_the_way.front().seen_at + kLatency) {
      const Frame frame = on_the_way.front();
      on_the_way.erase(on_the_way.begin());
      live.renew(frame.seen_at,
                 [&](ArticulatedCollisionManager& manager) { manager.replaceObject("person", frame.person); });
    }
    // An answer counts after the reaction; until then the one before does.
    if (options.reaction > 0) in_force = next;
    silent = silent > 0 ? silent - 1 : random.oneIn(100) ? 5 : 0;
    if (!silent) {
      const double bound = std::max(f, options.reaction > 0 ? in_force.at(now) : 0);
      const auto begin = std::chrono::steady_clock::now();
      guard.ask(*live.latest(), now, s, bound, answer);
      const double us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
      outcome.sum_us += us;
      outcome.most_us = std::max(outcome.most_us, us);
      ++outcome.asked;
      outcome.slowed += answer.speed < 1 && answer.speed > 0;
      outcome.stopped += answer.speed == 0;
      Promise& made = options.reaction > 0 ? next : in_force;
      made.speed = answer.speed;
      made.until = answer.valid_until;
      // Without a certificate the robot stops as the answer says that it has followed last.
      made.braking = answer.certified ? std::min(answer.braking, 1e9) : in_force.braking;
    }
    for (int k = 0; k < kSteps; ++k) {
      const double dt = kPeriod / kSteps;
      const double may = in_force.at(now);
      const double before = f;
      f = f > may ? std::max(may, f - in_force.braking * dt) : may;
      s = std::min(end, s + dt * (f > before ? f : 0.5 * (f + before)));
      moved += f * dt;
      now += dt;
      const std::vector<Segment> links = linksAt(trueAt(s, now));
      person.step(dt, links, random);
      if (!(f > 0) || s >= end) continue;
      for (const Segment& link : links) {
        outcome.touched = outcome.touched || distance(link, person.body()) < kLink + kPerson;
      }
    }
  }
  outcome.stood = 1 - moved / now;
  return outcome;
}

/// Whether a robot that nobody guards touches a person who walks as they like.
bool touchesUnguarded(std::uint64_t seed) {
  Walk drawn(seed);
  for (double now = 0; now < drawn.trajectory.endTime(); now += kPeriod / kSteps) {
    const std::vector<Segment> links = linksAt(drawn.trajectory.configuration(now));
    drawn.person.step(kPeriod / kSteps, links, drawn.random);
    for (const Segment& link : links) {
      if (distance(link, drawn.person.body()) < kLink + kPerson) return true;
    }
  }
  return false;
}

TEST(Walks, NobodyIsTouchedByARobotThatMoves) {
  const std::size_t walks = fromEnvironment("FCL_ARTIC_WALKS", 60);
  const std::uint64_t first = fromEnvironment("FCL_ARTIC_WALKS_SEED", 1);
  struct Sum {
    std::size_t touched = 0, asked = 0, slowed = 0, stopped = 0;
    double lost_needed = 0, lost_needless = 0, us = 0, most_us = 0;
  } sums[3];
  std::size_t would_touch = 0;
  for (std::size_t n = 0; n < walks; ++n) {
    const std::uint64_t seed = 1000003 * first + n;
    const bool needed = touchesUnguarded(seed);
    would_touch += needed;
    for (const Mode mode : {Mode::graded, Mode::onOff, Mode::margin}) {
      Sum& sum = sums[static_cast<int>(mode)];
      const Outcome outcome = walk(seed, mode);
      if (outcome.touched) ADD_FAILURE() << "walk " << n << ", mode " << static_cast<int>(mode) << ": touched";
      sum.touched += outcome.touched;
      sum.asked += outcome.asked;
      sum.slowed += outcome.slowed;
      sum.stopped += outcome.stopped;
      (needed ? sum.lost_needed : sum.lost_needless) += outcome.stood;
      sum.us += outcome.sum_us;
      sum.most_us = std::max(sum.most_us, outcome.most_us);
    }
  }
  std::cout << walks << " walks, in " << would_touch << " of them an unguarded robot touches\n";
  const char* names[] = {"graded", "on or off", "uniform margin"};
  for (int mode = 0; mode < 3; ++mode) {
    const Sum& sum = sums[mode];
    std::cout << names[mode] << ": " << sum.touched << " touched, of " << sum.asked << " answers " << sum.slowed
              << " slow and " << sum.stopped << " stop; time lost needlessly "
              << 100 * sum.lost_needless / static_cast<double>(walks - would_touch) << " %, else "
              << 100 * sum.lost_needed / static_cast<double>(std::max<std::size_t>(1, would_touch)) << " %; mean "
              << sum.us / static_cast<double>(sum.asked) << " us, worst " << sum.most_us << " us\n";
    EXPECT_EQ(sum.touched, 0u);
    EXPECT_GT(sum.asked, 100 * walks);
    EXPECT_GT(sum.stopped, walks / 4) << "nobody comes near";
  }
  EXPECT_GT(would_touch, walks / 10);
  EXPECT_LT(would_touch, walks);
}

}  // namespace
}  // namespace walk_test
}  // namespace fcl_artic
