// SPDX-License-Identifier: BSD-3-Clause
// The verifier's numbers against exact rationals and MPFR at 300 bits.
#include <gmp.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "big.h"

namespace verify::test {
namespace arithmetic_test {

struct Rational {
  Rational() { mpq_init(q); }
  ~Rational() { mpq_clear(q); }
  Rational(const Rational&) = delete;
  void set(Fix x) {
    mpz_set_si(mpq_numref(q), static_cast<long>(x.v >> 64));
    mpz_mul_2exp(mpq_numref(q), mpq_numref(q), 64);
    mpz_add_ui(mpq_numref(q), mpq_numref(q), static_cast<std::uint64_t>(x.v));
    mpz_set_ui(mpq_denref(q), 1);
    mpz_mul_2exp(mpq_denref(q), mpq_denref(q), 64);
    mpq_canonicalize(q);
  }
  mpq_t q;
};

using Rng = std::mt19937_64;

/// Any number of the range's kinds: large, small, whole, near powers of two.
Fix anyFix(Rng& rng, int most_bits = 83) {
  const int bits = 1 + static_cast<int>(rng() % static_cast<unsigned>(most_bits));
  const Uint raw = (static_cast<Uint>(rng()) << 64 | rng()) >> (128 - bits);
  Int v = static_cast<Int>(raw);
  if (rng() % 4 == 0) v = (static_cast<Int>(1) << bits) - static_cast<Int>(rng() % 3);
  return Fix{rng() % 2 ? v : -v};
}
double uniform(Rng& rng, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(rng);
}

TEST(VerifyFixed, ProductIsRoundedDownByLessThanOneUlp) {
  Rng rng(1);
  Rational a, b, p, r, d;
  Rational one_ulp;
  one_ulp.set(Fix{1});
  for (int n = 0; n < 200000; ++n) {
    const Fix x = anyFix(rng), y = anyFix(rng), z = x * y;
    a.set(x), b.set(y), r.set(z);
    mpq_mul(p.q, a.q, b.q);
    mpq_sub(d.q, p.q, r.q);
    ASSERT_GE(mpq_sgn(d.q), 0);
    ASSERT_LT(mpq_cmp(d.q, one_ulp.q), 0);
  }
}

TEST(VerifyFixed, WhatLeavesTheRangeIsRefused) {
  const Fix large = integer(std::int64_t{1} << 40);
  EXPECT_THROW(large + large, NotProven);
  EXPECT_THROW(-large - ulp(), NotProven);
  EXPECT_THROW(large * integer(2), NotProven);
  EXPECT_THROW(large * large, NotProven);
  EXPECT_THROW(large * -large, NotProven);
  EXPECT_TRUE((large * integer(1)).v == large.v);
  EXPECT_THROW(integer(std::int64_t{1} << 41), NotProven);
  EXPECT_THROW(enclose(1e13), BadInput);
  EXPECT_THROW(enclose(std::nan("")), BadInput);
  Rng rng(2);
  int refused = 0, taken = 0;
  for (int n = 0; n < 200000; ++n) {  // never wraps: what is returned is right
    const Fix x = anyFix(rng, 104), y = anyFix(rng, 104);
    try {
      const Fix z = x * y;
      const Big exact = Big(x) * Big(y);
      ASSERT_TRUE((exact - Big(z)).abs() <= Big(ulp()));
      ++taken;
    } catch (const NotProven&) {
      ASSERT_TRUE(Big(1099511627775.0) <= (Big(x) * Big(y)).abs());
      ++refused;
    }
  }
  EXPECT_GT(refused, 10000);
  EXPECT_GT(taken, 10000);
}

TEST(VerifyFixed, DoublesAreEnclosed) {
  Rng rng(3);
  const auto check = [](double x) {
    const Enclosed e = enclose(x);
    ASSERT_TRUE((Big(x) - Big(e.x)).abs() <= Big(e.error)) << x;
    ASSERT_LE(static_cast<long>(e.error.v), 1);
  };
  for (int n = 0; n < 300000; ++n) {
    std::uint64_t bits = rng();
    double x;
    std::memcpy(&x, &bits, sizeof x);
    if (n % 2) x = std::ldexp(uniform(rng, -1, 1), static_cast<int>(rng() % 160) - 120);
    if (std::isfinite(x) && std::fabs(x) < 1e12) check(x);
  }
  for (const double x :
       {0.0, -0.0, 5e-324, -5e-324, 1.0, -1.0, std::ldexp(1, -64), std::ldexp(-1, -65), std::ldexp(1.5, -64)})
    check(x);
}

TEST(VerifyFixed, RootsSinesAndUnitVectors) {
  Rng rng(4);
  for (int n = 0; n < 20000; ++n) {
    const Fix a = abs(anyFix(rng, 100)), r = sqrtUp(a);
    ASSERT_TRUE(Big(a) <= Big(r) * Big(r));
    ASSERT_TRUE((Big(r) - Big(a).sqrt()) <= Big(ulps(2)));
    const Fix angle = anyFix(rng, n % 2 ? 104 : 67);
    Fix s, c;
    sineCosine(angle, s, c);
    ASSERT_TRUE((Big(s) - Big(angle).sin()).abs() <= Big(ulps(2)));
    ASSERT_TRUE((Big(c) - Big(angle).cos()).abs() <= Big(ulps(2)));
    const double scale = std::ldexp(1, static_cast<int>(rng() % 600) - 300);
    const double axis[3] = {scale * uniform(rng, -1, 1), n % 3 ? scale * uniform(rng, -1, 1) : 0,
                            scale * uniform(rng, -1, 1)};
    Fix unit[3];
    unitVector(axis, unit);
    const Big x(axis[0]), y(axis[1]), z(axis[2]), length = (x * x + y * y + z * z).sqrt();
    for (int k = 0; k < 3; ++k) ASSERT_TRUE((Big(unit[k]) - Big(axis[k]) / length).abs() <= Big(ulps(2)));
  }
}

/// A model and one function of it: the polynomial plus a part of the remainder.
struct Function {
  Tm m;
  double part;
  Big at(const Big& s) const { return Big(m.c0) + s * (Big(m.c1) + s * Big(m.c2)) + Big(part) * Big(m.r); }
};
Function anyFunction(Rng& rng, double size, bool with_remainder) {
  const auto number = [&](double scale) {
    if (rng() % 4 == 0) return Fix{0};
    return encloseUp(uniform(rng, -scale, scale));
  };
  Function f{{number(size), number(size / 2), number(size / 4), {}}, uniform(rng, -1, 1)};
  if (rng() % 4 == 0) f.m.c1 = f.m.c2 = Fix{0};
  if (with_remainder && rng() % 3 != 0) f.m.r = abs(encloseUp(uniform(rng, 0, size * (rng() % 2 ? 0.1 : 1e-12))));
  if (rng() % 4 == 0) f.part = rng() % 2 ? 1 : -1;
  return f;
}

TEST(VerifyTaylor, SumsProductsQuotientsHoldTheirFunctions) {
  Rng rng(5);
  for (int n = 0; n < 30000; ++n) {
    const double size = std::ldexp(1, static_cast<int>(rng() % 24) - 12);
    const Function a = anyFunction(rng, size, true), b = anyFunction(rng, 1, true);
    const int by = 1 + static_cast<int>(rng() % 200);
    const Tm product = a.m * b.m, sum = a.m + b.m, difference = a.m - b.m, quotient = divided(a.m, by);
    for (const double at : {-1.0, 1.0, 0.0, uniform(rng, -1, 1), uniform(rng, -1, 1)}) {
      const Big s(at);
      ASSERT_TRUE(holds(product, s, a.at(s) * b.at(s))) << n;
      ASSERT_TRUE(holds(sum, s, a.at(s) + b.at(s)));
      ASSERT_TRUE(holds(difference, s, a.at(s) - b.at(s)));
      ASSERT_TRUE(holds(quotient, s, a.at(s) / Big(static_cast<double>(by))));
      ASSERT_TRUE((a.at(s)).abs() <= Big(bound(a.m)));
    }
  }
}

// Without remainders of their own, so that what the product leaves out is all that there is: with a4 = 1, s^4 at 0 is
// off by 1/8 from s^2 - 1/8.
TEST(VerifyTaylor, TheRemainderOfAProductIsNeededAndNotMuchTooLarge) {
  const Tm square{{}, {}, integer(1), {}};
  const Tm product = square * square;
  EXPECT_TRUE(holds(product, Big(0.0), Big(0.0)));
  EXPECT_NEAR(toDouble(product.r), 0.125, 1e-15);
  const Tm line{{}, integer(1), {}, {}};
  EXPECT_NEAR(toDouble((line * square).r), 0.25, 1e-15);
}

TEST(VerifyTaylor, SineAndCosine) {
  Rng rng(6);
  for (int n = 0; n < 3000; ++n) {
    Function angle = anyFunction(rng, n % 2 ? 1.5 : 0.2, n % 3 != 0);
    angle.m.c0 = encloseUp(uniform(rng, -100, 100));
    Tm s, c;
    sineCosine(angle.m, s, c);
    for (const double at : {-1.0, 1.0, 0.0, uniform(rng, -1, 1)}) {
      ASSERT_TRUE(holds(s, Big(at), angle.at(Big(at)).sin()));
      ASSERT_TRUE(holds(c, Big(at), angle.at(Big(at)).cos()));
    }
  }
  // Where nothing but Lagrange's remainder is left: at s = 1/2, T3 = -1, d - d^3/6 is at the end of what it leaves out,
  // and d^5/120 takes the sine beyond; at s = 1/sqrt(2), T4 = -1, so does -d^6/720 with the cosine.
  for (const double d : {1.0, -1.0, 0.5, 0.1}) {
    Tm s, c;
    sineCosine(Tm{{}, encloseUp(d), {}, {}}, s, c);
    for (const double at : {0.5, -0.5, std::sqrt(0.5), -std::sqrt(0.5)}) {
      EXPECT_TRUE(holds(s, Big(at), (Big(encloseUp(d)) * Big(at)).sin())) << d << " " << at;
      EXPECT_TRUE(holds(c, Big(at), (Big(encloseUp(d)) * Big(at)).cos())) << d << " " << at;
    }
  }
  // Third order: an interval half as wide has about a tenth of the remainder, or less.
  Tm s, c, s2, c2;
  sineCosine(Tm{integer(1), encloseUp(0.2), {}, {}}, s, c);
  sineCosine(Tm{integer(1), encloseUp(0.1), {}, {}}, s2, c2);
  EXPECT_LT(toDouble(s2.r), 0.14 * toDouble(s.r));
  EXPECT_LT(toDouble(s.r), 0.004);
}

TEST(VerifyTaylor, RotationVectors) {
  Rng rng(7);
  for (int n = 0; n < 500; ++n) {
    Function w[3];
    Vec v;
    for (std::size_t k = 0; k < 3; ++k) {
      w[k] = anyFunction(rng, n % 4 == 0 ? 4 : n % 4 == 1 ? 0.5 : n % 4 == 2 ? 1e-6 : 100, n % 2 == 0);
      v[k] = w[k].m;
    }
    const Mat R = rotation(v);
    for (const double at : {-1.0, 1.0, 0.0, uniform(rng, -1, 1)}) {
      const Big s(at);
      const BigVec x{w[0].at(s), w[1].at(s), w[2].at(s)};
      const BigPose exact = turned(x, (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt());
      for (std::size_t k = 0; k < 9; ++k) ASSERT_TRUE(holds(R[k], s, exact.R[k])) << n << " " << k;
    }
  }
  // Beyond 10 rad by squares of halves: little is lost.
  for (const int turn : {9, 11, 21, 1000}) {
    const Mat R = rotation(Vec{constant(integer(turn)), Tm{}, Tm{}});
    EXPECT_LT(toDouble(bound(R[4] - constant(encloseUp(std::cos(turn))))), 1e-12) << turn;
  }
  const Vec far{constant(integer(2000000)), Tm{}, Tm{}};
  EXPECT_THROW(rotation(far), NotProven);
}

}  // namespace arithmetic_test
}  // namespace verify::test
