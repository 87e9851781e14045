// SPDX-License-Identifier: BSD-3-Clause
//
// The engine as the rest of the library calls it.
#pragma once

#include <vector>

#include "narrowphase/engine.h"

namespace fcl_artic {
namespace engine {

/// A workspace of the widest engine. It serves one thread at a time; nothing in it reaches the next answer.
class EngineWorkspace {
 public:
  EngineWorkspace() : engine_(engine()), memory_(engine_.createWorkspace()) {}
  ~EngineWorkspace() { engine_.destroyWorkspace(memory_); }
  EngineWorkspace(const EngineWorkspace&) = delete;
  EngineWorkspace& operator=(const EngineWorkspace&) = delete;

  /// Solves, and completes the contacts (Query::describe_contacts): features by the elementary equations of two
  /// triangles (Redon 2004, eqs. 13, 14 and 18), which sharpen the answer's bracket, then nearest points and speeds.
  void solve(const Problem& problem, const Query& query, Answer& answer);
  /// Nearest points and speed of a contact that another solver has found, of a pair of the problem solved last.
  void addWitness(const Problem& problem, const Query& query, LeafContact& contact) const;

 private:
  PairMotion pairMotion(PairId pair, double tm, double d) const;
  /// The same for a report, with a velocity where the motion tells none.
  PairMotion lookAt(const Problem& problem, PairId pair, double tm, double d) const;
  void nameFeatures(const Problem& problem, const Query& query, LeafContact& contact) const;

  const Engine& engine_;
  void* memory_;
  std::vector<LeafContact> contacts_;  ///< completed
};

}  // namespace engine
}  // namespace fcl_artic
