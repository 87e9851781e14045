// SPDX-License-Identifier: BSD-3-Clause
//
// Eight doubles that go through together: eight time intervals, one per lane. Compiled once per instruction set: the
// including file defines FCL_ARTIC_ISA (the namespace) and FCL_ARTIC_ISA_BITS (128, 256 or 512) first. Nothing here or
// in the files built on it may instantiate inline code of other libraries: the linker could pick that copy for a
// processor that lacks the instructions.
//
// Every bound that uses lanes carries its rounding in a pad (doc/NUMERICS.md, "Pads") which holds in any rounding mode,
// with or without FMA, so mulAdd() may round once or twice.
#pragma once

#include <immintrin.h>

#ifdef __FAST_MATH__
#error "fcl_artic proves bounds in floating point: it cannot be compiled with -ffast-math"
#endif

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

#define FCL_ARTIC_INLINE inline __attribute__((always_inline))

// Scalars get the vocabulary of lanes, so that one text serves both.
FCL_ARTIC_INLINE double min(double a, double b) {
  return a < b ? a : b;
}
FCL_ARTIC_INLINE double max(double a, double b) {
  return a > b ? a : b;
}
FCL_ARTIC_INLINE float min(float a, float b) {
  return a < b ? a : b;
}
FCL_ARTIC_INLINE float max(float a, float b) {
  return a > b ? a : b;
}
FCL_ARTIC_INLINE int max(int a, int b) {
  return a > b ? a : b;
}
FCL_ARTIC_INLINE int min(int a, int b) {
  return a < b ? a : b;
}
FCL_ARTIC_INLINE double abs(double a) {
  return __builtin_fabs(a);
}
FCL_ARTIC_INLINE double sqrt(double a) {
  return __builtin_sqrt(a);
}
FCL_ARTIC_INLINE double mulAdd(double a, double b, double c) {
  return a * b + c;
}

constexpr int kLanes = 8;
constexpr unsigned kAllLanes = 0xff;

#if FCL_ARTIC_ISA_BITS == 512
using Register = __m512d;
FCL_ARTIC_INLINE Register regSet(double x) {
  return _mm512_set1_pd(x);
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return _mm512_min_pd(a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return _mm512_max_pd(a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return _mm512_abs_pd(a);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return _mm512_sqrt_pd(a);
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return _mm512_fmadd_pd(a, b, c);
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  return _mm512_mask_mov_pd(y, _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), x);
}
using Integers = __m256i;
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  return _mm512_cvttpd_epi32(a);
}
FCL_ARTIC_INLINE Integers regPlus(Integers a, int b) {
  return _mm256_add_epi32(a, _mm256_set1_epi32(b));
}
FCL_ARTIC_INLINE Register regBits(Integers a, int bits) {
  return _mm512_cvtepi32_pd(_mm256_and_si256(a, _mm256_set1_epi32(bits)));
}
#elif FCL_ARTIC_ISA_BITS == 256
using Register = __m256d;
FCL_ARTIC_INLINE Register regSet(double x) {
  return _mm256_set1_pd(x);
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return _mm256_min_pd(a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return _mm256_max_pd(a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return _mm256_sqrt_pd(a);
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return _mm256_fmadd_pd(a, b, c);
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)));
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  return _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_GT_OQ));
}
using Integers = __m128i;
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  return _mm256_cvttpd_epi32(a);
}
FCL_ARTIC_INLINE Integers regPlus(Integers a, int b) {
  return _mm_add_epi32(a, _mm_set1_epi32(b));
}
FCL_ARTIC_INLINE Register regBits(Integers a, int bits) {
  return _mm256_cvtepi32_pd(_mm_and_si128(a, _mm_set1_epi32(bits)));
}
#else
using Register = __m128d;
FCL_ARTIC_INLINE Register regSet(double x) {
  return _mm_set1_pd(x);
}
FCL_ARTIC_INLINE Register regMin(Register a, Register b) {
  return _mm_min_pd(a, b);
}
FCL_ARTIC_INLINE Register regMax(Register a, Register b) {
  return _mm_max_pd(a, b);
}
FCL_ARTIC_INLINE Register regAbs(Register a) {
  return _mm_andnot_pd(_mm_set1_pd(-0.0), a);
}
FCL_ARTIC_INLINE Register regSqrt(Register a) {
  return _mm_sqrt_pd(a);
}
FCL_ARTIC_INLINE Register regMulAdd(Register a, Register b, Register c) {
  return _mm_add_pd(_mm_mul_pd(a, b), c);
}
FCL_ARTIC_INLINE unsigned regGreater(Register a, Register b) {
  return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
}
FCL_ARTIC_INLINE Register regWhereGreater(Register a, Register b, Register x, Register y) {
  const Register which = _mm_cmpgt_pd(a, b);
  return _mm_or_pd(_mm_and_pd(which, x), _mm_andnot_pd(which, y));
}
using Integers = __m128i;
FCL_ARTIC_INLINE Integers regTruncate(Register a) {
  return _mm_cvttpd_epi32(a);
}
FCL_ARTIC_INLINE Integers regPlus(Integers a, int b) {
  return _mm_add_epi32(a, _mm_set1_epi32(b));
}
FCL_ARTIC_INLINE Register regBits(Integers a, int bits) {
  return _mm_cvtepi32_pd(_mm_and_si128(a, _mm_set1_epi32(bits)));
}
#endif
constexpr int kRegisterLanes = sizeof(Register) / sizeof(double);
constexpr int kRegisters = kLanes / kRegisterLanes;

