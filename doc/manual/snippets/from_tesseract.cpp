// SPDX-License-Identifier: BSD-3-Clause
// tesseract's two ways to ask: status 0 if all is as the page says.
#include <iostream>

#include <fcl_artic/tesseract/contact_manager.h>
#include <fcl_artic/tesseract/scene.h>
#include <tesseract/geometry/geometries.h>
#include <tesseract/scene_graph/joint.h>
#include <tesseract/scene_graph/link.h>

using namespace tesseract;

static Eigen::Isometry3d at(double x, double y) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, 0));
}

static bool twoPoses() {
  // [poses]
  fcl_artic::TesseractContactManager manager;  // or by tesseract's plug-in loader
  manager.addCollisionObject("ball", 0, {std::make_shared<geometry::Sphere>(0.1)}, {Eigen::Isometry3d::Identity()});
  manager.addCollisionObject("wall", 0, {std::make_shared<geometry::Box>(0.01, 1, 1)}, {Eigen::Isometry3d::Identity()});
  manager.setActiveCollisionObjects({"ball"});
  manager.setCollisionObjectsTransform("ball", at(-1, 0), at(1, 0));

  collision::ContactResultMap contacts;
  manager.contactTest(contacts, collision::ContactRequest(collision::ContactTestType::FIRST));
  std::cout << manager.result() << '\n';  // "contact within [0.4475, ...], proven"; no contact: "free: proven"
  // [/poses]
  return contacts.count() == 1 && manager.result().certain;
}

static bool jointSpace() {
  scene_graph::SceneGraph graph("arm");
  scene_graph::Link world{"world"}, hand{"hand"}, post{"post"};
  for (auto [link, x, y] : {std::make_tuple(&hand, 1., 0.), std::make_tuple(&post, 0., 1.)}) {
    auto body = std::make_shared<scene_graph::Collision>();
    body->geometry = std::make_shared<geometry::Sphere>(0.1);
    body->origin = at(x, y);
    link->collision.push_back(body);
  }
  scene_graph::Joint shoulder{"shoulder"}, fixed{"fixed"};
  shoulder.type = scene_graph::JointType::CONTINUOUS;
  shoulder.axis = Eigen::Vector3d::UnitZ();
  fixed.type = scene_graph::JointType::FIXED;
  shoulder.parent_link_id = fixed.parent_link_id = "world";
  shoulder.child_link_id = "hand";
  fixed.child_link_id = "post";
  graph.addLink(std::move(world));
  graph.setRoot("world");
  graph.addLink(std::move(hand), std::move(shoulder));
  graph.addLink(std::move(post), std::move(fixed));
  // [joints]
  const fcl_artic::TesseractScene scene = fcl_artic::fromTesseract(graph);  // of an environment: getSceneGraph()
  common::JointTrajectory trajectory;
  for (const double angle : {0.0, 1.0, 2.0}) {
    trajectory.push_back(common::JointState({"shoulder"}, Eigen::VectorXd::Constant(1, angle)));
  }
  const fcl_artic::CertifiedResult result = scene.certify(trajectory);
  std::cout << result << '\n';
  if (const auto* contact = result.first()) std::cout << *contact << '\n';
  // [/joints]
  return result.certain && result.t_lower > 1.3 && result.t_lower < 1.4;  // π/2 - 2 asin(0.1) = 1.3705 rad
}

int main() {
  return twoPoses() && jointSpace() ? 0 : 1;
}
