// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/outer_hull.h"

#include <algorithm>
#include <cmath>

// GJK as the engine has it; the portable instruction set serves here.
#define FCL_ARTIC_ISA sse2
#define FCL_ARTIC_ISA_BITS 128
#include "narrowphase/contact_proof.h"

namespace fcl_artic {
namespace {

constexpr std::size_t kMaxVertices = 64, kMaxPoints = 60000;
constexpr int kDirections = 256;
/// Directions in which the chosen vertices are nearer than this part of the body's size to its surface need no more.
constexpr double kGoodEnough = 0.002;

/// Evenly spread over the sphere (Fibonacci's spiral), in an order that is coarse before it is fine.
std::vector<Eigen::Vector3d> spreadDirections() {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kDirections; ++i) {
    int k = 0;  // i with its eight bits reversed
    for (int bit = 0; bit < 8; ++bit) k |= (i >> bit & 1) << (7 - bit);
    const double z = 1 - (2 * k + 1) / static_cast<double>(kDirections), r = std::sqrt(1 - z * z);
    const double angle = 2.399963229728653 * k;  // the golden angle
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

/// Upper bound of the distance of p from the hull: GJK's nearest point is a convex combination of vertices, wherever its
/// search ended.
double distanceUpper(const engine::TreeView& hull, const engine::Piece& piece, const Eigen::Vector3d& p) {
  static const engine::Piece kPoint = [] {
    engine::Piece point;
    point.kind = engine::PieceKind::point;
    return point;
  }();
  sse2::DifferenceBody body;
  body.tree_a = body.tree_b = &hull;
  body.a = &piece;
  body.b = &kPoint;
  for (int i = 0; i < 9; ++i) body.pose.R[i] = i % 4 == 0;
  for (int k = 0; k < 3; ++k) body.pose.c[k] = p[k];
  sse2::GjkResult g;
  const double guess[3] = {p[0], p[1], p[2]};
  sse2::gjk(body, guess, 1e-3, 0, 48, g);
  if (!sse2::originWeights(g.simplex)) return 2 * (piece.reach + p.norm());
  double w[3] = {0, 0, 0};
  for (int i = 0; i < g.simplex.n; ++i) {
    for (int k = 0; k < 3; ++k) w[k] += g.simplex.weight[i] * g.simplex.v[i].w[k];
  }
  // Weights sum to 1 within a few ulp, and a dozen roundings of numbers no larger than the bodies.
  return sse2::norm(w) * (1 + 1e-12) + 1e-14 * (piece.reach + p.norm());
}

}  // namespace

OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& points) {
  OuterHull hull;
  if (points.size() < 4 || points.size() > kMaxPoints) return hull;
  Eigen::Vector3d lo = points[0], hi = points[0];
  for (const Eigen::Vector3d& p : points) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  const double size = 0.5 * (hi - lo).norm();
  static const std::vector<Eigen::Vector3d> kSpread = spreadDirections();
  for (const Eigen::Vector3d& direction : kSpread) {
    std::size_t best = 0;
    double value = -INFINITY, chosen = -INFINITY;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double x = direction.dot(points[i]);
      if (x > value) {
        value = x;
        best = i;
      }
    }
    for (const Eigen::Vector3d& v : hull.vertices) chosen = std::max(chosen, direction.dot(v));
    if (hull.vertices.size() < kMaxVertices && value - chosen > kGoodEnough * size) hull.vertices.push_back(points[best]);
  }
  engine::TreeView view;
  engine::Piece piece;
  piece.kind = engine::PieceKind::vertices;
  piece.num_vertices = static_cast<std::int32_t>(hull.vertices.size());
  std::vector<double> packed;
  for (const Eigen::Vector3d& v : hull.vertices) {
    packed.insert(packed.end(), v.data(), v.data() + 3);
    piece.reach = std::max(piece.reach, v.norm());
  }
  view.vertices = packed.data();
  for (const Eigen::Vector3d& p : points) hull.radius = std::max(hull.radius, distanceUpper(view, piece, p));
  return hull;
}

}  // namespace fcl_artic
