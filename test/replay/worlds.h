// SPDX-License-Identifier: BSD-3-Clause
//
// Random worlds with all that a manager takes, and questions about them.
#pragma once

#include <memory>
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
#include "support/random_placing.h"

namespace fcl_artic::test {

constexpr int kBoundedKinds = 12, kKinds = 14;

/// A geometry of each kind; those from kBoundedKinds on are unbounded.
inline std::shared_ptr<fcl::CollisionGeometryd> geometry(int kind, Random& random) {
  const double a = random.uniform(0.05, 0.2), b = random.uniform(0.05, 0.2), c = random.uniform(0.05, 0.2);
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
      return boxMesh({a, b, c}, random.chance(0.5));
    case 7:
      return makeSolid(*boxMesh({a, b, c}));
    case 8: {
      auto points = std::make_shared<std::vector<Eigen::Vector3d>>();
      for (int i = 0; i < 7; ++i) points->push_back(random.box(0.2));
      return std::make_shared<fcl::Convexd>(points, 0, std::make_shared<std::vector<int>>());
    }
    case 9: {
      std::vector<Eigen::Vector3d> points;
      std::vector<double> radii;
      for (int i = 0; i < 9; ++i) {
        points.push_back(random.box(0.2));
        radii.push_back(random.uniform(0.01, 0.03));
      }
      if (random.chance(0.5)) radii.resize(1);
      return std::make_shared<PointCloud>(points, radii);
    }
    case 10: {
      const auto tree = std::make_shared<octomap::OcTree>(0.07);
      for (int i = 0; i < 12; ++i) {
        const Eigen::Vector3d p = random.box(0.2);
        tree->updateNode(octomap::point3d(float(p[0]), float(p[1]), float(p[2])), i % 4 != 0);
      }
      tree->prune();
      return std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
    }
    case 11: {
      const Eigen::Vector3d p = random.box(0.2), q = random.box(0.2), r = random.box(0.2);
      return std::make_shared<fcl::TrianglePd>(p, q, r);
    }
    case 12:
      return std::make_shared<fcl::Halfspaced>(Eigen::Vector3d(random.box(0.2) + Eigen::Vector3d::UnitZ()), -a - 1);
    default:
      return std::make_shared<fcl::Planed>(Eigen::Vector3d(random.box(0.2) + Eigen::Vector3d::UnitZ()), -a - 1);
  }
}

/// A tree of a chain and a branch, with all kinds of joints.
inline std::shared_ptr<KinematicTree> tree(Random& random, int links) {
  auto all = std::make_shared<KinematicTree>("robot of chance");
  all->addLink("link0");
  std::string single;  // a joint of one variable, to be followed
  for (int i = 1; i < links; ++i) {
    const std::string name = "link" + std::to_string(i), parent = "link" + std::to_string(random.below(4) ? i - 1 : 0);
    all->addLink(name);
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    constexpr JointType kTypes[] = {JointType::revolute,  JointType::revolute,  JointType::continuous,
                                    JointType::prismatic, JointType::spherical, JointType::floating,
                                    JointType::planar,    JointType::fixed};
    joint.type = kTypes[random.below(8)];
    joint.parent = parent;
    joint.child = name;
    joint.origin = random.pose(0.4);
    joint.axis = random.box(1) + 2 * Eigen::Vector3d::UnitY();
    const bool one = joint.type == JointType::revolute || joint.type == JointType::prismatic;
    if (one && random.chance(0.5)) {
      joint.lower = -random.uniform(0.5, 2);
      joint.upper = random.chance(0.5) ? random.uniform(0.5, 2) : std::numeric_limits<double>::infinity();
    }
    if (one && !single.empty() && random.chance(0.5)) {
      joint.mimics = true;
      joint.mimic = {single, random.uniform(-1, 1), random.uniform(-0.1, 0.1)};
    } else if (one) {
      single = joint.name;
    }
    all->addJoint(joint);
  }
  return all;
}

