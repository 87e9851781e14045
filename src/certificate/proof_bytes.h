// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers as a proof has them (doc/CERTIFICATES.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace fcl_artic::certificate {

class ProofBytes {
 public:
  /// @param out  bytes are added to it.
  explicit ProofBytes(std::string& out) : out_(out) {}

  void byte(int value) { out_ += static_cast<char>(value); }
  /// LEB128.
  void number(std::size_t n) {
    for (; n >= 128; n >>= 7) byte(static_cast<int>(n & 127) | 128);
    byte(static_cast<int>(n));
  }
  /// Appends x in `bytes` bytes, little endian.
  void fixed(std::int64_t x, int bytes) {
    for (int i = 0; i < bytes; ++i) byte(static_cast<int>(static_cast<std::uint64_t>(x) >> (8 * i) & 255));
  }
  void real(double x) {
    std::int64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    fixed(bits, 8);
  }

 private:
  std::string& out_;
};

}  // namespace fcl_artic::certificate
