// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic_moveit/cell.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "fcl_artic_moveit/motion.h"
#include "fcl_artic_moveit/shapes.h"
#include "numbers.h"

namespace fcl_artic_moveit {
namespace {

using collision_detection::AllowedCollisionMatrix;
using collision_detection::CollisionEnv;
using fcl_artic::JointType;
using fcl_artic::KinematicTree;
using fcl_artic::LinkId;
using moveit::core::AttachedBody;
using moveit::core::JointModelGroup;
using moveit::core::LinkModel;

std::pair<std::string, std::string> ordered(const std::string& a, const std::string& b) {
  return a < b ? std::make_pair(a, b) : std::make_pair(b, a);
}

/// Whether a joint above the link, or its own, moves with the group.
bool isMoved(const LinkModel* link, const JointModelGroup* group) {
  for (; link; link = link->getParentLinkModel()) {
    const moveit::core::JointModel* joint = link->getParentJointModel();
    if (joint && joint->getType() != moveit::core::JointModel::FIXED && movesWith(group, *joint)) return true;
  }
  return !group;  // with no group all links are looked at, also those that stand still
}

/// Number of joints that move on the way from one link to the other.
int jointsBetween(const KinematicTree& tree, LinkId a, LinkId b) {
  const auto moves = [&](LinkId link) {
    return tree.parentJoint(link) >= 0 && tree.joint(tree.parentJoint(link)).type != JointType::fixed;
  };
  std::map<LinkId, int> above;  // links above a, with the number of joints up to them
  int count = 0;
  for (LinkId link = a; link >= 0; link = tree.parentLink(link)) {
    above[link] = count;
    count += moves(link);
  }
  count = 0;
  for (LinkId link = b; link >= 0; link = tree.parentLink(link)) {
    const auto met = above.find(link);
    if (met != above.end()) return count + met->second;
    count += moves(link);
  }
  return count;
}

double paddingOf(const CollisionEnv& env, const std::string& link) {
  const double padding = env.getLinkPadding(link);
  requireAtLeast0("the padding of link '" + link + "'", padding, " m");
  return padding;
}

void requireNoScale(const CollisionEnv& env, const std::string& link) {
  const double scale = env.getLinkScale(link);
  if (scale == 1) return;
  throw std::invalid_argument("link '" + link + "' is scaled by " + std::to_string(scale) +
                              ", which is not certified: set its scale to 1 and use padding");
}

/// Whether MoveIt does not look at the pair, whatever its contacts (collisionCallback() of collision_detection_fcl).
bool alwaysAllows(const AllowedCollisionMatrix& acm, const std::string& a, const std::string& b) {
  collision_detection::AllowedCollision::Type type;
  return acm.getAllowedCollision(a, b, type) && type == collision_detection::AllowedCollision::ALWAYS;
}

bool mayTouch(const AttachedBody& body, const std::string& other) {
  return body.getTouchLinks().count(other) != 0;
}

/// A tolerance of one joint, given as rad or m, whatever its variable is.
fcl_artic::JointTolerance toleranceOf(const KinematicTree& tree, const std::string& name, double value) {
  const fcl_artic::JointId joint = tree.findJoint(name);
  if (joint < 0)
    throw std::invalid_argument("joint_tolerances: robot '" + tree.name() + "' has no joint '" + name + "'");
  switch (tree.joint(joint).type) {
    case JointType::prismatic:
      return {0, value};
    case JointType::fixed:  // which the manager refuses
    case JointType::revolute:
    case JointType::continuous:
      return {value, 0};
    case JointType::planar:
    case JointType::spherical:
    case JointType::floating:
      break;
  }
  throw std::invalid_argument("joint_tolerances: joint '" + name +
                              "' has several variables: joint_tolerance_angle and joint_tolerance_length count for it");
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const BodyName& body) {
  const char* kind[] = {"link", "attached body", "object"};
  return out << kind[body.kind] << " '" << body.id << '\'';
}

bool CellTolerances::any() const {
  const auto isAbove = [](const auto& entry) { return entry.second > 0; };
  return joints.any() || base.any() || objects > 0 || object_speed > 0 ||
         std::any_of(own.begin(), own.end(), isAbove) ||
         std::any_of(object_speeds.begin(), object_speeds.end(), isAbove);
}

Cell::Cell(moveit::core::RobotModelConstPtr model) : model_(std::move(model)) {
  if (!model_) throw std::invalid_argument("the robot model is null");
  readRobot();
}

void Cell::readRobot() {
  robot_ = toTree(*model_, mounts_, standing_);
  manager_ = std::make_shared<fcl_artic::ArticulatedCollisionManager>(robot_.tree);
  registered_.clear();
  body_margins_.clear();
  tolerances_text_.clear();
  ++robots_read_;
  for (const LinkModel* link : model_->getLinkModelsWithCollisionGeometry()) {
    if (apart_.count(link->getName())) continue;
    for (std::size_t i = 0; i < link->getShapes().size(); ++i) {
      const auto geometry = geometryOf(link->getShapes()[i], "link '" + link->getName() + "'");
      try {
        manager_->bind(link->getName(), std::make_shared<const fcl::CollisionObjectd>(geometry),
                       link->getCollisionOriginTransforms()[i]);
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("link '" + link->getName() + "': " + error.what());
      }
    }
  }
}

std::shared_ptr<fcl::CollisionGeometryd> Cell::geometryOf(const shapes::ShapeConstPtr& shape,
                                                          const std::string& owner) {
  if (!shape) throw std::invalid_argument(owner + " has a shape that is null");
  auto& known = geometry_[shape.get()];
  if (!known.second) {
    try {
      known = {shape, toFcl(*shape)};
    } catch (const std::invalid_argument& error) {
      geometry_.erase(shape.get());
      throw std::invalid_argument(owner + " has " + error.what());
    }
  }
  return known.second;
}

double Cell::paddingBetween(const fcl_artic::BodyRef& a, const fcl_artic::BodyRef& b) const {
  if (a.link >= 0 && b.link >= 0) return 0;
  return std::max(names_.at(a.name).second, names_.at(b.name).second);  // an object has none
}

std::string Cell::unused(const std::string& name) {
  std::string out = name;
  for (int k = 2; !used_.insert(out).second; ++k) out = name + "#" + std::to_string(k);
  return out;
}

std::vector<Cell::Body> Cell::linkBodies(const CollisionEnv& env, const JointModelGroup* group) const {
  std::vector<Body> out;
  for (const LinkModel* link : model_->getLinkModelsWithCollisionGeometry()) {
    requireNoScale(env, link->getName());
    Body body;
    body.name = link->getName();
    body.moveit = {BodyName::link, link->getName()};
    body.link = link;
    body.padding = paddingOf(env, link->getName());
    body.moves = isMoved(link, group);
    body.carrier = link->getName();
    out.push_back(std::move(body));
  }
  return out;
}

void Cell::addAttached(const CollisionEnv& env, const moveit::core::RobotState& state, const JointModelGroup* group,
                       std::vector<Body>& bodies) {
  std::vector<const AttachedBody*> all;
  state.getAttachedBodies(all);
  for (const AttachedBody* attached : all) {
    const LinkModel* link = attached->getAttachedLink();
    requireNoScale(env, link->getName());
    for (std::size_t i = 0; i < attached->getShapes().size(); ++i) {
      Body body;
      body.moveit = {BodyName::attached, attached->getName()};
      body.link = link;
      body.attached = attached;
      body.padding = paddingOf(env, link->getName());
      body.moves = isMoved(link, group);
      body.shape = attached->getShapes()[i];
      body.pose = attached->getShapePosesInLinkFrame()[i];
      body.carrier = link->getName();
      bodies.push_back(std::move(body));
    }
  }
}

void Cell::addObjects(const collision_detection::World& world, std::vector<Body>& bodies) {
  for (const auto& [id, object] : world) {
    for (std::size_t i = 0; i < object->shapes_.size(); ++i) {
      Body body;
      body.moveit = {BodyName::object, id};
      body.shape = object->shapes_[i];
      body.pose = object->global_shape_poses_[i];
      bodies.push_back(std::move(body));
    }
  }
}

namespace {

/// Whether a pair of bodies, at most one of them an object of the world, is to be checked.
template <class Body>
bool isChecked(const Body& a, const Body& b, const AllowedCollisionMatrix& acm) {
  if (!a.moves && !b.moves) return false;
  if (a.link && a.link == b.link && !a.attached == !b.attached) return false;  // the same link, or both carried by it
  if (alwaysAllows(acm, a.moveit.id, b.moveit.id)) return false;
  if (a.attached && mayTouch(*a.attached, b.moveit.id) && b.link) return false;
  return !(b.attached && mayTouch(*b.attached, a.moveit.id) && a.link);
}

}  // namespace

/// The manager may leave out neighbours, and does not check a body against the link that carries it. MoveIt checks
/// both, unless they are allowed. Attached objects are checked against neighbours too. So the shapes of one of two
/// neighbours become such objects, and bodies that their link may not touch are mounted on a link of their own.
/// @return whether the robot has to be read again.
bool Cell::separate(const std::vector<Body>& bodies, const AllowedCollisionMatrix& acm) {
  const std::size_t before = apart_.size() + mounts_.size();
  const KinematicTree& tree = *robot_.tree;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& a = bodies[i];
    if (!a.link || a.attached) continue;
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Body& b = bodies[j];
      if (!b.link || !isChecked(a, b, acm)) continue;
      if (b.attached) {
        if (a.link == b.link) mounts_.insert(b.link->getName());
      } else if (!apart_.count(a.name) && !apart_.count(b.name) &&
                 jointsBetween(tree, tree.linkId(a.link->getName()), tree.linkId(b.link->getName())) <= 1) {
        apart_.insert(b.name);
      }
    }
  }
  return apart_.size() + mounts_.size() != before;
}

