// SPDX-License-Identifier: BSD-3-Clause
//
// Options about a robot: its files, where it stands, what it carries.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include "fcl_artic/manager.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::app {

struct RobotOptions {
  std::string robot, srdf;            ///< files; no SRDF: empty
  std::vector<std::string> packages;  ///< NAME=DIR
  std::string base;                   ///< a pose, as parsePose() reads it; empty: the identity
  std::vector<std::string> attached;  ///< as parseAttachment() reads them
  bool floating_base = false, virtual_joint = false, solid_meshes = false, collada_up_axis = false,
       import_meshes = false;
};

/// Names of the robot's option: the file may stand by itself.
constexpr const char* kRobotNames = "ROBOT,--robot";
/// Adds ROBOT (or --robot), --package and --import, in the group "Robot and scene".
/// @param names  of the robot's option.
void addRobotFile(CLI::App& verb, RobotOptions& options, const std::string& names = kRobotNames);
/// Adds these, --srdf, --base, --floating-base and --virtual-joint.
/// @return --srdf, for what excludes it.
CLI::Option* addRobotOptions(CLI::App& verb, RobotOptions& options, const std::string& names = kRobotNames);
/// Adds --attach.
void addAttachOption(CLI::App& verb, RobotOptions& options);

UrdfOptions urdfOptions(const RobotOptions& options);
/// For scenes and carried objects, whose URDF files look for the same packages. (The caller adds the options of
/// WorldOptions.)
SceneOptions sceneOptions(const RobotOptions& options);

/// The robot, its allowed pairs and its notes. @throws as loadUrdf() and loadSrdf().
Robot readRobot(const RobotOptions& options);

/// Reads a pose as it is typed: "x,y,z" or "x,y,z,roll,pitch,yaw", m and rad or, with the ending deg, degrees. The
/// angles turn about the fixed axes x, y and z, one after the other, as in URDF.
/// @throws std::invalid_argument beginning with `option`.
Eigen::Isometry3d parsePose(const std::string& text, const std::string& option);

/// The parts of a text between separators; one at least, perhaps empty.
std::vector<std::string> split(const std::string& text, char separator);

/// An object that a link carries.
struct Attachment {
  std::string link;
  std::vector<std::string> touch_links;  ///< further links that it may touch
  std::string file;
  std::size_t option = 0;                                  ///< which --attach it is of
  std::string name;                                        ///< of the object, in its file; empty before that is read
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the file's frame in the link's
};

/// Reads "LINK=FILE", "LINK=FILE@POSE" or, with links that the object may touch, "LINK+LINK2+LINK3=FILE@POSE".
/// @throws std::invalid_argument naming the text and the reason, also for a link that the robot does not have.
Attachment parseAttachment(const KinematicTree& tree, const std::string& text);

/// Reads what links carry: appends a scene for each --attach.
/// @return one for each obstacle of these scenes, in their order.
std::vector<Attachment> readAttachments(const RobotOptions& options, const KinematicTree& tree,
                                        const SceneOptions& scene_options, std::vector<Scene>& scenes);
/// Makes links carry the last obstacles of a scene, all of whose obstacles the manager has. Needs setup() afterwards.
void attachLast(const std::vector<Attachment>& attachments, const Scene& scene, ArticulatedCollisionManager& manager);
/// For a picture: the last obstacles are made geometry of the links that carry them.
void moveToLinks(const std::vector<Attachment>& attachments, Scene& scene, Robot& robot);

}  // namespace fcl_artic::app
