// SPDX-License-Identifier: BSD-3-Clause
//
// The engine's answer. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>

#include "fcl_artic/statistics.h"
#include "model/bracket.h"
#include "model/pair_id.h"

namespace fcl_artic {
namespace engine {

struct Statistics : StandardStatistics {
  std::uint64_t pairs = 0, pairs_after_culling = 0;
};

/// Values of FeatureKind for the engine's code, which is compiled for several instruction sets and includes no Eigen.
constexpr std::int32_t kEdgeFace = 6, kFaceEdge = 7, kVolume = 9;

/// Two leaves that meet, or come too near to be separated.
struct LeafContact {
  PairId pair;
  std::int32_t body_a, body_b;
  std::int32_t piece_a, piece_b;  ///< -1: proven of what a mesh encloses, of no triangle
  bool certain;
  double t_lower, t_upper;    ///< this leaf pair's own bracket
  double normal[3];           ///< in A's tree frame, from A to B
  double point[3];            ///< in A's tree frame at time `t`
  double t;                   ///< t_upper when certain, else t_lower
  std::int32_t feature = -1;  ///< FeatureKind; -1: not known. The solver's is reported as it is
  /// Points of both pieces that are nearest to each other at t_nearest, both in A's tree frame at that time: t_lower;
  /// where the pieces overlap then, and with Query::any, `point` at `t`.
  double nearest_a[3], nearest_b[3];
  double t_nearest;
  double approach_speed;  ///< of B towards A along the normal at `point` and `t`, m per unit of t; 0 with Query::any
};

/// The order in which contacts are reported: the proven ones by their t_upper, then the rest by their t_lower. (Static:
/// each instruction set has its own.)
static inline bool comesBefore(const LeafContact& x, const LeafContact& y) {
  if (x.certain != y.certain) return x.certain;
  return x.certain ? x.t_upper < y.t_upper : x.t_lower < y.t_lower;
}

/// A pair in contact at t = 0 and the time from which it is watched again; kNever: it never comes apart, and nothing is
/// claimed of it.
struct Ignored {
  PairId pair;
  std::int32_t body_a, body_b;
  double watch_from;
};

static inline bool neverApart(const Ignored& pair) {
  return pair.watch_from >= kNever;
}

/// The bracket of all checked pairs, and what was found.
struct Answer : Bracket {
  const LeafContact* contacts = nullptr;  ///< owned by the workspace, valid until its next query
  std::int32_t num_contacts = 0;
  const Ignored* ignored = nullptr;  ///< the same
  std::int32_t num_ignored = 0;
  Statistics statistics;
};

/// Number of ignored pairs of which nothing is claimed.
static inline std::size_t numNeverApart(const Answer& answer) {
  std::size_t count = 0;
  for (std::int32_t i = 0; i < answer.num_ignored; ++i) count += neverApart(answer.ignored[i]);
  return count;
}

}  // namespace engine
}  // namespace fcl_artic
