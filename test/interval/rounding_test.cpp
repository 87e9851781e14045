// SPDX-License-Identifier: BSD-3-Clause
//
// Faults that compilers are known to have in directed rounding, tried on the library's own types.
#include <cfenv>
#include <cstdint>

#include <gtest/gtest.h>

#include "../numerics/control_bits.h"
#include "interval/matrix.h"
#include "interval/sine_cosine.h"

namespace fcl_artic {
namespace rounding_test {
namespace {

constexpr int kModes[4] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

double opaque(double x) {
  asm volatile("" : "+m"(x));
  return x;
}

TEST(Rounding, ModesWorkHere) {
  EXPECT_TRUE(roundingModesWork());
}

TEST(Rounding, ScopePutsTheCallersModeBack) {
  using numerics_test::controlBits, numerics_test::setControlBits;
  const std::uint64_t before = controlBits();
  const auto roundsUpward = [] {
    const Interval sum = Interval(opaque(1)) + Interval(opaque(0x1p-60));
    return sum.lower() == 1 && sum.upper() > 1;
  };
  for (const int mode : kModes) {
    for (const std::uint64_t flush : {std::uint64_t{0}, numerics_test::kFlushing}) {
      std::fesetround(mode);
      setControlBits(controlBits() | flush);
      const std::uint64_t mine = controlBits();
      EXPECT_EQ(roundsUpward(), mode == FE_UPWARD);
      {
        const RoundUpward outer;
        EXPECT_TRUE(roundsUpward());
        {
          const RoundUpward inner;
          EXPECT_TRUE(roundsUpward());
        }
        EXPECT_TRUE(roundsUpward());
        EXPECT_GT((Interval(0x1p-1074) + Interval(0.0)).upper(), 0);  // no flushing
      }
      EXPECT_EQ(controlBits(), mine);
      std::fesetround(FE_TONEAREST);  // of x86's old floating-point unit, too
      setControlBits(before);
    }
  }
}

TEST(Hazard, ConstantsAreNotFolded) {
  const RoundUpward scope;
  const Interval third = Interval(1.0) / Interval(3.0);
  EXPECT_LT(third.lower(), third.upper());
  const Interval product = Interval(0.1) * Interval(0.7);
  EXPECT_LT(product.lower(), product.upper());
  const Interval sum = Interval(0.1) + Interval(0x1p-60);
  EXPECT_LT(sum.lower(), sum.upper());
}

TEST(Hazard, NegationsAreNotCancelled) {
  const RoundUpward scope;
  const Interval a(opaque(0.1)), b(opaque(0.7));
  EXPECT_LT((-((-a) * b)).lower(), (a * b).upper());
  EXPECT_LT((-(-a - b)).lower(), (a + b).upper());
  const double large = opaque(0x1p53), one = opaque(1);
  EXPECT_EQ(((Interval(one) + Interval(large)) - Interval(large)).upper(), 2);  // (a + b) - b isn't simplified
}

__attribute__((noinline)) Interval twiceOverChange(double a, double b, Interval& inside) {
  const Interval outside = Interval(a) * Interval(b);  // to nearest
  const RoundUpward scope;
  inside = Interval(a) * Interval(b);
  return outside;
}
TEST(Hazard, OperationsAreNotSharedAcrossAChange) {
  int differ = 0, wide = 0;
  for (int i = 1; i < 100; ++i) {
    Interval inside;
    const Interval outside = twiceOverChange(opaque(i / 7.0), opaque(0.7), inside);
    EXPECT_TRUE(inside.contains(outside));
    EXPECT_LE(outside.width(), 0);
    differ += inside.upper() != outside.upper();
    wide += inside.lower() < inside.upper();
  }
  EXPECT_GT(differ, 20);
  EXPECT_GT(wide, 90);
}

__attribute__((noinline)) double divisionIn(double a, double b) {
  const RoundUpward scope;
  return (Interval(a) / Interval(b)).upper();  // must not sink behind the end of the scope
}
TEST(Hazard, OperationsStayInTheirScope) {
  EXPECT_GT(divisionIn(opaque(1), opaque(3)), opaque(1) / opaque(3));
}

__attribute__((noinline)) int alternate(double a, double b) {
  int wider = 0;
  for (int i = 0; i < 4; ++i) {  // the quotient doesn't change, the mode does
    if (i & 1) {
      const RoundUpward scope;
      wider += (Interval(a) / Interval(b)).width() > 0;
    } else {
      const Interval q = Interval(a) / Interval(b);
      wider -= q.upper() > q.lower();
    }
  }
  return wider;
}
TEST(Hazard, OperationsAreNotHoistedOutOfALoop) {
  EXPECT_EQ(alternate(opaque(1), opaque(3)), 2);
}

TEST(Hazard, ProductsAreNotFused) {
  const RoundUpward scope;
  const Interval a(opaque(0.1)), b(opaque(0.7));
  const Pair p = directed::mul(a.raw(), b.raw()), q = directed::mul(a.raw(), b.raw());
  const Pair zero = directed::add(p, pairNegate(q));
  EXPECT_EQ(pairLow(zero), 0);
  EXPECT_EQ(pairHigh(zero), 0);
}

}  // namespace
}  // namespace rounding_test
}  // namespace fcl_artic
