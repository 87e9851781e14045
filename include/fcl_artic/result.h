// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/contact.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <Eigen/Geometry>

#include "fcl_artic/bracket.h"
#include "fcl_artic/certificate.h"
#include "fcl_artic/export.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/statistics.h"
#include "fcl_artic/tube.h"

namespace fcl_artic {

/// Kinds of features that meet at a contact, body 1's first. Vertices, edges and faces are those of triangles.
enum class FeatureKind {
  vertexVertex,  ///< A vertex of body 1 and a vertex of body 2.
  vertexEdge,    ///< A vertex of body 1 and an edge of body 2.
  edgeVertex,    ///< An edge of body 1 and a vertex of body 2.
  vertexFace,    ///< A vertex of body 1 and a face of body 2.
  faceVertex,    ///< A face of body 1 and a vertex of body 2.
  edgeEdge,      ///< An edge of each body.
  edgeFace,      ///< An edge of body 1 and a face of body 2.
  faceEdge,      ///< A face of body 1 and an edge of body 2.
  faceFace,      ///< A face of each body.
  /// No features are known, for one of these reasons:
  /// - a body is not a triangle there;
  /// - one body lies within the other;
  /// - the pair has a margin above 0 and its triangles are not seen to cross;
  /// - the triangles' equations have no root there.
  volume
};

/// A body of a query: a geometry bound to a link, an object attached to a link, or an obstacle. The pointers are the
/// caller's own objects. Queries of two objects, and a ContinuousCollisionManager, know no names and leave the fields
/// at their defaults, except that continuousCollide() of two fcl::CollisionObjects sets `object`.
struct BodyRef {
  LinkId link = -1;                               ///< The link that carries it; -1 for an obstacle.
  const fcl::CollisionObjectd* object = nullptr;  ///< As registered or bound; null for a moving obstacle.
  std::string name;                               ///< The link's name, or the obstacle's or attached object's.
  const fcl::ContinuousCollisionObjectd* moving = nullptr;  ///< As registered, for a moving obstacle; else null.
};

/// One contact. As in FCL, `normal` points from body 1 to body 2. If a link and an obstacle touch, the link is body 1.
struct CertifiedContact : ToleranceWitness {
  /// The bodies that touch.
  BodyRef body1, body2;
  /// Geometry of body 1; the caller's.
  const fcl::CollisionGeometryd* o1 = nullptr;
  /// Geometry of body 2; the caller's.
  const fcl::CollisionGeometryd* o2 = nullptr;
  /// The pieces of the bodies that touch: index of a mesh's triangle, id of an OcTree's cell
  /// (OcTree::getNodeByQueryCellId), number of a PointCloud's point, fcl::Contactd::NONE (-1) for a shape. If no
  /// triangle is known, it is -1 for a mesh too:
  /// - with ContactMode::any where contact is proven by what closed meshes enclose (`point` lies within both bodies
  ///   then);
  /// - where one body lies within the other, a SolidMesh, at t = 0 (`normal` is roughly the shortest way out then).
  std::intptr_t b1 = -1, b2 = -1;
  /// The kinds of features that meet, body 1's first.
  FeatureKind feature = FeatureKind::volume;
  /// Point of contact in the world, m: at this contact's t_upper if it is certain, else at its t_lower. As the pieces
  /// touch at some time of the bracket, it may be off them by about as much as they move in it.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  /// Unit normal in the world, from body 1 to body 2, at the same time as `point`. Pieces may be in each other from
  /// the motion's begin. It is then the direction along which they part by the least translation, or the normal of the
  /// features that meet (not with ContactMode::any).
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  /// Witness points in the world, m: the points of the two pieces (b1 of body 1, b2 of body 2) that are nearest to each
  /// other at t_lower, just before they touch. Both are `point` if the pieces overlap then, as pieces in contact from
  /// the start do, and with ContactMode::any. Not proven.
  Eigen::Vector3d nearest1 = Eigen::Vector3d::Zero(), nearest2 = Eigen::Vector3d::Zero();
  /// Speed at which the bodies approach each other at `point` along the normal, in m per unit of the motion's time t
  /// (for a trajectory, of its own time). It is above 0 when they come together, below 0 when they part; 0 with
  /// ContactMode::any. Not proven.
  double approach_speed = 0;
  /// The bracket of these two pieces, b1 and b2. They do not touch before t_lower, counted from when their pair is
  /// watched (ignore_initial_contact); if `certain`, they touch at or before t_upper, else t_upper is the motion's end.
  /// Other pieces may touch earlier, but not before the result's t_lower. With ContactMode::any t_lower is often 0.
  double t_lower = 0, t_upper = 1;
  /// Whether contact of these two pieces at or before t_upper is proven. If not, it can't be excluded within the
  /// tolerances.
  bool certain = false;

