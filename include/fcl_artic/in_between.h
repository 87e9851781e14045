// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "fcl_artic/joint_motion.h"

namespace fcl_artic {

/// Makes the tree on which inBetweenMotion() moves. It has the same links and parents. Each link is on a floating
/// joint of its own, which has the name of the joint that it replaces. Links keep their numbers; roots, which may move
/// too, hang on one further link, "in_between_world" (with as many "_" appended as make it a new name). Give it to an
/// ArticulatedCollisionManager in place of the tree itself.
FCL_ARTIC_EXPORT std::shared_ptr<const KinematicTree> inBetweenTree(const KinematicTree& tree);

/// Makes the arbitrary in-between motion of Redon, Kim, Lin and Manocha (2004), Section 3, between two sets of link
/// poses. Seen from its parent, each link's origin moves at constant velocity, and the link turns about a fixed axis
/// at constant speed, the shortest way. Both ends are met, whatever the joints of the robot would allow. (The other
/// form of Section 3, every joint at constant speed, is JointMotion::linear().)
/// @param tree  made by inBetweenTree().
/// @param M_0_begin, M_0_end  poses of all links at t = 0 and t = 1, link to world, in the order of the links; without
///   the further link, which rests at the origin. Their rotations are made orthonormal.
/// @throws std::invalid_argument for
///   - another number of poses,
///   - a pose that is not rigid to 1e-6,
///   - a tree that was not made by inBetweenTree(),
///   - all that JointMotion::linear() throws for: coordinates of a link's origin in its parent's frame are at most 1e5
///     m.
FCL_ARTIC_EXPORT JointMotion inBetweenMotion(const KinematicTree& tree, const std::vector<Eigen::Isometry3d>& M_0_begin,
                                             const std::vector<Eigen::Isometry3d>& M_0_end);

}  // namespace fcl_artic
