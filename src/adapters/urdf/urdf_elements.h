// SPDX-License-Identifier: BSD-3-Clause
//
// What of a URDF is understood: the one list of elements and attributes. urdfdom passes over what it does not know, and
// a robot without a geometry, a place or a motion that its file has would pass as free.
#pragma once

#include <tinyxml2.h>

#include <string>

namespace fcl_artic::detail {

/// Refuses a document with anything in it that is neither understood nor on the list of what surely is no geometry,
/// place or motion of the robot; and one that has of anything more or less than it may have.
/// @return its <robot>.
/// @throws std::runtime_error beginning with `where`, naming element, attribute, line and cure.
tinyxml2::XMLElement& requireUnderstood(const std::string& where, tinyxml2::XMLDocument& document);

}  // namespace fcl_artic::detail
