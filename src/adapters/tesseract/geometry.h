// SPDX-License-Identifier: BSD-3-Clause
//
// tesseract's collision geometries as FCL's.
#pragma once

#include <memory>
#include <vector>

#include <fcl/geometry/collision_geometry.h>
#include <tesseract/geometry/geometry.h>

namespace fcl_artic {

/// FCL's geometries of one of tesseract's: one, or for a compound mesh as many as it has meshes.
/// @throws std::invalid_argument with the reason, for a geometry that is not supported or empty.
std::vector<std::shared_ptr<fcl::CollisionGeometryd>> fromTesseractGeometry(
    const ::tesseract::geometry::Geometry& geometry);

}  // namespace fcl_artic
