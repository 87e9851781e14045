// SPDX-License-Identifier: BSD-3-Clause
// Batches of intervals in plain C++, which need no rounding mode.
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_BATCH kIntervalBatchPortable
#include "interval/inflated.h"

#include "interval/batch.inl"
