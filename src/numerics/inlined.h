// SPDX-License-Identifier: BSD-3-Clause
//
// For arithmetic that proofs rest on: always inlined, so that no copy of a function, compiled for a wide instruction
// set, is there for the linker to keep for everybody.
#pragma once

#ifdef __FAST_MATH__
#error "fcl_artic proves bounds in floating point: it cannot be compiled with -ffast-math"
#endif

#define FCL_ARTIC_INLINE inline __attribute__((always_inline))