void Cell::registerBodies(const std::vector<Body>& bodies) {
  std::map<std::string, const Body*> now;
  for (const Body& body : bodies) {
    if (body.shape) now[body.name] = &body;
  }
  for (auto it = registered_.begin(); it != registered_.end();) {
    const auto same = now.find(it->first);
    const Registered& old = it->second;
    if (same != now.end() && same->second->shape == old.shape && same->second->carrier == old.carrier &&
        same->second->pose.matrix() == old.pose.matrix()) {
      ++it;
      continue;
    }
    manager_->unregisterObject(old.object);
    manager_->resetMargins();  // its own are gone: all are set again
    body_margins_.clear();
    it = registered_.erase(it);
  }
  for (const auto& [name, body] : now) {
    if (registered_.count(name)) continue;
    const std::string owner = (body->moveit.kind == BodyName::link ? "link '"
                               : body->attached                    ? "attached body '"
                                                                   : "object '") +
                              body->moveit.id + "'";
    const auto geometry = geometryOf(body->shape, owner);
    const Eigen::Isometry3d pose = body->carrier.empty() ? body->pose : Eigen::Isometry3d::Identity();
    auto object = std::make_shared<fcl::CollisionObjectd>(geometry, pose);
    try {
      manager_->registerObject(std::shared_ptr<const fcl::CollisionObjectd>(object), name);
      if (!body->carrier.empty()) manager_->attach(body->carrier, object.get(), body->pose);
      registered_[name] = {body->shape, body->pose, body->carrier, object};
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(owner + ": " + error.what());
    }
  }
}

