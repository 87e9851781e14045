// SPDX-License-Identifier: BSD-3-Clause
//
// Two doubles in a vector of the compiler's, for processors without a file of their own: GCC and clang make of it what
// the processor has, NEON on ARM, one double after the other elsewhere. The file numerics/pair.h lists what each
// function does.
#pragma once

#include <cstdint>

#include "numerics/inlined.h"

namespace fcl_artic {

typedef double Pair __attribute__((vector_size(16), may_alias));
typedef std::int64_t PairBits __attribute__((vector_size(16)));
FCL_ARTIC_INLINE PairBits pairBits(Pair a) {
  return reinterpret_cast<PairBits>(a);
}
/// x where the bits of `which` are set, else y.
FCL_ARTIC_INLINE Pair pairSelect(PairBits which, Pair x, Pair y) {
  return reinterpret_cast<Pair>((which & pairBits(x)) | (~which & pairBits(y)));
}

FCL_ARTIC_INLINE Pair pairOf(double low, double high) {
  return Pair{low, high};
}
FCL_ARTIC_INLINE Pair pairOf(double x) {
  return pairOf(x, x);
}
FCL_ARTIC_INLINE double pairLow(Pair a) {
  return a[0];
}
FCL_ARTIC_INLINE double pairHigh(Pair a) {
  return a[1];
}
FCL_ARTIC_INLINE Pair pairLows(Pair a, Pair b) {
  return Pair{a[0], b[0]};
}
FCL_ARTIC_INLINE Pair pairHighs(Pair a, Pair b) {
  return Pair{a[1], b[1]};
}
FCL_ARTIC_INLINE Pair pairLows(Pair a) {
  return pairLows(a, a);
}
FCL_ARTIC_INLINE Pair pairHighs(Pair a) {
  return pairHighs(a, a);
}
FCL_ARTIC_INLINE Pair pairSwap(Pair a) {
  return Pair{a[1], a[0]};
}
FCL_ARTIC_INLINE Pair pairMix(Pair a, Pair b) {
  return Pair{a[0], b[1]};
}
FCL_ARTIC_INLINE Pair pairNegate(Pair a) {
  return reinterpret_cast<Pair>(pairBits(a) ^ INT64_MIN);
}
FCL_ARTIC_INLINE Pair pairNegateLow(Pair a) {
  return reinterpret_cast<Pair>(pairBits(a) ^ PairBits{INT64_MIN, 0});
}
FCL_ARTIC_INLINE Pair pairMin(Pair a, Pair b) {
  return pairSelect(a < b, a, b);
}
FCL_ARTIC_INLINE Pair pairMax(Pair a, Pair b) {
  return pairSelect(a > b, a, b);
}
FCL_ARTIC_INLINE Pair pairWhereAtMost(Pair a, Pair b, Pair x, Pair y) {
  return pairSelect(a <= b, x, y);
}
FCL_ARTIC_INLINE unsigned pairGreater(Pair a, Pair b) {
  return static_cast<unsigned>(a[0] > b[0]) | static_cast<unsigned>(a[1] > b[1]) << 1;
}
FCL_ARTIC_INLINE Pair pairWithSignOf(double x, Pair a) {
  return reinterpret_cast<Pair>((pairBits(a) & INT64_MIN) | pairBits(pairOf(x)));
}

struct PairIntegers {
  std::int32_t of[2];
};
FCL_ARTIC_INLINE PairIntegers pairTruncate(Pair a) {
  return {{static_cast<std::int32_t>(a[0]), static_cast<std::int32_t>(a[1])}};
}
FCL_ARTIC_INLINE PairIntegers pairPlus(PairIntegers n, int k) {
  for (std::int32_t& i : n.of) {
    i = static_cast<std::int32_t>(static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(k));
  }
  return n;
}
FCL_ARTIC_INLINE Pair pairOf(PairIntegers n) {
  return Pair{static_cast<double>(n.of[0]), static_cast<double>(n.of[1])};
}
FCL_ARTIC_INLINE Pair pairWhereOdd(PairIntegers n, Pair x, Pair y) {
  return pairSelect(PairBits{-(n.of[0] & 1), -(n.of[1] & 1)}, x, y);
}
FCL_ARTIC_INLINE Pair pairFlip(Pair a, PairIntegers n) {
  return reinterpret_cast<Pair>(pairBits(a) ^ PairBits{n.of[0] & 2 ? INT64_MIN : 0, n.of[1] & 2 ? INT64_MIN : 0});
}

}  // namespace fcl_artic