struct alignas(64) Lanes {
  Register r[kRegisters];
  Lanes() = default;
  FCL_ARTIC_INLINE Lanes(double x) {  // NOLINT: a scalar is the same in every lane
    for (Register& q : r) q = regSet(x);
  }
  FCL_ARTIC_INLINE double operator[](int i) const { return reinterpret_cast<const double*>(r)[i]; }
  FCL_ARTIC_INLINE void set(int i, double x) { reinterpret_cast<double*>(r)[i] = x; }
};

#define FCL_ARTIC_EACH(expression)                          \
  Lanes o;                                                  \
  for (int i = 0; i < kRegisters; ++i) o.r[i] = expression; \
  return o
FCL_ARTIC_INLINE Lanes operator+(Lanes a, Lanes b) {
  FCL_ARTIC_EACH(a.r[i] + b.r[i]);
}
FCL_ARTIC_INLINE Lanes operator-(Lanes a, Lanes b) {
  FCL_ARTIC_EACH(a.r[i] - b.r[i]);
}
FCL_ARTIC_INLINE Lanes operator-(Lanes a) {
  FCL_ARTIC_EACH(-a.r[i]);
}
FCL_ARTIC_INLINE Lanes operator*(Lanes a, Lanes b) {
  FCL_ARTIC_EACH(a.r[i] * b.r[i]);
}
FCL_ARTIC_INLINE Lanes operator/(Lanes a, Lanes b) {
  FCL_ARTIC_EACH(a.r[i] / b.r[i]);
}
FCL_ARTIC_INLINE Lanes min(Lanes a, Lanes b) {
  FCL_ARTIC_EACH(regMin(a.r[i], b.r[i]));
}
FCL_ARTIC_INLINE Lanes max(Lanes a, Lanes b) {
  FCL_ARTIC_EACH(regMax(a.r[i], b.r[i]));
}
FCL_ARTIC_INLINE Lanes abs(Lanes a) {
  FCL_ARTIC_EACH(regAbs(a.r[i]));
}
FCL_ARTIC_INLINE Lanes sqrt(Lanes a) {
  FCL_ARTIC_EACH(regSqrt(a.r[i]));
}
/// a b + c
FCL_ARTIC_INLINE Lanes mulAdd(Lanes a, Lanes b, Lanes c) {
  FCL_ARTIC_EACH(regMulAdd(a.r[i], b.r[i], c.r[i]));
}
#undef FCL_ARTIC_EACH
/// Lanes with a > b; a lane with NaN is not among them.
FCL_ARTIC_INLINE unsigned greater(Lanes a, Lanes b) {
  unsigned mask = 0;
  for (int i = 0; i < kRegisters; ++i) mask |= regGreater(a.r[i], b.r[i]) << (i * kRegisterLanes);
  return mask;
}
/// Eight floats: ends of boxes, rounded outward, that only get compared. A comparison sets all bits of the lanes where
/// it holds (never with NaN); lanesOf() makes a mask of them.
struct alignas(32) FloatLanes {
#if FCL_ARTIC_ISA_BITS == 128
  __m128 r[2];
#else
  __m256 r;
#endif
};
#if FCL_ARTIC_ISA_BITS == 128
FCL_ARTIC_INLINE FloatLanes narrow(Lanes a) {
  FloatLanes o;
  for (int i = 0; i < 2; ++i) o.r[i] = _mm_movelh_ps(_mm_cvtpd_ps(a.r[2 * i]), _mm_cvtpd_ps(a.r[2 * i + 1]));
  return o;
}
FCL_ARTIC_INLINE FloatLanes spread(float x) {
  return {{_mm_set1_ps(x), _mm_set1_ps(x)}};
}
FCL_ARTIC_INLINE FloatLanes greater(const FloatLanes& a, const FloatLanes& b) {
  return {{_mm_cmpgt_ps(a.r[0], b.r[0]), _mm_cmpgt_ps(a.r[1], b.r[1])}};
}
FCL_ARTIC_INLINE FloatLanes operator|(const FloatLanes& a, const FloatLanes& b) {
  return {{_mm_or_ps(a.r[0], b.r[0]), _mm_or_ps(a.r[1], b.r[1])}};
}
FCL_ARTIC_INLINE unsigned lanesOf(const FloatLanes& a) {
  return static_cast<unsigned>(_mm_movemask_ps(a.r[0]) | _mm_movemask_ps(a.r[1]) << 4);
}
#else
FCL_ARTIC_INLINE FloatLanes narrow(Lanes a) {
#if FCL_ARTIC_ISA_BITS == 512
  return {_mm512_cvtpd_ps(a.r[0])};
#else
  return {_mm256_set_m128(_mm256_cvtpd_ps(a.r[1]), _mm256_cvtpd_ps(a.r[0]))};
#endif
}
FCL_ARTIC_INLINE FloatLanes spread(float x) {
  return {_mm256_set1_ps(x)};
}
FCL_ARTIC_INLINE FloatLanes greater(const FloatLanes& a, const FloatLanes& b) {
  return {_mm256_cmp_ps(a.r, b.r, _CMP_GT_OQ)};
}
FCL_ARTIC_INLINE FloatLanes operator|(const FloatLanes& a, const FloatLanes& b) {
  return {_mm256_or_ps(a.r, b.r)};
}
FCL_ARTIC_INLINE unsigned lanesOf(const FloatLanes& a) {
  return static_cast<unsigned>(_mm256_movemask_ps(a.r));
}
#endif
/// Conversion to float errs by at most 2^-23 of the value in any rounding mode; twice that, and a normal number for
/// values that would vanish, make the result a bound.
FCL_ARTIC_INLINE FloatLanes narrowDown(Lanes a) {
  return narrow(a - mulAdd(abs(a), 0x1p-22, 1e-37));
}
FCL_ARTIC_INLINE FloatLanes narrowUp(Lanes a) {
  return narrow(a + mulAdd(abs(a), 0x1p-22, 1e-37));
}

