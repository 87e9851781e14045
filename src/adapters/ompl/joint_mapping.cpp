// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <set>
#include <stdexcept>
#include <typeinfo>

#include <boost/math/constants/constants.hpp>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/SO3StateSpace.h>

#include "fcl_artic/ompl/motion_validator.h"

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;

/// SO2StateSpace::interpolate(): from + d t, d = to - from brought into [-π, π] by one turn of this length.
double shorterWay(double d) {
  constexpr double kPi = boost::math::constants::pi<double>();
  return d > kPi ? d - 2 * kPi : d < -kPi ? d + 2 * kPi : d;
}

/// The way over π is that of the joint only when a whole turn leaves every pose as it is.
void requireWholeTurns(const KinematicTree& tree, int variable, const std::string& where) {
  const JointId master = tree.variableJoint(variable);
  if (tree.joint(master).type == JointType::prismatic) {
    throw std::invalid_argument(where + ": an SO2StateSpace cannot drive the prismatic joint '" +
                                tree.joint(master).name + "'");
  }
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    if (!joint.mimics || tree.jointVariable(j) != variable) continue;
    const double m = joint.mimic.multiplier;
    if (m == 0 || (joint.type != JointType::prismatic && m == std::round(m))) continue;
    throw std::invalid_argument(where + ": an SO2StateSpace cannot drive joint '" + tree.joint(master).name +
                                "', since joint '" + joint.name + "' mimics it and is elsewhere after a whole turn");
  }
}

}  // namespace

JointMapping::JointMapping(const ob::StateSpace& space, std::shared_ptr<const KinematicTree> tree,
                           const std::vector<std::string>& joints, const Eigen::VectorXd& others)
    : tree_(std::move(tree)) {
  if (!tree_) throw std::invalid_argument("JointMapping: the kinematic tree is null");
  const std::string where = "state space '" + space.getName() + "'";
  std::vector<unsigned> path;
  collect(space, where, path);

  std::vector<std::string> names = joints;
  if (names.empty()) {
    for (int v = 0; v < tree_->dof(); ++v) names.push_back(tree_->variableName(v));
  }
  if (names.size() != values_.size()) {
    throw std::invalid_argument(where + " has " + std::to_string(values_.size()) + " values for " +
                                std::to_string(names.size()) + " joints of robot '" + tree_->name() + "'");
  }
  std::set<int> driven;
  for (std::size_t i = 0; i < names.size(); ++i) {
    int variable = -1;
    for (int v = 0; v < tree_->dof() && variable < 0; ++v) {
      if (tree_->variableName(v) == names[i]) variable = v;
    }
    if (variable < 0) {
      throw std::invalid_argument(where + ": robot '" + tree_->name() + "' has no joint '" + names[i] +
                                  "' that can be planned for (it is unknown, fixed or a mimic)");
    }
    if (!driven.insert(variable).second) {
      throw std::invalid_argument(where + ": joint '" + names[i] + "' is named twice");
    }
    if (values_[i].turns) requireWholeTurns(*tree_, variable, where);
    values_[i].variable = variable;
  }
  others_ = others.size() == 0 ? Eigen::VectorXd::Zero(tree_->dof()).eval() : others;
  tree_->requireConfiguration(others_, "others");
}

void JointMapping::collect(const ob::StateSpace& space, const std::string& whole, std::vector<unsigned>& path) {
  const std::string where = "part '" + space.getName() + "' of " + whole;
  // Exactly these classes: a derived one may interpolate another way (DubinsStateSpace is an SE2StateSpace).
  const std::type_info& type = typeid(space);
  if (type == typeid(ob::RealVectorStateSpace)) {
    for (unsigned i = 0; i < space.getDimension(); ++i) values_.push_back({path, i, false, -1});
  } else if (type == typeid(ob::SO2StateSpace)) {
    values_.push_back({path, 0, true, -1});
  } else if (type == typeid(ob::CompoundStateSpace)) {
    const auto& compound = static_cast<const ob::CompoundStateSpace&>(space);
    for (unsigned i = 0; i < compound.getSubspaceCount(); ++i) {
      path.push_back(i);
      collect(*compound.getSubspace(i), whole, path);
      path.pop_back();
    }
  } else if (type == typeid(ob::SE2StateSpace) || type == typeid(ob::SE3StateSpace) || type == typeid(ob::SO3StateSpace)) {
    const char* kind = type == typeid(ob::SE2StateSpace)   ? "SE2StateSpace, which needs a planar joint"
                       : type == typeid(ob::SE3StateSpace) ? "SE3StateSpace, which needs a floating joint"
                                                           : "SO3StateSpace, which needs a spherical joint";
    throw std::invalid_argument(where + " is an " + kind + ": such joints are not supported");
  } else {
    throw std::invalid_argument(where + " is not supported: the way that its interpolate() takes is not known here; "
                                "RealVectorStateSpace, SO2StateSpace and CompoundStateSpaces of them are supported");
  }
}

double JointMapping::read(const Value& value, const ob::State* state) {
  for (const unsigned part : value.path) state = state->as<ob::CompoundState>()->components[part];
  return value.turns ? state->as<ob::SO2StateSpace::StateType>()->value
                     : state->as<ob::RealVectorStateSpace::StateType>()->values[value.index];
}

void JointMapping::configuration(const ob::State* state, Eigen::VectorXd& q) const {
  q = others_;
  for (const Value& value : values_) q[value.variable] = read(value, state);
}

JointMotion JointMapping::motion(const ob::State* s1, const ob::State* s2) const {
  thread_local Eigen::VectorXd q0, q1;
  q0 = others_;
  q1 = others_;
  for (const Value& value : values_) {
    const double from = read(value, s1), to = read(value, s2);
    q0[value.variable] = from;
    q1[value.variable] = value.turns ? from + shorterWay(to - from) : to;
  }
  return JointMotion::linear(*tree_, q0, q1);
}

}  // namespace fcl_artic::planning
