// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary vertex/face and edge/edge equations of two triangles under a rigid relative motion (Redon et al.
// 2004, equations 14 and 13), with interval Newton (18). They give the first contact to the rounding floor, and the
// features that meet. It refines what the solver has found and names it; no verdict comes from here.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "fcl_artic/result.h"
#include "model/sweep.h"

namespace fcl_artic {

using ScalarMotion = engine::PairMotion;

/// Writes the motion over [tm - d, tm + d]. Asked for intervals inside [0, 1], up to 4 ulp; d may be 0.
using MotionAt = std::function<void(double tm, double d, ScalarMotion& out)>;

/// First contact of two triangles.
struct RefinedContact {
  FeatureKind feature = FeatureKind::volume;  ///< A's feature first
  double t_lower = 0;                         ///< proven: no contact in [the t_lower given, this)
  double t_upper = 1;    ///< proven, when `certain`: a contact at or before; else the t_upper given
  bool certain = false;  ///< an equation changes sign over the window while its features keep crossing each other
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< A's frame, at t_upper if certain or `proven`, else at t_lower
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< A's frame, unit, from A to B; same time
  int feature_a = -1, feature_b = -1;  ///< vertex i, or edge from vertex i to (i + 1) % 3; -1 for the face
};

/// Where a contact is looked for: known to lie in [t_lower, t_upper] within [0, 1].
struct ContactWindow {
  double t_lower, t_upper;
  bool proven = false;  ///< contact at t_upper is: point and normal are of that time in any case
};

/// Refines the first contact of triangles a (A's frame) and b (B's frame), in its window.
///
/// Degenerate contacts are a vertex on an edge, parallel edges, coplanar faces, grazing. They get the features within
/// the rounding floor of each other at the refined t_lower, a raised t_lower, the t_upper given and certain = false.
/// @return false, with the window as given and no feature, when it is proven that no equation has a root in the
///   window. The triangles are free there, or they cross each other in all of it.
bool refineTriangleContact(const Eigen::Vector3d a[3], const Eigen::Vector3d b[3], const MotionAt& motion,
                           const ContactWindow& window, RefinedContact& out);

}  // namespace fcl_artic
