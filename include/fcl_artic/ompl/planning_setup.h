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

/// Options of setUpPlanning().
struct SetupOptions {
  UrdfOptions urdf;    ///< How the robot is read; not used for a manager that is set up already.
  SceneOptions scene;  ///< How the scene is read; not used for a manager that is set up already.
  /// Values of joint variables that are not planned for, rad or m, by KinematicTree::variableName(). Others are at 0,
  /// or at the limit that is nearest to 0.
  std::map<std::string, double> fixed;
  /// Bounds of the positions of planar (x, y) and floating (x, y, z) joints that are planned for, m, within 1e5; not
  /// needed otherwise.
  Eigen::Vector3d position_lower = Eigen::Vector3d::Zero(), position_upper = Eigen::Vector3d::Zero();
  CertifiedRequest request = planningRequest();  ///< The request of validator and checker.
  /// Who culls by visibility where `request.visibility` asks for it; null: the executor cpu. Not used for a manager
  /// that is set up already, which has its own (ArticulatedCollisionManager::setVisibility()).
  std::shared_ptr<const VisibilityCuller> visibility;
};

/// All that a planner needs. `si` keeps everything alive that it uses.
struct PlanningSetup {
  /// The space information, set up, with continuous motion validator and state validity checker.
  ::ompl::base::SpaceInformationPtr si;
  /// The state space: a RealVectorStateSpace within the joints' limits. Turning joints without limits are
  /// SO2StateSpaces, planar joints SE2, spherical SO3 and floating ones SE3. If there are such joints, the space is a
  /// compound of these parts in the order of `joints`, with weights 1.
  ::ompl::base::StateSpacePtr space;
  std::vector<std::string> joints;  ///< Names of the joints that are planned for, in the order of a state's values.
  std::shared_ptr<const ArticulatedCollisionManager> manager;  ///< Robot and scene, set up; must not be changed.
  std::vector<std::string> notes;                              ///< Notes of what the loaders accepted though unusual.

  /// Writes joint values into a state. Angles of SO2StateSpaces are brought into (-π, π], and quaternions whose length
  /// is 1 within 1e-3 to the length 1, which OMPL asks for within 1e-9.
  /// @param state   of `space`.
  /// @param values  rad or m, in the order of `joints`: for a planar joint x, y, theta, for a floating one x, y, z and
  ///   the quaternion's x, y, z, w.
  /// @throws std::invalid_argument for another number of values.
  FCL_ARTIC_EXPORT void setState(::ompl::base::State* state, const std::vector<double>& values) const;
  /// Returns the joint values of a state, rad or m, in the order that setState() takes them.
  FCL_ARTIC_EXPORT std::vector<double> values(const ::ompl::base::State* state) const;
};

/// Sets up planning for a group of a robot, from files.
/// @param urdf   robot; see loadUrdf().
/// @param srdf   allowed pairs and groups; see loadSrdf(), groupJoints().
/// @param scene  obstacles; see loadScene(). Empty: no obstacles. An obstacle with a link's name gets another one; see
///   combineScenes().
/// @param group  name of the group in the SRDF.
/// @throws std::runtime_error as the loaders, and for an SRDF without the group.
/// @throws std::invalid_argument as for joints of a manager.
FCL_ARTIC_EXPORT PlanningSetup setUpPlanning(const std::string& urdf, const std::string& srdf, const std::string& scene,
                                             const std::string& group, const SetupOptions& options = {});

/// Sets up planning for some joints of a manager that is set up already.
/// @param manager  must not be changed while planners run, and must keep its objects alive.
/// @param joints   names; empty: all joints of the tree that move, except those whose limits are one value.
/// @throws std::invalid_argument for a manager that is null, for no joint, and, naming it, for a joint that is
///   - unknown, fixed, mimic, named twice, or fixed by an option and planned for,
///   - without room between its limits, or with limits beyond 1e5,
///   - prismatic without limits,
///   - planar or floating without bounds in the options (within 1e5 too).
FCL_ARTIC_EXPORT PlanningSetup setUpPlanning(std::shared_ptr<const ArticulatedCollisionManager> manager,
                                             const std::vector<std::string>& joints, const SetupOptions& options = {});

/// Sets up planning for a rigid body that moves freely among obstacles: the manager's tree is one joint, "body", from
/// the root "world" to the link "body". A state's pose is that of the geometry's own frame in the world. The way that
/// StateSpace::interpolate() takes is proven free: the frame's origin goes straight while the body turns the shorter
/// way at constant speed (FCL's CCDM_LINEAR about the origin, not CCDM_SCREW).
/// @param body       any geometry that a manager takes; shared from here on.
/// @param obstacles  what stands still, as from loadScene(); an obstacle named "world" or "body" gets another name.
/// @param options    position_lower and position_upper are needed; `fixed` and `urdf` are not used.
/// @param freedom    JointType::floating for an SE3StateSpace, or JointType::planar, in the plane z = 0, for an
///   SE2StateSpace.
/// @throws std::invalid_argument: body null or refused by the manager, a freedom of another type, bounds that are none.
FCL_ARTIC_EXPORT PlanningSetup setUpRigidBody(std::shared_ptr<fcl::CollisionGeometryd> body, const Scene& obstacles,
                                              const SetupOptions& options, JointType freedom = JointType::floating);

/// Returns the names of the joints that a group of an SRDF moves, in the tree's order: its chains, joints, links
/// (their parent joints) and subgroups. Fixed, mimic and passive joints are left out, and joints whose limits are one
/// value.
/// @param srdf   path of the file.
/// @param group  name of the group.
/// @throws std::runtime_error naming file and reason: unreadable, no such group, unknown link, joint or subgroup, a
///   subgroup within itself, a chain whose ends are not connected, a group that moves nothing.
FCL_ARTIC_EXPORT std::vector<std::string> groupJoints(const std::string& srdf, const KinematicTree& tree,
                                                      const std::string& group);

}  // namespace fcl_artic::planning
