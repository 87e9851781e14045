// SPDX-License-Identifier: BSD-3-Clause
//
// Records a contact that the search has found, with its point and normal. Times are the candidate's; here they are
// recorded.
#pragma once

#include "narrowphase/solver/follower.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

class ContactWriter : PartOfSolver {
 public:
  explicit ContactWriter(SearchState& state)
      : PartOfSolver(state.task), motions_(state.motions), horizon_(state.horizon), contacts_(state.contacts) {}

  /// Makes a new contact of a candidate whose gap is closed, with the candidate's t_lower.
  void record(Candidate& f);

 private:
  void lookBack(Candidate& f);
  void turnToSide(Candidate& f, const DifferenceBody& body);
  Vec3 pointBetween(Candidate& f, const DifferenceBody& body);

  RelativeMotions& motions_;
  Horizon& horizon_;
  ContactList& contacts_;
};

/// For a pair that was never seen apart, since it touches where its window begins: looks for a normal at earlier times,
/// ever farther back.
inline void ContactWriter::lookBack(Candidate& f) {
  TimeBatch poses = {};
  double step = query().tolerance_time;
  for (int k = 0; k < kLanes; ++k) {
    poses.setPose(k, max(0.0, f.t_lower - step));
    step *= 4;
  }
  const Seen seen = motions_.of(f.entry.pair, poses);
  const PiecePair pieces = piecesOf(f, seen);
  const Piece &a = pieces.a, &b = pieces.b;
  for (int k = 0; k < kLanes && !f.have_normal; ++k) {
    const DifferenceBody body = seen->differenceAt(a, b, k);
    GjkResult g;
    gjk(body, body.pose.c, {1e-7, a.radius + b.radius + seen->margin(), 64}, g);
    ++statistics().gjk;
    if (g.overlap) continue;
    f.normal = g.n;
    f.have_normal = true;
  }
}

/// A wall, a plane, has two sides: the normal is that of the one from which the other body came, or on which more of it
/// is.
inline void ContactWriter::turnToSide(Candidate& f, const DifferenceBody& body) {
  GjkResult nearer;
  unboundedGap(body, 0, nearer);
  f.normal = f.have_normal && dot(nearer.n, f.normal) < 0 ? -nearer.n : nearer.n;
  f.have_normal = true;
}

/// The point of a contact that is not proven: midway between the surfaces, or, beside a wall, the other piece's point
/// that is nearest to it.
inline Vec3 ContactWriter::pointBetween(Candidate& f, const DifferenceBody& body) {
  const Piece &a = *body.a, &b = *body.b;
  GjkResult g;
  gjk<true>(body, f.have_normal ? f.normal : body.pose.c, {1e-7, 0, 64}, g);
  originWeights(g.simplex);
  if (!f.have_normal && !g.overlap) {
    f.normal = g.n;
    f.have_normal = true;
  }
  if (unbounded(a) || unbounded(b)) {
    DifferencePoint lowest;
    body.support(f.normal, lowest);
    return unbounded(a) ? body.place(lowest.b) - f.normal * b.radius : lowest.a + f.normal * a.radius;
  }
  // The cores' nearest points, each moved out by its radius.
  const double out = f.have_normal ? 0.5 * (a.radius - b.radius) : 0;
  Vec3 x, y;
  combine(body, g.simplex, x, y);
  return f.normal * out + (x + y) * 0.5;
}

inline void ContactWriter::record(Candidate& f) {
  FCL_ARTIC_ASSERT(f.t_lower >= 0 && f.t_lower <= 1);
  if (!f.have_normal && f.t_lower > 0) lookBack(f);
  LeafContact& contact = contacts_.grow(f.entry.pair, f.piece_a, f.piece_b);
  contact.t_lower = f.t_lower;
  contact.certain = f.certain;
  contact.t_upper = f.certain ? f.t_upper : 1;
  contact.t = f.certain ? f.t_upper : f.t_lower;
  horizon_.joinLower(f.t_lower);
  const PairParts parts = problem().parts(f.entry.pair);
  const PiecePair pieces(*body(parts.a).tree, f.piece_a, *body(parts.b).tree, f.piece_b);
  const Piece &a = pieces.a, &b = pieces.b;
  const bool wall = unbounded(a) || unbounded(b);
  if (f.certain && f.have_normal && !wall) {
    f.point.store(contact.point);
    f.normal.store(contact.normal);
    return;
  }
  // Point and normal that are still missing are found at t_lower; a wall's normal is found at the time that is
  // reported.
  const Seen seen = motions_.of(f.entry.pair, TimeBatch::around(wall ? contact.t : f.t_lower));
  const DifferenceBody body = seen->differenceAt(a, b, 0);
  if (wall) turnToSide(f, body);
  const Vec3 point = f.certain ? f.point : pointBetween(f, body);
  if (!f.have_normal) {
    // In contact from the start: the direction between the pieces' middles.
    NodeRoom room_a, room_b;
    const Vec3 x = middleOf(nodeOf(seen->a(), f.entry.a, room_a)), y = middleOf(nodeOf(seen->b(), f.entry.b, room_b));
    f.normal = unitOrZ(body.place(y) - x);
  }
  point.store(contact.point);
  f.normal.store(contact.normal);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
