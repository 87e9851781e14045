// SPDX-License-Identifier: BSD-3-Clause
//
// Random worlds with all that a manager takes, and questions about them.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <octomap/OcTree.h>

#include "fcl_artic/fcl_artic.h"
#include "query/meshes.h"

namespace fcl_artic::test {

/// A generator whose numbers are the same on all machines.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : random_(seed) {}
  int below(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  bool coin() { return below(2) == 1; }
  double in(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random_() >> 11), -53);
  }
  Eigen::Vector3d vector(double most) {
    const double x = in(-most, most), y = in(-most, most), z = in(-most, most);
    return {x, y, z};
  }
  Eigen::Quaterniond turn() { return Eigen::Quaterniond(in(-1, 1), in(-1, 1), in(-1, 1), in(0.1, 1)).normalized(); }
  Eigen::Isometry3d pose(double far) {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() = turn().toRotationMatrix();
    M.translation() = vector(far);
    return M;
  }

 private:
  std::mt19937_64 random_;
};

constexpr int kBoundedKinds = 12, kKinds = 14;

/// A geometry of each kind; those from kBoundedKinds on are unbounded.
inline std::shared_ptr<fcl::CollisionGeometryd> geometry(int kind, Chance& chance) {
  const double a = chance.in(0.05, 0.2), b = chance.in(0.05, 0.2), c = chance.in(0.05, 0.2);
  switch (kind) {
    case 0:
      return std::make_shared<fcl::Boxd>(a, b, c);
    case 1:
      return std::make_shared<fcl::Sphered>(a);
    case 2:
      return std::make_shared<fcl::Ellipsoidd>(a, b, c);
    case 3:
      return std::make_shared<fcl::Capsuled>(a, b);
    case 4:
      return std::make_shared<fcl::Cylinderd>(a, b);
    case 5:
      return std::make_shared<fcl::Coned>(a, b);
    case 6:
      return boxMesh({a, b, c}, chance.coin());
    case 7:
      return makeSolid(*boxMesh({a, b, c}));
    case 8: {
      auto points = std::make_shared<std::vector<Eigen::Vector3d>>();
      for (int i = 0; i < 7; ++i) points->push_back(chance.vector(0.2));
      return std::make_shared<fcl::Convexd>(points, 0, std::make_shared<std::vector<int>>());
    }
    case 9: {
      std::vector<Eigen::Vector3d> points;
      std::vector<double> radii;
      for (int i = 0; i < 9; ++i) {
        points.push_back(chance.vector(0.2));
        radii.push_back(chance.in(0.01, 0.03));
      }
      if (chance.coin()) radii.resize(1);
      return std::make_shared<PointCloud>(points, radii);
    }
    case 10: {
      const auto tree = std::make_shared<octomap::OcTree>(0.07);
      for (int i = 0; i < 12; ++i) {
        const Eigen::Vector3d p = chance.vector(0.2);
        tree->updateNode(octomap::point3d(float(p[0]), float(p[1]), float(p[2])), i % 4 != 0);
      }
      tree->prune();
      return std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
    }
    case 11:
      return std::make_shared<fcl::TrianglePd>(chance.vector(0.2), chance.vector(0.2), chance.vector(0.2));
    case 12:
      return std::make_shared<fcl::Halfspaced>(Eigen::Vector3d(chance.vector(0.2) + Eigen::Vector3d::UnitZ()), -a - 1);
    default:
      return std::make_shared<fcl::Planed>(Eigen::Vector3d(chance.vector(0.2) + Eigen::Vector3d::UnitZ()), -a - 1);
  }
}

/// A tree of a chain and a branch, with all kinds of joints.
inline std::shared_ptr<KinematicTree> tree(Chance& chance, int links) {
  auto all = std::make_shared<KinematicTree>("robot of chance");
  all->addLink("link0");
  std::string single;  // a joint of one variable, to be followed
  for (int i = 1; i < links; ++i) {
    const std::string name = "link" + std::to_string(i), parent = "link" + std::to_string(chance.below(4) ? i - 1 : 0);
    all->addLink(name);
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    constexpr JointType kTypes[] = {JointType::revolute,  JointType::revolute,  JointType::continuous,
                                    JointType::prismatic, JointType::spherical, JointType::floating,
                                    JointType::planar,    JointType::fixed};
    joint.type = kTypes[chance.below(8)];
    joint.parent = parent;
    joint.child = name;
    joint.origin = chance.pose(0.4);
    joint.axis = chance.vector(1) + 2 * Eigen::Vector3d::UnitY();
    const bool one = joint.type == JointType::revolute || joint.type == JointType::prismatic;
    if (one && chance.coin()) {
      joint.lower = -chance.in(0.5, 2);
      joint.upper = chance.coin() ? chance.in(0.5, 2) : std::numeric_limits<double>::infinity();
    }
    if (one && !single.empty() && chance.coin()) {
      joint.mimics = true;
      joint.mimic = {single, chance.in(-1, 1), chance.in(-0.1, 0.1)};
    } else if (one) {
      single = joint.name;
    }
    all->addJoint(joint);
  }
  return all;
}

