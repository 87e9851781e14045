// SPDX-License-Identifier: BSD-3-Clause
//
// The question of one query: the motion, tolerances, and the solver's advisors. Plain data.
#pragma once

#include <cstdint>

#include "model/advisor.h"
#include "model/margins.h"
#include "model/problem.h"
#include "numerics/assertion.h"

namespace fcl_artic {
namespace engine {

/// Which variables are angles that go by the tangent of their half: with s the variable's polynomial, the angle is
/// reference + 2 atan(s). If a motion has such a variable, its degree is at least 2, as its bounds differ from time to
/// time.
struct HalfAngles {
  const std::uint8_t* is = nullptr;   ///< per variable, the first `count` of them; the others are their polynomials
  const double* reference = nullptr;  ///< per variable, rad
  std::int32_t count = 0;
  [[gnu::always_inline]] bool has(std::int32_t variable) const { return variable < count && is[variable] != 0; }
};

/// The time that bodies have had to move by themselves (Body::speed), linear in the query's t and never less later: at
/// t = 0 and at t = 1.
struct Clock {
  double begin = 0, end = 1;
};
/// How the problem's strays count (Problem::strays).
struct TubeAsked {
  double factor = 1;  ///< times which lengths and angles count, at least 0
  Clock clock;
  double times = 1;  ///< no less than how often the whole motion fits into a unit of time (Body::lag)
};

struct Query {
  /// Variable v at time t: sum over k of coefficients[k * num_variables + v] t^k, for k = 0..degree (at least 1).
  const double* coefficients = nullptr;
  std::int32_t num_variables = 0, degree = 1;
  HalfAngles half_angles;
  TubeAsked tube;
  const double* orientations = nullptr;  ///< rotations R0 of turns, row-major, nine numbers each
  double tolerance_time = 1e-6, tolerance_distance = 1e-6;
  Margins margins;
  bool check_scene = true, check_self = true, every_pair = false, ignore_initial = false, measure_times = false;
  bool any = false;               ///< stop at the first contact that is proven, wherever on the way it is
  std::int32_t max_contacts = 1;  ///< each of another pair; the search does not depend on it
  /// With ignore_initial: the only pairs whose initial contact may be ignored.
  const PairId* may_ignore = nullptr;
  std::int32_t num_may_ignore = -1;  ///< -1: that of all pairs may
  std::uint64_t work_budget = 0;
  /// Told now and then up to when the motion is proven free; false ends the query, which is undecided then.
  bool (*progress)(void* context, double t_lower) = nullptr;
  void* progress_context = nullptr;
  /// Contacts get their features and nearest points, and what the equations of these features prove sharpens the
  /// bracket. False: only the bracket is of interest.
  bool describe_contacts = true;
  /// Who advises the solver. Each may clear what it has proven; what several clear is cleared.
  static constexpr std::int32_t kMaxAdvisors = 4;
  Advisor advisors[kMaxAdvisors];
  std::int32_t num_advisors = 0;
  /// Adds one.
  [[gnu::always_inline]] void ask(const Advisor& advisor) {
    FCL_ARTIC_ASSERT(num_advisors < kMaxAdvisors);
    advisors[num_advisors++] = advisor;
  }
};

}  // namespace engine
}  // namespace fcl_artic
