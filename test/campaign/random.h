// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "convex.h"
#include "pairs/random.h"

namespace campaign {

/// The seeded stream, with what scenes draw besides.
class Random : public pairs::Random {
 public:
  using pairs::Random::Random;
  int between(int a, int b) { return a + below(b - a + 1); }
  double sign() { return chance(0.5) ? 1 : -1; }
  Mat3 rotation();
};

}  // namespace campaign
