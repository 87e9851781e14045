// SPDX-License-Identifier: BSD-3-Clause
//
// The parts of a URDF and of an SRDF that are understood: the lists of elements and attributes. The library urdfdom
// passes over what it does not know. A robot without a geometry, a place or a motion that its file has would pass as
// free; so would a pair that an SRDF wants checked.
#pragma once

#include <tinyxml2.h>

#include <string>

namespace fcl_artic::detail {

enum class Vocabulary { urdf, srdf };

/// Parses a document. It refuses one with anything in it that is neither understood nor on the list of what surely
/// does not matter. It also refuses one that has of anything more or less than it may have.
/// @return its <robot>.
/// @throws std::runtime_error beginning with `where`, naming element, attribute, line and cure.
tinyxml2::XMLElement& parseUnderstood(const std::string& where, const std::string& content, Vocabulary vocabulary,
                                      tinyxml2::XMLDocument& document);

}  // namespace fcl_artic::detail
