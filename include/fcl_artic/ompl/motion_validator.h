// SPDX-License-Identifier: BSD-3-Clause
//
// Component `ompl`: motions of OMPL planners, proven free instead of sampled. There is no resolution to choose.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSpace.h>
#include <ompl/base/StateValidityChecker.h>

#include "fcl_artic/manager.h"

namespace fcl_artic::planning {

/// Returns the request that planners ask with by default: tolerance_time 1/4096 of the motion, for queries that want
/// the first contact, tolerance_distance 0.01 mm, and the defaults of CertifiedRequest for the rest.
FCL_ARTIC_EXPORT CertifiedRequest planningRequest();

/// How the states of an OMPL space place the joints of a tree, and the motion that StateSpace::interpolate() describes.
///
/// The parts of the space are taken in order, and each takes the next of the named joints:
///
/// | space | joints | motion |
/// | --- | --- | --- |
/// | RealVectorStateSpace of n dimensions | n revolute, continuous or prismatic | straight |
/// | SO2StateSpace | 1 revolute or continuous without limits | the shorter way round, over π if that is it |
/// | SE2StateSpace | 1 planar | position straight, angle the shorter way round |
/// | SO3StateSpace | 1 spherical | the shortest rotation at constant speed |
/// | SE3StateSpace | 1 floating | position straight, shortest rotation |
/// | CompoundStateSpace | those of its parts | each part's |
///
/// A RealVectorStateSpace or SO2StateSpace may also drive single variables of a planar or floating joint, by their
/// names (KinematicTree::variableName()). If two orientations differ by less than 1e-4 rad,
/// SO3StateSpace::interpolate() stays at the first one until the end; the motion here turns on its way, and does reach
/// the second.
///
/// Any other space is refused, and so is a class derived from these: its interpolate() may take another way.
///
/// Const members may be called from many threads at once.
class FCL_ARTIC_EXPORT JointMapping {
 public:
  /// Maps the states of a space to the joints of a tree.
  /// @param space   of the states; must only live until the constructor returns.
  /// @param tree    shared from here on.
  /// @param joints  names of the joints, in the order of the space's parts; empty: all variables of the tree in its
  ///   order.
  /// @param others  dof() joint variables, rad or m, at which joints that are not named stay; empty: the neutral
  ///   configuration.
  /// @throws std::invalid_argument naming space or joint, for
  ///   - a tree that is null, a space that is not supported, a wrong number of joints,
  ///   - a joint that is unknown, fixed, a mimic, named twice or of the wrong kind for its part,
  ///   - a number for a part of a quaternion,
  ///   - SO2 for a joint with limits or with a mimic joint that is elsewhere after a whole turn,
  ///   - `others` that are no configuration.
  JointMapping(const ::ompl::base::StateSpace& space, std::shared_ptr<const KinematicTree> tree,
               const std::vector<std::string>& joints = {}, const Eigen::VectorXd& others = {});

  /// The tree whose joints are placed.
  const KinematicTree& tree() const { return *tree_; }
  /// Computes the joint variables of a state.
  /// @param state   of the mapped space.
  /// @param[out] q  dof() joint variables, rad or m.
  void configuration(const ::ompl::base::State* state, Eigen::VectorXd& q) const;
  /// Returns the motion from s1 to s2, t in [0, 1]: the one that the space's interpolate() describes.
  /// @throws std::invalid_argument as JointMotion::linear().
  JointMotion motion(const ::ompl::base::State* s1, const ::ompl::base::State* s2) const;

