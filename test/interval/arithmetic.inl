// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "arithmetic.h"
#include "interval/sine_cosine.h"

#define FCL_ARTIC_STRING2(x) #x
#define FCL_ARTIC_STRING(x) FCL_ARTIC_STRING2(x)

namespace fcl_artic {
namespace FCL_ARTIC_ISA {
namespace {

using numerics_test::Operation;

void apply(Operation operation, const Interval* a, const Interval* b, int n, Interval* out) {
  const RoundUpward upward;
  for (int i = 0; i < n; ++i) {
    switch (operation) {
      case Operation::add:
        out[i] = a[i] + b[i];
        break;
      case Operation::subtract:
        out[i] = a[i] - b[i];
        break;
      case Operation::negate:
        out[i] = -a[i];
        break;
      case Operation::multiply:
        out[i] = a[i] * b[i];
        break;
      case Operation::scale:
        out[i] = a[i] * b[i].lower();
        break;
      case Operation::divide:
        out[i] = a[i] / b[i];
        break;
      case Operation::square:
        out[i] = square(a[i]);
        break;
      case Operation::squareRoot:
        out[i] = sqrt(a[i]);
        break;
      case Operation::absolute:
        out[i] = abs(a[i]);
        break;
      case Operation::maximum:
        out[i] = max(a[i], b[i]);
        break;
      case Operation::minimum:
        out[i] = min(a[i], b[i]);
        break;
    }
  }
}

Ends endsOf(const double* x) {
  Ends ends;
  std::memcpy(&ends, x, sizeof ends);
  return ends;
}
/// A group of lanes from intervals that lie one behind the other.
Intervals gather(const Interval* x) {
  double lower[Intervals::kLanes], upper[Intervals::kLanes];
  for (int k = 0; k < Intervals::kLanes; ++k) {
    lower[k] = FCL_ARTIC_ARITHMETIC_LOWER(x[k].lower());
    upper[k] = x[k].upper();
  }
  return {endsOf(lower), endsOf(upper)};
}
void scatter(const Intervals& x, Interval* out) {
  double ends[2 * Intervals::kLanes];
  static_assert(sizeof ends == sizeof x);
  std::memcpy(ends, &x, sizeof x);
  for (int k = 0; k < Intervals::kLanes; ++k) {
    out[k] = Interval(FCL_ARTIC_ARITHMETIC_LOWER(ends[k]), ends[Intervals::kLanes + k]);
  }
}

/// @param n  a multiple of 8.
void applyLanes(Operation operation, const Interval* a, const Interval* b, int n, Interval* out) {
  const Scope scope;
  for (int i = 0; i < n; i += Intervals::kLanes) {
    const Intervals x = gather(a + i), y = gather(b + i);
    double number[Intervals::kLanes];
    for (int k = 0; k < Intervals::kLanes; ++k) number[k] = b[i + k].lower();
    Intervals o = x;
    switch (operation) {
      case Operation::add:
        o = x + y;
        break;
      case Operation::subtract:
        o = x - y;
        break;
      case Operation::multiply:
        o = x * y;
        break;
      default:
        o = x * endsOf(number);
        break;
    }
    scatter(o, out + i);
  }
}

void sineCosineOf(const Interval* x, int n, Interval* sine, Interval* cosine) {
  const RoundUpward upward;
  for (int i = 0; i < n; ++i) encloseSineCosine(x[i], sine[i], cosine[i]);
}

}  // namespace
}  // namespace FCL_ARTIC_ISA

namespace numerics_test {
const Arithmetic FCL_ARTIC_ISA_ARITHMETIC = {FCL_ARTIC_STRING(FCL_ARTIC_ISA), FCL_ARTIC_ARITHMETIC_DIRECTED,
                                             &FCL_ARTIC_ISA::apply, &FCL_ARTIC_ISA::applyLanes,
                                             &FCL_ARTIC_ISA::sineCosineOf};
}  // namespace numerics_test
}  // namespace fcl_artic
