// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace fcl_artic::certificate {

/// SHA-256 of bytes (FIPS 180-4).
std::array<std::uint8_t, 32> sha256(std::string_view bytes);
/// The same as 64 hexadecimal digits, in lower case.
std::string sha256Text(std::string_view bytes);

}  // namespace fcl_artic::certificate
