// SPDX-License-Identifier: BSD-3-Clause
//
// The motion of what a link carries, as one body's motion.
#pragma once

#include "fcl_artic/joint_motion.h"
#include "fcl_artic/kinematic_tree.h"
#include "motion/body_motion.h"

namespace fcl_artic {

/// The way from the root to the frame at `offset` in the link. Slides by vectors are three prismatic elements, and
/// turns at a constant rate revolute ones.
/// @param motion  of the tree, polynomial.
BodyMotion linkMotion(const KinematicTree& tree, const JointMotion& motion, LinkId link, const RigidTransform& offset);

}  // namespace fcl_artic
