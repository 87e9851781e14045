// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/ompl/planning_setup.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;

bool limited(const Joint& joint) {
  return joint.type != JointType::continuous && joint.lower <= joint.upper && !(joint.lower == 0 && joint.upper == 0);
}

int requireVariable(const KinematicTree& tree, const std::string& name, const std::string& what) {
  for (int v = 0; v < tree.dof(); ++v) {
    if (tree.variableName(v) == name) return v;
  }
  throw std::invalid_argument(what + ": robot '" + tree.name() + "' has no joint '" + name +
                              "' with a value of its own (it is unknown, fixed or a mimic)");
}

/// A space for each run of joints of one kind.
ob::StateSpacePtr makeSpace(const KinematicTree& tree, const std::vector<std::string>& joints) {
  if (joints.empty()) throw std::invalid_argument("setUpPlanning: robot '" + tree.name() + "' has no joint that moves");
  std::set<std::string> named;
  std::vector<ob::StateSpacePtr> parts;
  std::shared_ptr<ob::RealVectorStateSpace> reals;
  for (const std::string& name : joints) {
    const Joint& joint = tree.joint(tree.variableJoint(requireVariable(tree, name, "setUpPlanning")));
    if (!named.insert(name).second) throw std::invalid_argument("setUpPlanning: joint '" + name + "' is named twice");
    if (limited(joint)) {
      if (!reals) parts.push_back(reals = std::make_shared<ob::RealVectorStateSpace>());
      reals->addDimension(name, joint.lower, joint.upper);
      continue;
    }
    if (joint.type == JointType::prismatic) {
      throw std::invalid_argument("the prismatic joint '" + name + "' has no limits to plan within");
    }
    reals.reset();
    parts.push_back(std::make_shared<ob::SO2StateSpace>());
    parts.back()->setName(name);
  }
  if (parts.size() == 1) return parts.front();
  // The distance is the sum of the parts' then.
  return std::make_shared<ob::CompoundStateSpace>(parts, std::vector<double>(parts.size(), 1.0));
}

Eigen::VectorXd makeOthers(const KinematicTree& tree, const std::vector<std::string>& joints,
                           const std::map<std::string, double>& fixed) {
  Eigen::VectorXd others(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    others[v] = limited(joint) ? std::clamp(0.0, joint.lower, joint.upper) : 0;
  }
  for (const auto& [name, value] : fixed) {
    const int variable = requireVariable(tree, name, "options.fixed");
    if (std::find(joints.begin(), joints.end(), name) != joints.end()) {
      throw std::invalid_argument("options.fixed: joint '" + name + "' is to be planned for");
    }
    others[variable] = value;
  }
  tree.requireConfiguration(others, "options.fixed");
  return others;
}

/// Applies f to every part of a state that is no compound, in order.
template <typename F>
void forEachPart(const ob::StateSpace& space, ob::State* state, F&& f) {
  if (!space.isCompound()) return f(space, state);
  const auto& compound = *space.as<ob::CompoundStateSpace>();
  for (unsigned i = 0; i < compound.getSubspaceCount(); ++i) {
    forEachPart(*compound.getSubspace(i), state->as<ob::CompoundState>()->components[i], f);
  }
}

/// Robot, scene and manager as one: the manager holds pointers into both.
struct World {
  Robot robot;
  Scene scene;
  ArticulatedCollisionManager manager;
  World(Robot r, Scene s) : robot(std::move(r)), scene(std::move(s)), manager(robot.tree) {
    robot.addTo(manager);
    scene.addTo(manager);
    manager.setup();
  }
};

}  // namespace

void PlanningSetup::setState(ob::State* state, const std::vector<double>& values) const {
  if (values.size() != joints.size()) {
    throw std::invalid_argument("setState: " + std::to_string(values.size()) + " values for " +
                                std::to_string(joints.size()) + " joints");
  }
  std::size_t next = 0;
  forEachPart(*space, state, [&](const ob::StateSpace& part, ob::State* values_of_part) {
    for (unsigned i = 0; double* value = part.getValueAddressAtIndex(values_of_part, i); ++i) *value = values[next++];
    if (part.getType() == ob::STATE_SPACE_SO2) part.enforceBounds(values_of_part);  // the same angle in (-π, π]
  });
}

std::vector<double> PlanningSetup::values(const ob::State* state) const {
  std::vector<double> values;
  // OMPL gives addresses of a state that may be written to; it is not.
  forEachPart(*space, const_cast<ob::State*>(state), [&](const ob::StateSpace& part, ob::State* values_of_part) {
    for (unsigned i = 0; const double* value = part.getValueAddressAtIndex(values_of_part, i); ++i) {
      values.push_back(*value);
    }
  });
  return values;
}

PlanningSetup setUpPlanning(std::shared_ptr<const ArticulatedCollisionManager> manager,
                            const std::vector<std::string>& joints, const SetupOptions& options) {
  if (!manager) throw std::invalid_argument("setUpPlanning: the manager is null");
  const KinematicTree& tree = manager->tree();
  PlanningSetup setup;
  setup.manager = std::move(manager);
  setup.joints = joints;
  if (joints.empty()) {
    for (int v = 0; v < tree.dof(); ++v) setup.joints.push_back(tree.variableName(v));
  }
  setup.space = makeSpace(tree, setup.joints);
  const Eigen::VectorXd others = makeOthers(tree, setup.joints, options.fixed);
  const JointMapping mapping(*setup.space, setup.manager->sharedTree(), setup.joints, others);
  setup.si = std::make_shared<ob::SpaceInformation>(setup.space);
  setup.si->setStateValidityChecker(
      std::make_shared<CollisionStateValidityChecker>(setup.si, setup.manager, mapping, options.request));
  setup.si->setMotionValidator(
      std::make_shared<ContinuousMotionValidator>(setup.si, setup.manager, mapping, options.request));
  setup.si->setup();
  return setup;
}

PlanningSetup setUpPlanning(const std::string& urdf, const std::string& srdf, const std::string& scene,
                            const std::string& group, const SetupOptions& options) {
  Robot robot = loadUrdf(urdf, options.urdf);
  robot.allowed = loadSrdf(srdf, *robot.tree);
  const std::vector<std::string> joints = groupJoints(srdf, *robot.tree, group);
  const auto world = std::make_shared<const World>(std::move(robot), scene.empty() ? Scene() : loadScene(scene));
  PlanningSetup setup =
      setUpPlanning(std::shared_ptr<const ArticulatedCollisionManager>(world, &world->manager), joints, options);
  for (const auto* notes : {&world->robot.notes, &world->scene.notes}) {
    setup.notes.insert(setup.notes.end(), notes->begin(), notes->end());
  }
  return setup;
}

}  // namespace fcl_artic::planning
