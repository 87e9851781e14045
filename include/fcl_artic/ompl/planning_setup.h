// SPDX-License-Identifier: BSD-3-Clause
//
// From files to an OMPL SpaceInformation that planners take, in one call.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/State.h>

#include "fcl_artic/ompl/motion_validator.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::planning {

struct SetupOptions {
  UrdfOptions urdf;
  SceneOptions scene;
  /// Values of joint variables outside the group, by name; the others are at 0, or at the limit that is nearest to 0.
  std::map<std::string, double> fixed;
  /// Bounds of positions of planar (x, y) and floating joints that are planned for, m; needed for these only.
  Eigen::Vector3d position_lower = Eigen::Vector3d::Zero(), position_upper = Eigen::Vector3d::Zero();
  CertifiedRequest request = planningRequest();
};

/// All that a planner needs. `si` keeps everything alive that it uses.
struct PlanningSetup {
  /// Set up, with continuous motion validator and state validity checker.
  ::ompl::base::SpaceInformationPtr si;
  /// A RealVectorStateSpace within the joints' limits; joints without limits that turn are SO2StateSpaces, planar
  /// joints SE2, spherical SO3 and floating ones SE3, and the space is then a compound of parts in the order of
  /// `joints`.
  ::ompl::base::StateSpacePtr space;
  std::vector<std::string> joints;  ///< planned for, in the order of a state's values
  std::shared_ptr<const ArticulatedCollisionManager> manager;
  std::vector<std::string> notes;  ///< of the loaders

  /// Writes joint values into a state.
  /// @param values  in the order of `joints`, those of a planar joint x, y, theta, of a floating one x, y, z and the
  ///   quaternion's x, y, z, w.
  /// @throws std::invalid_argument for another number of values.
  FCL_ARTIC_EXPORT void setState(::ompl::base::State* state, const std::vector<double>& values) const;
  FCL_ARTIC_EXPORT std::vector<double> values(const ::ompl::base::State* state) const;
};

/// Sets up planning for a group of a robot from files.
/// @param srdf   allowed pairs and groups.
/// @param scene  what loadScene() reads; empty: no obstacles. An obstacle with a link's name gets another, see
/// combineScenes().
/// @throws std::runtime_error as the loaders, and for an SRDF without the group.
/// @throws std::invalid_argument as the other one.
FCL_ARTIC_EXPORT PlanningSetup setUpPlanning(const std::string& urdf, const std::string& srdf, const std::string& scene,
                                             const std::string& group, const SetupOptions& options = {});

/// Sets up planning for some joints of a manager that is set up already.
/// @param joints  names; none: all joints of the tree that move.
/// @throws std::invalid_argument naming the joint: unknown, fixed, mimic, named twice, fixed by an option and planned
///   for, without room between its limits or with limits beyond 1e5, prismatic without limits, or planar or floating
///   without bounds in the options (within 1e5 too).
FCL_ARTIC_EXPORT PlanningSetup setUpPlanning(std::shared_ptr<const ArticulatedCollisionManager> manager,
                                             const std::vector<std::string>& joints, const SetupOptions& options = {});

/// The joints that a group of an SRDF moves, in the tree's order: its chains, joints, links (their parent joints)
/// and subgroups, without fixed, mimic and passive joints, and those whose limits are one value.
/// @throws std::runtime_error naming file and reason: unreadable, no such group, unknown link, joint or subgroup, a
///   subgroup within itself, a chain whose ends are not connected, a group that moves nothing.
FCL_ARTIC_EXPORT std::vector<std::string> groupJoints(const std::string& srdf, const KinematicTree& tree,
                                                      const std::string& group);

}  // namespace fcl_artic::planning
