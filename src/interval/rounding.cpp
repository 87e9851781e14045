// SPDX-License-Identifier: BSD-3-Clause
#include "interval/rounding.h"

namespace fcl_artic {

bool roundingModesWork() {
  const RoundUpward scope;
  const auto twice = [](double x) { return pairOf(x); };
  const auto is = [](Pair a, double x) { return pairLow(a) == x && pairHigh(a) == x; };
  const Pair tiny = twice(0x1p-600), one = twice(1), least = twice(0x1p-1074);
  return is(directed::add(one, tiny), 1 + 0x1p-52) && is(directed::add(twice(-1), tiny), -1 + 0x1p-53) &&
         is(directed::mul(tiny, tiny), 0x1p-1074) && is(directed::mul(tiny, twice(-0x1p-600)), 0) &&
         is(directed::div(one, twice(3)), 0x1.5555555555556p-2) &&
         is(directed::div(one, twice(-3)), -0x1.5555555555555p-2) &&
         is(directed::sqrt(twice(2)), 0x1.6a09e667f3bcdp+0) && is(directed::add(least, least), 0x1p-1073);
}

}  // namespace fcl_artic
