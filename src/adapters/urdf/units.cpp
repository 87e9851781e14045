// SPDX-License-Identifier: BSD-3-Clause
//
// Lengths in other units than metres: multiplies geometries, and finds signs of such units.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "detail.h"
#include "fcl_artic/point_cloud.h"
#include "fcl_artic/solid_mesh.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic {
namespace detail {

GeometryPtr scaledGeometry(const GeometryPtr& geometry, double scale, const std::string& where) {
  if (scale == 1) return geometry;
  if (const auto* box = dynamic_cast<const fcl::Boxd*>(geometry.get())) return makeBox(scale * box->side, where);
  if (const auto* ball = dynamic_cast<const fcl::Sphered*>(geometry.get())) {
    return makeSphere(scale * ball->radius, where);
  }
  if (const auto* cylinder = dynamic_cast<const fcl::Cylinderd*>(geometry.get())) {
    return makeCylinder(scale * cylinder->radius, scale * cylinder->lz, where);
  }
  if (const auto* cone = dynamic_cast<const fcl::Coned*>(geometry.get())) {
    return makeCone(scale * cone->radius, scale * cone->lz, where);
  }
  if (const auto* plane = dynamic_cast<const fcl::Planed*>(geometry.get())) {
    return std::make_shared<fcl::Planed>(plane->n, scale * plane->d);
  }
  if (const auto* mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(geometry.get())) {
    std::vector<Eigen::Vector3d> vertices(mesh->vertices, mesh->vertices + mesh->num_vertices);
    for (Eigen::Vector3d& x : vertices) x *= scale;
    const std::vector<fcl::Triangle> triangles(mesh->tri_indices, mesh->tri_indices + mesh->num_tris);
    return makeMesh(vertices, triangles, where, nullptr, dynamic_cast<const SolidMark*>(geometry.get()) != nullptr);
  }
  if (const auto* cloud = dynamic_cast<const PointCloud*>(geometry.get())) {
    std::vector<Eigen::Vector3d> points = cloud->points();
    for (Eigen::Vector3d& x : points) x *= scale;
    return std::make_shared<PointCloud>(std::move(points), cloud->radii());  // radii are in metres always
  }
  fail(where, "has a geometry that can't be scaled");
}

}  // namespace detail

namespace {

constexpr double kUnbounded = 1e30;  // FCL's boxes around planes end near the largest double

/// Bound on the distance of the robot's geometry from its root, whichever way the joints turn: each joint's frame
/// stands at a fixed distance from the link that carries it.
double reachOf(const Robot& robot) {
  const KinematicTree& tree = *robot.tree;
  std::vector<double> frames(static_cast<std::size_t>(tree.numLinks()), 0);  // of each link, from its root
  for (const LinkId link : tree.topologicalOrder()) {
    const JointId j = tree.parentJoint(link);
    if (j < 0) continue;
    frames[static_cast<std::size_t>(link)] = frames[static_cast<std::size_t>(tree.parentLink(link))] +
                                             tree.joint(j).origin.translation().norm() + detail::slideUpper(tree, j);
  }
  double reach = 0;
  for (const LinkGeometry& g : robot.geometry) {
    const fcl::CollisionGeometryd& geometry = *g.object->collisionGeometry();
    const double own = (g.offset * geometry.aabb_center).norm() + geometry.aabb_radius;
    reach = std::max(reach, frames[static_cast<std::size_t>(g.link)] + own);
  }
  return reach;
}

}  // namespace

std::vector<std::string> unitNotes(const Robot& robot, const Scene& scene) {
  std::vector<std::string> notes;
  const double reach = reachOf(robot);
  if (!(reach > 0 && reach < kUnbounded)) return notes;
  const std::string reaches = "the robot reaches " + detail::text(reach) + " m at most";
  const std::string cure = "; lengths are taken for metres: is the scene in millimetres? (scale 0.001)";
  const Scene::Obstacle *nearest = nullptr, *largest = nullptr;
  double distance = kUnbounded, size = 0;
  for (const Scene::Obstacle& obstacle : scene.obstacles) {
    const fcl::AABBd& box = obstacle.object->getAABB();
    const double extent = (box.max_ - box.min_).maxCoeff();
    const double away = box.min_.cwiseMax(-box.max_).cwiseMax(0.0).norm();  // of the box from the root
    if (!nearest || away < distance) {
      nearest = &obstacle;
      distance = away;
    }
    if (extent < kUnbounded && extent > size) {
      largest = &obstacle;
      size = extent;
    }
  }
  // Bodies that stand about a robot are a tenth to ten times as large as its reach. If their millimetres are taken for
  // metres, they are a hundred to ten thousand times as large.
  constexpr double kFar = 10, kHuge = 100;
  if (nearest && distance > reach) {
    notes.push_back("no obstacle can be reached: '" + nearest->name + "', the nearest, is " + detail::text(distance) +
                    " m or more from the robot's root, " + reaches + (distance > kFar * reach ? cure : ""));
  }
  if (largest && size > kHuge * reach) {
    notes.push_back("obstacle '" + largest->name + "' is " + detail::text(size) + " m long, " + reaches + cure);
  }
  return notes;
}

}  // namespace fcl_artic
