// SPDX-License-Identifier: BSD-3-Clause
//
// Two doubles in a NEON register, which every 64-bit ARM processor has, with FMA. The file numerics/lanes.h lists what
// each function does. (NEON's own minimum and maximum treat NaN and zeros otherwise.)
#pragma once

#include <arm_neon.h>

#include "numerics/inlined.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using Register = float64x2_t;
FCL_ARTIC_INLINE Register regSet(double x) {
  return vdupq_n_f64(x);
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return vbslq_f64(vcltq_f64(a, b), a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return vbslq_f64(vcgtq_f64(a, b), a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return vabsq_f64(a);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return vsqrtq_f64(a);
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return vfmaq_f64(c, a, b);
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  const uint64x2_t which = vcgtq_f64(a, b);
  return (static_cast<unsigned>(vgetq_lane_u64(which, 0)) & 1) | (static_cast<unsigned>(vgetq_lane_u64(which, 1)) & 2);
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  return vbslq_f64(vcgtq_f64(a, b), x, y);
}
FCL_ARTIC_INLINE double regMaxLane(Register a) {
  return a[0] > a[1] ? a[0] : a[1];
}

using Integers = int32x2_t;
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  // Conversion saturates at the ends of 64 bits, and makes NaN 0: so what is out of range is found before.
  const uint64x2_t inside = vandq_u64(vcgtq_f64(a, regSet(-0x1p31 - 1)), vcltq_f64(a, regSet(0x1p31)));
  return vmovn_s64(vbslq_s64(inside, vcvtq_s64_f64(a), vdupq_n_s64(INT32_MIN)));
}
FCL_ARTIC_INLINE Integers regPlus(Integers n, int k) {
  return vadd_s32(n, vdup_n_s32(k));
}
FCL_ARTIC_INLINE Register regBits(Integers n, int bits) {
  return vcvtq_f64_s64(vmovl_s32(vand_s32(n, vdup_n_s32(bits))));
}

using Floats = float32x4_t;
FCL_ARTIC_INLINE Floats regNarrow(const Register* a) {
  return vcvt_high_f32_f64(vcvt_f32_f64(a[0]), a[1]);
}
FCL_ARTIC_INLINE Floats regSpread(float x) {
  return vdupq_n_f32(x);
}
FCL_ARTIC_INLINE Floats regAbove(Floats a, Floats b) {
  return vreinterpretq_f32_u32(vcgtq_f32(a, b));
}
FCL_ARTIC_INLINE Floats regOr(Floats a, Floats b) {
  return vreinterpretq_f32_u32(vorrq_u32(vreinterpretq_u32_f32(a), vreinterpretq_u32_f32(b)));
}
FCL_ARTIC_INLINE unsigned regSigns(Floats a) {
  const int32x4_t places = {0, 1, 2, 3};
  return vaddvq_u32(vshlq_u32(vshrq_n_u32(vreinterpretq_u32_f32(a), 31), places));
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
