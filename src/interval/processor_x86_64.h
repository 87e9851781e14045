// SPDX-License-Identifier: BSD-3-Clause
//
// Directed rounding on x86-64: the control register MXCSR, and operations of SSE2 that read it. The file
// interval/rounding.h lists what each does.
#pragma once

#include <xmmintrin.h>

#include "interval/rounding_mode.h"
#include "numerics/pair.h"

namespace fcl_artic {

class FloatingPointControl {
 public:
  enum class Rounding : unsigned { nearest = _MM_ROUND_NEAREST, upward = _MM_ROUND_UP };

  static FCL_ARTIC_INLINE FloatingPointControl present() { return FloatingPointControl(_mm_getcsr()); }
  FCL_ARTIC_INLINE bool is(Rounding rounding) const { return (mxcsr_ & ~kFlags) == of(rounding).mxcsr_; }
  static FCL_ARTIC_INLINE void set(Rounding rounding) { of(rounding).restore(); }
  FCL_ARTIC_INLINE void restore() const { asm volatile("ldmxcsr %1" : "+m"(rounding_mode) : "m"(mxcsr_) : "memory"); }

 private:
  explicit FCL_ARTIC_INLINE FloatingPointControl(unsigned mxcsr) : mxcsr_(mxcsr) {}
  /// Exceptions masked, subnormals kept.
  static FCL_ARTIC_INLINE FloatingPointControl of(Rounding rounding) {
    return FloatingPointControl(0x1f80 | static_cast<unsigned>(rounding));
  }
  static constexpr unsigned kFlags = 0x3f;
  unsigned mxcsr_;
};

namespace directed {
#ifdef __AVX__
#define FCL_ARTIC_DIRECTED(name)                                                   \
  FCL_ARTIC_INLINE Pair name(Pair a, Pair b) {                                     \
    Pair o;                                                                        \
    asm("v" #name "pd %2, %1, %0" : "=x"(o) : "x"(a), "x"(b), "m"(rounding_mode)); \
    return o;                                                                      \
  }
#else
#define FCL_ARTIC_DIRECTED(name)                                   \
  FCL_ARTIC_INLINE Pair name(Pair a, Pair b) {                     \
    asm(#name "pd %1, %0" : "+x"(a) : "x"(b), "m"(rounding_mode)); \
    return a;                                                      \
  }
#endif
FCL_ARTIC_DIRECTED(add)
FCL_ARTIC_DIRECTED(mul)
FCL_ARTIC_DIRECTED(div)
#undef FCL_ARTIC_DIRECTED
FCL_ARTIC_INLINE Pair sqrt(Pair a) {
  Pair o;
#ifdef __AVX__
  asm("vsqrtpd %1, %0" : "=x"(o) : "x"(a), "m"(rounding_mode));
#else
  asm("sqrtpd %1, %0" : "=x"(o) : "x"(a), "m"(rounding_mode));
#endif
  return o;
}
}  // namespace directed

}  // namespace fcl_artic
