// SPDX-License-Identifier: BSD-3-Clause
//
// The one place where a contact of the engine becomes the users' own.
#pragma once

#include <Eigen/Geometry>

#include "fcl_artic/result.h"
#include "geometry/shape_tree.h"
#include "model/answer.h"

namespace fcl_artic {

/// A contact's data of one of its bodies.
struct ReportedBody {
  BodyRef reference;
  const fcl::CollisionGeometryd* geometry;  ///< that `shape` was read from
  const ShapeTree& shape;
};

/// A contact as users see it: in world axes, with FCL's own ids of what meets. Body 1 is A.
/// @param M_0a  A's geometry in the world at the contact's `t`.
/// @param M_0a_nearest  at its t_nearest.
CertifiedContact reportContact(const engine::LeafContact& leaf, const ReportedBody& a, const ReportedBody& b,
                               const Eigen::Isometry3d& M_0a, const Eigen::Isometry3d& M_0a_nearest);

/// The same contact with body 1 and body 2 changed over.
CertifiedContact swapBodies(CertifiedContact contact);

}  // namespace fcl_artic
