// SPDX-License-Identifier: BSD-3-Clause
//
// Every operation against MPFR: on every instruction set, in every rounding mode of the caller, for every kind of
// operand.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include <gtest/gtest.h>
#include <mpfr.h>

#include "arithmetic.h"
#include "interval/sine_cosine.h"
#include "numerics/instruction_sets.h"
#include "operands.h"
#include "redon/box_batch.h"

namespace fcl_artic {
namespace numerics_test {
namespace operations_test {

std::vector<const Arithmetic*> arithmetics() {
  std::vector<const Arithmetic*> all;
#define FCL_ARTIC_ONE(set, Set) &kArithmetic##Set,
  for (const Arithmetic* s : {FCL_ARTIC_INSTRUCTION_SETS(FCL_ARTIC_ONE)}) {
    if (redon::boxBatchNamed(s->name)) all.push_back(s);
  }
#undef FCL_ARTIC_ONE
  return all;
}

namespace {

/// One operation on two doubles, rounded once in the given direction.
class Rounder {
 public:
  Rounder() {
    for (mpfr_t& x : x_) mpfr_init2(x, 53);
  }
  ~Rounder() {
    for (mpfr_t& x : x_) mpfr_clear(x);
  }
  Rounder(const Rounder&) = delete;
  Rounder& operator=(const Rounder&) = delete;

  double operator()(Operation operation, double a, double b, mpfr_rnd_t direction) {
    mpfr_set_d(x_[0], a, MPFR_RNDN);
    mpfr_set_d(x_[1], b, MPFR_RNDN);
    switch (operation) {
      case Operation::add:
        mpfr_add(x_[2], x_[0], x_[1], direction);
        break;
      case Operation::subtract:
        mpfr_sub(x_[2], x_[0], x_[1], direction);
        break;
      case Operation::divide:
        mpfr_div(x_[2], x_[0], x_[1], direction);
        break;
      case Operation::squareRoot:
        mpfr_sqrt(x_[2], x_[0], direction);
        break;
      case Operation::multiply:
      default:
        mpfr_mul(x_[2], x_[0], x_[1], direction);
        break;
    }
    return mpfr_get_d(x_[2], direction);
  }

