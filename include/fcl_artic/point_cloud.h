// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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
/// 40 bytes a point are taken where it is read, 8 more if each has its own radius, beside the 24 of the cloud itself.
class FCL_ARTIC_EXPORT PointCloud : public fcl::CollisionGeometryd {
 public:
  /// @param points  in m, in the geometry's own frame; at least one.
  /// @param radius  of all points, in m.
  /// @throws std::invalid_argument naming the point: no point, more than 5e8, a coordinate that is not finite or
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

  /// Returns a cloud of fewer points: one for each cube of a grid in which points lie, in the order of the cubes' first
  /// points. Its ball holds the balls of all points of its cube, proven, rounding included: a motion that is free of
  /// the thinned cloud is free of this one. A cube with one point keeps it as it is. Else the ball's centre is the
  /// middle of the points' box. Its radius is what they need: at most a point's radius and 0.87 of the cube's side. So
  /// the cloud grows by at most 1.74 sides. Numbers of contacts' points are those of the thinned cloud.
  /// @param voxel  a cube's side, in m: 1e-6 to 1e9. The grid is that of the geometry's own frame.
  /// @throws std::invalid_argument for another side.
  [[nodiscard]] std::shared_ptr<PointCloud> thinned(double voxel) const;

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

/// Where a frame of a sensor has the x, y and z of its points, as sensor_msgs/PointCloud2 says it: rows of bytes of one
/// size, in the machine's own order of bytes. All else in a row is passed over.
struct FrameLayout {
  std::size_t stride = 12;          ///< Bytes from one row to the next: point_step.
  std::size_t x = 0, y = 4, z = 8;  ///< Where each begins in a row: offset.
  bool is_double = false;           ///< Whether they are float64; else they are float32.
};

/// The points of a frame. Rows with a coordinate that is NaN or infinite are none: rays without an echo.
struct FramePoints {
  std::vector<Eigen::Vector3d> points;  ///< In m, in the rows' order.
  std::vector<std::uint32_t> rows;      ///< The row of each point; empty: all rows are points.
  std::size_t missing = 0;              ///< Rows that are none.
  /// How many of these have -inf. By it some cameras mean that something is too near to be measured: it is not in the
  /// scene.
  std::size_t too_near = 0;
};

/// Reads the points of a frame where it lies in memory.
/// @param rows   `count` rows, of any alignment; of an image whose lines are padded, one line.
/// @throws std::invalid_argument for a layout whose rows are too short for its coordinates, and for 2^32 rows or more.
FCL_ARTIC_EXPORT FramePoints readFrame(const void* rows, std::size_t count, const FrameLayout& layout = {});

}  // namespace fcl_artic
