// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "fcl_artic/redon2004.h"

namespace fcl_artic {

/// Which contacts a query looks for.
enum class ContactMode {
  first,  ///< The first contact of the whole motion.
  /// Any contact that can be proven soon: cheaper if only the verdict matters. A free answer is as certain as with
  /// `first`. The contact is proven at t_upper; t_lower, up to which the motion is proven free, is often 0.
  any,
  firstOfEveryPair,  ///< The first contact of every pair of bodies that touches.
};

/// Whether stage 2, culling by visibility (doc/VISIBILITY.md), takes part in a query of an ArticulatedCollisionManager.
/// It looks at links against obstacles, still or moving, and against links. Answers are the same bits either way; a
/// work budget turns the stage off.
enum class VisibilityMode {
  off,  ///< Never.
  on,   ///< Always. A query that does not end as plainly free is solved again without the stage.
};

/// The method that solves a query. Both make the same promise (doc/PROMISE.md).
enum class Method {
  standard,  ///< The library's own method (doc/ARCHITECTURE.md).
  /// The method of Redon, Kim, Lin, Manocha, "Fast Continuous Collision Detection for Articulated Models" (2004), with
  /// the options of RedonOptions (doc/REDON2004.md).
  redon2004,
};

/// How near counts as contact, and how finely a query locates it in time. Queries throw std::invalid_argument, naming
/// the value, for values outside the ranges given here.
struct Tolerances {
  /// Wanted width of [t_lower, t_upper], above 0: in normalized time, [0, 1]; for a trajectory in the unit of its
  /// times.
  double tolerance_time = 1e-6;
  /// Bodies whose gap can't be proven count as touching, with certain = false, only if the gap is below this length, in
  /// m, or too small for rounding to decide. Above 0.
  double tolerance_distance = 1e-6;
  /// Bodies nearer than this, in m, count as touching; finite, at least 0. Margins of a pair's or body's own replace
  /// it, also where they are smaller (ArticulatedCollisionManager::setMargin).
  double margin = 0;
  /// Added to the margin of every pair, in m: to `margin` and to margins that pairs and bodies have of their own.
  /// Finite, at least 0. The sum as rounded counts.
  double added_margin = 0;
};

/// How a query is solved, and how much work it may take.
struct Effort {
  /// The method. Method::redon2004 solves pairs of meshes and boxes without a margin. It leaves the following to
  /// Method::standard, pair by pair (RedonStatistics::pairs_by_standard):
  /// - other pairs,
  /// - pairs that have a margin of their own (also 0, as neighbours that are checked for touching),
  /// - pairs that touch at t = 0.
  ///
  /// It answers ContactMode::any with the first contact.
  Method method = Method::standard;
  /// Options of Method::redon2004; not used by Method::standard.
  RedonOptions redon;
  /// Maximum amount of work; 0: no limit. (Method::redon2004 leaves a query that takes it more than 2^17 tests to
  /// Method::standard then.) It is counted in node and leaf tests, for Method::redon2004 also in box tests, leaf
  /// pairs, equations and evaluations. So the answer does not depend on the machine's speed.
  ///
  /// When it is exceeded, the answer is `undecided`, and what it has proven holds: the motion is free up to t_lower.
  /// (With `firstOfEveryPair` t_lower is the motion's begin then, and with ignore_initial_contact it may be.) The
  /// pieces of a trajectory, and the pairs of a ContinuousCollisionManager, share one budget.
  std::uint64_t work_budget = 0;
  /// Whether to measure the time of each stage (QueryStatistics). Counts are always kept.
  bool measure_times = false;
};

/// Which pairs an ArticulatedCollisionManager checks: in queries, and for a clearance.
struct Scope {
  bool check_scene = true;  ///< Links against obstacles.
  bool check_self = true;   ///< Links, and the objects attached to them, against each other.
};

/// Request of a certified continuous query of two moving bodies. All defaults are safe: nothing has to be tuned.
struct CertifiedPairRequest : Tolerances, Effort {
  /// Which contacts are looked for. A query of two bodies has one pair: `firstOfEveryPair` is `first` there.
  ContactMode mode = ContactMode::first;
  /// Maximum number of contacts reported, each of another pair of bodies; t_lower and t_upper take all contacts into
  /// account, also with 0, which saves the time of describing contacts. With `first` each contact reported may be the
  /// first: none begins after t_upper. If there are too many, the earliest are kept. A query of two bodies has one
  /// contact at most.
  std::size_t max_contacts = 1;
  /// Whether pairs that touch at t = 0 (strictly: that are not proven apart then) may separate first. Such a pair is
  /// not checked until it is proven apart over a whole time interval of 1/8, 1/64 or 1/512 of the motion. From the
  /// start of the first such interval on it is checked as any other. Shorter separations are not looked for. A pair
  /// that is only within its margin at t = 0 is left out likewise, even if it touches before it has kept the margin.
  /// To exclude that, ask without the margin too. All parts of one body count as one: a link that touches one point of
  /// a cloud is not checked against the others.
  bool ignore_initial_contact = false;
  /// Called now and then, from the querying thread, with the time up to which the motion is proven free so far. (With
  /// `firstOfEveryPair` this is the motion's or piece's begin, after the first contact its t_lower.) May be empty. If
  /// it returns false, the query ends with `undecided`: for a planner's clock, or a stop button. Queries of many
  /// motions, and those of a ContinuousCollisionManager, do not call it.
  std::function<bool(double t_lower)> progress;
  /// Whether the result carries its proof (Certificate). It takes about a millisecond for an arm in a small scene;
  /// queries that don't ask take no longer. A ContinuousCollisionManager has none to give and refuses.
  bool certificate = false;
};

/// Request of a certified continuous query of an ArticulatedCollisionManager: what a query of two bodies has, which
/// pairs are checked, and whether stage 2 takes part. All defaults are safe: nothing has to be tuned.
struct CertifiedRequest : CertifiedPairRequest, Scope {
  /// Whether stage 2, culling by visibility, takes part. ArticulatedCollisionManager::setVisibility() selects the
  /// culler.
  VisibilityMode visibility = VisibilityMode::off;
};

}  // namespace fcl_artic
