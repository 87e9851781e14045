// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace fcl_artic::meshes {

/// A number of a binary file, as its header names it.
struct Scalar {
  char kind = 'F';        ///< F: floating point, I: signed, U: unsigned
  std::size_t bytes = 0;  ///< 0: none
  /// @param at  that many bytes. @param swap  whether they begin with the highest one.
  double read(const char* at, bool swap) const {
    char own[8];
    std::memcpy(own, at, bytes);
    if (swap) std::reverse(own, own + bytes);
    const auto as = [&](auto value) {
      std::memcpy(&value, own, sizeof value);
      return static_cast<double>(value);
    };
    if (kind == 'F') return bytes == 4 ? as(float()) : as(double());
    const bool is_signed = kind == 'I';
    switch (bytes) {
      case 1:
        return is_signed ? as(std::int8_t()) : as(std::uint8_t());
      case 2:
        return is_signed ? as(std::int16_t()) : as(std::uint16_t());
      case 4:
        return is_signed ? as(std::int32_t()) : as(std::uint32_t());
      default:
        return is_signed ? as(std::int64_t()) : as(std::uint64_t());
    }
  }
};

/// Whether a number that a file gives for each point says how far the point extends.
inline bool isExtent(std::string_view name) {
  const auto begins = [&](std::string_view start) { return name.substr(0, start.size()) == start; };
  return name == "w" || name == "scale" || begins("size") || begins("radius") || begins("diameter") ||
         begins("scale_") || begins("rot_");
}

}  // namespace fcl_artic::meshes
