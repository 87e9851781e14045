// SPDX-License-Identifier: BSD-3-Clause
//
// Random robots as URDF text, with kinematics of their own: what the reader and the library make of the text is not
// looked at here.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/collision_geometry.h>
#include <Eigen/Geometry>

#include "fcl_artic/kinematic_tree.h"
#include "pairs/random.h"

namespace urdf_trees {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;

/// FCL's answers are off by rounding. A contact counts only if it is there with shapes that are this much smaller on
/// each side, in m. A pair that is said to touch must do so with shapes as much larger. Meshes are what they are.
constexpr double kAround = 1e-5;

/// A collision element, or an obstacle.
struct Shape {
  Isometry3d offset = Isometry3d::Identity();  ///< in its link; of an obstacle: in the world
  std::string element;                         ///< the URDF's, with its origin; of an obstacle: empty
  Geometry exact, smaller, larger;
  bool mesh = false;
  double radius = 0;  ///< of a ball about the offset's origin that holds `larger`
};

struct Link {
  int parent = -1;  ///< comes before its child
  fcl_artic::JointType type = fcl_artic::JointType::fixed;
  Isometry3d origin = Isometry3d::Identity();
  std::string origin_element;
  Vector3d axis = Vector3d::UnitX();
  int master = -1;  ///< link whose joint is mimicked
  double multiplier = 1, joint_offset = 0;
  std::vector<Shape> shapes;

  bool moves(const std::vector<Link>& links) const;
};

/// Values of all joints at t = 0 and t = 1: one or three numbers, or a position and a quaternion x, y, z, w.
struct JointWay {
  std::vector<double> from, to;
};

const char* typeName(fcl_artic::JointType type);  ///< as URDF has it

class RandomTree {
 public:
  /// @param folder  with the meshes that writeMeshes() writes.
  RandomTree(pairs::Random& random, const std::string& folder);

  const std::vector<Link>& links() const { return links_; }
  static std::string linkName(int i) { return "link_" + std::to_string(i); }
  static std::string jointName(int i) { return "joint_" + std::to_string(i); }  ///< the one above link i

  /// Links and joints in an order of their own.
  std::string urdf(pairs::Random& random) const;
  /// Random ends for all joints. @param reach  size of the motion: rad, and m / 3.
  std::vector<JointWay> way(pairs::Random& random, double reach) const;
  /// Pose of every link: joint values straight from end to end, quaternions by the shortest rotation.
  std::vector<Isometry3d> poses(const std::vector<JointWay>& way, double t) const;
  /// The nearest link at or above this one that a joint moves; -1: the world, which also carries obstacles (link -1).
  int carrier(int link) const;

 private:
  std::vector<Link> links_;
};

/// A shape at random. @param size  largest extent, about.
Shape randomShape(pairs::Random& random, double size, const std::string& folder);
void writeMeshes(const std::string& folder);

}  // namespace urdf_trees
