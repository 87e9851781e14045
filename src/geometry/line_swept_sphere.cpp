// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/line_swept_sphere.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

#include <Eigen/Eigenvalues>

#include "geometry/point_lanes.h"
#include "geometry/spread_directions.h"
#include "numerics/constants.h"

namespace fcl_artic {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

/// The search works on extreme points: the farthest ones along kExtremeDirections directions, among about kSampled
/// points at most.
constexpr int kExtremeDirections = 100;
constexpr std::size_t kSampled = 20000;
/// Steps of the search from each axis. Measured on a Panda: 35 % less volume than about the principal axis, and of
/// 1,000 obstacles about it stage 1 leaves 9.4 pairs in place of 14.8; 150 leave 9.6, 2000 as many as 400.
constexpr int kSearchSteps = 400;

struct Segment {
  Vector3d p0, p1;
  double length() const { return (p1 - p0).norm(); }
};

/// Squares of distances from a segment as it is stored. Apart from rounding, none is too small: the distance from any
/// point of the segment is an upper bound.
class SquareDistance {
 public:
  explicit SquareDistance(const Segment& segment) : p0_(segment.p0), d_(segment.p1 - segment.p0) {
    const double square = d_.squaredNorm();
    inverse_ = square > 1e-200 ? 1 / square : 0;
  }
  double operator()(const Vector3d& x) const {
    const Vector3d y = x - p0_;
    return (y - std::clamp(y.dot(d_) * inverse_, 0.0, 1.0) * d_).squaredNorm();
  }

 private:
  Vector3d p0_, d_;
  double inverse_;
};

/// Largest distance of the points from the segment.
double reach(const Segment& segment, const Points& points) {
  const SquareDistance square(segment);
  double most = 0;
  for (const Vector3d& x : points) most = std::max(most, square(x));
  return std::sqrt(most);
}

/// Over pi. It grows with r, rounding included.
double volume(const Segment& segment, double r) {
  return r * r * (segment.length() + 4.0 / 3 * r);
}

/// The volume that holds the balls of this radius about all points; infinite if it is not less than `least`. A few
/// points may show that. They move to the front, as they most likely show it for the next segment too.
double volumeBelow(double least, const Segment& segment, Points& points, double radius) {
  const SquareDistance square(segment);
  double most = -1, v = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double found = square(points[i]);
    if (found <= most) continue;
    most = found;
    v = volume(segment, std::sqrt(most) + radius);
    if (v < least) continue;
    std::swap(points[i], points[i / 2]);
    return kInfinity;
  }
  return v;
}

/// The longest last.
Matrix3d principalAxes(const Points& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& x : points) mean += x;
  mean /= static_cast<double>(points.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& x : points) covariance += (x - mean) * (x - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors();
}

/// A segment along the last of three axes, through the middle of the extents across it. Its ends are as far out as the
/// round caps demand: a point at height z and distance c from the line needs an end at z - sqrt(r^2 - c^2) or beyond.
Segment alongAxis(const Matrix3d& axes, const Points& points) {
  Vector3d lo = Vector3d::Constant(kInfinity), hi = -lo;
  for (const Vector3d& x : points) {
    lo = lo.cwiseMin(axes.transpose() * x);
    hi = hi.cwiseMax(axes.transpose() * x);
  }
  const Vector3d middle = 0.5 * (lo + hi);
  double r = 0;
  for (const Vector3d& x : points) {
    const Vector3d y = axes.transpose() * x - middle;
    r = std::max(r, y.head<2>().norm());
  }
  double top = -kInfinity, bottom = kInfinity;
  for (const Vector3d& x : points) {
    const Vector3d y = axes.transpose() * x - middle;
    const double cap = std::sqrt(std::max(0.0, r * r - y[0] * y[0] - y[1] * y[1]));
    top = std::max(top, y[2] - cap);
    bottom = std::min(bottom, y[2] + cap);
  }
  if (bottom > top) bottom = top = 0.5 * (bottom + top);
  return {axes * (middle + Vector3d(0, 0, bottom)), axes * (middle + Vector3d(0, 0, top))};
}

/// About those few points on which a good segment depends: the farthest ones along directions all around.
Points extremePoints(const Points& points) {
  if (points.size() <= static_cast<std::size_t>(kExtremeDirections)) return points;
  const PointLanes lanes(points, 1 + points.size() / kSampled);
  Points kept;
  for (const Vector3d& n : spreadDirections(kExtremeDirections)) kept.push_back(points[lanes.farthest(n)]);
  return kept;
}

/// Random steps, longer after a gain, shorter else.
Segment searched(Segment best, Points points, double radius) {
  const double r = reach(best, points);
  if (r == 0) return best;  // a ball, or a capsule along its axis
  double least = volume(best, r + radius), step = 0.2 * r;
  std::minstd_rand random(1);
  const auto moved = [&] { return step * (2.0 * static_cast<double>(random()) / std::minstd_rand::max() - 1); };
  for (int i = 0; i < kSearchSteps; ++i) {
    Segment tried = best;
    for (int k = 0; k < 3; ++k) {
      tried.p0[k] += moved();
      tried.p1[k] += moved();
    }
    const double v = volumeBelow(least, tried, points, radius);
    step *= v < least ? 1.6 : 0.92;
    if (v >= least) continue;
    least = v;
    best = tried;
  }
  return best;
}

}  // namespace

LineSweptSphere encloseInLineSweptSphere(const std::vector<Eigen::Vector3d>& points, double radius) {
  const Points few = extremePoints(points);
  Matrix3d axes = principalAxes(points);
  Segment best = {Vector3d::Zero(), Vector3d::Zero()};
  double r = 0, least = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const Segment start = alongAxis(axes, points);
    for (const Segment& segment : {start, searched(start, few, radius)}) {
      const double needed = reach(segment, points) + radius, v = volume(segment, needed);
      if (v >= least) continue;
      least = v;
      best = segment;
      r = needed;
    }
    const Matrix3d turned = (Matrix3d() << axes.col(2), axes.col(0), axes.col(1)).finished();
    axes = turned;
  }
  // The proof rests only on reach() over all points, and on its rounding.
  r = r * (1 + 1e-12) + 1e-15 * (best.p0.norm() + best.p1.norm());
  return {best.p0[0], best.p0[1], best.p0[2], best.p1[0], best.p1[1], best.p1[2], r};
}

}  // namespace fcl_artic
