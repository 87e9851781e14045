// SPDX-License-Identifier: BSD-3-Clause
//
// Two doubles in a vector of the compiler's, for processors without a file of their own: GCC and clang make of it what
// the processor has, NEON on ARM, one double after the other elsewhere. The file numerics/lanes.h lists what each
// function does. Comparisons and signs do not depend on the rounding mode; of the functions here, only regSqrt,
// regMulAdd and regNarrow round, each by one operation of the processor for each rounding.
#pragma once

#include <cstdint>

#include "numerics/inlined.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

typedef double Register __attribute__((vector_size(16), may_alias));
typedef std::int64_t RegisterBits __attribute__((vector_size(16)));
FCL_ARTIC_INLINE RegisterBits bitsOf(Register a) {
  return reinterpret_cast<RegisterBits>(a);
}
/// x where the bits of `which` are set, else y.
FCL_ARTIC_INLINE Register regSelect(RegisterBits which, Register x, Register y) {
  return reinterpret_cast<Register>((which & bitsOf(x)) | (~which & bitsOf(y)));
}

FCL_ARTIC_INLINE Register regSet(double x) {
  return Register{x, x};
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return regSelect(a < b, a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return regSelect(a > b, a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return reinterpret_cast<Register>(bitsOf(a) & INT64_MAX);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return Register{__builtin_sqrt(a[0]), __builtin_sqrt(a[1])};
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return a * b + c;
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  return static_cast<unsigned>(a[0] > b[0]) | static_cast<unsigned>(a[1] > b[1]) << 1;
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  return regSelect(a > b, x, y);
}
FCL_ARTIC_INLINE double regMaxLane(Register a) {
  return a[0] > a[1] ? a[0] : a[1];
}

struct Integers {
  std::int32_t of[2];
};
FCL_ARTIC_INLINE std::int32_t truncated(double a) {
  return a > -0x1p31 && a < 0x1p31 ? static_cast<std::int32_t>(a) : INT32_MIN;
}
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  return {{truncated(a[0]), truncated(a[1])}};
}
FCL_ARTIC_INLINE std::int32_t plus(std::int32_t n, int k) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(n) + static_cast<std::uint32_t>(k));
}
FCL_ARTIC_INLINE Integers regPlus(Integers n, int k) {
  return {{plus(n.of[0], k), plus(n.of[1], k)}};
}
FCL_ARTIC_INLINE Register regBits(Integers n, int bits) {
  return Register{static_cast<double>(n.of[0] & bits), static_cast<double>(n.of[1] & bits)};
}

typedef float Floats __attribute__((vector_size(16), may_alias));
typedef std::int32_t FloatsBits __attribute__((vector_size(16)));
FCL_ARTIC_INLINE Floats regNarrow(const Register* a) {
  return Floats{static_cast<float>(a[0][0]), static_cast<float>(a[0][1]), static_cast<float>(a[1][0]),
                static_cast<float>(a[1][1])};
}
FCL_ARTIC_INLINE Floats regSpread(float x) {
  return Floats{x, x, x, x};
}
FCL_ARTIC_INLINE Floats regAbove(Floats a, Floats b) {
  return reinterpret_cast<Floats>(a > b);
}
FCL_ARTIC_INLINE Floats regOr(Floats a, Floats b) {
  return reinterpret_cast<Floats>(reinterpret_cast<FloatsBits>(a) | reinterpret_cast<FloatsBits>(b));
}
FCL_ARTIC_INLINE unsigned regSigns(Floats a) {
  const FloatsBits bits = reinterpret_cast<FloatsBits>(a);
  unsigned mask = 0;
  for (int i = 0; i < 4; ++i) mask |= static_cast<unsigned>(bits[i] < 0) << i;
  return mask;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
