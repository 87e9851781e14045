// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA avx2
#define FCL_ARTIC_ISA_BITS 256
#define FCL_ARTIC_ISA_REGISTERS kRegistersAvx2
#include "registers.inl"
