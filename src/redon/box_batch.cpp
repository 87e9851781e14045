// SPDX-License-Identifier: BSD-3-Clause
#include "redon/box_batch.h"

#include "numerics/instruction_sets.h"

namespace fcl_artic {
namespace redon {
namespace {

#define FCL_ARTIC_BATCH(set, Set) &kBoxBatch##Set,
const BoxBatch* const kBatches[] = {FCL_ARTIC_INSTRUCTION_SETS(FCL_ARTIC_BATCH)};
#undef FCL_ARTIC_BATCH

bool runs(const BoxBatch& batch) {
  if (&batch == &kBoxBatchPortable) return true;
  return roundingModesWork() && processorRuns(batch.name);  // not under valgrind, say
}

}  // namespace

const BoxBatch* boxBatchNamed(const char* name) {
  return findNamed(kBatches, name, &runs);
}

const BoxBatch& boxBatch() {
  static const BoxBatch& chosen = chooseWidest(kBatches, &runs);
  return chosen;
}

}  // namespace redon
}  // namespace fcl_artic
