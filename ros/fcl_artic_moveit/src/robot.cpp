// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/robot.h"

#include <cmath>
#include <deque>
#include <map>
#include <stdexcept>

#include <moveit/robot_model/planar_joint_model.hpp>
#include <moveit/robot_model/prismatic_joint_model.hpp>
#include <moveit/robot_model/revolute_joint_model.hpp>

namespace fcl_artic_moveit {
namespace {

using fcl_artic::Joint;
using fcl_artic::JointType;
using fcl_artic::KinematicTree;
using moveit::core::JointModel;

JointType typeOf(const JointModel& joint) {
  switch (joint.getType()) {
    case JointModel::REVOLUTE:
      return static_cast<const moveit::core::RevoluteJointModel&>(joint).isContinuous() ? JointType::continuous
                                                                                        : JointType::revolute;
    case JointModel::PRISMATIC:
      return JointType::prismatic;
    case JointModel::PLANAR:
      return JointType::planar;
    case JointModel::FLOATING:
      return JointType::floating;
    case JointModel::FIXED:
      return JointType::fixed;
    case JointModel::UNKNOWN:
      break;
  }
  throw std::invalid_argument("joint '" + joint.getName() + "' is of the type " + joint.getTypeName() +
                              ", which fcl_artic has no joint for");
}

Eigen::Vector3d axisOf(const JointModel& joint) {
  switch (joint.getType()) {
    case JointModel::REVOLUTE:
      return static_cast<const moveit::core::RevoluteJointModel&>(joint).getAxis();
    case JointModel::PRISMATIC:
      return static_cast<const moveit::core::PrismaticJointModel&>(joint).getAxis();
    default:
      return Eigen::Vector3d::UnitZ();  // PlanarJointModel::computeTransform(): x, y, about z
  }
}

/// A joint of the tree. Its child's frame is the joint's at 0, as MoveIt's: getJointOriginTransform() of the child is
/// the pose of the joint in the parent link's frame.
Joint jointOf(const JointModel& from, const std::string& parent, bool stands) {
  Joint joint;
  joint.name = from.getName();
  joint.type = typeOf(from);
  joint.parent = parent;
  joint.child = from.getChildLinkModel()->getName();
  joint.origin = from.getChildLinkModel()->getJointOriginTransform();
  joint.axis = axisOf(from);
  if (joint.type == JointType::revolute || joint.type == JointType::prismatic) {
    const moveit::core::VariableBounds& bounds = from.getVariableBounds().at(0);
    if (bounds.position_bounded_) {
      joint.lower = bounds.min_position_;
      joint.upper = bounds.max_position_;
    }
  }
  if (from.getMimic() && !stands && joint.type != JointType::fixed) {  // some URDFs have fixed joints that mimic
    joint.mimics = true;
    joint.mimic = {from.getMimic()->getName(), from.getMimicFactor(), from.getMimicOffset()};
  }
  return joint;
}

/// Adds the model's frame as the tree's root link, if it is no link of the model.
std::string addRoot(const moveit::core::RobotModel& model, KinematicTree& tree) {
  const std::string& frame = model.getModelFrame();
  std::string name = frame.empty() ? "model_frame" : frame;
  while (model.hasLinkModel(name)) name += '_';
  tree.addLink(name);
  return name;
}

/// Whether the root joint is one of the SRDF's, not the fixed one that MoveIt assumes where there is none.
bool hasVirtualJoint(const moveit::core::RobotModel& model) {
  return model.getModelFrame() != model.getRootLinkName() || model.getRootJoint()->getVariableCount() > 0;
}

}  // namespace

std::string mountName(const std::string& link) {
  return link + "/mount";
}

RobotTree toTree(const moveit::core::RobotModel& model, const std::set<std::string>& mounts,
                 const std::set<std::string>& standing) {
  RobotTree out;
  auto tree = std::make_shared<KinematicTree>(model.getName());
  std::string root;
  if (hasVirtualJoint(model)) root = addRoot(model, *tree);
  for (const moveit::core::LinkModel* link : model.getLinkModels()) tree->addLink(link->getName());
  // A joint that mimics another comes after it; all others keep the model's order.
  std::deque<Joint> followers;
  for (const JointModel* joint : model.getJointModels()) {
    if (joint == model.getRootJoint() && root.empty()) continue;
    Joint one = jointOf(*joint, joint->getParentLinkModel() ? joint->getParentLinkModel()->getName() : root,
                        standing.count(joint->getName()) != 0);
    if (one.mimics) {
      out.followers.push_back({one.name, joint->getFirstVariableIndex(), joint->getMimic()->getFirstVariableIndex(),
                               joint->getMimicFactor(), joint->getMimicOffset()});
      followers.push_back(std::move(one));
    } else {
      tree->addJoint(one);
    }
  }
  for (const Joint& joint : followers) tree->addJoint(joint);  // masters are no mimic joints: RobotModel resolves them
  for (const std::string& link : mounts) {
    const std::string name = mountName(link);
    tree->addLink(name);
    tree->addJoint(Joint::fixed(name, link, name));
  }
  const std::vector<std::string>& names = model.getVariableNames();
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < names.size(); ++i) index[names[i]] = i;
  for (int v = 0; v < tree->dof(); ++v) {
    const auto found = index.find(tree->variableName(v));
    if (found == index.end()) {
      throw std::invalid_argument("MoveIt's robot '" + model.getName() + "' has no variable '" + tree->variableName(v) +
                                  "'");
    }
    out.variables.push_back(found->second);
  }
  out.tree = std::move(tree);
  return out;
}

std::pair<const RobotTree::Follower*, double> RobotTree::farthestFollower(const moveit::core::RobotState& state) const {
  const double* values = state.getVariablePositions();
  std::pair<const Follower*, double> farthest{nullptr, 0};
  for (const Follower& follower : followers) {
    const double off =
        std::abs(values[follower.variable] - (follower.factor * values[follower.master] + follower.offset));
    if (!farthest.first || !(off <= farthest.second)) farthest = {&follower, off};  // NaN is the farthest
    if (std::isnan(off)) break;
  }
  return farthest;
}

Eigen::VectorXd RobotTree::configuration(const moveit::core::RobotState& state, double mimic_tolerance) const {
  const double* values = state.getVariablePositions();
  const auto [follower, off] = farthestFollower(state);
  if (follower && !(off <= mimic_tolerance)) {
    throw std::invalid_argument("joint '" + follower->name + "' is at " + std::to_string(values[follower->variable]) +
                                ", where the joint that it mimics has it at " +
                                std::to_string(follower->factor * values[follower->master] + follower->offset) +
                                "; RobotState::update() or enforceBounds() sets mimic joints, `mimic_tolerance` says " +
                                "how far one may be off");
  }
  Eigen::VectorXd q(static_cast<Eigen::Index>(variables.size()));
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const double value = values[variables[v]];
    if (!std::isfinite(value)) {
      throw std::invalid_argument("joint variable '" + tree->variableName(static_cast<int>(v)) + "' is " +
                                  std::to_string(value));
    }
    q[static_cast<Eigen::Index>(v)] = value;
  }
  return q;
}

}  // namespace fcl_artic_moveit
