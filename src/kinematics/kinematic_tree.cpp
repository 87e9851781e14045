// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/kinematic_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "kinematics/joint_factors.h"
#include "numerics/constants.h"
#include "numerics/rotation.h"
#include "numerics/shown.h"
#include "text/counted.h"
#include "text/nearest_name.h"

namespace fcl_artic {
namespace {

/// How far from 1 the length of a quaternion may be: enough for numbers typed or printed with three digits.
constexpr double kQuaternionLength = 1e-3;

std::vector<const char*> variableEndings(JointType type) {
  switch (type) {
    case JointType::fixed:
      return {};
    case JointType::planar:
      return {"/x", "/y", "/theta"};
    case JointType::spherical:
      return {"/rot_x", "/rot_y", "/rot_z", "/rot_w"};
    case JointType::floating:
      return {"/trans_x", "/trans_y", "/trans_z", "/rot_x", "/rot_y", "/rot_z", "/rot_w"};
    default:
      return {""};
  }
}

/// @return -1: there is none.
int idOf(const std::map<std::string, int, std::less<>>& ids, std::string_view name) {
  const auto it = ids.find(name);
  return it == ids.end() ? -1 : it->second;
}

}  // namespace

void Fingerprint::add(std::uint64_t number) {
  // Each step is a bijection of the number, and of the hash before it: no single change goes unseen.
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15u;  // 2^64 / golden ratio
  std::uint64_t x = (value_ ^ number) + kOdd;
  x = (x ^ (x >> 32)) * 0xD6E8FEB86659FD93u;  // R. Muegge's mixing step: an odd factor between two shifts
  x = (x ^ (x >> 32)) * 0xD6E8FEB86659FD93u;
  x ^= x >> 32;
  value_ = x == 0 ? kOdd : x;
}

void Fingerprint::add(double number) {
  std::uint64_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  add(bits);
}

void Fingerprint::add(std::string_view text) {
  add(std::uint64_t{text.size()});
  for (std::size_t i = 0; i < text.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, text.data() + i, std::min(sizeof word, text.size() - i));
    add(word);
  }
}

KinematicTree::KinematicTree(std::string name) : name_(std::move(name)) {
  joint_space_.add(std::uint64_t{0});
  content_.add(std::uint64_t{0});
}

bool hasLimits(const Joint& joint) {
  const bool could = KinematicTree::numVariables(joint.type) == 1 && joint.type != JointType::continuous;
  const bool some = joint.lower <= joint.upper && !(joint.lower == 0 && joint.upper == 0);
  return could && some && std::isfinite(joint.lower) && std::isfinite(joint.upper);
}

int KinematicTree::numVariables(JointType type) {
  switch (type) {
    case JointType::fixed:
      return 0;
    case JointType::planar:
      return 3;
    case JointType::spherical:
      return 4;
    case JointType::floating:
      return 7;
    default:
      return 1;
  }
}

LinkId KinematicTree::addLink(const std::string& name) {
  if (name.empty()) throw std::invalid_argument("robot '" + name_ + "': a link has no name");
  const LinkId id = numLinks();
  if (!index_.links.emplace(name, id).second) {
    throw std::invalid_argument("robot '" + name_ + "': two links are named '" + name + "'");
  }
  order_.insert(order_.begin() + (id - numJoints()), id);  // the last of the roots: each joint carries one other link
  link_names_.push_back(name);
  parent_joint_.push_back(-1);
  index_.above.push_back(id);
  content_.add(name);
  return id;
}

JointId KinematicTree::addJoint(const Joint& joint) {
  const JointId id = append(joint);
  sortLinks();
  return id;
}

void KinematicTree::addJoints(const std::vector<Joint>& joints) {
  KinematicTree grown = *this;
  for (const Joint& joint : joints) grown.append(joint);
  grown.sortLinks();
  *this = std::move(grown);
}

