// SPDX-License-Identifier: BSD-3-Clause
#include "motion/part_of_motion.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace part_of_motion_test {

using namespace fcl_artic;

// Against long doubles, of 64 bits: no part errs by more than is said of it, and what is said is not far too much.
TEST(MotionPart, ErrorIsBounded) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    MotionElement element;
    element.kind = MotionElement::Kind::revolute;
    for (int k = 0; k <= n % (kMaxDegree + 1); ++k)
      element.coefficients(0, k) = uniform(-1, 1) * std::pow(10, uniform(-3, 3));
    TimePart part = {uniform(0, 1), 1};
    if (n % 2) part.end = uniform(part.begin, 1);
    const Eigen::MatrixXd c = partOf(element.coefficients.row(0), part);
    const double u = uniform(0, 1);
    long double value = 0, whole = 0;
    const long double begin = part.begin, at = begin + u * (part.end - begin);
    for (int k = kMaxDegree; k >= 0; --k) {
      value = value * u + c(0, k);
      whole = whole * at + element.coefficients(0, k);
    }
    const double error = static_cast<double>(std::fabs(value - whole)) * 0x1p52;
    ASSERT_LE(error, partError(element).angle) << n;
    worst = std::max(worst, error / partError(element).angle);
  }
  EXPECT_GT(worst, 0.01);
}

}  // namespace part_of_motion_test
