// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs of contact at one pose, where any contact will do. One body may be a solid of one piece, the other a mesh.
// Then a vertex of the mesh lies within the solid, or a chord of the solid pierces a triangle. Two meshes: an edge of
// one triangle pierces another triangle. Any two leaves: GJK's common point.
#pragma once

#include "convex/chord.h"
#include "convex/contact_proof.h"
#include "narrowphase/solver/entry.h"
#include "narrowphase/solver/search_state.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Two bodies' boxes at one pose: nothing rests on what is said of them.
struct BoxesAtPose {
  float R[9], absolute[9], c[3];

  explicit BoxesAtPose(const PoseAt& pose) {
    for (int i = 0; i < 9; ++i) {
      R[i] = static_cast<float>(pose.R[i / 3][i % 3]);
      absolute[i] = __builtin_fabsf(R[i]);
    }
    for (int k = 0; k < 3; ++k) c[k] = static_cast<float>(pose.c[k]);
  }
  /// No axis of either box separates them.
  /// @param[out] nearness  square of their middles' distance, as part of their balls' radii.
  bool meet(const Node& a, const Node& b, float& nearness) const {
    float x[3], half_a[3], half_b[3], y[3];
    for (int k = 0; k < 3; ++k) {
      half_a[k] = 0.5f * (a.hi[k] - a.lo[k]);
      half_b[k] = 0.5f * (b.hi[k] - b.lo[k]);
      y[k] = 0.5f * (b.hi[k] + b.lo[k]);
    }
    bool all = true;
    for (int k = 0; k < 3; ++k) {
      const float *r = R + 3 * k, *e = absolute + 3 * k;
      x[k] = c[k] + r[0] * y[0] + r[1] * y[1] + r[2] * y[2] - 0.5f * (a.hi[k] + a.lo[k]);
      all &= __builtin_fabsf(x[k]) <= half_a[k] + e[0] * half_b[0] + e[1] * half_b[1] + e[2] * half_b[2];
    }
    for (int k = 0; k < 3; ++k) {
      const float z = R[k] * x[0] + R[3 + k] * x[1] + R[6 + k] * x[2];
      all &= __builtin_fabsf(z) <=
             half_b[k] + absolute[k] * half_a[0] + absolute[3 + k] * half_a[1] + absolute[6 + k] * half_a[2];
    }
    const float radii = static_cast<float>(a.radius + b.radius);
    nearness = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) / (radii * radii);
    return all;
  }
};

/// Proofs of one pair's contact at a lane's middle. Each returns true if it has proven a contact, which it records with
/// point and normal; false if nothing is proven, or the contact does not count.
class PoseProofs : PartOfSolver {
 public:
  explicit PoseProofs(SearchState& state)
      : PartOfSolver(state.task), horizon_(state.horizon), contacts_(state.contacts) {}

  bool vertexInside(Seen seen, int lane);
  bool chordPierces(Seen seen, int lane, const Vec3& near);
  bool triangles(Seen seen, int piece_a, int piece_b, int lane);
  bool anyTriangles(Seen seen, int lane, int max_box_pairs, const Entry& from);
  bool anyPieces(Seen seen, int lane, int max_box_pairs, const Entry& from);
  bool leaves(Seen seen, int piece_a, int piece_b, int lane);

 private:
  LeafContact* record(Seen seen, int piece_a, int piece_b, int lane) {
    FCL_ARTIC_ASSERT(lane >= 0 && lane < kLanes);
    return contacts_.record(seen->pair(), piece_a, piece_b, seen->batch().at[lane]);
  }

  Horizon& horizon_;
  ContactList& contacts_;
};

/// Maximum number of pairs of boxes that are tested in one pose, of which two triangles count as kTwoTriangles.
/// Measured: with half as many, robots that touch at the start take 7 % longer.
constexpr int kMaxBoxPairs = 1024, kTwoTriangles = 8;

/// Corners of a triangle, in its tree's frame.
inline void cornersOf(const TreeView& mesh, const Piece& triangle, Vec3* corners) {
  for (int i = 0; i < 3; ++i) corners[i] = Vec3(VerticesKind::points(mesh, triangle) + 3 * i);
}