inline std::shared_ptr<fcl::MotionBased> motionOfItsOwn(Chance& chance, const KinematicTree& arm) {
  const Eigen::Isometry3d from = chance.pose(0.8), to = chance.pose(0.8);
  switch (chance.below(4)) {
    case 0:
      return std::make_shared<fcl::TranslationMotion<double>>(fcl::Transform3d(from), fcl::Transform3d(to));
    case 1:
      return std::make_shared<fcl::ScrewMotion<double>>(from.linear(), from.translation(), to.linear(),
                                                        to.translation());
    case 2: {
      Eigen::Vector3d p[8];
      for (Eigen::Vector3d& v : p) v = chance.vector(0.6);
      return std::make_shared<fcl::SplineMotion<double>>(p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]);
    }
    default:
      return std::make_shared<FclLinkMotion>(
          arm, JointMotion::linear(arm, Eigen::VectorXd::Constant(arm.dof(), -0.7), Eigen::VectorXd::Ones(arm.dof())),
          arm.numLinks() - 1, from);
  }
}

/// An arm of three links for obstacles that move as its last link.
inline KinematicTree smallArm() {
  KinematicTree arm("small arm");
  for (const char* link : {"a", "b", "c"}) arm.addLink(link);
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  origin.translation().x() = 0.3;
  arm.addJoint(Joint::revolute("ab", "a", "b", {0.3, 1, 0.2}, origin));
  arm.addJoint(Joint::prismatic("bc", "b", "c", {1, 0.1, 0}, origin));
  return arm;
}

struct World {
  std::shared_ptr<KinematicTree> tree;
  ArticulatedCollisionManager manager;
};

/// A world, set up.
inline World world(std::uint64_t seed) {
  Chance chance(seed);
  const auto robot = tree(chance, 5);
  World world{robot, ArticulatedCollisionManager(robot)};
  ArticulatedCollisionManager& manager = world.manager;
  const auto object = [&](const std::shared_ptr<fcl::CollisionGeometryd>& shape, const Eigen::Isometry3d& M) {
    return std::make_shared<fcl::CollisionObjectd>(shape, fcl::Transform3d(M));
  };
  const auto shared = geometry(chance.below(kBoundedKinds), chance);
  for (int i = 0; i < robot->numLinks(); ++i) {
    const auto shape = i == 1 ? shared : geometry(chance.below(kBoundedKinds), chance);
    manager.bind(i, object(shape, Eigen::Isometry3d::Identity()), chance.pose(0.1));
  }
  const int obstacles = 2 + chance.below(3);
  for (int i = 0; i < obstacles; ++i) {
    const int kind =
        chance.below(4) == 0 ? kBoundedKinds + chance.below(kKinds - kBoundedKinds) : chance.below(kBoundedKinds);
    const auto shape = i == 0 ? shared : geometry(kind, chance);
    manager.registerObject(object(shape, chance.pose(1)), "obstacle with a name " + std::to_string(i));
  }
  const KinematicTree arm = smallArm();
  for (int i = chance.below(3); i > 0; --i) {
    manager.registerObject(std::make_shared<fcl::ContinuousCollisionObjectd>(
                               geometry(chance.below(kBoundedKinds), chance), motionOfItsOwn(chance, arm)),
                           "mover" + std::to_string(i));
  }
  if (chance.coin()) {
    const auto held = object(geometry(chance.below(kBoundedKinds), chance), chance.pose(1));
    manager.registerObject(held, "held");
    manager.attach("link3", held, chance.pose(0.1), {"link1"});
    manager.setMargin("held", 0.001);
  }
  if (chance.coin()) manager.allow("link0", "link2");
  if (chance.coin()) manager.allow("link1", "obstacle with a name 0");
  if (chance.coin()) manager.disallow("link0", "link1");
  if (chance.below(4) == 0) {
    AllowedCollisionMatrix all = manager.allowedCollisions();
    all.setComplete();
    manager.setAllowedCollisions(all);
  }
  if (chance.coin()) manager.setMargin("link2", 0.01);
  if (chance.coin()) manager.setMargin("link2", "link4", 0.002);
  manager.setup();
  return world;
}

inline Eigen::VectorXd configuration(Chance& chance, const KinematicTree& tree) {
  Eigen::VectorXd q(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) q[v] = chance.in(-1.5, 1.5);
  for (const JointId j : tree.quaternionJoints()) q.segment<4>(tree.quaternionVariable(j)) = chance.turn().coeffs();
  return q;
}

inline CertifiedRequest request(Chance& chance) {
  CertifiedRequest request;
  request.mode = static_cast<ContactMode>(chance.below(3));
  request.max_contacts = static_cast<std::size_t>(chance.below(4));
  request.ignore_initial_contact = chance.coin();
  if (chance.coin()) request.margin = 0.003;
  if (chance.below(4) == 0) request.added_margin = 1e-3 / 3;
  if (chance.below(4) == 0) request.work_budget = 500;
  if (chance.below(4) == 0) request.check_self = false;
  if (chance.below(8) == 0) request.check_scene = false;
  if (chance.below(4) == 0) request.method = Method::redon2004;
  if (chance.below(4) == 0) request.visibility = VisibilityMode::on;
  request.redon.refinement_level = chance.below(3) - 1;
  return request;
}

}  // namespace fcl_artic::test
