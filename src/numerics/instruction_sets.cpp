// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/instruction_sets.h"

#include <cstdlib>
#include <cstring>

namespace fcl_artic {

bool sameName(const char* a, const char* b) {
  return std::strcmp(a, b) == 0;
}

const char* instructionSetAsked() {
  return std::getenv("FCL_ARTIC_ISA");
}

bool processorRuns(const char* name) {
#if defined(__x86_64__) && !defined(FCL_ARTIC_PORTABLE)
  if (sameName(name, "avx512")) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma");
  }
  if (sameName(name, "avx2")) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
#define FCL_ARTIC_IS(set, Set) || sameName(name, #set)
  return false FCL_ARTIC_INSTRUCTION_SETS(FCL_ARTIC_IS);  // SSE2 is part of x86-64, NEON of 64-bit ARM
#undef FCL_ARTIC_IS
}

}  // namespace fcl_artic
