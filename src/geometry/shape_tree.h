// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "narrowphase/problem.h"

namespace fcl_artic {

/// A geometry as a tree of boxes over convex pieces: owner of what engine::TreeView shows. Constant once built.
class ShapeTree {
 public:
  /// A triangle surface; triangle i becomes a piece with primitive id ids[i]. Degenerate triangles (no area) count as the
  /// segments or points that they are.
  /// @throws std::invalid_argument: no triangle, an index out of range, a vertex that is not finite.
  static std::shared_ptr<const ShapeTree> fromTriangles(const std::vector<Eigen::Vector3d>& vertices,
                                                        const std::vector<std::array<int, 3>>& triangles);
  /// One convex piece, as SHAPES section 1.3 has it; sizes must be positive and finite.
  static std::shared_ptr<const ShapeTree> fromPiece(const engine::Piece& piece);

  const engine::TreeView& view() const { return view_; }
  /// Box of the whole in its own frame.
  Eigen::Vector3d lower() const;
  Eigen::Vector3d upper() const;
  /// A line swept sphere that holds the whole: p0, p1, r in the tree's frame.
  std::array<double, 7> lineSweptSphere() const;

 private:
  ShapeTree() = default;
  void build();
  void makeOuter(const std::vector<Eigen::Vector3d>& points);
  std::vector<engine::Node> nodes_;
  std::vector<engine::Piece> pieces_;
  std::vector<double> vertices_;
  std::vector<double> hulls_;  ///< with room for alignment
  engine::Piece outer_;
  engine::TreeView view_;
};

/// Boxes to be put into a tree: the same builder serves pieces and obstacles.
struct BoxBounds {
  double lo[3], hi[3];
};
/// Binary tree over boxes, node 0 the root; a leaf holds box ~left. Rounded outward. Empty for no boxes.
std::vector<engine::Node> buildBoxTree(const std::vector<BoxBounds>& boxes);

}  // namespace fcl_artic
