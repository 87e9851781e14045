// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/obb_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <unordered_map>

#include <Eigen/Eigenvalues>

#include "numerics/unit_vector.h"

namespace fcl_artic {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

/// By this part of the coordinates and of the box, a half size is longer than its points need. The axes are off by
/// single precision's rounding, 2^-24 an entry, so e_j . e_k differs from 0 or 1 by less than 2^-21. The test takes the
/// box for the parallelepiped along its axes as well as for the slabs across them. Each of the two holds the other if
/// the half sizes grow by this part of their sum. Rounding of the center and of the half sizes to float is less than
/// it, too.
constexpr double kSlack = 0x1p-20;

/// Gives equal points and equal edges one number each. Open addressing over tables that the caller provides.
template <class Key, class Hash>
class Numbering {
 public:
  explicit Numbering(std::size_t expected) { numbers_.reserve(2 * expected); }
  /// @return the number, and whether it is new.
  std::pair<std::int32_t, bool> of(const Key& key) {
    const auto found = numbers_.emplace(key, static_cast<std::int32_t>(numbers_.size()));
    return {found.first->second, found.second};
  }

 private:
  std::unordered_map<Key, std::int32_t, Hash> numbers_;
};

struct HashWords {
  template <class Words>
  std::size_t operator()(const Words& words) const {
    std::uint64_t h = 0x9e3779b97f4a7c15ull;
    for (const auto w : words) h = (h ^ static_cast<std::uint64_t>(w)) * 0xff51afd7ed558ccdull, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  }
};
using PointKey = std::array<std::uint64_t, 3>;
using EdgeKey = std::array<std::int32_t, 2>;

PointKey keyOf(const double* p) {
  PointKey key;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = p[k] + 0.0;  // no negative zero
    std::memcpy(&key[k], &x, sizeof x);
  }
  return key;
}

/// Corners of a box in the order of their bits: x + 2 y + 4 z; and its sides as triangles of these.
constexpr int kSides[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                               {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};

/// The axes of a box as it stores them, in single precision: e_j . e_k is within 2^-21 of 0 or 1.
class BoxAxes {
 public:
  /// The coordinate axes.
  BoxAxes() : BoxAxes(Matrix3d::Identity()) {}
  /// @param axes  its columns, of unit length.
  /// @return none if they are not orthonormal to single precision, or not finite.
  static std::optional<BoxAxes> within21Bits(const Matrix3d& axes) {
    const BoxAxes stored(axes);
    // Products of floats are exact, and their sums to 2^-51.
    const Matrix3d defect = stored.rows_ * stored.rows_.transpose() - Matrix3d::Identity();
    if (!(defect.array().abs() <= 0x1p-21).all()) return std::nullopt;
    return stored;
  }

  float operator()(int axis, int i) const { return static_cast<float>(rows_(axis, i)); }
  const Matrix3d& rows() const { return rows_; }

 private:
  explicit BoxAxes(const Matrix3d& columns) : rows_(columns.transpose().cast<float>().cast<double>()) {}
  Matrix3d rows_;
};

/// Principal axes of the area of triangles (Gottschalk 2000, Section 3.3), largest extent first.
BoxAxes principalAxes(const Vector3d* first, const std::uint32_t* order, std::size_t count) {
  Vector3d mean = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d* v = first + 3 * order[i];
    const Vector3d m = (v[0] + v[1] + v[2]) / 3;
    const double a = 0.5 * (v[1] - v[0]).cross(v[2] - v[0]).norm() + 1e-30;
    area += a;
    mean += a * m;
    second +=
        a / 12 * (9 * m * m.transpose() + v[0] * v[0].transpose() + v[1] * v[1].transpose() + v[2] * v[2].transpose());
  }
  mean /= area;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(second / area - mean * mean.transpose());
  if (solver.info() != Eigen::Success) return {};
  return BoxAxes::within21Bits(solver.eigenvectors().rowwise().reverse()).value_or(BoxAxes());
}

/// The axes of one triangle's box: along its longest edge, and along its normal. If the corners are in a line, the
/// computed normal is a residue of rounding, which may lie along the edge. Then any direction across the edge will do.
BoxAxes axesOf(const Vector3d* v) {
  Vector3d edge = v[1] - v[0];
  for (const Vector3d& e : {Vector3d(v[2] - v[1]), Vector3d(v[0] - v[2])}) {
    if (e.squaredNorm() > edge.squaredNorm()) edge = e;
  }
  const std::optional<UnitVector> longest = UnitVector::within3Ulps(edge);
  if (!longest) return {};
  const Vector3d& x = *longest;
  const auto axesWith = [&](const Vector3d& z) {
    Matrix3d axes;
    axes << x, z.cross(x), z;
    return BoxAxes::within21Bits(axes);
  };
  if (const std::optional<UnitVector> normal = UnitVector::within3Ulps((v[1] - v[0]).cross(v[2] - v[1]))) {
    const Vector3d& n = *normal;
    const std::optional<UnitVector> across = UnitVector::within3Ulps(n - n.dot(x) * x);
    if (const std::optional<BoxAxes> axes = across ? axesWith(*across) : std::nullopt) return *axes;
  }
  return axesWith(x.unitOrthogonal()).value_or(BoxAxes());
}

