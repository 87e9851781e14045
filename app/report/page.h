// SPDX-License-Identifier: BSD-3-Clause
//
// An answer as a page for a browser: the motion in 3-D to scrub through, and all that the answer says.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/collision_geometry.h>

#include "distances.h"
#include "fcl_artic/urdf/urdf.h"
#include "report.h"

namespace fcl_artic::app {

/// Something that a page shows.
struct PageBody {
  std::string name;  ///< as in the answer
  std::string kind;  ///< "link", "attached object", "obstacle" or "moving obstacle"
  LinkId link = -1;  ///< what carries it; -1: nothing
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< in the link's frame, else in the world
  std::shared_ptr<const fcl::CollisionGeometryd> geometry;
  /// Pose in the world at the motion's time t; empty for all but moving obstacles.
  std::function<Eigen::Isometry3d(double t)> motion;
};

/// Geometry of links, each by the name of its link.
std::vector<PageBody> linksOf(const KinematicTree& tree, const std::vector<LinkGeometry>& geometry);

/// A length to compare distances with: about as far as the links reach from their middle at the motion's begin, m,
/// above 0.
double sizeOf(const Report& report, const std::vector<PageBody>& bodies);

/// The page, whole in itself: it loads nothing, and says by a content security policy that it may not. If there are
/// more than a million triangles, or half a million cells of an OctoMap or points of a cloud, the drawing is thinned,
/// and the page says so.
/// @param report  what it says of the answer.
/// @param distances  what its curve shows.
/// @throws std::invalid_argument for a kind of geometry that can't be drawn.
std::string htmlPage(const Report& report, const std::vector<PageBody>& bodies, const Distances& distances);

}  // namespace fcl_artic::app
