// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "geometry/closed_parts.h"
#include "geometry/line_swept_sphere.h"
#include "geometry/mesh_triangle.h"
#include "model/tree_view.h"

namespace fcl_artic {

/// The space that the closed parts of a mesh enclose, as far as it is certain (doc/NUMERICS.md, "Inner balls").
class EnclosedSpace {
 public:
  /// @param mesh  of triangles only; outlives this.
  explicit EnclosedSpace(const engine::TreeView& mesh) : mesh_(mesh), parts_(findClosedParts(mesh)) {}

  const ClosedParts& parts() const { return parts_; }
  /// Lower bound of x's distance from a part's triangles.
  /// @param[out] nearest  about where that is.
  double clearance(std::int32_t part, const Eigen::Vector3d& x, Eigen::Vector3d& nearest) const;
  /// The part certainly goes around x an odd number of times.
  bool certainlyEncloses(std::int32_t part, const Eigen::Vector3d& x) const;

  using Crossing = LineCrossing;
  /// All of a part's triangles that the line through x along an axis crosses. False where it comes too near an edge to
  /// decide.
  bool crossings(std::int32_t part, const Eigen::Vector3d& x, int axis, std::vector<Crossing>& found) const;

 private:
  const engine::TreeView& mesh_;
  ClosedParts parts_;
};

/// A few large balls inside the closed parts of a mesh.
class BallsInMesh {
 public:
  /// @param around  holds the mesh.
  /// @return null for a body that is no mesh of triangles, or in which none are found.
  static std::unique_ptr<const BallsInMesh> find(const engine::TreeView& mesh, const LineSweptSphere& around);

  const engine::InnerBalls& view() const { return balls_; }

 private:
  BallsInMesh() = default;
  engine::InnerBalls balls_;
  std::vector<engine::ClosedPart> parts_;
};

}  // namespace fcl_artic
