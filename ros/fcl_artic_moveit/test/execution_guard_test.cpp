// SPDX-License-Identifier: BSD-3-Clause
// Executions in simulated time: the scene changes while the robot moves, and the guard stops it before it touches
// anything. Contact is judged by MoveIt's own check.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include <octomap/octomap.h>

#include <moveit/planning_scene/planning_scene.hpp>

#include "fcl_artic_moveit/execution_guard.h"
#include "models.h"

namespace fcl_artic_moveit {
namespace {

using fcl_artic::GuardReason;
using planning_scene::PlanningScene;
using robot_trajectory::RobotTrajectory;

constexpr double kTick = 0.01;         // s
constexpr double kDeceleration = 2.0;  // m/s² and rad/s²

Eigen::Isometry3d at(double x, double y, double z = 0) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// Waypoints of rail, turn and reach of the slider, with the times between them.
RobotTrajectory trajectoryOf(const PlanningScene& scene, const std::vector<std::vector<double>>& waypoints,
                             const std::vector<double>& steps, const std::string& group = "all") {
  RobotTrajectory out(scene.getRobotModel(), group);
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    moveit::core::RobotState state(scene.getCurrentState());
    for (std::size_t v = 0; v < waypoints[k].size(); ++v) state.setVariablePosition(v, waypoints[k][v]);
    state.update();
    out.addSuffixWayPoint(state, k == 0 ? 0 : steps[k - 1]);
  }
  return out;
}

ExecutionGuardOptions optionsOf(Executor executor = Executor::joints) {
  ExecutionGuardOptions out;
  out.executor = executor;
  out.deceleration = kDeceleration;
  out.period = 2 * kTick;
  out.reaction = 2 * kTick;
  out.most_age = 10 * kTick;
  return out;
}

bool collides(const PlanningScene& scene, const std::vector<double>& q) {
  moveit::core::RobotState state(scene.getCurrentState());
  for (std::size_t v = 0; v < q.size(); ++v) state.setVariablePosition(v, q[v]);
  state.update();
  return scene.isStateColliding(state, "all");
}

/// The rail runs along x at 1 m/s from 0 to 3; arm and finger reach 1.15 m ahead of it.
struct Execution {
  PlanningScene scene{slider()};
  RobotTrajectory trajectory = trajectoryOf(scene, {{0, 0, 0}, {3, 0, 0}}, {3});
  ExecutionGuard guard;
  explicit Execution(const ExecutionGuardOptions& options = optionsOf()) : guard(scene.getRobotModel(), options) {}
  void addBox(double x) {
    scene.getWorldNonConst()->addToObject("box", std::make_shared<shapes::Box>(0.1, 1, 1), at(x, 0));
  }
};

TEST(ExecutionGuard, SaysUntilWhenItIsFree) {
  Execution run;
  run.guard.follow(run.scene, 0, run.trajectory);
  const GuardReply free = run.guard.ask(0, 0, 0);
  EXPECT_FALSE(free.must_stop) << free.message;
  EXPECT_EQ(free.answer.speed, 1);
  EXPECT_TRUE(free.ahead.all_free);
  EXPECT_TRUE(free.message.empty());

  // The finger's front, at 1.15 + rail, comes to the box's side when the rail is at 2. A stop takes 1 / (2 x 2) m,
  // which is a tolerance of the rail here, and 0.02 s of reaction; lookAhead() takes the same twice more.
  run.addBox(3.2);
  run.guard.renew(run.scene, 0.01);
  const GuardReply reply = run.guard.ask(0.02, 0.02);
  EXPECT_FALSE(reply.must_stop) << reply.message;
  EXPECT_NEAR(reply.ahead.free_until, 2 - 0.25, 2e-3);
  EXPECT_LE(reply.ahead.free_until, 2 - 0.25);
  EXPECT_NEAR(reply.ahead.run_until, 2 - 0.25 - 0.02 - 0.25 - 0.25, 2e-3);
  EXPECT_NEAR(reply.answer.stop_at, 0.02 + 0.04 + 0.25, 1e-6) << "reaction, period, stop";

  // Twice as fast at first: a stop may take 2^2 / (2 x 2) m, and the rail is 1 m before its contact at 0.5 s.
  run.trajectory = trajectoryOf(run.scene, {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {0.5, 2});
  run.guard.follow(run.scene, 0, run.trajectory);
  const double free_until = run.guard.ask(0, 0, 0).ahead.free_until;
  EXPECT_LE(free_until, 0.5);
  EXPECT_NEAR(free_until, 0.5, 2e-3);
}

TEST(ExecutionGuard, StopsALongOneBeforeABoxThatAppears) {
  for (const double appears_at : {0.0, 0.3, 0.8}) {
    Execution run;
    int calls = 0;
    std::string message;
    run.guard.onMustStop([&](const GuardReply& reply) { ++calls, message = reply.message; });
    run.guard.follow(run.scene, 0, run.trajectory);
    // (The numbers of ticks count, so that no time is a sum.)
    int stopped = -1;
    double stop_at = 0, until = 0;
    for (int tick = 0; tick < 300; ++tick) {
      const double now = tick * kTick;
      if (std::abs(now - appears_at) < 1e-9) run.addBox(3.2);
      if (tick % 5 == 0) run.guard.renew(run.scene, now);
      const GuardReply reply = run.guard.ask(now, now);
      if (reply.must_stop) {
        stopped = tick;
        break;
      }
      stop_at = reply.answer.stop_at;
      until = reply.ahead.run_until;
    }
    ASSERT_GE(stopped, 0) << "it never stopped";
    EXPECT_EQ(calls, 1);
    expectContains(message, "link 'finger' and object 'box'");
    const double at_most = stopped * kTick + 2 * kTick + 0.5 / kDeceleration;  // reaction, braking
    EXPECT_LE(at_most, stop_at + 1e-9) << "as the answer before has proven";
    EXPECT_LT(at_most, 2);
    EXPECT_GT(at_most, 2 - 0.25 - 5 * kTick) << "no sooner than the tolerance of the stop and the answer need";
    EXPECT_GT(stopped * kTick, until) << "run_until was early enough";
    EXPECT_FALSE(collides(run.scene, {at_most, 0, 0}));
    EXPECT_TRUE(run.guard.ask(stopped * kTick + kTick, stopped * kTick).must_stop) << "it stays so";
    EXPECT_EQ(calls, 1);
  }
}

TEST(ExecutionGuard, WithASceneKeptItWouldTouch) {
  // The test above rests on this: without renew() the answers go on, up to most_age.
  Execution run;
  run.guard.follow(run.scene, 0, run.trajectory);
  run.addBox(3.2);
  EXPECT_FALSE(run.guard.ask(0.1, 0.1).must_stop);
  const GuardReply old = run.guard.ask(0.11, 0.11);
  EXPECT_TRUE(old.must_stop);
  EXPECT_EQ(old.answer.reason, GuardReason::old_scene);
  EXPECT_FALSE(old.answer.certified);
  expectContains(old.message, "the scene was seen 0.11 s ago");
  EXPECT_TRUE(collides(run.scene, {2.1, 0, 0}));
}

/// Joints that brake each by itself: the arm swings fast and brakes long, the rail runs and stands at once. Their stop
/// is far from the path, which alone is free.
TEST(ExecutionGuard, JointsThatStopAloneLeaveThePath) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> where(-1.5, 1.5), speed(0.2, 1), half(0.02, 0.2);
  int stops = 0, off_path = 0, at_once = 0, ends = 0;
  for (int i = 0; i < 400; ++i) {
    ExecutionGuardOptions options = optionsOf();
    options.decelerations = {{"rail", 8 * speed(random)}, {"turn", 2 * speed(random)}};
    Execution run(options);
    const std::vector<double> rates{where(random), 1.5 * where(random), 0};
    run.trajectory = trajectoryOf(run.scene, {{0, 0, 0}, {2 * rates[0], 2 * rates[1], 0}}, {2});
    run.guard.follow(run.scene, 0, run.trajectory);
    int stopped = -1;
    for (int tick = 0; tick < 200 && stopped < 0; ++tick) {
      const double now = tick * kTick;
      if (tick == 10) {
        run.scene.getWorldNonConst()->addToObject("box", std::make_shared<shapes::Box>(half(random), half(random), 0.1),
                                                  at(2 * where(random), where(random)));
      }
      run.guard.renew(run.scene, now);
      if (run.guard.ask(now, now).must_stop) stopped = tick;
    }
    if (stopped < 0) {
      ++ends;
      for (int k = 0; k <= 200; ++k) {
        EXPECT_FALSE(k >= 10 && collides(run.scene, {0.01 * k * rates[0], 0.01 * k * rates[1], 0})) << i;
      }
      continue;
    }
    // It comes on for up to the reaction, then each joint brakes.
    const double t = stopped * kTick;
    if (stopped <= 10) {  // it came out of nowhere: no stop may be proven
      ++at_once;
      continue;
    }
    ++stops;
    bool off = false;
    for (const double late : {0.0, 2 * kTick}) {
      for (double after = 0; after < 8; after += 0.02) {
        std::vector<double> q{0, 0, 0}, beside = q;
        const double braking = std::max(0.0, after - late);
        for (int v = 0; v < 2; ++v) {
          const double a = v ? options.decelerations["turn"] : options.decelerations["rail"], w = std::abs(rates[v]);
          const double b = std::min(braking, w / a);
          q[v] = rates[v] * (t + std::min(after, late)) + std::copysign(w * b - a * b * b / 2, rates[v]);
        }
        EXPECT_FALSE(collides(run.scene, q)) << "case " << i << ", stopped at " << t << ", " << after << " s later";
        off = off || std::abs(q[0] * rates[1] - q[1] * rates[0]) > 0.02;
      }
    }
    off_path += off;
  }
  std::cout << stops << " stopped, " << off_path << " of them off the path; " << at_once << " at once, " << ends
            << " reached the end\n";
  EXPECT_GE(stops, 20);
  EXPECT_GE(off_path, 10);
  EXPECT_GE(ends, 20);
}

TEST(ExecutionGuard, APersonWalksIn) {
  // He is beside the finger's end of way, walks to it at up to 1.6 m/s, and stands there.
  ExecutionGuardOptions options = optionsOf(Executor::path);
  options.certifier.tolerances.object_speed = 1.6;
  options.certifier.tolerances.object_speeds = {{"table", 0}};
  Execution run(options);
  run.scene.getWorldNonConst()->addToObject("table", std::make_shared<shapes::Box>(5, 0.1, 0.1), at(1, -0.2));
  const auto person = std::make_shared<shapes::Cylinder>(0.2, 2);
  const auto way = [](double t) { return at(3.6, std::max(0.0, 3.0 - 1.6 * std::max(0.0, t - 0.2))); };
  run.scene.getWorldNonConst()->addToObject("person", person, way(0));
  run.guard.follow(run.scene, 0, run.trajectory);
  double s = 0, factor = 0, slowest = 1;
  GuardReply reply;
  for (int tick = 0; tick < 600; ++tick) {
    const double now = tick * kTick;
    if (tick % 3 == 0) {
      run.scene.getWorldNonConst()->moveShapeInObject("person", person, way(now));
      run.guard.renew(run.scene, now);
    }
    reply = run.guard.ask(now, s, std::max(factor, reply.answer.speed));
    EXPECT_EQ(reply.must_stop, reply.answer.speed == 0);
    slowest = std::min(slowest, reply.answer.certified ? reply.answer.speed : 1);
    const double before = factor;
    factor = std::clamp(reply.answer.speed, factor - kTick * kDeceleration, factor + kTick * kDeceleration);
    s += kTick * (before + factor) / 2;
    EXPECT_FALSE(factor > 0 && collides(run.scene, {s, 0, 0})) << now;
  }
  EXPECT_LT(slowest, 0.5);
  EXPECT_GT(s, 1.5) << "it goes on, as the table stands still";
  EXPECT_LT(s, 2.25);
}

TEST(ExecutionGuard, AnOctomapThatChangesInPlaceIsReadAgain) {
  Execution run;
  const auto cells = std::make_shared<octomap::OcTree>(0.05);
  cells->updateNode(octomap::point3d(0, 0, 5), true);
  run.scene.processOctomapPtr(cells, Eigen::Isometry3d::Identity());
  run.guard.follow(run.scene, 0, run.trajectory);
  EXPECT_TRUE(run.guard.ask(0.01, 0.01).ahead.all_free);
  cells->updateNode(octomap::point3d(3.0F, 0, 0), true);  // as MoveIt's monitor does, under its lock
  run.scene.processOctomapPtr(cells, Eigen::Isometry3d::Identity());
  EXPECT_TRUE(run.guard.ask(0.02, 0.02).ahead.all_free) << "it was not told";
  run.guard.renew(run.scene, 0.02);
  const GuardReply reply = run.guard.ask(0.03, 0.03);
  EXPECT_FALSE(reply.must_stop) << reply.message;
  EXPECT_NEAR(reply.ahead.free_until, 3.0 - 1.15 - 0.25, 2e-3);  // the cell is from 3.0 to 3.05
  EXPECT_EQ(reply.ahead.body2.name, "<octomap>");
}

TEST(ExecutionGuard, PaddingMarginAndTolerancesCount) {
  const auto freeUntil = [](const std::function<void(Execution&)>& before, const ExecutionGuardOptions& options) {
    Execution run(options);
    run.addBox(3.2);
    before(run);
    run.guard.follow(run.scene, 0, run.trajectory);
    return run.guard.ask(0, 0).ahead.free_until;
  };
  const auto nothing = [](Execution&) {};
  const double plain = freeUntil(nothing, optionsOf());
  ExecutionGuardOptions margin = optionsOf(), object = optionsOf(), joints = optionsOf();
  margin.certifier.margin = 0.03;
  EXPECT_NEAR(freeUntil(nothing, margin), plain - 0.03, 2e-3);
  object.certifier.tolerances.objects = 0.02;
  EXPECT_NEAR(freeUntil(nothing, object), plain - 0.02, 2e-3);
  joints.certifier.tolerances.own = {{"rail", 0.02}};
  EXPECT_NEAR(freeUntil(nothing, joints), plain - 0.02, 2e-3) << "beside what the stop takes";
  const auto pad = [](Execution& run) { run.scene.getCollisionEnvNonConst()->setPadding(0.04); };
  EXPECT_NEAR(freeUntil(pad, optionsOf()), plain - 0.04, 2e-3);
  const auto allow = [](Execution& run) {
    for (const char* link : {"cart", "arm", "finger"})
      run.scene.getAllowedCollisionMatrixNonConst().setEntry(link, "box", true);
  };
  EXPECT_EQ(freeUntil(allow, optionsOf()), 3);
}

TEST(ExecutionGuard, WhatCannotBeTakenOverStops) {
  Execution run;
  EXPECT_TRUE(run.guard.ask(0, 0).must_stop) << "nothing is followed";
  run.trajectory = trajectoryOf(run.scene, {{0, 0, 0}, {1, 0, 0}}, {1}, "rail_only");
  const auto begin = [&] {
    run.guard.follow(run.scene, 0, run.trajectory);
    EXPECT_FALSE(run.guard.ask(0, 0).must_stop);
  };
  const auto expectStop = [&](const char* why) {
    run.guard.renew(run.scene, 0);
    const GuardReply reply = run.guard.ask(0, 0);
    EXPECT_TRUE(reply.must_stop);
    EXPECT_FALSE(reply.answer.certified);
    expectContains(reply.message, why);
  };
  begin();
  moveit::core::RobotState& state = run.scene.getCurrentStateNonConst();
  state.setVariablePosition("rail", 0.5);  // of the group: it runs
  run.guard.renew(run.scene, 0);
  EXPECT_FALSE(run.guard.ask(0, 0).must_stop);
  state.setVariablePosition("turn", 0.1);
  expectStop("joint 'turn', outside the group");
  state.setVariablePosition("turn", 0);
  run.guard.renew(run.scene, 0);
  EXPECT_TRUE(run.guard.ask(0, 0).must_stop) << "a stop that has begun";
  begin();

  Surroundings::attach(state, "tool", "finger", std::make_shared<shapes::Sphere>(0.01), {0.2, 0, 0}, {});
  expectStop("'tool'");
  state.clearAttachedBodies();
  begin();
  run.scene.getWorldNonConst()->addToObject("flat", std::make_shared<shapes::Plane>(0, 0, 0, 1), at(0, 0));
  expectStop("plane");
  run.scene.getWorldNonConst()->removeObject("flat");
  begin();
}

TEST(ExecutionGuard, WhatIsRefused) {
  Execution run;
  ExecutionGuardOptions options = optionsOf();
  options.deceleration = 0;
  options.decelerations = {{"turn", 1}};
  ExecutionGuard guard(run.scene.getRobotModel(), options);
  expectContains(refusal([&] { guard.follow(run.scene, 0, run.trajectory); }), "joint 'rail' moves and has no deceler");
  EXPECT_TRUE(guard.ask(0, 0).must_stop);
  run.trajectory = trajectoryOf(run.scene, {{0, 0, 0}, {1, 0, 0}}, {0});
  expectContains(refusal([&] { run.guard.follow(run.scene, 0, run.trajectory); }), "no times");
  for (const auto& [change, what] : std::vector<std::pair<std::function<void(ExecutionGuardOptions&)>, const char*>>{
           {[](auto& o) { o.period = 0; }, "period"},
           {[](auto& o) { o.reaction = -1; }, "reaction"},
           {[](auto& o) { o.most_age = NAN; }, "most_age"},
           {[](auto& o) { o.deceleration = -1; }, "deceleration"},
           {[](auto& o) { o.certifier.margin = -1; }, "margin"},
           {[](auto& o) { o.certifier.tolerances.object_speeds["person"] = -1; }, "object_speeds: person"}}) {
    ExecutionGuardOptions wrong = optionsOf();
    change(wrong);
    expectContains(refusal([&, &change = wrong] { ExecutionGuard(run.scene.getRobotModel(), change); }), what);
  }
  expectContains(refusal([] { executorNamed("drives"); }), "'drives' is no executor");
}

}  // namespace
}  // namespace fcl_artic_moveit
