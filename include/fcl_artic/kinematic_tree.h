// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// Index of a link in its KinematicTree; links are numbered in the order of addLink().
using LinkId = int;
/// Index of a joint in its KinematicTree; joints are numbered in the order of addJoint().
using JointId = int;

/// `continuous` is a revolute joint without limits: the factory JointMotion::shortest() may wrap it.
/// Joints of more than one variable, with the order that URDF's users and MoveIt know:
/// - `planar`: x, y, theta: a translation in the plane across the axis, then a rotation about the axis. x and y are
///   those of the joint's frame, turned the shortest way so that z becomes the axis.
/// - `spherical`: a quaternion x, y, z, w: rotates the child in the joint's frame.
/// - `floating`: a position x, y, z, then a quaternion x, y, z, w.
/// A quaternion is accepted when its length is 1 within 1e-3, and is normalised.
enum class JointType { fixed, revolute, continuous, prismatic, planar, spherical, floating };

/// q_this = multiplier * q_master + offset, as in URDF; both have one variable. Where the master is a mimic itself, the
/// tree keeps what that comes to, rounded: a mimic of the joint that the chain ends at.
struct Mimic {
  std::string master;  ///< name of the joint that is followed
  double multiplier = 1;
  double offset = 0;  ///< rad or m
};

/// One joint, as in URDF: the child link's frame is the joint's frame.
struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  std::string parent;  ///< parent link
  std::string child;   ///< child link
  /// Pose of the joint's frame in the parent link's frame at q = 0.
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  /// Axis in the joint's frame, of a planar joint the plane's normal; normalised by addJoint(). Unused when fixed,
  /// spherical or floating.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double lower = 0, upper = 0;  ///< rad or m; see hasLimits()
  bool mimics = false;
  Mimic mimic;

  /// A turn about `axis` by q rad, from `lower` to `upper`; both 0: without limits.
  /// @param axis  in the joint's frame, of any length but 0.
  /// @param origin  pose of the joint's frame in the parent link's frame at q = 0.
  static Joint revolute(std::string name, std::string parent, std::string child, const Eigen::Vector3d& axis,
                        const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity(), double lower = 0,
                        double upper = 0) {
    return make(JointType::revolute, std::move(name), std::move(parent), std::move(child), axis, origin, lower, upper);
  }
  /// A turn about `axis` by q rad without limits, which JointMotion::shortest() takes the shorter way round.
  static Joint continuous(std::string name, std::string parent, std::string child, const Eigen::Vector3d& axis,
                          const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
    return make(JointType::continuous, std::move(name), std::move(parent), std::move(child), axis, origin, 0, 0);
  }
  /// A slide along `axis` by q m, from `lower` to `upper`; both 0: without limits.
  static Joint prismatic(std::string name, std::string parent, std::string child, const Eigen::Vector3d& axis,
                         const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity(), double lower = 0,
                         double upper = 0) {
    return make(JointType::prismatic, std::move(name), std::move(parent), std::move(child), axis, origin, lower, upper);
  }
  /// No motion: the child stands at `origin` in the parent link's frame.
  static Joint fixed(std::string name, std::string parent, std::string child,
                     const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
    return make(JointType::fixed, std::move(name), std::move(parent), std::move(child), Eigen::Vector3d::UnitX(),
                origin, 0, 0);
  }

 private:
  static Joint make(JointType type, std::string&& name, std::string&& parent, std::string&& child,
                    const Eigen::Vector3d& axis, const Eigen::Isometry3d& origin, double lower, double upper) {
    Joint joint;
    joint.type = type;
    joint.name = std::move(name);
    joint.parent = std::move(parent);
    joint.child = std::move(child);
    joint.axis = axis;
    joint.origin = origin;
    joint.lower = lower;
    joint.upper = upper;
    return joint;
  }
};

/// Whether the joint stays between lower and upper: those of one variable do, but continuous ones, and but for
/// lower > upper, both 0 or an infinite one, which are no limits.
FCL_ARTIC_EXPORT bool hasLimits(const Joint& joint);

/// A number that stands for what was added to it, in that order: 64 bits, equal for equal contents. What has been moved
/// from, or was never given anything, is none and stands for nothing.
class FCL_ARTIC_EXPORT Fingerprint {
 public:
  Fingerprint() = default;
  Fingerprint(const Fingerprint&) = default;
  Fingerprint& operator=(const Fingerprint&) = default;
  Fingerprint(Fingerprint&& other) noexcept : value_(std::exchange(other.value_, 0)) {}
  Fingerprint& operator=(Fingerprint&& other) noexcept {
    value_ = std::exchange(other.value_, 0);
    return *this;
  }

  void add(std::uint64_t number);
  void add(double number);  ///< by its bits
  void add(std::string_view text);

  bool none() const { return value_ == 0; }
  /// False for what stands for nothing, also of two such.
  bool sameAs(const Fingerprint& other) const { return value_ != 0 && value_ == other.value_; }

 private:
  std::uint64_t value_ = 0;
};

/// A forest of links carried by joints: one robot or several, each with its own root. Constant during
/// queries and shared by threads.
class FCL_ARTIC_EXPORT KinematicTree {
 public:
  explicit KinematicTree(std::string name = "robot");

  /// @throws std::invalid_argument for an empty or repeated name.
  LinkId addLink(const std::string& name);
  /// Adds a joint between two known links. The tree is unchanged when this throws.
  /// @throws std::invalid_argument, naming joint and reason: repeated name, unknown link, a child that has a parent
  ///   already, a loop, a zero or non-finite axis, a rotation that is not orthonormal to 1e-9, an unknown or fixed
  ///   master.
  JointId addJoint(const Joint& joint);

