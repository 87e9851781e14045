// SPDX-License-Identifier: BSD-3-Clause
//
// Random robots as pinocchio and coal have them, and the same ones built by hand on this library's own types.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <pinocchio/fwd.hpp>  // before boost's variant

#include <pinocchio/multibody/geometry.hpp>
#include <pinocchio/multibody/model.hpp>

#include "fcl_artic/manager.h"

namespace fcl_artic::test {

using Random = std::mt19937_64;

/// Bodies that both libraries have.
enum class Body { box, sphere, ellipsoid, capsule, cone, cylinder, convex, mesh, count };

/// A joint and the body on it, or for parent = -1 an obstacle.
struct Part {
  int parent;      ///< index of the joint that carries the joint; -1: the universe
  JointType type;  ///< `fixed`: no joint, an obstacle
  Eigen::Isometry3d origin;
  Eigen::Vector3d axis;
  bool mimics = false;  ///< follows the joint before, revolute and no mimic: others pinocchio 3.7 may miscount
  Body body;
  Eigen::Vector3d size;  ///< m, at least 0.03
  Eigen::Isometry3d placement;
  double swept = 0;  ///< m
};

/// A robot, its obstacles and the pairs that are checked.
struct RandomRobot {
  std::vector<Part> parts;
  std::vector<std::pair<int, int>> pairs;
  std::string name(int part) const { return "part" + std::to_string(part); }
};

/// Makes a robot of 2 to 5 joints with a body each, and 2 obstacles.
/// @param kinds  joints are of these.
RandomRobot randomRobot(Random& random, const std::vector<JointType>& kinds);

/// The robot in pinocchio's types.
void makePinocchio(const RandomRobot& robot, pinocchio::Model& model, pinocchio::GeometryModel& geometries);

/// The same robot on this library's types, with no code of the adapter's.
struct DirectRobot {
  std::shared_ptr<KinematicTree> tree;
  std::shared_ptr<ArticulatedCollisionManager> manager;
};
DirectRobot makeDirect(const RandomRobot& robot);

/// A configuration of the direct robot within ±range rad or m.
Eigen::VectorXd randomConfiguration(const KinematicTree& tree, Random& random, double range);

Eigen::Isometry3d randomPose(Random& random, double reach);

}  // namespace fcl_artic::test
