// SPDX-License-Identifier: BSD-3-Clause
//
// The test of boxes in lanes against its twin for one pair (redon/overlap.h), and against exact positions. It runs on
// every instruction set of the machine, in every rounding mode of the caller.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "operands.h"
#include "redon/box_batch.h"
#include "redon/overlap.h"

namespace fcl_artic {
namespace numerics_test {
namespace box_batch_test {
namespace {

using redon::BoxBatch;

std::vector<const BoxBatch*> batches() {
  std::vector<const BoxBatch*> all;
  for (const char* name : {"portable", "sse2", "avx2", "avx512", "neon"}) {
    if (const BoxBatch* b = redon::boxBatchNamed(name)) all.push_back(b);
  }
  return all;
}

Eigen::Matrix3d rotation(Random& random) {
  Eigen::Vector4d q;
  do {
    for (double& x : q) x = random.in(-1, 1);
  } while (q.norm() < 0.1);
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

ObbNode randomBox(Random& random, double spread) {
  ObbNode box = {};
  const Eigen::Matrix3d axes = rotation(random);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) box.axis[i][k] = static_cast<float>(axes(i, k));
    box.center[i] = static_cast<float>(random.in(-spread, spread));
    box.half[i] = random.chance(0.1) ? 0 : static_cast<float>(random.in(0.01, 0.2));
  }
  return box;
}

Interval about(Random& random, double x, double width) {
  const double below = random.in(0, width), above = random.in(0, width);
  return Interval(x - below, x + above);
}

/// Boxes, and where the second ones go: a rigid transform, and an interval about it.
struct Case {
  ObbNode a[BoxBatch::kPairs], b[BoxBatch::kPairs];
  const ObbNode *first[BoxBatch::kPairs], *second[BoxBatch::kPairs];
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  IntervalTransform M;
  int n;