/// Where a > b lanes of x, else of y.
FCL_ARTIC_INLINE Lanes whereGreater(Lanes a, Lanes b, Lanes x, Lanes y) {
  Lanes o;
  for (int i = 0; i < kRegisters; ++i) o.r[i] = regWhereGreater(a.r[i], b.r[i], x.r[i], y.r[i]);
  return o;
}

/// Values whose lowest bits are replaced by their number, `first` + lane: the largest one then tells which it is. They
/// change by less than 2^-42 of themselves.
constexpr int kNumbered = 1024;  ///< numbers lie below
FCL_ARTIC_INLINE Lanes numbered(Lanes a, int first) {
  typedef long long Bits __attribute__((vector_size(sizeof(Register))));
  Lanes o;
  for (int i = 0; i < kRegisters; ++i) {
    Bits number;
    for (int k = 0; k < kRegisterLanes; ++k) number[k] = i * kRegisterLanes + k;
    o.r[i] = reinterpret_cast<Register>((reinterpret_cast<Bits>(a.r[i]) & ~static_cast<long long>(kNumbered - 1)) |
                                        (number + static_cast<long long>(first)));
  }
  return o;
}
FCL_ARTIC_INLINE int numberOf(double a) {
  long long bits;
  __builtin_memcpy(&bits, &a, sizeof bits);
  return static_cast<int>(bits & (kNumbered - 1));
}

