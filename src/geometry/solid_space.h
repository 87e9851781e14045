// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes that are solids: where a point lies, and whether one body is within the other at a pose (doc/NUMERICS.md,
// "Solid meshes").
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "model/problem.h"

namespace fcl_artic {

/// A closed, consistently oriented mesh as a solid: its surface, and the points that the surface winds around a number
/// of times other than 0.
class SolidSpace {
 public:
  /// @param mesh  of triangles only; outlives this.
  explicit SolidSpace(const engine::TreeView& mesh) : mesh_(mesh) {}

  enum class Side { outside, inside, unknown };
  /// Where all points within `error` of x lie. Unknown where the surface is as near, or too near to decide.
  /// @param[out] nearest  a point of the surface near x, when it lies inside: about the shortest way out.
  Side sideOf(const Eigen::Vector3d& x, double error, Eigen::Vector3d& nearest) const;
  /// Lower bound of x's distance from the surface.
  double clearance(const Eigen::Vector3d& x, Eigen::Vector3d& nearest) const;

  /// How often the surface winds around points.
  struct Winding {
    bool known = false;
    int number = 0;
  };
  /// Around x itself; not known where the line through x along the axis comes too near an edge, or the surface too near
  /// x.
  Winding winding(const Eigen::Vector3d& x, int axis) const;

 private:
  const engine::TreeView& mesh_;
};

/// Points of a bounded body, some for each part of its surface that hangs together (mesh), or for each of its pieces.
class SurfacePoints {
 public:
  explicit SurfacePoints(const engine::TreeView& tree);

  static constexpr std::size_t kPerPart = 4;
  /// The points of one part.
  struct Part {
    Eigen::Vector3d points[kPerPart];
  };
  const std::vector<Part>& parts() const { return parts_; }
  /// Over boxes of the parts' first points; leaf i is part i.
  const std::vector<engine::Node>& tree() const { return tree_; }

 private:
  std::vector<Part> parts_;
  std::vector<engine::Node> tree_;
};

/// engine::Problem::contained.
void findContained(const engine::Body& a, const engine::Body& b, const engine::PairPose& pose,
                   engine::ContainmentVerdict& found);

}  // namespace fcl_artic
