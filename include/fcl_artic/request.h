// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace fcl_artic {

/// What to look for.
enum class ContactMode {
  first,  ///< the first contact of the whole motion
  /// Any contact that can be proven soon: cheaper where only the verdict counts; free is as certain. The contact is
  /// proven at t_upper; t_lower says only up to when the motion is free, often 0.
  any,
  firstOfEveryPair,  ///< the first contact of every pair of bodies that touches
};

/// Stage 2, culling by visibility (doc/VISIBILITY.md): in queries of an ArticulatedCollisionManager, of links against
/// obstacles that stand still. No answer depends on it. Off with a work budget.
enum class VisibilityMode {
  off,
  on,
  automatic,  ///< where it pays, as measured on the manager's own queries
};

/// How a query is solved. Both give the same promise.
enum class Method {
  standard,   ///< the library's own
  redon2004,  ///< "Fast Continuous Collision Detection for Articulated Models" (Redon, Kim, Lin, Manocha 2004)
};

/// How the paper's method bounds a link's motion over a time interval.
enum class MotionEnclosure {
  intervalChain,  ///< products of interval matrices down the chain: the paper's
  meanValue,      ///< X(tm) + X'(T) (T - tm)
  taylor,         ///< a quadratic with a bounded remainder
};

/// Each idea of the paper's method by itself (doc/REDON2004.md). The defaults are the paper's, but for the last two:
/// with both false the method is as the paper has it.
struct RedonOptions {
  MotionEnclosure enclosure = MotionEnclosure::intervalChain;
  /// A link's bounds are kept on 2^level parts of the motion (Section 5.1.1). -1: by the link's motion; 0: undivided;
  /// at most 6.
  int refinement_level = -1;
  bool simultaneous = true;  ///< one list of equations per time interval (5.2.2); false: each equation by itself
  bool newton = true;        ///< interval Newton, eq. (18)
  /// Whether features of an equation can touch is asked in every interval; false: at the last, as the paper has it.
  bool early_validity = true;
  /// Boxes and equations go together through the sub-intervals in the order of time, up to the first contact; false:
  /// all boxes over the whole motion first, as the paper has it.
  bool in_time_order = true;
};

/// How near counts as contact, and how finely a query tells when.
struct Tolerances {
  /// Wanted width of [t_lower, t_upper], above 0; t runs from 0 to 1.
  double tolerance_time = 1e-6;
  /// A pair counts as touching (with certain = false) only when its gap is below this, in m; above 0.
  double tolerance_distance = 1e-6;
  /// Bodies nearer than this, in m, count as touching (pairs with a margin of their own go by that:
  /// ArticulatedCollisionManager::setMargin).
  double margin = 0;
  /// Added to every pair's margin, in m: to `margin`, and to the margins that pairs and bodies have in its place too.
  /// For room that is wanted whatever the margins are. Bodies count as touching that are nearer than the sum, as
  /// rounded.
  double added_margin = 0;
};

/// How a query is solved, and how much work it may be.
struct Effort {
  /// Method::redon2004 solves pairs of meshes and boxes without a margin; other pairs, and what touches at t = 0, are
  /// left to Method::standard, pair by pair (RedonStatistics::pairs_by_standard). ContactMode::any is answered with the
  /// first contact.
  Method method = Method::standard;
  RedonOptions redon;
  /// Node and leaf tests after which the answer is `undecided`; 0: no limit. (Of Method::redon2004's own work, box
  /// tests and evaluations count too.) Counted work, not time, so that the answer does not depend on the machine. A
  /// trajectory's pieces share one budget.
  std::uint64_t work_budget = 0;
  /// Measure the time of each stage too (counts are always there).
  bool measure_times = false;
};

/// Which pairs a manager of links and obstacles looks at.
struct Scope {
  bool check_scene = true;  ///< links against obstacles
  bool check_self = true;   ///< links against links
};

/// What a certified continuous query of two moving bodies is asked. All defaults are safe: nothing has to be tuned.
struct CertifiedPairRequest : Tolerances, Effort {
  ContactMode mode = ContactMode::first;
  /// At most so many contacts are reported; t_lower and t_upper are those of all. With mode `first` each of them may be
  /// the first: none begins after t_upper. With `firstOfEveryPair` they are in the order of their t_lower; of more than
  /// so many every pair's first contact is kept before any pair's second, and of these the earliest.
  std::size_t max_contacts = 1;
  /// Pairs that touch at t = 0 may separate; they are watched from the moment they have.
  bool ignore_initial_contact = false;
  /// Called now and then, from the querying thread, with the time up to which the motion is proven free so far. False
  /// ends the query, which is `undecided` then: for a planner's clock, or a button.
  std::function<bool(double t_lower)> progress;
};

/// What a certified continuous query of an ArticulatedCollisionManager is asked: the same, which pairs, and whether
/// stage 2 takes part. All defaults are safe: nothing has to be tuned.
struct CertifiedRequest : CertifiedPairRequest, Scope {
  VisibilityMode visibility = VisibilityMode::off;
};

}  // namespace fcl_artic
