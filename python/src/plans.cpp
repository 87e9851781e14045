// SPDX-License-Identifier: BSD-3-Clause
//
// Anybody's plans in Python.
#include <pybind11/stl.h>

#include <algorithm>

#include "files/files.h"
#include "guard_files.h"
#include "kinematics.h"
#include "plans/carried.h"
#include "plans/motion.h"
#include "plans/plan.h"
#include "world.h"

namespace fcl_artic::python {
namespace {

/// A plan of a file, and the motion that it is.
struct LoadedPlan {
  LoadedPlan(std::shared_ptr<const KinematicTree> of, plans::Plan read, plans::MotionOptions how)
      : tree(std::move(of)), plan(std::move(read)), options(std::move(how)) {
    try {
      motion = plans::toMotion(*tree, plan, options);
    } catch (const std::invalid_argument& problem) {
      error = problem.what();
    }
  }

  std::shared_ptr<const KinematicTree> tree;
  plans::Plan plan;
  plans::MotionOptions options;
  std::optional<plans::PlanMotion> motion;  ///< none: `error` says why
  std::string error;

  const plans::PlanMotion& require() const {
    if (!motion) valueError(error);
    return *motion;
  }
};

/// The state that pickle keeps: all that the motion is made of.
py::tuple planState(const LoadedPlan& p) {
  std::vector<std::pair<std::string, std::string>> carried;
  for (const plans::Carried& one : p.plan.carried) carried.emplace_back(one.name, one.link);
  const plans::MotionOptions& o = p.options;
  return py::make_tuple(
      treeOfRobot(p.tree),
      py::make_tuple(p.plan.name, p.plan.joints, p.plan.times, p.plan.positions, p.plan.velocities,
                     p.plan.accelerations, p.plan.state, carried, p.plan.has_degrees, p.plan.notes, p.plan.error,
                     p.plan.joints_counted, p.plan.foreign, p.plan.other_angles, p.plan.other_units, p.plan.part),
      py::make_tuple(static_cast<int>(o.interpolation), o.blend, static_cast<int>(o.turns), o.ignore_limits,
                     o.limit_tolerance, o.degrees, o.joints, o.state));
}
LoadedPlan planOfState(const py::tuple& state) {
  const py::tuple given = state[1], how = state[2];
  const auto read = [](const py::tuple& from, std::size_t i, auto& to) {
    to = py::cast<std::decay_t<decltype(to)>>(from[i]);
  };
  plans::Plan plan;
  std::vector<std::pair<std::string, std::string>> carried;
  std::size_t i = 0;
  read(given, i++, plan.name);
  read(given, i++, plan.joints);
  read(given, i++, plan.times);
  read(given, i++, plan.positions);
  read(given, i++, plan.velocities);
  read(given, i++, plan.accelerations);
  read(given, i++, plan.state);
  read(given, i++, carried);
  read(given, i++, plan.has_degrees);
  read(given, i++, plan.notes);
  read(given, i++, plan.error);
  read(given, i++, plan.joints_counted);
  read(given, i++, plan.foreign);
  read(given, i++, plan.other_angles);
  read(given, i++, plan.other_units);
  read(given, i++, plan.part);
  for (const auto& [name, link] : carried) plan.carried.push_back({name, link});
  plans::MotionOptions options;
  options.interpolation = static_cast<plans::Interpolation>(py::cast<int>(how[0]));
  read(how, 1, options.blend);
  options.turns = static_cast<plans::Turns>(py::cast<int>(how[2]));
  read(how, 3, options.ignore_limits);
  read(how, 4, options.limit_tolerance);
  read(how, 5, options.degrees);
  read(how, 6, options.joints);
  read(how, 7, options.state);
  return LoadedPlan(treeOf(state[0]), std::move(plan), std::move(options));
}

std::vector<LoadedPlan> load(py::handle path, py::handle tree, const std::string& interpolation, double blend,
                             const std::string& turns, bool ignore_limits, const std::vector<std::string>& joints,
                             const std::map<std::string, double>& state, const std::optional<std::string>& format,
                             const std::vector<std::string>& columns, const std::vector<std::string>& skip,
                             const std::string& time, bool degrees, double limit_tolerance) {
  const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
  const std::shared_ptr<const KinematicTree> of = finishedTreeOf(tree);
  plans::MotionOptions options;
  options.interpolation = plans::interpolationNamed(interpolation);
  if ((options.interpolation == plans::Interpolation::blends) != (blend > 0)) {
    valueError("interpolation='blends' and a blend above 0 go together");
  }
  options.blend = blend;
  options.turns = plans::turnsNamed(turns);
  options.ignore_limits = ignore_limits;
  options.joints = joints;
  options.state = state;
  options.degrees = degrees;
  if (!(limit_tolerance >= 0)) valueError("limit_tolerance is not a number of at least 0");
  options.limit_tolerance = limit_tolerance;
  if (!columns.empty() && !(skip.empty() && time.empty())) valueError("columns says it all: leave skip and time out");
  const plans::ColumnOptions of_csv{columns, skip, time, plans::unnamedColumns(*of, options)};
  const plans::Format kind = format ? plans::formatNamed(*format) : plans::formatOf(file);
  return guardFiles(file, [&] {
    std::vector<LoadedPlan> out;
    try {
      for (plans::Plan& plan : plans::parsePlans(*of, files::read(file), kind, of_csv)) {
        out.emplace_back(of, std::move(plan), options);
      }
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("'" + file + "': " + error.what());
    }
    return out;
  });
}

CertifiedResult certify(const World& world, py::handle value, const py::kwargs& options) {
  const auto& plan = required<LoadedPlan>(value, "plan", "Plan", "load_plans() reads the plans of a file");
  const plans::PlanMotion& motion = plan.require();
  std::vector<plans::Attached> attached;
  for (const World::Body& body : world.bodies()) {
    if (body.carrier >= 0) attached.push_back({{}, {body.name}, body.carrier});
  }
  plans::requireCarried(*world.tree(), plan.plan, attached, "World.attach() says what that is");
  std::string no_clock;
  try {
    plans::requireClock(motion);
  } catch (const std::invalid_argument& why) {
    no_clock = why.what();
  }
  return answer(world, motion.trajectory, readRequest(options), no_clock);
}

py::object arrayOfWaypoints(const LoadedPlan& plan) {
  if (!plan.motion) return py::none();
  const std::vector<Eigen::VectorXd>& q = plan.motion->waypoints;
  RowMajor rows(static_cast<Eigen::Index>(q.size()), q[0].size());
  for (std::size_t k = 0; k < q.size(); ++k) rows.row(static_cast<Eigen::Index>(k)) = q[k].transpose();
  return arrayOfRows(rows);
}

}  // namespace

void bindPlans(py::module_& module, py::class_<World>& world) {
  py::class_<LoadedPlan>(module, "Plan",
                         "A plan of a file, as load_plans() gives it: what it says, and the motion that it is.")
      .def_property_readonly(
          "name", [](const LoadedPlan& p) { return textOf(p.plan.name); }, "Within its file; '' for the only one.")
      .def_property_readonly(
          "error",
          [](const LoadedPlan& p) -> py::object { return p.motion ? py::none() : py::object(textOf(p.error)); },
          "What is wrong with it, naming waypoint and joint; None where nothing is.")
      .def_property_readonly(
          "trajectory",
          [](const py::object& self) {
            const Recipe how("__getattribute__", py::make_tuple("trajectory"), self);
            return MadeTrajectory(py::cast<const LoadedPlan&>(self).require().trajectory, how);
          },
          "The motion that is asked about. A ValueError for a plan with an error.")
      .def_property_readonly(
          "interpolation",
          [](const LoadedPlan& p) -> py::object {
            return p.motion ? py::object(py::str(plans::toString(p.motion->interpolation))) : py::none();
          },
          "What lies between the waypoints, as the option `interpolation` names it: 'linear', 'cubic', 'jtc-upsampled' "
          "...")
      .def_property_readonly(
          "times",
          [](const LoadedPlan& p) -> py::object {
            if (!p.motion) return py::none();
            const std::vector<double>& t = p.motion->times;
            return arrayOf(
                Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(t.data(), static_cast<Eigen::Index>(t.size()))));
          },
          "Of the waypoints; 0, 1, 2 ... where the plan has none.")
      .def_property_readonly("waypoints", &arrayOfWaypoints, "(N, n): all joints of the robot.")
      .def_property_readonly(
          "joints",
          [](const LoadedPlan& p) -> py::object { return p.motion ? py::cast(p.motion->joints) : py::none(); },
          "What the file's columns are taken for, in their order: as it names them, else by the option `joints`, else\n"
          "the robot's order.")
      .def_property_readonly(
          "carried",
          [](const LoadedPlan& p) {
            std::vector<std::string> names;
            for (const plans::Carried& one : p.plan.carried) names.push_back(one.name);
            return names;
          },
          "Objects that the message says the robot carries.")
      .def_property_readonly(
          "notes",
          [](const LoadedPlan& p) {
            return textsOf(p.motion ? p.motion->notes : plans::notesOf(p.plan, p.options.degrees));
          },
          "What was accepted though unusual.")
      .def(
          "waypoint_before", [](const LoadedPlan& p, double t) { return p.require().waypointBefore(t); },
          "Number of the waypoint at or before time t.", py::arg("t"))
      .def(py::pickle(&planState, &planOfState))
      .def("__repr__", [](const LoadedPlan& p) {
        if (!p.motion) return py::str("<Plan {!r}: {}>").format(p.plan.name, p.error);
        return py::str("<Plan {!r}: {} waypoints, {}>")
            .format(p.plan.name, p.motion->times.size(), plans::toString(p.motion->interpolation));
      });
  module.def(
      "load_plans", &load,
      "Reads the plans of a file (CSV, JSON, JSON lines, YAML and messages of ROS, OMPL's text, NumPy's arrays) for a\n"
      "robot. A plan that is wrong by itself has an `error`. `state` has values of joints that plans do not name.\n"
      "`columns`, `skip` and `time` say what columns of CSV files are, where their first line does not; `degrees`: "
      "angles\n"
      "are in degrees; `limit_tolerance`: by so much waypoints may be beyond limits, rad, and m for a tenth of it.",
      py::arg("path"), py::arg("robot"), py::kw_only(), py::arg("interpolation") = "auto", py::arg("blend") = 0.0,
      py::arg("turns") = "ask", py::arg("ignore_limits") = false, py::arg("joints") = std::vector<std::string>(),
      py::arg("state") = std::map<std::string, double>(), py::arg("format") = py::none(),
      py::arg("columns") = std::vector<std::string>(), py::arg("skip") = std::vector<std::string>(),
      py::arg("time") = "", py::arg("degrees") = false,
      py::arg("limit_tolerance") = plans::MotionOptions().limit_tolerance);
  world.def(
      "certify", &certify,
      "Finds the first contact of a plan of load_plans(), or proves that there is none. Options are those of Request.",
      py::arg("plan"));
}

}  // namespace fcl_artic::python
