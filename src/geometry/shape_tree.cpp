// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shape_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "geometry/closed_parts.h"
#include "geometry/curve_tree.h"
#include "geometry/outer_hull.h"
#include "geometry/solid_space.h"
#include "geometry/wide_tree.h"
#include "numerics/baseline_isa.h"

#include "convex/cloud.h"
#include "numerics/assertion.h"
#include "numerics/constants.h"

namespace fcl_artic {
namespace {

using baseline::makeLeaf;
using baseline::setRadius;
using engine::Node;
using engine::Piece;
using engine::PieceKind;

/// With this number, three coordinates for each point are counted in 32 bits.
constexpr std::size_t kMaxHullPoints = 500000000;

/// The tree over given leaves, one at least; leaf i holds piece i.
class Builder {
 public:
  /// @param nodes  2 a leaf.
  Builder(const std::vector<Node>& leaves, Node* nodes)
      : leaves_(leaves), order_(leaves.size()), keys_(leaves.size()), nodes_(nodes) {
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint32_t>(i);
  }
  void run() {
    used_ = 2;
    build(0, 0, leaves_.size());
    nodes_[1] = nodes_[0];
  }

 private:
  /// Median split across the longest side. It is as good as a surface area heuristic here (measured), and balanced, so
  /// recursion is shallow whatever the input.
  void build(std::size_t me, std::size_t begin, std::size_t end) {
    if (end - begin == 1) {
      nodes_[me] = leaves_[order_[begin]];
      return;
    }
    Node node = leaves_[order_[begin]];
    for (std::size_t i = begin + 1; i < end; ++i) {
      const Node& leaf = leaves_[order_[i]];
      for (int k = 0; k < 3; ++k) {
        node.lo[k] = std::min(node.lo[k], leaf.lo[k]);
        node.hi[k] = std::max(node.hi[k], leaf.hi[k]);
      }
    }
    setRadius(node);
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (node.hi[k] - node.lo[k] > node.hi[axis] - node.lo[axis]) axis = k;
    }
    const std::size_t half = (begin + end) / 2;
    if (end - begin > 2) {
      // Keys order by the boxes' middles, then by the index: the same tree on every machine, in one comparison.
      for (std::size_t i = begin; i < end; ++i) {
        const Node& leaf = leaves_[order_[i]];
        const float middle = leaf.lo[axis] + leaf.hi[axis] + 0.0f;  // + 0: no negative zero
        std::uint32_t bits;
        std::memcpy(&bits, &middle, sizeof bits);
        bits ^= bits >> 31 ? 0xffffffffu : 0x80000000u;
        keys_[i] = static_cast<std::uint64_t>(bits) << 32 | order_[i];
      }
      const auto at = [&](std::size_t i) { return keys_.begin() + static_cast<std::ptrdiff_t>(i); };
      std::nth_element(at(begin), at(half), at(end));
      for (std::size_t i = begin; i < end; ++i) order_[i] = static_cast<std::uint32_t>(keys_[i]);
    }
    const std::size_t left = used_;
    used_ += 2;
    node.child = static_cast<std::int32_t>(left);
    nodes_[me] = node;
    build(left, begin, half);
    build(left + 1, half, end);
  }
  const std::vector<Node>& leaves_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> keys_;
  Node* const nodes_;
  std::size_t used_ = 0;
};

/// Box of a bounded shape; sets its reach.
BoxBounds measure(Piece& piece) {
  BoxBounds box;
  baseline::Vec3 half;
  double sum = 0;
  if (!baseline::coreHalfSizes(piece, half)) throw std::invalid_argument("this kind of piece has no size of its own");
  for (int k = 0; k < 3; ++k) {
    const double far = std::abs(piece.center[k]) + half[k];
    sum += far * far;
    box.lo[k] = piece.center[k] - half[k] - piece.radius;
    box.hi[k] = piece.center[k] + half[k] + piece.radius;
  }
  piece.reach = std::sqrt(sum) * (1 + 1e-15);
  requireNear(piece);
  return box;
}

void requirePoints(const std::vector<Eigen::Vector3d>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthest) continue;
    throw std::invalid_argument("vertex " + std::to_string(i) +
                                (points[i].allFinite() ? " is more than 1e9 m away" : " is not finite"));
  }
}

