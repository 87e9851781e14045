// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/abi.h"
#include "fcl_artic/export.h"

namespace fcl_artic {

/// Index of a link in its KinematicTree; links are numbered in the order of addLink().
using LinkId = int;
/// Index of a joint in its KinematicTree; joints are numbered in the order of addJoint().
using JointId = int;

/// Kinds of joints, as in URDF, with the variables of each in order.
enum class JointType {
  fixed,       ///< No variable: the child does not move.
  revolute,    ///< One angle about the axis, rad.
  continuous,  ///< One angle about the axis, rad, without limits: JointMotion::shortest() takes the shorter way round.
  prismatic,   ///< One length along the axis, m.
  /// Variables x, y (m), theta (rad), as in MoveIt: a translation in the plane across the axis, then a rotation about
  /// the axis. The x and y are those of the joint's frame, turned the shortest way so that z becomes the axis.
  planar,
  /// A quaternion x, y, z, w that rotates the child in the joint's frame. Its length must be 1 within 1e-3; it is
  /// normalised.
  spherical,
  floating  ///< A position x, y, z (m) in the joint's frame, then a quaternion x, y, z, w as for `spherical`.
};

/// How a joint follows another one: q_this = multiplier * q_master + offset, as in URDF; both have one variable. If
/// the master is a mimic joint itself, KinematicTree::addJoint() stores the joint at the end of the chain instead. Its
/// multiplier is then the product of the multipliers, its offset the resulting one, as rounded.
struct Mimic {
  std::string master;     ///< Name of the joint that is followed.
  double multiplier = 1;  ///< Factor; finite.
  double offset = 0;      ///< Value at q_master = 0, rad or m; finite.
};

/// One joint, as in URDF: it carries the child link, whose frame is the joint's frame at q = 0.
struct Joint {
  std::string name;                   ///< Unique in the tree.
  JointType type = JointType::fixed;  ///< Kind of joint.
  std::string parent;                 ///< Name of the parent link.
  std::string child;                  ///< Name of the child link.
  /// Pose of the joint's frame in the parent link's frame at q = 0.
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  /// Axis in the joint's frame, for a planar joint the plane's normal; addJoint() normalises it. Unused for fixed,
  /// spherical and floating joints.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  /// Limits, rad or m; both 0: no limits (hasLimits()). Queries accept values beyond them.
  double lower = 0, upper = 0;
  bool mimics = false;  ///< Whether the joint follows another one, as `mimic` says, instead of having its own variable.
  Mimic mimic;          ///< How it follows another joint; unused unless `mimics`.

  /// Returns a joint that turns about `axis` by q rad, from `lower` to `upper`; both 0: without limits.
  /// @param axis    in the joint's frame, of any length but 0.
  /// @param origin  pose of the joint's frame in the parent link's frame at q = 0.
  static Joint revolute(std::string name, std::string parent, std::string child, const Eigen::Vector3d& axis,
                        const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity(), double lower = 0,
                        double upper = 0) {
    return make(JointType::revolute, std::move(name), std::move(parent), std::move(child), axis, origin, lower, upper);
  }
  /// Returns a joint that turns about `axis` by q rad without limits; JointMotion::shortest() takes the shorter way
  /// round.
  /// @param axis    in the joint's frame, of any length but 0.
  /// @param origin  pose of the joint's frame in the parent link's frame at q = 0.
  static Joint continuous(std::string name, std::string parent, std::string child, const Eigen::Vector3d& axis,
                          const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
    return make(JointType::continuous, std::move(name), std::move(parent), std::move(child), axis, origin, 0, 0);
  }
  /// Returns a joint that slides along `axis` by q m, from `lower` to `upper`; both 0: without limits.
  /// @param axis    in the joint's frame, of any length but 0.
  /// @param origin  pose of the joint's frame in the parent link's frame at q = 0.
  static Joint prismatic(std::string name, std::string parent, std::string child, const Eigen::Vector3d& axis,
                         const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity(), double lower = 0,
                         double upper = 0) {
    return make(JointType::prismatic, std::move(name), std::move(parent), std::move(child), axis, origin, lower, upper);
  }
  /// Returns a joint that does not move: the child stands at `origin` in the parent link's frame.
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

/// Whether the joint has limits: it is revolute or prismatic, and lower <= upper are finite and not both 0.
FCL_ARTIC_EXPORT bool hasLimits(const Joint& joint);

/// A 64-bit number that stands for the contents added to it, in their order: equal for equal contents. One that nothing
/// was added to, or that was moved from, is empty and stands for nothing.
class FCL_ARTIC_EXPORT Fingerprint {
 public:
  /// Creates an empty fingerprint.
  Fingerprint() = default;
  /// Copies a fingerprint.
  Fingerprint(const Fingerprint&) = default;
  /// Copies a fingerprint.
  Fingerprint& operator=(const Fingerprint&) = default;
  /// Takes over another fingerprint, which becomes empty.
  Fingerprint(Fingerprint&& other) noexcept : value_(std::exchange(other.value_, 0)) {}
  /// Takes over another fingerprint, which becomes empty.
  Fingerprint& operator=(Fingerprint&& other) noexcept {
    value_ = std::exchange(other.value_, 0);
    return *this;
  }

