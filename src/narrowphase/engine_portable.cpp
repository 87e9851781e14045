// SPDX-License-Identifier: BSD-3-Clause
// The engine without any processor's own instructions, chosen at run time by dispatch.cpp.
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_BITS 0
#define FCL_ARTIC_ISA_ENGINE kEnginePortable
#include "narrowphase/engine.h"
#include "narrowphase/engine.inl"
