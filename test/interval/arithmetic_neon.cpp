// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA neon
#define FCL_ARTIC_ISA_BITS 128
#define FCL_ARTIC_ISA_ARITHMETIC kArithmeticNeon
#define FCL_ARTIC_ARITHMETIC_DIRECTED true
#define FCL_ARTIC_ARITHMETIC_LOWER(x) (-(x))
#include "interval/interval_lanes.h"

#include "arithmetic.inl"
