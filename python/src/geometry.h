// SPDX-License-Identifier: BSD-3-Clause
//
// Geometries in Python: FCL's, constant and shared.
#pragma once

#include <memory>

#include <fcl/geometry/collision_geometry.h>
#include <fcl/narrowphase/collision_object.h>

#include "array.h"
#include "fcl_artic/point_cloud.h"

namespace fcl_artic::python {

/// A geometry as Python holds it. It is not changed once it is made, so that threads may share it.
struct Geometry {
  std::shared_ptr<fcl::CollisionGeometryd> shape;
  std::size_t missing = 0;  ///< rows without a point that points() left out
};

/// The geometry of a Geometry, or the mesh of an object that has `vertices` and `faces`, as trimesh's Trimesh.
/// @throws py::type_error naming `what`.
Geometry geometryOf(py::handle value, const char* what);

/// Points as an array has them: (N, 3) numbers, or rows with fields x, y and z, as those of a PointCloud2.
struct PointArray {
  py::array rows;  ///< one-dimensional, or (N, 3)
  FramePoints frame;
};
/// @throws py::type_error, py::value_error naming `what`.
PointArray pointArrayOf(py::handle value, const char* what);

/// An object of the geometry at a pose.
std::shared_ptr<fcl::CollisionObjectd> objectOf(const Geometry& geometry, const Eigen::Isometry3d& pose);

/// Describes a geometry by plain numbers and arrays, and makes it again from these.
py::tuple geometryState(const Geometry& geometry);
Geometry geometryOfState(const py::tuple& state);

void bindGeometry(py::module_& module);

}  // namespace fcl_artic::python
