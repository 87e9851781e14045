// SPDX-License-Identifier: BSD-3-Clause
#include "random_robot.h"

#include <algorithm>
#include <array>

#include <coal/BVH/BVH_model.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>

namespace fcl_artic::test {
namespace {

double uniform(Random& random, double lower, double upper) {
  return std::uniform_real_distribution<double>(lower, upper)(random);
}

Eigen::Vector3d randomVector(Random& random) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
}

/// An octahedron that is stretched: vertices and triangles, outward.
std::array<Eigen::Vector3d, 6> corners(const Eigen::Vector3d& s) {
  return {Eigen::Vector3d(s.x(), 0, 0),  Eigen::Vector3d(-s.x(), 0, 0), Eigen::Vector3d(0, s.y(), 0),
          Eigen::Vector3d(0, -s.y(), 0), Eigen::Vector3d(0, 0, s.z()),  Eigen::Vector3d(0, 0, -s.z())};
}
constexpr int kFaces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

std::shared_ptr<coal::CollisionGeometry> coalBody(const Part& part) {
  const Eigen::Vector3d& s = part.size;
  std::shared_ptr<coal::ShapeBase> shape;
  switch (part.body) {
    case Body::box:
      shape = std::make_shared<coal::Box>(2 * s);
      break;
    case Body::sphere:
      shape = std::make_shared<coal::Sphere>(s.x());
      break;
    case Body::ellipsoid:
      shape = std::make_shared<coal::Ellipsoid>(s);
      break;
    case Body::capsule:
      shape = std::make_shared<coal::Capsule>(s.x(), 2 * s.z());
      break;
    case Body::cone:
      shape = std::make_shared<coal::Cone>(s.x(), 2 * s.z());
      break;
    case Body::cylinder:
      shape = std::make_shared<coal::Cylinder>(s.x(), 2 * s.z());
      break;
    case Body::convex: {
      const auto vertices = corners(s);
      auto points = std::make_shared<std::vector<coal::Vec3s>>(vertices.begin(), vertices.end());
      auto faces = std::make_shared<std::vector<coal::Triangle>>();
      for (const auto& f : kFaces) faces->emplace_back(f[0], f[1], f[2]);
      shape = std::make_shared<coal::Convex<coal::Triangle>>(points, 6, faces, 8);
      break;
    }
    default: {
      auto mesh = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
      const auto vertices = corners(s);
      mesh->beginModel();
      for (const auto& f : kFaces) mesh->addTriangle(vertices[f[0]], vertices[f[1]], vertices[f[2]]);
      mesh->endModel();
      return mesh;
    }
  }
  shape->setSweptSphereRadius(part.swept);
  return shape;
}

std::shared_ptr<fcl::CollisionGeometryd> fclBody(const Part& part) {
  const Eigen::Vector3d& s = part.size;
  switch (part.body) {
    case Body::box:
      return std::make_shared<fcl::Boxd>(2 * s.x(), 2 * s.y(), 2 * s.z());
    case Body::sphere:
      return std::make_shared<fcl::Sphered>(s.x() + part.swept);
    case Body::ellipsoid:
      return std::make_shared<fcl::Ellipsoidd>(s.x(), s.y(), s.z());
    case Body::capsule:
      return std::make_shared<fcl::Capsuled>(s.x() + part.swept, 2 * s.z());
    case Body::cone:
      return std::make_shared<fcl::Coned>(s.x(), 2 * s.z());
    case Body::cylinder:
      return std::make_shared<fcl::Cylinderd>(s.x(), 2 * s.z());
    default:
      break;
  }
  const auto vertices = corners(s);
  if (part.body == Body::convex) {
    auto points = std::make_shared<std::vector<fcl::Vector3d>>(vertices.begin(), vertices.end());
    auto faces = std::make_shared<std::vector<int>>();
    for (const auto& f : kFaces) faces->insert(faces->end(), {3, f[0], f[1], f[2]});
    return std::make_shared<fcl::Convexd>(points, 8, faces);
  }
  auto mesh = std::make_shared<fcl::BVHModel<fcl::AABBd>>();
  mesh->beginModel();
  for (const auto& f : kFaces) mesh->addTriangle(vertices[f[0]], vertices[f[1]], vertices[f[2]]);
  mesh->endModel();
  return mesh;
}

/// Whether a margin has to stand for the swept radius.
double leftOver(const Part& part) {
  return part.body == Body::sphere || part.body == Body::capsule ? 0 : part.swept;
}

pinocchio::SE3 se3(const Eigen::Isometry3d& M) {
  return {M.linear(), M.translation()};
}

pinocchio::JointModel pinocchioJoint(const Part& part) {
  switch (part.type) {
    case JointType::revolute:
      return pinocchio::JointModelRevoluteUnaligned(part.axis);
    case JointType::continuous:
      return pinocchio::JointModelRevoluteUnboundedUnaligned(part.axis);
    case JointType::prismatic:
      return pinocchio::JointModelPrismaticUnaligned(part.axis);
    case JointType::planar:
      return pinocchio::JointModelPlanar();
    case JointType::spherical:
      return pinocchio::JointModelSpherical();
    default:
      return pinocchio::JointModelFreeFlyer();
  }
}

}  // namespace

Eigen::Isometry3d randomPose(Random& random, double reach) {
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.linear() =
      Eigen::Quaterniond(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1))
          .normalized()
          .toRotationMatrix();
  M.translation() = reach * randomVector(random);
  return M;
}

