// SPDX-License-Identifier: BSD-3-Clause
//
// Two links whose relative pose depends on two joint variables at most, and perhaps on a third one of little effect.
// The table says for which values of these variables the links are apart, proven once per robot. A query whose motion
// stays within such values need not look at the pair.
//
// The variables' range is cut into cells. A cell counts as proven when the engine has proven the links more than the
// margin apart for all values in it (doc/NUMERICS.md, section 10). A summed-area table answers for any box of cells by
// four look-ups.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"
#include "model/problem.h"
#include "model/query.h"
#include "model/variable_strays.h"

namespace fcl_artic {

class PairTable {
 public:
  /// The cells of one variable: cell i holds [lower + i width, lower + (i + 1) width].
  struct Axis {
    int variable = -1;
    double lower = 0, width = 1;
    int cells = 1;
    bool wraps = false;  ///< the cells are a full turn
    double upper() const { return lower + cells * width; }
  };
  /// The table's variables with their cells. The variable that moves the link farthest comes first. All are chosen
  /// before anything is proven of a cell, and do not change then.
  struct Cells {
    int count = 0;
    Axis axes[3];
  };

  /// @param sweep  that the pair refers to.
  /// @param margin  that the links are proven to keep.
  /// @return null where there is nothing to look up:
  ///   - the pose depends on more variables,
  ///   - joints of other kinds than turns about and slides along an axis, a slide without limits,
  ///   - no cell that could be proven.
  static std::shared_ptr<const PairTable> build(const KinematicTree& tree, const engine::SweepView& sweep,
                                                const engine::Body* bodies, const engine::LinkPair& pair,
                                                double margin);

  double margin() const { return margin_; }
  const Cells& cells() const { return cells_; }

  /// Parts [k/8, (k+1)/8] of a motion, bit k each, over all of which the links are proven more than margin() apart.
  /// @param variables  of the motion: a row each, column k for t^k.
  /// @param half_angles  which of them are tangents of half an angle.
  /// @param strays  values that the variables may have instead: all of them are looked at.
  unsigned freeParts(const Eigen::MatrixXd& variables, const engine::HalfAngles& half_angles = {},
                     const VariableStrays& strays = {}) const;

  /// Whether the links are proven more than margin() apart for all values in a box: `lower[i]` to `upper[i]` of
  /// the variable of cells().axes[i].
  bool free(const double* lower, const double* upper) const;

 private:
  struct Links;
  class Builder;

  PairTable(const Cells& cells, double margin) : cells_(cells), margin_(margin) {}
  static std::optional<const Cells> chooseCells(const KinematicTree& tree, const Links& links);
  static bool cellsOf(const Axis& axis, double lower, double upper, int& first, int& last);
  void sum(const std::vector<std::uint8_t>& proven);

  const Cells cells_;
  const double margin_;
  /// sums_[p * plane_ + i * stride_ + j]: the number, modulo 2^16, of cells (i', j') of the third axis's cell p with i'
  /// < i, j' < j that are not proven. An axis that wraps is there twice, so that every box of less than a turn is one
  /// piece.
  std::vector<std::uint16_t> sums_;
  std::size_t stride_ = 1, plane_ = 1;
};

}  // namespace fcl_artic
