// SPDX-License-Identifier: BSD-3-Clause
//
// The drop-in for FCL's <fcl/narrowphase/continuous_collision.h>: the same functions on the same types, with proven
// answers. Code that says `namespace ccd = fcl;` may say `namespace ccd = fcl_artic;` (doc/MIGRATION.md tells what
// changes).
//
// Call the functions qualified: where FCL's own header is included too, an unqualified call finds both by its
// arguments.
#pragma once

#include "fcl_artic/export.h"
#include "fcl_artic/fcl_names.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/request.h"

namespace fcl_artic {

// --- FCL's own signatures, for S = double and float (compiled once, in the library).
//
// What all of them promise:
// - Time runs from 0 to 1. The returned time is a lower bound of the first contact: before it, contact is proven to be
//   impossible. It is at most toc_err earlier than a proven contact, except where two objects graze each other within
//   1e-6 m and contact can't be told from none: that counts as contact too. Without contact it is 1, and
//   result.is_collide is false; a contact at exactly t = 1 is one.
// - The result is written in full. contact_tf1 and contact_tf2 are the poses at time_of_contact, those at t = 1 without
//   contact. At time_of_contact fcl::collide mostly finds nothing yet; CertifiedPairResult has poses where it does.
// - Any geometry that FCL has but point clouds, in any pairing: Box, Sphere, Ellipsoid, Capsule, Cone, Cylinder,
//   Convex, Halfspace, Plane, TriangleP, BVHModel with any bounding volume, OcTree (cells at or above its occupancy
//   threshold). Shapes and cells are solids; meshes, TriangleP and Plane are surfaces, a SolidMesh is a solid. Of an
//   OcTree that stands still only the cells near the other object's path are read, so that a large map costs little; of
//   one that moves, and against what is unbounded, all.
// - Of the request, toc_err is the wanted tolerance of time (1e-12 where it is less, 0 say), and ccd_motion_type the
//   way between two transforms. num_max_iterations, gjk_solver_type and ccd_solver_type have no effect: there is one
//   answer.
// - Geometries, motions and objects are only read: many threads may share them. Neither the state that a motion's
//   integrate() left nor an object's AABB matters.
// - Nothing is printed.
//
// What all of them throw: std::invalid_argument that names the object, for null pointers, a geometry that is a point
// cloud, empty or not finite, a motion whose bounds are unknown (see BoundedMotion), a transform that is not rigid, and
// toc_err negative or not finite. The result then says what is proven, nothing: contact at t = 0, poses the identity.

/// First contact of two geometries along two motions.
/// @param motion1, motion2  TranslationMotion, InterpMotion, ScrewMotion, SplineMotion, FclLinkMotion, or a class that
///   is a BoundedMotion too; pose of the geometry in the world, m.
/// @return time of contact in [0, 1]; 1 also without contact.
template <typename S>
FCL_ARTIC_EXPORT S continuousCollide(const fcl::CollisionGeometry<S>* o1, const fcl::MotionBase<S>* motion1,
                                     const fcl::CollisionGeometry<S>* o2, const fcl::MotionBase<S>* motion2,
                                     const fcl::ContinuousCollisionRequest<S>& request,
                                     fcl::ContinuousCollisionResult<S>& result);

/// First contact of two geometries that move from one pose to another, in the world, in the way of
/// request.ccd_motion_type: CCDM_TRANS (FCL's default) goes straight, keeps the start's rotation and drops the end's;
/// CCDM_LINEAR turns about the geometry's origin while that goes straight; CCDM_SCREW turns about an axis and slides
/// along it. CCDM_SPLINE, an empty stub in FCL, throws std::invalid_argument: two poses don't make a spline.
template <typename S>
FCL_ARTIC_EXPORT S continuousCollide(const fcl::CollisionGeometry<S>* o1, const fcl::Transform3<S>& tf1_beg,
                                     const fcl::Transform3<S>& tf1_end, const fcl::CollisionGeometry<S>* o2,
                                     const fcl::Transform3<S>& tf2_beg, const fcl::Transform3<S>& tf2_end,
                                     const fcl::ContinuousCollisionRequest<S>& request,
                                     fcl::ContinuousCollisionResult<S>& result);

/// The same for two objects, from their own transforms on.
template <typename S>
FCL_ARTIC_EXPORT S continuousCollide(const fcl::CollisionObject<S>* o1, const fcl::Transform3<S>& tf1_end,
                                     const fcl::CollisionObject<S>* o2, const fcl::Transform3<S>& tf2_end,
                                     const fcl::ContinuousCollisionRequest<S>& request,
                                     fcl::ContinuousCollisionResult<S>& result);

/// First contact of two objects along their own motions.
template <typename S>
FCL_ARTIC_EXPORT S collide(const fcl::ContinuousCollisionObject<S>* o1, const fcl::ContinuousCollisionObject<S>* o2,
                           const fcl::ContinuousCollisionRequest<S>& request,
                           fcl::ContinuousCollisionResult<S>& result);

/// Callback for continuous managers, with FCL's name. Other than FCL's it keeps the earliest contact of all pairs, and
/// asks to stop when there can be no earlier one.
/// When it throws, the result of all pairs claims nothing: contact at t = 0.
/// @param data  a fcl::DefaultContinuousCollisionData<S>, from <fcl/broadphase/default_broadphase_callbacks.h>.
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
// They throw what the functions above throw, and std::invalid_argument for a tolerance that is not a positive number
// (0 is none) and a margin that is negative or not finite. The result then is reset: Status::undecided on [0, 1].
//
// Contacts name a mesh's triangle and an OcTree's cell as FCL's own do (b1, b2; OcTree::getNodeByQueryCellId).

/// Along two motions, as above.
FCL_ARTIC_EXPORT Status continuousCollide(const fcl::CollisionGeometryd* o1, const fcl::MotionBased* motion1,
                                          const fcl::CollisionGeometryd* o2, const fcl::MotionBased* motion2,
                                          const CertifiedPairRequest& request, CertifiedPairResult& result);

/// From pose to pose, in the world. The way between them has no default here: FCL's, CCDM_TRANS, drops the end's
/// rotation.
FCL_ARTIC_EXPORT Status continuousCollide(const fcl::CollisionGeometryd* o1, const fcl::Transform3d& tf1_beg,
                                          const fcl::Transform3d& tf1_end, const fcl::CollisionGeometryd* o2,
                                          const fcl::Transform3d& tf2_beg, const fcl::Transform3d& tf2_end,
                                          fcl::CCDMotionType motion_type, const CertifiedPairRequest& request,
                                          CertifiedPairResult& result);

/// From two objects' own transforms on. The contacts' BodyRef::object are o1 and o2.
FCL_ARTIC_EXPORT Status continuousCollide(const fcl::CollisionObjectd* o1, const fcl::Transform3d& tf1_end,
                                          const fcl::CollisionObjectd* o2, const fcl::Transform3d& tf2_end,
                                          fcl::CCDMotionType motion_type, const CertifiedPairRequest& request,
                                          CertifiedPairResult& result);

/// Along two objects' own motions.
FCL_ARTIC_EXPORT Status collide(const fcl::ContinuousCollisionObjectd* o1, const fcl::ContinuousCollisionObjectd* o2,
                                const CertifiedPairRequest& request, CertifiedPairResult& result);

}  // namespace fcl_artic
