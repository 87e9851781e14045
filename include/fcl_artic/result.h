// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/contact.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <Eigen/Geometry>

#include "fcl_artic/bracket.h"
#include "fcl_artic/export.h"
#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic {

/// Features that meet, body 1's first. `volume`: at least one of the bodies is not a triangle there.
enum class FeatureKind {
  vertexVertex,
  vertexEdge,
  edgeVertex,
  vertexFace,
  faceVertex,
  edgeEdge,
  edgeFace,
  faceEdge,
  faceFace,
  volume
};

/// A body of a query: a geometry bound to a link, an object attached to one, or an obstacle.
struct BodyRef {
  LinkId link = -1;                                         ///< -1 for an obstacle
  const fcl::CollisionObjectd* object = nullptr;            ///< as registered or bound; null for an obstacle that moves
  std::string name;                                         ///< link name, or the obstacle's or attached object's
  const fcl::ContinuousCollisionObjectd* moving = nullptr;  ///< an obstacle with a motion of its own, as registered
};

/// One contact. As in FCL, `normal` points from body 1 to body 2.
struct CertifiedContact {
  BodyRef body1, body2;
  const fcl::CollisionGeometryd* o1 = nullptr;
  const fcl::CollisionGeometryd* o2 = nullptr;
  /// Triangle index in a mesh, fcl::Contactd::NONE (-1) for a shape. With ContactMode::any also for a mesh: where
  /// contact is proven by what closed meshes enclose, no triangle is known, and `point` lies within both bodies. The
  /// same where one body lies within the other, a SolidMesh, at t = 0: `normal` is the shortest way out then, about.
  std::intptr_t b1 = -1, b2 = -1;
  FeatureKind feature = FeatureKind::volume;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< world, at t_upper when certain, else at t_lower
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< world, unit, from body 1 to body 2
  /// Witness points, world: of the two pieces (b1 of body 1, b2 of body 2) those that are nearest to each other at
  /// t_lower, just before they touch. Where the pieces overlap then, as bodies in contact from the start do, and with
  /// ContactMode::any, both are `point`.
  Eigen::Vector3d nearest1 = Eigen::Vector3d::Zero(), nearest2 = Eigen::Vector3d::Zero();
  /// Speed at which the bodies approach each other at `point` along the normal, m per unit of the motion's time t (of a
  /// trajectory's own time): above 0 when they come together, below when they part. 0 with ContactMode::any.
  double approach_speed = 0;
  /// These two pieces of the bodies (b1, b2) do not touch before t_lower, counted from when their pair is watched; with
  /// `certain` they do at or before t_upper, else that is the motion's end. Other pieces may touch earlier,
  /// but not before the result's t_lower. With ContactMode::any t_lower is often 0.
  double t_lower = 0, t_upper = 1;
  bool certain = false;

  /// The same as FCL's own contact. At first contact nothing has been penetrated: the depth is 0.
  fcl::Contactd toFcl() const {
    fcl::Contactd contact;
    contact.o1 = o1;
    contact.o2 = o2;
    contact.b1 = b1;
    contact.b2 = b2;
    contact.pos = point;
    contact.normal = normal;
    contact.penetration_depth = 0;
    return contact;
  }
};

/// Work of the paper's method (Method::redon2004).
struct RedonStatistics {
  std::uint64_t pairs_by_standard = 0;  ///< pairs of bodies left to the library's own method
  std::uint64_t box_tests = 0;          ///< pairs of oriented boxes, one sub-interval each
  std::uint64_t leaf_pairs = 0;         ///< pairs of triangles whose boxes meet
  std::uint64_t equations = 0;          ///< n_e
  std::uint64_t intervals = 0;          ///< time intervals that motions were bounded over: s_max of eq. (17)
  std::uint64_t evaluations = 0;        ///< equations bounded over an interval: a n_e
  std::uint64_t steps_bounded = 0;      ///< moving joints of chains, bounded over an interval each
  double culling_us = 0, boxes_us = 0, equations_us = 0;
  double visibility_us = 0;  ///< stage 2, the bounds on what links sweep included
};

/// Work of a query, by stage. Times only with CertifiedRequest::measure_times.
struct QueryStatistics {
  std::uint64_t pairs = 0;                ///< body pairs that the request asks about
  std::uint64_t pairs_after_culling = 0;  ///< of these, left by the swept bounds (stage 1)
  std::uint64_t batches = 0;              ///< batches of eight time intervals
  std::uint64_t motion_evaluations = 0;   ///< (frame, batch) evaluations
  std::uint64_t node_tests = 0;           ///< bounding volume pairs, eight intervals each
  std::uint64_t leaf_tests = 0;           ///< pairs of convex pieces, eight intervals each
  std::uint64_t certificates = 0;         ///< directions checked, eight intervals each
  std::uint64_t gjk = 0;                  ///< witness searches
  std::uint64_t contact_proofs = 0;       ///< poses for which a proof of contact was tried
  std::uint64_t visibility_pairs = 0;     ///< pairs that stage 2 looked at (CertifiedRequest::visibility)
  std::uint64_t visibility_culled = 0;    ///< of these, proven free
  std::uint64_t visibility_nodes = 0;     ///< of the others, nodes of obstacles' trees proven free
  std::uint64_t visibility_pieces = 0;    ///< pieces of obstacles that were drawn for it
  std::uint64_t visibility_trials = 0;    ///< 1: `automatic` answered the query both ways to compare
  std::uint64_t visibility_repeated = 0;  ///< 1: solved again without stage 2, as the motion is not free
  double visibility_us = 0;               ///< always measured, trials included
  std::string visibility_executor;        ///< that did it: "cpu", "osmesa" or "egl"; empty: nothing was to be done
  std::string visibility_fallback;        ///< why it is "cpu" where another one was wanted
  double culling_us = 0, narrowphase_us = 0, report_us = 0, total_us = 0;
  RedonStatistics redon;
};

/// The answer of an ArticulatedCollisionManager: verdict and bracket (Bracket), contacts, work. Always written in full.
struct CertifiedResult : Bracket {
  /// None of a free motion. `undecided` may have some: with every pair asked, those found before the budget ran out.
  std::vector<CertifiedContact> contacts;
  /// Pose of every link in the world at t_lower; empty when the motion is free.
  std::vector<Eigen::Isometry3d> M_0_at_lower;
  /// Pairs that touch at t = 0 and were ignored (ignore_initial_contact).
  std::vector<std::pair<BodyRef, BodyRef>> ignored_initial_contacts;
  QueryStatistics statistics;

  /// The first of the contacts; null where there is none: the motion is free, or undecided before a contact was found.
  const CertifiedContact* first() const& { return contacts.empty() ? nullptr : &contacts.front(); }
  const CertifiedContact* first() const&& = delete;
};

/// "free", "contact", "undecided".
FCL_ARTIC_EXPORT const char* toString(Status status);
/// "vertex-face" and so on, body 1's feature first; "volume".
FCL_ARTIC_EXPORT const char* toString(FeatureKind kind);
/// The body's name; of one without a name "body".
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const BodyRef& body);
/// As toString().
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, Status status);
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, FeatureKind kind);
/// One line without its end: the verdict and the bracket, "contact within [0.25, 0.2500001], proven".
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const Bracket& bracket);
/// One line without its end: who touches whom, with which features, when and where.
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const CertifiedContact& contact);

}  // namespace fcl_artic
