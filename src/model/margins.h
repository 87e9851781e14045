// SPDX-License-Identifier: BSD-3-Clause
//
// The margins of a query's pairs.
#pragma once

#include <cstdint>

#include "model/pair_id.h"

namespace fcl_artic {
namespace engine {

/// The margins of a query's pairs, m, and all that any part of the library knows of them. A pair's margin is its own,
/// else the one requested, and to either is added what the query adds. These parts can't be had one by one, so that
/// nobody can leave one out. (Sums are as rounded. Inlined always: each instruction set has the code for itself.)
class Margins {
 public:
  /// All pairs have the margin requested.
  [[gnu::always_inline]] explicit Margins(double requested = 0, double added = 0)
      : requested_(requested + added), added_(added), largest_(requested_) {}

  /// Margins of the pairs' own: per scene pair and per link pair, below 0: none; null: no pair of that kind has one.
  /// @param largest  of all of them.
  [[gnu::always_inline]] void setOwn(const double* scene, std::int32_t num_scene_pairs, const double* link,
                                     double largest) {
    scene_ = scene;
    link_ = link;
    pairs_.num_scene_pairs = num_scene_pairs;
    largest_ = largest + added_ > requested_ ? largest + added_ : requested_;
  }
  /// For a problem that leaves out the first n link pairs.
  [[gnu::always_inline]] void skipLinkPairs(std::int32_t n) {
    if (link_) link_ += n;
  }

  /// The margin of a pair by its number in the problem.
  [[gnu::always_inline]] double of(PairId pair) const {
    const double* own = pairs_.in(scene_, link_, pair);
    return ofOwn(own ? *own : -1);
  }
  /// Whether the pair has a margin of its own, 0 included.
  [[gnu::always_inline]] bool isOwn(PairId pair) const {
    const double* own = pairs_.in(scene_, link_, pair);
    return own && *own >= 0;
  }
  /// The margin of a pair that the problem leaves out, by its own; below 0: none.
  [[gnu::always_inline]] double ofOwn(double own) const { return own >= 0 ? own + added_ : requested_; }
  /// No pair of the problem has a larger one.
  [[gnu::always_inline]] double largest() const { return largest_; }

 private:
  const double *scene_ = nullptr, *link_ = nullptr;
  PairNumbering pairs_;
  double requested_, added_, largest_;  ///< the first and the last with what is added
};

}  // namespace engine
}  // namespace fcl_artic
