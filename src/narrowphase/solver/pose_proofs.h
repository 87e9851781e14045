// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs of contact at one pose, where any contact will do. Of a solid that is one piece and the mesh of the other
// body: a vertex of the mesh lies within the solid, or a chord of the solid pierces a triangle. Of two meshes: an edge
// of one triangle pierces the other. Of any two leaves: GJK's common point.
#pragma once

#include "convex/chord.h"
#include "convex/contact_proof.h"
#include "narrowphase/solver/contact_list.h"
#include "narrowphase/solver/relative_motion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// All are of the present pair, at a lane's middle. What is proven is recorded, with point and normal, and true is
/// returned; false: nothing is proven, or it does not count.
class PoseProofs : PartOfSolver {
 public:
  PoseProofs(Task& task, RelativeMotion& motion, ContactList& contacts)
      : PartOfSolver(task), motion_(motion), contacts_(contacts) {}

  bool vertexInside(int lane);
  bool chordPierces(int lane, const double* near);
  bool triangles(int piece_a, int piece_b, int lane);
  bool leaves(int piece_a, int piece_b, int lane);

 private:
  LeafContact* record(int piece_a, int piece_b, int lane) {
    FCL_ARTIC_ASSERT(lane >= 0 && lane < kLanes);
    return contacts_.record(motion_.pair(), piece_a, piece_b, motion_.batch().at[lane]);
  }

  RelativeMotion& motion_;
  ContactList& contacts_;
};

/// Where any contact is asked for: a vertex of the one body's mesh that lies within the other, a single solid piece, at
/// a lane's middle. The vertex of the mesh's hull that lies deepest in the solid's box is tried.
inline bool PoseProofs::vertexInside(int lane) {
  for (int s = 0; s < 2; ++s) {
    const TreeView &mesh = motion_.moving(s), &solid = motion_.still(s);
    if (mesh.pieces[0].kind != PieceKind::vertices || !mesh.outer || mesh.outer->kind != PieceKind::hull) continue;
    if (!isSolid(solid)) continue;
    const RigidLanes& m = s ? motion_.side(1).m : motion_.seenFromA();
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
    const double eps = (s ? 2.5 : 1) * motion_.poseError();
    ++statistics().contact_proofs;
    if (!certainlyWithin(*body.a, where, eps) && !certainlyTouching(body, motion_.margin(), eps, guess, where))
      continue;
    const int piece = pieceAt(mesh, point.center);
    if (piece < 0) continue;
    LeafContact* const recorded = record(s ? piece : 0, s ? 0 : piece, lane);
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
        double p = motion_.seenFromA().c[0][k][lane], m_b = 0;
        for (int j = 0; j < 3; ++j) {
          p += motion_.seenFromA().R[0][3 * k + j][lane] * where[j];
          m_b -= motion_.seenFromA().R[0][3 * k + j][lane] * n_solid[j];
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
inline bool PoseProofs::chordPierces(int lane, const double* near) {
  const TreeView &solid = motion_.a(), &mesh = motion_.b();
  double chord[2][3], seen[2][3];
  if (!isSolid(solid) || mesh.pieces[0].kind != PieceKind::vertices || !longChord(solid.pieces[0], near, chord))
    return false;
  const DifferenceBody body = motion_.differenceAt(solid.pieces[0], mesh.pieces[0], lane);
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
        ++statistics().contact_proofs;
        if (!certainlyPierces(chord, corners, motion_.poseError(), weights, part)) return false;
        LeafContact* const recorded = record(0, index, lane);
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

/// Two triangles, of which an edge of the one may pierce the other at a lane's middle.
inline bool PoseProofs::triangles(int piece_a, int piece_b, int lane) {
  const TreeView* trees[2] = {&motion_.a(), &motion_.b()};
  const int pieces[2] = {piece_a, piece_b};
  double corners[2][3][3];
  const DifferenceBody body = motion_.differenceAt(trees[0]->pieces[piece_a], trees[1]->pieces[piece_b], lane);
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
      ++statistics().contact_proofs;
      if (!certainlyPierces(chord, corners[1 - s], motion_.poseError(), weights, part)) continue;
      LeafContact* const recorded = record(piece_a, piece_b, lane);
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
inline bool PoseProofs::leaves(int piece_a, int piece_b, int lane) {
  const Piece &a = motion_.a().pieces[piece_a], &b = motion_.b().pieces[piece_b];
  const DifferenceBody body = motion_.differenceAt(a, b, lane);
  if (triangles(piece_a, piece_b, lane)) return true;
  ++statistics().contact_proofs;
  const double* start = motion_.witness() ? motion_.witness() : body.pose.c;
  double point[3];
  if (!certainlyTouching(body, motion_.margin(), motion_.poseError(), start, point)) return false;
  LeafContact* const recorded = record(piece_a, piece_b, lane);
  if (!recorded) return false;
  LeafContact& contact = *recorded;
  const double size = norm(start);
  for (int k = 0; k < 3; ++k) {
    contact.point[k] = point[k];
    contact.normal[k] = size > 0 ? start[k] / size : (k == 2);
  }
  return true;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
