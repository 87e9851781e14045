// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/cloud_tree.h"
#include "geometry/thinning.h"
#include "numerics/constants.h"
#include "numerics/shown.h"

namespace fcl_artic {
namespace {

void refuse(const std::string& why) {
  throw std::invalid_argument("PointCloud: " + why);
}

bool isThere(const Eigen::Vector3d& x) {
  return std::abs(x[0]) <= kFarthest && std::abs(x[1]) <= kFarthest && std::abs(x[2]) <= kFarthest;  // false for NaN
}

template <class S>
FramePoints readRows(const char* row, std::size_t count, const FrameLayout& layout) {
  FramePoints frame;
  frame.points.resize(count);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i, row += layout.stride) {
    S x[3];
    std::memcpy(&x[0], row + layout.x, sizeof(S));
    std::memcpy(&x[1], row + layout.y, sizeof(S));
    std::memcpy(&x[2], row + layout.z, sizeof(S));
    constexpr S kMost = std::numeric_limits<S>::max();
    const bool there = std::abs(x[0]) <= kMost && std::abs(x[1]) <= kMost && std::abs(x[2]) <= kMost;
    if (!there) {
      if (frame.missing++ == 0) {  // the rows before it are points
        frame.rows.resize(i);
        std::iota(frame.rows.begin(), frame.rows.end(), 0u);
        frame.rows.reserve(count);
      }
      frame.too_near += std::any_of(x, x + 3, [](S value) { return value < -kMost; });
      continue;
    }
    frame.points[found++] = Eigen::Matrix<S, 3, 1>::Map(x).template cast<double>();
    if (frame.missing > 0) frame.rows.push_back(static_cast<std::uint32_t>(i));
  }
  frame.points.resize(found);
  return frame;
}

}  // namespace

PointCloud::PointCloud(std::vector<Eigen::Vector3d> points, double radius)
    : PointCloud(std::move(points), std::vector<double>{radius}) {}

PointCloud::PointCloud(std::vector<Eigen::Vector3d> points, std::vector<double> radii)
    : points_(std::move(points)), radii_(std::move(radii)) {
  if (points_.empty()) refuse("there is no point");
  if (points_.size() > kMaxBalls) refuse("there are " + std::to_string(points_.size()) + " points; 5e8 are the most");
  if (radii_.size() != 1 && radii_.size() != points_.size()) {
    refuse("there are " + std::to_string(points_.size()) + " points and " + std::to_string(radii_.size()) + " radii");
  }
  bool good = true;  // (All of them in one loop without a branch.)
  for (const Eigen::Vector3d& x : points_) good &= isThere(x);
  for (std::size_t i = 0; !good && i < points_.size(); ++i) {
    if (!isThere(points_[i])) refuse("point " + std::to_string(i) + " is not finite or beyond 1e9 m");
  }
  for (std::size_t i = 0; i < radii_.size(); ++i) {
    if (!(radii_[i] > 0) || !(radii_[i] <= kFarthest)) {
      refuse((radii_.size() == 1 ? "its radius" : "the radius of point " + std::to_string(i)) + " is " +
             shown(radii_[i]) + ", not a positive number of metres");
    }
  }
  PointCloud::computeLocalAABB();
}

std::shared_ptr<PointCloud> PointCloud::thinned(double voxel) const {
  if (!(voxel >= 1e-6 && voxel <= 1e9)) {
    refuse("the side of a voxel is " + shown(voxel) + ", not a length from 1e-6 to 1e9 m");
  }
  ThinnedBalls balls = thin(points_, radii_, voxel);
  return std::make_shared<PointCloud>(std::move(balls.centers), std::move(balls.radii));
}

FramePoints readFrame(const void* rows, std::size_t count, const FrameLayout& layout) {
  const std::size_t size = layout.is_double ? sizeof(double) : sizeof(float);
  for (const std::size_t at : {layout.x, layout.y, layout.z}) {
    if (at <= layout.stride && size <= layout.stride - at) continue;
    throw std::invalid_argument("readFrame: a coordinate at byte " + std::to_string(at) +
                                " does not fit into rows of " + std::to_string(layout.stride) + " bytes");
  }
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument("readFrame: there are " + std::to_string(count) + " rows; 2^32 - 1 are the most");
  }
  return layout.is_double ? readRows<double>(static_cast<const char*>(rows), count, layout)
                          : readRows<float>(static_cast<const char*>(rows), count, layout);
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
