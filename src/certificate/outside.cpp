// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/outside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "certificate/baseline_vectors.h"

#include "numerics/baseline_isa.h"

#include "convex/piece_kinds.h"

namespace fcl_artic::certificate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

/// A sign counts as sure from this part of the largest numbers on. The verifier's widened rotations change the numbers
/// by a thousandth of that.
constexpr double kSureSign = 1e-11;
constexpr std::size_t kMaxPointsOfPart = 16;  ///< points of a part

/// The corners of a triangle, a column each.
Matrix3d cornerColumns(const Geometry& geometry, std::size_t place) {
  const TreeView& tree = geometry.shape->view();
  return Matrix3d::Map(baseline::VerticesKind::points(tree, tree.pieces[geometry.order[place]]));
}
bool isSurface(const Geometry& geometry) {
  return geometry.shape->view().pieces[0].kind == PieceKind::vertices;
}
bool hasInside(const Geometry& geometry) {
  return geometry.shape->space() != nullptr;
}

/// How often the surface winds around x, by the half-line to that side; none if a sign is not sure. (The verifier has
/// the formula, solid.cpp.)
std::optional<int> windsAround(const Geometry& solid, const Vector3d& x, int side) {
  const int k = side % 3, i = (k + 1) % 3, j = (k + 2) % 3;
  int number = 0;
  for (std::size_t t = 0; t < solid.order.size(); ++t) {
    const Matrix3d q = cornerColumns(solid, t).colwise() - x;
    const double size = std::max(x.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff()), slack = kSureSign * size;
    const auto beside = [&](int c) { return q.row(c).minCoeff() > slack || q.row(c).maxCoeff() < -slack; };
    if (beside(i) || beside(j)) continue;
    Matrix3d next, last;  // of each corner the next one, and the one before
    next << q.col(1), q.col(2), q.col(0);
    last << q.col(2), q.col(0), q.col(1);
    const Eigen::RowVector3d area = q.row(i).cwiseProduct(next.row(j)) - q.row(j).cwiseProduct(next.row(i));
    const Eigen::Index plus = (area.array() > slack * size).count(), minus = (area.array() < -slack * size).count();
    if (plus > 0 && minus > 0) continue;
    if (plus < 3 && minus < 3) return std::nullopt;
    const double height = area.dot(last.row(k)) * (plus == 3 ? 1 : -1);
    if (!(std::abs(height) > slack * size * size)) return std::nullopt;
    if ((height > 0) == (side < 3)) number += plus == 3 ? 1 : -1;
  }
  return number;
}

/// The part of a mesh that each of its triangles belongs to: corners at the same coordinates are one.
std::vector<std::size_t> surfaceParts(const Geometry& mesh) {
  std::map<std::array<double, 3>, std::size_t> numbers;
  std::vector<std::size_t> root, first;
  const auto find = [&](std::size_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::size_t t = 0; t < mesh.order.size(); ++t) {
    const Matrix3d corners = cornerColumns(mesh, t);
    for (Eigen::Index k = 0; k < corners.cols(); ++k) {
      const Vector3d p = corners.col(k);
      // -0 and 0 are one coordinate.
      const std::size_t v = numbers.try_emplace({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, numbers.size()).first->second;
      if (v == root.size()) root.push_back(v);
      if (k == 0) first.push_back(v);
      root[find(v)] = find(first.back());
    }
  }
  for (std::size_t& v : first) v = find(v);
  return first;
}

/// Looks for points of A outside of B.
class OutsideSearch {
 public:
  OutsideSearch(MovingWorld& moving, int a, int b, double t, std::vector<OutsidePoint>& found)
      : a_(moving.geometry(a)), b_(moving.geometry(b)), found_(found) {
    const int frame = moving.body(b).frame;
    const Pose to_frame = moving.pose(a, frame, t);  // a copy: the next call may move it
    to_b_ = moving.pose(b, frame, t).inverse() * to_frame;
  }

  bool run() {
    if (!hasInside(b_) || a_.unbounded) return true;
    if (isSurface(a_)) return ofMesh();
    for (std::size_t place = 0; place < a_.order.size(); ++place) {
      if (!add(place, pointOf(place))) return false;
    }
    return true;
  }

 private:
  bool ofMesh() {
    const std::vector<std::size_t> part = surfaceParts(a_);
    std::map<std::size_t, std::vector<std::size_t>> places;
    std::vector<std::size_t> order;
    for (std::size_t place = 0; place < part.size(); ++place) {
      std::vector<std::size_t>& list = places[part[place]];
      if (list.empty()) order.push_back(part[place]);
      if (list.size() < kMaxPointsOfPart) list.push_back(place);
    }
    for (const std::size_t of : order) {
      bool shown = false;
      for (const std::size_t place : places[of]) {
        const Vector3d p = cornerColumns(a_, place) * Vector3d(5, 7, 4) / 16;
        shown = add(place, p);
        if (shown) break;
      }
      if (!shown) return false;
    }
    return true;
  }
  Vector3d pointOf(std::size_t place) const {
    const TreeView& tree = a_.shape->view();
    const Piece& piece = tree.pieces[a_.order[place]];
    if (piece.kind == PieceKind::hull) return toEigen(baseline::HullKind::vertex(tree, piece, 0));
    return Vector3d::Map(piece.center);
  }
  bool add(std::size_t place, const Vector3d& p) {
    const Vector3d x = to_b_.R * p + to_b_.c;
    for (int side = 0; side < 6; ++side) {
      const std::optional<int> number = windsAround(b_, x, side);
      if (number && *number != 0) return false;
      if (!number) continue;
      found_.push_back({place, side});
      return true;
    }
    return false;
  }

  const Geometry &a_, &b_;
  std::vector<OutsidePoint>& found_;
  Pose to_b_;
};

}  // namespace

std::optional<std::vector<OutsidePoint>> findOutside(MovingWorld& moving, int a, int b, double t) {
  std::vector<OutsidePoint> found;
  if (!OutsideSearch(moving, a, b, t, found).run() || !OutsideSearch(moving, b, a, t, found).run()) return std::nullopt;
  return found;
}

}  // namespace fcl_artic::certificate