void Cell::setPairs(const std::vector<Body>& bodies, const AllowedCollisionMatrix& acm) {
  fcl_artic::AllowedCollisionMatrix allowed;
  const KinematicTree& tree = *robot_.tree;
  const auto mayMove = [&](const Body& a, const Body& b) {
    return jointsBetween(tree, tree.linkId(a.link->getName()), tree.linkId(b.link->getName())) > 0;
  };
  wanted_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].link) continue;
    for (std::size_t j = 0; j < bodies.size(); ++j) {
      if (i == j || (bodies[j].link && j < i)) continue;
      if (!isChecked(bodies[i], bodies[j], acm)) {
        allowed.allow(bodies[i].name, bodies[j].name);
      } else if (bodies[j].link && mayMove(bodies[i], bodies[j])) {
        wanted_.insert(ordered(bodies[i].name, bodies[j].name));
      }
    }
  }
  if (allowed.pairs() != manager_->allowedCollisions().pairs()) manager_->setAllowedCollisions(std::move(allowed));
}

void Cell::setMargins(const std::vector<Body>& bodies) {
  std::map<std::string, double> margins;
  bool any = false;
  for (const Body& body : bodies) {
    if (!body.link) continue;
    margins[body.name] = body.padding;
    any = any || body.padding > 0;
  }
  if (!any) margins.clear();
  if (margins == body_margins_) return;
  manager_->resetMargins();
  for (auto a = margins.begin(); a != margins.end(); ++a) {
    if (a->second > 0) manager_->setMargin(a->first, a->second);
    for (auto b = std::next(a); b != margins.end(); ++b) {
      if (a->second > 0 || b->second > 0) manager_->setMargin(a->first, b->first, 0);
    }
  }
  body_margins_ = std::move(margins);
}

