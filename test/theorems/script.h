// SPDX-License-Identifier: BSD-3-Clause
//
// Gappa's scripts of what was recorded: each operation once as the processor does it, rounded, and once exact.
#pragma once

#include <string>
#include <vector>

#include "recorded.h"

namespace recording {

/// How the operations round.
struct Arithmetic {
  const char* mode;  ///< Gappa's: ne, zr, up, dn
  bool fused;        ///< mulAdd() rounds once
};

/// A statement on what is recorded between its making and its end, for a slice of the sizes.
class Statement {
 public:
  Statement();
  /// A number that is given, between these bounds, with a value well within.
  Recorded input(Real bound) { return input(-bound, bound); }
  Recorded input(Real least, Real most);
  /// The computed number counts as given from here on, and how it was computed does not matter.
  void cut(Recorded x, Real least, Real most);
  /// A bound that is known of the exact value of something that was computed.
  void known(Recorded x, Real bound);
  /// The same for all sums of products of a component of one vector with one of another. By Cauchy and Schwarz, no part
  /// of such a sum exceeds the product of their lengths.
  /// @return the nodes of these sums.
  std::vector<int> knownDots(const std::vector<int>& a, const std::vector<int>& b, Real bound);
  /// States: what is computed is off by at most `bound` from what it would be without rounding.
  void offBy(Recorded x, Real bound) { terms_.push_back({Kind::error, x, 0.0, bound}); }
  /// a - b, each as computed, from the exact difference.
  void offBy(Recorded a, Recorded b, Real bound) { terms_.push_back({Kind::error, a, b, bound}); }
  /// States: what is computed is off by at most `bound` of what it would be without rounding.
  void offByPart(Recorded x, Real bound) { terms_.push_back({Kind::part, x, 0.0, bound}); }
  /// States: as computed, a - b does not exceed `bound`.
  void below(Recorded a, Recorded b, Real bound) { terms_.push_back({Kind::order, a, b, bound}); }

  /// Gappa's text. @param ask  instead of stating bounds asks for them.
  std::string script(const Arithmetic& arithmetic, Real factor, bool ask) const;
  /// Bounds of the statements, in their order.
  std::vector<Real> bounds() const;

 private:
  enum class Kind { error, part, order };
  struct Term {
    Kind kind;
    Recorded a, b;
    Real bound;
  };
  struct Known {
    int node;
    Real bound;
  };
  struct Input {
    int node;
    Real least, most;
  };
  std::vector<Input> inputs_;
  std::vector<Known> known_;
  std::vector<Term> terms_;
};

}  // namespace recording
