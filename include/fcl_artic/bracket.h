// SPDX-License-Identifier: BSD-3-Clause
//
// When bodies touch, as far as it is proven. Plain data: the engine, which is compiled for several instruction sets,
// has it too.
#pragma once

#include <cstdint>

namespace fcl_artic {

/// The verdict of a query.
enum class Status : std::int32_t {
  free,       ///< Proven: no checked pair comes within its margin (0: touches) at any time of the motion.
  contact,    ///< Contact, proven if Bracket::certain; otherwise it can't be excluded within the tolerances.
  undecided,  ///< The work budget ran out, or `progress` ended the query. The motion is proven free on [0, t_lower).
};

/// The verdict of a query, and the bracket [t_lower, t_upper] of the time of first contact. Base of all results.
///
/// Time is the motion's, t in [0, 1]; for a trajectory it is the trajectory's own time. doc/PROMISE.md says what is
/// proven, and what the proof rests on.
struct Bracket {
  /// The verdict. `undecided` until a query has answered, and after a query that throws.
  Status status = Status::undecided;
  /// The motion is proven free on [begin, t_lower), whatever the status. The motion's end if it is free.
  double t_lower = 0;
  /// With `certain`, the first contact is proven to lie at or before t_upper. Otherwise t_upper is the time of some
  /// proven contact, more than tolerance_time after t_lower, or the motion's end.
  double t_upper = 1;
  /// True if contact is proven and, except with ContactMode::any and with tolerances of joints or poses, t_upper -
  /// t_lower <= tolerance_time. (In a trajectory's time, rounding adds a few ulp to the width.) False if the status is
  /// not `contact`, and for touches that stay grazes. One example is bodies that rest on each other. Another is two
  /// equal cubes as meshes that are pushed flush face to face: their edges lie in each other's faces at every time.
  bool certain = false;

  /// Whether the motion is proven free of contact. False for a contact that is not certain and for `undecided`.
  [[nodiscard, gnu::always_inline]] bool isFree() const { return status == Status::free; }
};

}  // namespace fcl_artic
