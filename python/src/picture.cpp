// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures of answers, drawn as `fcl_artic check --image` draws them.
#include <algorithm>
#include <cmath>
#include <mutex>

#include <pybind11/stl.h>

#include "result.h"
#include "world.h"

#ifdef FCL_ARTIC_HAS_PICTURES
#include "render/image.h"
#include "render/picture.h"
#include "report/title_line.h"
#endif

namespace fcl_artic::python {

#ifdef FCL_ARTIC_HAS_PICTURES
namespace {

using Image = py::array_t<std::uint8_t, py::array::c_style>;

int pixelsOf(py::handle size, std::size_t i) {
  const int pixels = py::cast<int>(py::object(py::reinterpret_borrow<py::sequence>(size)[i]));
  if (pixels < 64 || pixels > 4096) valueError("size has " + std::to_string(pixels) + ", not 64 to 4096 pixels");
  return pixels;
}

/// A result in the picture's time, [0, 1], whose bodies are the world's own, found by their names: it may come from
/// another process.
CertifiedResult inPicture(const World& world, const CertifiedResult& result, double begin, double length,
                          const std::vector<Scene::Obstacle>& obstacles) {
  CertifiedResult drawn = result;
  drawn.t_lower = std::clamp((result.t_lower - begin) / length, 0.0, 1.0);
  for (CertifiedContact& c : drawn.contacts) {
    for (BodyRef* body : {&c.body1, &c.body2}) {
      body->object = nullptr;
      if (body->link >= world.tree()->numLinks()) valueError("result is of another robot");
      for (const Scene::Obstacle& o : obstacles) {
        if (o.name == body->name) body->object = o.object.get();
      }
    }
  }
  return drawn;
}

py::object picture(const World& world, py::handle q0, py::handle q1, const CertifiedResult* given, py::handle size,
                   const std::optional<std::array<double, 2>>& camera, const std::optional<std::string>& title) {
  const Question question = questionOf(world, q0, q1);
  if (camera && !(std::isfinite((*camera)[0]) && std::isfinite((*camera)[1]))) {
    valueError("camera has an angle that is not finite");
  }
  if (given) requireAnswerOf(world, question, *given);
  const CertifiedResult result = given ? *given : answer(world, question, {});
  double begin = 0, length = 1;
  if (const auto* trajectory = std::get_if<JointTrajectory>(&question)) {
    begin = trajectory->beginTime();
    length = trajectory->endTime() - begin;
  }
  const double at = std::clamp((result.t_lower - begin) / length, 0.0, 1.0);
  Robot robot = world.robot();
  std::vector<Scene::Obstacle> obstacles;
  for (const World::Body& body : world.bodies()) {
    if (body.carrier >= 0) {
      robot.geometry.push_back({body.carrier, body.offset, body.object, "attached"});
    } else {
      // A copy: the world's own may be moved meanwhile.
      const auto shape = std::const_pointer_cast<fcl::CollisionGeometryd>(body.object->collisionGeometry());
      obstacles.push_back({body.name, objectOf({shape}, body.pose)});
    }
  }
  for (const World::MovingObstacle& mover : world.movers()) {
    const auto shape = std::const_pointer_cast<fcl::CollisionGeometryd>(mover.object->collisionGeometry());
    obstacles.push_back({mover.name, objectOf({shape}, mover.motion.pose(at))});
  }
  const CertifiedResult drawn = inPicture(world, result, begin, length, obstacles);
  render::PictureOptions options;
  options.width = pixelsOf(size, 0);
  options.height = pixelsOf(size, 1);
  options.camera = camera;
  options.title = title ? *title : app::titleLine(result);
  const render::JointPath path = [&](double t) {
    const auto* motion = std::get_if<JointMotion>(&question);
    return motion ? motion->configuration(t) : std::get<JointTrajectory>(question).configuration(begin + length * t);
  };
  render::Image image;
  {
    const GilReleased released;
    const InLibrary within;
    static std::mutex one;  // OpenGL's contexts are one thread's
    const std::lock_guard<std::mutex> lock(one);
    image = render::drawPicture(robot, obstacles, path, drawn, options);
  }
  Image array({image.height, image.width, 3});
  std::copy(image.rgb.begin(), image.rgb.end(), array.mutable_data());
  return py::module_::import("fcl_artic._picture").attr("Picture")(array);
}

py::bytes png(const Image& array) {
  if (array.ndim() != 3 || array.shape(2) != 3) valueError("an image has shape (height, width, 3)");
  render::Image image;
  image.height = static_cast<int>(array.shape(0));
  image.width = static_cast<int>(array.shape(1));
  image.rgb.assign(array.data(), array.data() + array.size());
  return render::png(image);
}

}  // namespace

void bindPicture(py::module_& module, py::class_<World>& world) {
  world.def(
      "picture", &picture,
      "Draws the way from q0 to q1 (or a motion or trajectory) and its answer: the robot where the first contact is,\n"
      "where it comes from, and the contact with its normal. `camera` is azimuth and elevation in degrees.",
      py::arg("q0"), py::arg("q1") = py::none(), py::kw_only(), py::arg("result") = py::none(),
      py::arg("size") = py::make_tuple(1600, 1000), py::arg("camera") = py::none(), py::arg("title") = py::none());
  module.def("_png", &png, py::arg("image"));
}
#else
void bindPicture(py::module_&, py::class_<World>& world) {
  world.def("picture", [](const World&, const py::args&, const py::kwargs&) {
    throw std::runtime_error("this module was built without the component visibility or libpng: it has no pictures");
  });
}
#endif

}  // namespace fcl_artic::python
