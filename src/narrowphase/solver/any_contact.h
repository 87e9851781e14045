// SPDX-License-Identifier: BSD-3-Clause
//
// Where any contact will do: proofs at poses on the way, before anything is followed.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Takes the proof that a pair is in contact at time t, whoever has proven it: all proofs come through here, and
/// nothing else lowers t_upper_.
/// @return false where that contact does not count: it is one to be ignored, or it is not known yet which are.
inline bool Solver::takeProof(int pair, double t) {
  FCL_ARTIC_ASSERT(t >= 0 && t <= 1);
  if (!watching_ || t < watchFrom(pair)) return false;
  t_upper_ = min(t_upper_, t);
  limit_ = min(limit_, t);
  engine::joinUpper(found_, t);
  return true;
}

/// Records a contact proven at a lane's middle, which ends the search. Point and normal are left to the caller.
/// @return null where the contact does not count (takeProof()).
inline LeafContact* Solver::record(int pair, int piece_a, int piece_b, int lane) {
  FCL_ARTIC_ASSERT(lane >= 0 && lane < kLanes);
  if (!takeProof(pair, tm_at_[lane])) return nullptr;
  const PairParts bodies = parts(pair);
  LeafContact& contact = contacts_.grow();
  contact = {};
  contact.pair = pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = piece_a;
  contact.piece_b = piece_b;
  contact.certain = true;
  contact.t_lower = watchFrom(pair);  // what was ignored before is no part of this contact
  contact.t = contact.t_upper = tm_at_[lane];
  engine::joinLower(found_, contact.t_lower);
  updateLive();
  return &contact;
}

/// Two triangles, of which an edge of the one may pierce the other at a lane's middle.
inline bool Solver::proveTriangles(int pair, int piece_a, int piece_b, int lane) {
  const TreeView* trees[2] = {side_[0].still, side_[0].moving};
  const int pieces[2] = {piece_a, piece_b};
  double corners[2][3][3];
  const DifferenceBody body = differenceAt(trees[0]->pieces[piece_a], trees[1]->pieces[piece_b], lane);
  for (int s = 0; s < 2; ++s) {
    const Piece& piece = trees[s]->pieces[pieces[s]];
    if (piece.kind != PieceKind::vertices || piece.num_vertices != 3) return false;
    const double* v = trees[s]->vertices + 3 * static_cast<std::ptrdiff_t>(piece.first_vertex);
    for (int i = 0; i < 3; ++i, v += 3) {
      for (int k = 0; k < 3; ++k) corners[s][i][k] = v[k];
      if (s) body.place(v, corners[s][i]);
    }
  }
  for (int s = 0; s < 2; ++s) {  // edges of this one
    for (int i = 0; i < 3; ++i) {
      double chord[2][3], weights[3], part;
      for (int k = 0; k < 3; ++k) {
        chord[0][k] = corners[s][i][k];
        chord[1][k] = corners[s][i < 2 ? i + 1 : 0][k];
      }
      if (!Probe(chord[0], chord[1]).meets(&corners[1 - s][0][0], weights, part)) continue;
      ++statistics_.contact_proofs;
      if (!certainlyPierces(chord, corners[1 - s], pose_error_, weights, part)) continue;
      LeafContact* const recorded = record(pair, piece_a, piece_b, lane);
      if (!recorded) return false;
      LeafContact& contact = *recorded;
      contact.feature = s ? engine::kFaceEdge : engine::kEdgeFace;
      // The pierced triangle's normal: out of A, or into B.
      const TreeView& pierced = *trees[1 - s];
      const double* flat = pierced.pieces[pieces[1 - s]].size;
      double middle[3], placed[3], inwards = 0;
      middleOf(pierced.nodes[0], middle);
      for (int k = 0; k < 3; ++k) placed[k] = middle[k];
      if (!s) body.place(middle, placed);
      for (int k = 0; k < 3; ++k) {
        contact.point[k] = chord[0][k] + part * (chord[1][k] - chord[0][k]);
        contact.normal[k] = s ? flat[k] : dot(body.pose.R + 3 * k, flat);
        inwards += contact.normal[k] * (placed[k] - contact.point[k]);
      }
      if ((inwards < 0) != (s == 1)) {
        for (double& x : contact.normal) x = -x;
      }
      return true;
    }
  }
  return false;
}

/// Contact of two leaves at a lane's middle, where any contact is asked for.
inline bool Solver::proveLeaves(int pair, int piece_a, int piece_b, int lane) {
  const Piece &a = side_[0].still->pieces[piece_a], &b = side_[0].moving->pieces[piece_b];
  const DifferenceBody body = differenceAt(a, b, lane);
  if (proveTriangles(pair, piece_a, piece_b, lane)) return true;
  ++statistics_.contact_proofs;
  const double* start = have_witness_ ? witness_ : body.pose.c;
  double point[3];
  if (!certainlyTouching(body, margin_, pose_error_, start, point)) return false;
  LeafContact* const recorded = record(pair, piece_a, piece_b, lane);
  if (!recorded) return false;
  LeafContact& contact = *recorded;
  const double size = norm(start);
  for (int k = 0; k < 3; ++k) {
    contact.point[k] = point[k];
    contact.normal[k] = size > 0 ? start[k] / size : (k == 2);
  }
  return true;
}