  explicit Case(Random& random) : R(rotation(random)), n(1 + random.below(BoxBatch::kPairs)) {
    const double spread = random.in(0.05, 0.6);
    for (int k = 0; k < BoxBatch::kPairs; ++k) {
      a[k] = randomBox(random, spread);
      b[k] = randomBox(random, spread);
      first[k] = &a[k];
      second[k] = &b[k];
    }
    const double width = random.chance(0.3) ? 0 : random.in(0, 0.1);
    for (int i = 0; i < 3; ++i) {
      t[i] = random.in(-0.1, 0.1);
      M.t[i] = about(random, t[i], width);
      for (int j = 0; j < 3; ++j) M.R(i, j) = about(random, R(i, j), width);
    }
  }
  unsigned apart(const BoxBatch& batch, int mode) const {
    const ScopedRounding scope(mode);
    return batch.apart(M, first, second, n);
  }
};

bool twinOf(const Case& c, int k) {
  const RoundUpward upward;
  redon::SweptObb swept;
  redon::sweep(c.M, c.b[k], swept);
  return redon::certainlyDisjoint(c.a[k], swept, c.b[k].half);
}

/// Moves the second boxes to where a step in the last place decides about the first pair.
void moveToTheBrink(Random& random, Case& c) {
  const IntervalVec3 start = c.M.t;
  Eigen::Vector3d way;
  for (double& x : way) x = random.in(-2, 2);
  double touching = 0, apart = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (touching + apart);
    {
      const RoundUpward upward;
      for (int i = 0; i < 3; ++i) c.M.t[i] = start[i] + Interval(way[i]) * middle;
    }
    (twinOf(c, 0) ? apart : touching) = middle;
  }
}

TEST(BoxBatch, TellsApartWhatItsTwinDoes) {
  Random random(seedOf("Boxes"));
  long checks = 0, apart = 0, lost = 0;
  const int rounds = scaled(100000) / 4;
  for (int round = 0; round < rounds; ++round) {
    Case c(random);
    if (random.chance(0.2)) moveToTheBrink(random, c);
    if (random.chance(0.02)) c.M.t[random.below(3)] = Interval::entire();
    unsigned twin = 0;
    for (int k = 0; k < c.n; ++k) twin |= static_cast<unsigned>(twinOf(c, k)) << k;
    for (const BoxBatch* batch : batches()) {
      const bool portable = std::strcmp(batch->name, "portable") == 0;
      for (const int mode : kRoundingModes) {
        const unsigned given = c.apart(*batch, mode);
        if (portable) {
          ASSERT_EQ(given & ~twin, 0u) << "round " << round;
          lost += given != twin;
        } else {
          ASSERT_EQ(given, twin) << batch->name << " round " << round;
        }
      }
    }
    checks += c.n;
    apart += __builtin_popcount(twin);
  }
  std::printf("%ld pairs of boxes, %ld apart; portable saw less %ld times\n", checks, apart, lost);
  EXPECT_GT(apart, checks / 10);
  EXPECT_LT(apart, checks - checks / 10);
  EXPECT_LT(lost, checks);
}

/// Eq. (12) as it stands, in long double: the axes of the fifteen along which two boxes in one frame are apart, and by
/// how much the best of them are.
unsigned separatingAxes(const ObbNode& a, const ObbNode& b, const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                        long double room) {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  Vector e[3], f[3], c_a, c_b;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3f own(b.axis[i][0], b.axis[i][1], b.axis[i][2]);
    e[i] = Eigen::Vector3f(a.axis[i][0], a.axis[i][1], a.axis[i][2]).cast<long double>();
    f[i] = R.cast<long double>() * own.cast<long double>();
  }
  c_a = Eigen::Vector3f(a.center[0], a.center[1], a.center[2]).cast<long double>();
  c_b = R.cast<long double>() * Eigen::Vector3f(b.center[0], b.center[1], b.center[2]).cast<long double>() +
        t.cast<long double>();
  unsigned out = 0;
  for (int axis = 0; axis < 15; ++axis) {
    const Vector n = axis < 3 ? e[axis] : axis < 6 ? f[axis - 3] : Vector(e[(axis - 6) / 3].cross(f[(axis - 6) % 3]));
    if (n.norm() < 0.1L) continue;  // nearly parallel edges
    long double gap = std::abs(n.dot(c_b - c_a));
    for (int i = 0; i < 3; ++i) gap -= a.half[i] * std::abs(n.dot(e[i])) + b.half[i] * std::abs(n.dot(f[i]));
    if (gap > 0) out |= 1u << axis;
    if (gap > 0 && gap < room) return 0;  // not telling
  }
  return out;
}

TEST(BoxBatch, EachOfTheFifteenAxesTellsBoxesApartThatNoOtherDoes) {
  Random random(seedOf("Axes"));
  long told[15] = {};
  for (int round = 0; round < scaled(100000) * 4; ++round) {
    Case c(random);
    c.a[0] = randomBox(random, 0.2);
    c.b[0] = randomBox(random, 0.2);
    for (int i = 0; i < 3; ++i) {
      c.M.t[i] = Interval(c.t[i]);
      for (int j = 0; j < 3; ++j) c.M.R(i, j) = Interval(c.R(i, j));
    }
    const unsigned axes = separatingAxes(c.a[0], c.b[0], c.R, c.t, 1e-5L);
    if (__builtin_popcount(axes) != 1) continue;
    const int axis = __builtin_ctz(axes);
    if (told[axis] >= 200) continue;
    ++told[axis];
    ASSERT_TRUE(twinOf(c, 0)) << "axis " << axis;
    for (const BoxBatch* batch : batches()) {
      ASSERT_TRUE(batch->apart(c.M, c.first, c.second, 1) & 1) << "axis " << axis << " " << batch->name;
    }
  }
  for (int axis = 0; axis < 15; ++axis) {
    std::printf("axis %d alone: %ld pairs\n", axis, told[axis]);
    EXPECT_GE(told[axis], 20) << "axis " << axis;
  }
}

/// Boxes that share a point, at the transform in the middle: of A a random point or corner, of B one that comes to lie
/// on it. Exact but for the rounding of a few sums, which the grown half sizes pay for.
TEST(BoxBatch, KeepsBoxesThatShareAPoint) {
  Random random(seedOf("Shared point"));
  long checks = 0;
  const int rounds = scaled(100000) / 4;
  for (int round = 0; round < rounds; ++round) {
    Case c(random);
    for (int k = 0; k < c.n; ++k) {
      const auto offset = [&](const ObbNode& box) {
        Eigen::Vector3d x = Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i) {
          const double side = random.chance(0.5) ? random.in(-1, 1) : random.chance(0.5) ? 1 : -1;
          for (int j = 0; j < 3; ++j) x[j] += side * box.half[i] * box.axis[i][j];
        }
        return x;
      };
      const Eigen::Vector3d at = offset(c.a[k]) - c.R * offset(c.b[k]);  // B's center against A's
      for (int i = 0; i < 3; ++i) {
        const double moved = at[i] - (c.R.row(i).dot(Eigen::Vector3f::Map(c.b[k].center).cast<double>()) + c.t[i]);
        c.a[k].center[i] = static_cast<float>(-moved);
        c.a[k].half[i] += 1e-6f;
      }
    }
    for (const BoxBatch* batch : batches()) {
      for (const int mode : kRoundingModes) ASSERT_EQ(c.apart(*batch, mode), 0u) << batch->name << " round " << round;
    }
    checks += c.n;
  }
  std::printf("%ld pairs of boxes\n", checks);
  EXPECT_GT(checks, rounds);
}

}  // namespace
}  // namespace box_batch_test
}  // namespace numerics_test
}  // namespace fcl_artic