  const std::string& name() const { return name_; }
  int numLinks() const { return static_cast<int>(link_names_.size()); }
  int numJoints() const { return static_cast<int>(joints_.size()); }
  /// Number of joint variables, the entries of a configuration: those of all joints that are neither fixed nor mimic,
  /// in the order of addJoint(). (A quaternion has four.)
  int dof() const { return static_cast<int>(variables_.size()); }

  const std::string& linkName(LinkId link) const { return link_names_.at(static_cast<std::size_t>(link)); }
  const Joint& joint(JointId joint) const { return joints_.at(static_cast<std::size_t>(joint)); }
  /// @throws std::out_of_range naming the joint and the robot.
  const Joint& joint(std::string_view name) const { return joint(jointId(name)); }
  /// Joint that variable v drives (mimic joints follow it).
  JointId variableJoint(int v) const { return variables_.at(static_cast<std::size_t>(v)); }
  /// Name of the joint, or with MoveIt's endings "JOINT/x", "/y", "/theta" (planar), "/trans_x" to "/trans_z" and
  /// "/rot_x" to "/rot_w" (floating; spherical: the latter).
  const std::string& variableName(int v) const { return variable_names_.at(static_cast<std::size_t>(v)); }
  /// True for an angle (rad), false for a length (m) or a part of a quaternion.
  bool isAngle(int v) const;
  /// First variable that drives the joint, -1 when fixed; for a mimic joint that of its master.
  int jointVariable(JointId j) const { return joint_variable_.at(static_cast<std::size_t>(j)); }
  /// Number of variables that drive the joint: 0 to 7.
  int numVariables(JointId j) const { return numVariables(joint(j).type); }
  static int numVariables(JointType type);
  /// First variable of the joint's quaternion, -1 when it has none.
  int quaternionVariable(JointId j) const;
  /// Joint whose child the link is, -1 for a root.
  JointId parentJoint(LinkId link) const { return parent_joint_.at(static_cast<std::size_t>(link)); }
  /// Parent link, -1 for a root.
  LinkId parentLink(LinkId link) const;
  /// Links in an order in which parents come before children.
  const std::vector<LinkId>& topologicalOrder() const { return order_; }

  /// @throws std::out_of_range naming the link and the robot.
  LinkId linkId(std::string_view name) const;
  /// @throws std::out_of_range naming the joint and the robot.
  JointId jointId(std::string_view name) const;
  bool hasLink(std::string_view name) const { return findLink(name) >= 0; }

  /// What a motion in joint space depends on: of every joint that moves, in the order of addJoint(), its name, its type
  /// and whom it mimics how. Trees that are alike in this have the same joint variables and take the same motions: a
  /// copy, the same robot loaded twice, at another base, with other links, limits or measured dimensions.
  const Fingerprint& jointSpace() const { return joint_space_; }
  /// All links and joints, with all of their names and numbers. (But for the name of the whole.)
  const Fingerprint& content() const { return content_; }

  /// All variables 0, quaternions at no rotation: every joint at its origin.
  Eigen::VectorXd neutralConfiguration() const;
  /// Value of the joint (rad or m) for the variables q; mimic applied; 0 when fixed.
  /// @throws std::invalid_argument for a joint of more than one variable; see jointPose().
  double jointValue(JointId joint, const Eigen::Ref<const Eigen::VectorXd>& q) const;
  /// Pose of the child in the joint's frame for the variables q; mimic applied.
  Eigen::Isometry3d jointPose(JointId joint, const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// Pose of every link in the world, roots at identity.
  /// @param q  dof() joint variables, rad or m.
  /// @param[out] M_0  link to world, numLinks() entries.
  /// @throws std::invalid_argument as requireConfiguration().
  void forwardKinematics(const Eigen::Ref<const Eigen::VectorXd>& q, std::vector<Eigen::Isometry3d>& M_0) const;

  /// Pose of one link in the world, the same bits as forwardKinematics() gives: the joints on its way only.
  /// @throws std::invalid_argument as requireConfiguration(); std::out_of_range for a link that is not there.
  Eigen::Isometry3d linkPose(LinkId link, const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// Refuses a configuration of the wrong size, with a value that is not finite, or with a quaternion whose length is
  /// not 1 within 1e-3, naming `what` and the joint.
  /// @throws std::invalid_argument
  void requireConfiguration(const Eigen::Ref<const Eigen::VectorXd>& q, const std::string& what) const;
  /// One line for each variable that is beyond its limits (they are accepted).
  std::vector<std::string> limitNotes(const Eigen::Ref<const Eigen::VectorXd>& q) const;

 private:
  int findLink(std::string_view name) const;
  void sortLinks();
  void addToFingerprints(const Joint& joint);
  /// A turn of q about a joint's axis, seen from the parent link: along + across cos q + aside sin q.
  struct Turn {
    explicit Turn(const Joint& joint);
    Eigen::Matrix3d along, across, aside;
  };
  void moveBy(JointId joint, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Isometry3d& M) const;
  void placeChild(JointId joint, const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Isometry3d& M_parent,
                  Eigen::Isometry3d& M_child) const;
  void placeLink(LinkId link, const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Isometry3d& M_0) const;
  std::string name_;
  std::vector<std::string> link_names_;
  std::vector<JointId> parent_joint_;
  std::vector<Joint> joints_;
  std::vector<Turn> turns_;  ///< of each joint; used of revolute and continuous ones
  std::vector<int> joint_parent_, joint_child_, joint_variable_;
  std::vector<JointId> with_quaternions_;
  std::vector<JointId> variables_;
  std::vector<std::string> variable_names_;
  std::vector<LinkId> order_;  ///< topological
  Fingerprint joint_space_, content_;
};

}  // namespace fcl_artic
