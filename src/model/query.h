// SPDX-License-Identifier: BSD-3-Clause
//
// What one query asks: the motion, tolerances, and who may advise the solver. Plain data.
#pragma once

#include <cstdint>

#include "model/margins.h"
#include "model/problem.h"

namespace fcl_artic {
namespace engine {

/// A link's line swept sphere over one of the eight parts [k/8, (k+1)/8] of the motion: within the hull of these
/// points, in the world, grown by a ball.
struct SweptLink {
  double points[6][3];
  double radius;
};
/// A pair of a link and a still obstacle that stage 1 left.
struct CullCandidate {
  std::int32_t pair, mover, obstacle;  ///< mover: among Problem::movers; obstacle: a body
  std::uint32_t lanes;                 ///< parts of the motion in which their bounds meet
  double margin;                       ///< of the pair
  /// Nodes of the obstacle's tree, a bit each, that are proven free of the mover over the whole motion; null: none.
  /// There until the solver returns.
  const std::uint64_t* free_nodes = nullptr;
};

/// A pair that is worth a look in the middle of the part [k/8, (k+1)/8] of a motion.
struct LikelyContact {
  std::int32_t link_pair, part;
};

struct Query {
  /// Variable v at time t: sum over k of coefficients[k * num_variables + v] t^k, for k = 0..degree (at least 1).
  const double* coefficients = nullptr;
  std::int32_t num_variables = 0, degree = 1;
  const double* orientations = nullptr;  ///< rotations R0 of turns, row-major, nine numbers each
  double tolerance_time = 1e-6, tolerance_distance = 1e-6;
  Margins margins;
  bool check_scene = true, check_self = true, every_pair = false, ignore_initial = false, measure_times = false;
  bool any = false;               ///< stop at the first contact that is proven, wherever on the way it is
  std::int32_t max_contacts = 1;  ///< with every_pair: of each pair
  const std::int32_t* may_ignore =
      nullptr;                       ///< with ignore_initial: the only pairs whose initial contact may be ignored
  std::int32_t num_may_ignore = -1;  ///< -1: that of all pairs may
  std::uint64_t work_budget = 0;
  /// Told now and then up to when the motion is proven free; false ends the query, which is undecided then.
  bool (*progress)(void* context, double t_lower) = nullptr;
  void* progress_context = nullptr;
  /// Contacts get their features and nearest points, and what the equations of these features prove sharpens the
  /// bracket. False: only the bracket is of interest.
  bool describe_contacts = true;
  /// Per link pair, bit k: it is proven free over the part [k/8, (k+1)/8] of this motion. Asked for when the pairs are
  /// come to, which contact with an obstacle may spare. Null: nothing is known.
  const std::uint8_t* (*link_free)(const void* context) = nullptr;
  const void* link_free_context = nullptr;
  /// With `any`: where balls inside links are likely to meet.
  const LikelyContact* likely = nullptr;
  std::int32_t num_likely = 0;
  /// A stage between stage 1 and the first batch: may clear lanes in which a pair is proven free and set free_nodes,
  /// nothing else. The pairs of a mover lie together; links[8 * mover + k] is set for movers that have pairs.
  void (*refine)(void* context, const Problem& problem, const SweptLink* links, CullCandidate* pairs,
                 std::int32_t num_pairs) = nullptr;
  void* refine_context = nullptr;
};

}  // namespace engine
}  // namespace fcl_artic
