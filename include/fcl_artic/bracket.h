// SPDX-License-Identifier: BSD-3-Clause
//
// What is proven of when bodies touch. Plain data: the engine, which is compiled for several instruction sets, has it
// too.
#pragma once

#include <cstdint>

namespace fcl_artic {

enum class Status : std::int32_t {
  free,       ///< proven: no checked pair touches during the motion
  contact,    ///< first contact within [t_lower, t_upper] (see Bracket::certain)
  undecided,  ///< the work budget ran out, or `progress` ended the query; free on [0, t_lower) is proven
};

/// The verdict of a query, and the bracket [t_lower, t_upper] that holds the first contact. Time is the motion's,
/// t in [0, 1]; of a trajectory it is the trajectory's own.
struct Bracket {
  Status status = Status::undecided;
  /// The motion is proven free on [begin, t_lower).
  double t_lower = 0;
  /// With `certain`, the first contact is proven to lie at or before t_upper. Otherwise the motion's end, or the time
  /// of a later proven contact.
  double t_upper = 1;
  /// Contact is proven, not only undecidable within the tolerances; t_upper - t_lower is no more than tolerance_time
  /// then, but with ContactMode::any.
  bool certain = false;

  /// Proven: nothing touches. Neither a contact nor an undecided motion is free.
  [[nodiscard, gnu::always_inline]] bool isFree() const { return status == Status::free; }
};

}  // namespace fcl_artic
