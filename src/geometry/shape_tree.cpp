// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shape_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>

#include "geometry/outer_hull.h"

namespace fcl_artic {
namespace {

using engine::Node;
using engine::Piece;
using engine::PieceKind;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Nearest float that is surely not below x, whatever the rounding mode.
float roundUp(double x) {
  return std::nextafter(std::nextafter(static_cast<float>(x), std::numeric_limits<float>::max()),
                        std::numeric_limits<float>::max());
}
float roundDown(double x) { return -roundUp(-x); }

Node makeNode(const BoxBounds& box) {
  Node node;
  double radius = 0;
  for (int k = 0; k < 3; ++k) {
    node.lo[k] = roundDown(box.lo[k]);
    node.hi[k] = roundUp(box.hi[k]);
    const double half = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
    radius += half * half;
  }
  node.radius = roundUp(std::sqrt(radius));
  node.child = -1;
  return node;
}

class Builder {
 public:
  explicit Builder(const std::vector<BoxBounds>& boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(2 * boxes.size());
  }
  std::vector<Node> run() {
    if (boxes_.empty()) return {};
    nodes_.resize(2);
    build(0, 0, order_.size());
    nodes_[1] = nodes_[0];
    return std::move(nodes_);
  }

 private:
  double middle(int i, int axis) const {
    const BoxBounds& b = boxes_[static_cast<std::size_t>(i)];
    return b.lo[axis] + b.hi[axis];
  }
  /// Median split across the longest side: as good as a surface area heuristic here (measured) and balanced, so that
  /// recursion is shallow whatever the input.
  void build(std::size_t me, std::size_t begin, std::size_t end) {
    BoxBounds box;
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = kInfinity;
      box.hi[k] = -kInfinity;
      for (std::size_t i = begin; i < end; ++i) {
        box.lo[k] = std::min(box.lo[k], boxes_[static_cast<std::size_t>(order_[i])].lo[k]);
        box.hi[k] = std::max(box.hi[k], boxes_[static_cast<std::size_t>(order_[i])].hi[k]);
      }
    }
    nodes_[me] = makeNode(box);
    if (end - begin == 1) {
      nodes_[me].child = ~order_[begin];
      return;
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (box.hi[k] - box.lo[k] > box.hi[axis] - box.lo[axis]) axis = k;
    }
    const std::size_t half = (begin + end) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(half), at(end), [&](int i, int j) {
      const double x = middle(i, axis), y = middle(j, axis);
      return x != y ? x < y : i < j;  // the same tree on every machine
    });
    const std::size_t left = nodes_.size();
    nodes_[me].child = static_cast<std::int32_t>(left);
    nodes_.resize(left + 2);
    build(left, begin, half);
    build(left + 1, half, end);
  }
  const std::vector<BoxBounds>& boxes_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

/// Half sizes of a shape's core along the axes.
void coreHalf(const Piece& p, double* half) {
  const double *e = p.size;
  switch (p.kind) {
    case PieceKind::box:
    case PieceKind::ellipsoid:
      for (int k = 0; k < 3; ++k) half[k] = e[k];
      return;
    case PieceKind::cylinder:
    case PieceKind::cone:
      half[0] = half[1] = e[0];
      half[2] = e[2];
      return;
    case PieceKind::segment:
      half[0] = half[1] = 0;
      half[2] = e[2];
      return;
    default:
      half[0] = half[1] = half[2] = 0;
  }
}

}  // namespace

std::vector<Node> buildBoxTree(const std::vector<BoxBounds>& boxes) { return Builder(boxes).run(); }

