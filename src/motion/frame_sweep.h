// SPDX-License-Identifier: BSD-3-Clause
//
// Moving bodies as seen from one base frame: the moving factors on the way to every body of interest, constant
// transforms multiplied in, each joint's axis turned to z. World motion is the sweep from the world. Relative motion
// of two links is a sweep along the path between them, so that joints which do not move them apart drop out exactly.
// Relative motion of two free bodies goes up the one's motion and down the other's.
#pragma once

#include <memory>
#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/tube.h"
#include "model/sweep.h"
#include "motion/body_motion.h"

namespace fcl_artic {

/// Where a link is carried: M_base,link(t) = (frame of `step`)(t) * offset.
struct Carrier {
  int step = -1;  ///< -1: fixed to the base frame
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();
  double length = 0, ulps = 0;  ///< of the offset, as in engine::Placement
};

class FrameSweep {
 public:
  /// The world's sweep: all links, seen from the world (roots stand at identity).
  static FrameSweep fromWorld(const KinematicTree& tree);
  /// A sweep from a link's frame, empty until carrier() asks for links.
  static FrameSweep fromLink(const KinematicTree& tree, LinkId base);

  /// A sweep from no tree: for cross() with the elements of body motions.
  FrameSweep() = default;

  /// Adds the steps on the way to the link where they are not there yet.
  Carrier carrier(LinkId link);

  /// Goes on into a tree that stands in the world: for carrier(), after the elements of a body's motion.
  /// @param world  where the world is carried.
  void enterTree(const KinematicTree& tree, const Carrier& world);

  /// Crosses one element of a body's motion, outwards (down) or back towards the world.
  /// @param variable  of its first row of coefficients.
  /// @param source  of a bounded element; the view keeps the pointer.
  /// @param orientation  of a turn: number, among those of the query, of the rotation that it is applied to; -1: none.
  Carrier cross(const Carrier& from, const MotionElement& element, int variable, const engine::BoundedSource* source,
                bool down, int orientation = -1);

  /// Says how far the tree's joints stray: of each joint an angle (rad) and a length (m).
  /// @param of_joint  in the tree's order; none: no joint strays.
  void setStrays(const std::vector<JointTolerance>& of_joint);

  /// Adds an error to the motion of the step crossed last: an angle in units of 2^-52 rad, a length in 2^-52 m.
  void allowError(double angle, double length);

  engine::SweepView view() const;
  void clear();

 private:
  explicit FrameSweep(const KinematicTree& tree, LinkId base) : tree_(&tree), base_(base) {}
  /// Crosses a joint: downwards (parent to child) or upwards.
  Carrier cross(const Carrier& from, JointId joint, bool down);
  /// Adds a step after `at` and goes there: its frame is turned so that the axis is z. The caller still has to set what
  /// moves it.
  engine::SweepStep& append(Carrier& at, const UnitVector& axis);

  const KinematicTree* tree_ = nullptr;
  LinkId base_ = -1;  ///< -1: the world
  Carrier world_;     ///< of a sweep that comes to the tree from outside
  std::vector<engine::SweepStep> steps_;
  struct Origin {
    int parent;
    JointId joint;  ///< -1: an element of a body's motion
    std::size_t factor;
    bool down;
  };
  std::vector<Origin> origin_;  ///< what step i crosses, to share common beginnings
};

/// The transform as the engine wants it.
engine::Placement makePlacement(const RigidTransform& M);
/// Where a geometry with this offset from the carried link stands in the frame of the carrier's step.
engine::Placement makePlacement(const Carrier& carrier, const RigidTransform& offset);
/// The base frame as seen from that geometry, where the carrier stands still.
engine::Placement makeInversePlacement(const Carrier& carrier, const RigidTransform& offset);

}  // namespace fcl_artic
