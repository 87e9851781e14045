// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/narrowphase/collision.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"

namespace fcl_artic {
namespace {

using detail::fail;
using LinkPair = std::pair<LinkId, LinkId>;
constexpr double kPi = 3.141592653589793;

/// A link's name from an attribute. @throws std::runtime_error when it is missing or unknown.
std::string linkName(const std::string& where, const tinyxml2::XMLElement& element, const char* attribute,
                     const KinematicTree& tree) {
  const std::string line = where + ", line " + std::to_string(element.GetLineNum());
  const char* name = element.Attribute(attribute);
  if (!name) fail(line, std::string("<") + element.Name() + "> has no attribute '" + attribute + "'");
  if (!tree.hasLink(name)) {
    fail(line, std::string("<") + element.Name() + "> names link '" + name + "', which robot '" + tree.name() +
                   "' does not have");
  }
  return name;
}

/// Pairs of links with geometry that a joint connects, or several joints over links without geometry.
std::set<LinkPair> adjacentPairs(const KinematicTree& tree, const std::vector<bool>& has_geometry) {
  std::vector<std::vector<LinkId>> neighbours(static_cast<std::size_t>(tree.numLinks()));
  for (LinkId link = 0; link < tree.numLinks(); ++link) {
    if (const LinkId parent = tree.parentLink(link); parent >= 0) {
      neighbours[link].push_back(parent);
      neighbours[parent].push_back(link);
    }
  }
  std::set<LinkPair> pairs;
  for (LinkId start = 0; start < tree.numLinks(); ++start) {
    if (!has_geometry[start]) continue;
    std::set<LinkId> seen = {start};
    std::vector<LinkId> open = neighbours[start];
    while (!open.empty()) {
      const LinkId link = open.back();
      open.pop_back();
      if (!seen.insert(link).second) continue;
      if (has_geometry[link]) {
        pairs.insert(std::minmax(start, link));
      } else {
        open.insert(open.end(), neighbours[link].begin(), neighbours[link].end());
      }
    }
  }
  return pairs;
}

/// Range that variable v is drawn from; lengths without limits stay at 0, quaternions are normalised afterwards.
std::pair<double, double> samplingRange(const KinematicTree& tree, int v) {
  const Joint& joint = tree.joint(tree.variableJoint(v));
  if (KinematicTree::numVariables(joint.type) > 1) {
    const int quaternion = tree.quaternionVariable(tree.variableJoint(v));
    if (quaternion >= 0 && v >= quaternion) return {-1, 1};
    return tree.isAngle(v) ? std::make_pair(-kPi, kPi) : std::make_pair(0.0, 0.0);
  }
  if (hasLimits(joint)) return {joint.lower, joint.upper};
  return joint.type == JointType::prismatic ? std::make_pair(0.0, 0.0) : std::make_pair(-kPi, kPi);
}

/// Static collisions of a robot's links, by FCL.
class LinkCollider {
 public:
  explicit LinkCollider(const Robot& robot)
      : robot_(robot), of_link_(static_cast<std::size_t>(robot.tree->numLinks())) {
    for (const LinkGeometry& g : robot.geometry) of_link_.at(static_cast<std::size_t>(g.link)).push_back(&g);
  }

  void setConfiguration(const Eigen::VectorXd& q) { robot_.tree->forwardKinematics(q, M_0_); }

  bool touch(const LinkPair& pair) const {
    for (const LinkGeometry* a : of_link_[pair.first]) {
      for (const LinkGeometry* b : of_link_[pair.second]) {
        fcl::CollisionResultd result;
        if (fcl::collide(a->object->collisionGeometry().get(), M_0_[pair.first] * a->offset,
                         b->object->collisionGeometry().get(), M_0_[pair.second] * b->offset, fcl::CollisionRequestd(),
                         result) > 0) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  const Robot& robot_;
  std::vector<std::vector<const LinkGeometry*>> of_link_;
  std::vector<Eigen::Isometry3d> M_0_;
};

}  // namespace

AllowedCollisionMatrix loadSrdf(const std::string& path, const KinematicTree& tree) {
  const std::string where = "'" + path + "'";
  const std::string xml = files::read(path);
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.c_str(), xml.size()) != tinyxml2::XML_SUCCESS) fail(where, document.ErrorStr());
  const tinyxml2::XMLElement* robot = document.RootElement();
  if (!robot || std::string(robot->Name()) != "robot") {
    fail(where, "is not an SRDF: the root element is not <robot>");
  }
  const auto forEach = [&](const char* name, auto&& visit) {
    for (auto* e = robot->FirstChildElement(name); e; e = e->NextSiblingElement(name)) visit(*e);
  };

