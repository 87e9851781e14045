// SPDX-License-Identifier: BSD-3-Clause
//
// Stands in the place of the engine's file of this name: one recorded number instead of a processor's register.
// numerics/lanes.h lists the meaning of each function.
#pragma once

#include <cstdint>

#include "numerics/inlined.h"
#include "recorded.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using recording::mulAdd;
using recording::Recorded;

struct Register {
  Recorded x;
};
inline Register operator+(Register a, Register b) {
  return {a.x + b.x};
}
inline Register operator-(Register a, Register b) {
  return {a.x - b.x};
}
inline Register operator*(Register a, Register b) {
  return {a.x * b.x};
}
inline Register operator/(Register a, Register b) {
  return {a.x / b.x};
}
inline Register operator-(Register a) {
  return {-a.x};
}
inline Register regSet(Recorded x) {
  return {x};
}
inline Register regMin(Register a, Register b) {
  return a.x < b.x ? a : b;
}
inline Register regMax(Register a, Register b) {
  return a.x > b.x ? a : b;
}
inline Register regAbs(Register a) {
  return {recording::absolute(a.x)};
}
inline Register regSqrt(Register a) {
  return {recording::rootOf(a.x)};
}
inline Register regMulAdd(Register a, Register b, Register c) {
  return {recording::productPlus(a.x, b.x, c.x)};
}
inline unsigned regGreater(Register a, Register b) {
  recording::comparisons().emplace_back(a.x, b.x);
  return a.x > b.x ? 1 : 0;
}
inline Register regWhereGreater(Register a, Register b, Register x, Register y) {
  return a.x > b.x ? x : y;
}
inline Recorded regMaxLane(Register a) {
  return a.x;
}

struct Integers {
  int n;
};
inline Integers regTruncate(Register a) {
  return {static_cast<int>(a.x.value)};
}
inline Integers regPlus(Integers n, int k) {
  return {n.n + k};
}
/// Whole numbers are given: no rounding made them.
inline Register regBits(Integers n, int bits) {
  return {recording::given(n.n & bits)};
}

struct Floats {
  float x;
};
/// Keeps what is narrowed among the comparisons, with itself.
inline Floats regNarrow(const Register* a) {
  recording::comparisons().emplace_back(a->x, a->x);
  return {static_cast<float>(a->x)};
}
inline Floats regSpread(float x) {
  return {x};
}
inline Floats regAbove(Floats a, Floats b) {
  return {a.x > b.x ? 1.0F : 0.0F};
}
inline Floats regOr(Floats a, Floats b) {
  return {a.x + b.x > 0 ? 1.0F : 0.0F};
}
inline unsigned regSigns(Floats a) {
  return a.x > 0 ? 1 : 0;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
