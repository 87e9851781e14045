// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fcl/narrowphase/collision_object.h>

#include "fcl_artic/manager.h"
#include "fcl_artic/point_cloud.h"

namespace fcl_artic {

/// A geometry of a robot's link, ready for ArticulatedCollisionManager::bind().
struct LinkGeometry {
  LinkId link = -1;                                          ///< The link in Robot::tree.
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();  ///< Pose of the geometry's frame in the link's frame.
  /// The geometry: BVHModel<OBBRSSd> or SolidMesh<OBBRSSd> for a mesh, else Box, Cylinder or Sphere. Its own transform
  /// is not used. Meshes of the same file and scale share their geometry.
  std::shared_ptr<fcl::CollisionObjectd> object;
  std::string source;  ///< Path of the mesh file, or "box", "cylinder", "sphere".
};

/// A robot read from URDF: its tree and the collision geometry of its links.
struct Robot {
  std::shared_ptr<const KinematicTree> tree;  ///< Links and joint variables in the order of the file.
  std::vector<LinkGeometry> geometry;         ///< Collision geometry of the links; a link may have several.
  /// Pairs of links that may touch: empty after loadUrdf(), to be set from loadSrdf() or generateAllowedCollisions().
  /// Neighbours (ArticulatedCollisionManager::setAllowedCollisions()) need no entry, unless the matrix is complete, as
  /// that of an SRDF is.
  AllowedCollisionMatrix allowed;
  /// Proofs of pairs that never touch, from generateAllowedCollisions(); null: none.
  std::shared_ptr<const LinkPairProofs> proofs;
  std::vector<std::string> notes;  ///< Notes of what was accepted though unusual, one line each.

