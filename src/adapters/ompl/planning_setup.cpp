// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/ompl/planning_setup.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/SO3StateSpace.h>

#include "text/nearest_name.h"

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;

std::vector<std::string> variableNames(const KinematicTree& tree) {
  std::vector<std::string> names;
  for (int v = 0; v < tree.dof(); ++v) names.push_back(tree.variableName(v));
  return names;
}

int requireVariable(const KinematicTree& tree, const std::string& name, const std::string& what) {
  if (const int v = tree.findVariable(name); v >= 0) return v;
  throw std::invalid_argument(what + ": robot '" + tree.name() + "' has no joint '" + name +
                              "' with a value of its own (it is unknown, fixed or a mimic)" +
                              text::didYouMean(name, variableNames(tree)));
}

/// Queries take values up to this, rad or m (JointMotion::linear()): planners must not draw others.
bool answerable(double value) {
  return std::abs(value) <= 1e5;
}

/// Whether the joint has one value only: then it stands with the joints that are not planned for.
bool standsStill(const Joint& joint) {
  return hasLimits(joint) && joint.lower == joint.upper;
}

/// A joint that can be planned for.
const Joint& requireJoint(const KinematicTree& tree, const std::string& name) {
  if (const JointId j = tree.findJoint(name); j >= 0) {
    const Joint& joint = tree.joint(j);
    if (!joint.mimics && joint.type != JointType::fixed) return joint;
  }
  throw std::invalid_argument("setUpPlanning: robot '" + tree.name() + "' has no joint '" + name +
                              "' that can be planned for (it is unknown, fixed or a mimic)" +
                              text::didYouMean(name, variableNames(tree)));
}

/// The space of a joint whose value is not one number within limits.
ob::StateSpacePtr wholeJointSpace(const Joint& joint, const SetupOptions& options) {
  const auto bounds = [&](unsigned dimensions) {
    ob::RealVectorBounds b(dimensions);
    for (unsigned i = 0; i < dimensions; ++i) {
      b.low[i] = options.position_lower[i];
      b.high[i] = options.position_upper[i];
      if (b.low[i] < b.high[i] && answerable(b.low[i]) && answerable(b.high[i])) continue;
      throw std::invalid_argument("setUpPlanning: joint '" + joint.name +
                                  "' needs options.position_lower and position_upper");
    }
    return b;
  };
  if (joint.type == JointType::planar) {
    const auto space = std::make_shared<ob::SE2StateSpace>();
    space->setBounds(bounds(2));
    return space;
  }
  if (joint.type == JointType::floating) {
    const auto space = std::make_shared<ob::SE3StateSpace>();
    space->setBounds(bounds(3));
    return space;
  }
  if (joint.type == JointType::spherical) return std::make_shared<ob::SO3StateSpace>();
  return std::make_shared<ob::SO2StateSpace>();
}

/// A space for each run of joints of one kind.
ob::StateSpacePtr makeSpace(const KinematicTree& tree, const std::vector<std::string>& joints,
                            const SetupOptions& options) {
  if (joints.empty()) throw std::invalid_argument("setUpPlanning: robot '" + tree.name() + "' has no joint that moves");
  std::set<std::string> named;
  std::vector<ob::StateSpacePtr> parts;
  std::shared_ptr<ob::RealVectorStateSpace> reals;
  for (const std::string& name : joints) {
    const Joint& joint = requireJoint(tree, name);
    if (!named.insert(name).second) throw std::invalid_argument("setUpPlanning: joint '" + name + "' is named twice");
    if (standsStill(joint)) {
      throw std::invalid_argument("setUpPlanning: joint '" + name + "' has no room between its limits");
    }
    if (hasLimits(joint) && !(answerable(joint.lower) && answerable(joint.upper))) {
      throw std::invalid_argument("setUpPlanning: joint '" + name + "' has limits beyond 1e5");
    }
    if (hasLimits(joint)) {
      if (!reals) parts.push_back(reals = std::make_shared<ob::RealVectorStateSpace>());
      reals->addDimension(name, joint.lower, joint.upper);
      continue;
    }
    if (joint.type == JointType::prismatic) {
      throw std::invalid_argument("setUpPlanning: the prismatic joint '" + name + "' has no limits to plan within");
    }
    reals.reset();
    parts.push_back(wholeJointSpace(joint, options));
    parts.back()->setName(name);
  }
  if (parts.size() == 1) return parts.front();
  // The distance is the sum of the parts' then.
  return std::make_shared<ob::CompoundStateSpace>(parts, std::vector<double>(parts.size(), 1.0));
}

