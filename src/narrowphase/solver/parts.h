// SPDX-License-Identifier: BSD-3-Clause
//
// The solver's parts, each of which knows only those above it:
//
//   Task             the query at hand, its budget and what it has cost
//   TimeBatch        eight intervals of time: a value
//   SweptFrames      the links' frames over a batch
//   RelativeMotions  two bodies against each other over a batch, handed down as Seen
//   Horizon          the known bounds of the first contact's time, which are kept here alone
//   ContactList      contacts, and the gate through which every proof of contact comes
//   SearchState      these: what all others share
//   PoseProofs, BallProofs   contact at one pose, where any will do
//   Traversal        a pair's node pairs and leaf pairs over a batch
//   Follower         a leaf pair, or two hulls, followed to where they meet
//   ContactWriter    records the contact found there with its t_lower; its point and normal
//   AnyContact       poses at which contact is likely
//   Patches          stage 1 in a large body: the nodes that it leaves
//   StageOne         stage 1: pairs whose swept bounds meet; stage 2: takes out what advisors prove free
//   Containment, InitialContacts   solid meshes within each other, and what is ignored at t = 0
//   PairSearch       the order of the search: by time, then by pair
#pragma once

#include "narrowphase/solver/initial_contacts.h"
#include "narrowphase/solver/pair_search.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// All parts, put together.
struct SolverParts : SearchState {
  PoseProofs proofs{*this};
  BallProofs balls{*this};
  Traversal traversal{*this, proofs};
  Follower follower{*this};
  AnyContact any{*this, balls, proofs, traversal};
  StageOne stage_one{*this, any};
  Containment containment{*this, stage_one};
  InitialContacts initial{*this, traversal, containment};
  PairSearch search{*this, proofs, traversal, follower, any};
  Buffer<Entry> open;  ///< what is not yet decided

  /// A new query: nothing is known, and nothing of the last one is left.
  void begin(const Problem& problem, const Query& query) {
    SearchState::begin(problem, query);
    traversal.begin();
    any.begin();
    containment.begin();
    open.clear();
  }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