  void add(std::uint64_t number);   ///< Adds an integer.
  void add(double number);          ///< Adds a number by its bits: 0 and -0 differ.
  void add(std::string_view text);  ///< Adds a text with its length.

  /// Whether it is empty.
  bool none() const { return value_ == 0; }
  /// Whether both stand for the same contents. False if either is empty, also if both are.
  bool sameAs(const Fingerprint& other) const { return value_ != 0 && value_ == other.value_; }

 private:
  std::uint64_t value_ = 0;
};

/// A forest of links carried by joints: one robot or several, each with its own root. Roots stand at the world's
/// origin: to place a robot elsewhere, add a link "world" that carries it by a fixed joint. Links and joints can be
/// added, not changed. It must not change during queries, and may then be shared by threads; a manager whose tree has
/// grown needs setup(). Functions of a LinkId, JointId or variable throw std::out_of_range for an index that is not
/// there.
class FCL_ARTIC_EXPORT KinematicTree {
 public:
  /// Creates a tree without links; the name is used in messages.
  explicit KinematicTree(std::string name = "robot");

  /// Adds a link, which is a root until a joint carries it.
  /// @return its index: links are numbered 0, 1, ...
  /// @throws std::invalid_argument for an empty or repeated name.
  LinkId addLink(const std::string& name);
  /// Adds a joint between two links that were added before; the master of a mimic joint must have been added too. The
  /// rotation of its origin is made orthonormal and its axis normalised. The tree is unchanged if this throws.
  /// @return its index: joints are numbered 0, 1, ...
  /// @throws std::invalid_argument, naming joint and reason, for
  ///   - an empty or repeated name, an unknown link, a child that has a parent already, a loop,
  ///   - an origin whose rotation is not orthonormal to 1e-9 or that is farther than 1e9 m away,
  ///   - a zero or non-finite axis, a limit that is not a number,
  ///   - a mimic joint that is fixed or has more than one variable,
  ///   - a master that is unknown, fixed or has more than one variable,
  ///   - a multiplier or offset that is not finite.
  JointId addJoint(const Joint& joint);
  /// Adds joints as addJoint() does, one after the other. Use it for trees of thousands of links: the order of the
  /// links is found once, not after each joint. The tree is unchanged if this throws.
  /// @throws std::invalid_argument as addJoint().
  void addJoints(const std::vector<Joint>& joints);

  /// The robot's name.
  const std::string& name() const { return name_; }
  /// Number of links.
  int numLinks() const { return static_cast<int>(link_names_.size()); }
  /// Number of joints, fixed ones included.
  int numJoints() const { return static_cast<int>(joints_.size()); }
  /// Number of joint variables, the entries of a configuration: those of all joints that are neither fixed nor mimic,
  /// in the order of addJoint(). (A quaternion has four.)
  int dof() const { return static_cast<int>(variables_.size()); }

  /// Name of a link. (Here and below: @throws std::out_of_range naming robot and number for a link, joint or variable
  /// that is not there.)
  const std::string& linkName(LinkId link) const { return entryOf(link_names_, link, "link"); }
  /// A joint by its index, with normalised axis, orthonormal origin and resolved mimic.
  const Joint& joint(JointId joint) const { return entryOf(joints_, joint, "joint"); }
  /// A joint by its name.
  /// @throws std::out_of_range naming the joint and the robot.
  const Joint& joint(std::string_view name) const { return joint(jointId(name)); }
  /// The joint that variable v drives. (Mimic joints follow it.)
  JointId variableJoint(int v) const { return entryOf(variables_, v, "joint variable"); }
  /// Name of variable v: that of its joint, or for joints of more than one variable with MoveIt's endings: "JOINT/x",
  /// "/y", "/theta" (planar), "/rot_x" to "/rot_w" (spherical), "/trans_x" to "/trans_z" and "/rot_x" to "/rot_w"
  /// (floating).
  const std::string& variableName(int v) const { return entryOf(variable_names_, v, "joint variable"); }
  /// Whether variable v is an angle (rad); else it is a length (m) or a part of a quaternion.
  bool isAngle(int v) const;
  /// Index of the first variable that drives the joint, for a mimic joint its master's; -1 if it is fixed.
  int jointVariable(JointId j) const { return entryOf(joint_variable_, j, "joint"); }
  /// Number of variables that drive the joint: 0 to 7.
  int numVariables(JointId j) const { return numVariables(joint(j).type); }
  /// Number of variables that drive a joint of this type: 0 to 7.
  static int numVariables(JointType type);
  /// Index of the first variable (x) of the joint's quaternion; -1 if it has none.
  int quaternionVariable(JointId j) const;
  /// Joints with a quaternion, spherical and floating ones, in the order of their ids.
  const std::vector<JointId>& quaternionJoints() const { return with_quaternions_; }
  /// Joints that follow another one (Joint::mimics), in the order of their ids.
  const std::vector<JointId>& mimicJoints() const { return mimics_; }
  /// The joint whose child the link is; -1 for a root.
  JointId parentJoint(LinkId link) const { return entryOf(parent_joint_, link, "link"); }
  /// The link's parent; -1 for a root.
  LinkId parentLink(LinkId link) const;
  /// All links in an order in which parents come before their children.
  const std::vector<LinkId>& topologicalOrder() const { return order_; }

