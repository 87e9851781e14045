// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's motions as plain data. Nothing here moves an FCL object: integrate() is const but writes to it, so it is called
// on copies only.
#pragma once

#include <string>

#include <fcl/math/motion/motion_base.h>
#include <fcl/narrowphase/continuous_collision_request.h>

#include "fcl_artic/fcl_link_motion.h"
#include "motion/body_motion.h"

namespace fcl_artic {

/// Reads the motion that the object performs, that is, what its integrate() and getCurrentTransform() show for t in
/// [0, 1], whatever time it stands at now. The result refers to the object only where that is a BoundedMotion.
///
/// Taken are FCL's four motions, FclLinkMotion, and any class that derives from BoundedMotion as well. A class that
/// derives from one of the former may move otherwise; it is refused unless it is a BoundedMotion.
///
/// Where FCL's objects do something else than their names or end poses say, what they do counts:
/// - TranslationMotion(tf1, tf2) keeps the rotation of tf1.
/// - ScrewMotion between poses less than 1e-10 rad apart keeps the first rotation and goes |d| times as far as the
///   displacement d of its end poses (0.5 m ends at 0.25 m, 6 m at 36 m).
/// - InterpMotion(tf1, tf2) and (R1, T1, R2, T2) leave the reference point, whose path is a straight line, as whatever
///   was in memory before. It is read as FCL reads it; only where its coordinates are not finite or beyond 1e9 m can
///   the mistake be seen. Use the constructor (R1, T1, R2, T2, O).
/// For the motion that is meant between two poses see motionBetween().
///
/// @throws std::invalid_argument naming the type, for
///   - one that is not known;
///   - values that are not finite, beyond 1e9 m, or not rigid;
///   - objects whose constructor left out what the motion is made of (InterpMotion(tf1, tf2, O) and SplineMotion(tf1,
///     tf2)), as far as that shows;
///   - a BoundedMotion that contradicts itself.
template <class S>
BodyMotion readMotion(const fcl::MotionBase<S>& motion);
extern template BodyMotion readMotion(const fcl::MotionBase<float>& motion);
extern template BodyMotion readMotion(const fcl::MotionBase<double>& motion);

/// The motion from one pose to another that the type means. Rotations go the shorter way; by half a turn, either way.
/// - CCDM_TRANS: a straight line. The first rotation is kept, the second one has no effect.
/// - CCDM_LINEAR: the frame's origin goes along a straight line while the frame turns about it, both at constant rates.
/// - CCDM_SCREW: a turn about an axis with a slide along it, both at constant rates; without a turn, a straight line.
/// @throws std::invalid_argument for CCDM_SPLINE, as two poses don't make a spline, and for poses that are not rigid.
BodyMotion motionBetween(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& end, fcl::CCDMotionType type);
BodyMotion motionBetween(const RigidTransform& begin, const RigidTransform& end, fcl::CCDMotionType type);

/// The rigid transform in doubles, its rotation made orthonormal.
/// @throws std::invalid_argument naming `what` when a value is not finite or beyond 1e9 m, or the rotation is off by
///   more than 1e-6 (float: 1e-4).
template <class S>
RigidTransform readTransform(const fcl::Transform3<S>& M, const char* what);
extern template RigidTransform readTransform<float>(const fcl::Transform3<float>& M, const char* what);
extern template RigidTransform readTransform<double>(const fcl::Transform3<double>& M, const char* what);

/// The chain of the link's joints.
const BodyMotion& bodyMotion(const FclLinkMotion& motion);

}  // namespace fcl_artic
