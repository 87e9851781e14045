// SPDX-License-Identifier: BSD-3-Clause
//
// Directed rounding on 64-bit ARM: the control register FPCR, the status register FPSR, and operations of NEON that
// read the former. The file interval/rounding.h lists what each does.
#pragma once

#include <cstdint>

#include "interval/rounding_mode.h"
#include "numerics/pair.h"

namespace fcl_artic {

class FloatingPointControl {
 public:
  enum class Rounding : std::uint64_t { nearest = 0, upward = 1u << 22 };  ///< FPCR's field RMode, bits 23 and 22

  static FCL_ARTIC_INLINE FloatingPointControl present() {
    FloatingPointControl o;
    asm volatile("mrs %0, fpcr" : "=r"(o.fpcr_));
    asm volatile("mrs %0, fpsr" : "=r"(o.fpsr_));
    return o;
  }
  FCL_ARTIC_INLINE bool is(Rounding rounding) const { return fpcr_ == static_cast<std::uint64_t>(rounding); }
  /// All else is 0: exceptions trap nowhere, subnormals are kept (FZ, FIZ), NaN keep their bits (DN), and no operation
  /// behaves otherwise than the first processors' (AH, NEP).
  static FCL_ARTIC_INLINE void set(Rounding rounding) {
    asm volatile("msr fpcr, %1" : "+m"(rounding_mode) : "r"(rounding) : "memory");
  }
  FCL_ARTIC_INLINE void restore() const {
    asm volatile("msr fpcr, %1\n\tmsr fpsr, %2" : "+m"(rounding_mode) : "r"(fpcr_), "r"(fpsr_) : "memory");
  }

 private:
  FloatingPointControl() = default;
  std::uint64_t fpcr_, fpsr_;
};

namespace directed {
#define FCL_ARTIC_DIRECTED(name)                                                          \
  FCL_ARTIC_INLINE Pair name(Pair a, Pair b) {                                            \
    Pair o;                                                                               \
    asm("f" #name " %0.2d, %1.2d, %2.2d" : "=w"(o) : "w"(a), "w"(b), "m"(rounding_mode)); \
    return o;                                                                             \
  }
FCL_ARTIC_DIRECTED(add)
FCL_ARTIC_DIRECTED(mul)
FCL_ARTIC_DIRECTED(div)
#undef FCL_ARTIC_DIRECTED
FCL_ARTIC_INLINE Pair sqrt(Pair a) {
  Pair o;
  asm("fsqrt %0.2d, %1.2d" : "=w"(o) : "w"(a), "m"(rounding_mode));
  return o;
}
}  // namespace directed

}  // namespace fcl_artic
