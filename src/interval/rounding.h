// SPDX-License-Identifier: BSD-3-Clause
//
// Directed rounding that a compiler can't undo. C++ knows no rounding mode: compilers fold, share and move
// floating-point operations across a change of mode, -frounding-math or not (doc/INTERVALS.md, "Compiler hazards"). So
// every operation that relies on the mode is an instruction of its own here, which the compiler doesn't look into, and
// which reads `rounding_mode`; a change of mode writes it. The order of writes and reads is then the order of changes
// and operations.
#pragma once

#if !defined(__x86_64__)
#error "directed rounding is written for x86-64, as the engine is"
#endif
#include <immintrin.h>

#include "numerics/inlined.h"

namespace fcl_artic {

/// Stands for the processor's rounding mode where the compiler orders operations. Never read or written in fact.
__attribute__((visibility("hidden"))) inline char rounding_mode = 0;

/// Sets the processor's floating-point control while it lives; the caller's is put back at the end, sticky flags
/// included.
class RoundingScope {
 public:
  RoundingScope(const RoundingScope&) = delete;
  RoundingScope& operator=(const RoundingScope&) = delete;

 protected:
  explicit FCL_ARTIC_INLINE RoundingScope(unsigned control)
      : before_(_mm_getcsr()), changes_((before_ & ~kFlags) != control) {
    if (changes_) set(control);
  }
  FCL_ARTIC_INLINE ~RoundingScope() {
    if (changes_) set(before_);
  }
  static constexpr unsigned kFlags = 0x3f;
  /// Exceptions masked, subnormals kept, rounding to nearest.
  static constexpr unsigned kDefault = 0x1f80;

 private:
  static FCL_ARTIC_INLINE void set(unsigned control) {
    asm volatile("ldmxcsr %1" : "+m"(rounding_mode) : "m"(control) : "memory");
  }
  unsigned before_;
  bool changes_;
};

/// Rounds upward while it lives: all operations of Interval are enclosures then, in whatever mode the caller computes,
/// flushes subnormals or traps exceptions. May be nested: only an outer one writes the control register, twice.
class RoundUpward : public RoundingScope {
 public:
  FCL_ARTIC_INLINE RoundUpward() : RoundingScope(kUpward) {}
  FCL_ARTIC_INLINE ~RoundUpward() {}  // inlined even where nothing is optimised: no copy for the linker to pick
  static FCL_ARTIC_INLINE bool isOn() { return (_mm_getcsr() & ~kFlags) == kUpward; }

 private:
  static constexpr unsigned kUpward = kDefault | _MM_ROUND_UP;
};

/// The usual mode, for code of others that is called meanwhile.
class RoundToNearest : public RoundingScope {
 public:
  FCL_ARTIC_INLINE RoundToNearest() : RoundingScope(kDefault) {}
  FCL_ARTIC_INLINE ~RoundToNearest() {}
};

/// Two doubles at once, in the present rounding mode.
namespace directed {
#ifdef __AVX__
#define FCL_ARTIC_DIRECTED(name)                                                   \
  FCL_ARTIC_INLINE __m128d name(__m128d a, __m128d b) {                            \
    __m128d o;                                                                     \
    asm("v" #name "pd %2, %1, %0" : "=x"(o) : "x"(a), "x"(b), "m"(rounding_mode)); \
    return o;                                                                      \
  }
#else
#define FCL_ARTIC_DIRECTED(name)                                   \
  FCL_ARTIC_INLINE __m128d name(__m128d a, __m128d b) {            \
    asm(#name "pd %1, %0" : "+x"(a) : "x"(b), "m"(rounding_mode)); \
    return a;                                                      \
  }
#endif
FCL_ARTIC_DIRECTED(add)
FCL_ARTIC_DIRECTED(mul)
FCL_ARTIC_DIRECTED(div)
#undef FCL_ARTIC_DIRECTED
FCL_ARTIC_INLINE __m128d sqrt(__m128d a) {
  __m128d o;
#ifdef __AVX__
  asm("vsqrtpd %1, %0" : "=x"(o) : "x"(a), "m"(rounding_mode));
#else
  asm("sqrtpd %1, %0" : "=x"(o) : "x"(a), "m"(rounding_mode));
#endif
  return o;
}
}  // namespace directed

/// True if a probe of every operation under RoundUpward rounds upward: not so on a machine, an emulator or under a tool
/// that ignores rounding modes (valgrind does). Costs a microsecond; the result may be kept.
bool roundingModesWork();

}  // namespace fcl_artic
