// SPDX-License-Identifier: BSD-3-Clause
//
// Answers to look at: a picture, a page for a browser.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "report/distances.h"
#include "report/report.h"
#include "world.h"

namespace fcl_artic::app {

struct ViewOptions {
  std::string image, html;         ///< files; empty: none
  std::string size = "1600x1000";  ///< of the picture, WxH in pixels
  std::string camera;              ///< azimuth,elevation in degrees; empty: chosen
  bool wanted() const { return !image.empty() || !html.empty(); }
};

/// Adds --image, --size, --camera and --html, in the group "Output".
/// @return --image and --html, for what excludes them.
std::vector<CLI::Option*> addViewOptions(CLI::App& verb, ViewOptions& options);

/// Writes what is asked for.
/// @param motion  that `report` is of, of the world's robot.
/// @throws std::runtime_error naming the file, or why nothing can be drawn.
void writeViews(const ViewOptions& options, const World& world, const ArticulatedCollisionManager& manager,
                const RobotMotion& motion, const Report& report);

}  // namespace fcl_artic::app
