// SPDX-License-Identifier: BSD-3-Clause
#include "sha256.h"

#include <cstring>

namespace verify {
namespace {

std::uint32_t turned(std::uint32_t x, int n) {
  return x >> n | x << (32 - n);
}

/// Section 6.2.2 of the standard.
void block(std::uint32_t H[8], const std::uint8_t* bytes) {
  static const std::uint32_t K[64] = {
      0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
      0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
      0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
      0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
      0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
      0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
      0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
      0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
  std::uint32_t W[64];
  for (int t = 0; t < 16; ++t)
    W[t] = static_cast<std::uint32_t>(bytes[4 * t]) << 24 | static_cast<std::uint32_t>(bytes[4 * t + 1]) << 16 |
           static_cast<std::uint32_t>(bytes[4 * t + 2]) << 8 | bytes[4 * t + 3];
  for (int t = 16; t < 64; ++t) {
    const std::uint32_t a = W[t - 15], b = W[t - 2];
    W[t] = (turned(b, 17) ^ turned(b, 19) ^ b >> 10) + W[t - 7] + (turned(a, 7) ^ turned(a, 18) ^ a >> 3) + W[t - 16];
  }
  std::uint32_t v[8];
  std::memcpy(v, H, sizeof v);
  for (int t = 0; t < 64; ++t) {
    const std::uint32_t e = v[4], a = v[0];
    const std::uint32_t t1 =
        v[7] + (turned(e, 6) ^ turned(e, 11) ^ turned(e, 25)) + ((e & v[5]) ^ (~e & v[6])) + K[t] + W[t];
    const std::uint32_t t2 = (turned(a, 2) ^ turned(a, 13) ^ turned(a, 22)) + ((a & v[1]) ^ (a & v[2]) ^ (v[1] & v[2]));
    for (int k = 7; k > 0; --k) v[k] = v[k - 1];
    v[4] += t1;
    v[0] = t1 + t2;
  }
  for (int k = 0; k < 8; ++k) H[k] += v[k];
}

}  // namespace

std::string sha256(std::string_view data) {
  std::uint32_t H[8] = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  // After the data a bit, zeros, and the length in bits, 64 bits wide, at a block's end.
  std::string padded(data);
  padded += '\x80';
  padded.resize((data.size() + 9 + 63) / 64 * 64);
  for (std::size_t k = 0; k < 8; ++k)
    padded[padded.size() - 1 - k] = static_cast<char>(static_cast<std::uint64_t>(data.size()) * 8 >> 8 * k);
  for (std::size_t k = 0; k < padded.size(); k += 64) block(H, reinterpret_cast<const std::uint8_t*>(&padded[k]));
  std::string hash;
  for (std::size_t k = 0; k < 32; ++k) hash += static_cast<char>(H[k / 4] >> (24 - 8 * (k % 4)));
  return hash;
}

std::string hexOf(std::string_view hash) {
  std::string text;
  for (const char byte : hash) {
    text += "0123456789abcdef"[byte >> 4 & 15];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

}  // namespace verify
