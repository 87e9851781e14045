// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes that are solids. All else proves of a mesh that its surface is apart from the other body; as long as it is,
// neither can come to lie within the other, so that one pose tells whether one does (doc/NUMERICS.md, "Solid meshes").
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Whether one body of a pair, of which the surfaces may well be apart, lies within the other at time t. The batch is
/// another one then.
[[gnu::noinline]] inline void Solver::findContained(int pair, double t, engine::Containment& found) {
  const double tm[kLanes] = {t, t, t, t, t, t, t, t};
  evaluateAt(tm, 0);
  setupPair(pair);
  const PairParts bodies = parts(pair);
  const Body &a = problem_->bodies[bodies.a], &b = problem_->bodies[bodies.b];
  engine::PairPose pose;
  const RigidLanes& m = side_[0].m;
  for (int i = 0; i < 9; ++i) pose.R[i] = m.R[0][i][0];
  for (int i = 0; i < 3; ++i) pose.c[i] = m.c[0][i][0];
  // 4: points are seen both ways, and as far from the frames as both bodies are large (doc/NUMERICS.md).
  pose.error = 4 * (pose_error_ + m.rem_c + m.rem_R * (a.tree->extent + b.tree->extent));
  ++statistics_.contact_proofs;
  problem_->contained(a, b, pose, found);
  FCL_ARTIC_ASSERT(found.verdict >= engine::Containment::kNone && found.verdict <= engine::Containment::kCertain);
}

inline bool Solver::mayBeContained(int pair, double t) {
  const PairParts bodies = parts(pair);
  if (!problem_->contained || !(problem_->bodies[bodies.a].space || problem_->bodies[bodies.b].space)) return false;
  engine::Containment found;
  findContained(pair, t, found);
  return found.verdict != engine::Containment::kNone;
}

/// A pair in which one body lies within the other at t = 0, or may do.
inline void Solver::testAtStart(int pair) {
  const PairParts bodies = parts(pair);
  if (!problem_->bodies[bodies.a].space && !problem_->bodies[bodies.b].space) return;
  engine::Containment found;
  findContained(pair, 0, found);
  if (found.verdict == engine::Containment::kNone) return;
  LeafContact& contact = contained_.grow();
  contact = {};
  contact.pair = pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = contact.piece_b = -1;
  contact.certain = found.verdict == engine::Containment::kCertain;
  contact.t_upper = contact.certain ? 0 : 1;
  contact.feature = engine::kVolume;
  for (int k = 0; k < 3; ++k) {
    contact.point[k] = found.point[k];
    contact.normal[k] = found.normal[k];
  }
}

/// All pairs of which one body is within the other at t = 0, to contained_. What holds a body's surface in a box holds
/// the body: pairs whose boxes are apart in the first lane are left out, and no others, whatever stage 1, tables or
/// stage 2 prove of surfaces.
[[gnu::noinline, gnu::cold]] inline void Solver::findContainedAtStart() {
  contained_.clear();
  const auto boxesMeet = [](const SweptBox& a, const SweptBox& b) {
    FloatLanes out = greater(a.lo[0], b.hi[0]) | greater(b.lo[0], a.hi[0]);
    for (int k = 1; k < 3; ++k) out = out | greater(a.lo[k], b.hi[k]) | greater(b.lo[k], a.hi[k]);
    return !(lanesOf(out) & 1);
  };
  if (query_->check_scene && problem_->obstacle_tree) {
    for (int m = 0; m < problem_->num_scene_movers; ++m) {
      meetObstacles(mover_box_[m]);
      for (int i = 0; i < met_.size(); ++i) {
        const int pair = m * problem_->num_obstacles + met_[i].obstacle;
        if (!(met_[i].mask & 1) || (problem_->scene_allowed && problem_->scene_allowed[pair])) continue;
        testAtStart(pair);
      }
    }
  }
  if (query_->check_self) {
    for (int p = 0; p < problem_->num_link_pairs; ++p) {
      if (linkAllowed(p)) continue;
      const LinkPair& pair = problem_->link_pairs[p];
      if (problem_->num_movers &&
          !boxesMeet(mover_box_[problem_->bodies[pair.a].mover], mover_box_[problem_->bodies[pair.b].mover])) {
        continue;
      }
      testAtStart(problem_->num_scene_pairs + p);
    }
  }
  beginBatch(0, 1);
}

inline bool Solver::isContained(int pair) const {
  for (int i = 0; i < contained_.size(); ++i) {
    if (contained_[i].pair == pair) return true;
  }
  return false;
}

/// What lies within another body at t = 0 is in contact there, but for the initial contacts that are ignored.
inline void Solver::reportContained() {
  for (int i = 0; i < contained_.size(); ++i) {
    const LeafContact& contact = contained_[i];
    if (watchFrom(contact.pair) > 0) continue;
    contacts_.push(contact);
    engine::joinLower(found_, 0);
    if (query_->every_pair) {
      if (contact.certain) engine::joinUpper(found_, 0);
      for (int j = 0; j < entries_.size(); ++j) {
        if (entries_[j].pair == contact.pair) entries_[j].mask = 0;  // its first contact is known
      }
    } else if (contact.certain) {
      takeProof(contact.pair, 0);
    } else {
      limit_ = min(limit_, query_->tolerance_time);
    }
  }
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
