// SPDX-License-Identifier: BSD-3-Clause
// Batches of box tests for one instruction set, chosen at run time by box_batch.cpp.
#define FCL_ARTIC_ISA avx512
#define FCL_ARTIC_ISA_BITS 512
#define FCL_ARTIC_ISA_BATCH kBoxBatchAvx512
#include "interval/interval_lanes.h"

#include "redon/box_batch.inl"
