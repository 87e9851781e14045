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

/// What planners ask for: first contact (where it is wanted at all) within 1/4096 of the motion, 0.01 mm.
FCL_ARTIC_EXPORT CertifiedRequest planningRequest();

/// How the states of an OMPL space place the joints of a tree, and the motion that StateSpace::interpolate() describes.
///
/// The space's parts are taken in order and share out the named joints:
///
/// | space | joints | motion |
/// | --- | --- | --- |
/// | RealVectorStateSpace of n dimensions | n revolute, continuous or prismatic | straight |
/// | SO2StateSpace | 1 revolute or continuous | the shorter way round, over π where that is it |
/// | SE2StateSpace | 1 planar | position straight, angle the shorter way round |
/// | SO3StateSpace | 1 spherical | the shortest rotation at constant speed |
/// | SE3StateSpace | 1 floating | position straight, shortest rotation |
/// | CompoundStateSpace | those of its parts | each part's |
///
/// A RealVectorStateSpace or SO2StateSpace may drive single variables of a planar or floating joint too, by their names
/// (KinematicTree::variableName()). Where two orientations differ by less than 1e-4 rad, SO3StateSpace::interpolate()
/// stays at the first one until the end; the motion here turns on its way, and does reach the second.
///
/// Any other space is refused, and so is a class derived from these: its interpolate() may take another way.
class FCL_ARTIC_EXPORT JointMapping {
 public:
  /// @param joints  names of the joints, in the order of the space's parts; none: all variables of the tree in its
  /// order.
  /// @param others  dof() joint variables, those of unnamed joints stay at theirs; empty: at the neutral configuration.
  /// @throws std::invalid_argument naming space or joint: space not supported, wrong number of joints, a joint that is
  ///   unknown, fixed, a mimic, named twice or of the wrong kind for its part, a number for a part of a quaternion, SO2
  ///   for a joint that is mimicked so that a whole turn of it is not one of the mimic.
  JointMapping(const ::ompl::base::StateSpace& space, std::shared_ptr<const KinematicTree> tree,
               const std::vector<std::string>& joints = {}, const Eigen::VectorXd& others = {});

  const KinematicTree& tree() const { return *tree_; }
  /// Joint variables of a state. @param[out] q  dof() entries.
  void configuration(const ::ompl::base::State* state, Eigen::VectorXd& q) const;
  /// The motion from s1 to s2. @throws std::invalid_argument as JointMotion::linear().
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
  /// What takes one name.
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

/// Says of a motion that it is valid only when it is proven free of contact, over all of its way. Thread-safe.
///
/// A motion is invalid when it touches anything, when contact can't be excluded within the request's tolerances, and
/// when a work budget ran out. Only collisions are judged, not bounds of the space nor other constraints. By default a
/// motion that starts in contact is invalid.
///
/// With CertifiedRequest::ignore_initial_contact, pairs that touch at s1 may separate, whichever way. At s2 all pairs
/// must be farther than their margin and tolerance_distance from each other, and from such a state on nothing is
/// ignored: a plan may start in contact, but not come back into it. So of any sequence of states whose motions are
/// valid one by one, nothing touches after the first motion, and in that one only what touched at its start.
///
/// Margins are the pairs' own where they have any (ArticulatedCollisionManager::setMargin), else the request's;
/// CertifiedRequest::added_margin is added to either, and so is the room that states are given.
class FCL_ARTIC_EXPORT ContinuousMotionValidator : public ::ompl::base::MotionValidator {
 public:
  /// @param manager  set up, and not changed while planners run; it must keep its objects alive.
  /// @param request  mode, max_contacts and progress are not used.
  /// @throws std::invalid_argument when something is null, or when the mapping is not one of the manager's tree.
  ContinuousMotionValidator(const ::ompl::base::SpaceInformationPtr& si,
                            std::shared_ptr<const ArticulatedCollisionManager> manager, JointMapping mapping,
                            const CertifiedRequest& request = planningRequest());
  /// The same for all variables of the manager's tree in its order.
  ContinuousMotionValidator(const ::ompl::base::SpaceInformationPtr& si,
                            std::shared_ptr<const ArticulatedCollisionManager> manager,
                            const CertifiedRequest& request = planningRequest());

  /// Any contact will do here: it need not be the first.
  bool checkMotion(const ::ompl::base::State* s1, const ::ompl::base::State* s2) const override;

  /// When false: the motion is proven free from s1 up to lastValid.second, within the request's tolerance_time of its
  /// first contact, and lastValid.first, unless null, is set to the state there. It may be s1 or s2. The motion from s1
  /// to that state is valid. The time is asked for with twice the request's tolerance_distance added to every margin,
  /// and at the state itself all pairs are proven farther apart than their margin and tolerance_distance: so it is
  /// valid by itself and can be left again. Where there is no such room at s1, or what touched there has not separated
  /// by then, the time is 0 and the state s1. When true, lastValid is not touched.
  /// When it throws, the time is 0 and the state s1, too.
  bool checkMotion(const ::ompl::base::State* s1, const ::ompl::base::State* s2,
                   std::pair<::ompl::base::State*, double>& lastValid) const override;

  /// OMPL's counters, read and reset so that planners may run meanwhile. (Those of the base class give the same
  /// numbers, but should be asked when no planner runs.)
  unsigned int getValidMotionCount() const;
  unsigned int getInvalidMotionCount() const;
  unsigned int getCheckedMotionCount() const { return getValidMotionCount() + getInvalidMotionCount(); }
  double getValidMotionFraction() const;
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

/// A state is valid when it is proven free of contact. Thread-safe. Bounds are not judged, as in the motion validator.
class FCL_ARTIC_EXPORT CollisionStateValidityChecker : public ::ompl::base::StateValidityChecker {
 public:
  /// As ContinuousMotionValidator. ignore_initial_contact has no meaning for a state, and is not used.
  CollisionStateValidityChecker(const ::ompl::base::SpaceInformationPtr& si,
                                std::shared_ptr<const ArticulatedCollisionManager> manager, JointMapping mapping,
                                const CertifiedRequest& request = planningRequest());
  CollisionStateValidityChecker(const ::ompl::base::SpaceInformationPtr& si,
                                std::shared_ptr<const ArticulatedCollisionManager> manager,
                                const CertifiedRequest& request = planningRequest());

  using ::ompl::base::StateValidityChecker::isValid;
  bool isValid(const ::ompl::base::State* state) const override;

 private:
  std::shared_ptr<const ArticulatedCollisionManager> manager_;
  JointMapping mapping_;
  CertifiedRequest request_;
};

}  // namespace fcl_artic::planning
