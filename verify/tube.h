// SPDX-License-Identifier: BSD-3-Clause
// How far tolerances let the points of two bodies move against each other: see doc/TUBES.md.
#pragma once

#include <optional>

#include "motion.h"

namespace verify {

/// Pieces [from, to) of a body.
struct Part {
  int body;
  std::uint32_t from, to;
};

/// The three Bernstein coefficients of a length over an interval of time.
using Lengths = std::array<Fix, 3>;

/// Coefficients of a line that is nowhere below the way that a body may have come by itself (doc/TUBES.md, "Speeds").
Lengths wayOf(const World& world, const Piece& piece, const Span& span, int body);

class Tube {
 public:
  Tube(const World& world, Poses& poses, const Span& span, const Part& a)
      : world_(world), poses_(poses), span_(span), a_(a) {}

  /// Whether two parts stay apart in the whole tube.
  /// @param closed  Bernstein coefficients of -gap, along a direction of that length or less, with the margin: below 0
  ///   where they are apart on the motion itself.
  bool covers(const Lengths& closed, Fix length, const Part& b);

 private:
  using Moves = std::vector<std::optional<Lengths>>;
  /// Bounds on how far the part's points move at each place that gives, on the way from it to a body. None: any
  /// distance.
  Moves movesOf(const Part& part, int other);
  std::optional<Lengths> move(const Part& part, const Give& give, const Pose& pose);

  const World& world_;
  Poses& poses_;
  const Span span_;
  const Part a_;
  // The last partner that stands like this one: of many obstacles the way is the same.
  int known_frame_ = -1;
  Moves known_;
};

}  // namespace verify
