// SPDX-License-Identifier: BSD-3-Clause
#include "fixed.h"

#include <mpfr.h>

namespace verify {
namespace {

static_assert(sizeof(long) >= 8, "MPFR takes and gives the high words of numbers as long");

struct Real {  // an MPFR number that frees itself
  explicit Real(mpfr_prec_t bits) { mpfr_init2(x, bits); }
  explicit Real(Fix a) : Real(128) {  // which has at most 105 bits: exact
    Real low(64);
    mpfr_set_si(x, static_cast<long>(a.v >> 64), MPFR_RNDN);
    mpfr_set_ui_2exp(low.x, static_cast<std::uint64_t>(a.v), -64, MPFR_RNDN);
    mpfr_add(x, x, low.x, MPFR_RNDN);
  }
  ~Real() { mpfr_clear(x); }
  Real(const Real&) = delete;
  Real& operator=(const Real&) = delete;
  mpfr_t x;
};

/// The number of ulps in x, rounded down, for |x| <= 2^40 of 64 bits or more. The part of x above its integer part is
/// in [0, 1), and multiples of 2^-64 there have 64 bits. So rounding it down to x's precision leaves it at or above the
/// same multiples.
Fix floorOf(Real& x) {
  const long whole = mpfr_get_si(x.x, MPFR_RNDD);
  mpfr_sub_si(x.x, x.x, whole, MPFR_RNDD);
  mpfr_mul_2si(x.x, x.x, 64, MPFR_RNDD);  // a power of two: exact
  return checked(whole * kOne + static_cast<Int>(mpfr_get_ui(x.x, MPFR_RNDD)));
}

}  // namespace

// value = m 2^e with an integer m of 53 bits, exactly. 2^64 value = m 2^(e + 64) is an integer, or is rounded down.
Enclosed enclose(double value) {
  if (!std::isfinite(value) || std::fabs(value) > 1099511627776.0)
    throw BadInput("a number is not finite or beyond the verifier's range of 2^40");
  int exponent = 0;
  const Int m = static_cast<Int>(std::ldexp(std::frexp(value, &exponent), 53));
  const int shift = exponent - 53 + 64;
  if (shift >= 0) return {checked(m * (static_cast<Int>(1) << shift)), Fix{0}};
  if (shift <= -120) return {Fix{m < 0 ? -1 : 0}, ulps(m != 0)};
  const Int down = m >> -shift;
  return {Fix{down}, ulps(down * (static_cast<Int>(1) << std::min(-shift, 64)) != m)};
}
Fix encloseUp(double value) {
  const Enclosed e = enclose(value);
  return e.x + e.error;
}
Fix encloseDown(double value) {
  const Enclosed e = enclose(value);
  return e.x - e.error;
}

// Rounded up; the floor takes less than the ulp that is added.
Fix sqrtUp(Fix a) {
  Real root(std::max(a, Fix{0}));
  mpfr_sqrt(root.x, root.x, MPFR_RNDU);
  return floorOf(root) + ulps(1);
}

// MPFR rounds the exact sine to 80 bits downwards: off by less than 2^-79; the floor takes less than one ulp more.
void sineCosine(Fix angle, Fix& sine, Fix& cosine) {
  const Real x(angle);
  Real s(80), c(80);
  mpfr_sin_cos(s.x, c.x, x.x, MPFR_RNDD);
  sine = floorOf(s);
  cosine = floorOf(c);
}

// At 200 bits five roundings of relative size 2^-200; the floor takes less than one ulp.
void unitVector(const double axis[3], Fix unit[3]) {
  Real sum(200), square(200), entry(200);
  mpfr_set_zero(sum.x, 1);
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(axis[k])) throw BadInput("an axis is not finite");
    mpfr_set_d(square.x, axis[k], MPFR_RNDN);
    mpfr_sqr(square.x, square.x, MPFR_RNDN);
    mpfr_add(sum.x, sum.x, square.x, MPFR_RNDN);
  }
  if (mpfr_zero_p(sum.x)) throw BadInput("an axis is the zero vector");
  mpfr_sqrt(sum.x, sum.x, MPFR_RNDN);
  for (int k = 0; k < 3; ++k) {
    mpfr_set_d(entry.x, axis[k], MPFR_RNDN);
    mpfr_div(entry.x, entry.x, sum.x, MPFR_RNDN);
    unit[k] = floorOf(entry);
  }
}

}  // namespace verify
