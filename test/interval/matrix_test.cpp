// SPDX-License-Identifier: BSD-3-Clause
//
// Vectors and matrices of intervals against exact members of them.
#include <cstdio>

#include <gtest/gtest.h>

#include "interval/matrix.h"
#include "operands.h"

namespace fcl_artic {
namespace numerics_test {
namespace matrix_test {
namespace {

bool holds(const IntervalVec3& x, const Real3& value) {
  return holds(x[0], value[0]) && holds(x[1], value[1]) && holds(x[2], value[2]);
}
Real3 column(const RealFrame& M, std::size_t j) {
  return {M.R[0][j], M.R[1][j], M.R[2][j]};
}
bool holdsColumns(const IntervalMat3& M, const Real3* columns) {
  return holds(M.column(0), columns[0]) && holds(M.column(1), columns[1]) && holds(M.column(2), columns[2]);
}
/// The rotation's part alone.
Real3 turned(const RealFrame& M, const Real3& p) {
  RealFrame o = M;
  o.t = {0.0, 0.0, 0.0};
  return o * p;
}

TEST(Matrix, ProductsHoldExactOnes) {
  Random random(seedOf("Matrix"));
  const int rounds = scaled(100000) / 4;
  for (int round = 0; round < rounds; ++round) {
    const Shape shape = kModerateShapes[round % kNumModerateShapes];
    const IntervalTransform A = randomTransform(random, shape), B = randomTransform(random, shape);
    const RealFrame a = memberOf(random, A), b = memberOf(random, B);
    double p[3], C[9];
    for (double& x : p) x = number(random, shape);
    for (double& x : C) x = number(random, shape);
    const Real3 point = {p[0], p[1], p[2]};

    const Real3 axb = cross(a.t, b.t),
                column_products[3] = {turned(a, column(b, 0)), turned(a, column(b, 1)), turned(a, column(b, 2))};
    const Real3 constant[3] = {turned(a, {C[0], C[3], C[6]}), turned(a, {C[1], C[4], C[7]}),
                               turned(a, {C[2], C[5], C[8]})};
    const Real3 back[3] = {
        {a.R[0][0], a.R[0][1], a.R[0][2]}, {a.R[1][0], a.R[1][1], a.R[1][2]}, {a.R[2][0], a.R[2][1], a.R[2][2]}};
    const Real3 inverse_t = {-dot(column(a, 0), a.t), -dot(column(a, 1), a.t), -dot(column(a, 2), a.t)};
    for (const int mode : kRoundingModes) {
      const ScopedRounding scope(mode);
      const RoundUpward upward;
      ASSERT_TRUE(holds(A * B.t, a * b.t)) << "round " << round;
      ASSERT_TRUE(holds(A * p, a * point));
      ASSERT_TRUE(holds(A.R * p, turned(a, point)));
      ASSERT_TRUE(holdsColumns(A.R * B.R, column_products));
      ASSERT_TRUE(holdsColumns(timesConstant(A.R, C), constant));
      const IntervalTransform product = A * B, back_again = inverse(A);
      ASSERT_TRUE(holdsColumns(product.R, column_products));
      ASSERT_TRUE(holds(product.t, a * b.t));
      ASSERT_TRUE(holdsColumns(back_again.R, back));
      ASSERT_TRUE(holds(back_again.t, inverse_t));
      ASSERT_TRUE(holds(cross(A.t, B.t), axb));
      ASSERT_TRUE(holds(dot(A.t, B.t), dot(a.t, b.t)));
      ASSERT_TRUE(holds(tripleProduct(IntervalVec3(p), A.t, B.t), dot(point, axb)));
      ASSERT_TRUE(holds(A.t - B.t, a.t - b.t));
      ASSERT_TRUE(holds(A.t + B.t, a.t + b.t));
      ASSERT_TRUE(holds(hull(A.t, B.t), a.t));
      ASSERT_TRUE(holds(hull(A, B).t, b.t));
    }
  }
  std::printf("%d members of each, in four rounding modes\n", rounds);
}

}  // namespace
}  // namespace matrix_test
}  // namespace numerics_test
}  // namespace fcl_artic
