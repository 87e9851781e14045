// SPDX-License-Identifier: BSD-3-Clause
//
// Our own mistakes. A caller's mistake is an exception. An assertion is about what this library takes for granted of
// itself. It ends the program, with the place, in builds with FCL_ARTIC_ASSERTIONS (the presets dev, asan-ubsan, tsan,
// fuzz), and is no code in others.
#pragma once

namespace fcl_artic {

/// Says what does not hold and where, and ends the program.
[[noreturn]] void assertionFailed(const char* condition, const char* file, int line) noexcept;

}  // namespace fcl_artic

#ifdef FCL_ARTIC_ASSERTIONS
#define FCL_ARTIC_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::fcl_artic::assertionFailed(#condition, __FILE__, __LINE__))
#else
#define FCL_ARTIC_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#endif
