// SPDX-License-Identifier: BSD-3-Clause
//
// Eight doubles that go through together: eight time intervals, one per lane. Compiled once per instruction set: the
// including file defines FCL_ARTIC_ISA (the namespace) and FCL_ARTIC_ISA_BITS (512, 256, 128; 0: none) first. Neither
// this nor files built on it may instantiate inline code of other libraries: the linker could pick that copy for a
// processor that lacks the instructions. Every bound that uses lanes carries its rounding in a pad (doc/NUMERICS.md,
// "Pads") which holds in any rounding mode, with or without FMA, so mulAdd() may round once or twice.
//
// All that depends on the processor is in numerics/register_*.h, one file for each instruction set. For another
// processor, such a file defines what follows; test/numerics/registers_test.cpp compares it with this list. All work
// lane by lane, round in the mode that is set at that time, and keep subnormals. Arithmetic may give any NaN.
//
//   Register             2, 4 or 8 doubles, a vector type of the compiler's: its + - * / are IEEE 754's, and -a changes
//                        nothing but the sign bit
//   regSet(x)            x in every lane
//   regMin(a, b)         a < b ? a : b; so it is b where either is NaN, and where both are zero
//   regMax(a, b)         a > b ? a : b; likewise
//   regAbs(a)            a without its sign bit, NaN's too
//   regSqrt(a)           IEEE 754's: rounded correctly, -0 of -0, NaN below
//   regMulAdd(a, b, c)   a b + c, rounded once, or twice as a * b + c is
//   regGreater(a, b)     an unsigned whose bit i is set where a > b in lane i; not where either is NaN
//   regWhereGreater(a, b, x, y)   a > b ? x : y, with all bits of x or y
//   regMaxLane(a)        the largest lane as a double; a zero of either sign; any lane if one is NaN
//
//   Integers             as many 32-bit integers
//   regTruncate(a)       a toward zero; -2^31 for NaN and where the result has more than 32 bits
//   regPlus(n, int k)    n + k, modulo 2^32
//   regBits(n, int bits) the Register of the signed integers n & bits
//
//   Floats               4 or 8 floats, that only get compared: as 0 or 1 all bits of a lane are clear or set
//   regNarrow(const Register* a)   the doubles of as many registers as fill one Floats, a[0] first, each rounded
//   regSpread(float x)   x in every lane
//   regAbove(a, b)       1 where a > b, 0 elsewhere and with NaN
//   regOr(a, b)          bitwise
//   regSigns(a)          an unsigned whose bit i is the sign bit of lane i
#pragma once

#if FCL_ARTIC_ISA_BITS == 512
#include "numerics/register_avx512.h"
#elif FCL_ARTIC_ISA_BITS == 256
#include "numerics/register_avx2.h"
#elif FCL_ARTIC_ISA_BITS == 128 && defined(__aarch64__)
#include "numerics/register_neon.h"
#elif FCL_ARTIC_ISA_BITS == 128
#include "numerics/register_sse2.h"
#elif defined(FCL_ARTIC_ISA_BITS) && FCL_ARTIC_ISA_BITS == 0
#include "numerics/register_portable.h"
#else
#error "FCL_ARTIC_ISA_BITS: 512, 256, 128 or 0"
#endif

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

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
constexpr int kFloatLanes = sizeof(Floats) / sizeof(float);
struct alignas(32) FloatLanes {
  Floats r[kLanes / kFloatLanes];
};
#define FCL_ARTIC_EACH(expression)                                    \
  FloatLanes o;                                                       \
  for (int i = 0; i < kLanes / kFloatLanes; ++i) o.r[i] = expression; \
  return o
FCL_ARTIC_INLINE FloatLanes narrow(Lanes a) {
  FCL_ARTIC_EACH(regNarrow(a.r + i * (kFloatLanes / kRegisterLanes)));
}
FCL_ARTIC_INLINE FloatLanes spread(float x) {
  FCL_ARTIC_EACH(regSpread(x));
}
FCL_ARTIC_INLINE FloatLanes greater(const FloatLanes& a, const FloatLanes& b) {
  FCL_ARTIC_EACH(regAbove(a.r[i], b.r[i]));
}
FCL_ARTIC_INLINE FloatLanes operator|(const FloatLanes& a, const FloatLanes& b) {
  FCL_ARTIC_EACH(regOr(a.r[i], b.r[i]));
}
#undef FCL_ARTIC_EACH
FCL_ARTIC_INLINE unsigned lanesOf(const FloatLanes& a) {
  unsigned mask = 0;
  for (int i = 0; i < kLanes / kFloatLanes; ++i) mask |= regSigns(a.r[i]) << (i * kFloatLanes);
  return mask;
}
/// The ends of the box that holds eight: `boxes` has their lower ends along three axes, then the upper ones. (Lane by
/// lane, through memory, an arm's free motion took 5 % longer.)
/// @param ends  of boxes[i] the least lane, from i = 3 on the largest.
FCL_ARTIC_INLINE void outerLanes(const FloatLanes* boxes, float* ends) {
  typedef float Eight __attribute__((vector_size(sizeof(FloatLanes))));
  Eight one[6], two[3], four[2];
  for (int i = 0; i < 6; ++i) {
    __builtin_memcpy(&one[i], &boxes[i], sizeof(Eight));
    if (i >= 3) one[i] = -one[i];
  }
  // Half as many of each every time: a0 b0 a1 b1 a4 b4 a5 b5, then a b c d twice, then all.
  for (int i = 0; i < 3; ++i) {
    const Eight p = one[2 * i], q = one[2 * i + 1];
    const Eight x = __builtin_shufflevector(p, q, 0, 8, 1, 9, 4, 12, 5, 13);
    const Eight y = __builtin_shufflevector(p, q, 2, 10, 3, 11, 6, 14, 7, 15);
    two[i] = x < y ? x : y;
  }
  for (int i = 0; i < 2; ++i) {
    const Eight p = two[2 * i], q = two[i + 1];  // the last pair stands for the one that is missing
    const Eight x = __builtin_shufflevector(p, q, 0, 1, 8, 9, 4, 5, 12, 13);
    const Eight y = __builtin_shufflevector(p, q, 2, 3, 10, 11, 6, 7, 14, 15);
    four[i] = x < y ? x : y;
  }
  const Eight x = __builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 8, 9, 10, 11);
  const Eight y = __builtin_shufflevector(four[0], four[1], 4, 5, 6, 7, 12, 13, 14, 15);
  const Eight all = x < y ? x : y;
  for (int i = 0; i < 6; ++i) ends[i] = i < 3 ? all[i] : -all[i];
}
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

/// Values whose lowest bits are replaced by their number, `first` + lane: the largest one then carries its own number.
/// They change by less than 2^-42 of themselves.
constexpr int kNumbered = 1024;  ///< numbers lie below
FCL_ARTIC_INLINE Lanes numbered(Lanes a, int first) {
  typedef long long Bits __attribute__((vector_size(sizeof(Register))));
  Lanes o;
  for (int i = 0; i < kRegisters; ++i) {
    Bits number = {};
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
  for (int n = kRegisters / 2; n > 0; n /= 2) {
    for (int i = 0; i < n; ++i) a.r[i] = regMax(a.r[2 * i], a.r[2 * i + 1]);
  }
  return regMaxLane(a.r[0]);
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
