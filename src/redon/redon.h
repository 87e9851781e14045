// SPDX-License-Identifier: BSD-3-Clause
//
// The method of the paper (Redon, Kim, Lin, Manocha 2004) on the engine's own problem, query and answer
// (doc/REDON2004.md).
#pragma once

#include <functional>
#include <memory>

#include "geometry/obb_tree.h"
#include "narrowphase/engine_workspace.h"
#include "redon/options.h"

namespace fcl_artic {
namespace redon {

/// Memory of one query at a time. Nothing in it reaches the next answer.
class Workspace {
 public:
  Workspace();
  ~Workspace();
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Answers as engine::Engine::solve does. Pairs that the paper has no method for are left to the engine:
/// - pairs with curved or unbounded pieces,
/// - pairs with a margin or one of their own,
/// - pairs with a motion known by bounds only,
/// - whatever touches at t = 0.
///
/// Stage 2 (engine::Advisor::clear) is asked once for the paper's pairs, and by the engine for its own.
/// @param engine  its workspace. Contacts that it finds have no `feature`.
/// @param treeOf  a body's tree of oriented boxes, null where it has none.
/// @param[out] counts  work; the answer's own statistics count what the engine did.
void solve(Workspace& workspace, engine::EngineWorkspace& engine, const engine::Problem& problem,
           const engine::Query& query, const Options& options,
           const std::function<const ObbTree*(std::int32_t body)>& treeOf, engine::Answer& answer, Counts& counts);

}  // namespace redon
}  // namespace fcl_artic
