// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "image.h"
#include "triangles.h"

namespace fcl_artic::render {

/// A triangle mesh with a normal at each corner: smooth over gentle edges, sharp at others.
struct Surface {
  std::vector<Eigen::Vector3f> corners;  ///< three per triangle, body's frame, m
  std::vector<Eigen::Vector3f> normals;  ///< one per corner, unit
  Eigen::AlignedBox3f box;               ///< around the corners
};
std::shared_ptr<const Surface> makeSurface(const Triangles& triangles);

/// Something to draw. Colours are linear RGB.
struct Body {
  std::shared_ptr<const Surface> surface;
  Eigen::Isometry3d M_0 = Eigen::Isometry3d::Identity();  ///< body to world
  Eigen::Vector3f color = Eigen::Vector3f::Constant(0.5f);
  Eigen::Vector3f highlight = Eigen::Vector3f::Zero();  ///< mixed in around the picture's focus
  float highlight_radius = 1e-6f;                       ///< m
  float highlight_floor = 0;                            ///< share mixed in everywhere
  float glow = 0;                                       ///< 0: shaded, 1: flat colour
  bool throws_shadow = true;
  bool clear_of_ghosts = false;  ///< ghosts in front of it are nearly invisible, and it shimmers through obstacles
};

/// One translucent pose.
struct Ghost {
  std::vector<Body> bodies;
  float opacity = 0.3f;
};

struct Camera {
  Eigen::Vector3d eye = Eigen::Vector3d::UnitX(), target = Eigen::Vector3d::Zero();
  double near = 0.01, far = 100;  ///< m
};
/// Full angle of view from bottom to top, rad.
constexpr double kFieldOfView = 0.56;

/// The bodies to draw, world frame with z up.
struct Stage {
  std::vector<Body> solid;
  std::vector<Ghost> ghosts;                        ///< first one lies lowest
  std::vector<Body> annotations;                    ///< on top of everything, with a light rim
  Eigen::Vector3d focus = Eigen::Vector3d::Zero();  ///< middle of interest
  double radius = 1;                                ///< of the ball around `focus` that matters, m
  Eigen::Vector3d highlight_center = Eigen::Vector3d::Zero();
  double ground_z = 0;
};

/// Draws stages off screen, by OSMesa or else EGL. One renderer at a time and thread.
class Renderer {
 public:
  /// @throws std::runtime_error when OpenGL 3.3 can't be had or a shader does not compile.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  Image draw(const Stage& stage, const Camera& camera, int width, int height);

  /// Pixels that each group of bodies covers in a small view; what hides behind another body doesn't count.
  /// @param groups  one entry per body, 0 to 254.
  std::vector<int> visiblePixels(const std::vector<Body>& bodies, const std::vector<int>& groups, const Camera& camera,
                                 int width, int height);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic::render