/// Tolerances of objects go with these, and all with the manager: they are set anew each time.
void Cell::setTolerances(const std::vector<Body>& bodies, const CellTolerances& tolerances) {
  if (tolerances_text_.empty() && !tolerances.any()) return;
  manager_->resetTolerances();
  manager_->setJointTolerances(tolerances.joints);
  for (const auto& [name, value] : tolerances.own) {
    manager_->setJointTolerance(name, toleranceOf(*robot_.tree, name, value));
  }
  manager_->setBaseTolerance(tolerances.base);
  tolerances_text_ = manager_->describeTolerances();
  fcl_artic::PoseTolerance of_object;
  of_object.length = tolerances.objects;
  double fastest = 0;
  for (const Body& body : bodies) {
    if (body.moveit.kind != BodyName::object) continue;
    const auto own = tolerances.object_speeds.find(body.moveit.id);
    const double speed = own == tolerances.object_speeds.end() ? tolerances.object_speed : own->second;
    manager_->setObjectTolerance(body.name, of_object);
    manager_->setObjectSpeed(body.name, {speed, 0});
    fastest = std::max(fastest, speed);
  }
  std::ostringstream text;
  text << tolerances_text_;
  const auto comma = [&] { return text.tellp() > 0 ? ", " : ""; };
  if (tolerances.objects > 0) text << comma() << "objects " << 1000 * tolerances.objects << " mm";
  if (fastest > 0) text << comma() << "objects moving at up to " << fastest << " m/s";
  tolerances_text_ = text.str();
}

/// A pair that is wanted and not checked would go into `free` unseen.
void Cell::requireChecked() const {
  std::set<std::pair<std::string, std::string>> checked;
  for (const auto& pair : manager_->checkedLinkPairs()) checked.insert(ordered(pair.first, pair.second));
  for (const auto& pair : wanted_) {
    if (checked.count(pair)) continue;
    throw std::logic_error("'" + pair.first + "' and '" + pair.second + "' should be checked and are not");
  }
}

void Cell::update(const CollisionEnv& env, const AllowedCollisionMatrix& acm, const moveit::core::RobotState& state,
                  const JointModelGroup* group, const CellTolerances& tolerances) {
  if (env.getRobotModel() != model_ || state.getRobotModel() != model_) {
    throw std::invalid_argument("scene or trajectory are of another robot model than '" + model_->getName() + "'");
  }
  std::vector<Body> bodies = linkBodies(env, group);
  addAttached(env, state, group, bodies);
  std::set<std::string> standing;
  for (const moveit::core::JointModel* joint : model_->getJointModels()) {
    if (joint->getMimic() && !movesWith(group, *joint)) standing.insert(joint->getName());
  }
  const bool stand = standing == standing_;
  standing_ = std::move(standing);
  if (separate(bodies, acm) || !stand) readRobot();

  // Links whose shapes are apart become as many bodies; names in the manager are given in a fixed order.
  std::vector<Body> all;
  used_.clear();
  for (LinkId link = 0; link < robot_.tree->numLinks(); ++link) used_.insert(robot_.tree->linkName(link));
  addObjects(*env.getWorld(), bodies);
  for (Body& body : bodies) {
    if (body.moveit.kind == BodyName::link && !apart_.count(body.name)) {
      all.push_back(std::move(body));
      continue;
    }
    if (body.moveit.kind == BodyName::link) {
      for (std::size_t i = 0; i < body.link->getShapes().size(); ++i) {
        Body shape = body;
        shape.name = unused(body.moveit.id);
        shape.shape = body.link->getShapes()[i];
        shape.pose = body.link->getCollisionOriginTransforms()[i];
        all.push_back(std::move(shape));
      }
      continue;
    }
    body.name = unused(body.moveit.id);
    if (body.attached && mounts_.count(body.carrier)) body.carrier = mountName(body.carrier);
    all.push_back(std::move(body));
  }
  names_.clear();
  for (const Body& body : all) names_[body.name] = {body.moveit, body.padding};

  registerBodies(all);
  setPairs(all, acm);
  setMargins(all);
  setTolerances(all, tolerances);
  manager_->setup();
  requireChecked();

  // Shapes that nobody has any more.
  for (auto it = geometry_.begin(); it != geometry_.end();) {
    it = it->second.first.use_count() == 1 ? geometry_.erase(it) : std::next(it);
  }
}

}  // namespace fcl_artic_moveit
