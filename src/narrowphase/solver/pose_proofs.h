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

/// Proofs for the present pair, at a lane's middle. Each returns true if it has proven a contact, which it records with
/// point and normal; false if nothing is proven, or the contact does not count.
class PoseProofs : PartOfSolver {
 public:
  PoseProofs(Task& task, RelativeMotion& motion, ContactList& contacts)
      : PartOfSolver(task), motion_(motion), contacts_(contacts) {}

  bool vertexInside(int lane);
  bool chordPierces(int lane, const Vec3& near);
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

/// Corners of a triangle, in its tree's frame.
inline void cornersOf(const TreeView& mesh, const Piece& triangle, Vec3* corners) {
  for (int i = 0; i < 3; ++i) corners[i] = Vec3(VerticesKind::points(mesh, triangle) + 3 * i);
}

/// For queries that any contact answers: proves that a vertex of the one body's mesh lies within the other body, a
/// single solid piece, at a lane's middle. It tries the vertex of the mesh's hull that lies deepest in the solid's box.
inline bool PoseProofs::vertexInside(int lane) {
  for (int s = 0; s < 2; ++s) {
    const TreeView &mesh = motion_.moving(s), &solid = motion_.still(s);
    if (mesh.pieces[0].kind != PieceKind::vertices || !mesh.outer || mesh.outer->kind != PieceKind::hull) continue;
    if (!isSolid(solid)) continue;
    const RigidLanes& m = s ? motion_.side(1).m : motion_.seenFromA();
    DifferenceBody body;
    body.pose = {laneOf(m.R[0], lane), laneOf(m.c[0], lane)};
    const Node& box = solid.nodes[0];
    const Vec3 center = middleOf(box), size = doublesOf(box.hi) - doublesOf(box.lo);
    const double* x = mesh.hulls + mesh.outer->first_vertex;
    const int n = mesh.outer->num_vertices;
    double best = 1;
    int vertex = -1;
    for (int i = 0; i < n; i += kLanes) {  // lanes go over vertices
      Lanes depth(0.0);
      for (int k = 0; k < 3; ++k) {
        const Lanes y = hullValues(x, n, i, body.pose.R[k]) + Lanes(body.pose.c[k] - center[k]);
        depth = max(depth, abs(y) * Lanes(2 / size[k]));
      }
      const double least = minLane(depth);
      if (least >= best) continue;
      best = least;
      vertex = i + __builtin_ctz(kAllLanes & ~greater(depth, Lanes(least)));
    }
    if (vertex < 0) continue;
    Piece point;
    point.kind = PieceKind::point;
    const Vec3 tip(x[vertex], x[n + vertex], x[2 * n + vertex]);
    tip.store(point.center);
    body.tree_a = &solid;
    body.a = &solid.pieces[0];
    body.tree_b = &mesh;
    body.b = &point;
    Vec3 where = body.place(tip);
    const Vec3 guess = where - center;
    // Seen from the other side a pose errs by twice as much (doc/NUMERICS.md, "Pads").
    const double eps = (s ? 2.5 : 1) * motion_.poseError();
    ++statistics().contact_proofs;
    if (!certainlyWithin(*body.a, where, eps) && !certainlyTouching(body, motion_.margin(), eps, guess, where))
      continue;
    const int piece = pieceAt(mesh, tip);
    if (piece < 0) continue;
    LeafContact* const recorded = record(s ? piece : 0, s ? 0 : piece, lane);
    if (!recorded) return false;
    LeafContact& contact = *recorded;
    // Outwards from the solid, through the side of its box that is nearest.
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = abs(guess[k]) / size[k] > abs(guess[axis]) / size[axis] ? k : axis;
    Vec3 outwards(0, 0, 0);
    outwards[axis] = guess[axis] < 0 ? -1 : 1;
    if (s) {  // the solid is B
      const Mat3 R = laneOf(motion_.seenFromA().R[0], lane);
      where = R * where + laneOf(motion_.seenFromA().c[0], lane);
      outwards = -(R * outwards);
    }
    where.store(contact.point);
    outwards.store(contact.normal);
    return true;
  }
  return false;
}

/// For queries that any contact answers: proves that a chord of A, a single solid piece, pierces a triangle of B's mesh
/// at a lane's middle.
/// @param near  a point of A's frame that the chord should pass near to.
inline bool PoseProofs::chordPierces(int lane, const Vec3& near) {
  const TreeView &solid = motion_.a(), &mesh = motion_.b();
  Vec3 chord[2];
  if (!isSolid(solid) || mesh.pieces[0].kind != PieceKind::vertices || !longChord(solid.pieces[0], near, chord))
    return false;
  const DifferenceBody body = motion_.differenceAt(solid.pieces[0], mesh.pieces[0], lane);
  // The chord's ends, seen from B.
  const Probe probe(body.pose.opposite(body.pose.c - chord[0]), body.pose.opposite(body.pose.c - chord[1]));
  return anyLeaf(
      mesh, [&](const Node& node) { return probe.meets(node); },
      [&](int index) {
        const Piece& piece = mesh.pieces[index];
        if (piece.num_vertices != 3) return false;
        Vec3 corners[3], weights;
        double part;
        cornersOf(mesh, piece, corners);
        if (!probe.meets(corners, weights, part)) return false;
        for (Vec3& corner : corners) corner = body.place(corner);
        ++statistics().contact_proofs;
        if (!certainlyPierces(chord, corners, motion_.poseError(), weights, part)) return false;
        LeafContact* const recorded = record(0, index, lane);
        if (!recorded) return false;
        LeafContact& contact = *recorded;
        // The triangle's normal, towards the mesh's middle.
        const Vec3 point = chord[0] + (chord[1] - chord[0]) * part, normal = body.pose.R * sizeOf(piece);
        const double inwards = dot(normal, body.place(middleOf(mesh.nodes[0])) - point);
        point.store(contact.point);
        (inwards < 0 ? -normal : normal).store(contact.normal);
        return true;
      });
}

/// Two triangles: an edge of the one may pierce the other at a lane's middle.
inline bool PoseProofs::triangles(int piece_a, int piece_b, int lane) {
  const TreeView* trees[2] = {&motion_.a(), &motion_.b()};
  const int pieces[2] = {piece_a, piece_b};
  Vec3 corners[2][3];
  const DifferenceBody body = motion_.differenceAt(trees[0]->pieces[piece_a], trees[1]->pieces[piece_b], lane);
  for (int s = 0; s < 2; ++s) {
    const Piece& piece = trees[s]->pieces[pieces[s]];
    if (piece.kind != PieceKind::vertices || piece.num_vertices != 3) return false;
    cornersOf(*trees[s], piece, corners[s]);
  }
  for (Vec3& corner : corners[1]) corner = body.place(corner);
  for (int s = 0; s < 2; ++s) {  // edges of this one
    for (int i = 0; i < 3; ++i) {
      const Vec3 chord[2] = {corners[s][i], corners[s][i < 2 ? i + 1 : 0]};
      Vec3 weights;
      double part;
      if (!Probe(chord[0], chord[1]).meets(corners[1 - s], weights, part)) continue;
      ++statistics().contact_proofs;
      if (!certainlyPierces(chord, corners[1 - s], motion_.poseError(), weights, part)) continue;
      LeafContact* const recorded = record(piece_a, piece_b, lane);
      if (!recorded) return false;
      LeafContact& contact = *recorded;
      contact.feature = s ? engine::kFaceEdge : engine::kEdgeFace;
      // The pierced triangle's normal: out of A, or into B.
      const TreeView& pierced = *trees[1 - s];
      const Vec3 flat = sizeOf(pierced.pieces[pieces[1 - s]]), middle = middleOf(pierced.nodes[0]);
      const Vec3 point = chord[0] + (chord[1] - chord[0]) * part, normal = s ? flat : body.pose.R * flat;
      const double inwards = dot(normal, (s ? middle : body.place(middle)) - point);
      point.store(contact.point);
      ((inwards < 0) != (s == 1) ? -normal : normal).store(contact.normal);
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
  const Vec3 start = motion_.witness() ? *motion_.witness() : body.pose.c;
  Vec3 point;
  if (!certainlyTouching(body, motion_.margin(), motion_.poseError(), start, point)) return false;
  LeafContact* const recorded = record(piece_a, piece_b, lane);
  if (!recorded) return false;
  point.store(recorded->point);
  unitOrZ(start).store(recorded->normal);
  return true;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
