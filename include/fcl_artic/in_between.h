// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "fcl_artic/joint_motion.h"

namespace fcl_artic {

/// The arbitrary in-between motion of Redon, Kim, Lin and Manocha (2004), Section 3, between two sets of link poses:
/// seen from its parent, each link's origin moves at constant velocity, and the link turns about a fixed axis at
/// constant speed, the shortest way. No joint is asked for; the poses at both ends are met, whatever the joints would
/// allow. (The other form of Section 3, every joint at constant speed, is JointMotion::linear().)

/// The same links and parents, each link on a floating joint of its own, named as the joint that it replaces. Links
/// keep their numbers; roots, which may move too, hang on a further link, "in_between_world" (with as many "_" behind
/// it as it takes to be a new name). For an ArticulatedCollisionManager in place of the tree itself.
FCL_ARTIC_EXPORT std::shared_ptr<const KinematicTree> inBetweenTree(const KinematicTree& tree);

/// @param tree  made by inBetweenTree().
/// @param M_0_begin, M_0_end poses of all links in the world at t = 0 and t = 1, in the order of the links; without the
///   further link, which rests at the origin.
/// @throws std::invalid_argument for another number of poses, one that is not rigid, or a tree that was not made so.
FCL_ARTIC_EXPORT JointMotion inBetweenMotion(const KinematicTree& tree, const std::vector<Eigen::Isometry3d>& M_0_begin,
                                             const std::vector<Eigen::Isometry3d>& M_0_end);

}  // namespace fcl_artic
