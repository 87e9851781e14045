// SPDX-License-Identifier: BSD-3-Clause
//
// Where any contact will do: proofs at poses on the way, before anything is followed.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Contact of two leaves at a lane's middle, where any contact is asked for.
inline bool Solver::proveLeaves(int pair, int piece_a, int piece_b, int lane) {
  const Piece &a = side_[0].still->pieces[piece_a], &b = side_[0].moving->pieces[piece_b];
  const DifferenceBody body = differenceAt(a, b, lane);
  LeafContact contact = {};
  ++statistics_.contact_proofs;
  const double* start = have_witness_ ? witness_ : body.pose.c;
  if (!certainlyTouching(body, margin_, pose_error_, start, contact.point)) return false;
  const PairParts bodies = parts(pair);
  contact.pair = pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = piece_a;
  contact.piece_b = piece_b;
  contact.certain = true;
  contact.t = contact.t_upper = tm_at_[lane];
  double size = norm(start);
  for (int k = 0; k < 3; ++k) contact.normal[k] = size > 0 ? start[k] / size : (k == 2);
  contacts_.push(contact);
  t_upper_ = limit_ = tm_at_[lane];
  updateLive();
  return true;
}

/// Where any contact is asked for: a vertex of the one body's mesh that lies within the other, a single solid piece, at
/// a lane's middle. The vertex of the mesh's hull that lies deepest in the solid's box is tried.
inline bool Solver::proveVertexInside(int pair, int lane) {
  for (int s = 0; s < 2; ++s) {
    const Side& side = this->side(s);
    const TreeView &mesh = *side.moving, &solid = *side.still;
    if (mesh.pieces[0].kind != PieceKind::vertices || !mesh.outer || mesh.outer->kind != PieceKind::hull) continue;
    if (solid.num_pieces != 1 || solid.pieces[0].kind == PieceKind::vertices || unbounded(solid.pieces[0])) continue;
    DifferenceBody body;
    for (int i = 0; i < 9; ++i) body.pose.R[i] = side.m.R[0][i][lane];
    for (int i = 0; i < 3; ++i) body.pose.c[i] = side.m.c[0][i][lane];
    const Node& box = solid.nodes[0];
    double center[3];
    middleOf(box, center);
    const double* x = mesh.hulls + mesh.outer->first_vertex;
    const int n = mesh.outer->num_vertices;
    double best = 1;
    int vertex = -1;
    for (int i = 0; i < n; i += kLanes) {  // lanes go over vertices
      Lanes depth(0.0);
      for (int k = 0; k < 3; ++k) {
        const double reach = 2 / (static_cast<double>(box.hi[k]) - static_cast<double>(box.lo[k]));
        const Lanes y = hullValues(x, n, i, body.pose.R + 3 * k) + Lanes(body.pose.c[k] - center[k]);
        depth = max(depth, abs(y) * Lanes(reach));
      }
      const double least = minLane(depth);
      if (least >= best) continue;
      best = least;
      vertex = i + __builtin_ctz(kAllLanes & ~greater(depth, Lanes(least)));
    }
    if (vertex < 0) continue;
    Piece point;
    point.kind = PieceKind::point;
    for (int k = 0; k < 3; ++k) point.center[k] = x[k * n + vertex];
    body.tree_a = &solid;
    body.a = &solid.pieces[0];
    body.tree_b = &mesh;
    body.b = &point;
    double guess[3], where[3];
    for (int k = 0; k < 3; ++k) guess[k] = dot(body.pose.R + 3 * k, point.center) + body.pose.c[k] - center[k];
    ++statistics_.contact_proofs;
    // Seen from the other side a pose errs by twice as much (doc/NUMERICS.md, "Pads").
    if (!certainlyTouching(body, margin_, (s ? 2.5 : 1) * pose_error_, guess, where)) continue;
    LeafContact contact = {};
    const PairParts bodies = parts(pair);
    contact.pair = pair;
    contact.body_a = bodies.a;
    contact.body_b = bodies.b;
    int piece = 0;  // a triangle with that vertex
    for (int i = 0; i < mesh.num_pieces; ++i) {
      const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(mesh.pieces[i].first_vertex);
      for (int j = 0; j < mesh.pieces[i].num_vertices; ++j, v += 3) {
        if (v[0] == point.center[0] && v[1] == point.center[1] && v[2] == point.center[2]) piece = i;
      }
      if (piece == i && i) break;
    }
    (s ? contact.piece_a : contact.piece_b) = piece;
    contact.certain = true;
    contact.t = contact.t_upper = tm_at_[lane];
    // Outwards from the solid, through the side of its box that is nearest.
    double n_solid[3] = {0, 0, 0}, most = -1;
    int axis = 0;
    for (int k = 0; k < 3; ++k) {
      const double part = abs(guess[k]) / (static_cast<double>(box.hi[k]) - static_cast<double>(box.lo[k]));
      if (part > most) {
        most = part;
        axis = k;
      }
    }
    n_solid[axis] = guess[axis] < 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
      if (s == 0) {
        contact.point[k] = where[k];
        contact.normal[k] = n_solid[k];
      } else {  // the solid is B
        double p = side_[0].m.c[0][k][lane], m = 0;
        for (int j = 0; j < 3; ++j) {
          p += side_[0].m.R[0][3 * k + j][lane] * where[j];
          m -= side_[0].m.R[0][3 * k + j][lane] * n_solid[j];
        }
        contact.point[k] = p;
        contact.normal[k] = m;
      }
    }
    contacts_.push(contact);
    t_upper_ = limit_ = tm_at_[lane];
    updateLive();
    return true;
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