Eigen::VectorXd makeOthers(const KinematicTree& tree, const std::vector<std::string>& joints,
                           const std::map<std::string, double>& fixed) {
  Eigen::VectorXd others = tree.neutralConfiguration();
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    if (hasLimits(joint)) others[v] = std::clamp(0.0, joint.lower, joint.upper);
  }
  for (const auto& [name, value] : fixed) {
    const int variable = requireVariable(tree, name, "options.fixed");
    if (std::find(joints.begin(), joints.end(), tree.joint(tree.variableJoint(variable)).name) != joints.end()) {
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

/// Brings a quaternion to the length 1. OMPL takes it within 1e-9 only, and files have fewer digits. One that no query
/// would take (KinematicTree::requireConfiguration()) stays as it is.
void normalize(const ob::StateSpace& part, ob::State* state) {
  if (part.satisfiesBounds(state)) return;
  auto& q = *state->as<ob::SO3StateSpace::StateType>();
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(std::abs(length - 1) <= 1e-3)) return;
  for (double* c : {&q.x, &q.y, &q.z, &q.w}) *c /= length;
}

/// Robot, scene and manager as one: the manager holds pointers into both.
struct World {
  Robot robot;
  Scene scene;
  ArticulatedCollisionManager manager;
  World(Robot r, Scene s, const SetupOptions& options) : robot(std::move(r)), scene(std::move(s)), manager(robot.tree) {
    robot.addTo(manager);
    scene.addTo(manager);
    manager.setup();
    if (options.visibility) manager.setVisibility(options.visibility);
  }
};

}  // namespace

void PlanningSetup::setState(ob::State* state, const std::vector<double>& values) const {
  if (const std::size_t wanted = this->values(state).size(); values.size() != wanted) {
    throw std::invalid_argument("setState: " + std::to_string(values.size()) + " values for a state of " +
                                std::to_string(wanted));
  }
  std::size_t next = 0;
  forEachPart(*space, state, [&](const ob::StateSpace& part, ob::State* values_of_part) {
    for (unsigned i = 0; double* value = part.getValueAddressAtIndex(values_of_part, i); ++i) *value = values[next++];
    if (part.getType() == ob::STATE_SPACE_SO2) part.enforceBounds(values_of_part);  // the same angle in (-π, π]
    if (part.getType() == ob::STATE_SPACE_SO3) normalize(part, values_of_part);
  });
}

std::vector<double> PlanningSetup::values(const ob::State* state) const {
  std::vector<double> values;
  // OMPL gives only addresses that may be written to; this does not write.
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
    for (int v = 0; v < tree.dof(); v += tree.numVariables(tree.variableJoint(v))) {
      const Joint& joint = tree.joint(tree.variableJoint(v));
      if (!standsStill(joint)) setup.joints.push_back(joint.name);
    }
  }
  setup.space = makeSpace(tree, setup.joints, options);
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

// NOLINTNEXTLINE(performance-unnecessary-value-param): kept by what is returned
PlanningSetup setUpRigidBody(std::shared_ptr<fcl::CollisionGeometryd> body, const Scene& obstacles,
                             const SetupOptions& options, JointType freedom) {
  if (!body) throw std::invalid_argument("setUpRigidBody: the body is null");
  if (freedom != JointType::floating && freedom != JointType::planar) {
    throw std::invalid_argument("setUpRigidBody: the joint is neither floating nor planar");
  }
  const auto tree = std::make_shared<KinematicTree>("rigid body");
  tree->addLink("world");
  tree->addLink("body");
  Joint joint;
  joint.type = freedom;
  joint.name = "body";
  joint.parent = "world";
  joint.child = "body";
  joint.axis = Eigen::Vector3d::UnitZ();
  tree->addJoint(joint);
  Robot robot;
  robot.tree = tree;
  robot.geometry.push_back({tree->linkId("body"), Eigen::Isometry3d::Identity(),
                            std::make_shared<fcl::CollisionObjectd>(std::move(body)), "body"});
  Scene scene = combineScenes({obstacles}, *tree);
  std::vector<std::string> notes = scene.notes;
  const auto world = std::make_shared<const World>(std::move(robot), std::move(scene), options);
  SetupOptions own = options;
  own.fixed.clear();
  PlanningSetup setup =
      setUpPlanning(std::shared_ptr<const ArticulatedCollisionManager>(world, &world->manager), {"body"}, own);
  setup.notes = std::move(notes);
  return setup;
}

PlanningSetup setUpPlanning(const std::string& urdf, const std::string& srdf, const std::string& scene,
                            const std::string& group, const SetupOptions& options) {
  Robot robot = loadUrdf(urdf, options.urdf);
  robot.allowed = loadSrdf(srdf, *robot.tree, &robot.notes);
  const std::vector<std::string> joints = groupJoints(srdf, *robot.tree, group);
  std::vector<Scene> scenes;
  if (!scene.empty()) scenes.push_back(loadScene(scene, options.scene));
  Scene obstacles = combineScenes(scenes, *robot.tree);
  const auto world = std::make_shared<const World>(std::move(robot), std::move(obstacles), options);
  PlanningSetup setup =
      setUpPlanning(std::shared_ptr<const ArticulatedCollisionManager>(world, &world->manager), joints, options);
  for (const auto& notes : {world->robot.notes, world->scene.notes, unitNotes(world->robot, world->scene)}) {
    setup.notes.insert(setup.notes.end(), notes.begin(), notes.end());
  }
  return setup;
}

}  // namespace fcl_artic::planning
