// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fcl/narrowphase/collision_object.h>

#include "fcl_artic/manager.h"

namespace fcl_artic {

/// A geometry of a robot's link, ready for ArticulatedCollisionManager::bind().
struct LinkGeometry {
  LinkId link = -1;
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();  ///< geometry in the link's frame
  /// BVHModel<OBBRSSd> or SolidMesh<OBBRSSd> for a mesh; Box, Cylinder, Sphere.
  std::shared_ptr<fcl::CollisionObjectd> object;
  std::string source;  ///< mesh file, or "box", "cylinder", "sphere"
};

/// A robot read from URDF: its tree and the collision geometry of its links.
struct Robot {
  std::shared_ptr<const KinematicTree> tree;
  std::vector<LinkGeometry> geometry;
  AllowedCollisionMatrix allowed;  ///< from loadSrdf() or generateAllowedCollisions(); adjacent links need no entry
  std::vector<std::string> notes;  ///< what was accepted though unusual, one line each

  /// Binds every geometry and sets the allowed collisions; the manager keeps the geometries alive, the Robot may go.
  /// setup() is left to the caller.
  /// @throws std::invalid_argument as bind(); nothing stays bound then.
  FCL_ARTIC_EXPORT void addTo(ArticulatedCollisionManager& manager) const;
};

struct UrdfOptions {
  /// Folders that stand for "package://NAME/": name to folder. A package that isn't named is looked for in the URDF's
  /// folder and its parents, by folder name.
  std::map<std::string, std::string> packages;
  /// Meshes are solids (SolidMesh), what lies within one touches it. One that is not closed and consistently oriented
  /// is an error then. (For some meshes only: makeSolid() of what Robot::geometry has.)
  bool solid_meshes = false;
};

/// Reads a robot. Meshes (what assimp reads) come with their scale, by absolute path, path relative to the URDF's
/// folder, file:// or package://. Degenerate triangles stay out, with a note.
/// @throws std::runtime_error naming file and reason: unreadable, not a URDF, joint loop, unsupported joint, missing
///   or empty mesh, mesh without a triangle of positive area, mesh that is to be a solid and can't be one.
FCL_ARTIC_EXPORT Robot loadUrdf(const std::string& path, const UrdfOptions& options = {});

/// One of several robots: every name gets the prefix, such as "left_".
struct PlacedRobot {
  const Robot* robot = nullptr;
  std::string prefix;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();  ///< of its root links, in the world
};

/// Several robots as one, a forest: each stands on a link of its own, PREFIX + "mount". Their variables follow each
/// other in the order of the parts. Allowed pairs are those of the parts; every link of one robot is checked against
/// every link of the others, those of robots that touch where they stand too.
/// @throws std::invalid_argument: null, a name that comes twice (give other prefixes), a base that is not rigid.
FCL_ARTIC_EXPORT Robot combineRobots(const std::vector<PlacedRobot>& parts, const std::string& name = "robots");

/// Reads the disabled pairs of an SRDF (`disable_collisions`), as MoveIt's assistant writes them.
/// @throws std::runtime_error naming file and reason; an unknown link is an error.
FCL_ARTIC_EXPORT AllowedCollisionMatrix loadSrdf(const std::string& path, const KinematicTree& tree);

struct AllowedPair {
  std::string link1, link2;
  std::string reason;  ///< "Adjacent", "Always", "Default" or "Never", as MoveIt's assistant writes them
};

/// Pairs that need no check, found as MoveIt's assistant does: adjacent, in contact in all of `samples` random
/// configurations within the limits (continuous joints: [-π, π]), at q = 0, or in none of them.
/// Sampled, not proven: 'never' is for speed, and a pair that does collide rarely may be among them.
FCL_ARTIC_EXPORT std::vector<AllowedPair> generateAllowedCollisions(const Robot& robot, int samples = 10000,
                                                                    std::uint64_t seed = 1);
/// Writes an SRDF with these pairs, all or nothing. @throws std::runtime_error naming file and reason.
FCL_ARTIC_EXPORT void writeSrdf(const std::string& path, const std::string& robot_name,
                                const std::vector<AllowedPair>& pairs);

/// Obstacles read from a scene file.
struct Scene {
  struct Obstacle {
    std::string name;
    std::shared_ptr<fcl::CollisionObjectd> object;
  };
  std::vector<Obstacle> obstacles;
  std::vector<std::string> notes;
  /// Registers every obstacle; the manager keeps them alive, the Scene may go. setup() is left to the caller.
  /// @throws std::invalid_argument as registerObject(); none stays registered then.
  FCL_ARTIC_EXPORT void addTo(ArticulatedCollisionManager& manager) const;
};

struct SceneOptions {
  /// OctoMap: unknown cells are obstacles too, within the box around all cells that are known (octomap's
  /// getMetricMin() to getMetricMax()); else unknown space is free.
  bool unknown_cells = false;
  bool solid_meshes = false;  ///< as UrdfOptions::solid_meshes
};

/// Reads a scene by its file's ending: meshes (what assimp reads: .obj .stl .ply .dae ...), one obstacle a file;
/// URDF (.urdf: all links at q = 0, quaternions at no rotation, as obstacles); MoveIt scene text (.scene);
/// OctoMap (.bt .ot), occupied cells as boxes. Names are given once: NAME#2 and so on for the further shapes of one
/// object.
/// @throws std::runtime_error naming file and reason.
FCL_ARTIC_EXPORT Scene loadScene(const std::string& path, const SceneOptions& options = {});

/// Several scenes as one, for a robot: an obstacle whose name another one or a link has becomes NAME#2, or so on, with
/// a note. (Allowed pairs and margins go by name.)
FCL_ARTIC_EXPORT Scene combineScenes(const std::vector<Scene>& scenes, const KinematicTree& tree);

/// A triangle mesh by assimp, all its parts in one BVHModel, scaled per axis.
/// @param solid  it is a SolidMesh, triangles without area included; refused when it is not closed and consistently
///   oriented.
/// @throws std::runtime_error as loadUrdf().
FCL_ARTIC_EXPORT std::shared_ptr<fcl::CollisionGeometryd> loadMesh(const std::string& path,
                                                                   const Eigen::Vector3d& scale,
                                                                   std::vector<std::string>* notes = nullptr,
                                                                   bool solid = false);

}  // namespace fcl_artic
