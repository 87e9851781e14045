// SPDX-License-Identifier: BSD-3-Clause
//
// The processor's floating-point control register, for tests of who changes it. Written here anew, not with the
// library's own (interval/processor_*.h).
#pragma once

#include <cfenv>
#include <cstdint>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace fcl_artic {
namespace numerics_test {

#if defined(__x86_64__)
/// MXCSR without the sticky flags of exceptions.
inline std::uint64_t controlBits() {
  return _mm_getcsr() & ~0x3fu;
}
inline void setControlBits(std::uint64_t bits) {
  _mm_setcsr(static_cast<unsigned>(bits));
}
constexpr std::uint64_t kUsualControl = 0x1f80;
constexpr std::uint64_t kFlushing = 0x8040;  ///< subnormal results are zero, subnormal operands too
#elif defined(__aarch64__)
/// FPCR.
inline std::uint64_t controlBits() {
  std::uint64_t bits;
  asm volatile("mrs %0, fpcr" : "=r"(bits));
  return bits;
}
inline void setControlBits(std::uint64_t bits) {
  asm volatile("msr fpcr, %0" : : "r"(bits) : "memory");
}
constexpr std::uint64_t kUsualControl = 0;
constexpr std::uint64_t kFlushing = 1u << 24;  ///< FZ: subnormal results are zero, subnormal operands too
#else
/// The state that C knows: the rounding mode.
inline std::uint64_t controlBits() {
  return static_cast<std::uint64_t>(std::fegetround());
}
inline void setControlBits(std::uint64_t bits) {
  std::fesetround(static_cast<int>(bits));
}
constexpr std::uint64_t kUsualControl = FE_TONEAREST;
constexpr std::uint64_t kFlushing = 0;
#endif

}  // namespace numerics_test
}  // namespace fcl_artic