/// Adds a triangle's vertices to those of the pieces, and gives its box.
BoxBounds addTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      std::vector<double>& vertices, Piece& piece) {
  piece.kind = PieceKind::vertices;
  piece.first_vertex = static_cast<std::int32_t>(vertices.size() / 3);
  piece.num_vertices = 3;
  BoxBounds box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = std::min({a[k], b[k], c[k]});
    box.hi[k] = std::max({a[k], b[k], c[k]});
  }
  for (const Eigen::Vector3d* v : {&a, &b, &c}) vertices.insert(vertices.end(), v->data(), v->data() + 3);
  piece.reach = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()})) * (1 + 1e-15);
  const Eigen::Vector3d n = (b - a).cross(c - a).normalized();
  const bool unit = std::abs(n.squaredNorm() - 1) <= 2e-15;  // not where slivers let it underflow
  for (int k = 0; k < 3; ++k) piece.size[k] = unit ? n[k] : 0;
  return box;
}

}  // namespace

std::vector<Node> buildBoxTree(const std::vector<BoxBounds>& boxes) {
  std::vector<Node> leaves(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) leaves[i] = makeLeaf(boxes[i], static_cast<std::int32_t>(i));
  std::vector<Node> nodes(2 * leaves.size());
  if (!leaves.empty()) Builder(leaves, nodes.data()).run();
  return nodes;
}

ShapeTree::ShapeTree(Private) {}
ShapeTree::~ShapeTree() = default;

std::shared_ptr<const ShapeTree> ShapeTree::fromTriangles(const std::vector<Eigen::Vector3d>& vertices,
                                                          const std::vector<std::array<int, 3>>& triangles,
                                                          bool solid) {
  if (triangles.empty()) throw std::invalid_argument("the mesh has no triangle");
  requirePoints(vertices);
  auto tree = std::make_shared<ShapeTree>(Private());
  std::vector<Node> leaves(triangles.size());
  tree->pieces_ = LargeArray<Piece>(triangles.size());
  tree->vertices_.reserve(9 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Eigen::Vector3d* v[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const int index = triangles[i][k];
      if (index < 0 || static_cast<std::size_t>(index) >= vertices.size()) {
        throw std::invalid_argument("triangle " + std::to_string(i) + " has a vertex index out of range");
      }
      v[k] = &vertices[static_cast<std::size_t>(index)];
    }
    Piece& piece = tree->pieces_[i];
    piece = Piece();
    piece.primitive = static_cast<std::int32_t>(i);
    leaves[i] = makeLeaf(addTriangle(*v[0], *v[1], *v[2], tree->vertices_, piece), piece.primitive);
  }
  tree->nodes_ = LargeArray<Node>(2 * leaves.size());
  Builder(leaves, tree->nodes_.data()).run();
  tree->show();
  if (solid) {
    const std::string reason = whyNoSolid(tree->view_);
    if (!reason.empty()) throw std::invalid_argument("a mesh that is to be a solid: " + reason);
    tree->space_ = std::make_unique<const SolidSpace>(tree->view_);
  }
  tree->makeOuter(vertices);
  return tree;
}

std::shared_ptr<const ShapeTree> ShapeTree::fromTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                         const Eigen::Vector3d& c) {
  requirePoints({a, b, c});
  auto tree = std::make_shared<ShapeTree>(Private());
  tree->root_[0] = makeLeaf(addTriangle(a, b, c, tree->vertices_, tree->outer_), 0);
  tree->show();
  return tree;
}

std::shared_ptr<const ShapeTree> ShapeTree::fromHull(const std::vector<Eigen::Vector3d>& points) {
  if (points.empty()) throw std::invalid_argument("it has no vertex");
  if (points.size() > kMaxHullPoints) throw std::invalid_argument("it has too many vertices");
  requirePoints(points);
  auto tree = std::make_shared<ShapeTree>(Private());
  tree->outer_ = tree->hulls_.add(points, 0);
  BoxBounds box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = kInfinity;
    box.hi[k] = -kInfinity;
    for (const Eigen::Vector3d& p : points) {
      box.lo[k] = std::min(box.lo[k], p[k]);
      box.hi[k] = std::max(box.hi[k], p[k]);
    }
  }
  tree->root_[0] = makeLeaf(box, 0);
  tree->show();
  return tree;
}

