// SPDX-License-Identifier: BSD-3-Clause
#include "setup/registry.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

#include "fcl/fcl_geometry.h"
#include "numerics/assertion.h"
#include "setup/neighbour_findings.h"
#include "setup/neighbours.h"
#include "text/nearest_name.h"

namespace fcl_artic {
namespace {

/// The body that matches.
/// @throws std::invalid_argument saying `missing` where none does.
template <class Matches>
std::vector<ManagedBody>::iterator requireIf(std::vector<ManagedBody>& bodies, const Matches& matches,
                                             const char* missing) {
  const auto body = std::find_if(bodies.begin(), bodies.end(), matches);
  if (body == bodies.end()) throw std::invalid_argument(missing);
  return body;
}

/// The body with this object.
std::vector<ManagedBody>::iterator require(std::vector<ManagedBody>& bodies, const fcl::CollisionObjectd* object,
                                           const char* missing) {
  return requireIf(
      bodies, [&](const ManagedBody& b) { return object && b.object == object; }, missing);
}
std::vector<ManagedBody>::iterator require(std::vector<ManagedBody>& bodies,
                                           const fcl::ContinuousCollisionObjectd* object, const char* missing) {
  return requireIf(
      bodies, [&](const ManagedBody& b) { return object && b.moving == object; }, missing);
}

std::vector<std::string> linkNames(const KinematicTree& tree) {
  std::vector<std::string> names;
  for (LinkId link = 0; link < tree.numLinks(); ++link) names.push_back(tree.linkName(link));
  return names;
}

}  // namespace

Registry::Registry(std::shared_ptr<const KinematicTree> tree) : tree_(std::move(tree)) {
  if (!tree_) throw std::invalid_argument("ArticulatedCollisionManager: the kinematic tree is null");
}

std::set<LinkId> Registry::linksWithGeometry() const {
  std::set<LinkId> with_geometry;
  for (const ManagedBody& link : links_) {
    if (!link.attached) with_geometry.insert(link.link);
  }
  return with_geometry;
}

const ManagedBody& Registry::body(std::int32_t number) const {
  FCL_ARTIC_ASSERT(number >= 0 &&
                   static_cast<std::size_t>(number) < links_.size() + moving_.size() + obstacles_.size());
  std::size_t i = static_cast<std::size_t>(number);
  if (i < links_.size()) return links_[i];
  i -= links_.size();
  return i < moving_.size() ? moving_[i] : obstacles_[i - moving_.size()];
}

void Registry::requireNew(const void* object, const std::string& what) const {
  if (!object) throw std::invalid_argument(what + ": the object is null");
  if (!objects_.count(object)) return;
  for (const Bodies* bodies : {&obstacles_, &links_, &moving_}) {
    for (const ManagedBody& b : *bodies) {
      if (b.object == object || b.moving == object) {
        throw std::invalid_argument(what + ": the object is there already, as '" + b.name + "'");
      }
    }
  }
}

LinkId Registry::requireLink(const LinkRef& link, const std::string& what) const {
  if (!link.byName()) {
    if (link.id() >= 0 && link.id() < tree_->numLinks()) return link.id();
    throw std::invalid_argument(what + ": robot '" + tree_->name() + "' has no link " + std::to_string(link.id()));
  }
  const std::string name(link.name());
  if (tree_->hasLink(name)) return tree_->linkId(name);
  throw std::invalid_argument(what + ": robot '" + tree_->name() + "' has no link '" + name + "'" +
                              text::didYouMean(name, linkNames(*tree_)));
}

void Registry::requireLinks() const {
  for (const ManagedBody& body : links_) {
    requireLink(body.link, "setup");
    if (body.attached || tree_->linkName(body.link) == body.name) continue;
    throw std::invalid_argument("setup: link " + std::to_string(body.link) + " of robot '" + tree_->name() +
                                "', which carries geometry, was '" + body.name + "' and is '" +
                                tree_->linkName(body.link) + "' now");
  }
}

void Registry::requireBody(const std::string& name, const std::string& what) const {
  if (tree_->hasLink(name) || obstacle_names_.count(name)) return;
  std::vector<std::string> names = linkNames(*tree_);
  names.insert(names.end(), obstacle_names_.begin(), obstacle_names_.end());
  std::sort(names.begin(), names.end());  // the same hint in each run
  throw std::invalid_argument(what + ": '" + name + "' is no link of robot '" + tree_->name() + "' and no obstacle" +
                              text::didYouMean(name, names));
}

void Registry::requireObject(const std::string& name, const std::string& what) const {
  requireBody(name, what);
  if (tree_->hasLink(name))
    throw std::invalid_argument(what + ": '" + name + "' is a link: set its joints' tolerances");
}

/// The name as given or chosen. It must not be a link's: allowed pairs and margins go by names, so the link's would
/// hold for the obstacle too.
std::string Registry::obstacleName(const std::string& name) const {
  std::string shown = name.empty() ? "obstacle" + std::to_string(named_) : name;
  if (obstacle_names_.count(shown)) throw std::invalid_argument("obstacle '" + shown + "': the name is taken");
  if (tree_->hasLink(shown)) {
    throw std::invalid_argument("obstacle '" + shown + "': the name is that of a link of robot '" + tree_->name() +
                                "'");
  }
  return shown;
}

ManagedBody Registry::newBody(const fcl::CollisionObjectd* object, const std::string& what) const {
  requireNew(object, what);
  ManagedBody body;
  body.object = object;
  body.readShape(what);
  return body;
}

void Registry::addObstacle(Bodies& bodies, ManagedBody body) {
  body.readObstacle();
  objects_.insert(body.object ? static_cast<const void*>(body.object) : body.moving);
  obstacle_names_.insert(body.name);
  bodies.push_back(std::move(body));
  ++named_;
}

void Registry::forget(Bodies& bodies, Bodies::iterator body) {
  objects_.erase(body->object);
  objects_.erase(body->moving);
  const std::string name = body->isObstacle() ? body->name : std::string();
  bodies.erase(body);
  if (obstacle_names_.erase(name) > 0) keepNames([&](const std::string& other) { return other != name; });
}

void Registry::keepNames(const std::function<bool(const std::string& body)>& isKept) {
  margins_.keep(isKept);
  tolerances_.keep(isKept);
  const auto isGone = [&](const auto& pair) { return !isKept(pair.first) || !isKept(pair.second); };
  const auto haveGone = [&](const AllowedCollisionMatrix::Pairs& pairs) {
    return std::any_of(pairs.begin(), pairs.end(), isGone);
  };
  if (!haveGone(allowed_.pairs()) && !haveGone(allowed_.disallowedPairs())) return;
  AllowedCollisionMatrix kept;
  kept.setComplete(allowed_.complete());
  for (const auto& pair : allowed_.pairs()) {
    if (!isGone(pair)) kept.allow(pair.first, pair.second);
  }
  for (const auto& pair : allowed_.disallowedPairs()) {
    if (!isGone(pair)) kept.disallow(pair.first, pair.second);
  }
  allowed_ = std::move(kept);
}

void Registry::setAllowed(AllowedCollisionMatrix matrix) {
  for (const auto* pairs : {&matrix.pairs(), &matrix.disallowedPairs()}) {
    for (const auto& [a, b] : *pairs) {
      requireBody(a, "setAllowedCollisions");
      requireBody(b, "setAllowedCollisions");
    }
  }
  allowed_ = std::move(matrix);
}

bool Registry::areOpenNeighbours(const std::set<LinkId>& with_geometry, LinkId a, LinkId b) const {
  return carrierOf(*tree_, a) != carrierOf(*tree_, b) && areNeighbours(*tree_, with_geometry, a, b) &&
         !allowed_.mustBeChecked(tree_->linkName(a), tree_->linkName(b));
}

bool Registry::standStill(const ManagedBody& a, const ManagedBody& b) const {
  if (a.moving || b.moving || carrierOf(*tree_, a.link) != carrierOf(*tree_, b.link)) return false;
  const AllowedCollisionMatrix::Pairs& asked = allowed_.disallowedPairs();
  return asked.empty() || asked.count(std::minmax(a.name, b.name)) == 0;
}

Excuse Registry::excuseOf(const ManagedBody& a, const ManagedBody& b) const {
  // before the pairs that callers allow: `free` names no exception for pairs that stand still
  if (standStill(a, b)) return Excuse::still;
  if (allowed_.allowed(a.name, b.name)) return Excuse::allowed;
  if (a.mayTouchLink(b) || b.mayTouchLink(a)) return Excuse::touch_link;
  if (a.attached || b.attached || !neighbours_) return Excuse::none;
  return neighbours_->leavesOut(*tree_, a, b) ? Excuse::neighbours : Excuse::none;
}

NamedMargins Registry::marginsOfNeighbours() const {
  NamedMargins margins;
  if (!neighbours_) return margins;
  for (const auto& [links, pair] : neighbours_->pairs) {
    const LinkPairFinding& found = pair.finding;
    if (pair.isChecked() && !allowed_.allowed(found.link1, found.link2)) margins.set(found.link1, found.link2, 0);
  }
  return margins;
}

NamedMargins Registry::margins() const {
  NamedMargins margins = margins_;
  const NamedMargins of_neighbours = marginsOfNeighbours();
  for (const auto& [names, margin] : of_neighbours.ofPairs()) {
    if (margins_.ofPairs().count(names) == 0) margins.set(names.first, names.second, margin);
  }
  return margins;
}

void Registry::allow(const std::string& a, const std::string& b) {
  requireBody(a, "allow");
  requireBody(b, "allow");
  allowed_.allow(a, b);
}

void Registry::disallow(const std::string& a, const std::string& b) {
  requireBody(a, "disallow");
  requireBody(b, "disallow");
  allowed_.disallow(a, b);
}

void Registry::registerObject(const ObjectRef<fcl::CollisionObjectd>& object, const std::string& name) {
  const std::string shown = obstacleName(name);
  ManagedBody body = newBody(object.get(), "obstacle '" + shown + "'");
  body.name = shown;
  body.owner = object.share();
  addObstacle(obstacles_, std::move(body));
}

void Registry::registerObject(const ObjectRef<fcl::ContinuousCollisionObjectd>& object, const std::string& name) {
  ManagedBody body;
  body.name = obstacleName(name);
  requireNew(object.get(), "obstacle '" + body.name + "'");
  body.moving = object.get();
  body.owner = object.share();
  addObstacle(moving_, std::move(body));
}

void Registry::registerObjects(const std::vector<fcl::CollisionObjectd*>& objects) {
  const std::size_t before = obstacles_.size(), named = named_;
  try {
    for (const fcl::CollisionObjectd* object : objects) registerObject(object, {});
  } catch (...) {
    while (obstacles_.size() > before) forget(obstacles_, obstacles_.end() - 1);
    named_ = named;
    throw;
  }
}

void Registry::replaceObstacles(const std::vector<std::shared_ptr<const fcl::CollisionObjectd>>& objects,
                                const std::vector<std::string>& names) {
  if (!names.empty() && names.size() != objects.size()) {
    throw std::invalid_argument("replaceObstacles: there are " + std::to_string(names.size()) + " names for " +
                                std::to_string(objects.size()) + " objects");
  }
  requireLinks();
  // Objects and names that stay. (Sets are made anew: taking thousands out of them one by one takes longer than all the
  // rest.)
  std::unordered_set<const void*> known;
  std::unordered_set<std::string> taken;
  known.reserve(links_.size() + moving_.size() + objects.size());
  taken.reserve(known.bucket_count());
  for (const Bodies* bodies : {&links_, &moving_}) {
    for (const ManagedBody& body : *bodies) {
      known.insert(body.object ? static_cast<const void*>(body.object) : body.moving);
      if (body.isObstacle()) taken.insert(body.name);
    }
  }
  // Obstacles that are read already. (If the scene shares no object with the last one, there are none.)
  std::unordered_map<const void*, const ManagedBody*> before;
  const auto isKnown = [&](const auto& object) { return objects_.count(object.get()) > 0; };
  if (std::any_of(objects.begin(), objects.end(), isKnown)) {
    for (const ManagedBody& obstacle : obstacles_) before.emplace(obstacle.object, &obstacle);
  }
  Bodies fresh;
  fresh.reserve(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const bool named = !names.empty() && !names[i].empty();
    ManagedBody body;
    body.name = named ? names[i] : "obstacle" + std::to_string(i);
    const std::string what = "obstacle '" + body.name + "'";
    if (!objects[i]) throw std::invalid_argument(what + ": the object is null");
    if (!taken.insert(body.name).second) throw std::invalid_argument(what + ": the name is taken");
    if (tree_->hasLink(body.name)) {
      throw std::invalid_argument(what + ": the name is that of a link of robot '" + tree_->name() + "'");
    }
    if (!known.insert(objects[i].get()).second) throw std::invalid_argument(what + ": the object is there already");
    const auto old = before.find(objects[i].get());
    if (old != before.end() && old->second->isAsRead()) {
      const std::string name = std::move(body.name);
      body = *old->second;
      body.name = name;
      body.owner = objects[i];
    } else {
      body.object = objects[i].get();
      body.owner = objects[i];
      body.readObstacle();
    }
    fresh.push_back(std::move(body));
  }
  // Numbers are given anew: "obstacle0" is another object, unless somebody has named it so.
  const std::unordered_set<std::string> named_again(names.begin(), names.end());
  obstacle_names_.swap(taken);  // those of before
  keepNames([&](const std::string& name) {
    if (taken.count(name) == 0 || named_again.count(name) > 0) return true;  // a link's, or one that is given again
    const auto stays = [&](const ManagedBody& body) { return body.name == name; };
    return std::any_of(links_.begin(), links_.end(), stays) || std::any_of(moving_.begin(), moving_.end(), stays);
  });
  obstacles_ = std::move(fresh);
  objects_ = std::move(known);
  named_ = objects.size() + moving_.size();
}

void Registry::replaceObject(const std::string& name, const ObjectRef<fcl::CollisionObjectd>& object) {
  const auto old =
      std::find_if(obstacles_.begin(), obstacles_.end(), [&](const ManagedBody& b) { return b.name == name; });
  if (old == obstacles_.end()) {
    requireBody(name, "replaceObject");
    throw std::invalid_argument("replaceObject: '" + name + "' is no obstacle that stands still");
  }
  if (object.get() != old->object) requireNew(object.get(), "obstacle '" + name + "'");
  ManagedBody body;
  body.name = name;
  body.object = object.get();
  body.owner = object.share();
  body.readObstacle();
  objects_.insert(body.object);
  if (old->object != body.object) objects_.erase(old->object);
  *old = std::move(body);
}

Registry Registry::withoutObstacles() const {
  Registry robot = *this;
  const auto isOfRobot = [&](const std::string& name) {
    return tree_->hasLink(name) ||
           std::any_of(links_.begin(), links_.end(), [&](const ManagedBody& b) { return b.name == name; });
  };
  robot.keepNames(isOfRobot);
  for (const Bodies* bodies : {&obstacles_, &moving_}) {
    for (const ManagedBody& body : *bodies) {
      robot.objects_.erase(body.object);
      robot.objects_.erase(body.moving);
      robot.obstacle_names_.erase(body.name);
    }
  }
  robot.obstacles_.clear();
  robot.moving_.clear();
  robot.named_ = 0;
  return robot;
}

bool Registry::unregisterObject(const fcl::CollisionObjectd* object) {
  const auto is_it = [&](const ManagedBody& b) { return b.object == object && b.isObstacle(); };
  const auto still = std::find_if(obstacles_.begin(), obstacles_.end(), is_it);
  if (still != obstacles_.end()) {
    forget(obstacles_, still);
    return false;
  }
  forget(links_, requireIf(links_, is_it, "unregisterObject: the object is not registered"));
  return true;
}

void Registry::unregisterObject(const fcl::ContinuousCollisionObjectd* object) {
  forget(moving_, require(moving_, object, "unregisterObject: the object is not registered"));
}

void Registry::bind(const LinkRef& link, const ObjectRef<fcl::CollisionObjectd>& object,
                    const Eigen::Isometry3d& offset) {
  const LinkId id = requireLink(link, "bind");
  const std::string what = "geometry of link '" + tree_->linkName(id) + "'";
  ManagedBody body = newBody(object.get(), what);
  body.owner = object.share();
  body.link = id;
  body.name = tree_->linkName(id);
  body.offset = requireRigid(offset, what);
  body.readCarried(what);
  objects_.insert(object.get());
  links_.push_back(std::move(body));
}

void Registry::unbind(const fcl::CollisionObjectd* object) {
  const auto body = require(links_, object, "unbind: the object is bound to no link");
  if (body->attached) throw std::invalid_argument("unbind: '" + body->name + "' is attached; detach it");
  forget(links_, body);
}

void Registry::attach(const LinkRef& carrier, const fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset,
                      const std::vector<std::string>& touch_links) {
  const LinkId link = requireLink(carrier, "attach");
  const auto carried = std::find_if(links_.begin(), links_.end(),
                                    [&](const ManagedBody& body) { return body.attached && body.object == object; });
  if (carried != links_.end()) {
    throw std::invalid_argument("attach: '" + carried->name + "' is carried by '" + tree_->linkName(carried->link) +
                                "' already; detach it first");
  }
  const auto obstacle = require(obstacles_, object, "attach: the object is not registered as an obstacle");
  const std::string what = "attach: '" + obstacle->name + "'";
  ManagedBody body = *obstacle;
  body.link = link;
  body.attached = true;
  body.offset = requireRigid(offset, what);
  for (const std::string& name : touch_links) body.touch_links.insert(requireLink(name, what));
  body.requireBounded(what);
  links_.push_back(std::move(body));
  obstacles_.erase(obstacle);
}

void Registry::detach(const fcl::CollisionObjectd* object) {
  const auto carried = requireIf(
      links_, [&](const ManagedBody& b) { return b.object == object && b.attached; },
      "detach: the object is not attached");
  ManagedBody body = *carried;
  body.link = -1;
  body.attached = false;
  body.touch_links.clear();
  body.readObstacle();
  obstacles_.push_back(std::move(body));
  links_.erase(carried);
}

void Registry::clear() {
  keepNames([&](const std::string& name) { return tree_->hasLink(name); });
  obstacles_.clear();
  links_.clear();
  moving_.clear();
  objects_.clear();
  obstacle_names_.clear();
  named_ = 0;
}

Registry::Changes Registry::readAgain(const std::vector<ManagedBody*>& bodies) {
  requireLinks();
  std::vector<std::pair<ManagedBody*, ManagedBody>> changed;  // all or nothing
  for (ManagedBody* body : bodies) {
    if (body->isAsRead()) continue;
    changed.emplace_back(body, *body);
    changed.back().second.readAgain();
  }
  Changes changes;
  for (auto& [body, read] : changed) {
    (body->link >= 0 ? changes.links : changes.obstacles) = true;
    *body = std::move(read);
  }
  return changes;
}

Registry::Changes Registry::readAgain() {
  std::vector<ManagedBody*> bodies;
  for (Bodies* of : {&links_, &moving_, &obstacles_}) {
    for (ManagedBody& body : *of) bodies.push_back(&body);
  }
  return readAgain(bodies);
}

Registry::Changes Registry::readAgain(const std::vector<const fcl::CollisionObjectd*>& objects) {
  std::vector<ManagedBody*> bodies;
  for (const fcl::CollisionObjectd* object : objects) {
    const auto is_it = [&](const ManagedBody& b) { return object && b.object == object; };
    const auto obstacle = std::find_if(obstacles_.begin(), obstacles_.end(), is_it);
    const auto carried =
        obstacle != obstacles_.end() ? obstacle : require(links_, object, "update: the object is not registered");
    bodies.push_back(&*carried);
  }
  return readAgain(bodies);
}

Registry::Changes Registry::readAgain(const fcl::ContinuousCollisionObjectd* object) {
  return readAgain(std::vector<ManagedBody*>{&*require(moving_, object, "update: the object is not registered")});
}

void Registry::setMargin(const std::string& body, double margin) {
  requireBody(body, "setMargin");
  margins_.set(body, margin);
}

void Registry::setMargin(const std::string& a, const std::string& b, double margin) {
  requireBody(a, "setMargin");
  requireBody(b, "setMargin");
  margins_.set(a, b, margin);
}

void Registry::setJointTolerance(const std::string& joint, const JointTolerance& tolerance) {
  tolerances_.setJoint(*tree_, joint, tolerance, "setJointTolerance");
}

}  // namespace fcl_artic
