// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/tesseract/scene.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <stdexcept>
#include <utility>

#include <tesseract/common/allowed_collision_matrix.h>
#include <tesseract/scene_graph/joint.h>
#include <tesseract/scene_graph/link.h>

#include "adapters/tesseract/geometry.h"

namespace fcl_artic {
namespace {

namespace scene_graph = ::tesseract::scene_graph;
using TesseractId = ::tesseract::common::LinkId;
using ::tesseract::common::LinkIdPair;

/// All states must name the joints that the first one names, and other joints must have a value of their own.
void requireAllNamed(const KinematicTree& tree, const std::vector<bool>& named, const std::vector<bool>& named_first,
                     std::size_t state, bool others) {
  const std::string where = "state " + std::to_string(state) + ": ";
  for (int v = 0; v < tree.dof(); ++v) {
    const auto i = static_cast<std::size_t>(v);
    if (named[i] != named_first[i]) {
      throw std::invalid_argument(where + "joint '" + tree.variableName(v) + "' is " + (named[i] ? "" : "not ") +
                                  "named, in state 0 it is" + (named[i] ? " not" : ""));
    }
    if (named[i] || others) continue;
    throw std::invalid_argument(where + "joint '" + tree.variableName(v) +
                                "' is not named: `others` says where joints stay that no state names");
  }
}

/// One geometry of a link.
struct LinkShape {
  std::string link;  ///< tesseract's
  std::string name;  ///< in the manager
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
  Eigen::Isometry3d offset;  ///< in the link's frame
  bool attached = false;
};

class Reader {
 public:
  Reader(const scene_graph::SceneGraph& graph, const ::tesseract::common::CollisionMarginData& margins)
      : graph_(graph), margins_(margins), tree_(std::make_shared<KinematicTree>(graph.getName())) {
    if (!graph.isTree()) throw std::invalid_argument("fromTesseract: scene graph '" + graph.getName() + "' is no tree");
    for (const auto& link : graph.getLinks()) names_.insert(link->getName());
    readJoints();
  }

  TesseractScene read() {
    for (const auto& link : graph_.getLinks()) readLink(*link);
    for (std::size_t a = 0; a < bodies_.size(); ++a) {
      for (std::size_t b = a + 1; b < bodies_.size(); ++b) readPair(bodies_[a], bodies_[b]);
    }
    for (const LinkShape& body : bodies_) {
      if (isStill(body) || body.attached) continue;
      tree_->addLink(body.name);
      tree_->addJoint(Joint::fixed(unused(body.name), body.link, body.name, body.offset));
    }
    scene_.tree = tree_;
    scene_.manager = std::make_shared<ArticulatedCollisionManager>(scene_.tree);
    for (const LinkShape& body : bodies_) add(body);
    scene_.manager->setAllowedCollisions(std::move(allowed_));
    setMargins();
    scene_.manager->setup();
    requireChecked();
    return std::move(scene_);
  }

 private:
  std::string unused(std::string name) {
    while (!names_.insert(name).second) name += '_';
    return name;
  }

  void readJoints() {
    // From the root on, so that the variables' order is the robot's. A joint that mimics another comes after it.
    std::deque<TesseractId> links{graph_.getRoot()};
    std::deque<std::shared_ptr<const scene_graph::Joint>> followers;
    tree_->addLink(graph_.getRoot().name());
    while (!links.empty()) {
      auto joints = graph_.getOutboundJoints(links.front());
      links.pop_front();
      std::sort(joints.begin(), joints.end(), [](const auto& a, const auto& b) { return a->getName() < b->getName(); });
      for (const auto& joint : joints) {
        tree_->addLink(joint->child_link_id.name());
        links.push_back(joint->child_link_id);
        joint->mimic ? followers.push_back(joint) : addJoint(*joint);
      }
    }
    std::set<std::string> added;
    for (JointId j = 0; j < tree_->numJoints(); ++j) added.insert(tree_->joint(j).name);
    for (std::size_t waited = 0; !followers.empty();) {
      const auto joint = followers.front();
      followers.pop_front();
      if (added.count(joint->mimic->joint_id.name())) {
        addJoint(*joint);
        added.insert(joint->getName());
        waited = 0;
      } else if (followers.push_back(joint); ++waited > followers.size()) {
        throw std::invalid_argument("fromTesseract: joint '" + joint->getName() + "' mimics '" +
                                    joint->mimic->joint_id.name() + "', which is not there");
      }
    }
  }

