// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel of the proofs of "free", compiled with recorded numbers: same files, same text.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "recorded.h"

#define FCL_ARTIC_ISA recorded
#define FCL_ARTIC_ISA_BITS 0
#define double ::recording::Recorded
#define reinterpret_cast ::recording::as
#define __builtin_sqrt ::recording::rootOf    // NOLINT(bugprone-reserved-identifier): what the kernel calls
#define __builtin_fabs ::recording::absolute  // NOLINT(bugprone-reserved-identifier)
#include "motion/chain.h"
#include "narrowphase/certificate.h"
#include "narrowphase/solver/swept_box.h"
#include "narrowphase/solver/swept_lss.h"
#undef double
#undef reinterpret_cast
#undef __builtin_sqrt
#undef __builtin_fabs

namespace kernel = fcl_artic::recorded;
