// SPDX-License-Identifier: BSD-3-Clause
//
// Solid meshes. All other parts of the solver prove only that a mesh's surface is apart from the other body. As long as
// it is, neither body can come to lie within the other. So one pose shows whether one body lies within the other all
// that time (doc/NUMERICS.md, "Solid meshes").
#pragma once

#include "narrowphase/solver/stage_one.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

class Containment : PartOfSolver {
 public:
  Containment(SearchState& state, StageOne& stage_one)
      : PartOfSolver(state.task),
        motions_(state.motions),
        horizon_(state.horizon),
        contacts_(state.contacts),
        stage_one_(stage_one) {}

  void begin() { contained_.clear(); }

  /// Finds all pairs of which one body lies within the other at t = 0, or may do.
  void findAtStart();
  /// Whether one body of a pair may lie within the other at time t.
  bool mayBeContained(PairId pair, double t);
  /// Whether the pair is one of those that findAtStart() has found.
  bool isContainedAtStart(PairId pair) const;
  int size() const { return contained_.size(); }
  PairId pair(int i) const { return contained_[i].pair; }
  /// Records the contacts at t = 0 of the pairs found, but for those that are ignored. With Query::every_pair the
  /// entries of these pairs in `open` are closed.
  void report(Buffer<Entry>& open);

 private:
  bool isSolid(const PairParts& bodies) const { return body(bodies.a).space || body(bodies.b).space; }
  engine::ContainmentVerdict contained(PairId pair, double t);
  void testAtStart(PairId pair);

  RelativeMotions& motions_;
  Horizon& horizon_;
  ContactList& contacts_;
  StageOne& stage_one_;
  Buffer<LeafContact> contained_;  ///< at t = 0
};

/// Whether one body of a pair lies within the other at time t; their surfaces may be apart.
[[gnu::noinline]] inline engine::ContainmentVerdict Containment::contained(PairId pair, double t) {
  const Seen seen = motions_.of(pair, TimeBatch::around(t));
  const PairParts bodies = problem().parts(pair);
  const Body &a = body(bodies.a), &b = body(bodies.b);
  engine::PairPose pose;
  const RigidLanes& m = seen->seenFromA();
  laneOf(m.R[0], 0).store(pose.R);
  laneOf(m.c[0], 0).store(pose.c);
  // 4: points are seen both ways, and as far from the frames as both bodies are large (doc/NUMERICS.md).
  pose.error = 4 * (seen->poseError() + m.rem_c + m.rem_R * (a.tree->extent + b.tree->extent));
  ++statistics().contact_proofs;
  engine::ContainmentVerdict found;
  problem().contained(a, b, pose, found);
  FCL_ARTIC_ASSERT(found.verdict >= engine::ContainmentVerdict::kNone &&
                   found.verdict <= engine::ContainmentVerdict::kCertain);
  return found;
}

inline bool Containment::mayBeContained(PairId pair, double t) {
  return problem().contained && isSolid(problem().parts(pair)) &&
         contained(pair, t).verdict != engine::ContainmentVerdict::kNone;
}

inline void Containment::testAtStart(PairId pair) {
  if (!isSolid(problem().parts(pair))) return;
  const engine::ContainmentVerdict found = contained(pair, 0);
  if (found.verdict == engine::ContainmentVerdict::kNone) return;
  LeafContact& contact = contained_.grow() = contactOf(problem(), pair, -1, -1);
  contact.certain = found.verdict == engine::ContainmentVerdict::kCertain;
  contact.t_upper = contact.certain ? 0 : 1;
  contact.feature = engine::kVolume;
  for (int k = 0; k < 3; ++k) {
    contact.point[k] = found.point[k];
    contact.normal[k] = found.normal[k];
  }
}

/// A box that holds a body's surface holds the body. So only pairs whose boxes are apart in the first lane are left
/// out. All others are tested, whatever stage 1, tables or stage 2 prove of their surfaces.
[[gnu::noinline, gnu::cold]] inline void Containment::findAtStart() {
  contained_.clear();
  if (query().check_scene && problem().obstacle_tree) {
    for (int m = 0; m < problem().num_scene_movers; ++m) {
      const Buffer<BoxHit>& met = stage_one_.meetObstacles(m);
      for (int i = 0; i < met.size(); ++i) {
        const PairId pair = problem().scenePair(m, problem().still_bounds[met[i].place].obstacle);
        if (!(met[i].mask & 1) || problem().isAllowed(pair)) continue;
        testAtStart(pair);
      }
    }
  }
  if (query().check_self) {
    for (int p = 0; p < problem().num_link_pairs; ++p) {
      if (problem().isAllowed(problem().linkPair(p))) continue;
      const LinkPair& pair = problem().link_pairs[p];
      if (problem().num_movers && (stage_one_.boxesApart(body(pair.a).mover, body(pair.b).mover) & 1)) continue;
      testAtStart(problem().linkPair(p));
    }
  }
}

inline bool Containment::isContainedAtStart(PairId pair) const {
  for (int i = 0; i < contained_.size(); ++i) {
    if (contained_[i].pair == pair) return true;
  }
  return false;
}

inline void Containment::report(Buffer<Entry>& open) {
  for (int i = 0; i < contained_.size(); ++i) {
    const LeafContact& contact = contained_[i];
    if (contacts_.watchFrom(contact.pair) > 0) continue;
    contacts_.push(contact);
    horizon_.joinLower(0);
    if (query().every_pair) {
      if (contact.certain) horizon_.joinUpper(0);
      for (int j = 0; j < open.size(); ++j) {
        if (open[j].pair == contact.pair) open[j].mask = 0;  // its first contact is known
      }
    } else if (contact.certain) {
      contacts_.takeProof(contact.pair, 0);
    } else {
      horizon_.closeAt(query().tolerance_time);
    }
  }
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
