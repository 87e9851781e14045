// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pairs/path.h"

namespace pair_campaign {

/// A motion of the test's own, as a user writes one (fcl_artic::BoundedMotion): turns about a fixed axis and goes along
/// a line, both with a sine on top.
struct Wobble {
  Eigen::Matrix3d R1 = Eigen::Matrix3d::Identity();
  pairs::Vec3 axis = pairs::Vec3::UnitZ();
  double turn = 0, turn_swing = 0;                                                                  ///< rad
  pairs::Vec3 start = pairs::Vec3::Zero(), way = pairs::Vec3::Zero(), swing = pairs::Vec3::Zero();  ///< m
  double frequency = 1;         ///< rad per unit of t
  bool has_derivatives = true;  ///< tells more than poses and bounds on speeds
};
pairs::PathPtr boundedPath(const Wobble& wobble);

}  // namespace pair_campaign
