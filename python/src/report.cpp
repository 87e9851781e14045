// SPDX-License-Identifier: BSD-3-Clause
//
// Answers as pages for a browser, made as `fcl_artic check --html` makes them.
#include <pybind11/stl.h>

#include "kinematics.h"
#include "options.h"
#include "result.h"
#include "watch.h"
#include "world.h"

#ifdef FCL_ARTIC_HAS_REPORTS
#include "report/page.h"
#include "report/title_line.h"
#endif

namespace fcl_artic::python {

#ifdef FCL_ARTIC_HAS_REPORTS
namespace {

/// The bodies that the page shows; movers by functions that are called with the GIL held.
std::vector<app::PageBody> bodiesOf(const World& world, double begin, double length) {
  std::vector<app::PageBody> bodies = app::linksOf(*world.tree(), world.robot().geometry);
  for (const World::Body& b : world.bodies()) {
    const bool carried = b.carrier >= 0;
    bodies.push_back({b.name,
                      carried ? "attached object" : "obstacle",
                      b.carrier,
                      carried ? b.offset : b.pose,
                      b.object->collisionGeometry(),
                      {}});
  }
  for (const World::MovingObstacle& m : world.movers()) {
    bodies.push_back({m.name, "moving obstacle", -1, Eigen::Isometry3d::Identity(), m.object->collisionGeometry(),
                      [motion = m.motion, begin, length](double t) { return motion.pose((t - begin) / length); }});
  }
  return bodies;
}

py::object reportOn(const World& world, const Question& question, const CertifiedResult* given, py::handle path,
                    const py::kwargs& options) {
  const py::module_ pages = py::module_::import("fcl_artic._report");
  if (!path.is_none()) pages.attr("require_folder_of")(path);
  const auto [begin, end] = app::timeOf(question);
  Request request = readRequest(options);
  const py::object progress = request.progress;
  const CertifiedRequest asked = request.request;
  if (given) {
    requireAnswerOf(world, question, *given);
    if (given->isFree() && !answer(world, question, request).isFree()) {
      valueError(
          "result is free, but asked again with these options the motion is not: it is of another motion, of "
          "another state of the world, or of other options");
    }
  } else {
    request.request.measure_times = true;
  }
  const CertifiedResult result = given ? *given : answer(world, question, std::move(request));
  const std::vector<std::string> notes = world.robot().notes;
  app::Report report{*world.tree(), asked, result,  notes, [&](double t) { return app::configurationAt(question, t); },
                     begin,         end,   nullptr, 1,     given == nullptr || options.size() > 0};
  report.tolerances = world.manager().look([](const ArticulatedCollisionManager& m) { return m.describeTolerances(); });
  if (const auto* trajectory = std::get_if<JointTrajectory>(&question)) report.pieces = trajectory->numPieces();
  const std::vector<app::PageBody> bodies = bodiesOf(world, begin, end - begin);
  app::DistanceOptions measured;
  measured.obstacles = asked.check_scene;
  measured.links = asked.check_self;
  measured.most = app::sizeOf(report, bodies);
  Watch watch(progress);
  app::Distances distances;
  world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    runWatched(watch, [&](const auto& goOn) {
      measured.progress = goOn;
      distances = app::measureDistances(manager, question, measured);
    });
  });
  watch.finish();
  const py::str html(app::htmlPage(report, bodies, distances));
  const py::object page = pages.attr("Report")(html, app::titleLine(result));
  if (!path.is_none()) page.attr("save")(path);
  return page;
}

py::object report(const World& world, py::handle q0, py::handle q1, const CertifiedResult* result, py::handle path,
                  const py::kwargs& options) {
  return reportOn(world, questionOf(world, q0, q1), result, path, options);
}

py::object reportTrajectory(const World& world, py::handle waypoints, py::handle times, py::handle velocities,
                            py::handle accelerations, py::handle blend, bool unwrap, const CertifiedResult* result,
                            py::handle path, const py::kwargs& options) {
  return reportOn(world, trajectoryThrough(*world.tree(), waypoints, times, velocities, accelerations, blend, unwrap),
                  result, path, options);
}

}  // namespace

void bindReport(py::class_<World>& world) {
  world
      .def(
          "report", &report,
          "Makes a page for a browser of the way from q0 to q1 (or a motion or trajectory) and its answer: the motion\n"
          "in 3-D to scrub through, contacts, distances over time. Notebooks show it. With `path` it is saved there.\n"
          "Without `result` the question is asked; options are those of Request. With `result` they only say what it\n"
          "is an answer to; where they are left out, the page says that this is not known.",
          py::arg("q0"), py::arg("q1") = py::none(), py::arg("result") = py::none(), py::arg("path") = py::none())
      .def("report_trajectory", &reportTrajectory,
           "Makes a page as report() does, of the way through waypoints, which check_trajectory() describes.",
           py::arg("waypoints"), py::arg("times") = py::none(), py::kw_only(), py::arg("velocities") = py::none(),
           py::arg("accelerations") = py::none(), py::arg("blend") = py::none(), py::arg("unwrap") = false,
           py::arg("result") = py::none(), py::arg("path") = py::none());
}
#else
void bindReport(py::class_<World>& world) {
  for (const char* name : {"report", "report_trajectory"}) {
    world.def(name, [](const World&, const py::args&, const py::kwargs&) {
      throw std::runtime_error("this module was built without nlohmann-json or fmt: it has no reports");
    });
  }
}
#endif

}  // namespace fcl_artic::python