 private:
  enum class Kind { real, angle, quaternion };
  /// One number of a state and what it drives.
  struct Value {
    std::vector<unsigned> path;  ///< through compound states to the part
    unsigned index;              ///< in a real vector or quaternion
    Kind kind;
    bool turns;    ///< takes the shorter way round
    int variable;  ///< of the tree; in a Part: counted from its first
  };
  /// A part of the space that takes one name.
  struct Part {
    JointType joint;   ///< that it drives as a whole; `fixed`: it drives one variable
    std::string what;  ///< says so
    std::vector<Value> values;
  };
  static void collect(const ::ompl::base::StateSpace& space, const std::string& whole, std::vector<unsigned>& path,
                      std::vector<Part>& parts);
  int requireVariable(const std::string& name, const std::string& where) const;
  int requireJoint(const std::string& name, const Part& part) const;
  JointMotion atHalfTurn(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const;
  static double read(const Value& value, const ::ompl::base::State* state);

  std::shared_ptr<const KinematicTree> tree_;
  std::vector<Value> values_;
  std::vector<int> quaternions_;  ///< first variables of those that states drive
  Eigen::VectorXd others_;
};

/// Motion validator that accepts a motion only if it is proven free of contact over all of its way. It may be called
/// from many threads at once.
///
/// A motion is invalid if it touches anything, if contact can't be excluded within the request's tolerances, and if a
/// work budget ran out. Only collisions are judged, neither bounds of the space nor other constraints. By default a
/// motion that starts in contact is invalid.
///
/// With CertifiedRequest::ignore_initial_contact, pairs that touch at s1 may separate, whichever way. At s2 all pairs
/// must be farther than their margin and tolerance_distance from each other. From such a state on nothing is ignored:
/// a plan may start in contact, but not come back into it. So along any sequence of states whose motions are valid one
/// by one, nothing touches after the first motion. In the first motion only pairs that touched at its start touch,
/// until they have separated.
///
/// Margins are the pairs' own if they have any (ArticulatedCollisionManager::setMargin()), else the request's;
/// CertifiedRequest::added_margin is added to either, and so is the room that states are given. With tolerances
/// (ArticulatedCollisionManager::setJointTolerances()) a valid motion or state is one of which all of the tube is free.
class FCL_ARTIC_EXPORT ContinuousMotionValidator : public ::ompl::base::MotionValidator {
 public:
  /// Creates a validator for a space information.
  /// @param manager  set up, and not changed while planners run; it must keep its objects alive.
  /// @param mapping  made with the manager's own tree (ArticulatedCollisionManager::sharedTree()).
  /// @param request  mode, max_contacts and progress are not used.
  /// @throws std::invalid_argument if something is null, if the mapping is of another tree than the manager's, or if an
  ///   obstacle moves.
  ContinuousMotionValidator(const ::ompl::base::SpaceInformationPtr& si,
                            std::shared_ptr<const ArticulatedCollisionManager> manager, JointMapping mapping,
                            const CertifiedRequest& request = planningRequest());
  /// Creates a validator for a space information whose space has all variables of the manager's tree in its order.
  /// @param manager  set up, and not changed while planners run; it must keep its objects alive.
  /// @param request  mode, max_contacts and progress are not used.
  /// @throws std::invalid_argument if something is null, if an obstacle moves, and as JointMapping for the space of
  /// `si`.
  ContinuousMotionValidator(const ::ompl::base::SpaceInformationPtr& si,
                            std::shared_ptr<const ArticulatedCollisionManager> manager,
                            const CertifiedRequest& request = planningRequest());

  /// Returns whether the motion from s1 to s2 is proven free. (Any contact decides it; the first one is not looked
  /// for.)
  /// @throws as JointMapping::motion() and ArticulatedCollisionManager::continuousCollide(), and std::invalid_argument
  /// if
  ///   an obstacle moves.
  bool checkMotion(const ::ompl::base::State* s1, const ::ompl::base::State* s2) const override;