RandomRobot randomRobot(Random& random, const std::vector<JointType>& kinds) {
  RandomRobot robot;
  const int joints = 2 + static_cast<int>(random() % 4), all = joints + 2;
  // coal sweeps no shape that it tests against a mesh.
  const bool sweeps = random() % 2;
  for (int i = 0; i < all; ++i) {
    Part part;
    // Depth first, as pinocchio asks for: on the joint before, or on one that carries it.
    part.parent = i < joints ? i - 1 : -1;
    while (part.parent >= 0 && random() % 4 == 0) {
      part.parent = robot.parts[static_cast<std::size_t>(part.parent)].parent;
    }
    part.type = i < joints ? kinds[random() % kinds.size()] : JointType::fixed;
    part.origin = randomPose(random, 0.5);
    part.axis = part.type == JointType::planar ? Eigen::Vector3d::UnitZ() : randomVector(random).normalized().eval();
    part.mimics = i > 0 && part.type == JointType::revolute && robot.parts.back().type == JointType::revolute &&
                  !robot.parts.back().mimics && random() % 4 == 0;
    part.body = static_cast<Body>(random() % static_cast<unsigned>(sweeps ? Body::mesh : Body::count));
    part.size = Eigen::Vector3d::Constant(0.03) + 0.15 * randomVector(random).cwiseAbs();
    part.placement = randomPose(random, i < joints ? 0.3 : 0.8);
    if (sweeps && random() % 2 == 0) part.swept = 0.03;
    robot.parts.push_back(part);
  }
  for (int a = 0; a < all; ++a) {
    for (int b = a + 1; b < all; ++b) {
      const bool still = a >= joints;  // and so b
      if (!still && random() % 4 != 0) robot.pairs.emplace_back(a, b);
    }
  }
  return robot;
}

void makePinocchio(const RandomRobot& robot, pinocchio::Model& model, pinocchio::GeometryModel& geometries) {
  std::vector<pinocchio::JointIndex> joints;
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const Part& part = robot.parts[i];
    const std::string name = robot.name(static_cast<int>(i));
    joints.push_back(0);
    if (part.type != JointType::fixed) {
      const pinocchio::JointIndex parent = part.parent < 0 ? 0 : joints[static_cast<std::size_t>(part.parent)];
      pinocchio::JointModel joint = pinocchioJoint(part);
      if (part.mimics) joint = pinocchio::JointModelMimic(joint, model.joints[joints[i - 1]], -0.5, 0.25);
      joints.back() = model.addJoint(parent, joint, se3(part.origin), "joint" + std::to_string(i));
    }
    const Eigen::Isometry3d placement = part.type == JointType::fixed ? part.origin * part.placement : part.placement;
    geometries.addGeometryObject(pinocchio::GeometryObject(name, joints.back(), se3(placement), coalBody(part)));
  }
  for (const auto& [a, b] : robot.pairs) {
    geometries.addCollisionPair(
        pinocchio::CollisionPair(static_cast<pinocchio::GeomIndex>(a), static_cast<pinocchio::GeomIndex>(b)));
  }
}

DirectRobot makeDirect(const RandomRobot& robot) {
  DirectRobot direct;
  direct.tree = std::make_shared<KinematicTree>("direct");
  direct.tree->addLink("world");
  const auto joint_link = [](std::size_t i) { return "link" + std::to_string(i); };
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const Part& part = robot.parts[i];
    if (part.type == JointType::fixed) continue;
    Joint joint;
    joint.type = part.type;
    joint.name = "joint" + std::to_string(i);
    joint.parent = part.parent < 0 ? "world" : joint_link(static_cast<std::size_t>(part.parent));
    joint.child = joint_link(i);
    joint.origin = part.origin;
    joint.axis = part.axis;
    joint.mimics = part.mimics;
    if (part.mimics) joint.mimic = {"joint" + std::to_string(i - 1), -0.5, 0.25};
    direct.tree->addLink(joint.child);
    direct.tree->addJoint(joint);
  }
  direct.manager = std::make_shared<ArticulatedCollisionManager>(direct.tree);
  ArticulatedCollisionManager& manager = *direct.manager;
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {  // all attached: neighbours are then checked
    const Part& part = robot.parts[i];
    const Eigen::Isometry3d placement = part.type == JointType::fixed ? part.origin * part.placement : part.placement;
    auto body = std::make_shared<fcl::CollisionObjectd>(fclBody(part), placement);
    manager.registerObject(body, robot.name(static_cast<int>(i)));
    if (part.type != JointType::fixed) manager.attach(joint_link(i), body, placement);
  }
  const int all = static_cast<int>(robot.parts.size());
  for (int a = 0; a < all; ++a) {
    for (int b = a + 1; b < all; ++b) {
      const double margin =
          leftOver(robot.parts[static_cast<std::size_t>(a)]) + leftOver(robot.parts[static_cast<std::size_t>(b)]);
      if (std::find(robot.pairs.begin(), robot.pairs.end(), std::make_pair(a, b)) == robot.pairs.end()) {
        manager.allow(robot.name(a), robot.name(b));
      } else if (margin > 0) {
        manager.setMargin(robot.name(a), robot.name(b), margin);
      }
    }
  }
  manager.setup();
  return direct;
}

Eigen::VectorXd randomConfiguration(const KinematicTree& tree, Random& random, double range) {
  Eigen::VectorXd q = tree.neutralConfiguration();
  for (int v = 0; v < q.size(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    const std::string& name = tree.variableName(v);
    const bool length = joint.type == JointType::prismatic || name.find("/trans") != std::string::npos ||
                        name.find("/x") != std::string::npos || name.find("/y") != std::string::npos;
    q[v] = uniform(random, -1, 1) * (length ? 0.3 * range : range);
  }
  for (int v = 0; v < q.size(); ++v) {
    if (tree.variableName(v).find("/rot_x") != std::string::npos) q.segment<4>(v).normalize();
  }
  return q;
}

}  // namespace fcl_artic::test
