// SPDX-License-Identifier: BSD-3-Clause
//
// The solver's parts, each of which knows only those above it:
//
//   Task             the query at hand, its budget and what it has cost
//   TimeBatch        eight intervals of time: a value
//   SweptFrames      the links' frames over a batch
//   RelativeMotion   two bodies against each other over a batch
//   Horizon          when the first contact is, as far as known: the only writer of these times
//   ContactList      contacts, and the gate through which every proof of contact comes
//   PoseProofs, BallProofs   contact at one pose, where any will do
//   Traversal        a pair's node pairs and leaf pairs over a batch
//   Follower         a leaf pair, or two hulls, followed to where they meet
//   AnyContact       poses at which contact is likely
//   StageOne         pairs whose swept bounds meet; and what advisors prove free of them
//   Containment, InitialContacts   solid meshes within each other, and what is ignored at t = 0
//   PairSearch       the order of the search: by time, then by pair
#pragma once

#include "narrowphase/solver/initial_contacts.h"
#include "narrowphase/solver/pair_search.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// All parts, put together.
struct SolverParts {
  Task task;
  SweptFrames frames{task};
  RelativeMotion motion{task, frames};
  Horizon horizon{task};
  ContactList contacts{task, horizon};
  PoseProofs proofs{task, motion, contacts};
  BallProofs balls{task, frames, contacts};
  Traversal traversal{task, motion, horizon, contacts, proofs};
  Follower follower{task, motion, horizon, contacts};
  AnyContact any{task, frames, motion, horizon, balls, proofs, traversal};
  StageOne stage_one{task, frames, motion, horizon, contacts, any};
  Containment containment{task, motion, horizon, contacts, stage_one};
  InitialContacts initial{task, motion, horizon, contacts, traversal, containment};
  PairSearch search{task, motion, horizon, contacts, traversal, follower, any};
  Buffer<Entry> open;  ///< what is not yet decided

  /// A new query: nothing is known, and nothing of the last one is left.
  void begin(const Problem& problem, const Query& query) {
    task.begin(problem, query);
    frames.begin();
    motion.begin();
    horizon.begin();
    contacts.begin();
    traversal.begin();
    any.begin();
    containment.begin();
    open.clear();
  }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
