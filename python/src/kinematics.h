// SPDX-License-Identifier: BSD-3-Clause
//
// Kinematic trees, motions and trajectories in Python.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "array.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/trajectory.h"
#include "recipe.h"

namespace fcl_artic::python {

/// A tree as Python holds it: one that is being built, or a robot's, which does not change.
struct Tree {
  std::shared_ptr<KinematicTree> own;         ///< Null for a robot's.
  std::shared_ptr<const KinematicTree> tree;  ///< The same as `own`, if that is not null.
};

Tree treeInBuilding(std::string name);
inline Tree treeOfRobot(std::shared_ptr<const KinematicTree> tree) {
  return {nullptr, std::move(tree)};
}

/// The tree of a KinematicTree, Robot or World.
/// @throws py::type_error for what has none.
std::shared_ptr<const KinematicTree> treeOf(py::handle value);
/// The same, but a copy if the tree is being built: so no other thread changes it while this one has let go of the GIL.
std::shared_ptr<const KinematicTree> finishedTreeOf(py::handle value);

/// A link by its name or index.
/// @throws py::value_error for a name that is not there, with one that may be meant; py::index_error for an index.
LinkId linkOf(const KinematicTree& tree, py::handle link);

/// The straight motion from one configuration to another.
JointMotion linearMotion(const KinematicTree& tree, py::handle q0, py::handle q1);

/// A motion or trajectory as Python holds it. The library's functions take it as its base class.
template <class Base>
struct Made : Base {
  Made(Base base, Recipe how) : Base(std::move(base)), recipe(std::move(how)) {}
  Recipe recipe;
};
using MadeMotion = Made<JointMotion>;
using MadeTrajectory = Made<JointTrajectory>;

/// Whether the value is a joint motion or trajectory.
inline bool isMotion(py::handle value) {
  return py::isinstance<JointMotion>(value) || py::isinstance<JointTrajectory>(value);
}

/// The trajectory through waypoints.
/// @param times  None: 0, 1, ...: times are numbers of waypoints.
/// @param velocities, accelerations, blend None, or the values that make it cubic, quintic, or of parabolic blends.
JointTrajectory trajectoryThrough(const KinematicTree& tree, py::handle waypoints, py::handle times,
                                  py::handle velocities, py::handle accelerations, py::handle blend, bool unwrap);

void bindKinematics(py::module_& module);

}  // namespace fcl_artic::python
