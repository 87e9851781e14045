// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::bench {

/// Ends of a straight motion of some joints.
struct Ends {
  std::vector<double> from, to;
};

/// A random motion of this length (the Euclidean norm over the joints) that begins within the joints' limits.
/// @param[out] within  it ends there too.
inline Ends randomEnds(const KinematicTree& tree, const std::vector<std::string>& joints, double length,
                       std::mt19937& random, bool& within) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Ends ends;
  double norm = 0;
  for (const std::string& joint : joints) {
    const Joint& j = tree.joint(tree.jointId(joint));
    ends.from.push_back(0.5 * (j.lower + j.upper) + 0.5 * (j.upper - j.lower) * unit(random));
    ends.to.push_back(unit(random));
    norm += ends.to.back() * ends.to.back();
  }
  within = true;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& j = tree.joint(tree.jointId(joints[i]));
    ends.to[i] = ends.from[i] + ends.to[i] * length / std::sqrt(norm);
    within = within && ends.to[i] >= j.lower && ends.to[i] <= j.upper;
  }
  return ends;
}

}  // namespace fcl_artic::bench
