// SPDX-License-Identifier: BSD-3-Clause
//
// The continuous overlap test (redon/overlap.h) for several pairs of boxes at once: intervals side by side in vector
// registers, compiled once per instruction set and picked at run time. All but "portable" do what the test does,
// operation by operation; "portable" needs no rounding mode, and what it separates is apart. Callers need no
// RoundUpward: each call sees to it.
#pragma once

#include "geometry/obb_tree.h"
#include "interval/matrix.h"

namespace fcl_artic {
namespace redon {

struct BoxBatch {
  static constexpr int kPairs = 8;
  const char* name;
  int fewest;  ///< pairs from which on this beats the test one by one; 1 for what is there where that one can't run
  /// Box b[k] is carried by M in the frame of box a[k].
  /// @param n  pairs, 1 to kPairs.
  /// @return bit k: the boxes of pair k are apart at every time.
  unsigned (*apart)(const IntervalTransform& M, const ObbNode* const* a, const ObbNode* const* b, int n);
};

/// The widest that this processor runs; FCL_ARTIC_ISA in the environment asks for another by its name.
const BoxBatch& boxBatch();
/// The one of that name (numerics/instruction_sets.h); null where the build has none or the processor does not run it.
const BoxBatch* boxBatchNamed(const char* name);

/// A build has those of them that numerics/instruction_sets.h lists.
extern const BoxBatch kBoxBatchPortable, kBoxBatchSse2, kBoxBatchAvx2, kBoxBatchAvx512, kBoxBatchNeon;

}  // namespace redon
}  // namespace fcl_artic
