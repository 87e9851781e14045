// SPDX-License-Identifier: BSD-3-Clause
#include "interval/batch.h"

#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace fcl_artic {
namespace {

bool runs(const IntervalBatch& batch) {
  if (&batch == &kIntervalBatchPortable) return true;
  if (!roundingModesWork()) return false;  // under valgrind, say
  if (&batch == &kIntervalBatchAvx512) return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
  return &batch != &kIntervalBatchAvx2 || __builtin_cpu_supports("avx2");
}

const IntervalBatch& chooseBatch() {
  if (const char* asked = std::getenv("FCL_ARTIC_ISA")) {
    if (const IntervalBatch* found = intervalBatchNamed(asked)) return *found;
  }
  for (const IntervalBatch* b : {&kIntervalBatchAvx512, &kIntervalBatchAvx2, &kIntervalBatchSse2}) {
    if (runs(*b)) return *b;
  }
  return kIntervalBatchPortable;
}

}  // namespace

const IntervalBatch* intervalBatchNamed(const char* name) {
  for (const IntervalBatch* b :
       {&kIntervalBatchPortable, &kIntervalBatchSse2, &kIntervalBatchAvx2, &kIntervalBatchAvx512}) {
    if (std::strcmp(name, b->name) == 0 && runs(*b)) return b;
  }
  return nullptr;
}

const IntervalBatch& intervalBatch() {
  static const IntervalBatch& chosen = chooseBatch();
  return chosen;
}

}  // namespace fcl_artic
