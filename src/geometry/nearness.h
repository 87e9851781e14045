// SPDX-License-Identifier: BSD-3-Clause
//
// Whether single points are near a geometry.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "geometry/shape_tree.h"

namespace fcl_artic {

/// Finds points that are within a distance of a geometry, in its frame: of its solid pieces, and of the surfaces of its
/// meshes. It says so only of points for which a point of the geometry is known that is as near, but for rounding: 64
/// 2^-52 of the numbers that go in. It may miss one that is near, where a search for the nearest point of a hull, cone
/// or ellipsoid ends early.
class Nearness {
 public:
  /// @param shape  bounded; it must stay alive.
  explicit Nearness(const ShapeTree& shape) : tree_(shape.view()) {}
  /// @param last  the leaf that was near the last point, to be asked first; -1: none.
  bool isNear(const Eigen::Vector3d& x, double most, std::int32_t& last) const;

 private:
  bool isNearPiece(std::int32_t piece, const Eigen::Vector3d& x, double most) const;
  const engine::TreeView& tree_;
};

}  // namespace fcl_artic
