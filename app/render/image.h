// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fcl_artic::render {

/// An 8 bit RGB image, top row first, sRGB.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height
};

/// The image as the content of a PNG file.
/// @throws std::runtime_error naming the reason.
std::string png(const Image& image);
/// @throws std::runtime_error naming the file and the reason.
void writePng(const std::string& path, const Image& image);

}  // namespace fcl_artic::render
