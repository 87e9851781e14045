// SPDX-License-Identifier: BSD-3-Clause
//
// Every register file of this machine, and the portable one, against the list in numerics/lanes.h: function by function
// on the same values, special ones among them, in every rounding mode.
#include "registers.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "cases.h"
#include "numerics/instruction_sets.h"

namespace fcl_artic {
namespace numerics_test {
namespace registers_test {

std::vector<const RegisterFile*> registerFiles() {
  std::vector<const RegisterFile*> all;
#define FCL_ARTIC_ONE(set, Set) &kRegisters##Set,
  for (const RegisterFile* s : {FCL_ARTIC_INSTRUCTION_SETS(FCL_ARTIC_ONE)}) {
    if (processorRuns(s->name)) all.push_back(s);
  }
#undef FCL_ARTIC_ONE
  return all;
}

namespace {

constexpr int kLanes = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const double kSpecial[] = {0,
                           1,
                           0.5,
                           3,
                           0x1p-1074,
                           0x0.8p-1022,
                           0x1p-1022,
                           0x1p-140,
                           0x1p-127,
                           0x1p-126,
                           0x1.fffffep127,
                           0x1.ffffffp127,
                           0x1p128,
                           0x1.fffffffffffffp1023,
                           2147483647,
                           2147483647.5,
                           2147483648,
                           2147483649,
                           4294967296,
                           1e300,
                           kInfinity,
                           kNaN};
constexpr int kSpecials = sizeof kSpecial / sizeof *kSpecial;

/// A number of any size, any kind and either sign.
double number(Random& random) {
  const double sign = random.chance(0.5) ? 1 : -1;
  switch (random.below(4)) {
    case 0:
      return std::copysign(kSpecial[random.below(kSpecials)], sign);
    case 1:
      return sign * random.below(5);  // equal ones
    case 2:
      return sign * random.size(1e-3, 1e10);
    default:
      return sign * std::ldexp(1 + random.unit(), random.below(2098) - 1074);
  }
}

struct Case {
  double a[kLanes], b[kLanes], x[kLanes], y[kLanes];
  explicit Case(Random& random) {
    for (int i = 0; i < kLanes; ++i) {
      a[i] = number(random);
      b[i] = random.chance(0.1) ? a[i] : number(random);
      x[i] = number(random);
      y[i] = number(random);
    }
  }
};

template <typename T>
bool sameBits(T a, T b) {
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison): bits are meant
}
template <typename T>
bool sameOrBothNaN(T a, T b) {
  return sameBits(a, b) || (std::isnan(a) && std::isnan(b));
}

/// One lane of what the list promises, in the rounding mode that is set: volatile, so that it is computed here and now.
bool promised(Operation operation, double in_a, double in_b, double in_x, double in_y, double out) {
  volatile double a = in_a, b = in_b, x = in_x, o = 0;
  switch (operation) {
    case Operation::plus:
      o = a + b;
      break;
    case Operation::minus:
      o = a - b;
      break;
    case Operation::times:
      o = a * b;
      break;
    case Operation::over:
      o = a / b;
      break;
    case Operation::sqrt:
      o = std::sqrt(a);
      break;
    case Operation::mulAdd: {
      const volatile double product = a * b;
      o = product + x;
      const volatile double fused = std::fma(a, b, x);
      return sameOrBothNaN<double>(out, o) || sameOrBothNaN<double>(out, fused);
    }
    case Operation::negated:
      return sameBits(out, std::copysign(in_a, std::signbit(in_a) ? 1.0 : -1.0));
    case Operation::abs:
      return sameBits(out, std::copysign(in_a, 1.0));
    case Operation::min:
      return sameBits(out, a < b ? in_a : in_b);
    case Operation::max:
      return sameBits(out, a > b ? in_a : in_b);
    case Operation::whereGreater:
      return sameBits(out, a > b ? in_x : in_y);
  }
  return sameOrBothNaN<double>(out, o);
}

TEST(Registers, ArithmeticIsTheListsInAnyRoundingMode) {
  const char* const names[] = {"plus", "minus", "times", "over",   "negated",     "min",
                               "max",  "abs",   "sqrt",  "mulAdd", "whereGreater"};
  Random random(seedOf("RegistersArithmetic"));
  const int batches = scaled(40000) / kLanes;
  for (int batch = 0; batch < batches; ++batch) {
    const Case c(random);
    for (const int mode : kRoundingModes) {
      const ScopedRounding scope(mode);
      for (const RegisterFile* file : registerFiles()) {
        for (int k = 0; k <= static_cast<int>(Operation::whereGreater); ++k) {
          const Operation operation = static_cast<Operation>(k);
          double out[kLanes];
          file->apply(operation, c.a, c.b, c.x, c.y, out);
          for (int i = 0; i < kLanes; ++i) {
            ASSERT_TRUE(promised(operation, c.a[i], c.b[i], c.x[i], c.y[i], out[i]))
                << file->name << " " << names[k] << " mode " << mode << " lane " << i << ": " << c.a[i] << " " << c.b[i]
                << " " << c.x[i] << " " << c.y[i] << " gives " << out[i];
          }
        }
      }
    }
  }
}

TEST(Registers, ComparisonsAreTheLists) {
  Random random(seedOf("RegistersComparisons"));
  const int batches = scaled(100000) / kLanes;
  for (int batch = 0; batch < batches; ++batch) {
    const Case c(random);
    unsigned expected = 0;
    double largest = -kInfinity;
    bool has_nan = false;
    for (int i = 0; i < kLanes; ++i) {
      expected |= static_cast<unsigned>(c.a[i] > c.b[i]) << i;
      largest = std::max(largest, c.a[i]);
      has_nan |= std::isnan(c.a[i]);
    }
    for (const RegisterFile* file : registerFiles()) {
      ASSERT_EQ(file->greater(c.a, c.b), expected) << file->name;
      const double found = file->maxLane(c.a);
      bool among = false;
      for (const double lane : c.a) among |= sameBits(found, lane);
      ASSERT_TRUE(among) << file->name << " " << found;
      if (!has_nan) {
        ASSERT_EQ(found, largest) << file->name;
      }
      double out[kLanes];
      file->set(c.a[0], out);
      for (const double lane : out) ASSERT_TRUE(sameBits(lane, c.a[0])) << file->name;
    }
  }
}

std::int32_t truncated(double a) {
  return a > -0x1p31 - 1 && a < 0x1p31 ? static_cast<std::int32_t>(a) : INT32_MIN;
}

TEST(Registers, IntegersAreTheListsInAnyRoundingMode) {
  Random random(seedOf("RegistersIntegers"));
  const int batches = scaled(40000) / kLanes;
  for (int batch = 0; batch < batches; ++batch) {
    const Case c(random);
    const int add = random.below(4) - 1, bits = random.chance(0.3) ? -1 : 1 << random.below(4);
    for (const int mode : kRoundingModes) {
      const ScopedRounding scope(mode);
      for (const RegisterFile* file : registerFiles()) {
        double out[kLanes];
        file->integers(c.a, add, bits, out);
        for (int i = 0; i < kLanes; ++i) {
          const std::uint32_t sum = static_cast<std::uint32_t>(truncated(c.a[i])) + static_cast<std::uint32_t>(add);
          ASSERT_TRUE(sameBits<double>(out[i], static_cast<std::int32_t>(sum) & bits))
              << file->name << " " << c.a[i] << " + " << add << " & " << bits << " gives " << out[i];
        }
        file->numbered(c.a, 8 * (batch % 128), out);
        for (int i = 0; i < kLanes; ++i) {
          std::uint64_t in, numbered;
          std::memcpy(&in, &c.a[i], sizeof in);
          std::memcpy(&numbered, &out[i], sizeof numbered);
          ASSERT_EQ(numbered, (in & ~std::uint64_t{1023}) | static_cast<std::uint64_t>(8 * (batch % 128) + i))
              << file->name;
        }
      }
    }
  }
}

TEST(Registers, FloatsAreTheListsInAnyRoundingMode) {
  Random random(seedOf("RegistersFloats"));
  const int batches = scaled(100000) / kLanes;
  int above = 0, rounded = 0;
  for (int batch = 0; batch < batches; ++batch) {
    const Case c(random);
    for (const int mode : kRoundingModes) {
      const ScopedRounding scope(mode);
      float expected[kLanes], b[kLanes], x[kLanes], y[kLanes];
      unsigned larger = 0;
      for (int i = 0; i < kLanes; ++i) {
        volatile double in = c.a[i];
        volatile float out = static_cast<float>(in);
        expected[i] = out;
        rounded += out != in && !std::isnan(in);
        b[i] = random.chance(0.2) ? expected[i] : static_cast<float>(c.b[i]);
        x[i] = random.chance(0.6) ? -1 : static_cast<float>(c.x[i]);
        y[i] = static_cast<float>(c.y[i]);
        larger |= static_cast<unsigned>(expected[i] > b[i] || x[i] > y[i]) << i;
      }
      above += larger != 0;
      for (const RegisterFile* file : registerFiles()) {
        float out[kLanes];
        file->narrow(c.a, out);
        for (int i = 0; i < kLanes; ++i) {
          ASSERT_TRUE(sameOrBothNaN(out[i], expected[i]))
              << file->name << " mode " << mode << " " << c.a[i] << " gives " << out[i];
        }
        ASSERT_EQ(file->above(expected, b, x, y), larger) << file->name;
        file->spread(expected[0], out);
        for (const float lane : out) ASSERT_TRUE(sameOrBothNaN(lane, expected[0])) << file->name;
      }
    }
  }
  EXPECT_GT(above, batches);
  EXPECT_GT(rounded, batches);
}

}  // namespace
}  // namespace registers_test
}  // namespace numerics_test
}  // namespace fcl_artic
