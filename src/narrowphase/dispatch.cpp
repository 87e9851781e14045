// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#include "narrowphase/engine.h"

namespace fcl_artic {
namespace engine {
namespace {

bool runs(const Engine& engine) {
  if (&engine == &kEngineAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma");
  }
  if (&engine == &kEngineAvx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return true;  // SSE2 is part of x86-64
}

const Engine& chooseEngine() {
  if (const char* asked = std::getenv("FCL_ARTIC_ISA")) {
    if (const Engine* found = engineNamed(asked)) return *found;
  }
  if (runs(kEngineAvx512)) return kEngineAvx512;
  if (runs(kEngineAvx2)) return kEngineAvx2;
  return kEngineSse2;
}

}  // namespace

const Engine* engineNamed(const char* name) {
  for (const Engine* e : {&kEngineSse2, &kEngineAvx2, &kEngineAvx512}) {
    if (std::strcmp(name, e->name) == 0 && runs(*e)) return e;
  }
  return nullptr;
}

const Engine& engine() {
  static const Engine& chosen = chooseEngine();
  return chosen;
}

}  // namespace engine
}  // namespace fcl_artic
