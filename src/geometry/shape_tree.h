// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include <Eigen/Core>

#include "geometry/cloud_tree.h"
#include "geometry/convex_parts.h"
#include "geometry/inner_balls.h"
#include "geometry/large_array.h"
#include "geometry/line_swept_sphere.h"
#include "geometry/obb_tree.h"
#include "geometry/packed_hulls.h"
#include "model/tree_view.h"

namespace fcl_artic {

class SolidSpace;
class SurfacePoints;

/// A geometry as a tree of boxes over convex pieces: owner of what engine::TreeView shows. Constant once built.
///
/// A tree may be empty (view().num_pieces == 0): nothing touches it. It still has node 0 and piece 0, a point at the
/// origin: whoever forgets to ask finds a contact that is none, never the other way round.
class ShapeTree {
  struct Private {};

 public:
  /// A triangle surface; triangle i becomes a piece with primitive id i. Degenerate triangles (no area) count as the
  /// segments or points that they are.
  /// @throws std::invalid_argument: no triangle, an index out of range, a vertex that is not finite.
  /// @param solid  the body is what the surface encloses, too (SolidSpace); then also @throws when it is not closed or
  ///   not consistently oriented.
  static std::shared_ptr<const ShapeTree> fromTriangles(const std::vector<Eigen::Vector3d>& vertices,
                                                        const std::vector<std::array<int, 3>>& triangles,
                                                        bool solid = false);
  /// One triangle that is a shape: its primitive id is -1.
  static std::shared_ptr<const ShapeTree> fromTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                       const Eigen::Vector3d& c);
  /// The convex hull of points, of any number from 1 on, as one piece. They need not all be its corners.
  static std::shared_ptr<const ShapeTree> fromHull(const std::vector<Eigen::Vector3d>& points);
  /// One convex piece without vertices; sizes must be positive and finite. halfspace and
  /// plane: a unit normal; the whole is unbounded then, and its box ends at engine::kUnbounded.
  static std::shared_ptr<const ShapeTree> fromPiece(const engine::Piece& piece);
  /// Bounded pieces without vertices, their primitive ids as given; empty for none.
  static std::shared_ptr<const ShapeTree> fromPieces(const std::vector<engine::Piece>& pieces);
  /// Balls, one at least, their numbers as primitive ids; they are put into another order.
  /// @param radii  one for all, or one each; finite, at least 0.
  /// @param threads  at most; 0: as many as the machine runs at once. The tree does not depend on it.
  static std::shared_ptr<const ShapeTree> fromBalls(const std::vector<Eigen::Vector3d>& centers,
                                                    const std::vector<double>& radii, int threads = 0);

  const engine::TreeView& view() const { return view_; }
  /// The same, a surface cut into convex parts, which are made when first asked for.
  const engine::TreeView& viewWithParts() const;
  /// The same, a body of many pieces with the upper nodes that stage 1 goes into, which are made when first asked for.
  const engine::TreeView& viewWithUpperNodes() const;
  /// Box of the whole in its own frame.
  Eigen::Vector3d lower() const { return Eigen::Vector3f::Map(view_.nodes[0].lo).cast<double>(); }
  Eigen::Vector3d upper() const { return Eigen::Vector3f::Map(view_.nodes[0].hi).cast<double>(); }
  /// Its triangles under a tree of oriented boxes; null for a body that has none (ObbTree::covers). Made when first
  /// asked for.
  const ObbTree* obbTree() const;
  /// A line swept sphere that holds the whole, in the tree's frame. Made when first asked for.
  /// @throws std::invalid_argument when it is unbounded.
  const LineSweptSphere& lineSweptSphere() const;
  /// Balls inside its closed parts; null where there are none. Made when first asked for.
  const engine::InnerBalls* innerBalls() const;
  /// Where points lie in a mesh that is a solid; null for all other bodies.
  const SolidSpace* space() const { return space_.get(); }
  /// Points of all of its parts, for pairs with such a mesh. Made when first asked for.
  const SurfacePoints* surfacePoints() const;
  /// A box that holds the whole, for stage 1.
  engine::CoreBox coreBox() const;
  /// Memory that it takes, roughly.
  std::size_t bytes() const;

  explicit ShapeTree(Private);
  ~ShapeTree();
  ShapeTree(const ShapeTree&) = delete;
  ShapeTree& operator=(const ShapeTree&) = delete;

 private:
  void show();
  void setExtent();
  LineSweptSphere makeLineSweptSphere() const;
  void makeOuter(const std::vector<Eigen::Vector3d>& points);
  engine::Node root_[2];  ///< a single piece's node: most shapes then need no memory but this object's
  engine::Piece outer_;   ///< the piece around the whole; of a single piece, that piece; of a cloud, its first ball
  LargeArray<engine::Node> nodes_;
  LargeArray<engine::Piece> pieces_;
  CloudTree cloud_;  ///< instead of both
  std::vector<double> vertices_;
  PackedHulls hulls_;
  engine::TreeView view_;
  std::unique_ptr<const SolidSpace> space_;
  mutable std::once_flag parts_once_, upper_once_, obb_once_, lss_once_, balls_once_, points_once_;
  mutable LineSweptSphere lss_ = {};
  mutable std::unique_ptr<const ConvexParts> parts_;
  mutable std::vector<engine::UpperNode> upper_;
  mutable engine::TreeView view_with_upper_;
  mutable std::unique_ptr<const ObbTree> obb_;
  mutable std::unique_ptr<const BallsInMesh> balls_;
  mutable std::unique_ptr<const SurfacePoints> points_;
};

using engine::BoxBounds;

/// Binary tree over boxes, node 0 the root; a leaf holds box ~left. Rounded outward. Empty for no boxes.
std::vector<engine::Node> buildBoxTree(const std::vector<BoxBounds>& boxes);

}  // namespace fcl_artic
