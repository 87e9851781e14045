// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pairs/judge.h"

namespace pairs {

enum class Bodies { meshes, shapes, mixed };
enum class Moves { interp, translation, screw, spline };

struct PairOptions {
  Bodies bodies = Bodies::meshes;
  Moves moves = Moves::interp;
  bool both_move = true;
  /// Where a query is clear, the second body's whole motion is moved so that the least gap, or the depth, is of 1e-8 to
  /// 1e-3 m.
  bool graze = false;
  /// Bounding volume of the meshes; both the same, as FCL compares no others. Any: each one its own.
  Volume volume = Volume::rss;
  bool any_volume = false;
  /// Half-spaces and planes are among the shapes, at most one a query.
  bool unbounded = false;
  /// Shapes that are drawn; empty: all bounded ones.
  std::vector<Kind> kinds;
};

/// The query of this seed; the same one for the same options and seed. Rotations up to 180 degrees.
PairQuery makePair(const PairOptions& options, std::uint64_t seed);

/// Query `index` of a reference set, by InterpMotion: half of them with both bodies moving, a quarter near-grazing.
PairQuery referencePair(Bodies bodies, std::uint64_t seed, std::uint64_t index);

/// The same query with its meshes built anew, on trees of this bounding volume.
PairQuery withVolume(const PairQuery& query, Volume volume);

}  // namespace pairs
