// SPDX-License-Identifier: BSD-3-Clause
//
// Directed rounding by the C library, for processors without a file of their own. The file interval/rounding.h lists
// what each function does. An operation here is the compiler's, between two empty instructions that the compiler
// doesn't look into. One before it hides the operands, one after it the result, and both read `rounding_mode`. So it
// comes after the change of mode before it, ends before the next one, and is neither folded nor fused.
#pragma once

#include <cfenv>

#include "interval/rounding_mode.h"
#include "numerics/pair.h"

#if !defined(FE_UPWARD) || !defined(FE_TONEAREST)
#error "fcl_artic: this processor has no rounding upward in <cfenv>, which interval arithmetic needs"
#endif

namespace fcl_artic {

class FloatingPointControl {
 public:
  enum class Rounding : int { nearest = FE_TONEAREST, upward = FE_UPWARD };

  static FCL_ARTIC_INLINE FloatingPointControl present() {
    FloatingPointControl o;
    std::fegetenv(&o.environment_);
    return o;
  }
  /// Always false: C has no way to ask whether subnormals are kept and exceptions trap. So every scope sets the mode.
  FCL_ARTIC_INLINE bool is(Rounding) const { return false; }
  static FCL_ARTIC_INLINE void set(Rounding rounding) {
    order();
    std::fesetenv(FE_DFL_ENV);
    std::fesetround(static_cast<int>(rounding));
    order();
  }
  FCL_ARTIC_INLINE void restore() const {
    order();
    std::fesetenv(&environment_);
    order();
  }

 private:
  FloatingPointControl() = default;
  static FCL_ARTIC_INLINE void order() { asm volatile("" : "+m"(rounding_mode) : : "memory"); }
  std::fenv_t environment_;
};

namespace directed {
FCL_ARTIC_INLINE double hidden(double x) {
  asm("" : "+m"(x) : "m"(rounding_mode));
  return x;
}
FCL_ARTIC_INLINE Pair add(Pair a, Pair b) {
  return Pair{hidden(hidden(a[0]) + hidden(b[0])), hidden(hidden(a[1]) + hidden(b[1]))};
}
FCL_ARTIC_INLINE Pair mul(Pair a, Pair b) {
  return Pair{hidden(hidden(a[0]) * hidden(b[0])), hidden(hidden(a[1]) * hidden(b[1]))};
}
FCL_ARTIC_INLINE Pair div(Pair a, Pair b) {
  return Pair{hidden(hidden(a[0]) / hidden(b[0])), hidden(hidden(a[1]) / hidden(b[1]))};
}
FCL_ARTIC_INLINE Pair sqrt(Pair a) {
  return Pair{hidden(__builtin_sqrt(hidden(a[0]))), hidden(__builtin_sqrt(hidden(a[1])))};
}
}  // namespace directed

}  // namespace fcl_artic
