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
/// So few different points make the hull themselves: it is the body's own then, and a convex body touches where its
/// hull does.
constexpr std::size_t kAllVertices = 160;
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

/// The points, each once; none when they are more than `most`.
std::vector<Eigen::Vector3d> differentPoints(std::vector<Eigen::Vector3d> points, std::size_t most) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() > most) points.clear();
  return points;
}

/// Points eight by eight, to find those farthest along directions.
class PointLanes {
 public:
  explicit PointLanes(const std::vector<Eigen::Vector3d>& points) : blocks_((points.size() + 7) / 8) {
    for (std::size_t i = 0; i < 8 * blocks_.size(); ++i) {
      const Eigen::Vector3d& p = points[std::min(i, points.size() - 1)];
      for (std::size_t k = 0; k < 3; ++k) blocks_[i / 8].x[k][i % 8] = p[static_cast<Eigen::Index>(k)];
    }
  }
  double farthest(const Eigen::Vector3d& u) const {
    double most[8];
    std::fill(most, most + 8, -INFINITY);
    for (const Block& block : blocks_) {
      for (int i = 0; i < 8; ++i) {
        const double value = block.along(u, i);
        most[i] = most[i] > value ? most[i] : value;
      }
    }
    return *std::max_element(most, most + 8);
  }
  std::size_t firstAt(const Eigen::Vector3d& u, double value) const {
    std::size_t i = 0;
    while (i + 1 < 8 * blocks_.size() && blocks_[i / 8].along(u, static_cast<int>(i % 8)) < value) ++i;
    return i;
  }

 private:
  struct Block {
    double x[3][8];
    double along(const Eigen::Vector3d& u, int i) const { return x[0][i] * u[0] + x[1][i] * u[1] + x[2][i] * u[2]; }
  };
  std::vector<Block> blocks_;
};

/// How far points are from the hull of a few vertices, from above.
class HullDistance {
 public:
  explicit HullDistance(const std::vector<Eigen::Vector3d>& vertices) {
    for (const Eigen::Vector3d& v : vertices) {
      packed_.insert(packed_.end(), v.data(), v.data() + 3);
      reach_ = std::max(reach_, v.norm());
      middle_ += v / static_cast<double>(vertices.size());
    }
    view_.vertices = packed_.data();
    piece_.num_vertices = static_cast<std::int32_t>(vertices.size());
    point_.kind = engine::PieceKind::point;
    body_.tree_a = body_.tree_b = &view_;
    body_.a = &piece_;
    body_.b = &point_;
    for (int i = 0; i < 9; ++i) body_.pose.R[i] = i % 4 == 0;
  }
  /// The distance of p from above: nearly the least where it exceeds `enough`, and else any value up to that.
  double operator()(const Eigen::Vector3d& p, double enough) {
    // Neighbours in a mesh are nearest to the same few vertices.
    const double guess = last_.n == 3 ? distanceOfTriangle(p) : INFINITY;
    if (guess <= enough) return guess;
    for (int k = 0; k < 3; ++k) body_.pose.c[k] = p[k];
    const Eigen::Vector3d direction = p - middle_;
    sse2::GjkResult g;
    sse2::gjk(body_, direction.data(), 1e-3, enough * (1 - 1e-9), 48, g);
    sse2::originWeights(g.simplex);
    last_ = g.simplex;
    return std::min(guess, distanceOfCombination(p));
  }

 private:
  double distanceOfTriangle(const Eigen::Vector3d& p) {
    double corner[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) corner[i][k] = last_.v[i].a[k] - p[k];
    }
    sse2::nearestOnTriangle(corner[0], corner[1], corner[2], last_.weight);
    return distanceOfCombination(p);
  }
  /// From the convex combination of vertices that a search ended with, wherever that was; from one of them should the
  /// weights, which nothing rests on elsewhere, make no such combination.
  double distanceOfCombination(const Eigen::Vector3d& p) const {
    Eigen::Vector3d w = Eigen::Vector3d::Zero();
    double sum = 0, nearest = INFINITY;
    bool convex = true;
    for (int i = 0; i < last_.n; ++i) {
      const Eigen::Vector3d d = p - Eigen::Vector3d::Map(last_.v[i].a);
      w += last_.weight[i] * d;
      sum += last_.weight[i];
      convex = convex && last_.weight[i] >= 0;
      nearest = std::min(nearest, d.squaredNorm());
    }
    convex = convex && std::abs(sum - 1) <= 1e-14;
    // Sum of weights within 1e-14, and a dozen roundings of numbers no larger than the bodies.
    return (convex ? w.norm() : std::sqrt(nearest)) * (1 + 1e-12) + 2e-14 * (reach_ + p.norm());
  }
  std::vector<double> packed_;
  engine::TreeView view_;
  engine::Piece piece_, point_;
  sse2::DifferenceBody body_;
  sse2::Simplex last_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  double reach_ = 0;
};

}  // namespace

OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& points) {
  OuterHull hull;
  if (points.size() < 4 || points.size() > kMaxPoints) return hull;
  Eigen::Vector3d lo = points[0], hi = points[0];
  for (const Eigen::Vector3d& p : points) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  hull.vertices = differentPoints(points, kAllVertices);
  if (!hull.vertices.empty()) return hull;
  const double size = 0.5 * (hi - lo).norm();
  static const std::vector<Eigen::Vector3d> kSpread = spreadDirections();
  const PointLanes lanes(points);
  for (const Eigen::Vector3d& direction : kSpread) {
    const double value = lanes.farthest(direction);
    double chosen = -INFINITY;
    for (const Eigen::Vector3d& v : hull.vertices) chosen = std::max(chosen, direction.dot(v));
    if (!(value - chosen > kGoodEnough * size)) continue;
    hull.vertices.push_back(points[std::min(lanes.firstAt(direction, value), points.size() - 1)]);
    if (hull.vertices.size() == kMaxVertices) break;
  }
  HullDistance distance(hull.vertices);
  // Some points from all over first: most others then need no more than the proof that they are no farther.
  for (std::size_t i = 0; i < points.size(); i += 61)
    hull.radius = std::max(hull.radius, distance(points[i], hull.radius));
  for (const Eigen::Vector3d& p : points) hull.radius = std::max(hull.radius, distance(p, hull.radius));
  return hull;
}

}  // namespace fcl_artic
