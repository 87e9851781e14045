// SPDX-License-Identifier: BSD-3-Clause
// Batches of box tests in plain C++, which need no rounding mode.
#define FCL_ARTIC_ISA portable
#define FCL_ARTIC_ISA_BATCH kBoxBatchPortable
#include "interval/inflated.h"

#include "redon/box_batch.inl"
