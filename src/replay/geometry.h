// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include <fcl/geometry/collision_geometry.h>

#include "replay/record.h"

namespace fcl_artic::replay {

/// All that queries read of a geometry (GeometryContent). It must have been read, that is, not refused.
GeometryRecord geometryRecord(const fcl::CollisionGeometryd& geometry);

/// A geometry of which queries read the same.
/// @param at  way to the record, for messages.
/// @throws std::invalid_argument for numbers that FCL's constructors and readers don't check. The manager's own
///   refusals are left to the manager.
std::shared_ptr<fcl::CollisionGeometryd> geometryOf(const GeometryRecord& record, const std::string& at);

}  // namespace fcl_artic::replay
