// SPDX-License-Identifier: BSD-3-Clause
#include "edges/inputs.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <typeinfo>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>

#include "certificate/sha256.h"
#include "fcl_artic/point_cloud.h"
#include "fcl_artic/solid_mesh.h"
#include "files/files.h"

namespace fcl_artic::app {
namespace {

/// Bytes to take a hash of: each item with its length, so that no two lists of items have the same bytes.
class Content {
 public:
  void add(const void* bytes, std::size_t size) {
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes_.append(static_cast<const char*>(bytes), size);
  }
  void add(const std::string& text) { add(text.data(), text.size()); }
  void add(double x) { add(&x, sizeof x); }
  void add(const Eigen::Vector3d& v) { add(v.data(), 3 * sizeof(double)); }
  void add(const Eigen::Isometry3d& M) { add(M.matrix().data(), 16 * sizeof(double)); }
  std::string hash() const { return certificate::sha256Text(bytes_); }

 private:
  std::string bytes_;
};

/// @throws std::logic_error for a kind that no reader makes.
std::string hashOf(const fcl::CollisionGeometryd& geometry) {
  Content content;
  content.add(std::string(typeid(geometry).name()));  // a solid is another one than a surface
  if (const auto* mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(&geometry)) {
    for (int i = 0; i < mesh->num_vertices; ++i) content.add(mesh->vertices[i]);
    for (int i = 0; i < mesh->num_tris; ++i) {
      for (int k = 0; k < 3; ++k) content.add(static_cast<double>(mesh->tri_indices[i][k]));
    }
  } else if (const auto* box = dynamic_cast<const fcl::Boxd*>(&geometry)) {
    content.add(box->side);
  } else if (const auto* sphere = dynamic_cast<const fcl::Sphered*>(&geometry)) {
    content.add(sphere->radius);
  } else if (const auto* cylinder = dynamic_cast<const fcl::Cylinderd*>(&geometry)) {
    content.add(Eigen::Vector3d(cylinder->radius, cylinder->lz, 0));
  } else if (const auto* cone = dynamic_cast<const fcl::Coned*>(&geometry)) {
    content.add(Eigen::Vector3d(cone->radius, cone->lz, 0));
  } else if (const auto* capsule = dynamic_cast<const fcl::Capsuled*>(&geometry)) {
    content.add(Eigen::Vector3d(capsule->radius, capsule->lz, 0));
  } else if (const auto* plane = dynamic_cast<const fcl::Planed*>(&geometry)) {
    content.add(plane->n);
    content.add(plane->d);
  } else if (const auto* halfspace = dynamic_cast<const fcl::Halfspaced*>(&geometry)) {
    content.add(halfspace->n);
    content.add(halfspace->d);
  } else if (const auto* cloud = dynamic_cast<const PointCloud*>(&geometry)) {
    for (const Eigen::Vector3d& point : cloud->points()) content.add(point);
    for (const double radius : cloud->radii()) content.add(radius);
  } else {
    throw std::logic_error(std::string("no hash is known of a geometry of the type ") + typeid(geometry).name());
  }
  return content.hash();
}

/// Hashes of geometries; what many share is read once.
class Hashes {
 public:
  const std::string& of(const fcl::CollisionObjectd& object) {
    std::string& hash = known_[object.collisionGeometry().get()];
    if (hash.empty()) hash = hashOf(*object.collisionGeometry());
    return hash;
  }

 private:
  std::map<const fcl::CollisionGeometryd*, std::string> known_;
};

void addTree(const KinematicTree& tree, Content& content) {
  for (LinkId link = 0; link < tree.numLinks(); ++link) content.add(tree.linkName(link));
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    for (const std::string& name : {joint.name, joint.parent, joint.child}) content.add(name);
    content.add(static_cast<double>(joint.type));
    content.add(joint.origin);
    content.add(joint.axis);
    content.add(Eigen::Vector3d(joint.lower, joint.upper, static_cast<double>(joint.mimics)));
    if (!joint.mimics) continue;
    content.add(joint.mimic.master);
    content.add(Eigen::Vector3d(joint.mimic.multiplier, joint.mimic.offset, 0));
  }
}

void addAllowed(const AllowedCollisionMatrix& allowed, Content& content) {
  content.add(static_cast<double>(allowed.complete()));
  for (const auto* pairs : {&allowed.pairs(), &allowed.disallowedPairs()}) {
    content.add(static_cast<double>(pairs->size()));
    for (const auto& [a, b] : *pairs) {
      content.add(a);
      content.add(b);
    }
  }
}

/// Whether files of this ending name no others that hold geometry.
bool isWhole(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* whole : {".stl", ".obj", ".ply", ".off", ".scene", ".bt", ".ot", ".pcd", ".xyz"}) {
    if (ending == whole) return true;
  }
  return false;
}

}  // namespace

std::string sceneFileHash(const std::string& path, const SceneOptions& options) {
  if (isWhole(path)) return certificate::sha256Text(files::read(path));
  const Scene scene = loadScene(path, options);
  return obstaclesHash(scene, scene.obstacles.size());
}

std::string obstaclesHash(const Scene& scene, std::size_t number) {
  Content content;
  Hashes hashes;
  for (std::size_t i = 0; i < number; ++i) {
    const Scene::Obstacle& obstacle = scene.obstacles[i];
    content.add(obstacle.name);
    content.add(Eigen::Isometry3d(obstacle.object->getTransform()));
    content.add(hashes.of(*obstacle.object));
  }
  return content.hash();
}

std::string robotHash(const World& read) {
  Content content;
  Hashes hashes;
  content.add(static_cast<double>(kErrata));
  addTree(*read.robot.tree, content);
  for (const LinkGeometry& geometry : read.robot.geometry) {
    content.add(static_cast<double>(geometry.link));
    content.add(geometry.offset);
    content.add(hashes.of(*geometry.object));
  }
  const std::size_t first = read.scene.obstacles.size() - read.attachments.size();
  for (std::size_t i = 0; i < read.attachments.size(); ++i) {
    const Attachment& attachment = read.attachments[i];
    const Scene::Obstacle& obstacle = read.scene.obstacles[first + i];
    for (const std::string& name : {obstacle.name, attachment.link}) content.add(name);
    for (const std::string& link : attachment.touch_links) content.add(link);
    content.add(attachment.pose);
    content.add(hashes.of(*obstacle.object));
  }
  addAllowed(read.robot.allowed, content);
  content.add(read.pairs().text());
  if (read.tolerances().any()) content.add(read.tolerances().text());
  return content.hash();
}

}  // namespace fcl_artic::app