std::shared_ptr<const ShapeTree> ShapeTree::fromPiece(const Piece& piece) {
  auto tree = std::make_shared<ShapeTree>(Private());
  tree->outer_ = piece;
  if (!baseline::unbounded(piece)) {
    tree->root_[0] = makeLeaf(measure(tree->outer_), 0);
    tree->show();
    return tree;
  }
  const double* n = piece.size;
  if (!(std::abs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) <= 2e-15)) {
    throw std::invalid_argument("its normal is not of unit length");
  }
  if (!(std::abs(piece.center[0]) <= kFarthest))
    throw std::invalid_argument("it is not finite or more than 1e9 m away");
  tree->outer_.reach = std::abs(piece.center[0]);
  Node& root = tree->root_[0];
  for (int k = 0; k < 3; ++k) {
    root.lo[k] = -engine::kUnbounded;
    root.hi[k] = engine::kUnbounded;
  }
  setRadius(root);
  root.child = ~0;
  tree->show();
  tree->view_.extent = tree->outer_.reach;
  return tree;
}

std::shared_ptr<const ShapeTree> ShapeTree::fromPieces(const std::vector<Piece>& pieces) {
  if (pieces.size() == 1) return fromPiece(pieces[0]);
  if (pieces.empty()) {
    Piece point;
    point.kind = PieceKind::point;
    auto tree = std::make_shared<ShapeTree>(Private());
    tree->outer_ = point;
    tree->root_[0] = makeLeaf(measure(tree->outer_), 0);
    tree->show();
    tree->view_.num_pieces = 0;
    tree->view_.outer = nullptr;
    return tree;
  }
  auto tree = std::make_shared<ShapeTree>(Private());
  tree->pieces_ = LargeArray<Piece>(pieces.size());
  tree->nodes_ = LargeArray<Node>(2 * pieces.size());
  std::copy(pieces.begin(), pieces.end(), tree->pieces_.data());
  CurveBuilder({tree->pieces_[0].center, kPieceStride}, pieces.size(), 0, tree->pieces_.data(), tree->nodes_.data(),
               measure)
      .build();
  tree->show();
  return tree;
}

std::shared_ptr<const ShapeTree> ShapeTree::fromBalls(const std::vector<Eigen::Vector3d>& centers,
                                                      const std::vector<double>& radii, int threads) {
  FCL_ARTIC_ASSERT(!centers.empty() && (radii.size() == 1 || radii.size() == centers.size()));
  if (centers.size() == 1) {
    Piece ball;
    ball.kind = PieceKind::point;
    ball.primitive = 0;
    ball.radius = radii[0];
    std::copy_n(centers[0].data(), 3, ball.center);
    return fromPiece(ball);
  }
  auto tree = std::make_shared<ShapeTree>(Private());
  tree->cloud_ = buildCloudTree(centers, radii, threads);
  tree->cloud_.show(tree->view_);
  tree->outer_ = baseline::pieceOfBall(tree->view_, 0);
  tree->view_.pieces = &tree->outer_;
  tree->setExtent();
  return tree;
}

/// If the body has several pieces, makes one piece around it: a hull of few vertices, grown so far that it holds all
/// points.
void ShapeTree::makeOuter(const std::vector<Eigen::Vector3d>& points) {
  if (pieces_.size() == 1) {
    view_.outer = pieces_.data();
    return;
  }
  const OuterHull hull = makeOuterHull(points);
  if (hull.vertices.empty()) return;
  outer_ = hulls_.add(hull.vertices, hull.radius);
  view_.outer = &outer_;
  view_.hulls = hulls_.data();
}

/// Points the view at what was built: a tree over pieces, or else the single piece.
void ShapeTree::show() {
  const bool single = pieces_.empty();
  if (single) root_[1] = root_[0];
  view_.nodes = single ? root_ : nodes_.data();
  view_.num_nodes = single ? 2 : static_cast<std::int32_t>(nodes_.size());
  view_.pieces = single ? &outer_ : pieces_.data();
  view_.num_pieces = single ? 1 : static_cast<std::int32_t>(pieces_.size());
  view_.vertices = vertices_.data();
  view_.hulls = hulls_.data();
  if (single) view_.outer = &outer_;
  setExtent();
}