/// The box along these axes round the triangles.
void fitBox(const BoxAxes& axes, const Vector3d* first, const std::uint32_t* order, std::size_t count, ObbNode& node) {
  const Matrix3d& e = axes.rows();
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) node.axis[k][i] = axes(k, i);
  }
  Vector3d lo = Vector3d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
  for (std::size_t i = 0; i < count; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector3d x = e * first[3 * order[i] + static_cast<std::uint32_t>(j)];
      lo = lo.cwiseMin(x);
      hi = hi.cwiseMax(x);
    }
  }
  const Vector3d c = e.transpose() * (0.5 * (lo + hi));
  for (int k = 0; k < 3; ++k) node.center[k] = static_cast<float>(c[k]);
  const Vector3d stored(node.center[0], node.center[1], node.center[2]), at = e * stored;
  const Vector3d half = (hi - at).cwiseMax(at - lo).cwiseMax(0);
  const double slack = kSlack * (half.sum() + 0x1p-20 * stored.cwiseAbs().sum()) + 1e-37;
  for (int k = 0; k < 3; ++k) node.half[k] = static_cast<float>((half[k] + slack) * (1 + 0x1p-22));
}

}  // namespace

bool ObbTree::covers(const TreeView& body) {
  if (body.num_pieces == 0) return false;
  for (int i = 0; i < body.num_pieces; ++i) {
    const Piece& p = body.pieces[i];
    const bool triangle = p.kind == PieceKind::vertices && p.num_vertices == 3 && p.radius == 0;
    bool box = p.kind == PieceKind::box && p.radius == 0;
    for (int k = 0; k < 3; ++k) box = box && (p.center[k] + p.size[k]) - p.center[k] == p.size[k];  // corners are exact
    if (!triangle && !box) return false;
  }
  return true;
}

ObbTree::ObbTree(const TreeView& body) {
  readFeatures(body);
  buildNodes();
}

void ObbTree::readFeatures(const TreeView& body) {
  Numbering<PointKey, HashWords> points(static_cast<std::size_t>(body.num_pieces));
  Numbering<EdgeKey, HashWords> edges(2 * static_cast<std::size_t>(body.num_pieces));
  const auto addTriangle = [&](const double* const* v, std::int32_t piece) {
    ObbTriangle t;
    t.piece = piece;
    for (int k = 0; k < 3; ++k) {
      const auto [number, is_new] = points.of(keyOf(v[k]));
      t.vertex[k] = number;
      if (!is_new) continue;
      t.owns_vertex |= static_cast<std::uint8_t>(1 << k);
      vertices_.insert(vertices_.end(), v[k], v[k] + 3);
    }
    for (int k = 0; k < 3; ++k) {
      const int a = t.vertex[k], b = t.vertex[(k + 1) % 3];
      t.edge[k] = -1;
      if (a == b) continue;
      const auto [number, is_new] = edges.of({std::min(a, b), std::max(a, b)});
      t.edge[k] = number;
      if (!is_new) continue;
      t.owns_edge |= static_cast<std::uint8_t>(1 << k);
      edges_.push_back({a, b});
    }
    triangles_.push_back(t);
  };
  for (std::int32_t i = 0; i < body.num_pieces; ++i) {
    const Piece& p = body.pieces[i];
    if (p.kind == PieceKind::vertices) {
      const double* v = body.vertices + 3 * static_cast<std::ptrdiff_t>(p.first_vertex);
      const double* corners[3] = {v, v + 3, v + 6};
      addTriangle(corners, i);
      continue;
    }
    double corner[8][3];
    for (int c = 0; c < 8; ++c) {
      for (int k = 0; k < 3; ++k) corner[c][k] = p.center[k] + (c >> k & 1 ? p.size[k] : -p.size[k]);
    }
    for (const int* side : kSides) {
      const double* corners[3] = {corner[side[0]], corner[side[1]], corner[side[2]]};
      addTriangle(corners, i);
    }
  }
}

/// Top down: split at the mean across the longest axis, or at the median if the mean separates nothing (Gottschalk
/// 1996).
void ObbTree::buildNodes() {
  const std::size_t n = triangles_.size();
  std::vector<Vector3d> corners(3 * n), middles(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 3; ++k) corners[3 * i + k] = Vector3d::Map(vertex(triangles_[i].vertex[k]));
    middles[i] = (corners[3 * i] + corners[3 * i + 1] + corners[3 * i + 2]) / 3;
  }
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  nodes_.reserve(2 * n);
  nodes_.resize(1);
  struct Task {
    std::size_t node, begin, end;
  };
  std::vector<Task> tasks{{0, 0, n}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    const std::size_t count = task.end - task.begin;
    std::uint32_t* own = order.data() + task.begin;
    const BoxAxes axes = count == 1 ? axesOf(&corners[3 * own[0]]) : principalAxes(corners.data(), own, count);
    ObbNode node;
    fitBox(axes, corners.data(), own, count, node);
    if (count == 1) {
      node.child = ~static_cast<std::int32_t>(own[0]);
      nodes_[task.node] = node;
      continue;
    }
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
      if (node.half[k] > node.half[longest]) longest = k;
    }
    const Vector3d along = axes.rows().row(longest);
    double mean = 0;
    for (std::size_t i = 0; i < count; ++i) mean += along.dot(middles[own[i]]);
    mean /= static_cast<double>(count);
    std::size_t left = static_cast<std::size_t>(
        std::partition(own, own + count, [&](std::uint32_t i) { return along.dot(middles[i]) < mean; }) - own);
    if (left < count / 8 + (count > 1) || left > count - count / 8 - 1) {
      left = count / 2;
      std::nth_element(own, own + left, own + count, [&](std::uint32_t a, std::uint32_t b) {
        const double x = along.dot(middles[a]), y = along.dot(middles[b]);
        return x != y ? x < y : a < b;
      });
    }
    node.child = static_cast<std::int32_t>(nodes_.size());
    nodes_[task.node] = node;
    nodes_.resize(nodes_.size() + 2);
    tasks.push_back({static_cast<std::size_t>(node.child), task.begin, task.begin + left});
    tasks.push_back({static_cast<std::size_t>(node.child) + 1, task.begin + left, task.end});
  }
}

}  // namespace fcl_artic
