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

IntervalTransform randomTransform(Random& random, Shape shape) {
  IntervalTransform M;
  for (Interval& x : M.R.m) x = operand(random, shape);
  for (Interval& x : M.t.v) x = operand(random, shape);
  return M;
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
    for (const IntervalBatch* batch : batches()) {
      std::vector<IntervalVec3> out(static_cast<std::size_t>(n) + 1);
      out.back() = IntervalVec3(1.0, 2.0, 3.0);
      {
        const ScopedRounding scope(kRoundingModes[round % 4]);
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
    for (const IntervalBatch* batch : batches()) {
      std::vector<Interval> value(static_cast<std::size_t>(n)), same(value), rate(value);
      {
        const ScopedRounding scope(kRoundingModes[round % 4]);
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

/// A point of an interval, its ends now and then.
double within(Random& random, const Interval& x) {
  const int kind = random.below(4);
  if (kind == 0 || x.width() == 0) return x.lower();
  if (kind == 1) return x.upper();
  const double s = random.unit(), y = (1 - s) * x.lower() + s * x.upper();
  return std::min(std::max(y, x.lower()), x.upper());
}

/// Of moderate numbers: here it is the dependence of the terms on one another that is tried, overflow elsewhere.
TEST(Batch, EquationsHoldTheExactValue) {
  Random random(seedOf("Batch exact"));
  long checks = 0;
  const int rounds = scaled(100000) / (2 * 8);
  for (int round = 0; round < rounds; ++round) {
    const Shape shape = kModerateShapes[round % kNumModerateShapes];
    const int n = 8;
    FrameBounds frame[2];
    Real R[2][2][9], t[2][2][3];  // [frame][pose, rate]
    for (int f = 0; f < 2; ++f) {
      frame[f].pose = randomTransform(random, shape);
      frame[f].rate = randomTransform(random, shape);
      for (int order = 0; order < 2; ++order) {
        const IntervalTransform& M = order ? frame[f].rate : frame[f].pose;
        for (int i = 0; i < 9; ++i) R[f][order][i] = within(random, M.R.m[i]);
        for (int i = 0; i < 3; ++i) t[f][order][i] = within(random, M.t[i]);
      }
    }
    const Columns points(random, shape, n);
    for (const IntervalBatch* batch : batches()) {
      for (const bool edges : {false, true}) {
        Interval value[n], rate[n];
        {
          const ScopedRounding scope(kRoundingModes[round % 4]);
          (edges ? batch->edgeEdge : batch->vertexFace)(frame[0], frame[1], points.columns, n, value, rate);
        }
        const int i = random.below(n);
        Real3 x[2][4];
        for (int k = 0; k < 4; ++k) {
          const int f = k == 0 || (edges && k == 1) ? 0 : 1;
          for (int order = 0; order < 2; ++order) {
            for (int r = 0; r < 3; ++r) {
              Real sum = t[f][order][r];
              for (int c = 0; c < 3; ++c) {
                sum += R[f][order][3 * r + c] * Real(points.numbers[3 * k + c][static_cast<std::size_t>(i)]);
              }
              x[order][k][static_cast<std::size_t>(r)] = sum;
            }
          }
        }
        const auto differences = [edges](const Real3* p) -> std::array<Real3, 3> {
          if (edges) return {p[2] - p[0], p[1] - p[0], p[3] - p[2]};
          return {p[1] - p[0], p[2] - p[1], p[3] - p[1]};
        };
        const auto d = differences(x[0]), e = differences(x[1]);
        const Real exact = dot(d[0], cross(d[1], d[2]));
        const Real speed = dot(e[0], cross(d[1], d[2])) + dot(d[0], cross(e[1], d[2]) + cross(d[1], e[2]));
        ASSERT_TRUE(holds(value[i], exact)) << batch->name << " edges " << edges << " round " << round;
        ASSERT_TRUE(holds(rate[i], speed)) << batch->name << " edges " << edges << " round " << round;
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