 private:
  mpfr_t x_[3];
};

/// The narrowest interval that holds the operation's results, for finite operands.
Interval narrowest(Rounder& round, Operation operation, const Interval& a, const Interval& b) {
  const double al = a.lower(), ah = a.upper(), bl = b.lower(), bh = b.upper();
  const auto corners = [&](Operation o, double p, double q, double r, double s) {
    double lower = HUGE_VAL, upper = -HUGE_VAL;
    for (const double x : {p, q}) {
      for (const double y : {r, s}) {
        lower = std::min(lower, round(o, x, y, MPFR_RNDD));
        upper = std::max(upper, round(o, x, y, MPFR_RNDU));
      }
    }
    return Interval(lower, upper);
  };
  const double least = al > 0 ? al : ah < 0 ? -ah : 0, most = std::max(-al, ah);
  switch (operation) {
    case Operation::negate:
      return Interval(-ah, -al);
    case Operation::scale:
      return corners(Operation::multiply, al, ah, bl, bl);
    case Operation::divide:
      return b.containsZero() ? Interval::entire() : corners(operation, al, ah, bl, bh);
    case Operation::square:
      return Interval(round(Operation::multiply, least, least, MPFR_RNDD),
                      round(Operation::multiply, most, most, MPFR_RNDU));
    case Operation::squareRoot:
      return Interval(round(operation, std::max(al, 0.0), 0, MPFR_RNDD),
                      round(operation, std::max(ah, 0.0), 0, MPFR_RNDU));
    case Operation::absolute:
      return Interval(least, most);
    case Operation::maximum:
      return Interval(std::max(al, bl), std::max(ah, bh));
    case Operation::minimum:
      return Interval(std::min(al, bl), std::min(ah, bh));
    default:
      return corners(operation, al, ah, bl, bh);
  }
}

constexpr int kGroup = 64;
/// Pairs of operands of all shapes, b another shape than a now and then.
struct Operands {
  Interval a[kGroup], b[kGroup];
  Operands(Random& random, int round, bool unbounded) {
    const int shapes = unbounded ? kNumShapes : kNumShapes - 1;
    for (int i = 0; i < kGroup; ++i) {
      const Shape shape = unbounded ? Shape::unbounded : kShapes[(round + i) % shapes];
      a[i] = operand(random, shape);
      b[i] = operand(random, random.chance(0.5) ? shape : kShapes[random.below(shapes)]);
    }
  }
};

bool same(const Interval& a, const Interval& b) {
  return a.lower() == b.lower() && a.upper() == b.upper();
}

TEST(Operations, GiveTheNarrowestEnclosure) {
  Random random(seedOf("Operations"));
  Rounder rounder;
  const int rounds = scaled(100000) / kGroup + 1;
  long checks = 0, wider = 0;
  for (int round = 0; round < rounds; ++round) {
    const Operands in(random, round, false);
    for (int o = 0; o < static_cast<int>(std::size(kOperations)); ++o) {
      const Operation operation = kOperations[o];
      Interval expected[kGroup];
      for (int i = 0; i < kGroup; ++i) expected[i] = narrowest(rounder, operation, in.a[i], in.b[i]);
      for (const Arithmetic* arithmetic : arithmetics()) {
        for (const int mode : kRoundingModes) {
          for (const bool lanes : {false, true}) {
            if (lanes && o >= kLaneOperations) continue;
            Interval out[kGroup];
            {
              const ScopedRounding scope(mode);
              (lanes ? arithmetic->applyLanes : arithmetic->apply)(operation, in.a, in.b, kGroup, out);
            }
            for (int i = 0; i < kGroup; ++i) {
              ++checks;
              if (lanes && !arithmetic->directed) {
                wider += !same(out[i], expected[i]);
                ASSERT_TRUE(out[i].contains(expected[i])) << arithmetic->name << " operation " << o << " mode " << mode;
              } else {
                ASSERT_TRUE(same(out[i], expected[i]))
                    << arithmetic->name << " operation " << o << " mode " << mode << " lanes " << lanes << ": ["
                    << in.a[i].lower() << ", " << in.a[i].upper() << "], [" << in.b[i].lower() << ", "
                    << in.b[i].upper() << "] give [" << out[i].lower() << ", " << out[i].upper() << "], not ["
                    << expected[i].lower() << ", " << expected[i].upper() << "]";
              }
            }
          }
        }
      }
    }
  }
  std::printf("%ld results, %d operands per operation, instruction set and mode\n", checks, rounds * kGroup);
  EXPECT_GT(wider, 0);
}

TEST(Operations, HoldTheResultsOfUnboundedOperands) {
  Random random(seedOf("Unbounded"));
  Rounder round;
  const int rounds = scaled(100000) / kGroup + 1;
  long finite = 0, unbounded = 0;
  for (int r = 0; r < rounds; ++r) {
    const Operands in(random, r, true);
    for (int o = 0; o < static_cast<int>(std::size(kOperations)); ++o) {
      const Operation operation = kOperations[o];
      for (const Arithmetic* arithmetic : arithmetics()) {
        const bool lanes = o < kLaneOperations && random.chance(0.5);
        Interval out[kGroup];
        {
          const ScopedRounding scope(kRoundingModes[random.below(4)]);
          (lanes ? arithmetic->applyLanes : arithmetic->apply)(operation, in.a, in.b, kGroup, out);
        }
        for (int i = 0; i < kGroup; ++i) {
          ASSERT_FALSE(out[i].isEmpty()) << arithmetic->name << " operation " << o;
          const double x = member(random, in.a[i]),
                       y = operation == Operation::scale ? in.b[i].lower() : member(random, in.b[i]);
          if (!std::isfinite(y) || (operation == Operation::squareRoot && x < 0) ||
              (operation == Operation::divide && y == 0))
            continue;
          const Interval point = narrowest(round, operation, Interval(x), Interval(y));
          // The exact result lies in `point`, so at least one of its ends is no farther out than the result's.
          ASSERT_TRUE(out[i].lower() <= point.upper() && point.lower() <= out[i].upper())
              << arithmetic->name << " operation " << o << " lanes " << lanes << ": [" << in.a[i].lower() << ", "
              << in.a[i].upper() << "], [" << in.b[i].lower() << ", " << in.b[i].upper() << "] give [" << out[i].lower()
              << ", " << out[i].upper() << "], not " << point.lower();
          ++(out[i].isFinite() ? finite : unbounded);
        }
      }
    }
  }
  std::printf("%ld finite and %ld unbounded results\n", finite, unbounded);
  EXPECT_GT(finite, 1000);
  EXPECT_GT(unbounded, 1000);
}

TEST(Operations, WithoutTheirRoundingModeAreCaught) {
  Random random(seedOf("Mutant"));
  Rounder rounder;
  int broken = 0, checks = 0;
  for (int round = 0; round < 100; ++round) {
    const Operands in(random, round, false);
    for (int i = 0; i < kGroup; ++i) {
      const Interval product = in.a[i] * in.b[i], sum = in.a[i] + in.b[i];  // to nearest
      broken += !product.contains(narrowest(rounder, Operation::multiply, in.a[i], in.b[i]));
      broken += !sum.contains(narrowest(rounder, Operation::add, in.a[i], in.b[i]));
      checks += 2;
    }
  }
  std::printf("%d of %d results rounded to nearest are no enclosures\n", broken, checks);
  EXPECT_GT(broken, checks / 5);
}

TEST(Operations, AnswerQuestions) {
  const RoundUpward upward;
  const Interval a(1, 2), b(-1, 3), c(4, 5), zero(0.0);
  EXPECT_TRUE(a.certainlyPositive());
  EXPECT_FALSE(b.certainlyPositive());
  EXPECT_TRUE((-a).certainlyNegative());
  EXPECT_FALSE(zero.certainlyNegative());
  EXPECT_FALSE(zero.certainlyPositive());
  EXPECT_TRUE(b.containsZero());
  EXPECT_TRUE(zero.containsZero());
  EXPECT_FALSE(a.containsZero());
  EXPECT_TRUE(b.contains(a));
  EXPECT_FALSE(a.contains(b));
  EXPECT_TRUE(a.contains(2.0));
  EXPECT_TRUE(certainlyLess(a, c));
  EXPECT_FALSE(certainlyLess(a, Interval(2, 3)));
  EXPECT_TRUE(certainlyDisjoint(c, a));
  EXPECT_FALSE(certainlyDisjoint(a, b));
  EXPECT_TRUE(intersection(a, c).isEmpty());
  EXPECT_TRUE(same(intersection(a, b), a));
  EXPECT_TRUE(same(hull(a, c), Interval(1, 5)));
  EXPECT_EQ(b.magnitude(), 3);
  EXPECT_EQ(b.mignitude(), 0);
  EXPECT_EQ((-c).mignitude(), 4);
  EXPECT_EQ(c.width(), 1);
  EXPECT_TRUE(b.contains(b.middle()));
  EXPECT_TRUE(same(Interval(std::nan(""), 1), Interval(-HUGE_VAL, 1)));
  EXPECT_TRUE(same(Interval(std::nan("")), Interval::entire()));
  EXPECT_FALSE(Interval(0, HUGE_VAL).isFinite());
}

/// Angles with ends at and next to multiples of pi/2, widths from nothing to some turns, sizes up to beyond the range.
Interval angles(Random& random) {
  const double quarter = 1.5707963267948966;
  const auto near = [&](double k) { return k * quarter * (1 + (random.below(9) - 4) * 0x1p-53); };
  const auto end = [&](double scale) {
    switch (random.below(4)) {
      case 0:
        scale *= sign(random);
        return scale * random.size(1e-300, 1);
      case 1:
        return random.in(-7, 7);
      case 2:
        scale = std::floor(random.in(-scale, scale));
        return near(scale);
      default:
        return random.in(-scale, scale);
    }
  };
  const double from = end(random.chance(0.5) ? 8 : random.size(1, 2e6));
  switch (random.below(5)) {
    case 0:
      return Interval(from);
    case 1:
      return Interval(from, std::nextafter(from, HUGE_VAL));
    case 2:
      return Interval(from, from + random.size(1e-16, 10));
    case 3: {
      const int quarters = random.below(6);
      return Interval(from, from + near(quarters));
    }
    default: {
      const double to = end(8);
      return Interval(std::min(from, to), std::max(from, to));
    }
  }
}

TEST(Operations, SineAndCosineHoldAllValues) {
  Random random(seedOf("Interval sine"));
  const int rounds = scaled(100000) / kGroup + 1;
  long straddling = 0, checks = 0;
  double excess = 0;  // of thin arguments' width over what the allowance makes of it
  for (int round = 0; round < rounds; ++round) {
    Interval x[kGroup];
    Real sine[kGroup], cosine[kGroup];
    for (int i = 0; i < kGroup; ++i) {
      x[i] = angles(random);
      const double at = member(random, x[i]);
      // The extrema between the ends, if any, are what is hardest to hold: one of them instead of a point.
      const double k = std::ceil(x[i].lower() / 1.5707963267948966), peak = k * 1.5707963267948966;
      if (random.chance(0.5) && std::abs(k) < 1e7 && peak > x[i].lower() + 1e-6 && peak < x[i].upper() - 1e-6) {
        const int quadrant = static_cast<int>(static_cast<long>(k) & 3);
        sine[i] = quadrant == 1 ? 1.0 : quadrant == 3 ? -1.0 : 0.0;
        cosine[i] = quadrant == 0 ? 1.0 : quadrant == 2 ? -1.0 : 0.0;
        ++straddling;
      } else {
        sine[i] = sin(Real(at));
        cosine[i] = cos(Real(at));
      }
    }
    for (const Arithmetic* arithmetic : arithmetics()) {
      for (const int mode : kRoundingModes) {
        Interval s[kGroup], c[kGroup];
        {
          const ScopedRounding scope(mode);
          arithmetic->sineCosine(x, kGroup, s, c);
        }
        for (int i = 0; i < kGroup; ++i) {
          ASSERT_TRUE(holds(s[i], sine[i]) && holds(c[i], cosine[i]))
              << arithmetic->name << " mode " << mode << " [" << x[i].lower() << ", " << x[i].upper() << "]";
          ASSERT_LE(s[i].magnitude(), 1);
          ASSERT_LE(c[i].magnitude(), 1);
          if (x[i].magnitude() <= kLargestAngle && x[i].upper() - x[i].lower() < 1e-3) {
            excess = std::max(
                {excess, s[i].width() - (x[i].upper() - x[i].lower()), c[i].width() - (x[i].upper() - x[i].lower())});
          }
          ++checks;
        }
      }
    }
  }
  std::printf("%ld intervals, every %.0fth over an extremum; too wide by %.2g at most\n", checks,
              static_cast<double>(rounds * kGroup) / static_cast<double>(straddling), excess);
  EXPECT_GT(straddling, rounds);
  EXPECT_LE(excess, 3 * kSineError);
}

}  // namespace
}  // namespace operations_test
}  // namespace numerics_test
}  // namespace fcl_artic