/// Adds a joint, and leaves the order of the links as it is.
JointId KinematicTree::append(const Joint& joint) {
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument("robot '" + name_ + "': joint '" + joint.name + "' " + reason);
  };
  if (joint.name.empty()) refuse("has no name");
  if (findJoint(joint.name) >= 0) refuse("exists already");
  const int parent = idOf(index_.links, joint.parent), child = idOf(index_.links, joint.child);
  if (parent < 0) refuse("has an unknown parent link '" + joint.parent + "'");
  if (child < 0) refuse("has an unknown child link '" + joint.child + "'");
  if (const JointId other = parentJoint(child); other >= 0) {
    refuse("would be a second parent of link '" + joint.child + "', which joint '" + joints_[other].name +
           "' carries already");
  }
  if (rootAbove(parent) == child) refuse("closes a loop at link '" + joint.child + "'");
  const std::optional<Rotation> turn = Rotation::within12Ulps(joint.origin.linear(), kOriginDefect);
  if (!joint.origin.translation().allFinite() || !turn) refuse("has an origin that is no rigid transform");
  if (joint.origin.translation().cwiseAbs().maxCoeff() > kFarthest) refuse("has an origin more than 1e9 m away");
  const bool moves = joint.type != JointType::fixed;
  const bool has_axis = moves && joint.type != JointType::spherical && joint.type != JointType::floating;
  const std::optional<UnitVector> axis = UnitVector::within3Ulps(joint.axis);
  if (has_axis && !axis) refuse("has an axis that is zero or not finite");
  if (std::isnan(joint.lower) || std::isnan(joint.upper)) refuse("has a limit that is not a number");

  int variable = moves ? dof() : -1;
  Mimic followed = joint.mimic;
  if (joint.mimics) {
    if (!moves) refuse("is fixed and cannot mimic");
    if (numVariables(joint.type) > 1) refuse("has more than one variable and cannot mimic");
    if (!std::isfinite(joint.mimic.multiplier) || !std::isfinite(joint.mimic.offset)) {
      refuse("mimics with a multiplier or offset that is not finite");
    }
    const JointId master = findJoint(joint.mimic.master);
    if (master < 0) refuse("mimics an unknown joint '" + joint.mimic.master + "'");
    variable = joint_variable_[master];
    if (variable < 0) refuse("mimics joint '" + joint.mimic.master + "', which is fixed");
    if (numVariables(master) > 1) refuse("mimics joint '" + joint.mimic.master + "', which has more than one variable");
    if (joints_[master].mimics) {  // its own mimic already names the joint at the end of the chain
      const Mimic& next = joints_[master].mimic;
      followed = {next.master, joint.mimic.multiplier * next.multiplier,
                  joint.mimic.multiplier * next.offset + joint.mimic.offset};
      if (!std::isfinite(followed.multiplier) || !std::isfinite(followed.offset)) {
        refuse("mimics joint '" + next.master + "' through '" + joint.mimic.master +
               "' with a multiplier or offset that is not finite");
      }
    }
  }

  if (!joint.mimics) {
    for (const char* ending : variableEndings(joint.type)) {
      const std::string name = joint.name + ending;
      const int other = findVariable(name);
      if (other < 0) continue;
      refuse("would have the variable '" + name + "', which joint '" + joints_[variables_[other]].name +
             "' has already; call it otherwise");
    }
  }

  const JointId id = numJoints();
  joints_.push_back(joint);
  joints_.back().mimic = followed;
  joints_.back().origin = RigidTransform(*turn, joint.origin.translation());
  if (has_axis) joints_.back().axis = *axis;
  turns_.emplace_back(joints_.back());
  joint_parent_.push_back(parent);
  joint_variable_.push_back(variable);
  if (quaternionVariable(id) >= 0) with_quaternions_.push_back(id);
  if (joint.mimics) {
    mimics_.push_back(id);
  } else {
    variables_.insert(variables_.end(), static_cast<std::size_t>(numVariables(joint.type)), id);
    for (const char* ending : variableEndings(joint.type)) {
      index_.variables.emplace(joint.name + ending, static_cast<int>(variable_names_.size()));
      variable_names_.push_back(joint.name + ending);
    }
  }
  index_.joints.emplace(joint.name, id);
  parent_joint_[child] = id;
  index_.above[child] = parent;
  addToFingerprints(joints_.back());
  return id;
}

void KinematicTree::addToFingerprints(const Joint& joint) {
  const auto addJointTo = [&](Fingerprint& print) {
    print.add(joint.name);
    print.add(static_cast<std::uint64_t>(joint.type));
    print.add(std::uint64_t{joint.mimics});
    if (!joint.mimics) return;
    print.add(joint.mimic.master);
    print.add(joint.mimic.multiplier);
    print.add(joint.mimic.offset);
  };
  if (joint.type != JointType::fixed) addJointTo(joint_space_);
  addJointTo(content_);
  content_.add(joint.parent);
  content_.add(joint.child);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 4; ++k) content_.add(joint.origin(i, k));
    content_.add(joint.axis[i]);
  }
  content_.add(joint.lower);
  content_.add(joint.upper);
}