std::shared_ptr<const ShapeTree> ShapeTree::fromTriangles(const std::vector<Eigen::Vector3d>& vertices,
                                                          const std::vector<std::array<int, 3>>& triangles) {
  if (triangles.empty()) throw std::invalid_argument("the mesh has no triangle");
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite()) throw std::invalid_argument("vertex " + std::to_string(i) + " is not finite");
    if (vertices[i].cwiseAbs().maxCoeff() > 1e9) {
      throw std::invalid_argument("vertex " + std::to_string(i) + " is more than 1e9 m away");
    }
  }
  auto tree = std::shared_ptr<ShapeTree>(new ShapeTree);
  tree->pieces_.reserve(triangles.size());
  tree->vertices_.reserve(9 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    Piece piece;
    piece.kind = PieceKind::vertices;
    piece.first_vertex = static_cast<std::int32_t>(tree->vertices_.size() / 3);
    piece.num_vertices = 3;
    piece.primitive = static_cast<std::int32_t>(i);
    std::array<Eigen::Vector3d, 3> v;
    for (std::size_t k = 0; k < 3; ++k) {
      const int index = triangles[i][k];
      if (index < 0 || static_cast<std::size_t>(index) >= vertices.size()) {
        throw std::invalid_argument("triangle " + std::to_string(i) + " has a vertex index out of range");
      }
      v[k] = vertices[static_cast<std::size_t>(index)];
      tree->vertices_.insert(tree->vertices_.end(), v[k].data(), v[k].data() + 3);
      piece.reach = std::max(piece.reach, v[k].norm() * (1 + 1e-15));
    }
    const Eigen::Vector3d n = (v[1] - v[0]).cross(v[2] - v[0]).normalized();
    const bool unit = std::abs(n.squaredNorm() - 1) <= 2e-15;  // not where slivers let it underflow
    for (int k = 0; k < 3; ++k) piece.size[k] = unit ? n[k] : 0;
    tree->pieces_.push_back(piece);
  }
  tree->build();
  tree->makeOuter(vertices);
  return tree;
}

std::shared_ptr<const ShapeTree> ShapeTree::fromPiece(const Piece& given) {
  Piece piece = given;
  auto tree = std::shared_ptr<ShapeTree>(new ShapeTree);
  double half[3];
  coreHalf(piece, half);
  const double far[3] = {std::abs(piece.center[0]) + half[0], std::abs(piece.center[1]) + half[1],
                         std::abs(piece.center[2]) + half[2]};
  piece.reach = std::sqrt(far[0] * far[0] + far[1] * far[1] + far[2] * far[2]) * (1 + 1e-15);
  if (!std::isfinite(piece.reach + piece.radius) || piece.reach + piece.radius > 1e9) {
    throw std::invalid_argument("a size is not finite or beyond 1e9 m");
  }
  tree->pieces_.push_back(piece);
  tree->build();
  tree->view_.outer = tree->pieces_.data();
  return tree;
}

/// One piece around a body of many: a hull of few vertices, grown so far that it holds all points.
void ShapeTree::makeOuter(const std::vector<Eigen::Vector3d>& points) {
  if (pieces_.size() == 1) {
    view_.outer = pieces_.data();
    return;
  }
  const OuterHull hull = makeOuterHull(points);
  if (hull.vertices.empty()) return;
  const std::size_t n = (hull.vertices.size() + 7) / 8 * 8;
  hulls_.resize(3 * n + 8);
  const std::size_t misaligned = reinterpret_cast<std::uintptr_t>(hulls_.data()) / sizeof(double) % 8;
  double* x = hulls_.data() + (8 - misaligned) % 8;
  outer_.kind = PieceKind::hull;
  outer_.first_vertex = 0;
  outer_.num_vertices = static_cast<std::int32_t>(n);
  outer_.radius = hull.radius;
  for (int k = 0; k < 3; ++k) outer_.size[k] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d& v = hull.vertices[std::min(i, hull.vertices.size() - 1)];  // the last one fills up
    for (std::size_t k = 0; k < 3; ++k) x[k * n + i] = v[static_cast<Eigen::Index>(k)];
    outer_.reach = std::max(outer_.reach, v.norm() * (1 + 1e-15));
  }
  view_.hulls = x;
  view_.outer = &outer_;
}

