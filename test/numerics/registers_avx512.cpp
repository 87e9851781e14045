// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA avx512
#define FCL_ARTIC_ISA_BITS 512
#define FCL_ARTIC_ISA_REGISTERS kRegistersAvx512
#include "registers.inl"