KinematicTree::Turn::Turn(const Joint& joint) {
  const Eigen::Matrix3d R = joint.origin.linear();
  const Eigen::Vector3d a = joint.axis;
  along = R * a * a.transpose();
  across = R - along;
  for (int k = 0; k < 3; ++k) aside.col(k) = R * a.cross(Eigen::Vector3d::Unit(k));
}

bool KinematicTree::isAngle(int v) const {
  const JointId j = variableJoint(v);
  switch (joints_[j].type) {
    case JointType::revolute:
    case JointType::continuous:
      return true;
    case JointType::planar:
      return v == joint_variable_[j] + 2;
    default:
      return false;
  }
}

int KinematicTree::quaternionVariable(JointId j) const {
  const JointType type = joint(j).type;
  return type == JointType::spherical ? jointVariable(j) : type == JointType::floating ? jointVariable(j) + 3 : -1;
}

Eigen::VectorXd KinematicTree::neutralConfiguration() const {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(dof());
  for (const JointId j : with_quaternions_) q[quaternionVariable(j) + 3] = 1;
  return q;
}

LinkId KinematicTree::parentLink(LinkId link) const {
  const JointId joint = parentJoint(link);
  return joint < 0 ? -1 : joint_parent_[joint];
}

/// Returns the root of the link's tree. Each call makes the way up half as long, so that joints in any order are added
/// in n log n steps in all.
LinkId KinematicTree::rootAbove(LinkId link) {
  while (index_.above[link] != link) link = index_.above[link] = index_.above[index_.above[link]];
  return link;
}

/// Sorts links breadth first, from the roots on; roots, and the children of a link, by number.
void KinematicTree::sortLinks() {
  const std::size_t roots = link_names_.size();
  std::vector<LinkId> first(roots + 1, -1), next(roots, -1);  // of each link's children, and among its parent's
  for (std::size_t link = roots; link-- > 0;) {
    const JointId joint = parent_joint_[link];
    LinkId& list = first[joint < 0 ? roots : static_cast<std::size_t>(joint_parent_[joint])];
    next[link] = std::exchange(list, static_cast<LinkId>(link));
  }
  std::size_t end = 0;
  for (std::size_t i = 0; i <= end && end < roots; ++i) {
    const std::size_t parent = i == 0 ? roots : static_cast<std::size_t>(order_[i - 1]);
    for (LinkId link = first[parent]; link >= 0; link = next[link]) order_[end++] = link;
  }
}

LinkId KinematicTree::linkId(std::string_view name) const {
  const LinkId id = idOf(index_.links, name);
  if (id < 0) {
    throw std::out_of_range("robot '" + name_ + "' has no link '" + std::string(name) + "'" +
                            text::didYouMean(name, link_names_));
  }
  return id;
}

JointId KinematicTree::jointId(std::string_view name) const {
  if (const JointId id = findJoint(name); id >= 0) return id;
  std::vector<std::string> names;
  for (const Joint& joint : joints_) names.push_back(joint.name);
  throw std::out_of_range("robot '" + name_ + "' has no joint '" + std::string(name) + "'" +
                          text::didYouMean(name, names));
}

JointId KinematicTree::findJoint(std::string_view name) const {
  return idOf(index_.joints, name);
}

int KinematicTree::findVariable(std::string_view name) const {
  return idOf(index_.variables, name);
}

double KinematicTree::jointValue(JointId j, const Eigen::Ref<const Eigen::VectorXd>& q) const {
  const int variable = jointVariable(j);
  if (variable < 0) return 0;
  const Joint& joint = joints_[j];
  requireSize(q, "q");
  if (numVariables(j) > 1) {
    throw std::invalid_argument("robot '" + name_ + "': joint '" + joint.name + "' has no single value");
  }
  return joint.mimics ? joint.mimic.multiplier * q[variable] + joint.mimic.offset : q[variable];
}

void KinematicTree::forwardKinematics(const Eigen::Ref<const Eigen::VectorXd>& q,
                                      std::vector<Eigen::Isometry3d>& M_0) const {
  requireConfiguration(q, "q");
  M_0.resize(link_names_.size());
  for (const LinkId link : topologicalOrder()) {
    const JointId j = parent_joint_[link];
    if (j < 0) {
      M_0[link].setIdentity();
    } else {
      placeChild(j, q, M_0[joint_parent_[j]], M_0[link]);
    }
  }
}

Eigen::Isometry3d KinematicTree::linkPose(LinkId link, const Eigen::Ref<const Eigen::VectorXd>& q) const {
  requireConfiguration(q, "q");
  Eigen::Isometry3d M_0;
  placeLink(link, q, M_0);
  return M_0;
}

