// SPDX-License-Identifier: BSD-3-Clause
#include "image.h"

#include <stdexcept>

#include <png.h>

#include "files/files.h"

namespace fcl_artic::render {

std::string png(const Image& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  std::string content(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = content.size();
  if (!png_image_write_to_memory(&header, content.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("cannot make a PNG: ") + header.message);
  }
  content.resize(size);
  return content;
}

void writePng(const std::string& path, const Image& image) {
  files::write(path, png(image));
}

}  // namespace fcl_artic::render