void ShapeTree::setExtent() {
  view_.extent = lower().cwiseAbs().cwiseMax(upper().cwiseAbs()).norm() * (1 + 1e-15);
}

engine::CoreBox ShapeTree::coreBox() const {
  engine::CoreBox box;
  const Piece& piece = view_.pieces[0];
  const bool round = view_.num_pieces == 1 && (piece.kind == PieceKind::point || piece.kind == PieceKind::segment);
  for (int k = 0; k < 3; ++k) {
    const double half = piece.kind == PieceKind::segment && k == 2 ? piece.size[2] : 0;
    box.lo[k] = round ? piece.center[k] - half : view_.nodes[0].lo[k];
    box.hi[k] = round ? piece.center[k] + half : view_.nodes[0].hi[k];
  }
  box.radius = round ? piece.radius : 0;
  return box;
}

const engine::TreeView& ShapeTree::viewWithParts() const {
  if (view_.num_pieces <= 1) return view_;  // nothing to cut: ConvexParts would show the same
  std::call_once(parts_once_, [this] { parts_ = std::make_unique<const ConvexParts>(view_); });
  return parts_->view();
}

const engine::TreeView& ShapeTree::viewWithUpperNodes() const {
  std::call_once(upper_once_, [this] {
    upper_ = upperNodes(view_);
    view_with_upper_ = view_;
    if (!upper_.empty()) view_with_upper_.upper = upper_.data();
  });
  return view_with_upper_;
}

const ObbTree* ShapeTree::obbTree() const {
  std::call_once(obb_once_, [this] {
    if (ObbTree::covers(view_)) obb_ = std::make_unique<const ObbTree>(view_);
  });
  return obb_.get();
}

const engine::InnerBalls* ShapeTree::innerBalls() const {
  std::call_once(balls_once_, [this] { balls_ = BallsInMesh::find(view_, lineSweptSphere()); });
  return balls_ ? &balls_->view() : nullptr;
}

const SurfacePoints* ShapeTree::surfacePoints() const {
  std::call_once(points_once_, [this] { points_ = std::make_unique<const SurfacePoints>(view_); });
  return points_.get();
}

std::size_t ShapeTree::bytes() const {
  return sizeof(*this) + nodes_.bytes() + pieces_.bytes() + cloud_.bytes() + vertices_.capacity() * sizeof(double) +
         hulls_.bytes();
}

const LineSweptSphere& ShapeTree::lineSweptSphere() const {
  std::call_once(lss_once_, [this] { lss_ = makeLineSweptSphere(); });
  return lss_;
}

LineSweptSphere ShapeTree::makeLineSweptSphere() const {
  // Points whose balls hold the body: vertices, or the corners of a shape's box (radii added at the end).
  std::vector<Eigen::Vector3d> points;
  double radius = 0;
  for (std::size_t i = 0; i + 2 < vertices_.size(); i += 3) points.push_back(Eigen::Vector3d::Map(&vertices_[i]));
  for (int i = 0; i < std::max(1, view_.num_pieces); ++i) {
    baseline::PieceRoom room;
    const Piece& p = baseline::pieceOf(view_, i, room);
    if (baseline::unbounded(p)) throw std::invalid_argument("unbounded: no line swept sphere holds it");
    radius = std::max(radius, p.radius);
    if (p.kind == PieceKind::vertices) continue;  // added above
    baseline::Vec3 half;
    if (!baseline::coreHalfSizes(p, half)) {
      baseline::coverCore(view_, p, [&](double x, double y, double z) { points.emplace_back(x, y, z); });
      continue;
    }
    const int corners = p.kind == PieceKind::point ? 1 : 8;  // they are one point
    for (int corner = 0; corner < corners; ++corner) {
      Eigen::Vector3d x;
      for (int k = 0; k < 3; ++k) x[k] = p.center[k] + ((corner >> k & 1) ? half[k] : -half[k]);
      points.push_back(x);
    }
  }
  return encloseInLineSweptSphere(points, radius);
}

}  // namespace fcl_artic
