// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fcl_artic/result.h"
#include "fcl_artic/urdf/urdf.h"
#include "image.h"

namespace fcl_artic::render {

/// Joint values at t in [0, 1].
using JointPath = std::function<Eigen::VectorXd(double t)>;

struct PictureOptions {
  int width = 1600, height = 1000;              ///< pixels
  std::optional<std::array<double, 2>> camera;  ///< azimuth from +x and elevation, degrees; none: chosen
  std::string title;                            ///< one line; empty: none
};

/// @throws std::runtime_error when this program was built without the component visibility.
void requirePictures();

/// Draws an answer, off screen: the robot at t_lower, the obstacles, the sweep as translucent poses (paler
/// after the contact), and the first contact with its normal. The bodies that touch are highlighted.
/// @param result  with t_lower in [0, 1], as the path.
/// @throws std::runtime_error naming the reason when nothing can be drawn.
Image drawPicture(const Robot& robot, const std::vector<Scene::Obstacle>& obstacles, const JointPath& motion,
                  const CertifiedResult& result, const PictureOptions& options);
/// Draws an answer as drawPicture() does, as a PNG file.
/// @throws std::runtime_error as drawPicture(), and naming the file when it can't be written.
void writePicture(const std::string& path, const Robot& robot, const std::vector<Scene::Obstacle>& obstacles,
                  const JointPath& motion, const CertifiedResult& result, const PictureOptions& options);

}  // namespace fcl_artic::render
