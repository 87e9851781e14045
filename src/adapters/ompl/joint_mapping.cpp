// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <set>
#include <stdexcept>
#include <typeinfo>

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/SO3StateSpace.h>
#include <boost/math/constants/constants.hpp>

#include "fcl_artic/ompl/motion_validator.h"

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;

constexpr double kNearHalfTurn = 1e-9;  ///< far beyond the roundings of a product of unit quaternions

/// SO2StateSpace::interpolate(): from + d t, d = to - from brought into [-π, π] by one turn of this length.
double shorterWay(double d) {
  constexpr double kPi = boost::math::constants::pi<double>();
  return d > kPi ? d - 2 * kPi : d < -kPi ? d + 2 * kPi : d;
}

/// The shorter way over π is the joint's way only if a whole turn leaves every pose as it is, and no limit lies on that
/// way. Otherwise a drive goes from 2.8 to -2.8 through 0.
void requireWholeTurns(const KinematicTree& tree, int variable, const std::string& where) {
  const std::string& name = tree.variableName(variable);
  if (!tree.isAngle(variable)) {
    const bool prismatic = tree.joint(tree.variableJoint(variable)).type == JointType::prismatic;
    throw std::invalid_argument(where + ": an SO2StateSpace cannot drive " +
                                (prismatic ? "the prismatic joint '" : "what is no angle, '") + name + "'");
  }
  if (const Joint& joint = tree.joint(tree.variableJoint(variable)); hasLimits(joint)) {
    throw std::invalid_argument(where + ": an SO2StateSpace cannot drive joint '" + name + "', which has the limits [" +
                                std::to_string(joint.lower) + ", " + std::to_string(joint.upper) +
                                "] and does not turn forever: a RealVectorStateSpace within them can");
  }
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    if (!joint.mimics || tree.jointVariable(j) != variable) continue;
    const double m = joint.mimic.multiplier;
    if (m == 0 || (joint.type != JointType::prismatic && m == std::round(m))) continue;
    throw std::invalid_argument(where + ": an SO2StateSpace cannot drive joint '" + name + "', since joint '" +
                                joint.name + "' mimics it and is elsewhere after a whole turn");
  }
}

/// w(1) of the turn from q0 to q1 at nearly half a turn, where either way round is the shortest but for rounding: the
/// one that SO3StateSpace::interpolate() takes. That function is called here: a sum of our own could have another sign,
/// if OMPL's compiler fuses operations that ours does not.
Eigen::Vector3d halfTurn(const Eigen::Vector4d& q0, const Eigen::Vector4d& q1) {
  const auto stateOf = [](const Eigen::Vector4d& q, ob::SO3StateSpace::StateType& state) {
    state.x = q[0], state.y = q[1], state.z = q[2], state.w = q[3];
  };
  ob::SO3StateSpace::StateType begin, end, between;
  stateOf(q0, begin);
  stateOf(q1, end);
  ob::SO3StateSpace().interpolate(&begin, &end, 0.25, &between);
  const bool to_negative = Eigen::Vector4d(between.x, between.y, between.z, between.w).dot(q1) < 0;
  const Eigen::Quaterniond from(q0), to(Eigen::Vector4d(to_negative ? Eigen::Vector4d(-q1) : q1));
  const Eigen::Quaterniond turn = to.normalized() * from.normalized().conjugate();
  return 2 * std::atan2(turn.vec().norm(), turn.w()) * turn.vec().normalized();
}

}  // namespace

JointMapping::JointMapping(const ob::StateSpace& space, std::shared_ptr<const KinematicTree> tree,
                           const std::vector<std::string>& joints, const Eigen::VectorXd& others)
    : tree_(std::move(tree)) {
  if (!tree_) throw std::invalid_argument("JointMapping: the kinematic tree is null");
  const std::string where = "state space '" + space.getName() + "'";
  std::vector<Part> parts;
  std::vector<unsigned> path;
  collect(space, where, path, parts);

  // Without names the parts take the tree's variables in order, whole joints if they need them.
  std::vector<std::string> names = joints;
  if (joints.empty()) {
    int next = 0;
    for (const Part& part : parts) {
      if (next >= tree_->dof()) break;
      const JointId joint = tree_->variableJoint(next);
      const bool whole = part.joint != JointType::fixed;
      if (whole) requireJoint(tree_->joint(joint).name, part);
      names.push_back(whole ? tree_->joint(joint).name : tree_->variableName(next));
      next += whole ? tree_->numVariables(joint) : 1;
    }
    while (next < tree_->dof()) names.push_back(tree_->variableName(next++));  // too many: refused below
  }
  if (names.size() != parts.size()) {
    throw std::invalid_argument(where + " has " + std::to_string(parts.size()) + " values for " +
                                std::to_string(names.size()) + " joints of robot '" + tree_->name() + "'");
  }
  std::set<int> driven;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int first =
        parts[i].joint == JointType::fixed ? requireVariable(names[i], where) : requireJoint(names[i], parts[i]);
    for (Value value : parts[i].values) {
      value.variable += first;
      if (!driven.insert(value.variable).second) {
        throw std::invalid_argument(where + ": joint '" + names[i] + "' is named twice");
      }
      if (value.turns) requireWholeTurns(*tree_, value.variable, where);
      values_.push_back(value);
    }
    if (parts[i].joint == JointType::spherical) quaternions_.push_back(first);
    if (parts[i].joint == JointType::floating) quaternions_.push_back(first + 3);
  }
  others_ = others.size() == 0 ? tree_->neutralConfiguration() : others;
  tree_->requireConfiguration(others_, "others");
}

