// SPDX-License-Identifier: BSD-3-Clause
// SHA-256, FIPS 180-4.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace verify {

/// 32 bytes.
std::string sha256(std::string_view data);
/// 64 hexadecimal digits, lower case.
std::string hexOf(std::string_view hash);

}  // namespace verify
