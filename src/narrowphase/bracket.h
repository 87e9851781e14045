// SPDX-License-Identifier: BSD-3-Clause
//
// When the first of several contacts is. One place that knows how brackets are joined, for the engine and the queries.
#pragma once

namespace fcl_artic {
namespace engine {

/// Later than all of [0, 1]: what does not happen.
constexpr double kNever = 2;

/// Joined of all contacts that are found, before any of them is left out of what is reported. Without contact both are
/// kNever.
struct Bracket {
  double t_lower = kNever;  ///< no contact is earlier
  double t_upper = kNever;  ///< one is proven to be no later; kNever: none is proven
};

// static: each instruction set has them for itself.

static inline void joinLower(Bracket& bracket, double t_lower) {
  if (t_lower < bracket.t_lower) bracket.t_lower = t_lower;
}
static inline void joinUpper(Bracket& bracket, double t_upper) {
  if (t_upper < bracket.t_upper) bracket.t_upper = t_upper;
}

/// What `certain` promises: contact is proven, and, unless any contact was asked for, within the tolerance of time.
static inline bool isCertain(const Bracket& bracket, double tolerance_time, bool any) {
  return bracket.t_upper <= 1 && (any || bracket.t_upper - bracket.t_lower <= tolerance_time);
}

}  // namespace engine
}  // namespace fcl_artic
