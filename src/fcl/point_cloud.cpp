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
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!(points_[i].cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e9)) {
      refuse("point " + std::to_string(i) + " is not finite or beyond 1e9 m");
    }
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
  aabb_local = fcl::AABBd();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius(i));
    aabb_local += fcl::AABBd(points_[i] - reach, points_[i] + reach);
  }
  aabb_center = aabb_local.center();
  aabb_radius = (aabb_local.max_ - aabb_center).norm();
}

}  // namespace fcl_artic
