// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include <fcl/geometry/collision_geometry.h>

#include "fcl_artic/abi.h"
#include "fcl_artic/export.h"

namespace fcl_artic {

/// A cloud of points, as depth cameras and scanners give it, each of them a ball: what touches one of the balls touches
/// the cloud. The radius says how far the surface may be from where a point was measured. It goes wherever FCL geometry
/// goes: into an ArticulatedCollisionManager, as an obstacle, the geometry of a link or an attached object, into a
/// ContinuousCollisionManager, into fcl_artic::continuousCollide(). FCL itself knows no such geometry and has no answer
/// for it.
///
///     auto cloud = std::make_shared<fcl_artic::PointCloud>(points, 0.005);
///     manager.registerObject(std::make_shared<fcl::CollisionObjectd>(cloud), "scan");
///
/// A contact's b1 or b2 is the number of the point that is touched. A cloud cannot be changed: make another one. About
/// 145 bytes a point are taken where it is read, beside the 24 of the cloud itself.
class FCL_ARTIC_EXPORT PointCloud : public fcl::CollisionGeometryd {
 public:
  /// @param points  in m, in the geometry's own frame; at least one.
  /// @param radius  of all points, in m.
  /// @throws std::invalid_argument naming the point: no point, more than 2^31 - 1, a coordinate that is not finite or
  ///   beyond 1e9 m, a radius that is not positive and finite.
  PointCloud(std::vector<Eigen::Vector3d> points, double radius);
  /// @param points  as above.
  /// @param radii   one for each point, in m.
  /// @throws std::invalid_argument as above, and when there are not as many radii as points.
  PointCloud(std::vector<Eigen::Vector3d> points, std::vector<double> radii);
  /// Copies all points.
  PointCloud(const PointCloud&) = default;
  /// Nobody changes a cloud: whoever holds one need not look again.
  PointCloud& operator=(const PointCloud&) = delete;

  /// The points, in m, in the geometry's own frame.
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// The radius of a point, in m.
  double radius(std::size_t point) const { return radii_.size() == 1 ? radii_[0] : radii_[point]; }
  /// The radii in m: one for all points, or one for each.
  const std::vector<double>& radii() const { return radii_; }

  /// Computes FCL's box and ball around the whole, as FCL asks of every geometry.
  void computeLocalAABB() override;

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> radii_;
};

}  // namespace fcl_artic
