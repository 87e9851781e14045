// SPDX-License-Identifier: BSD-3-Clause
#include "planning/fcl_state_check.h"

#include <algorithm>
#include <set>

#include <fcl/narrowphase/collision.h>

namespace fcl_artic::planning_data {
namespace {

bool touch(const fcl::CollisionObjectd& a, const fcl::CollisionObjectd& b) {
  fcl::CollisionResultd result;
  return fcl::collide(&a, &b, fcl::CollisionRequestd(), result) > 0;
}

/// Joined by one moving joint at most, with no other link with geometry between them.
bool neighbours(const KinematicTree& tree, const std::set<LinkId>& with_geometry, LinkId a, LinkId b) {
  std::vector<LinkId> up_a{a}, up_b{b};
  for (auto* up : {&up_a, &up_b}) {
    while (tree.parentLink(up->back()) >= 0) up->push_back(tree.parentLink(up->back()));
  }
  if (up_a.back() != up_b.back()) return false;
  LinkId top = up_a.back();
  while (!up_a.empty() && !up_b.empty() && up_a.back() == up_b.back()) {
    top = up_a.back();
    up_a.pop_back();
    up_b.pop_back();
  }
  int moving = 0;
  bool bare = top == a || top == b || !with_geometry.count(top);
  for (const auto* up : {&up_a, &up_b}) {
    for (const LinkId link : *up) {
      moving += tree.joint(tree.parentJoint(link)).type != JointType::fixed;
      bare = bare && (link == a || link == b || !with_geometry.count(link));
    }
  }
  return moving <= 1 && bare;
}

bool onPair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* found) {
  return *static_cast<bool*>(found) = touch(*a, *b);
}

}  // namespace

FclStateCheck::FclStateCheck(const Robot& robot, const Scene& scene, const std::vector<CarriedObject>& carried)
    : tree_(robot.tree) {
  std::set<LinkId> with_geometry;
  for (const LinkGeometry& g : robot.geometry) {
    links_.push_back({g.link, g.offset, std::make_unique<fcl::CollisionObjectd>(*g.object)});
    with_geometry.insert(g.link);
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    for (std::size_t j = i + 1; j < links_.size(); ++j) {
      const LinkId a = links_[i].link, b = links_[j].link;
      if (a == b || robot.allowed.allowed(tree_->linkName(a), tree_->linkName(b))) continue;
      if (!neighbours(*tree_, with_geometry, a, b)) pairs_.emplace_back(i, j);
    }
  }
  for (const CarriedObject& one : carried) {
    std::set<std::string> may_touch(one.touch_links.begin(), one.touch_links.end());
    may_touch.insert(tree_->linkName(one.link));
    for (std::size_t i = 0; i < links_.size(); ++i) {
      // Links first, then the objects carried that came before this one.
      const bool is_link = i < robot.geometry.size();
      const std::string& link = tree_->linkName(links_[i].link);
      const std::string& name = is_link ? link : carried[i - robot.geometry.size()].name;
      const bool together = is_link ? may_touch.count(link) > 0 : links_[i].link == one.link;
      if (!together && !robot.allowed.allowed(name, one.name)) pairs_.emplace_back(i, links_.size());
    }
    links_.push_back({one.link, one.offset, std::make_unique<fcl::CollisionObjectd>(*one.object)});
  }
  for (const Scene::Obstacle& obstacle : scene.obstacles) {
    obstacles_.push_back(std::make_unique<fcl::CollisionObjectd>(*obstacle.object));
    obstacles_.back()->computeAABB();
    scene_.registerObject(obstacles_.back().get());
  }
  scene_.setup();
}

bool FclStateCheck::collides(const Eigen::VectorXd& q) {
  tree_->forwardKinematics(q, M_0_);
  for (Link& link : links_) {
    link.object->setTransform(M_0_[static_cast<std::size_t>(link.link)] * link.offset);
    link.object->computeAABB();
  }
  for (Link& link : links_) {
    bool found = false;
    scene_.collide(link.object.get(), &found, onPair);
    if (found) return true;
  }
  return std::any_of(pairs_.begin(), pairs_.end(), [&](const auto& pair) {
    const fcl::CollisionObjectd &a = *links_[pair.first].object, &b = *links_[pair.second].object;
    return a.getAABB().overlap(b.getAABB()) && touch(a, b);
  });
}

}  // namespace fcl_artic::planning_data
