// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace fcl_artic {
namespace redon {

/// The part of 2^level that holds part k of 2^finer.
inline int partHolding(int level, int k, int finer) {
  return k >> (finer - level);
}

/// Parts k of 2^level as a set, from those of 2^from that they have time in common with, instants aside.
inline std::uint64_t partsAt(int level, std::uint64_t parts, int from) {
  std::uint64_t out = 0;
  for (int k = 0; k < 1 << level; ++k) {
    const int first = level > from ? k >> (level - from) : k << (from - level);
    const int count = level > from ? 1 : 1 << (from - level);
    for (int j = first; j < first + count; ++j) out |= (parts >> j & 1) << k;
  }
  return out;
}

}  // namespace redon
}  // namespace fcl_artic