  /// Binds every geometry to its link and replaces the manager's allowed collisions and proofs. Needs setup()
  /// afterwards. The manager keeps the geometries alive; the Robot may go.
  /// @param manager  made for `tree`, or for a tree that begins with links of the same names.
  /// @throws std::invalid_argument for a manager of another robot, and as ArticulatedCollisionManager::bind() and
  ///   setAllowedCollisions(). Nothing stays bound then.
  FCL_ARTIC_EXPORT void addTo(ArticulatedCollisionManager& manager) const;
};

/// How a robot's root link moves in the world, as the `virtual_joint` of an SRDF says it.
struct VirtualJoint {
  std::string name;
  JointType type = JointType::floating;  ///< planar (x, y, theta, in the plane z = 0 of its parent) or floating
  std::string parent_frame;              ///< name of the link that stands for the world
  std::string child_link;                ///< the robot's root link
};

/// Reads the `virtual_joint` of an SRDF that moves the robot.
/// @return none where the file has none, or only ones of type `fixed`.
/// @throws std::runtime_error naming file, line and reason: unreadable, not an SRDF, a missing attribute, a type that
/// is
///   neither fixed, planar nor floating, two that move.
FCL_ARTIC_EXPORT std::optional<VirtualJoint> loadVirtualJoint(const std::string& path);

/// Options of loadUrdf().
struct UrdfOptions {
  /// Folders that stand for "package://NAME/" (or "package:///NAME/"): from name to folder. A package that isn't named
  /// here is looked for in this order:
  /// - in the URDF's folder and its parents, by folder name and by the `name` in a package.xml;
  /// - as ROS does, in and below the folders of the environment's ROS_PACKAGE_PATH;
  /// - at share/NAME in the folders of AMENT_PREFIX_PATH.
  ///
  /// The first folder that has the file is taken.
  std::map<std::string, std::string> packages;
  /// Whether meshes are solids (SolidMesh), so that what lies within one touches it. A mesh that is not closed and
  /// consistently oriented is an error then. (For some meshes only: apply makeSolid() to the geometries of Robot.)
  bool solid_meshes = false;
  /// Whether the up axis of COLLADA and glTF files counts: what is up (of COLLADA what the file says, y if it says
  /// nothing; of glTF y) becomes z. If not, as in RViz and MoveIt, coordinates are taken as they stand, and a file in
  /// which x or y is up is noted.
  bool collada_up_axis = false;
  /// Pose of the robot's root link in the world. If it is not the identity, the tree has one more link, its last, and
  /// one more joint, "base_mount", its first. The link is "world", or, if the robot has a link of that name, "world_".
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  /// Whether the robot's root link moves freely in the world: the tree has one more link, as for `base`, and a floating
  /// joint "floating_base", whose origin is `base`. Its 7 variables come before the robot's own.
  bool floating_base = false;
  /// Whether meshes of formats that loadMesh() does not read itself are read by assimp, with a note.
  bool import_meshes = false;
  /// Moves the robot's root link in the world: the tree has one more link, its `parent_frame`, and its joint, whose
  /// origin is `base`. Its variables come before the robot's own. Not beside `floating_base`.
  std::optional<VirtualJoint> virtual_joint;
};

/// Reads a robot from a URDF file. Meshes are read as by loadMesh(), with their scale, and are found by absolute path,
/// path relative to the URDF's folder, `file:` or `package:` URL. Xacro files must be expanded before.
/// @throws std::runtime_error naming file and reason:
///   - unreadable, not a URDF, joint loop, unsupported joint;
///   - missing or empty mesh, with all places that were searched;
///   - mesh without a triangle of positive area, mesh that is to be a solid and can't be one;
///   - a base that is not rigid to 1e-9, a joint of the name that the base's needs;
///   - a virtual joint beside floating_base, or whose child is not the root link.
FCL_ARTIC_EXPORT Robot loadUrdf(const std::string& path, const UrdfOptions& options = {});

/// One part of combineRobots().
struct PlacedRobot {
  const Robot* robot = nullptr;  ///< The robot; must live until combineRobots() returns.
  std::string prefix;            ///< Prepended to all of its link and joint names, such as "left_".
  /// Pose of its root links in the world.
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
};

/// Combines several robots into one forest, each on a link of its own, prefix + "mount". If a part was combined
/// before, each of its roots is on prefix + "mount_of_" + the root's name. Their variables follow each other in the
/// order of the parts. Allowed pairs, and what is said of neighbours, are those of the parts, proofs are none. Every
/// link of one robot is checked against every link of the others, but for what stands still against each other
/// (ArticulatedCollisionManager::setAllowedCollisions()). Geometries are shared with the parts.
/// @throws std::invalid_argument: null, a name that comes twice (give other prefixes), a base that is not rigid to
///   1e-9.
FCL_ARTIC_EXPORT Robot combineRobots(const std::vector<PlacedRobot>& parts, const std::string& name = "robots");

/// An upper bound on how far from the robot's root a point of its geometry gets in any configuration, m, as rounded.
/// It is the lengths of the links in a row, each with what it carries. (Compared with a mesh's extent, it shows a file
/// that is in other units.) Where the robot stands does not count. If one fixed, planar or floating joint leaves a
/// root without geometry, such as "world", its child is the root here. Joints that slide count by their limits;
/// without limits they count as standing still at 0, as planar and floating ones do, and the bound holds for such
/// configurations only.
/// @param geometry  what the links carry; none: the bound is on the frames of joints and links.
FCL_ARTIC_EXPORT double reachUpper(const KinematicTree& tree, const std::vector<LinkGeometry>& geometry = {});

/// A pair of links that needs no check, as readSrdf() reads it.
struct SrdfPair {
  /// Names of the two links.
  std::string link1, link2;
  std::string reason;  ///< The reason that the file gives, such as "Adjacent", "Always", "Default" or "Never".
};

/// Reads the pairs of links that need no check from an SRDF file, as MoveIt does: `disable_collisions`, and
/// `disable_default_collisions` with its exceptions, `enable_collisions`. As in MoveIt, all other pairs are checked,
/// neighbours too: the matrix is complete (AllowedCollisionMatrix::setComplete()).
///
/// Entries with a link that the robot lacks are passed over, which leaves no pair unchecked: the SRDFs of many makers
/// name links that not all of their URDFs have.
/// @param notes  what was passed over is appended, one line; may be null.
/// @throws std::runtime_error naming file and reason:
///   - unreadable;
///   - not an SRDF;
///   - none of its links is one of the robot's;
///   - an `enable_collisions` with a link that the robot lacks, whose other link is disabled by default: were it a
///     slip, the pair that was meant would go unchecked.
FCL_ARTIC_EXPORT AllowedCollisionMatrix loadSrdf(const std::string& path, const KinematicTree& tree,
                                                 std::vector<std::string>* notes = nullptr);

/// Reads the same pairs as loadSrdf(), each with the reason that the file gives, in the order of their names.
/// @return each pair once, the alphabetically smaller name first; the reason is empty where the file has none, and
///   "disable_default_collisions" where that is what allows the pair.
/// @throws std::runtime_error as loadSrdf().
FCL_ARTIC_EXPORT std::vector<SrdfPair> readSrdf(const std::string& path, const KinematicTree& tree,
                                                std::vector<std::string>* notes = nullptr);

/// Finds the pairs of a robot's links that need no check: the manager's classifyLinkPairs(), which says what of its
/// answer is proven. (`never` is. MoveIt's assistant samples.) To use what it finds:
/// `robot.allowed = report.alwaysTouching(); robot.proofs = report.proofs;`, then addTo().
/// @throws std::invalid_argument for a robot without a tree, and as ArticulatedCollisionManager::bind() and
///   classifyLinkPairs().
FCL_ARTIC_EXPORT LinkPairReport generateAllowedCollisions(const Robot& robot, const LinkPairOptions& options = {});
/// Writes an SRDF file with the pairs that need no check within the joints' limits (`disable_collisions`):
/// - pairs that never touch, proven ("Never"),
/// - pairs that always do ("Always"),
/// - neighbours that a manager leaves out by itself ("Adjacent").
///
/// The file is written as a whole or, if this throws, not at all.
/// @throws std::runtime_error naming file and reason.
FCL_ARTIC_EXPORT void writeSrdf(const std::string& path, const std::string& robot_name, const LinkPairReport& report);
/// Writes the same file with pairs that the caller allows, each with its own reason.
/// @param others  those that the report has too are left to it.
/// @throws std::runtime_error naming file and reason.
FCL_ARTIC_EXPORT void writeSrdf(const std::string& path, const std::string& robot_name, const LinkPairReport& report,
                                const std::vector<SrdfPair>& others);

/// Obstacles read from a scene file.
struct Scene {
  /// One obstacle that stands still.
  struct Obstacle {
    std::string name;                               ///< Unique in the scene.
    std::shared_ptr<fcl::CollisionObjectd> object;  ///< Geometry, at its pose in the world.
    /// If it is a shape of an object that has several: the name of the object, which is that of its first shape; else
    /// empty.
    std::string shape_of = {};
  };
  std::vector<Obstacle> obstacles;  ///< The obstacles, in the order of the file.
  std::vector<std::string> notes;   ///< Notes of what was accepted though unusual, one line each.
  /// Names of all obstacles that a name stands for: of a whole object, its shapes. (Margins, allowed pairs and attach()
  /// go by the names of single obstacles: one call for each.)
  FCL_ARTIC_EXPORT std::vector<std::string> namesOf(const std::string& object) const;
  /// Registers every obstacle by its name. Needs setup() afterwards. The manager keeps the obstacles alive; the Scene
  /// may go.
  /// @throws std::invalid_argument as ArticulatedCollisionManager::registerObject(); none stays registered then.
  FCL_ARTIC_EXPORT void addTo(ArticulatedCollisionManager& manager) const;
};

/// Options of loadScene().
struct SceneOptions {
  /// OctoMap files: whether unknown cells are obstacles too, within the box around all known cells (octomap's
  /// getMetricMin() to getMetricMax()). If not, unknown space is free.
  bool unknown_cells = false;
  bool solid_meshes = false;     ///< Whether meshes are solids, as UrdfOptions::solid_meshes.
  bool collada_up_axis = false;  ///< Whether a COLLADA file's up axis counts, as UrdfOptions::collada_up_axis.
  /// Factor by which all lengths of the scene, positions too, are multiplied: 0.001 for a file in millimetres. Above 0.
  double scale = 1;
  /// Radius of a point cloud's points, in m, whatever the scale. Above 0 for files of points; 0: they are refused.
  double point_radius = 0;
  std::map<std::string, std::string> packages;  ///< For URDF files, as UrdfOptions::packages.
  bool import_meshes = false;                   ///< As UrdfOptions::import_meshes.
};

/// Reads a scene. The file's ending decides how: meshes as by loadMesh(), one obstacle a file; URDF (.urdf), all links
/// in the neutral configuration as obstacles; MoveIt's scene text (.scene); OctoMap (.bt .ot), occupied cells as boxes;
/// point clouds (.pcd .xyz, .ply without faces), balls. Names are made unique: further shapes of an object become
/// NAME#2 and so on.
/// @throws std::invalid_argument for a scale that is not above 0 and finite; std::runtime_error naming file and reason.
FCL_ARTIC_EXPORT Scene loadScene(const std::string& path, const SceneOptions& options = {});

/// Combines several scenes into one, for a robot. An obstacle whose name another one or a link has becomes NAME#2 or
/// so, with a note. (Allowed pairs and margins are given by name.) Objects are shared with the scenes.
FCL_ARTIC_EXPORT Scene combineScenes(const std::vector<Scene>& scenes, const KinematicTree& tree);

/// Compares the extents of a scene with the reach of a robot. It reports what suggests that one of them is in other
/// units than metres: no obstacle can be reached, or one is a hundred times as large as the reach. The reach is that
/// of any point of the robot's geometry from its root, whatever the joint values within their limits. Nothing is
/// reported of a robot that slides or floats without limits, nor of unbounded obstacles.
/// @return one line each, naming obstacle, both lengths in m and the cure; none if all is as usual.
FCL_ARTIC_EXPORT std::vector<std::string> unitNotes(const Robot& robot, const Scene& scene);

/// Reads a point cloud:
/// - PCD (.pcd: ascii, binary, binary_compressed);
/// - PLY (.ply, its vertices);
/// - lines that begin with three numbers (.xyz; one separator, a blank, a comma or a semicolon, and one number of
///   columns a file).
///
/// Points that are not finite, as of rays without an echo, are left out, with a note. A PCD file's VIEWPOINT is not
/// applied; a note says so where it is not the identity. Counts that do not agree, and what follows the last point,
/// are refused.
/// @param radius  of all points, in m.
/// @param notes   what was accepted though unusual is appended, one line each; may be null.
/// @throws std::invalid_argument for a radius that is not above 0 and finite; std::runtime_error naming file and
/// reason.
FCL_ARTIC_EXPORT std::shared_ptr<PointCloud> loadPointCloud(const std::string& path, double radius,
                                                            std::vector<std::string>* notes = nullptr);

/// Reads a triangle mesh, all parts of the file in one BVHModel<OBBRSSd>: STL (.stl), OBJ (.obj), PLY (.ply), OFF
/// (.off), COLLADA (.dae), glTF 2.0 (.gltf, .glb). Decimals become the nearest doubles; places of nodes (COLLADA,
/// glTF) are computed in doubles. Content that may be geometry, or its place, and is not understood is refused by
/// name. Points, lines and vertices without a triangle are left out, with a note. Triangles without area stay, as the
/// segments that they are, but for those with two equal corners along an edge of another triangle. The manual's page
/// "What is read" has the list.
/// @param scale  factor for each axis, finite, not 0.
/// @param notes  what was accepted though unusual is appended, one line each; may be null.
/// @param solid  whether to return a SolidMesh<OBBRSSd>, triangles without area included. A mesh that is not closed and
///   consistently oriented is refused then.
/// @param collada_up_axis  whether the up axis of COLLADA and glTF files counts, as UrdfOptions::collada_up_axis; the
///   unit of COLLADA does.
/// @param import_meshes  whether files of other formats are read by assimp, with a note. .3mf, .amf and .x3d are
/// refused:
///   their units or parts would get lost.
/// @throws std::runtime_error naming file and reason: unreadable, no triangle of positive area, a scale of 0 or not
///   finite, no solid though it is to be one.
FCL_ARTIC_EXPORT std::shared_ptr<fcl::CollisionGeometryd> loadMesh(const std::string& path,
                                                                   const Eigen::Vector3d& scale,
                                                                   std::vector<std::string>* notes = nullptr,
                                                                   bool solid = false, bool collada_up_axis = false,
                                                                   bool import_meshes = false);

}  // namespace fcl_artic
