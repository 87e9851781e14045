// SPDX-License-Identifier: BSD-3-Clause
#include "views.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "files/files.h"
#include "progress.h"
#include "render/picture.h"
#include "report/page.h"
#include "report/title_line.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

constexpr double kMaxPixels = 4096;  // a side; the buffers to draw in are twice as large

/// Two numbers with a separator between them, as "1600x1000" or "-60,25"; nothing when the text is something else.
std::optional<std::array<double, 2>> numberPair(const std::string& text, char separator) {
  const char* at = text.c_str();
  char* end = nullptr;
  std::array<double, 2> out{};
  out[0] = std::strtod(at, &end);
  if (end == at || *end != separator) return std::nullopt;
  at = end + 1;
  out[1] = std::strtod(at, &end);
  if (end == at || *end != '\0') return std::nullopt;
  return out;
}

std::string requireSize(const std::string& text) {
  const auto size = numberPair(text, 'x');
  const bool good =
      size && (*size)[0] >= 64 && (*size)[1] >= 64 && (*size)[0] <= kMaxPixels && (*size)[1] <= kMaxPixels;
  return good ? "" : "'" + text + "' is not a size WxH in pixels from 64x64 to 4096x4096";
}

std::string requireCamera(const std::string& text) {
  const auto angles = numberPair(text, ',');
  const bool good = angles && std::abs((*angles)[0]) <= 360 && std::abs((*angles)[1]) <= 90;
  return good ? "" : "'" + text + "' is not azimuth,elevation in degrees, as -60,25";
}

/// Writes the answer as a page.
void writePage(const std::string& file, const World& world, const ArticulatedCollisionManager& manager,
               const RobotMotion& motion, const Report& report) {
  std::vector<PageBody> bodies = linksOf(report.tree, world.robot.geometry);
  const std::size_t carried = world.scene.obstacles.size() - world.attachments.size();
  for (std::size_t i = 0; i < world.scene.obstacles.size(); ++i) {
    const Scene::Obstacle& o = world.scene.obstacles[i];
    PageBody body{o.name, "obstacle", -1, Eigen::Isometry3d(o.object->getTransform()), o.object->collisionGeometry(),
                  {}};
    if (i >= carried) {
      const Attachment& a = world.attachments[i - carried];
      body.kind = "attached object";
      body.link = report.tree.linkId(a.link);
      body.pose = a.pose;
    }
    bodies.push_back(body);
  }
  DistanceOptions measured;
  measured.obstacles = report.request.check_scene;
  measured.links = report.request.check_self;
  measured.most = sizeOf(report, bodies);
  const WaitingNote note("writing " + file);
  files::write(file, htmlPage(report, bodies, measureDistances(manager, motion, measured)));
}

}  // namespace

std::vector<CLI::Option*> addViewOptions(CLI::App& verb, ViewOptions& options) {
  CLI::Option* image = verb.add_option("--image", options.image, "Draw robot, sweep and first contact as PNG")
                           ->check(requirePng)
                           ->group("Output")
                           ->type_name("FILE");
  verb.add_option("--size", options.size, "Size of the picture in pixels")
      ->check(requireSize)
      ->needs(image)
      ->group("Output")
      ->type_name("WxH")
      ->capture_default_str();
  verb.add_option("--camera", options.camera,
                  "Where the picture is seen from: azimuth from +x and elevation, in degrees; "
                  "without it a view that shows the contact is chosen")
      ->check(requireCamera)
      ->needs(image)
      ->group("Output")
      ->type_name("AZ,EL");
  CLI::Option* html =
      verb.add_option(
              "--html", options.html,
              "Write the answer as a page for a browser: the motion in 3-D to scrub through, contacts, distances")
          ->group("Output")
          ->type_name("FILE");
  return {image, html};
}

void writeViews(const ViewOptions& options, const World& world, const ArticulatedCollisionManager& manager,
                const RobotMotion& motion, const Report& report) {
  const double length = report.end - report.begin;
  if (!options.image.empty()) {
    const auto size = *numberPair(options.size, 'x');
    render::PictureOptions picture;
    picture.width = static_cast<int>(size[0]);
    picture.height = static_cast<int>(size[1]);
    picture.title = titleLine(report.result);
    if (!options.camera.empty()) picture.camera = numberPair(options.camera, ',');
    CertifiedResult drawn = report.result;  // in the time of a picture
    drawn.t_lower = (report.result.t_lower - report.begin) / length;
    const auto path = [&](double t) { return report.configuration(report.begin + t * length); };
    Robot shown = world.robot;
    Scene scene = world.scene;
    moveToLinks(world.attachments, scene, shown);
    const WaitingNote note("drawing " + options.image);
    render::writePicture(options.image, shown, scene.obstacles, path, drawn, picture);
  }
  if (!options.html.empty()) {
    writePage(options.html, world, manager, motion, report);
  }
}

}  // namespace fcl_artic::app