  /// Index of the link of this name.
  /// @throws std::out_of_range naming the link and the robot.
  LinkId linkId(std::string_view name) const;
  /// Index of the joint of this name.
  /// @throws std::out_of_range naming the joint and the robot.
  JointId jointId(std::string_view name) const;
  /// Whether there is a link of this name.
  bool hasLink(std::string_view name) const { return index_.links.count(name) > 0; }
  /// Index of the joint of this name; -1 if there is none.
  JointId findJoint(std::string_view name) const;
  /// Index of the variable of this name (variableName()); -1 if there is none.
  int findVariable(std::string_view name) const;

  /// Fingerprint of what a motion in joint space depends on: the name and type of every joint that moves, and which
  /// joint it mimics how, in the order of addJoint(). Trees with the same one have the same joint variables and accept
  /// the same motions. Examples are a copy, and the same robot loaded twice, at another base, with other links, limits
  /// or dimensions.
  const Fingerprint& jointSpace() const { return joint_space_; }
  /// Fingerprint of all links and joints with all of their names and numbers, except the name of the tree.
  const Fingerprint& content() const { return content_; }

  /// Returns the configuration of dof() zeros, with quaternions that do not rotate: every joint is at its origin.
  Eigen::VectorXd neutralConfiguration() const;
  /// Returns the value of a joint of at most one variable, rad or m, with mimic applied; 0 if it is fixed.
  /// @param q  dof() joint variables, rad or m.
  /// @throws std::invalid_argument for another number of them, and for a joint of more than one variable (use
  ///   jointPose()).
  double jointValue(JointId joint, const Eigen::Ref<const Eigen::VectorXd>& q) const;
  /// Returns the pose of the child link in the joint's frame, with mimic applied.
  /// @param q  dof() joint variables, rad or m.
  /// @throws std::invalid_argument for another number of them.
  Eigen::Isometry3d jointPose(JointId joint, const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// Computes the pose of every link in the world; roots are at the identity.
  /// @param q         dof() joint variables, rad or m.
  /// @param[out] M_0  link to world, numLinks() entries.
  /// @throws std::invalid_argument as requireConfiguration().
  void forwardKinematics(const Eigen::Ref<const Eigen::VectorXd>& q, std::vector<Eigen::Isometry3d>& M_0) const;

  /// Returns the pose of one link in the world, link to world: the same bits as forwardKinematics(), from the joints
  /// above the link only.
  /// @param q  dof() joint variables, rad or m.
  /// @throws std::invalid_argument as requireConfiguration(); std::out_of_range for a link that is not there.
  Eigen::Isometry3d linkPose(LinkId link, const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// Checks that a configuration has dof() finite entries, and quaternions whose lengths are 1 within 1e-3. Limits are
  /// not checked.
  /// @param what  begins the message.
  /// @throws std::invalid_argument otherwise, naming `what` and the joint.
  void requireConfiguration(const Eigen::Ref<const Eigen::VectorXd>& q, const std::string& what) const;
  /// Returns one line of text for each variable that is beyond its joint's limits. (Queries accept such
  /// configurations.)
  /// @throws std::invalid_argument as requireConfiguration().
  std::vector<std::string> limitNotes(const Eigen::Ref<const Eigen::VectorXd>& q) const;

 private:
  template <class T>
  const T& entryOf(const std::vector<T>& all, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= all.size()) refuseIndex(what, index, all.size());
    return all[static_cast<std::size_t>(index)];
  }
  [[noreturn]] void refuseIndex(const char* what, int index, std::size_t count) const;
  void requireSize(const Eigen::Ref<const Eigen::VectorXd>& q, const std::string& what) const;
  JointId append(const Joint& joint);
  LinkId rootAbove(LinkId link);
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
  std::vector<int> joint_parent_, joint_variable_;
  std::vector<JointId> with_quaternions_, mimics_;
  std::vector<JointId> variables_;
  std::vector<std::string> variable_names_;
  std::vector<LinkId> order_;  ///< topological
  struct Index {
    std::map<std::string, int, std::less<>> links, joints, variables;  ///< numbers by name
    std::vector<LinkId> above;  ///< of each link one of those that carry it; a root's is itself
  };
  Index index_;
  Fingerprint joint_space_, content_;
};

}  // namespace fcl_artic
