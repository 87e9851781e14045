// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>

#include "cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace sine_cosine_test {
namespace {

/// Values where the reduction by pi/2 is hardest: the doubles next to k pi/2, and ends of its range.
double angle(Random& random) {
  const int k = random.below(1273238) - 636619;
  switch (random.below(5)) {
    case 0:
      return random.in(-1e6, 1e6);
    case 1:
      return random.in(-7, 7);
    case 2:
      return random.size(1e-300, 1) * (random.chance(0.5) ? 1 : -1);
    case 3:
      return k * 1.5707963267948966 * (1 + (random.below(9) - 4) * 0x1p-53);
    default:
      return (k + 0.5) * 1.5707963267948966 * (1 + (random.below(9) - 4) * 0x1p-53);
  }
}

TEST(SineCosine, WithinFourUlpOfMpfrInAnyRoundingMode) {
  Random random(seedOf("SineCosine"));
  const int batches = scaled(100000) / 8;
  double worst = 0;
  for (int batch = 0; batch < batches; ++batch) {
    double x[8], sine[8], cosine[8];
    Real true_sine[8], true_cosine[8];
    for (int i = 0; i < 8; ++i) {
      x[i] = std::max(-1e6, std::min(1e6, angle(random)));
      true_sine[i] = sin(Real(x[i]));
      true_cosine[i] = cos(Real(x[i]));
    }
    for (const Subject* subject : subjects()) {
      for (const int mode : kRoundingModes) {
        {
          const ScopedRounding scope(mode);
          subject->sineCosine(x, sine, cosine);
        }
        for (int i = 0; i < 8; ++i) {
          const double error = max(abs(Real(sine[i]) - true_sine[i]), abs(Real(cosine[i]) - true_cosine[i])).toDouble();
          worst = std::max(worst, error);
          ASSERT_LE(error, 4 * 0x1p-52) << subject->name << " mode " << mode << " x " << x[i];
        }
      }
    }
  }
  std::printf("largest error %.3f of 2^-52 (promised: 4)\n", worst * 0x1p52);
  EXPECT_GT(worst, 0.4 * 0x1p-52) << "the hardest values were not met";
}

}  // namespace
}  // namespace sine_cosine_test
}  // namespace numerics_test
}  // namespace fcl_artic
