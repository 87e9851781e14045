// SPDX-License-Identifier: BSD-3-Clause
// SHA-256, FIPS 180-4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace verify {

using Hash = std::array<std::uint8_t, 32>;
Hash sha256(const void* data, std::size_t size);
/// 64 hexadecimal digits, lower case.
std::string hexOf(const Hash& hash);

}  // namespace verify
