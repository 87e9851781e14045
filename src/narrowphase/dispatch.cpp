// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "narrowphase/engine.h"

namespace fcl_artic {
namespace engine {
namespace {

// The widest first; the last one runs everywhere.
#ifdef __x86_64__
const Engine* const kEngines[] = {&kEngineAvx512, &kEngineAvx2, &kEngineSse2};

bool runs(const Engine& engine) {
  if (&engine == &kEngineAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma");
  }
  if (&engine == &kEngineAvx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return true;  // SSE2 is part of x86-64
}
#else
const Engine* const kEngines[] = {&kEnginePortable};

bool runs(const Engine&) {
  return true;
}
#endif

const Engine& chooseEngine() {
  if (const char* asked = std::getenv("FCL_ARTIC_ISA")) {
    if (const Engine* found = engineNamed(asked)) return *found;
  }
  for (const Engine* engine : kEngines) {  // the widest first
    if (runs(*engine)) return *engine;
  }
  return *kEngines[std::size(kEngines) - 1];
}

}  // namespace

const Engine* engineNamed(const char* name) {
  for (const Engine* e : kEngines) {
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
