// SPDX-License-Identifier: BSD-3-Clause
//
// The one place that knows how brackets of contact times are ordered and joined, by the engine, the paper's method and
// the queries. All of it is static: each instruction set has its own.
#pragma once

#include "fcl_artic/bracket.h"

namespace fcl_artic {
namespace engine {

/// Later than all of [0, 1]: what does not happen.
constexpr double kNever = 2;

/// When the first of several contacts is. Joined of all contacts that are found, before any of them is left out of what
/// is reported.
struct FirstContact {
  double t_lower = kNever;  ///< no contact is earlier; kNever: there is none
  double t_upper = kNever;  ///< one is proven to be no later; kNever: none is proven
};

static inline void joinLower(FirstContact& first, double t_lower) {
  if (t_lower < first.t_lower) first.t_lower = t_lower;
}
static inline void joinUpper(FirstContact& first, double t_upper) {
  if (t_upper < first.t_upper) first.t_upper = t_upper;
}

/// The promise of `certain`: contact is proven, and, unless any contact was asked for, within the tolerance of time.
static inline bool isCertain(const FirstContact& first, double tolerance_time, bool any) {
  return first.t_upper <= 1 && (any || first.t_upper - first.t_lower <= tolerance_time);
}

/// The answer of a query that was looked at to its end.
static inline Bracket bracketOf(const FirstContact& first, double tolerance_time, bool any) {
  if (first.t_lower >= kNever) return {Status::free, 1, 1, false};
  const double t_upper = first.t_upper < 1 ? first.t_upper : 1;
  return {Status::contact, first.t_lower, t_upper, isCertain(first, tolerance_time, any)};
}
/// The answer of one that was not: the budget ran out, or the caller ended it.
/// @param t_lower  up to which every pair is proven free.
static inline Bracket undecidedBracket(double t_lower, const FirstContact& first) {
  return {Status::undecided, t_lower, first.t_upper < 1 ? first.t_upper : 1, false};
}

/// By when a contact is proven that an answer knows of; kNever: it knows of none.
static inline double provenBy(const Bracket& bracket) {
  return bracket.status != Status::free && (bracket.certain || bracket.t_upper < 1) ? bracket.t_upper : kNever;
}

/// The answer of a trajectory, as far as it is known, takes in that of its next piece, carried into its time.
/// @param whole  free as far as the piece begins, or, if contact_found, with the first contact.
static inline void joinNextPiece(Bracket& whole, const Bracket& piece, bool contact_found) {
  if (!contact_found) {
    whole = piece;
  } else if (piece.status != Status::free) {
    if (piece.t_upper < whole.t_upper) whole.t_upper = piece.t_upper;
    if (piece.status == Status::undecided) {  // not of every pair
      whole.status = Status::undecided;
      whole.certain = false;
    }
  }
}

/// Takes in that a contact of this answer is proven by t_upper.
static inline void sharpen(Bracket& bracket, double t_upper, double tolerance_time, bool any) {
  if (bracket.status == Status::free || t_upper > bracket.t_upper) return;  // at 1, where none is proven yet, it counts
  bracket.t_upper = t_upper;
  bracket.certain = bracket.certain || isCertain({bracket.t_lower, t_upper}, tolerance_time, any);
}

}  // namespace engine
}  // namespace fcl_artic