/// The number of a variable that a single number may drive: no part of a quaternion, as these don't go straight.
int JointMapping::requireVariable(const std::string& name, const std::string& where) const {
  if (const int v = tree_->findVariable(name); v >= 0) {
    const JointId joint = tree_->variableJoint(v);
    const int quaternion = tree_->quaternionVariable(joint);
    if (quaternion < 0 || v < quaternion) return v;
    throw std::invalid_argument(where + ": '" + name +
                                "' is part of a quaternion, which takes an SO3 or SE3StateSpace for all of "
                                "joint '" +
                                tree_->joint(joint).name + "'");
  }
  throw std::invalid_argument(where + ": robot '" + tree_->name() + "' has no joint '" + name +
                              "' that can be planned for (it is unknown, fixed or a mimic)");
}

int JointMapping::requireJoint(const std::string& name, const Part& part) const {
  const JointId j = tree_->findJoint(name);
  if (j >= 0 && tree_->joint(j).type == part.joint) return tree_->jointVariable(j);
  throw std::invalid_argument(part.what + ": '" + name + "' of robot '" + tree_->name() + "' is none");
}

void JointMapping::collect(const ob::StateSpace& space, const std::string& whole, std::vector<unsigned>& path,
                           std::vector<Part>& parts) {
  const std::string where = "part '" + space.getName() + "' of " + whole;
  const auto below = [&](unsigned i) {
    std::vector<unsigned> deeper = path;
    deeper.push_back(i);
    return deeper;
  };
  // Exactly these classes: a derived one may interpolate another way (DubinsStateSpace is an SE2StateSpace).
  const std::type_info& type = typeid(space);
  if (type == typeid(ob::RealVectorStateSpace)) {
    for (unsigned i = 0; i < space.getDimension(); ++i)
      parts.push_back({JointType::fixed, "", {{path, i, Kind::real, false, 0}}});
  } else if (type == typeid(ob::SO2StateSpace)) {
    parts.push_back({JointType::fixed, "", {{path, 0, Kind::angle, true, 0}}});
  } else if (type == typeid(ob::SE2StateSpace)) {
    parts.push_back({JointType::planar,
                     where + " is an SE2StateSpace, which needs a planar joint",
                     {{below(0), 0, Kind::real, false, 0},
                      {below(0), 1, Kind::real, false, 1},
                      {below(1), 0, Kind::angle, true, 2}}});
  } else if (type == typeid(ob::SO3StateSpace) || type == typeid(ob::SE3StateSpace)) {
    const bool floating = type == typeid(ob::SE3StateSpace);
    Part part{JointType::spherical, where + " is an SO3StateSpace, which needs a spherical joint", {}};
    if (floating) {
      part = {JointType::floating, where + " is an SE3StateSpace, which needs a floating joint", {}};
      for (unsigned i = 0; i < 3; ++i) part.values.push_back({below(0), i, Kind::real, false, static_cast<int>(i)});
    }
    for (unsigned i = 0; i < 4; ++i) {
      part.values.push_back(
          {floating ? below(1) : path, i, Kind::quaternion, false, static_cast<int>(floating ? 3 + i : i)});
    }
    parts.push_back(part);
  } else if (type == typeid(ob::CompoundStateSpace)) {
    const auto& compound = static_cast<const ob::CompoundStateSpace&>(space);
    for (unsigned i = 0; i < compound.getSubspaceCount(); ++i) {
      path.push_back(i);
      collect(*compound.getSubspace(i), whole, path, parts);
      path.pop_back();
    }
  } else {
    throw std::invalid_argument(
        where +
        " is not supported: the way that its interpolate() takes is not known here; RealVector, "
        "SO2, SE2, SO3 and SE3StateSpace and CompoundStateSpaces of them are supported");
  }
}

double JointMapping::read(const Value& value, const ob::State* state) {
  for (const unsigned part : value.path) state = state->as<ob::CompoundState>()->components[part];
  switch (value.kind) {
    case Kind::real:
      return state->as<ob::RealVectorStateSpace::StateType>()->values[value.index];
    case Kind::angle:
      return state->as<ob::SO2StateSpace::StateType>()->value;
    default:
      break;
  }
  const auto& q = *state->as<ob::SO3StateSpace::StateType>();
  const double* const parts[] = {&q.x, &q.y, &q.z, &q.w};
  return *parts[value.index];
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
  for (const int v : quaternions_) {
    const double dot = q0[v] * q1[v] + q0[v + 1] * q1[v + 1] + q0[v + 2] * q1[v + 2] + q0[v + 3] * q1[v + 3];
    if (std::abs(dot) < kNearHalfTurn) return atHalfTurn(q0, q1);
  }
  return JointMotion::linear(*tree_, q0, q1);
}

/// As JointMotion::linear(), with the sense of rotation by OMPL's rule.
JointMotion JointMapping::atHalfTurn(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const {
  Eigen::MatrixXd coefficients = JointMotion::linear(*tree_, q0, q1).coefficients();
  for (const int v : quaternions_) {
    const double dot = q0[v] * q1[v] + q0[v + 1] * q1[v + 1] + q0[v + 2] * q1[v + 2] + q0[v + 3] * q1[v + 3];
    if (std::abs(dot) >= kNearHalfTurn) continue;
    coefficients.block<3, 1>(v, 1) = halfTurn(q0.segment<4>(v), q1.segment<4>(v));
  }
  return JointMotion::polynomial(*tree_, coefficients);
}

}  // namespace fcl_artic::planning
