// SPDX-License-Identifier: BSD-3-Clause
//
// Directed rounding that a compiler can't undo. C++ knows no rounding mode: compilers fold, share and move
// floating-point operations across a change of mode, -frounding-math or not (doc/REDON2004.md, "Compiler hazards"). So
// every operation that relies on the mode is an instruction of its own here, which the compiler doesn't look into. The
// instruction reads `rounding_mode`; a change of mode writes it. The order of writes and reads is then the order of
// changes and operations.
//
// All that depends on the processor is in interval/processor_*.h. Such a file defines:
//
//   class FloatingPointControl    the processor's floating-point control, sticky flags of exceptions included
//     enum class Rounding         nearest, upward
//     static present()            as it is now
//     is(rounding)                true only where it rounds so, traps nothing and keeps subnormals
//     static set(rounding)        makes it so; writes rounding_mode
//     restore()                   puts this one back, flags included; writes rounding_mode
//   directed::add, mul, div (a, b), sqrt(a)   of two doubles at once, in the mode that is set; read rounding_mode
#pragma once

#include "numerics/inlined.h"

#if defined(__x86_64__) && !defined(FCL_ARTIC_PORTABLE)
#include "interval/processor_x86_64.h"
#elif defined(__aarch64__) && !defined(FCL_ARTIC_PORTABLE)
#include "interval/processor_aarch64.h"
#else
#include "interval/processor_any.h"
#endif

namespace fcl_artic {

/// Sets the processor's floating-point control while it lives; the caller's is put back at the end, sticky flags
/// included.
class RoundingScope {
 public:
  RoundingScope(const RoundingScope&) = delete;
  RoundingScope& operator=(const RoundingScope&) = delete;

 protected:
  explicit FCL_ARTIC_INLINE RoundingScope(FloatingPointControl::Rounding rounding)
      : before_(FloatingPointControl::present()), changes_(!before_.is(rounding)) {
    if (changes_) FloatingPointControl::set(rounding);
  }
  FCL_ARTIC_INLINE ~RoundingScope() {
    if (changes_) before_.restore();
  }

 private:
  FloatingPointControl before_;
  bool changes_;
};

/// Rounds upward while it lives: all operations of Interval are enclosures then, in whatever mode the caller computes,
/// flushes subnormals or traps exceptions. May be nested: an inner one writes no control register where
/// FloatingPointControl knows it set.
class RoundUpward : public RoundingScope {
 public:
  FCL_ARTIC_INLINE RoundUpward() : RoundingScope(FloatingPointControl::Rounding::upward) {}
  FCL_ARTIC_INLINE ~RoundUpward() {}  // inlined even where nothing is optimised: no copy for the linker to pick
};

/// The usual mode, for code of others that is called meanwhile.
class RoundToNearest : public RoundingScope {
 public:
  FCL_ARTIC_INLINE RoundToNearest() : RoundingScope(FloatingPointControl::Rounding::nearest) {}
  FCL_ARTIC_INLINE ~RoundToNearest() {}
};

/// True if a probe of every operation under RoundUpward rounds upward: not so on a machine, an emulator or under a tool
/// that ignores rounding modes (valgrind does). Costs a microsecond; the result may be kept.
bool roundingModesWork();

}  // namespace fcl_artic
