// SPDX-License-Identifier: BSD-3-Clause
//
// Random straight motions in joint space within the joints' limits, and the steps that OMPL would sample them in.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"
#include "random.h"

namespace fcl_artic::app {

/// Ends of a straight motion in joint space, all joint variables each.
struct MotionEnds {
  Eigen::VectorXd from, to;
};

/// Draws motions that begin anywhere within the joints' limits and end near there. The same seed draws the same ones.
///
/// A joint that turns begins within its limits or, if it has none, within +-pi, and moves by at most the given angle. A
/// length begins within its limits or +-1 m, and moves by the same part of that range as the angle is of a full turn. A
/// quaternion begins anywhere and turns by at most the angle. Ends beyond a limit are not drawn. Angles and lengths are
/// multiples of 1e-6, or a limit, so that they are short to write.
class RandomMotions {
 public:
  /// @param tree   must outlive this object.
  /// @param angle  rad, above 0.
  /// @throws std::invalid_argument for a tree without joint variables.
  RandomMotions(const KinematicTree& tree, double angle, std::uint64_t seed);
  MotionEnds next();

 private:
  double between(double low, double high);
  void drawQuaternion(int first, MotionEnds& ends);
  const KinematicTree& tree_;
  double angle_;
  Random random_;
};

/// Number of steps in which OMPL's discrete motion validator samples a motion, its validSegmentCount(). A step is at
/// most this part of the space's extent. All joints with limits are taken together, each joint without limits by
/// itself.
/// @param resolution  such as 0.01, OMPL's default.
int numSteps(const KinematicTree& tree, const MotionEnds& ends, double resolution);

/// A configuration as `check --from` and `--to` read it, all digits: "0.1,-2".
std::string configurationText(const Eigen::VectorXd& q);

}  // namespace fcl_artic::app
