// SPDX-License-Identifier: BSD-3-Clause
#include "engine.h"
#include "../support/allow_neighbours.h"

#include <chrono>

namespace campaign {
namespace {

Eigen::Isometry3d isometry(const Pose& M) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = M.R;
  X.translation() = M.p;
  return X;
}

std::string linkName(int link) {
  return "link" + std::to_string(link);
}
std::string jointName(int link) {
  return "joint" + std::to_string(link);
}

Eigen::VectorXd vectorOf(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

}  // namespace

int Answer::bodyOf(const fcl::CollisionObjectd* object) const {
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i].get() == object) return static_cast<int>(i);
  return -1;
}

std::shared_ptr<const fcl_artic::KinematicTree> treeOf(const Scene& scene) {
  auto tree = std::make_shared<fcl_artic::KinematicTree>("campaign");
  for (int i = 0; i < static_cast<int>(scene.links.size()); ++i) tree->addLink(linkName(i));
  for (int i = 0; i < static_cast<int>(scene.links.size()); ++i) {
    const Link& l = scene.links[static_cast<std::size_t>(i)];
    if (l.parent < 0) continue;
    static constexpr fcl_artic::JointType kTypes[] = {fcl_artic::JointType::fixed, fcl_artic::JointType::revolute,
                                                      fcl_artic::JointType::continuous,
                                                      fcl_artic::JointType::prismatic};
    fcl_artic::Joint joint;
    joint.name = jointName(i);
    joint.type = kTypes[static_cast<int>(l.joint)];
    joint.parent = linkName(l.parent);
    joint.child = linkName(i);
    joint.origin = isometry(l.origin);
    joint.axis = l.axis;
    if (l.master >= 0) {
      joint.mimics = true;
      joint.mimic = {jointName(l.master), l.multiplier, l.offset};
    }
    tree->addJoint(joint);
  }
  return tree;
}

fcl_artic::JointMotion motionOf(const Scene& scene, const fcl_artic::KinematicTree& tree) {
  const Eigen::VectorXd q0 = vectorOf(scene.q0), q1 = vectorOf(scene.q1);
  return scene.shortest ? fcl_artic::JointMotion::shortest(tree, q0, q1) : fcl_artic::JointMotion::linear(tree, q0, q1);
}

Question prepare(const Scene& scene) {
  Question question;
  question.tree = treeOf(scene);
  question.manager = std::make_unique<fcl_artic::ArticulatedCollisionManager>(question.tree);
  fcl_artic::ArticulatedCollisionManager& manager = *question.manager;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& b = scene.bodies[i];
    const Eigen::Isometry3d X = isometry(b.pose);
    question.objects.push_back(std::make_shared<fcl::CollisionObjectd>(b.geometry->fclGeometry(),
                                                                       b.link < 0 ? X : Eigen::Isometry3d::Identity()));
    if (b.link < 0)
      manager.registerObject(question.objects.back().get(), scene.nameOf(static_cast<int>(i)));
    else
      manager.bind(b.link, question.objects.back().get(), X);
  }
  fcl_artic::AllowedCollisionMatrix allowed;
  for (const auto& [a, b] : scene.allowed) allowed.allow(scene.nameOf(a), scene.nameOf(b));
  manager.setAllowedCollisions(allowed);
  fcl_artic::test::setUpWithoutNeighbours(manager);
  question.motion = motionOf(scene, *question.tree);

  fcl_artic::CertifiedRequest& request = question.request;
  request.tolerance_time = scene.tolerance_time;
  request.tolerance_distance = scene.tolerance_distance;
  request.margin = request.added_margin = 0.5 * scene.margin;  // an exact sum
  request.check_scene = scene.check_scene;
  request.check_self = scene.check_self;
  request.mode = scene.every_pair ? fcl_artic::ContactMode::firstOfEveryPair : fcl_artic::ContactMode::first;
  request.max_contacts = scene.every_pair ? 10000 : static_cast<std::size_t>(scene.max_contacts);
  return question;
}

Answer ask(const Question& question, const fcl_artic::CertifiedRequest& request) {
  Answer answer;
  answer.request = request;
  answer.objects = question.objects;
  const auto start = std::chrono::steady_clock::now();
  question.manager->continuousCollide(*question.motion, request, answer.result);
  answer.elapsed_us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  return answer;
}

}  // namespace campaign
