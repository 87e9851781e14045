// SPDX-License-Identifier: BSD-3-Clause
//
// Batches against their scalar twin, bit by bit, and against MPFR; on every instruction set of the machine.
#include <array>
#include <cstdio>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "interval/batch.h"
#include "operands.h"

namespace fcl_artic {
namespace numerics_test {
namespace {

std::vector<const IntervalBatch*> batches() {
  std::vector<const IntervalBatch*> all;
  for (const char* name : {"portable", "sse2", "avx2", "avx512"}) {
    if (const IntervalBatch* b = intervalBatchNamed(name)) all.push_back(b);
  }
  return all;
}

/// Every batch in every rounding mode of its caller.
struct Variant {
  const IntervalBatch* batch;
  int mode;
};
std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const IntervalBatch* batch : batches()) {
    for (const int mode : kRoundingModes) all.push_back({batch, mode});
  }
  return all;
}

bool isPortable(const IntervalBatch& b) {
  return std::strcmp(b.name, "portable") == 0;
}

bool sameBits(const Interval& a, const Interval& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// What a batch gives for what its twin gives: the same, or the portable one something that holds it.
::testing::AssertionResult agrees(const IntervalBatch& batch, const Interval& given, const Interval& twin) {
  if (isPortable(batch) ? given.contains(twin) : sameBits(given, twin)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << batch.name << " gives [" << given.lower() << ", " << given.upper()
                                       << "], its twin [" << twin.lower() << ", " << twin.upper() << "]";
}

/// Four points of n equations, by columns.
struct Columns {
  std::vector<double> numbers[12];
  const double* columns[12];
  Columns(Random& random, Shape shape, int n) {
    for (int c = 0; c < 12; ++c) {
      for (int i = 0; i < n; ++i) numbers[c].push_back(number(random, shape));
      columns[c] = numbers[c].data();
    }
  }
};

IntervalVec3 placed(const IntervalTransform& M, const Columns& points, int k, int i) {
  double p[3];
  for (int c = 0; c < 3; ++c) p[c] = points.numbers[3 * k + c][static_cast<std::size_t>(i)];
  return M * p;
}

struct Equation {
  Interval value, rate;
};
/// The scalar twin of vertexFace and edgeEdge.
Equation twinOf(bool edges, const FrameBounds& first, const FrameBounds& second, const Columns& points, int i) {
  IntervalVec3 p[4], v[4];
  for (int k = 0; k < 4; ++k) {
    const FrameBounds& f = k == 0 || (edges && k == 1) ? first : second;
    p[k] = placed(f.pose, points, k, i);
    v[k] = placed(f.rate, points, k, i);
  }
  const auto differences = [edges](const IntervalVec3* x) -> std::array<IntervalVec3, 3> {
    if (edges) return {x[2] - x[0], x[1] - x[0], x[3] - x[2]};
    return {x[1] - x[0], x[2] - x[1], x[3] - x[1]};
  };
  const auto d = differences(p), e = differences(v);
  const IntervalVec3 normal = cross(d[1], d[2]);
  return {dot(d[0], normal), dot(e[0], normal) + dot(d[0], cross(e[1], d[2]) + cross(d[1], e[2]))};
}

TEST(Batch, PointsHaveTheBitsOfTheirTwin) {
  Random random(seedOf("Batch points"));
  long checks = 0;
  const int rounds = scaled(100000) / (3 * 20);
  for (int round = 0; round < rounds; ++round) {
    const Shape shape = kShapes[round % kNumShapes];
    const int n = 1 + random.below(40);
    const IntervalTransform M = randomTransform(random, shape);
    std::vector<double> xyz;
    for (int i = 0; i < 3 * n; ++i) xyz.push_back(number(random, shape));
    for (const Variant& variant : variants()) {
      const IntervalBatch* batch = variant.batch;
      std::vector<IntervalVec3> out(static_cast<std::size_t>(n) + 1);
      out.back() = IntervalVec3(1.0, 2.0, 3.0);
      {
        const ScopedRounding scope(variant.mode);
        batch->boundPoints(M, xyz.data(), n, out.data());
      }
      ASSERT_TRUE(sameBits(out.back()[2], Interval(3.0))) << "written behind the end";
      const RoundUpward upward;
      for (int i = 0; i < n; ++i) {
        const IntervalVec3 twin = M * &xyz[static_cast<std::size_t>(3 * i)];
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(agrees(*batch, out[static_cast<std::size_t>(i)][c], twin[c]));
        checks += 3;
      }
    }
  }
  std::printf("%ld components of points\n", checks);
}

TEST(Batch, EquationsHaveTheBitsOfTheirTwin) {
  Random random(seedOf("Batch equations"));
  long checks = 0;
  const int rounds = scaled(100000) / 20;
  for (int round = 0; round < rounds; ++round) {
    const Shape shape = kShapes[round % kNumShapes];
    const int n = 1 + random.below(40);
    FrameBounds frame[2];
    for (FrameBounds& f : frame) {
      f.pose = randomTransform(random, shape);
      f.rate = randomTransform(random, shape);
    }
    const Columns points(random, shape, n);
    const bool edges = random.chance(0.5);
    for (const Variant& variant : variants()) {
      const IntervalBatch* batch = variant.batch;
      std::vector<Interval> value(static_cast<std::size_t>(n)), same(value), rate(value);
      {
        const ScopedRounding scope(variant.mode);
        const auto solve = edges ? batch->edgeEdge : batch->vertexFace;
        solve(frame[0], frame[1], points.columns, n, value.data(), rate.data());
        solve(frame[0], frame[1], points.columns, n, same.data(), nullptr);
      }
      const RoundUpward upward;
      for (int i = 0; i < n; ++i) {
        const std::size_t at = static_cast<std::size_t>(i);
        const Equation twin = twinOf(edges, frame[0], frame[1], points, i);
        ASSERT_TRUE(agrees(*batch, value[at], twin.value));
        ASSERT_TRUE(agrees(*batch, same[at], twin.value));
        ASSERT_TRUE(agrees(*batch, rate[at], twin.rate));
        ++checks;
      }
    }
  }
  std::printf("%ld equations\n", checks);
}

/// Of moderate numbers: here it is the dependence of the terms on one another that is tried, overflow elsewhere.
TEST(Batch, EquationsHoldTheExactValue) {
  Random random(seedOf("Batch exact"));
  long checks = 0;
  const int rounds = scaled(25000) / 2;
  for (int round = 0; round < rounds; ++round) {
    const Shape shape = kModerateShapes[round % kNumModerateShapes];
    FrameBounds frame[2];
    RealFrame exact[2][2];  // [frame][pose, rate]
    for (int f = 0; f < 2; ++f) {
      frame[f].pose = randomTransform(random, shape);
      frame[f].rate = randomTransform(random, shape);
      exact[f][0] = memberOf(random, frame[f].pose);
      exact[f][1] = memberOf(random, frame[f].rate);
    }
    constexpr int n = 9;
    const Columns points(random, shape, n);
    const std::size_t i = static_cast<std::size_t>(random.below(n));
    for (const bool edges : {false, true}) {
      Real3 x[2][4];
      for (int k = 0; k < 4; ++k) {
        const int f = k == 0 || (edges && k == 1) ? 0 : 1;
        const Real3 p = {points.numbers[3 * k][i], points.numbers[3 * k + 1][i], points.numbers[3 * k + 2][i]};
        for (int order = 0; order < 2; ++order) x[order][k] = exact[f][order] * p;
      }
      const auto differences = [edges](const Real3* p) -> std::array<Real3, 3> {
        if (edges) return {p[2] - p[0], p[1] - p[0], p[3] - p[2]};
        return {p[1] - p[0], p[2] - p[1], p[3] - p[1]};
      };
      const auto d = differences(x[0]), e = differences(x[1]);
      const Real value = dot(d[0], cross(d[1], d[2]));
      const Real rate = dot(e[0], cross(d[1], d[2])) + dot(d[0], cross(e[1], d[2]) + cross(d[1], e[2]));
      for (const Variant& variant : variants()) {
        Interval values[n], rates[n];
        {
          const ScopedRounding scope(variant.mode);
          const auto solve = edges ? variant.batch->edgeEdge : variant.batch->vertexFace;
          solve(frame[0], frame[1], points.columns, n, values, rates);
        }
        ASSERT_TRUE(holds(values[i], value)) << variant.batch->name << " edges " << edges << " round " << round;
        ASSERT_TRUE(holds(rates[i], rate)) << variant.batch->name << " edges " << edges << " round " << round;
        ++checks;
      }
    }
  }
  std::printf("%ld equations\n", checks);
  EXPECT_GT(checks, rounds);
}

}  // namespace
}  // namespace numerics_test
}  // namespace fcl_artic