FCL_ARTIC_INLINE double maxLane(Lanes a) {
#if FCL_ARTIC_ISA_BITS == 128
  const Register m = regMax(regMax(a.r[0], a.r[1]), regMax(a.r[2], a.r[3]));
#else
#if FCL_ARTIC_ISA_BITS == 512
  const __m256d half = _mm256_max_pd(_mm512_castpd512_pd256(a.r[0]), _mm512_extractf64x4_pd(a.r[0], 1));
#else
  const __m256d half = regMax(a.r[0], a.r[1]);
#endif
  const __m128d m = _mm_max_pd(_mm256_castpd256_pd128(half), _mm256_extractf128_pd(half, 1));
#endif
  return m[0] > m[1] ? m[0] : m[1];
}
FCL_ARTIC_INLINE double minLane(Lanes a) {
  return -maxLane(-a);
}

/// Sine and cosine for |x| <= kMaxAngle, error at most 4 * 2^-52 in any rounding mode (doc/NUMERICS.md, "Sine and
/// cosine"; measured against MPFR in test/numerics).
/// Cody and Waite's reduction by pi/2 in three parts of at most 33 bits (exact products for |k| < 2^20), then the
/// minimax polynomials that fdlibm publishes for [-pi/4, pi/4]. The quotient is rounded by truncation, which does not
/// depend on the rounding mode.
constexpr double kMaxAngle = 1e6;
FCL_ARTIC_INLINE void sineCosine(Lanes x, Lanes& sine, Lanes& cosine) {
  Lanes k, o, ss, sc;
  for (int i = 0; i < kRegisters; ++i) {
    const Register t = x.r[i] * regSet(0.63661977236758134308);
    const Register half = regMax(regMin(t * regSet(1e300), regSet(0.5)), regSet(-0.5));  // with t's sign
    const Integers n = regTruncate(t + half);
    k.r[i] = regBits(n, -1);
    o.r[i] = regBits(n, 1);
    ss.r[i] = regSet(1.0) - regBits(n, 2);
    sc.r[i] = regSet(1.0) - regBits(regPlus(n, 1), 2);
  }
  const Lanes r = ((x - k * Lanes(1.57079632673412561417e+00)) - k * Lanes(6.07710050630396597660e-11)) -
                  k * Lanes(2.02226624879595063154e-21);
  const Lanes z = r * r;
  Lanes p = mulAdd(z, 1.58969099521155010221e-10, -2.50507602534068634195e-08);
  p = mulAdd(z, p, 2.75573137070700676789e-06);
  p = mulAdd(z, p, -1.98412698298579493134e-04);
  p = mulAdd(z, p, 8.33333333332248946124e-03);
  p = mulAdd(z, p, -1.66666666666666324348e-01);
  const Lanes s = mulAdd(r * z, p, r);
  Lanes q = mulAdd(z, -1.13596475577881948265e-11, 2.08757232129817482790e-09);
  q = mulAdd(z, q, -2.75573143513906633035e-07);
  q = mulAdd(z, q, 2.48015872894767294178e-05);
  q = mulAdd(z, q, -1.38888888888741095749e-03);
  q = mulAdd(z, q, 4.16666666666666019037e-02);
  const Lanes c = mulAdd(z * z, q, Lanes(1.0) - Lanes(0.5) * z);
  const Lanes e = Lanes(1.0) - o;  // 0 or 1, so that the sums below pick one addend exactly
  sine = ss * (e * s + o * c);
  cosine = sc * (e * c + o * s);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
