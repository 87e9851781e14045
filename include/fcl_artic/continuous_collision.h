// SPDX-License-Identifier: BSD-3-Clause
//
// The drop-in for FCL's <fcl/narrowphase/continuous_collision.h>: the same functions on the same types, with proven
// answers. Code that says `namespace ccd = fcl;` may say `namespace ccd = fcl_artic;` (doc/MIGRATION.md says what
// changes).
//
// Call the functions qualified: where FCL's own header is included too, an unqualified call finds both by its
// arguments.
#pragma once

#include "fcl_artic/abi.h"
#include "fcl_artic/export.h"
#include "fcl_artic/fcl_names.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/request.h"

namespace fcl_artic {

// --- FCL's own signatures, for S = double and float (compiled once, in the library).
//
// All of them promise:
// - Time runs from 0 to 1. The returned time is a lower bound of the first contact: contact before it is proven to be
//   impossible. It is at most toc_err earlier than a proven contact, except if two objects graze each other within
//   1e-6 m and contact can't be decided: that counts as contact too. Without contact it is 1, and result.is_collide is
//   false; a contact at exactly t = 1 is one.
// - The result is written in full. contact_tf1 and contact_tf2 are the poses at time_of_contact, or those at t = 1
//   without contact. At time_of_contact fcl::collide mostly finds nothing yet; CertifiedPairResult has poses where it
//   does.
// - Any geometry that FCL has except models of points, in any pairing: Box, Sphere, Ellipsoid, Capsule, Cone,
//   Cylinder, Convex, Halfspace, Plane, TriangleP, BVHModel with any bounding volume, OcTree (cells at or above its
//   occupancy threshold); and, of doubles, a PointCloud. Shapes and cells are solids; meshes, TriangleP and Plane are
//   surfaces, a SolidMesh is a solid. If an OcTree stands still, only its cells near the other object's path are read,
//   so that a large map costs little. If it moves, or the other object is unbounded, all its cells are read.
// - The request's toc_err is the wanted tolerance of time (1e-12 if it is less, such as 0), its ccd_motion_type the
//   way between two transforms. A toc_err of 1 or more asks whether there is contact, not when (ContactMode::any).
//   That is the cheapest question. The returned time is then often 0, and free is as certain as ever.
//   num_max_iterations, gjk_solver_type and ccd_solver_type have no effect: there is one answer.
// - Geometries, motions and objects are only read: many threads may share them. Neither the state that a motion's
//   integrate() left nor an object's AABB matters.
// - Nothing is printed.
//
// All of them throw std::invalid_argument that names the object, for
// - null pointers,
// - a mesh without triangles (an FCL model of points is one: use PointCloud),
// - a geometry that is not finite,
// - a motion whose bounds are unknown (see BoundedMotion),
// - a transform that is not rigid,
// - a toc_err that is negative or not finite.
//
// The result then says what is proven, nothing: contact at t = 0, poses the identity.

/// Finds the first contact of two geometries along two motions, with FCL's signature and a proven answer.
/// @param o1, o2  any geometries; must outlive the call only.
/// @param motion1, motion2  TranslationMotion, InterpMotion, ScrewMotion, SplineMotion, FclLinkMotion, or a class that
///   is a BoundedMotion too; pose of the geometry in the world, m.
/// @param request  toc_err is the wanted tolerance of time (at least 1e-12 is used; of 1 or more: any contact will do);
///   nothing else is read.
/// @param[out] result  written in full, with the poses at the returned time; contact at t = 0 if this throws.
/// @return a time in [0, 1] before which contact is proven to be impossible; 1 also without contact
///   (result.is_collide).
/// @throws std::invalid_argument, naming the object, for null, a mesh without triangles, values that are not finite, a
///   motion with unknown bounds, a toc_err that is negative or not finite.
template <typename S>
FCL_ARTIC_EXPORT S continuousCollide(const fcl::CollisionGeometry<S>* o1, const fcl::MotionBase<S>* motion1,
                                     const fcl::CollisionGeometry<S>* o2, const fcl::MotionBase<S>* motion2,
                                     const fcl::ContinuousCollisionRequest<S>& request,
                                     fcl::ContinuousCollisionResult<S>& result);

/// Finds the first contact of two geometries that move from one pose to another in the world, with FCL's signature and
/// a proven answer.
/// @param request  ccd_motion_type is the way between the poses: CCDM_TRANS (FCL's default) goes straight, keeps the
///   start's rotation and drops the end's; CCDM_LINEAR turns about the geometry's origin while that goes straight;
///   CCDM_SCREW turns about an axis and slides along it. CCDM_SPLINE, an empty stub in FCL, throws: two poses don't
///   make a spline. toc_err is the wanted tolerance of time (at least 1e-12 is used; of 1 or more: any
///   contact will do).
/// @param[out] result  written in full, with the poses at the returned time; contact at t = 0 if this throws.
/// @return a time in [0, 1] before which contact is proven to be impossible; 1 also without contact
///   (result.is_collide).
/// @throws std::invalid_argument as for two motions, for CCDM_SPLINE, and for transforms that are not rigid to 1e-6
///   (float: 1e-4).
template <typename S>
FCL_ARTIC_EXPORT S continuousCollide(const fcl::CollisionGeometry<S>* o1, const fcl::Transform3<S>& tf1_beg,
                                     const fcl::Transform3<S>& tf1_end, const fcl::CollisionGeometry<S>* o2,
                                     const fcl::Transform3<S>& tf2_beg, const fcl::Transform3<S>& tf2_end,
                                     const fcl::ContinuousCollisionRequest<S>& request,
                                     fcl::ContinuousCollisionResult<S>& result);

/// Finds the first contact of two objects that move from their own transforms to the given ones in the world, with
/// FCL's signature and a proven answer.
/// @param request  as for two geometries that move from pose to pose: ccd_motion_type and toc_err.
/// @param[out] result  written in full, with the poses at the returned time; contact at t = 0 if this throws.
/// @return a time in [0, 1] before which contact is proven to be impossible; 1 also without contact
///   (result.is_collide).
/// @throws std::invalid_argument as for two geometries.
template <typename S>
FCL_ARTIC_EXPORT S continuousCollide(const fcl::CollisionObject<S>* o1, const fcl::Transform3<S>& tf1_end,
                                     const fcl::CollisionObject<S>* o2, const fcl::Transform3<S>& tf2_end,
                                     const fcl::ContinuousCollisionRequest<S>& request,
                                     fcl::ContinuousCollisionResult<S>& result);

/// Finds the first contact of two objects along their own motions, with FCL's signature and a proven answer.
/// @param request  toc_err is the wanted tolerance of time (at least 1e-12 is used; of 1 or more: any contact will do);
///   nothing else is read.
/// @param[out] result  written in full, with the poses at the returned time; contact at t = 0 if this throws.
/// @return a time in [0, 1] before which contact is proven to be impossible; 1 also without contact
///   (result.is_collide).
/// @throws std::invalid_argument as for two geometries along two motions.
template <typename S>
FCL_ARTIC_EXPORT S collide(const fcl::ContinuousCollisionObject<S>* o1, const fcl::ContinuousCollisionObject<S>* o2,
                           const fcl::ContinuousCollisionRequest<S>& request,
                           fcl::ContinuousCollisionResult<S>& result);

/// Callback for continuous managers, with FCL's name. Unlike FCL's it keeps the earliest contact of all pairs, and asks
/// to stop when there can be no earlier one.
/// @param data  a fcl::DefaultContinuousCollisionData<S>, from <fcl/broadphase/default_broadphase_callbacks.h>: its
///   request is asked, its result and done are written.
/// @return whether to stop.
/// @throws std::invalid_argument as collide(). The result of all pairs then claims nothing: contact at t = 0.
template <typename S>
bool DefaultContinuousCollisionFunction(fcl::ContinuousCollisionObject<S>* o1, fcl::ContinuousCollisionObject<S>* o2,
                                        void* data) {
  auto& all = *static_cast<DefaultContinuousCollisionData<S>*>(data);
  if (all.done) return true;
  fcl::ContinuousCollisionResult<S> result;
  try {
    fcl_artic::collide<S>(o1, o2, all.request, result);
  } catch (...) {  // the result of all pairs is none either
    all.result = result;
    all.done = true;
    throw;
  }
  const bool earlier = result.is_collide && result.time_of_contact < all.result.time_of_contact;
  if (!all.result.is_collide || earlier) all.result = result;
  all.done = all.result.is_collide && all.result.time_of_contact <= 0;
  return all.done;
}

// --- The same queries with this library's request and result: contacts, [t_lower, t_upper], `certain`, margin, budget,
// statistics.
//
// They throw what the functions above throw, and std::invalid_argument for a tolerance that is not a positive number (0
// is none) and a margin that is negative or not finite. The result then is reset: Status::undecided on [0, 1].
//
// Contacts name a mesh's triangle and an OcTree's cell as FCL's own do (b1, b2; OcTree::getNodeByQueryCellId).

/// Finds the first contact of two geometries along two motions, or proves that there is none.
/// @param motion1, motion2  TranslationMotion, InterpMotion, ScrewMotion, SplineMotion, FclLinkMotion, or a class that
///   is a BoundedMotion too; pose of the geometry in the world, m.
/// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
/// @return result.status.
/// @throws std::invalid_argument, naming the object, for null, a mesh without triangles, values that are not finite,
///   and a motion with unknown bounds. Also for a request with values out of range (Tolerances).
FCL_ARTIC_EXPORT Status continuousCollide(const fcl::CollisionGeometryd* o1, const fcl::MotionBased* motion1,
                                          const fcl::CollisionGeometryd* o2, const fcl::MotionBased* motion2,
                                          const CertifiedPairRequest& request, CertifiedPairResult& result);

/// Finds the first contact of two geometries that move from one pose to another in the world, or proves that there is
/// none.
/// @param motion_type  the way between the poses: CCDM_TRANS (drops the end's rotation), CCDM_LINEAR or CCDM_SCREW. It
///   has no default, since FCL's, CCDM_TRANS, drops a rotation.
/// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
/// @return result.status.
/// @throws std::invalid_argument as for two motions, for CCDM_SPLINE, and for transforms that are not rigid to 1e-6.
FCL_ARTIC_EXPORT Status continuousCollide(const fcl::CollisionGeometryd* o1, const fcl::Transform3d& tf1_beg,
                                          const fcl::Transform3d& tf1_end, const fcl::CollisionGeometryd* o2,
                                          const fcl::Transform3d& tf2_beg, const fcl::Transform3d& tf2_end,
                                          fcl::CCDMotionType motion_type, const CertifiedPairRequest& request,
                                          CertifiedPairResult& result);

/// Finds the first contact of two objects that move from their own transforms to the given ones in the world, or proves
/// that there is none. The contacts' BodyRef::object are o1 and o2.
/// @param motion_type  the way between the poses: CCDM_TRANS (drops the end's rotation), CCDM_LINEAR or CCDM_SCREW.
/// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
/// @return result.status.
/// @throws std::invalid_argument as for two geometries from pose to pose.
FCL_ARTIC_EXPORT Status continuousCollide(const fcl::CollisionObjectd* o1, const fcl::Transform3d& tf1_end,
                                          const fcl::CollisionObjectd* o2, const fcl::Transform3d& tf2_end,
                                          fcl::CCDMotionType motion_type, const CertifiedPairRequest& request,
                                          CertifiedPairResult& result);

/// Finds the first contact of two objects along their own motions, or proves that there is none.
/// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
/// @return result.status.
/// @throws std::invalid_argument as for two geometries along two motions.
FCL_ARTIC_EXPORT Status collide(const fcl::ContinuousCollisionObjectd* o1, const fcl::ContinuousCollisionObjectd* o2,
                                const CertifiedPairRequest& request, CertifiedPairResult& result);

}  // namespace fcl_artic
