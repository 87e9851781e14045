// SPDX-License-Identifier: BSD-3-Clause
//
// The files that every page is made of, as they are when the program is built (CMakeLists.txt).
#pragma once

#include <string_view>

namespace fcl_artic::app::page_parts {

extern const std::string_view kPage;    ///< page.html, with places for what differs: {{title}}
extern const std::string_view kStyle;   ///< page.css
extern const std::string_view kViewer;  ///< viewer.js

}  // namespace fcl_artic::app::page_parts
