// SPDX-License-Identifier: BSD-3-Clause
// The engine for one instruction set, chosen at run time by dispatch.cpp.
#define FCL_ARTIC_ISA avx512
#define FCL_ARTIC_ISA_BITS 512
#define FCL_ARTIC_ISA_ENGINE kEngineAvx512
#include "narrowphase/engine.h"
#include "narrowphase/engine.inl"
