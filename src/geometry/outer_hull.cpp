// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/outer_hull.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/point_lanes.h"
#include "geometry/spread_directions.h"
#include "numerics/baseline_isa.h"

#include "convex/contact_proof.h"

namespace fcl_artic {
namespace {

/// A body with more points than kMaxPoints, or more different ones than kMaxDifferent, must be a whole scene: it gets
/// no hull.
constexpr std::size_t kMaxPoints = 1000000, kMaxDifferent = 60000;
constexpr int kHullDirections = 32;
/// The hull grows until all points are within this part of the body's size; its radius covers the rest.
constexpr double kGoodEnough = 0.002;

/// The points, each once.
std::vector<Eigen::Vector3d> differentPoints(std::vector<Eigen::Vector3d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// Upper bounds of points' distances from the hull of a few vertices.
class HullDistance {
 public:
  HullDistance() {
    point_.kind = engine::PieceKind::point;
    body_.tree_a = body_.tree_b = &view_;
    body_.a = &piece_;
    body_.b = &point_;
    body_.pose.R = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  }
  void add(const Eigen::Vector3d& vertex) {
    packed_.insert(packed_.end(), vertex.data(), vertex.data() + 3);
    reach_ = std::max(reach_, vertex.norm());
    sum_ += vertex;
    view_.vertices = packed_.data();
    ++piece_.num_vertices;
  }
  /// An upper bound of p's distance: nearly the distance if that exceeds `enough`, else any value up to `enough`.
  double operator()(const Eigen::Vector3d& p, double enough) {
    // Neighbours in a mesh are nearest to the same few vertices.
    const double guess = last_.n == 3 ? distanceOfTriangle(p) : INFINITY;
    if (guess <= enough) return guess;
    body_.pose.c = baseline::Vec3(p.data());
    const Eigen::Vector3d direction = p - sum_ / piece_.num_vertices;
    baseline::GjkResult g;
    baseline::gjk(body_, baseline::Vec3(direction.data()), {1e-3, enough * (1 - 1e-9), 48}, g);
    baseline::originWeights(g.simplex);
    last_ = g.simplex;
    return std::min(guess, distanceOfCombination(p));
  }

 private:
  double distanceOfTriangle(const Eigen::Vector3d& p) {
    const baseline::Vec3 x(p.data());
    baseline::nearestOnTriangle(last_.v[0].a - x, last_.v[1].a - x, last_.v[2].a - x).store(last_.weight);
    return distanceOfCombination(p);
  }
  /// p's distance from the convex combination of vertices with which a search ended, wherever that is. If the weights
  /// are no convex combination (nothing else rests on them), p's distance from the nearest of the vertices.
  double distanceOfCombination(const Eigen::Vector3d& p) const {
    Eigen::Vector3d w = Eigen::Vector3d::Zero();
    double sum = 0, nearest = INFINITY;
    bool convex = true;
    for (int i = 0; i < last_.n; ++i) {
      const Eigen::Vector3d d = p - Eigen::Vector3d::Map(last_.v[i].a.k);
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
  baseline::DifferenceBody body_;
  baseline::Simplex last_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  double reach_ = 0;
};

}  // namespace

OuterHull makeOuterHull(const std::vector<Eigen::Vector3d>& all_points, std::size_t most_exact, std::size_t most) {
  OuterHull hull;
  if (all_points.size() < 4 || all_points.size() > kMaxPoints) return hull;
  const std::vector<Eigen::Vector3d> points = differentPoints(all_points);
  if (points.size() > kMaxDifferent) return hull;
  if (points.size() <= most_exact) {
    hull.vertices = points;
    return hull;
  }
  HullDistance distance;
  const auto choose = [&](std::size_t point) {
    hull.vertices.push_back(points[point]);
    distance.add(points[point]);
  };
  // The hull begins with a few points all around. The point that is farthest from it is the next vertex. Distances only
  // shrink as the hull grows, so those in the heap are upper bounds, and only its top is computed again.
  const PointLanes lanes(points);
  std::set<std::size_t> first;
  for (const Eigen::Vector3d& direction : spreadDirections(kHullDirections)) {
    first.insert(lanes.farthest(direction));
  }
  for (std::size_t point : first) choose(point);
  Eigen::Vector3d lo = points[0], hi = points[0];
  for (const Eigen::Vector3d& p : points) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  const double enough = kGoodEnough * 0.5 * (hi - lo).norm();
  struct Far {
    double distance;
    std::size_t point, vertices;  ///< and the number of vertices that the distance is to
    bool operator<(const Far& other) const { return distance < other.distance; }
  };
  std::vector<Far> heap;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = distance(points[i], enough);
    hull.radius = std::max(hull.radius, std::min(d, enough));
    if (d > enough) heap.push_back({d, i, hull.vertices.size()});
  }
  std::make_heap(heap.begin(), heap.end());
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end());
    Far top = heap.back();
    heap.pop_back();
    if (top.vertices < hull.vertices.size()) {
      top.distance = std::min(top.distance, distance(points[top.point], enough));
      top.vertices = hull.vertices.size();
      if (top.distance <= enough) {
        hull.radius = std::max(hull.radius, top.distance);
        continue;
      }
      heap.push_back(top);
      std::push_heap(heap.begin(), heap.end());
      continue;
    }
    if (hull.vertices.size() >= most) {
      hull.radius = std::max(hull.radius, top.distance);
      break;
    }
    choose(top.point);
  }
  return hull;
}

}  // namespace fcl_artic
