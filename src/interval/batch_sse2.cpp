// SPDX-License-Identifier: BSD-3-Clause
// Batches of intervals for one instruction set, chosen at run time by batch.cpp.
#define FCL_ARTIC_ISA sse2
#define FCL_ARTIC_ISA_BITS 128
#define FCL_ARTIC_ISA_BATCH kIntervalBatchSse2
#include "interval/interval_lanes.h"

#include "interval/batch.inl"
