// SPDX-License-Identifier: BSD-3-Clause
//
// Shared by all queries on their way to the engine and back: memory, the request, statistics, the order of contacts.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "geometry/shape_tree.h"
#include "model/bracket.h"
#include "motion/frame_sweep.h"
#include "narrowphase/engine_workspace.h"
#include "redon/redon.h"

namespace fcl_artic {

/// Memory that one query uses at a time. No answer depends on what earlier queries have left in it.
class QueryWorkspace {
 public:
  engine::EngineWorkspace engine;
  redon::Workspace& redon() {
    if (!redon_) redon_ = std::make_unique<redon::Workspace>();
    return *redon_;
  }
  engine::Body bodies[2];                      ///< of a pair query: only their trees are set
  FrameSweep sweep;                            ///< of a pair query
  std::vector<double> coefficients;            ///< of its variables
  std::vector<std::uint8_t> link_free;         ///< of a manager's query: link pairs that are proven apart
  std::vector<engine::LikelyContact> likely;   ///< of a manager's query
  std::vector<std::uint8_t> scene_allowed;     ///< of a manager's query: with pairs that are left out
  std::vector<std::uint8_t> link_allowed;      ///< likewise
  std::vector<engine::BoundedSource> sources;  ///< of a query's bounded motions

 private:
  friend class WorkspaceLoan;
  std::unique_ptr<redon::Workspace> redon_;
  bool busy_ = false;
};

/// A workspace for one query: the thread's own, shared by all managers; another one while that is busy (a query from
/// within a progress callback).
class WorkspaceLoan {
 public:
  WorkspaceLoan();
  ~WorkspaceLoan() { workspace_->busy_ = false; }
  WorkspaceLoan(const WorkspaceLoan&) = delete;
  WorkspaceLoan& operator=(const WorkspaceLoan&) = delete;
  QueryWorkspace& operator*() const { return *workspace_; }
  QueryWorkspace* operator->() const { return workspace_; }

 private:
  std::unique_ptr<QueryWorkspace> other_;
  QueryWorkspace* workspace_;
};

/// The margins that a request asks for, for pairs that have none of their own. No other function reads a request's
/// margins.
/// @throws std::invalid_argument for a margin that is negative or not finite, or when their sum is not finite.
engine::Margins marginsOf(const Tolerances& request);

/// The request as the engine takes it, without the motion, the scope and the pairs' own margins.
/// @throws std::invalid_argument for a tolerance or margin that is negative or not finite.
engine::Query makeQuery(const CertifiedPairRequest& request);

QueryStatistics statisticsOf(const engine::Statistics& statistics);
/// Adds one query's work to a sum: all but the counts of pairs and the total time, which the caller sets itself.
void addWork(const QueryStatistics& s, QueryStatistics& sum);
/// The part of a query's work that a work budget counts.
std::uint64_t countedWork(const QueryStatistics& s);

/// Sorts a manager's contacts by t_lower, and keeps of every two bodies the first one. (A link may have several
/// geometries, so two bodies may have several contacts.)
/// @param certain  the answer's. If true, the contact that is proven first comes before all others, whatever its
/// t_lower.
void keepFirstOfEachPair(bool certain, std::vector<CertifiedContact>& contacts);

}  // namespace fcl_artic