  void addJoint(const scene_graph::Joint& from) {
    Joint joint;
    switch (from.type) {
      case scene_graph::JointType::FIXED:
        joint.type = JointType::fixed;
        break;
      case scene_graph::JointType::REVOLUTE:
        joint.type = JointType::revolute;
        break;
      case scene_graph::JointType::CONTINUOUS:
        joint.type = JointType::continuous;
        break;
      case scene_graph::JointType::PRISMATIC:
        joint.type = JointType::prismatic;
        break;
      case scene_graph::JointType::PLANAR:
        joint.type = JointType::planar;
        break;
      case scene_graph::JointType::FLOATING:
        joint.type = JointType::floating;
        break;
      default:
        throw std::invalid_argument("fromTesseract: joint '" + from.getName() + "' is of unknown type");
    }
    joint.name = from.getName();
    joint.parent = from.parent_link_id.name();
    joint.child = from.child_link_id.name();
    joint.origin = from.parent_to_joint_origin_transform;
    joint.axis = from.axis;
    if (from.limits && (joint.type == JointType::revolute || joint.type == JointType::prismatic)) {
      joint.lower = from.limits->lower;
      joint.upper = from.limits->upper;
    }
    if (from.mimic) {
      joint.mimics = true;
      joint.mimic = {from.mimic->joint_id.name(), from.mimic->multiplier, from.mimic->offset};
    }
    tree_->addJoint(joint);
  }

  void readLink(const scene_graph::Link& link) {
    if (!graph_.getLinkCollisionEnabled(link.getId())) return;
    int count = 0;
    for (const auto& collision : link.collision) {
      if (!collision || !collision->geometry) continue;
      std::vector<std::shared_ptr<fcl::CollisionGeometryd>> geometries;
      try {
        geometries = fromTesseractGeometry(*collision->geometry);
      } catch (const std::invalid_argument& e) {
        throw std::invalid_argument("fromTesseract: link '" + link.getName() + "': " + e.what());
      }
      for (auto& geometry : geometries) {
        LinkShape body;
        body.link = link.getName();
        body.name = unused(link.getName() + "/" + std::to_string(count++));
        body.geometry = std::move(geometry);
        body.offset = collision->origin;
        bodies_.push_back(std::move(body));
      }
    }
  }

  /// The link that moves this one: the nearest at or above it that a joint moves; the root's if none does.
  LinkId group(LinkId link) const {
    while (tree_->parentJoint(link) >= 0 && tree_->joint(tree_->parentJoint(link)).type == JointType::fixed) {
      link = tree_->parentLink(link);
    }
    return link;
  }
  LinkId groupOf(const LinkShape& body) const { return group(tree_->linkId(body.link)); }
  bool isStill(const LinkShape& body) const { return tree_->parentJoint(groupOf(body)) < 0; }

  void readPair(LinkShape& a, LinkShape& b) {
    if (a.link == b.link) {
      allowed_.allow(a.name, b.name);
      return;
    }
    if (graph_.isCollisionAllowed(LinkIdPair(TesseractId(a.link), TesseractId(b.link)))) {
      allowed_.allow(a.name, b.name);
      return;
    }
    const LinkId x = groupOf(a), y = groupOf(b);
    if (x == y) {
      allowed_.allow(a.name, b.name);
      const std::string note = "links '" + std::min(a.link, b.link) + "' and '" + std::max(a.link, b.link) +
                               "' are not checked: no joint moves them against each other";
      if (std::find(scene_.notes.begin(), scene_.notes.end(), note) == scene_.notes.end()) scene_.notes.push_back(note);
      return;
    }
    if (isStill(a) || isStill(b)) return;  // one of them an obstacle
    checked_.emplace(std::min(a.name, b.name), std::max(a.name, b.name));
    if (a.attached || b.attached) return;
    // If one joint lies between them, they are neighbours, whom a manager may leave out, unless one is attached.
    const auto above = [&](LinkId child) { return group(tree_->parentLink(child)); };
    if (above(x) == y) a.attached = true;
    if (above(y) == x) b.attached = true;
  }

  void add(const LinkShape& body) {
    std::vector<Eigen::Isometry3d> M_0;
    tree_->forwardKinematics(tree_->neutralConfiguration(), M_0);
    const Eigen::Isometry3d pose = M_0[static_cast<std::size_t>(tree_->linkId(body.link))] * body.offset;
    try {
      auto object = std::make_shared<fcl::CollisionObjectd>(body.geometry, pose);
      if (isStill(body)) {
        scene_.manager->registerObject(object, body.name);
      } else if (body.attached) {
        scene_.manager->registerObject(object, body.name);
        scene_.manager->attach(body.link, object, body.offset);
      } else {
        scene_.manager->bind(body.name, object);
      }
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument("fromTesseract: link '" + body.link + "': " + e.what());
    }
  }

