// SPDX-License-Identifier: BSD-3-Clause
//
// In which configurations two links are likely to touch: a guess, made once per robot, of the poses at which a query
// for any contact looks first. Nothing rests on it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "model/problem.h"

namespace fcl_artic {

/// A joint variable's range: its limits, or a turn where these are no narrower.
struct VariableRange {
  double lower = 0, per_range = 0;  ///< 1 / range; 0: it has none
  bool wraps = false;

  VariableRange() = default;
  VariableRange(const KinematicTree& tree, int variable);
  double value(double part) const { return lower + part / per_range; }
  /// Where in the range q is, in [0, 1).
  double part(double q) const {
    double part = (q - lower) * per_range;
    if (wraps) part -= static_cast<double>(static_cast<std::int64_t>(part)) - (part < 0);
    constexpr double kBelowOne = 1 - 0x1p-40;
    return part > 0 ? part < kBelowOne ? part : kBelowOne : 0;
  }
};

class ContactGrid {
 public:
  static constexpr std::size_t kMaxVariables = 3;

  /// For two links whose relative pose depends on three joint variables at most: whether balls inside both meet in the
  /// middle of each cell of the variables' ranges.
  /// @param sweep  that the pair refers to.
  /// @return null where there is nothing to look up:
  ///   - more variables,
  ///   - joints of other kinds than turns about and slides along an axis, a slide without limits,
  ///   - a link without balls, or no cell in which they meet.
  static std::shared_ptr<const ContactGrid> build(const KinematicTree& tree, const engine::SweepView& sweep,
                                                  const engine::LinkPair& pair, const engine::Body* bodies);

  struct Axes {
    int count = 0, cells = 1;  ///< cells along each
    int variables[kMaxVariables];

    /// @param parts  of each variable's range.
    std::size_t cell(const double* parts) const {
      int cell = 0;
      for (int i = 0; i < count; ++i) cell = cell * cells + static_cast<int>(parts[variables[i]] * cells);
      return static_cast<std::size_t>(cell);
    }
  };

  const Axes& axes() const { return axes_; }
  const std::vector<bool>& touching() const { return touching_; }

 private:
  Axes axes_;
  std::vector<bool> touching_;  ///< by cell
};

}  // namespace fcl_artic