  // In MoveIt's order of precedence: a pair that is named wins over a link's default, and disabled wins over enabled.
  AllowedCollisionMatrix matrix;
  forEach("disable_default_collisions", [&](const tinyxml2::XMLElement& e) {
    const std::string link = linkName(where, e, "link", tree);
    for (LinkId other = 0; other < tree.numLinks(); ++other) {
      if (tree.linkName(other) != link) matrix.allow(link, tree.linkName(other));
    }
  });
  forEach("enable_collisions", [&](const tinyxml2::XMLElement& e) {
    matrix.disallow(linkName(where, e, "link1", tree), linkName(where, e, "link2", tree));
  });
  forEach("disable_collisions", [&](const tinyxml2::XMLElement& e) {
    matrix.allow(linkName(where, e, "link1", tree), linkName(where, e, "link2", tree));
  });
  return matrix;
}

std::vector<AllowedPair> generateAllowedCollisions(const Robot& robot, int samples, std::uint64_t seed) {
  if (!robot.tree) throw std::invalid_argument("generateAllowedCollisions: the robot has no tree");
  const KinematicTree& tree = *robot.tree;
  if (samples < 1) {
    throw std::invalid_argument("generateAllowedCollisions: samples is " + std::to_string(samples) +
                                ", must be positive");
  }
  std::vector<bool> has_geometry(static_cast<std::size_t>(tree.numLinks()));
  for (const LinkGeometry& g : robot.geometry) has_geometry.at(static_cast<std::size_t>(g.link)) = true;

  std::vector<AllowedPair> allowed;
  const auto allow = [&](const LinkPair& pair, const char* reason) {
    allowed.push_back({tree.linkName(pair.first), tree.linkName(pair.second), reason});
  };
  const std::set<LinkPair> adjacent = adjacentPairs(tree, has_geometry);
  // Planar and floating joints slide without bounds: neighbourhood and samples say nothing of links on both sides of
  // one.
  std::vector<LinkId> part(static_cast<std::size_t>(tree.numLinks()));
  for (const LinkId link : tree.topologicalOrder()) {
    const JointId j = tree.parentJoint(link);
    const JointType type = j < 0 ? JointType::floating : tree.joint(j).type;
    const bool slides = type == JointType::floating || type == JointType::planar;
    part[static_cast<std::size_t>(link)] = slides ? link : part[static_cast<std::size_t>(tree.parentLink(link))];
  }

  const auto together = [&](const LinkPair& pair) {
    return part[static_cast<std::size_t>(pair.first)] == part[static_cast<std::size_t>(pair.second)];
  };
  for (const LinkPair& pair : adjacent) {
    if (together(pair)) allow(pair, "Adjacent");
  }

  std::vector<std::pair<double, double>> ranges;
  Eigen::VectorXd q(tree.dof());
  for (int v = 0; v < tree.dof(); ++v) {
    const auto [lower, upper] = ranges.emplace_back(samplingRange(tree, v));
    // Where 0 is beyond the limits, contacts at 0 would excuse pairs that never pass there.
    q[v] = lower <= 0 && upper >= 0 ? 0 : (lower + upper) / 2;
  }
  const auto normaliseQuaternions = [&] {
    for (JointId j = 0; j < tree.numJoints(); ++j) {
      const int v = tree.quaternionVariable(j);
      if (v < 0) continue;
      const double length = q.segment<4>(v).norm();
      q.segment<4>(v) = length > 0.1 ? Eigen::Vector4d(q.segment<4>(v) / length) : Eigen::Vector4d(0, 0, 0, 1);
    }
  };
  normaliseQuaternions();

  struct Candidate {
    LinkPair pair;
    bool touches;  ///< in the first sample; as long as it is a candidate, in all of them
  };
  std::vector<Candidate> candidates;
  LinkCollider collider(robot);
  collider.setConfiguration(q);
  for (LinkId a = 0; a < tree.numLinks(); ++a) {
    for (LinkId b = a + 1; b < tree.numLinks(); ++b) {
      if (!has_geometry[a] || !has_geometry[b] || adjacent.count({a, b})) continue;
      if (!together({a, b})) continue;
      if (collider.touch({a, b})) {
        allow({a, b}, "Default");
      } else {
        candidates.push_back({{a, b}, false});
      }
    }
  }

  std::mt19937_64 random(seed);
  for (int sample = 0; sample < samples && !candidates.empty(); ++sample) {
    for (int v = 0; v < tree.dof(); ++v) {
      // The standard's own distribution differs between its implementations.
      const double u = std::ldexp(static_cast<double>(random() >> 11), -53);
      q[v] = ranges[v].first + u * (ranges[v].second - ranges[v].first);
    }
    normaliseQuaternions();
    collider.setConfiguration(q);
    for (Candidate& candidate : candidates) {
      const bool touches = collider.touch(candidate.pair);
      if (sample == 0) candidate.touches = touches;
      if (touches != candidate.touches) candidate.pair = {-1, -1};  // touches here and not there: needs its checks
    }
    candidates.erase(
        std::remove_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.pair.first < 0; }),
        candidates.end());
  }
  for (const Candidate& c : candidates) allow(c.pair, c.touches ? "Always" : "Never");
  return allowed;
}

void writeSrdf(const std::string& path, const std::string& robot_name, const std::vector<AllowedPair>& pairs) {
  tinyxml2::XMLDocument document;
  document.InsertEndChild(document.NewDeclaration());
  tinyxml2::XMLElement* robot = document.NewElement("robot");
  robot->SetAttribute("name", robot_name.c_str());
  document.InsertEndChild(robot);
  for (const AllowedPair& pair : pairs) {
    tinyxml2::XMLElement* element = robot->InsertNewChildElement("disable_collisions");
    element->SetAttribute("link1", pair.link1.c_str());
    element->SetAttribute("link2", pair.link2.c_str());
    element->SetAttribute("reason", pair.reason.c_str());
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  files::write(path, printer.CStr());
}

}  // namespace fcl_artic