  /// Returns this contact as FCL's own type. At first contact nothing has been penetrated: the depth is 0.
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

/// Work of a query, by stage. Times are in µs, and 0 without Effort::measure_times unless said otherwise. For a
/// trajectory and for many pairs they are sums. (Fields of Method::standard's work stand here directly.)
struct QueryStatistics : StandardStatistics {
  std::uint64_t pairs = 0;                ///< Pairs of bodies that the request asks about.
  std::uint64_t pairs_after_culling = 0;  ///< Pairs that the swept bounds (stage 1) leave.
  VisibilityStatistics visibility;        ///< Work of stage 2 (CertifiedRequest::visibility).
  std::string visibility_executor;        ///< Executor of stage 2: "cpu", "osmesa" or "egl"; empty if it had no work.
  std::string visibility_fallback;        ///< Why the executor is "cpu" although another one was wanted.
  RedonStatistics redon;                  ///< Work of Method::redon2004.
  double report_us = 0;                   ///< Time of writing the result, µs; of an ArticulatedCollisionManager only.
  double total_us = 0;                    ///< Time of the whole query, µs; of managers only.
};

/// The answer of an ArticulatedCollisionManager: verdict and bracket (Bracket), contacts, work. A query writes every
/// field; if it throws, the result is reset: `undecided`, t_lower at the motion's begin, no contacts.
struct CertifiedResult : Bracket {
  /// The first contact of every two bodies, in the order of their t_lower, at most CertifiedRequest::max_contacts. All
  /// geometries of a link count as one body here. If the result is `certain`, the first contact is that which is proven
  /// first. Empty if the motion is free.
  /// `undecided` has contacts only for a trajectory with `firstOfEveryPair`: those found before the budget ran out.
  std::vector<CertifiedContact> contacts;
  /// Pose of every link at t_lower, link to world, in the order of the links. Empty if the motion is free, and if
  /// CertifiedPairRequest::max_contacts is 0: then the verdict is all that is wanted.
  std::vector<Eigen::Isometry3d> M_0_at_lower;
  /// Pairs that touch at t = 0, or are within their margin, and were ignored
  /// (CertifiedPairRequest::ignore_initial_contact). Each geometry of a link is a body of its own. So a link's name
  /// may stand in several pairs with one obstacle, while other geometries of it are checked.
  std::vector<std::pair<BodyRef, BodyRef>> ignored_initial_contacts;
  /// Number of these that are proven apart, by their margin, nowhere on the motion: `free` says nothing of them.
  std::size_t never_apart_pairs = 0;
  /// Number of pairs, of those the request asks about, that were not checked and that nothing proves apart for this
  /// motion and margin. They were not checked because they are allowed (setAllowedCollisions(), attach()'s
  /// touch_links), or neighbours of which it can't be decided whether they touch (unproven_neighbours). `free` says
  /// nothing of them; ArticulatedCollisionManager::setLinkPairProofs() makes them fewer. Neighbours that touch
  /// whatever the joint between them does, as housings that overlap in it, do not count:
  /// ArticulatedCollisionManager::notes() names those that nobody allowed.
  std::size_t unproven_allowed_pairs = 0;
  /// Names of the links of those of these pairs that are neighbours which nobody allowed; null: none. (Shared by all
  /// answers of one set-up.)
  std::shared_ptr<const std::vector<std::pair<std::string, std::string>>> unproven_neighbours;
  /// The proof that the motion is free, or free until shortly before t_lower; null if the request did not ask for it
  /// (CertifiedPairRequest::certificate).
  std::shared_ptr<const Certificate> certificate;
  /// Work of the query.
  QueryStatistics statistics;

  /// Whether the motion is free because no pair of bodies was to be checked: no geometry, or all pairs are allowed or
  /// out of scope.
  [[nodiscard]] bool nothingChecked() const { return status == Status::free && statistics.pairs == 0; }
  /// The first of the contacts; null if there is none: the motion is free or undecided, or max_contacts is 0. It points
  /// into this result.
  const CertifiedContact* first() const& { return contacts.empty() ? nullptr : &contacts.front(); }
  /// Not available for a temporary result, whose contacts would be gone.
  const CertifiedContact* first() const&& = delete;
};

/// Returns "free", "contact" or "undecided".
FCL_ARTIC_EXPORT const char* toString(Status status);
/// Returns the features with a hyphen, body 1's first, such as "vertex-face"; or "volume".
FCL_ARTIC_EXPORT const char* toString(FeatureKind kind);
/// Returns what a free motion's answer does not cover: allowed pairs and neighbours without a proof, pairs that
/// touched at the start and were ignored. For example "but for 2 allowed pairs not proven apart, and for 1 pair of
/// neighbours not proven apart: base, arm"; empty if the motion is not free, or there is nothing.
FCL_ARTIC_EXPORT std::string exceptionsOf(const CertifiedResult& result);
/// Prints the body's name, or "body" if it has none.
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const BodyRef& body);
/// Prints toString(status).
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, Status status);
/// Prints toString(kind).
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, FeatureKind kind);
/// Prints verdict and bracket on one line, without a line end: "contact within [0.25, 0.2500001], proven".
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const Bracket& bracket);
/// Prints verdict and bracket on one line, without a line end, and what a verdict of `free` leaves out: "free: proven,
/// but for 3 allowed pairs not proven apart", "nothing was checked, there is no pair of bodies".
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const CertifiedResult& result);
/// Prints on one line, without a line end, which bodies touch, with which features, when and where.
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const CertifiedContact& contact);

}  // namespace fcl_artic
