// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/instruction_set.h"
#include "narrowphase/engine.h"
#include "numerics/instruction_sets.h"

namespace fcl_artic {
namespace engine {
namespace {

#define FCL_ARTIC_ENGINE(set, Set) &kEngine##Set,
const Engine* const kEngines[] = {FCL_ARTIC_ENGINES(FCL_ARTIC_ENGINE)};
#undef FCL_ARTIC_ENGINE

bool runs(const Engine& engine) {
  return processorRuns(engine.name);
}

}  // namespace

const Engine& engine() {
  static const Engine& chosen = chooseWidest(kEngines, &runs);
  return chosen;
}

}  // namespace engine

const char* instructionSet() {
  return engine::engine().name;
}

}  // namespace fcl_artic
