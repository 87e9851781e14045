// SPDX-License-Identifier: BSD-3-Clause
//
// The manager inside: what callers gave it (Registry), what is made of that for queries (Setup), and the culler of
// stage 2. manager.cpp forwards changes to them, manager_query.cpp asks and reports.
#pragma once

#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "certificate/certificate.h"
#include "fcl_artic/manager.h"
#include "query/engine_query.h"
#include "query/query_context.h"
#include "setup/neighbour_findings.h"
#include "setup/registry.h"
#include "setup/setup.h"

namespace fcl_artic {

/// Finds out what neighbours do over all values of the joint between them (setup/neighbour_findings.h). It looks at
/// neighbours that the matrix neither allows nor has checked, for the rule; and at those that it allows, for what
/// answers say of them. Earlier findings of the same geometry stay.
std::shared_ptr<const NeighbourFindings> lookAtNeighbours(const Registry& registry);

struct ArticulatedCollisionManager::Impl {
  explicit Impl(std::shared_ptr<const KinematicTree> tree) : registry(std::move(tree)) {}

  /// Makes the set-up anew where that is out of date.
  void use(const Registry::Changes& changes) {
    if (changes.links) setup.robotChanged();
    if (changes.obstacles) setup.obstaclesChanged();
    if (setup.ready() && setup.isOf(*registry.tree())) return;
    if (!setup.robotReady(*registry.tree())) registry.setNeighbours(lookAtNeighbours(registry));
    setup.build(registry);
    world_.reset();
  }

  /// The world that certificates are about; made when first asked for. Safe from several threads.
  std::shared_ptr<const certificate::World> world() const {
    const std::lock_guard<std::mutex> lock(world_mutex_);
    if (!world_) {
      const NamedTolerances& named = registry.tolerances();
      const certificate::WorldTolerances tolerances = {named.straysOf(*registry.tree()).of_joint, named.base(),
                                                       named.ofObjects(), named.speeds()};
      world_ = std::make_shared<const certificate::World>(certificate::makeWorld(registry, tolerances));
    }
    return world_;
  }
  /// Adds a motion that was answered to what a certificate claims.
  /// @param time  the part of the obstacles' time that it takes.
  void appendClaim(const JointMotion& motion, const TimePart& time, const CertifiedRequest& request,
                   const Bracket& answer, const QueryContext::Details& details, certificate::Claim& claim) const;

  /// Notes the pairs whose initial contacts were ignored, and what the context asks for.
  void noteBeside(const engine::Answer& answer, const QueryContext& context, CertifiedResult& result) const;

  /// Adds what an answer has beyond the solver's: its certificate, allowed pairs, no more contacts than asked for.
  /// @param details  of the answer; read where the request asks for a certificate.
  void finishAnswer(const JointMotion& motion, const CertifiedRequest& request, const QueryContext::Details& details,
                    CertifiedResult& result) const;

  /// @throws std::logic_error where what queries read is not up to date.
  void requireReady() const {
    if (setup.ready() && setup.isOf(*registry.tree())) return;
    throw std::logic_error(
        "ArticulatedCollisionManager: call setup() after changing objects, links, margins, allowed pairs or the tree");
  }

  /// Says of pairs that are not checked which ones nothing proves apart for all of these motions
  /// (CertifiedResult::unproven_allowed_pairs and unproven_neighbours).
  void countUnchecked(const JointMotion* const* motions, std::size_t num_motions, const CertifiedRequest& request,
                      bool own_margins, CertifiedResult& result) const {
    engine::Margins margins = marginsOf(request);
    (own_margins ? setup.margins() : setup.marginsOfNeighbours()).putInto(margins);
    const ProvenPairs& proven = setup.proven();
    result.unproven_allowed_pairs = proven.unprovenAllowed(motions, num_motions, setup.variableStrays(1), margins,
                                                           request.check_self, request.check_scene);
    result.unproven_neighbours = request.check_self ? proven.undecidedNeighbours() : nullptr;
  }

  Registry registry;
  Setup setup;
  mutable std::mutex world_mutex_;
  mutable std::shared_ptr<const certificate::World> world_;
  std::shared_ptr<const VisibilityCuller> culler = std::make_shared<VisibilityCuller>();  ///< never null
};

}  // namespace fcl_artic
