// SPDX-License-Identifier: BSD-3-Clause
// The engine for one instruction set, chosen at run time by dispatch.cpp.
#define FCL_ARTIC_ISA avx2
#define FCL_ARTIC_ISA_BITS 256
#define FCL_ARTIC_ISA_ENGINE kEngineAvx2
#include "narrowphase/engine.h"
#include "narrowphase/engine.inl"
