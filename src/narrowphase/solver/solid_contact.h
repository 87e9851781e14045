// SPDX-License-Identifier: BSD-3-Clause
//
// Where any contact will do: a solid that is one piece, and the mesh of the other body, at one pose. Either a vertex of
// the mesh lies within the solid, or a chord of the solid pierces a triangle.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Where any contact is asked for: a vertex of the one body's mesh that lies within the other, a single solid piece, at
/// a lane's middle. The vertex of the mesh's hull that lies deepest in the solid's box is tried.
inline bool Solver::proveVertexInside(int pair, int lane) {
  for (int s = 0; s < 2; ++s) {
    const TreeView &mesh = *side_[s].moving, &solid = *side_[s].still;
    if (mesh.pieces[0].kind != PieceKind::vertices || !mesh.outer || mesh.outer->kind != PieceKind::hull) continue;
    if (!isSolid(solid)) continue;
    if (s) side(s);  // makes it
    const RigidLanes& m = side_[s].m;
    DifferenceBody body;
    for (int i = 0; i < 9; ++i) body.pose.R[i] = m.R[0][i][lane];
    for (int i = 0; i < 3; ++i) body.pose.c[i] = m.c[0][i][lane];
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
    body.place(point.center, where);
    for (int k = 0; k < 3; ++k) guess[k] = where[k] - center[k];
    // Seen from the other side a pose errs by twice as much (doc/NUMERICS.md, "Pads").
    const double eps = (s ? 2.5 : 1) * pose_error_;
    ++statistics_.contact_proofs;
    if (!certainlyWithin(*body.a, where, eps) && !certainlyTouching(body, margin_, eps, guess, where)) continue;
    const int piece = pieceAt(mesh, point.center);
    if (piece < 0) continue;
    LeafContact* const recorded = record(pair, s ? piece : 0, s ? 0 : piece, lane);
    if (!recorded) return false;
    LeafContact& contact = *recorded;
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
        double p = side_[0].m.c[0][k][lane], m_b = 0;
        for (int j = 0; j < 3; ++j) {
          p += side_[0].m.R[0][3 * k + j][lane] * where[j];
          m_b -= side_[0].m.R[0][3 * k + j][lane] * n_solid[j];
        }
        contact.point[k] = p;
        contact.normal[k] = m_b;
      }
    }
    return true;
  }
  return false;
}

/// Where any contact is asked for: a triangle of B's mesh that a chord of A, a single solid piece, pierces at a lane's
/// middle.
/// @param near  a point of A's frame that the chord should pass near to.
inline bool Solver::provePierced(int pair, int lane, const double* near) {
  const TreeView &solid = *side_[0].still, &mesh = *side_[0].moving;
  double chord[2][3], seen[2][3];
  if (!isSolid(solid) || mesh.pieces[0].kind != PieceKind::vertices || !longChord(solid.pieces[0], near, chord))
    return false;
  const DifferenceBody body = differenceAt(solid.pieces[0], mesh.pieces[0], lane);
  for (int end = 0; end < 2; ++end) {
    double d[3];
    for (int k = 0; k < 3; ++k) d[k] = body.pose.c[k] - chord[end][k];
    body.pose.opposite(d, seen[end]);
  }
  const Probe probe(seen[0], seen[1]);
  return anyLeaf(
      mesh, [&](const Node& node) { return probe.meets(node); },
      [&](int index) {
        const Piece& piece = mesh.pieces[index];
        const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(piece.first_vertex);
        double part, weights[3], corners[3][3];
        if (piece.num_vertices != 3 || !probe.meets(v, weights, part)) return false;
        for (int i = 0; i < 3; ++i) body.place(v + 3 * i, corners[i]);
        ++statistics_.contact_proofs;
        if (!certainlyPierces(chord, corners, pose_error_, weights, part)) return false;
        LeafContact* const recorded = record(pair, 0, index, lane);
        if (!recorded) return false;
        LeafContact& contact = *recorded;
        // The triangle's normal, towards the mesh's middle.
        double normal[3], middle[3], placed[3], inwards = 0;
        middleOf(mesh.nodes[0], middle);
        body.place(middle, placed);
        for (int k = 0; k < 3; ++k) {
          contact.point[k] = chord[0][k] + part * (chord[1][k] - chord[0][k]);
          normal[k] = dot(body.pose.R + 3 * k, piece.size);
          inwards += normal[k] * (placed[k] - contact.point[k]);
        }
        for (int k = 0; k < 3; ++k) contact.normal[k] = inwards < 0 ? -normal[k] : normal[k];
        return true;
      });
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
