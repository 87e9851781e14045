// SPDX-License-Identifier: BSD-3-Clause
//
// Work of queries. Each struct lists its numbers once, in forEachField(). All code that adds, prints or writes them
// goes by that list, so that a new number is a member here and its line in the list.
#pragma once

#include <cstdint>

namespace fcl_artic {

/// Work of the library's own method (Method::standard), by stage. Times are in µs, and 0 without Effort::measure_times.
struct StandardStatistics {
  std::uint64_t batches = 0;             ///< Batches of eight time intervals.
  std::uint64_t motion_evaluations = 0;  ///< Frames evaluated, over one batch each.
  std::uint64_t node_tests = 0;          ///< Pairs of bounding volumes tested, over eight time intervals each.
  std::uint64_t leaf_tests = 0;          ///< Pairs of convex pieces tested, over eight time intervals each.
  std::uint64_t certificates = 0;        ///< Separating directions checked, over eight time intervals each.
  std::uint64_t gjk = 0;                 ///< Searches for witness directions by GJK.
  std::uint64_t contact_proofs = 0;      ///< Poses at which a proof of contact was tried.
  double culling_us = 0;                 ///< Time of stage 1, µs.
  double narrowphase_us = 0;             ///< Time of the search after stages 1 and 2, µs.

  /// Calls visit(name, pointer to member) for every field.
  template <class Visit>
  static void forEachField(const Visit& visit) {
    using S = StandardStatistics;
    visit("batches", &S::batches);
    visit("motion_evaluations", &S::motion_evaluations);
    visit("node_tests", &S::node_tests);
    visit("leaf_tests", &S::leaf_tests);
    visit("certificates", &S::certificates);
    visit("gjk", &S::gjk);
    visit("contact_proofs", &S::contact_proofs);
    visit("culling_us", &S::culling_us);
    visit("narrowphase_us", &S::narrowphase_us);
  }
};

/// Work of the paper's method (Method::redon2004). Symbols and equations are those of Redon et al. (2004). Times are in
/// µs, and 0 without Effort::measure_times.
struct RedonStatistics {
  std::uint64_t pairs_by_standard = 0;  ///< Pairs of bodies that were left to Method::standard.
  std::uint64_t box_tests = 0;          ///< Pairs of oriented boxes tested, one sub-interval each.
  std::uint64_t leaf_pairs = 0;         ///< Pairs of triangles whose boxes meet.
  std::uint64_t equations = 0;          ///< Elementary equations made: n_e.
  std::uint64_t intervals = 0;          ///< Time intervals over which motions were bounded: s_max of eq. (17).
  std::uint64_t evaluations = 0;        ///< Equations bounded, over an interval each: a n_e.
  std::uint64_t steps_bounded = 0;      ///< Moving joints of chains bounded, over an interval each.
  double culling_us = 0;                ///< Time of dynamic BVH culling (Section 4), µs.
  double boxes_us = 0;                  ///< Time of the trees of oriented boxes (Section 5.1), µs.
  double equations_us = 0;              ///< Time of the equations (Section 5.2), µs.
  double visibility_us = 0;             ///< Time of stage 2, including the bounds on what links sweep, µs.

  /// Calls visit(name, pointer to member) for every field.
  template <class Visit>
  static void forEachField(const Visit& visit) {
    using S = RedonStatistics;
    visit("pairs_by_standard", &S::pairs_by_standard);
    visit("box_tests", &S::box_tests);
    visit("leaf_pairs", &S::leaf_pairs);
    visit("equations", &S::equations);
    visit("intervals", &S::intervals);
    visit("evaluations", &S::evaluations);
    visit("steps_bounded", &S::steps_bounded);
    visit("culling_us", &S::culling_us);
    visit("boxes_us", &S::boxes_us);
    visit("equations_us", &S::equations_us);
    visit("visibility_us", &S::visibility_us);
  }
};

/// Work of stage 2, culling by visibility (doc/VISIBILITY.md).
struct VisibilityStatistics {
  std::uint64_t pairs = 0;     ///< Pairs that it looked at.
  std::uint64_t culled = 0;    ///< Pairs that it proved free.
  std::uint64_t nodes = 0;     ///< Nodes of large bodies that it proved free, in other pairs.
  std::uint64_t pieces = 0;    ///< Pieces of the other bodies that it drew.
  std::uint64_t repeated = 0;  ///< Queries that were solved again without it, as they were not simply free.
  double us = 0;               ///< Time, µs; always measured.

  /// Calls visit(name, pointer to member) for every field.
  template <class Visit>
  static void forEachField(const Visit& visit) {
    using S = VisibilityStatistics;
    visit("pairs", &S::pairs);
    visit("culled", &S::culled);
    visit("nodes", &S::nodes);
    visit("pieces", &S::pieces);
    visit("repeated", &S::repeated);
    visit("us", &S::us);
  }
};

}  // namespace fcl_artic