inline std::shared_ptr<fcl::MotionBased> motionOfItsOwn(Random& random, const KinematicTree& arm) {
  const Eigen::Isometry3d from = random.pose(0.8), to = random.pose(0.8);
  switch (random.below(4)) {
    case 0:
      return std::make_shared<fcl::TranslationMotion<double>>(fcl::Transform3d(from), fcl::Transform3d(to));
    case 1:
      return std::make_shared<fcl::ScrewMotion<double>>(from.linear(), from.translation(), to.linear(),
                                                        to.translation());
    case 2: {
      Eigen::Vector3d p[8];
      for (Eigen::Vector3d& v : p) v = random.box(0.6);
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
  Random random(seed);
  const auto robot = tree(random, 5);
  World world{robot, ArticulatedCollisionManager(robot)};
  ArticulatedCollisionManager& manager = world.manager;
  const auto object = [&](const std::shared_ptr<fcl::CollisionGeometryd>& shape, const Eigen::Isometry3d& M) {
    return std::make_shared<fcl::CollisionObjectd>(shape, fcl::Transform3d(M));
  };
  const auto shared = geometry(random.below(kBoundedKinds), random);
  for (int i = 0; i < robot->numLinks(); ++i) {
    const auto shape = i == 1 ? shared : geometry(random.below(kBoundedKinds), random);
    manager.bind(i, object(shape, Eigen::Isometry3d::Identity()), random.pose(0.1));
  }
  const int obstacles = 2 + random.below(3);
  for (int i = 0; i < obstacles; ++i) {
    const int kind =
        random.oneIn(4) ? kBoundedKinds + random.below(kKinds - kBoundedKinds) : random.below(kBoundedKinds);
    const auto shape = i == 0 ? shared : geometry(kind, random);
    manager.registerObject(object(shape, random.pose(1)), "obstacle with a name " + std::to_string(i));
  }
  const KinematicTree arm = smallArm();
  for (int i = random.below(3); i > 0; --i) {
    const auto shape = geometry(random.below(kBoundedKinds), random);
    const auto motion = motionOfItsOwn(random, arm);
    manager.registerObject(std::make_shared<fcl::ContinuousCollisionObjectd>(shape, motion),
                           "mover" + std::to_string(i));
  }
  if (random.chance(0.5)) {
    const auto shape = geometry(random.below(kBoundedKinds), random);
    const auto held = object(shape, random.pose(1));
    manager.registerObject(held, "held");
    manager.attach("link3", held, random.pose(0.1), {"link1"});
    manager.setMargin("held", 0.001);
  }
  if (random.chance(0.5)) manager.allow("link0", "link2");
  if (random.chance(0.5)) manager.allow("link1", "obstacle with a name 0");
  if (random.chance(0.5)) manager.disallow("link0", "link1");
  if (random.oneIn(4)) {
    AllowedCollisionMatrix all = manager.allowedCollisions();
    all.setComplete();
    manager.setAllowedCollisions(all);
  }
  if (random.chance(0.5)) manager.setMargin("link2", 0.01);
  if (random.chance(0.5)) manager.setMargin("link2", "link4", 0.002);
  manager.setup();
  return world;
}

inline Eigen::VectorXd configuration(Random& random, const KinematicTree& tree) {
  Eigen::VectorXd q(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) q[v] = random.uniform(-1.5, 1.5);
  for (const JointId j : tree.quaternionJoints())
    q.segment<4>(tree.quaternionVariable(j)) = Eigen::Quaterniond(random.rotation()).coeffs();
  return q;
}

inline CertifiedRequest request(Random& random) {
  CertifiedRequest request;
  request.mode = static_cast<ContactMode>(random.below(3));
  request.max_contacts = static_cast<std::size_t>(random.below(4));
  request.ignore_initial_contact = random.chance(0.5);
  if (random.chance(0.5)) request.margin = 0.003;
  if (random.oneIn(4)) request.added_margin = 1e-3 / 3;
  if (random.oneIn(4)) request.work_budget = 500;
  if (random.oneIn(4)) request.check_self = false;
  if (random.oneIn(8)) request.check_scene = false;
  if (random.oneIn(4)) request.method = Method::redon2004;
  if (random.oneIn(4)) request.visibility = VisibilityMode::on;
  request.redon.refinement_level = random.below(3) - 1;
  return request;
}

}  // namespace fcl_artic::test