  void setMargins() {
    const double most = margins_.getMaxCollisionMargin();
    if (!(most > 0)) return;
    scene_.has_margins = true;
    const double other = std::max(margins_.getDefaultCollisionMargin(), 0.0);
    for (const LinkShape& a : bodies_) {
      scene_.manager->setMargin(a.name, other);
      for (const LinkShape& b : bodies_) {
        const auto own = margins_.getCollisionMarginPairData().getCollisionMargin(
            LinkIdPair(TesseractId(a.link), TesseractId(b.link)));
        if (own && a.name < b.name) scene_.manager->setMargin(a.name, b.name, std::max(*own, 0.0));
      }
    }
  }

  /// Every pair that moves and is neither allowed nor noted is checked, or nothing is returned at all.
  void requireChecked() const {
    std::set<std::pair<std::string, std::string>> pairs;
    for (const auto& [a, b] : scene_.manager->checkedLinkPairs()) pairs.insert(std::minmax(a, b));
    for (const auto& [a, b] : checked_) {
      if (!pairs.count({a, b})) throw std::logic_error("fromTesseract: pair '" + a + "', '" + b + "' is not checked");
    }
  }

  const scene_graph::SceneGraph& graph_;
  const ::tesseract::common::CollisionMarginData& margins_;
  std::shared_ptr<KinematicTree> tree_;
  std::set<std::string> names_;
  std::vector<LinkShape> bodies_;
  std::set<std::pair<std::string, std::string>> checked_;  ///< names of bodies, the lesser one first
  AllowedCollisionMatrix allowed_;
  TesseractScene scene_;
};

}  // namespace

TesseractScene fromTesseract(const scene_graph::SceneGraph& graph,
                             const ::tesseract::common::CollisionMarginData& margins) {
  return Reader(graph, margins).read();
}

JointTrajectory TesseractScene::trajectory(const ::tesseract::common::JointTrajectory& trajectory,
                                           const Eigen::VectorXd& others) const {
  if (trajectory.states.size() < 2) {
    throw std::invalid_argument("the trajectory has " + std::to_string(trajectory.states.size()) +
                                " states, two are the least");
  }
  const Eigen::VectorXd start = others.size() == 0 ? tree->neutralConfiguration() : others;
  tree->requireConfiguration(start, "others");
  std::vector<double> times;
  std::vector<Eigen::VectorXd> waypoints;
  std::vector<bool> named_first;  // variables that state 0 names
  bool increasing = true;
  for (std::size_t i = 0; i < trajectory.states.size(); ++i) {
    const auto& state = trajectory.states[i];
    const std::string where = "state " + std::to_string(i) + ": ";
    if (state.position.size() != static_cast<Eigen::Index>(state.joint_ids.size())) {
      throw std::invalid_argument(where + std::to_string(state.position.size()) + " positions for " +
                                  std::to_string(state.joint_ids.size()) + " joints");
    }
    Eigen::VectorXd q = start;
    std::vector<bool> named(static_cast<std::size_t>(tree->dof()));
    for (std::size_t k = 0; k < state.joint_ids.size(); ++k) {
      const std::string& name = state.joint_ids[k].name();
      const int variable = tree->findVariable(name);
      if (variable < 0) {
        throw std::invalid_argument(where + "'" + name + "' is no joint with one variable of its own");
      }
      if (named[static_cast<std::size_t>(variable)]) {
        throw std::invalid_argument(where + "joint '" + name + "' is named twice");
      }
      named[static_cast<std::size_t>(variable)] = true;
      q[variable] = state.position[static_cast<Eigen::Index>(k)];
      if (!std::isfinite(q[variable])) {
        throw std::invalid_argument(where + "the position of joint '" + name + "' is not finite");
      }
    }
    if (i == 0) named_first = named;
    requireAllNamed(*tree, named, named_first, i, others.size() > 0);
    waypoints.push_back(std::move(q));
    increasing = increasing && std::isfinite(state.time) && (times.empty() || state.time > times.back());
    times.push_back(state.time);
  }
  if (!increasing) {
    for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<double>(i);
  }
  return JointTrajectory::linear(*tree, times, waypoints);
}

CertifiedResult TesseractScene::certify(const ::tesseract::common::JointTrajectory& asked,
                                        const CertifiedRequest& request, const Eigen::VectorXd& others) const {
  if (has_margins && request.margin > 0) {
    throw std::invalid_argument("certify: tesseract's margins replace request.margin, which is " +
                                std::to_string(request.margin) + "; request.added_margin is added to them");
  }
  return manager->continuousCollide(trajectory(asked, others), request);
}

}  // namespace fcl_artic
