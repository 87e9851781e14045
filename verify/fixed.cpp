// SPDX-License-Identifier: BSD-3-Clause
#include "fixed.h"

#include <gmp.h>
#include <mpfr.h>

namespace verify {
namespace {

struct Real {  // an MPFR number that frees itself
  explicit Real(mpfr_prec_t bits) { mpfr_init2(x, bits); }
  ~Real() { mpfr_clear(x); }
  Real(const Real&) = delete;
  Real& operator=(const Real&) = delete;
  mpfr_t x;
};

struct Integer {
  Integer() { mpz_init(x); }
  ~Integer() { mpz_clear(x); }
  Integer(const Integer&) = delete;
  Integer& operator=(const Integer&) = delete;
  mpz_t x;
};

void set(Integer& z, Uint value) {
  const std::uint64_t words[2] = {static_cast<std::uint64_t>(value), static_cast<std::uint64_t>(value >> 64)};
  mpz_import(z.x, 2, -1, sizeof words[0], 0, 0, words);
}

Int get(const Integer& z) {
  if (mpz_sizeinbase(z.x, 2) > 105) throw OutOfRange("a number is beyond the verifier's range of 2^40");
  std::uint64_t words[2] = {0, 0};
  mpz_export(words, nullptr, -1, sizeof words[0], 0, 0, z.x);
  const Int magnitude = static_cast<Int>((static_cast<Uint>(words[1]) << 64) | words[0]);
  return mpz_sgn(z.x) < 0 ? -magnitude : magnitude;
}

/// floor(2^64 x)
Fix floorOf(Real& x) {
  Integer z;
  mpfr_mul_2si(x.x, x.x, 64, MPFR_RNDD);  // a power of two: exact
  mpfr_get_z(z.x, x.x, MPFR_RNDD);
  return checked(get(z));
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

// (r - 1)^2 <= 2^64 v < r^2 with r = isqrt(2^64 v) + 1, so r 2^-64 is above the root and at most 1 ulp above it.
Fix sqrtUp(Fix a) {
  Integer z;
  set(z, static_cast<Uint>(a.v < 0 ? 0 : a.v));
  mpz_mul_2exp(z.x, z.x, 64);
  mpz_sqrt(z.x, z.x);
  return checked(get(z) + 1);
}

// The angle has at most 105 bits, so 128 hold it. MPFR rounds the exact sine to 80 bits downwards: off by less than
// 2^-79; the floor takes less than one ulp more.
void sineCosine(Fix angle, Fix& sine, Fix& cosine) {
  Real x(128), low(64), s(80), c(80);
  mpfr_set_si(x.x, static_cast<long>(angle.v >> 64), MPFR_RNDN);
  mpfr_set_ui_2exp(low.x, static_cast<std::uint64_t>(angle.v), -64, MPFR_RNDN);
  mpfr_add(x.x, x.x, low.x, MPFR_RNDN);
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
