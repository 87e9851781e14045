// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/point_cloud.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "numerics/shown.h"

namespace fcl_artic {
namespace {

void refuse(const std::string& why) {
  throw std::invalid_argument("PointCloud: " + why);
}

bool isThere(const Eigen::Vector3d& x) {
  return (std::abs(x[0]) <= 1e9) & (std::abs(x[1]) <= 1e9) & (std::abs(x[2]) <= 1e9);  // false for NaN
}

}  // namespace

PointCloud::PointCloud(std::vector<Eigen::Vector3d> points, double radius)
    : PointCloud(std::move(points), std::vector<double>{radius}) {}

PointCloud::PointCloud(std::vector<Eigen::Vector3d> points, std::vector<double> radii)
    : points_(std::move(points)), radii_(std::move(radii)) {
  if (points_.empty()) refuse("there is no point");
  if (points_.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    refuse("there are " + std::to_string(points_.size()) + " points; 2^31 - 1 are the most");
  }
  if (radii_.size() != 1 && radii_.size() != points_.size()) {
    refuse("there are " + std::to_string(points_.size()) + " points and " + std::to_string(radii_.size()) + " radii");
  }
  bool good = true;  // (All of them in one loop without a branch.)
  for (const Eigen::Vector3d& x : points_) good &= isThere(x);
  for (std::size_t i = 0; !good && i < points_.size(); ++i) {
    if (!isThere(points_[i])) refuse("point " + std::to_string(i) + " is not finite or beyond 1e9 m");
  }
  for (std::size_t i = 0; i < radii_.size(); ++i) {
    if (!(radii_[i] > 0) || !(radii_[i] <= 1e9)) {
      refuse((radii_.size() == 1 ? "its radius" : "the radius of point " + std::to_string(i)) + " is " +
             shown(radii_[i]) + ", not a positive number of metres");
    }
  }
  PointCloud::computeLocalAABB();
}

void PointCloud::computeLocalAABB() {
  // Rounding is monotonic: one radius may be taken off the least coordinate as well as off each.
  const bool one_radius = radii_.size() == 1;
  Eigen::Array3d lower = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double reach = one_radius ? 0 : radii_[i];
    lower = lower.min(points_[i].array() - reach);
    upper = upper.max(points_[i].array() + reach);
  }
  if (one_radius) {
    lower -= radii_[0];
    upper += radii_[0];
  }
  aabb_local = fcl::AABBd(lower.matrix(), upper.matrix());
  aabb_center = aabb_local.center();
  aabb_radius = (aabb_local.max_ - aabb_center).norm();
}

}  // namespace fcl_artic
