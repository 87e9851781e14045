// SPDX-License-Identifier: BSD-3-Clause
//
// Two links whose relative pose depends on two joint variables at most, or on a third one of little effect: where among
// these the links are apart, proven once per robot. A query whose motion stays there need not look at the pair.
//
// The variables' range is cut into cells; a cell counts as proven when the engine has proven the links more than the
// margin apart for all values in it (doc/NUMERICS.md, section 10). A summed-area table answers for any box of cells by
// four look-ups.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"
#include "narrowphase/problem.h"

namespace fcl_artic {

class PairTable {
 public:
  /// @param sweep  that the pair refers to.
  /// @param margin  that the links are proven to keep.
  /// @return null where there is nothing to look up: more variables, joints of other kinds than turns about and slides
  ///   along an axis, a slide without limits, or no cell that could be proven.
  static std::shared_ptr<const PairTable> build(const KinematicTree& tree, const engine::SweepView& sweep,
                                                const engine::Body* bodies, const engine::LinkPair& pair,
                                                double margin);

  double margin() const { return margin_; }

  /// Parts [k/8, (k+1)/8] of a motion, bit k each, over all of which the links are proven more than margin() apart.
  /// @param variables  of the motion: a row each, column k for t^k.
  unsigned freeParts(const Eigen::MatrixXd& variables) const;

  /// Whether the links are proven more than margin() apart for all values in a box: `lower[i]` to `upper[i]` of
  /// the variable of axes_[i].
  bool free(const double* lower, const double* upper) const;

 private:
  /// The cells of one variable: cell i holds [lower + i width, lower + (i + 1) width].
  struct Axis {
    int variable = -1;
    double lower = 0, width = 1;
    int cells = 1;
    bool wraps = false;  ///< the cells are a full turn
    double upper() const { return lower + cells * width; }
  };
  class Builder;

  static bool cellsOf(const Axis& axis, double lower, double upper, int& first, int& last);
  void sum(const std::vector<std::uint8_t>& proven);

  double margin_ = 0;
  int num_axes_ = 0;
  Axis axes_[3];  ///< by how far they take the link, the farthest first
  /// sums_[p * plane_ + i * stride_ + j]: of the third axis's cell p, cells (i', j') with i' < i, j' < j that are not
  /// proven, modulo 2^16. An axis that wraps is there twice, so that every box of less than a turn is one piece.
  std::vector<std::uint16_t> sums_;
  std::size_t stride_ = 1, plane_ = 1;
};

}  // namespace fcl_artic
