// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fcl_artic/kinematic_tree.h"
#include "plans/motion.h"
#include "plans/plan.h"

namespace fcl_artic::plans {

inline void addJoint(KinematicTree& tree, const std::string& name, JointType type, const std::string& parent,
                     const std::string& child, double lower = 0, double upper = 0) {
  Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.lower = lower;
  joint.upper = upper;
  tree.addJoint(joint);
}

/// A hinge within [-1, 2], a rail within [-1, 1].
inline KinematicTree armTree() {
  KinematicTree tree("arm");
  for (const char* link : {"base", "arm", "slide"}) tree.addLink(link);
  addJoint(tree, "hinge", JointType::revolute, "base", "arm", -1, 2);
  addJoint(tree, "rail", JointType::prismatic, "base", "slide", -1, 1);
  return tree;
}

/// The same, and a finger that goes half as far as the rail, the other way, from 0.1 on.
inline KinematicTree gripperTree() {
  KinematicTree tree = armTree();
  tree.addLink("finger");
  Joint joint;
  joint.name = "finger";
  joint.type = JointType::prismatic;
  joint.parent = "arm";
  joint.child = "finger";
  joint.mimics = true;
  joint.mimic = {"rail", -0.5, 0.1};
  tree.addJoint(joint);
  return tree;
}

/// A wheel that turns forever, on a cart that drives in a plane, and a drone.
inline KinematicTree cartTree() {
  KinematicTree tree("cart");
  for (const char* link : {"world", "cart", "wheel", "drone"}) tree.addLink(link);
  addJoint(tree, "drive", JointType::planar, "world", "cart");
  addJoint(tree, "wheel", JointType::continuous, "cart", "wheel");
  addJoint(tree, "fly", JointType::floating, "world", "drone");
  return tree;
}

/// The message of the std::invalid_argument that `call` throws.
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  ADD_FAILURE() << "throws nothing";
  return {};
}

inline void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

/// Why the first plan of a file is no motion.
inline std::string refusalOf(const KinematicTree& tree, const std::string& content, Format format,
                             const MotionOptions& options = {}) {
  return refusal([&] { (void)toMotion(tree, parsePlans(tree, content, format).at(0), options); });
}

}  // namespace fcl_artic::plans
