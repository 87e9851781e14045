// SPDX-License-Identifier: BSD-3-Clause
//
// The engine as compiled for each instruction set, and the choice among them.
#pragma once

#include "model/answer.h"
#include "model/query.h"

namespace fcl_artic {
namespace engine {

/// The engine as compiled for one instruction set.
struct Engine {
  const char* name;
  void* (*createWorkspace)();
  void (*destroyWorkspace)(void* workspace);
  /// One workspace serves one thread at a time; nothing in it reaches the next answer.
  void (*solve)(void* workspace, const Problem& problem, const Query& query, Answer& answer);
  /// Motion of a pair of the problem that this workspace solved last; problem and query must still be there.
  void (*pairMotion)(void* workspace, PairId pair, double tm, double d, PairMotion& motion);
};

/// The widest engine that this processor runs; FCL_ARTIC_ISA in the environment asks for another by its name.
const Engine& engine();

/// A build has those of them that numerics/instruction_sets.h lists.
extern const Engine kEnginePortable, kEngineSse2, kEngineAvx2, kEngineAvx512, kEngineNeon;

}  // namespace engine
}  // namespace fcl_artic
