// SPDX-License-Identifier: BSD-3-Clause
//
// Tolerances of joints and of objects' poses: as the caller sets them, by names; and as set-up and queries read them.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/tube.h"
#include "geometry/shape_tree.h"
#include "motion/body_motion.h"

namespace fcl_artic {

/// How far joints stray, in the order of a tree's joints and variables.
struct TreeStrays {
  std::vector<JointTolerance> of_joint;  ///< empty: none strays
  /// rad or m, by variable, the tolerance of a joint with one variable; infinity where a joint with several variables
  /// strays. Empty: no joint strays.
  std::vector<double> of_variable;
};

/// Tolerances by the names of joints and of objects.
class NamedTolerances {
 public:
  /// Counts for joints that have none of their own: the angle if they turn, the length if they slide.
  /// @throws std::invalid_argument: a number negative or not finite.
  void setAllJoints(const JointTolerance& tolerance);
  /// @throws std::invalid_argument beginning with `what`, as ArticulatedCollisionManager::setJointTolerance().
  void setJoint(const KinematicTree& tree, const std::string& joint, const JointTolerance& tolerance,
                const std::string& what);
  /// @throws std::invalid_argument: a number negative or not finite.
  void setBase(const PoseTolerance& tolerance);
  const PoseTolerance& base() const { return of_base_; }
  /// @throws std::invalid_argument: a number negative or not finite.
  void setObject(const std::string& name, const PoseTolerance& tolerance);
  /// @throws std::invalid_argument: a number that is not finite, a negative speed.
  void setSpeed(const std::string& name, const ObjectSpeed& speed);
  /// @throws std::invalid_argument: a number negative or not finite.
  void setTime(double time);
  double ofTime() const { return of_time_; }
  const JointTolerance& ofAllJoints() const { return of_all_joints_; }
  const std::map<std::string, JointTolerance>& ofJoints() const { return of_joint_; }
  const std::map<std::string, PoseTolerance>& ofObjects() const { return of_object_; }
  const std::map<std::string, ObjectSpeed>& speeds() const { return speed_of_; }
  /// That of an object; not moving if nobody has set one.
  ObjectSpeed speedOf(const std::string& object) const;
  bool anySpeed() const;
  void clear();
  /// Forgets those of objects of other names than these.
  void keep(const std::function<bool(const std::string& name)>& isKept);

  /// Some joint or object strays, or an object moves by itself. (The tolerance of time is for moving obstacles.)
  bool any() const;
  /// @throws std::invalid_argument: a joint with a tolerance is in the tree no more, or is another one by now.
  TreeStrays straysOf(const KinematicTree& tree) const;
  /// Upper bound of how far any point of an object's geometry may be from where the object's pose puts it, m.
  /// @param shape  in the object's own frame.
  double strayOf(const std::string& object, const ShapeTree& shape) const;
  /// The tolerance of time multiplied by an upper bound of the speed of an obstacle's points. (The speed is in m, as
  /// the motion as a whole takes 1.)
  /// @param shape  in the object's own frame.
  /// @throws std::invalid_argument naming the obstacle: nothing bounds its speed.
  double lagOf(const std::string& object, const ShapeTree& shape, const BodyMotion& motion) const;

 private:
  JointTolerance of_all_joints_;
  PoseTolerance of_base_;
  double of_time_ = 0;
  std::map<std::string, JointTolerance> of_joint_;
  std::map<std::string, PoseTolerance> of_object_;
  std::map<std::string, ObjectSpeed> speed_of_;
};

}  // namespace fcl_artic
