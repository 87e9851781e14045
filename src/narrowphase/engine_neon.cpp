// SPDX-License-Identifier: BSD-3-Clause
// The engine for one instruction set, chosen at run time by dispatch.cpp.
#define FCL_ARTIC_ISA neon
#define FCL_ARTIC_ISA_BITS 128
#define FCL_ARTIC_ISA_ENGINE kEngineNeon
#include "narrowphase/engine.h"
#include "narrowphase/engine.inl"
