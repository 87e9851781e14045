// SPDX-License-Identifier: BSD-3-Clause
//
// For code that is compiled once, with the instructions that every processor has: include this first, then what is
// compiled per instruction set elsewhere (numerics/lanes.h). Its names are in the namespace `baseline`.
#pragma once

#if defined(__x86_64__) && !defined(FCL_ARTIC_PORTABLE)
#define FCL_ARTIC_ISA sse2
#define FCL_ARTIC_ISA_BITS 128
#elif defined(__aarch64__) && !defined(FCL_ARTIC_PORTABLE)
#define FCL_ARTIC_ISA neon
#define FCL_ARTIC_ISA_BITS 128
#else
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_BITS 0
#endif

namespace fcl_artic {
namespace FCL_ARTIC_ISA {}
namespace baseline = FCL_ARTIC_ISA;
}  // namespace fcl_artic
