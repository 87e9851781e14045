// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "image.h"

namespace fcl_artic::render {

/// Writes one line of ASCII text at the top left, dark with a light rim, its size after the image's height. A line that
/// is too long is cut and ends in "...". Characters without a glyph show as a box.
void drawTitle(Image& image, const std::string& text);

}  // namespace fcl_artic::render
