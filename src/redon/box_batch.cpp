// SPDX-License-Identifier: BSD-3-Clause
#include "redon/box_batch.h"

#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace fcl_artic {
namespace redon {
namespace {

bool runs(const BoxBatch& batch) {
  if (&batch == &kBoxBatchPortable) return true;
  if (!roundingModesWork()) return false;  // under valgrind, say
  if (&batch == &kBoxBatchAvx512) return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
  return &batch != &kBoxBatchAvx2 || __builtin_cpu_supports("avx2");
}

const BoxBatch& chooseBatch() {
  if (const char* asked = std::getenv("FCL_ARTIC_ISA")) {
    if (const BoxBatch* found = boxBatchNamed(asked)) return *found;
  }
  for (const BoxBatch* b : {&kBoxBatchAvx512, &kBoxBatchAvx2, &kBoxBatchSse2}) {
    if (runs(*b)) return *b;
  }
  return kBoxBatchPortable;
}

}  // namespace

const BoxBatch* boxBatchNamed(const char* name) {
  for (const BoxBatch* b : {&kBoxBatchPortable, &kBoxBatchSse2, &kBoxBatchAvx2, &kBoxBatchAvx512}) {
    if (std::strcmp(name, b->name) == 0 && runs(*b)) return b;
  }
  return nullptr;
}

const BoxBatch& boxBatch() {
  static const BoxBatch& chosen = chooseBatch();
  return chosen;
}

}  // namespace redon
}  // namespace fcl_artic
