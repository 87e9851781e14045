// SPDX-License-Identifier: BSD-3-Clause
#include <new>

#include "narrowphase/engine.h"
#include "narrowphase/solver.h"

#define FCL_ARTIC_STRING2(x) #x
#define FCL_ARTIC_STRING(x) FCL_ARTIC_STRING2(x)

namespace fcl_artic {
namespace FCL_ARTIC_ISA {
namespace {

void* createWorkspace() {
  void* memory =
      std::aligned_alloc(alignof(Solver), (sizeof(Solver) + alignof(Solver) - 1) / alignof(Solver) * alignof(Solver));
  if (!memory) std::abort();
  return ::new (memory) Solver();
}

void destroyWorkspace(void* workspace) {
  static_cast<Solver*>(workspace)->~Solver();
  std::free(workspace);
}

void solve(void* workspace, const Problem& problem, const Query& query, Answer& answer) {
  static_cast<Solver*>(workspace)->solve(problem, query, answer);
}

void pairMotion(void* workspace, PairId pair, double tm, double d, engine::PairMotion& motion) {
  static_cast<Solver*>(workspace)->pairMotion(pair, tm, d, motion);
}

}  // namespace
}  // namespace FCL_ARTIC_ISA

namespace engine {
const Engine FCL_ARTIC_ISA_ENGINE = {FCL_ARTIC_STRING(FCL_ARTIC_ISA), &FCL_ARTIC_ISA::createWorkspace,
                                     &FCL_ARTIC_ISA::destroyWorkspace, &FCL_ARTIC_ISA::solve,
                                     &FCL_ARTIC_ISA::pairMotion};
}  // namespace engine
}  // namespace fcl_artic
