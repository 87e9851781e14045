// SPDX-License-Identifier: BSD-3-Clause
//
// A chord of a solid among the triangles of a mesh: where it may be worth to prove contact. Nothing rests on what is
// found here, but for the chord's ends, which belong to the solid.
#pragma once

#include "convex/piece_kinds.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Node;

/// Leaves of a tree that `meets` lets through, until one does for `visit`. Nothing rests on which are seen.
template <class Meets, class Visit>
FCL_ARTIC_INLINE bool anyLeaf(const TreeView& tree, const Meets& meets, const Visit& visit) {
  constexpr int kDeepest = 64;
  int waiting[kDeepest], count = 0;
  for (int index = 0;;) {
    const Node& node = tree.nodes[index];
    if (node.isLeaf()) {
      if (visit(node.piece())) return true;
    } else {
      const bool left = meets(tree.nodes[node.left()]), right = meets(tree.nodes[node.right()]);
      if (left && right && count < kDeepest) waiting[count++] = node.right();
      if (left || right) {
        index = left ? node.left() : node.right();
        continue;
      }
    }
    if (!count) return false;
    index = waiting[--count];
  }
}

/// A piece of a mesh with the corner x; -1: there is none.
inline int pieceAt(const TreeView& mesh, const Vec3& x) {
  const float f[3] = {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
  int found = -1;
  anyLeaf(
      mesh,
      [&](const Node& node) {  // boxes are rounded outward
        return f[0] >= node.lo[0] && f[1] >= node.lo[1] && f[2] >= node.lo[2] && f[0] <= node.hi[0] &&
               f[1] <= node.hi[1] && f[2] <= node.hi[2];
      },
      [&](int piece) {
        const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(mesh.pieces[piece].first_vertex);
        for (int i = 0; i < mesh.pieces[piece].num_vertices; ++i, v += 3) {
          if (v[0] == x[0] && v[1] == x[1] && v[2] == x[2]) found = piece;
        }
        return found >= 0;
      });
  return found;
}

/// The segment from `start` to start + along among boxes and triangles, as far as doubles can decide.
struct Probe {
  Vec3 start, along;
  float per[3], offset[3];  ///< x * per - offset is the part of the way at which a coordinate is x
  bool down[3];             ///< which it goes towards the lower end
  Probe(const Vec3& s, const Vec3& e) : start(s), along(e - s) {
    for (int k = 0; k < 3; ++k) {
      per[k] = static_cast<float>(1 / (abs(along[k]) > 1e-12 ? along[k] : 1e-12));
      offset[k] = static_cast<float>(s[k]) * per[k];
      down[k] = per[k] < 0;
    }
  }
  bool meets(const Node& box) const {
    float first = 0.0f, last = 1.0f;
    for (int k = 0; k < 3; ++k) {
      first = max(first, (down[k] ? box.hi[k] : box.lo[k]) * per[k] - offset[k]);
      last = min(last, (down[k] ? box.lo[k] : box.hi[k]) * per[k] - offset[k]);
    }
    return first <= last;
  }
  /// @param[out] weights  of the triangle's corners where they meet.
  /// @param[out] part  of the way, there.
  bool meets(const Vec3* v, Vec3& weights, double& part) const {
    const Vec3 a = v[1] - v[0], b = v[2] - v[0], o = start - v[0];
    const Vec3 n = cross(a, b), m = cross(along, o);
    const double per_volume = -1 / dot(along, n);
    weights[1] = -dot(b, m) * per_volume;
    weights[2] = dot(a, m) * per_volume;
    weights[0] = 1 - weights[1] - weights[2];
    part = dot(o, n) * per_volume;
    return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0 && part >= 0 && part <= 1;
  }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
