// SPDX-License-Identifier: BSD-3-Clause
//
// The manager that users hold. A change goes to the registry, and marks the parts of the set-up that it makes out of
// date.
#include "fcl_artic/manager.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "kinematics/angles.h"
#include "query/manager_impl.h"

namespace fcl_artic {

ArticulatedCollisionManager::ArticulatedCollisionManager(std::shared_ptr<const KinematicTree> tree)
    : impl_(std::make_unique<Impl>(std::move(tree))) {}
ArticulatedCollisionManager::~ArticulatedCollisionManager() = default;
ArticulatedCollisionManager::ArticulatedCollisionManager(ArticulatedCollisionManager&&) noexcept = default;
ArticulatedCollisionManager& ArticulatedCollisionManager::operator=(ArticulatedCollisionManager&&) noexcept = default;

const KinematicTree& ArticulatedCollisionManager::tree() const {
  return *impl_->registry.tree();
}
std::shared_ptr<const KinematicTree> ArticulatedCollisionManager::sharedTree() const {
  return impl_->registry.tree();
}

void ArticulatedCollisionManager::registerObject(const ObjectRef<fcl::CollisionObjectd>& object,
                                                 const std::string& name) {
  impl_->registry.registerObject(object, name);
  impl_->setup.obstaclesChanged();
}

void ArticulatedCollisionManager::registerObject(const ObjectRef<fcl::ContinuousCollisionObjectd>& object,
                                                 const std::string& name) {
  impl_->registry.registerObject(object, name);
  impl_->setup.obstaclesChanged();
}

void ArticulatedCollisionManager::registerObjects(const std::vector<fcl::CollisionObjectd*>& objects) {
  impl_->registry.registerObjects(objects);
  if (!objects.empty()) impl_->setup.obstaclesChanged();
}

void ArticulatedCollisionManager::replaceObstacles(
    const std::vector<std::shared_ptr<const fcl::CollisionObjectd>>& objects, const std::vector<std::string>& names) {
  impl_->registry.replaceObstacles(objects, names);
  impl_->setup.obstaclesChanged();
  impl_->use({});
}

ArticulatedCollisionManager ArticulatedCollisionManager::shareRobot() const {
  impl_->requireReady();
  ArticulatedCollisionManager other(impl_->registry.tree());
  other.impl_->registry = impl_->registry.withoutObstacles();
  other.impl_->setup = impl_->setup;
  other.impl_->setup.obstaclesChanged();
  other.impl_->use({});
  return other;
}

ArticulatedCollisionManager ArticulatedCollisionManager::copy() const {
  ArticulatedCollisionManager other(impl_->registry.tree());
  other.impl_->registry = impl_->registry;
  other.impl_->setup = impl_->setup;
  other.impl_->setup.obstaclesChanged();  // a set-up refers to its own parts
  other.impl_->culler = impl_->culler;
  return other;
}

void ArticulatedCollisionManager::replaceObject(const std::string& name,
                                                const ObjectRef<fcl::CollisionObjectd>& object) {
  impl_->registry.replaceObject(name, object);
  impl_->setup.obstaclesChanged();
}

void ArticulatedCollisionManager::unregisterObject(const ObjectRef<fcl::CollisionObjectd>& object) {
  const bool carried = impl_->registry.unregisterObject(object.get());
  carried ? impl_->setup.robotChanged() : impl_->setup.obstaclesChanged();
}

void ArticulatedCollisionManager::unregisterObject(const ObjectRef<fcl::ContinuousCollisionObjectd>& object) {
  impl_->registry.unregisterObject(object.get());
  impl_->setup.obstaclesChanged();
}

void ArticulatedCollisionManager::bind(const LinkRef& link, const ObjectRef<fcl::CollisionObjectd>& object,
                                       const Eigen::Isometry3d& offset) {
  impl_->registry.bind(link, object, offset);
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::unbind(const ObjectRef<fcl::CollisionObjectd>& object) {
  impl_->registry.unbind(object.get());
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::attach(const LinkRef& link, const ObjectRef<fcl::CollisionObjectd>& object,
                                         const Eigen::Isometry3d& offset, const std::vector<std::string>& touch_links) {
  impl_->registry.attach(link, object.get(), offset, touch_links);
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::detach(const ObjectRef<fcl::CollisionObjectd>& object) {
  impl_->registry.detach(object.get());
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::setAllowedCollisions(AllowedCollisionMatrix matrix) {
  impl_->registry.setAllowed(std::move(matrix));
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::setLinkPairProofs(std::shared_ptr<const LinkPairProofs> proofs) {
  impl_->registry.setProofs(std::move(proofs));
  impl_->setup.marginsChanged();
}

void ArticulatedCollisionManager::allow(const std::string& a, const std::string& b) {
  impl_->registry.allow(a, b);
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::disallow(const std::string& a, const std::string& b) {
  impl_->registry.disallow(a, b);
  impl_->setup.robotChanged();
}

const AllowedCollisionMatrix& ArticulatedCollisionManager::allowedCollisions() const {
  return impl_->registry.allowed();
}

void ArticulatedCollisionManager::setMargin(const std::string& body, double margin) {
  impl_->registry.setMargin(body, margin);
  impl_->setup.marginsChanged();
}

void ArticulatedCollisionManager::setMargin(const std::string& a, const std::string& b, double margin) {
  impl_->registry.setMargin(a, b, margin);
  impl_->setup.marginsChanged();
}

void ArticulatedCollisionManager::resetMargins() {
  impl_->registry.resetMargins();
  impl_->setup.marginsChanged();
}

void ArticulatedCollisionManager::setJointTolerances(const JointTolerance& all) {
  impl_->registry.setJointTolerances(all);
  impl_->setup.tolerancesChanged();
}

void ArticulatedCollisionManager::setJointTolerance(const std::string& joint, const JointTolerance& tolerance) {
  impl_->registry.setJointTolerance(joint, tolerance);
  impl_->setup.tolerancesChanged();
}

void ArticulatedCollisionManager::setBaseTolerance(const PoseTolerance& tolerance) {
  impl_->registry.setBaseTolerance(tolerance);
  impl_->setup.tolerancesChanged();
}

void ArticulatedCollisionManager::setObjectTolerance(const std::string& name, const PoseTolerance& tolerance) {
  impl_->registry.setObjectTolerance(name, tolerance);
  impl_->setup.tolerancesChanged();
}

void ArticulatedCollisionManager::setObjectSpeed(const std::string& name, const ObjectSpeed& speed) {
  impl_->registry.setObjectSpeed(name, speed);
  impl_->setup.tolerancesChanged();
}

void ArticulatedCollisionManager::setTimeTolerance(double time) {
  impl_->registry.setTimeTolerance(time);
  impl_->setup.tolerancesChanged();
}

bool ArticulatedCollisionManager::hasSpeeds() const {
  return impl_->registry.tolerances().anySpeed();
}

void ArticulatedCollisionManager::resetTolerances() {
  impl_->registry.resetTolerances();
  impl_->setup.tolerancesChanged();
}

std::string ArticulatedCollisionManager::describeTolerances() const {
  const NamedTolerances& tolerances = impl_->registry.tolerances();
  std::string all;
  const auto add = [&](const std::string& name, const auto& tolerance) {
    if (!tolerance.any()) return;
    all += (all.empty() ? "" : ", ") + name;
    const auto write = [&](double value, const char* unit) {
      char text[64];
      std::snprintf(text, sizeof text, " %.6g %s", value, unit);
      all += text;
    };
    if (tolerance.length > 0) write(1000 * tolerance.length, "mm");
    if (tolerance.length > 0 && tolerance.angle > 0) all += " and";
    if (tolerance.angle > 0) write(tolerance.angle / kRadiansPerDegree, "deg");
  };
  add(tolerances.ofJoints().empty() ? "joints" : "other joints", tolerances.ofAllJoints());
  for (const auto& [name, own] : tolerances.ofJoints()) add("'" + name + "'", own);
  add("base", tolerances.base());
  for (const auto& [name, own] : tolerances.ofObjects()) add("'" + name + "'", own);
  for (const auto& [name, own] : tolerances.speeds()) {
    if (!(own.speed > 0)) continue;
    char text[96];
    std::snprintf(text, sizeof text, "' moving at up to %.6g m per unit of time from %.6g on", own.speed, own.since);
    all += (all.empty() ? "'" : ", '") + name + text;
  }
  if (tolerances.ofTime() > 0) {
    char text[64];
    std::snprintf(text, sizeof text, "%.6g units of time", tolerances.ofTime());
    all += (all.empty() ? "" : ", ") + std::string(text);
  }
  return all;
}

void ArticulatedCollisionManager::setVisibility(std::shared_ptr<const VisibilityCuller> culler) {
  impl_->culler = culler ? std::move(culler) : std::make_shared<VisibilityCuller>();
}

void ArticulatedCollisionManager::setup() {
  impl_->use(impl_->registry.readAgain());
}

void ArticulatedCollisionManager::prepareFor(Method method) {
  if (method == Method::redon2004) impl_->setup.prepareObbTrees();
}

void ArticulatedCollisionManager::update() {
  impl_->use(impl_->registry.readAgain());
}

void ArticulatedCollisionManager::update(const ObjectRef<fcl::CollisionObjectd>& object) {
  impl_->use(impl_->registry.readAgain(std::vector<const fcl::CollisionObjectd*>{object.get()}));
}

void ArticulatedCollisionManager::update(const std::vector<fcl::CollisionObjectd*>& objects) {
  impl_->use(impl_->registry.readAgain(std::vector<const fcl::CollisionObjectd*>(objects.begin(), objects.end())));
}

void ArticulatedCollisionManager::update(const ObjectRef<fcl::ContinuousCollisionObjectd>& object) {
  impl_->use(impl_->registry.readAgain(object.get()));
}

void ArticulatedCollisionManager::clear() {
  impl_->registry.clear();
  impl_->setup.robotChanged();
}

void ArticulatedCollisionManager::getObjects(std::vector<const fcl::CollisionObjectd*>& objects) const {
  objects.clear();
  for (const ManagedBody& b : impl_->registry.obstacles()) objects.push_back(b.object);
}

void ArticulatedCollisionManager::getObjects(std::vector<const fcl::ContinuousCollisionObjectd*>& objects) const {
  objects.clear();
  for (const ManagedBody& b : impl_->registry.moving()) objects.push_back(b.moving);
}

std::vector<std::pair<LinkId, const fcl::CollisionObjectd*>> ArticulatedCollisionManager::boundObjects() const {
  std::vector<std::pair<LinkId, const fcl::CollisionObjectd*>> bound;
  for (const ManagedBody& b : impl_->registry.links()) bound.emplace_back(b.link, b.object);
  return bound;
}

std::vector<std::pair<std::string, std::string>> ArticulatedCollisionManager::checkedLinkPairs() const {
  impl_->requireReady();
  const engine::Problem problem = impl_->setup.problem();
  std::set<std::pair<std::string, std::string>> pairs;  // a link may carry several bodies
  for (std::int32_t i = 0; i < impl_->setup.numSelfPairs(); ++i) {
    const engine::LinkPair& pair = problem.link_pairs[i];
    pairs.insert(std::minmax(impl_->registry.body(pair.a).name, impl_->registry.body(pair.b).name));
  }
  return {pairs.begin(), pairs.end()};
}

Eigen::Isometry3d ArticulatedCollisionManager::boundOffset(const ObjectRef<fcl::CollisionObjectd>& object) const {
  for (const ManagedBody& b : impl_->registry.links()) {
    if (b.object == object.get()) return b.offset;
  }
  throw std::invalid_argument("boundOffset: the object is bound to no link");
}

std::size_t ArticulatedCollisionManager::size() const {
  return impl_->registry.obstacles().size() + impl_->registry.moving().size();
}

}  // namespace fcl_artic
