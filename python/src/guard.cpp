// SPDX-License-Identifier: BSD-3-Clause
//
// A guard in Python. Its scene is what a world was like when it was renewed; worlds are changed as ever.
#include "fcl_artic/guard.h"

#include <pybind11/stl.h>

#include <memory>
#include <stdexcept>

#include "array.h"
#include "enums.h"
#include "kinematics.h"
#include "options.h"
#include "world.h"

namespace fcl_artic::python {
namespace {

/// A guard that threads share: one after the other asks.
using SharedGuard = Guarded<Guard>;

/// A copy of the world's manager. The world moves its objects in place: scenes hold what was read of them, and never
/// look at them again. In a turn at the world's manager.
ArticulatedCollisionManager copyOf(const World& world, const ArticulatedCollisionManager& manager) {
  if (world.movers().empty()) return manager.copy();
  throw std::invalid_argument("LiveScene: '" + world.movers().front().name +
                              "' has a motion of its own, which stops for nobody: add() it where it is seen, and "
                              "set_object_speed()");
}

std::unique_ptr<LiveScene> makeScene(const World& world, double seen_at) {
  return world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    // (It reads all objects again: nobody moves them while this asks.)
    return std::make_unique<LiveScene>(copyOf(world, manager), seen_at);
  });
}

void renew(LiveScene& scene, const World& world, double seen_at) {
  world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    scene.renew(seen_at, [&](ArticulatedCollisionManager& copy) { copy = copyOf(world, manager); });
  });
}

double seenAt(const LiveScene& scene) {
  const GilReleased released;
  const InLibrary within;
  return scene.latest()->seen_at;
}

std::unique_ptr<SharedGuard> makeGuard(py::handle robot, py::handle deceleration, double period, double reaction,
                                       double most_age, double margin, double added_margin, int tries,
                                       py::handle work_budget, py::handle check_self, py::handle check_scene) {
  const std::shared_ptr<const KinematicTree> tree = finishedTreeOf(robot);
  GuardOptions options;
  const bool one = py::isinstance<py::float_>(deceleration) || py::isinstance<py::int_>(deceleration);
  options.deceleration = one ? Eigen::VectorXd::Constant(tree->dof(), numberOf(deceleration, "deceleration"))
                             : vectorOf(deceleration, "deceleration");
  options.period = period;
  options.reaction = reaction;
  options.most_age = most_age;
  options.margin = margin;
  options.added_margin = added_margin;
  options.tries = tries;
  options.work_budget = countOf(work_budget, "work_budget");
  options.check_self = flagOf(check_self, "check_self");
  options.check_scene = flagOf(check_scene, "check_scene");
  return std::make_unique<SharedGuard>(tree, std::move(options));
}

py::object classOf(const char* name) {
  return py::module_::import("fcl_artic._guard").attr(name);
}

py::object pairOf(const BodyRef& a, const BodyRef& b) {
  if (a.name.empty() && b.name.empty()) return py::none();
  return py::make_tuple(a.name, b.name);
}

py::object ask(SharedGuard& guard, const LiveScene& scene, double now, double path_time, double path_speed) {
  GuardAnswer a;
  guard.changeAtOnce([&](Guard& g) { g.ask(*scene.latest(), now, path_time, path_speed, a); });
  const Separation& s = a.separation;
  const py::object separation =
      classOf("Separation")(s.human_reacting, s.human_stopping, s.robot_reacting, s.robot_stopping, s.object, s.robot);
  return classOf("GuardAnswer")(a.speed, a.valid_until, a.braking, a.stop_time, a.stop_at, a.certified,
                                memberOf(a.reason), pairOf(a.body1, a.body2), a.near_at, separation, a.tests);
}

py::object lookAhead(SharedGuard& guard, const LiveScene& scene, double now, double path_time) {
  AheadAnswer a;
  guard.changeAtOnce([&](Guard& g) { g.lookAhead(*scene.latest(), now, path_time, a); });
  return classOf("AheadAnswer")(a.free_until, a.run_until, a.braking, a.all_free, memberOf(a.reason),
                                pairOf(a.body1, a.body2), a.tests);
}

}  // namespace

void bindGuard(py::module_& module) {
  py::class_<LiveScene>(module, "LiveScene",
                        "A world as a sensor saw it at one time, for a guard. One thread changes the world and renews "
                        "the\n"
                        "scene, others ask meanwhile: they have the last scene until the next one is complete.")
      .def(py::init(&makeScene), "Takes the world as it is. `seen_at`: when, s, by the caller's clock.",
           py::arg("world"), py::arg("seen_at"))
      .def("renew", &renew,
           "Takes the world as it is now: what is changed in it later does not reach the scene. `seen_at`: when the\n"
           "sensor saw all of it, s.",
           py::arg("world"), py::arg("seen_at"))
      .def_property_readonly("seen_at", &seenAt, "When the scene was seen, s, by the caller's clock.")
      .def("__repr__",
           [](const LiveScene& scene) { return py::str("<LiveScene: seen at {:.6g} s>").format(seenAt(scene)); });
  const GuardOptions defaults;
  py::class_<SharedGuard>(
      module, "Guard",
      "Lets a robot follow a trajectory only while a stop is certified. Each answer covers the motion until the next\n"
      "one and the stop after it, against the scene, with all tolerances and speeds of the world (doc/GUARD.md).\n"
      "`deceleration`: how much the drives can brake along the path, rad/s² or m/s², of each variable or one number "
      "for\n"
      "all; `period`: the next answer comes within it, s; `reaction`: an answer counts from then on, s; `most_age`: "
      "an\n"
      "older scene lets nothing move, s; `margin`, `added_margin`: m; `tries`: speeds between the slowest and the "
      "full\n"
      "one; `work_budget`: most tests of one answer, 0: no limit.")
      .def(py::init(&makeGuard), py::arg("robot"), py::kw_only(), py::arg("deceleration"),
           py::arg("period") = defaults.period, py::arg("reaction") = defaults.reaction,
           py::arg("most_age") = defaults.most_age, py::arg("margin") = defaults.margin,
           py::arg("added_margin") = defaults.added_margin, py::arg("tries") = defaults.tries,
           py::arg("work_budget") = defaults.work_budget, py::arg("check_self") = defaults.check_self,
           py::arg("check_scene") = defaults.check_scene)
      .def(
          "follow",
          [](SharedGuard& guard, const JointTrajectory& trajectory) {
            guard.changeAtOnce([&](Guard& g) { g.follow(trajectory); });
          },
          "Takes the trajectory that the robot follows from now on; its times are in s.", py::arg("trajectory"))
      .def("ask", &ask,
           "How the robot may go on. `now`: s, by the scene's clock; `path_time`: the trajectory's time at which the "
           "robot\n"
           "is; `path_speed`: the largest factor of speed that it may have until the answer is followed, 0 to 1.",
           py::arg("scene"), py::arg("now"), py::arg("path_time"), py::arg("path_speed"))
      .def("look_ahead", &lookAhead,
           "How far ahead the trajectory is free at full speed, and until when a stop is possible that ends before "
           "that.",
           py::arg("scene"), py::arg("now"), py::arg("path_time"));
}

}  // namespace fcl_artic::python