/// The vertex of a mesh's hull that is deepest in a box; -1: none is in it.
/// @param pose  of the mesh, seen from the box.
/// @param center, size  of the box.
inline int deepestVertex(const TreeView& mesh, const PoseAt& pose, const Vec3& center, const Vec3& size) {
  const double* x = mesh.hulls + mesh.outer->first_vertex;
  const int n = mesh.outer->num_vertices;
  double best = 1;
  int vertex = -1;
  for (int i = 0; i < n; i += kLanes) {  // lanes go over vertices
    Lanes depth(0.0);
    for (int k = 0; k < 3; ++k) {
      const Lanes y = hullValues(x, n, i, pose.R[k]) + Lanes(pose.c[k] - center[k]);
      depth = max(depth, abs(y) * Lanes(2 / size[k]));
    }
    const double least = minLane(depth);
    if (least >= best) continue;
    best = least;
    vertex = i + __builtin_ctz(kAllLanes & ~greater(depth, Lanes(least)));
  }
  return vertex;
}

/// For queries that any contact answers: proves that a vertex of the one body's mesh lies within the other body, a
/// single solid piece, at a lane's middle. It tries the vertex of the mesh's hull that lies deepest in the solid's box.
inline bool PoseProofs::vertexInside(Seen seen, int lane) {
  for (int s = 0; s < 2; ++s) {
    const TreeView &mesh = seen->moving(s), &solid = seen->still(s);
    if (mesh.pieces[0].kind != PieceKind::vertices || !mesh.outer || mesh.outer->kind != PieceKind::hull) continue;
    if (!isSolid(solid)) continue;
    const RigidLanes& m = s ? seen->side(1).m : seen->seenFromA();
    DifferenceBody body;
    body.pose = {laneOf(m.R[0], lane), laneOf(m.c[0], lane)};
    const Node& box = solid.nodes[0];
    const Vec3 center = middleOf(box), size = doublesOf(box.hi) - doublesOf(box.lo);
    const double* x = mesh.hulls + mesh.outer->first_vertex;
    const int n = mesh.outer->num_vertices;
    const int vertex = deepestVertex(mesh, body.pose, center, size);
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
    const double eps = (s ? 2.5 : 1) * seen->poseError();
    ++statistics().contact_proofs;
    if (!certainlyWithin(*body.a, where, eps) && !certainlyTouching(body, seen->margin(), eps, guess, where)) continue;
    const int piece = pieceAt(mesh, tip);
    if (piece < 0) continue;
    LeafContact* const recorded = record(seen, s ? piece : 0, s ? 0 : piece, lane);
    if (!recorded) return false;
    LeafContact& contact = *recorded;
    // Outwards from the solid, through the side of its box that is nearest.
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = abs(guess[k]) / size[k] > abs(guess[axis]) / size[axis] ? k : axis;
    Vec3 outwards(0, 0, 0);
    outwards[axis] = guess[axis] < 0 ? -1 : 1;
    if (s) {  // the solid is B
      const Mat3 R = laneOf(seen->seenFromA().R[0], lane);
      where = R * where + laneOf(seen->seenFromA().c[0], lane);
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
inline bool PoseProofs::chordPierces(Seen seen, int lane, const Vec3& near) {
  const TreeView &solid = seen->a(), &mesh = seen->b();
  Vec3 chord[2];
  if (!isSolid(solid) || mesh.pieces[0].kind != PieceKind::vertices || !longChord(solid.pieces[0], near, chord))
    return false;
  const DifferenceBody body = seen->differenceAt(solid.pieces[0], mesh.pieces[0], lane);
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
        if (!certainlyPierces(chord, corners, seen->poseError(), weights, part)) return false;
        LeafContact* const recorded = record(seen, 0, index, lane);
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
inline bool PoseProofs::triangles(Seen seen, int piece_a, int piece_b, int lane) {
  const TreeView* trees[2] = {&seen->a(), &seen->b()};
  const int pieces[2] = {piece_a, piece_b};
  Vec3 corners[2][3];
  if (trees[0]->pieces[0].kind != PieceKind::vertices || trees[1]->pieces[0].kind != PieceKind::vertices) return false;
  const DifferenceBody body = seen->differenceAt(trees[0]->pieces[piece_a], trees[1]->pieces[piece_b], lane);
  for (int s = 0; s < 2; ++s) {
    const Piece& piece = trees[s]->pieces[pieces[s]];
    if (piece.num_vertices != 3) return false;
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
      if (!certainlyPierces(chord, corners[1 - s], seen->poseError(), weights, part)) continue;
      LeafContact* const recorded = record(seen, piece_a, piece_b, lane);
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

/// Tries the triangles of two bodies at a lane's middle: first those in boxes whose middles are near each other.
/// @param max_box_pairs  as kMaxBoxPairs.
/// @param from  the nodes to begin at.
inline bool PoseProofs::anyTriangles(Seen seen, int lane, int max_box_pairs, const Entry& from) {
  const TreeView &A = seen->a(), &B = seen->b();
  if (A.pieces[0].kind != PieceKind::vertices || B.pieces[0].kind != PieceKind::vertices) return false;
  return anyPieces(seen, lane, max_box_pairs, from);
}

/// The same of pieces of all kinds.
inline bool PoseProofs::anyPieces(Seen seen, int lane, int max_box_pairs, const Entry& from) {
  const TreeView &A = seen->a(), &B = seen->b();
  const bool are_triangles = A.pieces[0].kind == PieceKind::vertices && B.pieces[0].kind == PieceKind::vertices;
  const BoxesAtPose boxes(seen->differenceAt(A.pieces[0], B.pieces[0], lane).pose);
  struct NodePair {
    std::int32_t a, b;
  };
  constexpr int kDeepest = 64;
  NodePair waiting[kDeepest], at = {from.a, from.b};
  int count = 0;
  for (int left = max_box_pairs; left > 0 && !horizon_.mustEnd();) {
    NodeRoom room_a, room_b;
    const Node &x = nodeOf(A, at.a, room_a), &y = nodeOf(B, at.b, room_b);
    if (x.isLeaf() && y.isLeaf()) {
      ++statistics().leaf_tests;
      if (are_triangles ? triangles(seen, x.piece(), y.piece(), lane) : leaves(seen, x.piece(), y.piece(), lane)) {
        return true;
      }
      left -= kTwoTriangles;
    } else {
      const bool split_a = y.isLeaf() || (!x.isLeaf() && x.radius > y.radius);
      NodePair child[2] = {at, at};
      bool meet[2];
      float nearness[2];
      for (int i = 0; i < 2; ++i) {
        (split_a ? child[i].a : child[i].b) = (split_a ? x : y).child + i;
        NodeRoom room;  // of the child; the other node is x or y
        meet[i] = split_a ? boxes.meet(nodeOf(A, child[i].a, room), y, nearness[i])
                          : boxes.meet(x, nodeOf(B, child[i].b, room), nearness[i]);
      }
      left -= 2;
      statistics().node_tests += 2;
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

/// Contact of two leaves at a lane's middle, where any contact is asked for.
inline bool PoseProofs::leaves(Seen seen, int piece_a, int piece_b, int lane) {
  const PiecePair pieces(seen->a(), piece_a, seen->b(), piece_b);
  const Piece &a = pieces.a, &b = pieces.b;
  const DifferenceBody body = seen->differenceAt(a, b, lane);
  if (triangles(seen, piece_a, piece_b, lane)) return true;
  ++statistics().contact_proofs;
  const Vec3 start = seen->witness() ? *seen->witness() : body.pose.c;
  Vec3 point;
  if (!certainlyTouching(body, seen->margin(), seen->poseError(), start, point)) return false;
  LeafContact* const recorded = record(seen, piece_a, piece_b, lane);
  if (!recorded) return false;
  point.store(recorded->point);
  unitOrZ(start).store(recorded->normal);
  return true;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