void KinematicTree::placeLink(LinkId link, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Isometry3d& M_0) const {
  const JointId j = parentJoint(link);
  if (j < 0) return M_0.setIdentity();
  Eigen::Isometry3d M_parent;
  placeLink(joint_parent_[j], q, M_parent);
  placeChild(j, q, M_parent, M_0);
}

void KinematicTree::placeChild(JointId j, const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Isometry3d& M_parent,
                               Eigen::Isometry3d& M_child) const {
  const Joint& joint = joints_[j];
  if (joint.type != JointType::revolute && joint.type != JointType::continuous) {
    M_child = M_parent * joint.origin;
    return moveBy(j, q, M_child);
  }
  const Turn& turn = turns_[j];
  const double angle = jointValue(j, q);
  M_child.linear().noalias() =
      M_parent.linear() * (turn.along + std::cos(angle) * turn.across + std::sin(angle) * turn.aside);
  M_child.translation() = M_parent * joint.origin.translation();
  M_child.makeAffine();
}

Eigen::Isometry3d KinematicTree::jointPose(JointId j, const Eigen::Ref<const Eigen::VectorXd>& q) const {
  requireSize(q, "q");
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  moveBy(j, q, M);
  return M;
}

/// Multiplies M by the joint's pose from the right.
void KinematicTree::moveBy(JointId j, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Isometry3d& M) const {
  const Joint& joint = this->joint(j);
  const int v = jointVariable(j);
  switch (joint.type) {
    case JointType::fixed:
      break;
    case JointType::prismatic:
      M.translate(jointValue(j, q) * joint.axis);
      break;
    case JointType::revolute:
    case JointType::continuous:
      M.rotate(Eigen::AngleAxisd(jointValue(j, q), joint.axis));
      break;
    case JointType::planar:
      M.translate(planeFrame(axisOf(joint)).matrix().leftCols<2>() * q.segment<2>(v));
      M.rotate(Eigen::AngleAxisd(q[v + 2], joint.axis));
      break;
    case JointType::floating:
      M.translate(Eigen::Vector3d(q.segment<3>(v)));
      M.rotate(Eigen::Quaterniond(Eigen::Vector4d(q.segment<4>(v + 3))).normalized());
      break;
    case JointType::spherical:
      M.rotate(Eigen::Quaterniond(Eigen::Vector4d(q.segment<4>(v))).normalized());
      break;
  }
}

void KinematicTree::refuseIndex(const char* what, int index, std::size_t count) const {
  throw std::out_of_range("robot '" + name_ + "' has no " + what + " " + std::to_string(index) + ": there are " +
                          std::to_string(count));
}

void KinematicTree::requireSize(const Eigen::Ref<const Eigen::VectorXd>& q, const std::string& what) const {
  if (q.size() == dof()) return;
  std::string message = what + " has " + text::counted(static_cast<std::size_t>(q.size()), "entry", "entries") +
                        ", robot '" + name_ + "' has " + std::to_string(dof());
  if (dof() > 0) message += ": " + variableName(0) + (dof() > 1 ? " ... " + variableName(dof() - 1) : "");
  throw std::invalid_argument(message);
}

void KinematicTree::requireConfiguration(const Eigen::Ref<const Eigen::VectorXd>& q, const std::string& what) const {
  requireSize(q, what);
  for (int v = 0; v < dof(); ++v) {
    if (!std::isfinite(q[v])) {
      throw std::invalid_argument(what + ": the value " + shown(q[v]) + " of joint '" + variableName(v) +
                                  "' is not finite");
    }
  }
  for (const JointId j : with_quaternions_) {
    const int v = quaternionVariable(j);
    const double length = q.segment<4>(v).norm();
    if (std::abs(length - 1) <= kQuaternionLength) continue;
    throw std::invalid_argument(what + ": the quaternion of joint '" + joints_[j].name + "' has the length " +
                                shown(length) + " instead of 1");
  }
}

std::vector<std::string> KinematicTree::limitNotes(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  requireConfiguration(q, "q");
  std::vector<std::string> notes;
  for (int v = 0; v < dof(); ++v) {
    const Joint& joint = joints_[variables_[v]];
    if (!hasLimits(joint) || (q[v] >= joint.lower && q[v] <= joint.upper)) continue;
    std::ostringstream note;
    note << "joint '" << joint.name << "' at " << q[v] << " is beyond its limits [" << joint.lower << ", "
         << joint.upper << "]";
    notes.push_back(note.str());
  }
  return notes;
}

}  // namespace fcl_artic
