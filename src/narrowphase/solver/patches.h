// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 1 in a large body: a mesh, a cloud or an OcTree, that stands still, moves, or is carried.
#pragma once

#include "narrowphase/solver/any_contact.h"
#include "narrowphase/solver/swept_lss.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Asks for an object's cache lines before they are needed.
template <class T>
FCL_ARTIC_INLINE void prefetch(const T* object) {
  for (unsigned i = 0; i < sizeof(T); i += 64) __builtin_prefetch(reinterpret_cast<const char*>(object) + i);
}

/// Stage 1 divides nodes of a large body that are larger than this part of the radius of the link's line swept sphere.
/// Measured, a Panda amid 10^4 and 9 * 10^4 triangles, 10^5 and 10^6 points: 1 to 2 are alike. From 4 on free motions
/// take longer, up to 4 times; below 0.4 contacts do, as a link meets many nodes at once.
constexpr double kPatchSize = 1;

/// Maximum number of a large body's upper nodes that are looked at for one link; what is below the others is left to
/// the search as it is. Boxes far from the origin are no smaller than a float's rounding: without a bound each piece of
/// such a body would be a patch.
constexpr int kMaxUpperNodes = 128;

/// A large body's upper node that is to be looked at, and the lanes in which its box meets that of a mover.
struct OpenUpper {
  std::int32_t upper, node;  ///< the same node, of the upper levels and of the tree
  unsigned mask;
};

/// The one of some lanes in which a segment is nearest; the middle one of several in which it is as near.
inline int nearestLane(Lanes square, unsigned lanes) {
  double least = square[__builtin_ctz(lanes)];
  for (int k = 0; k < kLanes; ++k) least = lanes >> k & 1 ? min(least, square[k]) : least;
  return middleLane(lanes & ~greater(square, Lanes(least)));
}

class Patches : PartOfSolver {
 public:
  /// Which body of a pair is the large one.
  enum class Large { a, b };

  /// @param directions  that Entry::direction names; those of a large body A are added.
  Patches(SearchState& state, AnyContact& any, Buffer<Vec3Lanes>& directions)
      : PartOfSolver(state.task),
        horizon_(state.horizon),
        contacts_(state.contacts),
        any_(any),
        directions_(directions) {}

  /// Appends the patches that may touch.
  void cull(const Entry& large, Large which, double margin, const SweptLss& lss, Buffer<Entry>& open);

 private:
  void open(const Entry& patch, double radius, const NearestToBox& nearest, Buffer<Entry>& open);

  Horizon& horizon_;
  const ContactList& contacts_;
  AnyContact& any_;
  Buffer<Vec3Lanes>& directions_;
  Buffer<OpenUpper> uppers_;
};

/// Goes from the upper levels of a large body's tree down to *patches*: nodes no larger than the other body, or without
/// upper nodes. The boxes of eight children are compared at once with that of the line swept sphere over [0, 1], then
/// with those of its parts, in the body's tree frame. All that is left out is proven apart: so is all that is below it.
/// @param large  the pair and the lanes that are left of it.
/// @param lss  the other body's, as seen from the tree's frame.
inline void Patches::cull(const Entry& large, Large which, double margin, const SweptLss& lss,
                          Buffer<Entry>& all_open) {
  const PairId pair = large.pair;
  const PairParts bodies = problem().parts(pair);
  const TreeView& tree = *body(which == Large::a ? bodies.a : bodies.b).tree;
  SweptBox parts;
  boundLss(lss, margin, parts);
  float ends[6];
  endsOfWhole(parts, ends);
  const SweptBox whole = spreadBox(ends, ends + 3);
  const double size = kPatchSize * (lss.radius + margin);
  const int first = all_open.size();
  const auto openNode = [&](int node, unsigned lanes) {
    NearestToBox nearest;
    lanes &= ~certainlyApart(lss, boxOfNode(tree.nodes[node]), OwnFrame(), margin, nearest);
    if (!lanes) return;
    const Entry patch = which == Large::a ? Entry{pair, node, 0, lanes} : Entry{pair, 0, node, lanes};
    open(patch, lss.radius, nearest, all_open);
  };
  uppers_.clear();
  uppers_.push({0, 0, large.mask});
  for (int i = 0; i < uppers_.size() && !horizon_.mustEnd(); ++i) {
    const OpenUpper at = uppers_[i];
    ++statistics().node_tests;
    if (i >= kMaxUpperNodes) {
      openNode(at.node, at.mask);
      continue;
    }
    const engine::UpperNode& upper = tree.upper[at.upper];
    for (unsigned left = kAllLanes & ~apart(whole, load(upper.boxes)); left; left &= left - 1) {
      const int child = __builtin_ctz(left);
      const std::int32_t node = upper.node[child];
      const unsigned met = node < 0 ? 0 : at.mask & ~apart(parts, spreadBox(upper.boxes, child));
      if (!met) continue;
      const std::int32_t below = upper.upper[child];
      if (below >= 0 && tree.nodes[node].radius > size) {
        uppers_.push({below, node, met});
        prefetch(tree.upper + below);
      } else {
        openNode(node, met);
      }
    }
  }
  if (!any_.isWanted()) return;
  int best = -1;
  for (int i = first; i < all_open.size(); ++i) {
    if (all_open[i].deepest >= 0 && (best < 0 || all_open[i].nearness < all_open[best].nearness)) best = i;
  }
  if (best >= 0 && !any_.tryPatch(all_open[best])) all_open[best].deepest = -1;  // it is not tried again
}

/// Appends a node of a large body. If the link is deep in it, contact is suspected there, or, if any contact will do,
/// expected.
/// @param radius  of the link's line swept sphere.
inline void Patches::open(const Entry& patch, double radius, const NearestToBox& nearest, Buffer<Entry>& open) {
  const unsigned deep = patch.mask & ~greater(nearest.square, Lanes(kDeep * kDeep * radius * radius));
  Entry& entry = open.grow() = patch;
  entry.deep = deep != 0;
  if (patch.b == 0) {
    entry.direction = directions_.size();
    directions_.push(nearest.direction);
  }
  if (!deep || query().every_pair || !contacts_.watching()) return;
  if (!query().any) return horizon_.suspect(whole().at[__builtin_ctz(deep)]);
  const int lane = nearestLane(nearest.square, deep);
  entry.deepest = static_cast<std::int8_t>(lane);
  entry.nearness = static_cast<float>(sqrt(nearest.square[lane]) / radius);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
