// SPDX-License-Identifier: BSD-3-Clause
//
// For code that is compiled once, with the instructions that every processor has: include this first, then what is
// compiled per instruction set elsewhere (numerics/lanes.h).
#pragma once

#define FCL_ARTIC_ISA sse2
#define FCL_ARTIC_ISA_BITS 128
