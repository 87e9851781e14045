// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene.h"

namespace campaign {

/// A motion whose first contact is known because it was built from it: body 0 (on the last link) and body 1 (the
/// obstacle) are put on the two sides of a plane so that they touch at one point of it, or face on face, and the motion
/// at t* makes them approach.
struct Constructed {
  Scene scene;
  double time = 0;          ///< t*
  Vec3 point;               ///< world
  Vec3 normal;              ///< world, unit, from body 0 to body 1
  double normal_speed = 0;  ///< of approach at t*, m per unit of t
  bool region = false;      ///< face on face: `point` is one of many
  bool curved = false;      ///< a curved side meets a flat one: shallow overlaps are wide
};

/// "<feature of body 0> on <feature of body 1>".
const std::vector<std::string>& contactKinds();
/// "revolute", "prismatic" or "mixed" (two or three joints).
const std::vector<std::string>& chainKinds();

/// A case of this kind by seed: drawn until the approach is at least 0.1 m per unit of t and sampling shows no contact
/// on [0, t* - 1e-7]. Before t*, in its last 1e-7, the gap at the feature shrinks at that speed.
/// @throws std::runtime_error when no draw will do
Constructed constructContact(const std::string& contact, const std::string& chain, std::uint64_t seed);

}  // namespace campaign
