// SPDX-License-Identifier: BSD-3-Clause
#include "image.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <png.h>

namespace fcl_artic::render {

void writePng(const std::string& path, const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  errno = 0;
  if (!png_image_write_to_file(&header, path.c_str(), 0, image.rgb.data(), 0, nullptr)) {
    const std::string reason = errno ? std::strerror(errno) : header.message;
    throw std::runtime_error("can't write the picture '" + path + "': " + reason);
  }
}

}  // namespace fcl_artic::render