void ShapeTree::build() {
  std::vector<BoxBounds> boxes(pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& p = pieces_[i];
    BoxBounds& box = boxes[i];
    double half[3];
    coreHalf(p, half);
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = p.center[k] - half[k];
      box.hi[k] = p.center[k] + half[k];
      if (p.kind == PieceKind::vertices) {
        box.lo[k] = kInfinity;
        box.hi[k] = -kInfinity;
        for (int j = 0; j < p.num_vertices; ++j) {
          const double x = vertices_[static_cast<std::size_t>(3 * (p.first_vertex + j) + k)];
          box.lo[k] = std::min(box.lo[k], x);
          box.hi[k] = std::max(box.hi[k], x);
        }
      }
      box.lo[k] -= p.radius;
      box.hi[k] += p.radius;
    }
  }
  nodes_ = buildBoxTree(boxes);
  view_.nodes = nodes_.data();
  view_.pieces = pieces_.data();
  view_.vertices = vertices_.data();
  view_.num_nodes = static_cast<std::int32_t>(nodes_.size());
  view_.num_pieces = static_cast<std::int32_t>(pieces_.size());
  view_.extent = lower().cwiseAbs().cwiseMax(upper().cwiseAbs()).norm() * (1 + 1e-15);
}

Eigen::Vector3d ShapeTree::lower() const { return Eigen::Vector3f::Map(nodes_.front().lo).cast<double>(); }

Eigen::Vector3d ShapeTree::upper() const { return Eigen::Vector3f::Map(nodes_.front().hi).cast<double>(); }

std::array<double, 7> ShapeTree::lineSweptSphere() const {
  // Points whose balls hold the body: vertices, or the corners of a shape's box (radii added at the end).
  std::vector<Eigen::Vector3d> points;
  double radius = 0;
  for (std::size_t i = 0; i + 2 < vertices_.size(); i += 3) points.push_back(Eigen::Vector3d::Map(&vertices_[i]));
  for (const Piece& p : pieces_) {
    radius = std::max(radius, p.radius);
    if (p.kind == PieceKind::vertices) continue;
    double half[3];
    coreHalf(p, half);
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d x;
      for (int k = 0; k < 3; ++k) x[k] = p.center[k] + ((corner >> k & 1) ? half[k] : -half[k]);
      points.push_back(x);
    }
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) mean += x;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points) covariance += (x - mean) * (x - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  // The principal axis, its line through the middle of the extents across it; the ends as far out as the round caps
  // demand: a point at height z and distance c from the line needs an end at z - sqrt(r^2 - c^2) or beyond.
  const Eigen::Matrix3d axes = solver.eigenvectors();
  Eigen::Vector3d lo = Eigen::Vector3d::Constant(kInfinity), hi = -lo;
  for (const Eigen::Vector3d& x : points) {
    lo = lo.cwiseMin(axes.transpose() * x);
    hi = hi.cwiseMax(axes.transpose() * x);
  }
  const Eigen::Vector3d middle = 0.5 * (lo + hi);
  double r = 0;
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Vector3d y = axes.transpose() * x - middle;
    r = std::max(r, std::hypot(y[0], y[1]));
  }
  r *= 1 + 1e-12;
  double top = -kInfinity, bottom = kInfinity;
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Vector3d y = axes.transpose() * x - middle;
    const double cap = std::sqrt(std::max(0.0, r * r - y[0] * y[0] - y[1] * y[1]));
    top = std::max(top, y[2] - cap);
    bottom = std::min(bottom, y[2] + cap);
  }
  if (bottom > top) bottom = top = 0.5 * (bottom + top);
  const Eigen::Vector3d p0 = axes * (middle + Eigen::Vector3d(0, 0, bottom)),
                        p1 = axes * (middle + Eigen::Vector3d(0, 0, top));
  // Whatever rounding did above: the radius is what the points need from the segment as it is stored.
  double needed = 0;
  const Eigen::Vector3d d = p1 - p0;
  for (const Eigen::Vector3d& x : points) {
    const double s = d.squaredNorm() > 0 ? std::clamp((x - p0).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    needed = std::max(needed, (x - p0 - s * d).norm());
  }
  needed = (needed + radius) * (1 + 1e-12) + 1e-15 * (p0.norm() + p1.norm());
  return {p0[0], p0[1], p0[2], p1[0], p1[1], p1[2], needed};
}

}  // namespace fcl_artic
