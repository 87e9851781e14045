// SPDX-License-Identifier: BSD-3-Clause
//
// Two moving bodies: the engine's problem with one pair.
#pragma once

#include "fcl_artic/pair_result.h"
#include "fcl_artic/request.h"
#include "geometry/shape_tree.h"
#include "motion/body_motion.h"

namespace fcl_artic {

/// One of the two bodies.
struct MovingShape {
  const ShapeTree& shape;
  const BodyMotion& motion;
  const fcl::CollisionGeometryd* geometry = nullptr;  ///< for the report: CertifiedContact::o1 or o2
};

/// First contact of two bodies, or the proof that there is none. Bodies may be unbounded (half-spaces, planes).
/// CertifiedPairRequest::check_scene and check_self have no meaning here; mode firstOfEveryPair is first.
/// @throws std::invalid_argument for a tolerance or margin that is negative or not finite.
void solvePair(const MovingShape& body1, const MovingShape& body2, const CertifiedPairRequest& request,
               CertifiedPairResult& result);

}  // namespace fcl_artic
