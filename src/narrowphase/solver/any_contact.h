// SPDX-License-Identifier: BSD-3-Clause
//
// Where any contact will do: proofs at poses on the way, before anything is followed.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// The contact proven at a lane's middle that ends the search. Point and normal are left to the caller.
inline LeafContact& Solver::proven(int pair, int piece_a, int piece_b, int lane) {
  const PairParts bodies = parts(pair);
  LeafContact& contact = contacts_.grow();
  contact = {};
  contact.pair = pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = piece_a;
  contact.piece_b = piece_b;
  contact.certain = true;
  contact.t = contact.t_upper = t_upper_ = limit_ = tm_at_[lane];
  updateLive();
  return contact;
}

/// Contact of two leaves at a lane's middle, where any contact is asked for.
inline bool Solver::proveLeaves(int pair, int piece_a, int piece_b, int lane) {
  const Piece &a = side_[0].still->pieces[piece_a], &b = side_[0].moving->pieces[piece_b];
  const DifferenceBody body = differenceAt(a, b, lane);
  ++statistics_.contact_proofs;
  const double* start = have_witness_ ? witness_ : body.pose.c;
  double point[3];
  if (!certainlyTouching(body, margin_, pose_error_, start, point)) return false;
  LeafContact& contact = proven(pair, piece_a, piece_b, lane);
  const double size = norm(start);
  for (int k = 0; k < 3; ++k) {
    contact.point[k] = point[k];
    contact.normal[k] = size > 0 ? start[k] / size : (k == 2);
  }
  return true;
}

/// Where any contact is asked for: the poses in the middles of the lanes in which hulls overlap, pieces and all.
inline bool Solver::proveAnywhere() {
  if (overlapping_.size() == 0) return false;
  const double middles[kLanes] = {0.0625, 0.1875, 0.3125, 0.4375, 0.5625, 0.6875, 0.8125, 0.9375};
  evaluateAt(middles, 0);
  for (int k = 0; k < kLanes; ++k) lane_start_[k] = lane_end_[k] = middles[k];
  claimed_ = 2;
  last_ = true;  // down to the leaves
  updateLive();
  const int roots = entries_.size();
  for (int i = 0; i < overlapping_.size() && !finished(); ++i) {
    const Entry e = overlapping_[i];
    setupPair(e.pair);
    traverse(e.pair, e.a, e.b, e.mask);
    entries_.truncate(roots);
  }
  if (finished()) return true;
  claimed_ = 2;
  beginBatch(0, 1);
  return false;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
