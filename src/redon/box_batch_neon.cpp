// SPDX-License-Identifier: BSD-3-Clause
// Batches of box tests for one instruction set, chosen at run time by box_batch.cpp.
#define FCL_ARTIC_ISA neon
#define FCL_ARTIC_ISA_BITS 128
#define FCL_ARTIC_ISA_BATCH kBoxBatchNeon
#include "interval/interval_lanes.h"

#include "redon/box_batch.inl"