  /// Returns whether the motion from s1 to s2 is proven free, and if not, how far it is.
  ///
  /// If false, the motion is proven free from s1 up to lastValid.second, within the request's tolerance_time of its
  /// first contact. Unless lastValid.first is null, it is set to the state there; it may be s1 or s2. The motion from
  /// s1 to that state is valid. The time is asked for with twice the request's tolerance_distance added to every
  /// margin. At the state itself all pairs are proven farther apart than their margin and tolerance_distance: so the
  /// state is valid by itself and can be left again. If there is no such room at s1, or what touched there has not
  /// separated by then, the time is 0 and the state s1. If true, lastValid is not touched.
  /// @param[out] lastValid  state and fraction of the motion, in [0, 1].
  /// @throws as checkMotion(s1, s2); the time is 0 and the state s1 then, too.
  bool checkMotion(const ::ompl::base::State* s1, const ::ompl::base::State* s2,
                   std::pair<::ompl::base::State*, double>& lastValid) const override;

  // The counters of the base class give the same numbers as those below, but should be asked when no planner runs.

  /// Returns how many motions were found valid. May be called while planners run.
  unsigned int getValidMotionCount() const;
  /// Returns how many motions were found invalid. May be called while planners run.
  unsigned int getInvalidMotionCount() const;
  /// Returns how many motions were checked. May be called while planners run.
  unsigned int getCheckedMotionCount() const { return getValidMotionCount() + getInvalidMotionCount(); }
  /// Returns the fraction of checked motions that were valid; 0 if none was. May be called while planners run.
  double getValidMotionFraction() const;
  /// Sets the counts to 0. May be called while planners run.
  void resetMotionCounter();

 private:
  bool count(bool valid) const;
  bool roomAt(const ::ompl::base::State* state) const;
  bool ignoring(const ::ompl::base::State* s1) const;
  bool provenFree(const JointMotion& motion, const ::ompl::base::State* s2, bool ignoring) const;
  double timeWithRoom(const JointMotion& motion, bool ignoring) const;

  std::shared_ptr<const ArticulatedCollisionManager> manager_;
  JointMapping mapping_;
  CertifiedRequest any_, first_, apart_;
};

/// State validity checker that accepts a state only if it is proven free of contact. It may be called from many threads
/// at once. Bounds are not judged, as in the motion validator.
class FCL_ARTIC_EXPORT CollisionStateValidityChecker : public ::ompl::base::StateValidityChecker {
 public:
  /// Creates a checker for a space information.
  /// @param manager  set up, and not changed while planners run; it must keep its objects alive.
  /// @param mapping  made with the manager's own tree (ArticulatedCollisionManager::sharedTree()).
  /// @param request  mode, max_contacts, progress and ignore_initial_contact are not used.
  /// @throws std::invalid_argument if something is null, if the mapping is of another tree than the manager's, or if an
  ///   obstacle moves.
  CollisionStateValidityChecker(const ::ompl::base::SpaceInformationPtr& si,
                                std::shared_ptr<const ArticulatedCollisionManager> manager, JointMapping mapping,
                                const CertifiedRequest& request = planningRequest());
  /// Creates a checker for a space information whose space has all variables of the manager's tree in its order.
  /// @param manager  set up, and not changed while planners run; it must keep its objects alive.
  /// @param request  mode, max_contacts, progress and ignore_initial_contact are not used.
  /// @throws std::invalid_argument if something is null, if an obstacle moves, and as JointMapping for the space of
  /// `si`.
  CollisionStateValidityChecker(const ::ompl::base::SpaceInformationPtr& si,
                                std::shared_ptr<const ArticulatedCollisionManager> manager,
                                const CertifiedRequest& request = planningRequest());

  /// OMPL's overloads, which also return distances to invalid states.
  using ::ompl::base::StateValidityChecker::isValid;
  /// Returns whether the state is proven free of contact.
  /// @throws as ArticulatedCollisionManager::collide(), and std::invalid_argument if an obstacle moves.
  bool isValid(const ::ompl::base::State* state) const override;

 private:
  std::shared_ptr<const ArticulatedCollisionManager> manager_;
  JointMapping mapping_;
  CertifiedRequest request_;
};

}  // namespace fcl_artic::planning
