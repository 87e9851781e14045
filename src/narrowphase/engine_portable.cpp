// SPDX-License-Identifier: BSD-3-Clause
// The engine for processors other than x86-64, where it is the only one.
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_BITS 0
#define FCL_ARTIC_ISA_ENGINE kEnginePortable
#include "narrowphase/engine.h"
#include "narrowphase/engine.inl"
