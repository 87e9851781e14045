// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <algorithm>
#include <cmath>

namespace campaign {

std::string Scene::nameOf(int body) const {
  const Body& b = bodies[static_cast<std::size_t>(body)];
  return b.link >= 0 ? "link" + std::to_string(b.link) : "body" + std::to_string(body);
}

void Scene::allow(int a, int b) {
  const int n = static_cast<int>(bodies.size());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j && nameOf(i) == nameOf(a) && nameOf(j) == nameOf(b)) allowed.insert(std::minmax(i, j));
}

Kinematics::Kinematics(const Scene& scene) : scene_(scene), variable_(scene.links.size(), -1) {
  int next = 0;
  std::vector<bool> wraps;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    const Link& l = scene.links[i];
    if (l.hasVariable()) {
      variable_[i] = next++;
      wraps.push_back(scene.shortest && l.joint == JointKind::continuous);
    } else if (l.parent >= 0 && l.joint != JointKind::fixed) {
      variable_[i] = variable_[static_cast<std::size_t>(l.master)];
    }
  }
  for (std::size_t v = 0; v < scene.q0.size(); ++v) {
    double d = scene.q1[v] - scene.q0[v];
    if (wraps[v]) d = std::remainder(d, 2 * M_PI);
    dq_.push_back(d);
  }
}

double Kinematics::jointValue(int link, double t) const {
  const Link& l = scene_.links[static_cast<std::size_t>(link)];
  const int v = variable_[static_cast<std::size_t>(link)];
  if (v < 0) return 0;
  const double q = scene_.q0[static_cast<std::size_t>(v)] + t * dq_[static_cast<std::size_t>(v)];
  return l.master < 0 ? q : l.multiplier * q + l.offset;
}

Pose Kinematics::linkPose(int link, double t) const {
  const Link& l = scene_.links[static_cast<std::size_t>(link)];
  if (l.parent < 0) return {};
  Pose step;
  const double q = jointValue(link, t);
  if (l.joint == JointKind::prismatic) step.p = q * l.axis;
  if (l.joint == JointKind::revolute || l.joint == JointKind::continuous) step.R = rotationAbout(l.axis, q);
  return linkPose(l.parent, t) * (l.origin * step);
}

Pose Kinematics::bodyPose(int body, double t) const {
  const Body& b = scene_.bodies[static_cast<std::size_t>(body)];
  return b.link < 0 ? b.pose : linkPose(b.link, t) * b.pose;
}

std::vector<int> Kinematics::ancestors(int link) const {
  std::vector<int> chain;
  for (int l = link; l >= 0; l = scene_.links[static_cast<std::size_t>(l)].parent) chain.push_back(l);
  return chain;
}

double Kinematics::speedAgainst(int body, int ancestor) const {
  const Body& b = scene_.bodies[static_cast<std::size_t>(body)];
  double speed = 0;
  double reach = (b.pose * b.geometry->centre()).norm() + b.geometry->radius();  // from the link's origin
  for (int l = b.link; l >= 0 && l != ancestor; l = scene_.links[static_cast<std::size_t>(l)].parent) {
    const Link& link = scene_.links[static_cast<std::size_t>(l)];
    if (link.parent < 0) break;
    const double rate = std::abs(jointValue(l, 1) - jointValue(l, 0));
    if (link.joint == JointKind::prismatic) {
      speed += rate;
      reach += std::max(std::abs(jointValue(l, 0)), std::abs(jointValue(l, 1)));
    } else {
      speed += rate * reach;
    }
    reach += link.origin.p.norm();
  }
  return speed;
}

double Kinematics::relativeSpeed(int a, int b) const {
  // Seen from the nearest common ancestor both bodies move at most at these speeds.
  const std::vector<int> chain_a = ancestors(scene_.bodies[static_cast<std::size_t>(a)].link);
  const std::vector<int> chain_b = ancestors(scene_.bodies[static_cast<std::size_t>(b)].link);
  const auto common = std::find_first_of(chain_a.begin(), chain_a.end(), chain_b.begin(), chain_b.end());
  const int frame = common == chain_a.end() ? -1 : *common;
  return (1 + 1e-9) * (speedAgainst(a, frame) + speedAgainst(b, frame)) + 1e-12;
}

bool Kinematics::hasBody(int link) const {
  return std::any_of(scene_.bodies.begin(), scene_.bodies.end(), [&](const Body& b) { return b.link == link; });
}

/// The nearest link at or above this one that a joint moves; -1: the world, which also carries obstacles (link -1).
int Kinematics::carrier(int link) const {
  while (link >= 0) {
    const Link& l = scene_.links[static_cast<std::size_t>(link)];
    if (l.parent >= 0 && l.joint != JointKind::fixed) break;
    link = l.parent;
  }
  return link;
}

/// Whether the library leaves the pair out by itself: at most one joint that can move, and nothing but links without
/// geometry, lie between.
bool Kinematics::joined(int link_a, int link_b) const {
  const std::vector<int> up_a = ancestors(link_a), up_b = ancestors(link_b);
  const auto common = std::find_first_of(up_a.begin(), up_a.end(), up_b.begin(), up_b.end());
  if (common == up_a.end()) return false;
  int moving = 0;
  for (const int end : {link_a, link_b})
    for (int l = end; l != *common; l = scene_.links[static_cast<std::size_t>(l)].parent) {
      if (l != end && hasBody(l)) return false;
      moving += scene_.links[static_cast<std::size_t>(l)].joint != JointKind::fixed;
    }
  if (*common != link_a && *common != link_b && hasBody(*common)) return false;
  return moving <= 1;
}

std::vector<std::pair<int, int>> Kinematics::pairs() const {
  std::vector<std::pair<int, int>> r;
  const int n = static_cast<int>(scene_.bodies.size());
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const int a = scene_.bodies[static_cast<std::size_t>(i)].link,
                b = scene_.bodies[static_cast<std::size_t>(j)].link;
      if (a == b || scene_.allowed.count({i, j})) continue;  // of one link, or both obstacles
      const bool self = a >= 0 && b >= 0;
      if (!(self ? scene_.check_self : scene_.check_scene)) continue;
      if (carrier(a) == carrier(b)) continue;  // stand still against each other
      if (self && joined(a, b)) continue;
      r.emplace_back(i, j);
    }
  return r;
}

}  // namespace campaign
