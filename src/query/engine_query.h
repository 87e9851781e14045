// SPDX-License-Identifier: BSD-3-Clause
//
// What all queries share on their way to the engine and back: memory, request, statistics, contacts of triangles.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "geometry/shape_tree.h"
#include "motion/frame_sweep.h"
#include "narrowphase/bracket.h"
#include "narrowphase/problem.h"
#include "redon/redon.h"

namespace fcl_artic {

/// Memory of one query at a time. Nothing in it reaches the next answer.
class Workspace {
 public:
  Workspace() : engine_(engine::engine().createWorkspace()) {}
  ~Workspace() { engine::engine().destroyWorkspace(engine_); }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  void* engine() const { return engine_; }
  redon::Workspace& redon() {
    if (!redon_) redon_ = std::make_unique<redon::Workspace>();
    return *redon_;
  }
  engine::Body bodies[2];                      ///< of a pair query: their trees, all else as it is at first
  FrameSweep sweep;                            ///< of a pair query
  std::vector<double> coefficients;            ///< of its variables
  std::vector<std::uint8_t> link_free;         ///< of a manager's query: what tables say of link pairs
  std::vector<engine::LikelyContact> likely;   ///< the same
  std::vector<engine::BoundedSource> sources;  ///< of its bounded motions

 private:
  friend class WorkspaceLoan;
  void* engine_;
  std::unique_ptr<redon::Workspace> redon_;
  bool busy_ = false;
};

/// A workspace for one query: the thread's own, shared by all managers; another one while that is busy (a query from within
/// a progress callback).
class WorkspaceLoan {
 public:
  WorkspaceLoan();
  ~WorkspaceLoan() { workspace_->busy_ = false; }
  WorkspaceLoan(const WorkspaceLoan&) = delete;
  WorkspaceLoan& operator=(const WorkspaceLoan&) = delete;
  Workspace& operator*() const { return *workspace_; }
  Workspace* operator->() const { return workspace_; }

 private:
  std::unique_ptr<Workspace> other_;
  Workspace* workspace_;
};

/// The margins that a request asks for; of pairs that have none of their own. Nothing else reads a request's margins.
/// @throws std::invalid_argument for a margin that is negative or not finite, or when their sum is not finite.
engine::Margins marginsOf(const CertifiedRequest& request);

/// The request as the engine takes it, without the motion and the pairs' own margins.
/// @throws std::invalid_argument for a tolerance or margin that is negative or not finite.
engine::Query makeQuery(const CertifiedRequest& request);

Status statusOf(engine::Verdict verdict);
QueryStatistics statisticsOf(const engine::Statistics& statistics);
/// Adds one query's work to a sum: all but the counts of pairs and the total time, which the asker knows better.
void addWork(const QueryStatistics& s, QueryStatistics& sum);
void addWork(const RedonStatistics& s, RedonStatistics& sum);

/// FCL's own id of a piece, as in Contact::b1: a mesh's triangle, an OcTree's cell (OcTree::getNodeByQueryCellId), -1 for
/// a shape.
/// @param geometry  that the tree was read from; null where FCL's double type is not at hand.
std::intptr_t primitiveId(const fcl::CollisionGeometryd* geometry, const ShapeTree& shape, std::int32_t piece);

/// What the equations of single contacts have proven beyond the solver is taken into the result's bracket.
/// @param every_pair  else contacts that are now proven to be later than another one are left out, and the others put in
///   order: proven ones by their t_upper, then the rest.
template <class Result>
void sharpenBracket(const CertifiedRequest& request, bool every_pair, Result& result) {
  std::vector<CertifiedContact>& contacts = result.contacts;
  for (const CertifiedContact& contact : contacts) {
    if (!contact.certain || contact.t_upper >= result.t_upper) continue;
    result.t_upper = contact.t_upper;
    const engine::Bracket bracket = {result.t_lower, result.t_upper};
    const bool any = request.mode == ContactMode::any;
    result.certain = result.certain || engine::isCertain(bracket, request.tolerance_time, any);
  }
  if (every_pair || contacts.size() < 2) return;
  const auto later = [&](const CertifiedContact& contact) { return contact.t_lower > result.t_upper; };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), later), contacts.end());
  std::stable_sort(contacts.begin(), contacts.end(), [](const CertifiedContact& a, const CertifiedContact& b) {
    if (a.certain != b.certain) return a.certain;
    return a.certain ? a.t_upper < b.t_upper : a.t_lower < b.t_lower;
  });
}

/// Puts contacts in the order of their t_lower and leaves `most` of them: the first one of every pair before any pair's
/// second, and of these the earliest.
/// @param pairs  of each contact; those of one pair in the order in which they are wanted.
void keepEarliest(std::size_t most, const std::vector<std::int32_t>& pairs, std::vector<CertifiedContact>& contacts);

/// Names the features of a contact of two triangles and sharpens it (Redon 2004, eqs. 13, 14 and 18). The verdict stays
/// the solver's.
void refineContact(void* engine_workspace, const engine::TreeView& a, const engine::TreeView& b, double tolerance_time,
                   engine::LeafContact& leaf, FeatureKind& feature);

}  // namespace fcl_artic
