// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_ARITHMETIC kArithmeticPortable
#define FCL_ARTIC_ARITHMETIC_DIRECTED false
#define FCL_ARTIC_ARITHMETIC_LOWER(x) (x)
#include "interval/inflated.h"

#include "arithmetic.inl"
