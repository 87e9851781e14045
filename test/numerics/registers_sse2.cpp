// SPDX-License-Identifier: BSD-3-Clause
#define FCL_ARTIC_ISA sse2
#define FCL_ARTIC_ISA_BITS 128
#define FCL_ARTIC_ISA_REGISTERS kRegistersSse2
#include "registers.inl"