/// Two bodies' boxes at one pose: nothing rests on what is told of them.
struct BoxesAtPose {
  float R[9], absolute[9], c[3];

  explicit BoxesAtPose(const PoseAt& pose) {
    for (int i = 0; i < 9; ++i) {
      R[i] = static_cast<float>(pose.R[i]);
      absolute[i] = __builtin_fabsf(R[i]);
    }
    for (int k = 0; k < 3; ++k) c[k] = static_cast<float>(pose.c[k]);
  }
  /// Whether no axis of either box tells them apart.
  /// @param[out] nearness  square of their middles' distance, as part of their balls' radii.
  bool meet(const Node& a, const Node& b, float& nearness) const {
    float x[3], of_a[3], of_b[3], y[3];
    for (int k = 0; k < 3; ++k) {
      of_a[k] = 0.5f * (a.hi[k] - a.lo[k]);
      of_b[k] = 0.5f * (b.hi[k] - b.lo[k]);
      y[k] = 0.5f * (b.hi[k] + b.lo[k]);
    }
    bool all = true;
    for (int k = 0; k < 3; ++k) {
      const float *r = R + 3 * k, *e = absolute + 3 * k;
      x[k] = c[k] + r[0] * y[0] + r[1] * y[1] + r[2] * y[2] - 0.5f * (a.hi[k] + a.lo[k]);
      all &= __builtin_fabsf(x[k]) <= of_a[k] + e[0] * of_b[0] + e[1] * of_b[1] + e[2] * of_b[2];
    }
    for (int k = 0; k < 3; ++k) {
      const float z = R[k] * x[0] + R[3 + k] * x[1] + R[6 + k] * x[2];
      all &=
          __builtin_fabsf(z) <= of_b[k] + absolute[k] * of_a[0] + absolute[3 + k] * of_a[1] + absolute[6 + k] * of_a[2];
    }
    const float radii = static_cast<float>(a.radius + b.radius);
    nearness = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) / (radii * radii);
    return all;
  }
};

/// Two links whose line swept spheres meet: balls inside them are tried at the pose at which these are deepest in each
/// other. That pose is put down, and the others at which balls may meet.
inline void Solver::considerPose(int pair, Lanes square, double radii) {
  const double least = minLane(square), distance = sqrt(least) / radii;
  const int lane = __builtin_ctz(kAllLanes & ~greater(square, Lanes(least)));
  const double reach = reachOfBalls(pair);
  unsigned near = reach > 0 ? kAllLanes & ~greater(square, Lanes(reach * reach)) : 0;
  if (near && proveByBalls(pair, lane)) return;
  near &= ~(1u << lane);
  if (near || distance < kDeepLinks) looks_.push({pair, lane, distance, near});
}

/// The triangles of two links at a lane's middle, those in boxes whose middles are near each other first.
inline bool Solver::proveAtPose(int pair, int lane) {
  setupPair(pair);
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  const BoxesAtPose boxes(differenceAt(A.pieces[0], B.pieces[0], lane).pose);
  struct NodePair {
    std::int32_t a, b;
  };
  constexpr int kDeepest = 64;
  NodePair waiting[kDeepest], at = {0, 0};
  int count = 0;
  for (int left = kMostAtPose; left > 0;) {
    const Node &x = A.nodes[at.a], &y = B.nodes[at.b];
    if (x.isLeaf() && y.isLeaf()) {
      if (proveTriangles(pair, x.piece(), y.piece(), lane)) return true;
      --left;
    } else {
      const bool of_a = y.isLeaf() || (!x.isLeaf() && x.radius > y.radius);
      NodePair child[2] = {at, at};
      bool meet[2];
      float nearness[2];
      for (int i = 0; i < 2; ++i) {
        (of_a ? child[i].a : child[i].b) = (of_a ? x : y).child + i;
        meet[i] = boxes.meet(A.nodes[child[i].a], B.nodes[child[i].b], nearness[i]);
      }
      left -= 2;
      statistics_.node_tests += 2;
      const int first = !meet[0] || (meet[1] && nearness[1] < nearness[0]);
      if (meet[first]) {
        if (meet[1 - first] && count < kDeepest) waiting[count++] = child[1 - first];
        at = child[first];
        continue;
      }
    }
    if (!count) return false;
    at = waiting[--count];
  }
  return false;
}

/// Where any contact is asked for: links whose line swept spheres are deep in each other. Balls inside them at all
/// poses at which these may meet; then each pair's triangles at the pose at which they are deepest.
inline bool Solver::proveAtPoses() {
  for (int i = 0; i < looks_.size(); ++i) {
    for (unsigned near = looks_[i].near; near; near &= near - 1) {
      if (proveByBalls(looks_[i].pair, __builtin_ctz(near))) return true;
    }
  }
  for (int done = 0; done < looks_.size(); ++done) {
    int first = done;
    for (int i = done + 1; i < looks_.size(); ++i) {
      if (looks_[i].distance < looks_[first].distance) first = i;
    }
    const Look look = looks_[first];
    looks_[first] = looks_[done];
    if (look.distance < kDeepLinks && proveAtPose(look.pair, look.lane)) return true;
  }
  return false;
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
