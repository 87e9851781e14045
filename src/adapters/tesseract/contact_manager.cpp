// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/tesseract/contact_manager.h"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include <tesseract/collision/common.h>
#include <tesseract/collision/contact_result_validator.h>
#include <tesseract/common/contact_allowed_validator.h>
#include <yaml-cpp/yaml.h>

#include "adapters/tesseract/geometry.h"
#include "fcl_artic/manager.h"

namespace fcl_artic {

namespace collision = ::tesseract::collision;
namespace common = ::tesseract::common;
using ObjectId = common::LinkId;

namespace {

/// One geometry of an object.
struct Part {
  int shape;  ///< index of tesseract's shape
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
  std::shared_ptr<fcl::CollisionObjectd> object;  ///< of this manager alone
  std::string body;                               ///< name in the manager
};

struct Object {
  ObjectId id;
  int mask = 0;
  collision::CollisionShapesConst shapes;
  common::VectorIsometry3d poses;
  bool enabled = true;
  Eigen::Isometry3d pose1 = Eigen::Isometry3d::Identity(), pose2 = Eigen::Isometry3d::Identity();
  std::vector<Part> parts;
  bool active = false;  ///< moves in the manager as it was made
  int variable = -1;    ///< its first one, if it is active
};

/// Requires of every pose what the manager requires of obstacles' poses. (An active object's pose becomes a quaternion,
/// which any matrix would give.)
void requirePose(const ObjectId& id, const Eigen::Isometry3d& pose) {
  if (!pose.matrix().allFinite() || pose.translation().cwiseAbs().maxCoeff() > 1e5) {
    throw std::invalid_argument("object '" + id.name() + "' has a pose that is not finite or farther than 1e5 m away");
  }
  const Eigen::Matrix3d R = pose.matrix().topLeftCorner<3, 3>();
  const Eigen::Matrix3d defect = R.transpose() * R - Eigen::Matrix3d::Identity();
  if (defect.cwiseAbs().maxCoeff() <= 1e-6 && R.determinant() > 0) return;
  throw std::invalid_argument("object '" + id.name() + "' has a pose that is not rigid to 1e-6");
}

/// Position and quaternion x, y, z, w.
void writePose(const Eigen::Isometry3d& pose, Eigen::VectorXd& q, int variable) {
  q.segment<3>(variable) = pose.translation();
  q.segment<4>(variable + 3) = Eigen::Quaterniond(pose.linear()).normalized().coeffs();
}

}  // namespace

struct TesseractContactManager::Impl {
  std::string name;
  TesseractOptions options;
  std::vector<Object> objects;
  std::vector<ObjectId> ids;
  std::unordered_set<ObjectId> active;
  collision::CollisionMarginData margins{0};
  std::shared_ptr<const common::ContactAllowedValidator> validator;
  CertifiedResult result;

  // Parts of the manager that the next query has to make anew.
  bool other_objects = true, other_margins = true;
  std::set<const Object*> moved;  ///< still ones that stand elsewhere
  std::shared_ptr<KinematicTree> tree;
  std::unique_ptr<ArticulatedCollisionManager> manager;
  std::vector<bool> allowed;  ///< of all pairs of objects, as the validator had it last

  Object* find(const ObjectId& id) {
    const auto found = std::find_if(objects.begin(), objects.end(), [&](const Object& o) { return o.id == id; });
    return found == objects.end() ? nullptr : &*found;
  }
  const Object* find(const ObjectId& id) const { return const_cast<Impl*>(this)->find(id); }

  void setPoses(const ObjectId& id, const Eigen::Isometry3d& pose1, const Eigen::Isometry3d& pose2) {
    Object* object = find(id);
    if (!object) return;
    requirePose(id, pose1);
    requirePose(id, pose2);
    object->pose1 = pose1;
    object->pose2 = pose2;
    if (!object->active) moved.insert(object);
  }
  bool setEnabled(const ObjectId& id, bool enabled) {
    Object* object = find(id);
    if (!object) return false;
    other_objects = other_objects || object->enabled != enabled;
    object->enabled = enabled;
    return true;
  }

  void rebuild();
  void bindStill(Object& object, std::set<std::string>& names);
  void setMargins();
  void askValidator(bool anew);
  void prepare();
  JointMotion motion() const;
  CertifiedRequest request(const collision::ContactRequest& asked) const;
  std::pair<const Object*, const Part*> owner(const BodyRef& body) const;
  collision::ContactResult contact(const CertifiedContact& found, const JointMotion& motion) const;
};

void TesseractContactManager::Impl::bindStill(Object& object, std::set<std::string>& names) {
  for (Part& part : object.parts) {
    part.body = object.id.name();
    while (!names.insert(part.body).second) part.body += '_';
    part.object = std::make_shared<fcl::CollisionObjectd>(
        part.geometry, object.pose1 * object.poses[static_cast<std::size_t>(part.shape)]);
    manager->registerObject(part.object, part.body);
  }
}

/// Active objects are links on floating joints of their own, all others obstacles.
void TesseractContactManager::Impl::rebuild() {
  tree = std::make_shared<KinematicTree>("tesseract");
  std::set<std::string> names;
  for (Object& object : objects) {
    object.active = object.enabled && collision::isLinkActive(active, object.id);
    if (object.active) names.insert(object.id.name());
  }
  std::string root = "world";
  while (!names.insert(root).second) root += '_';
  tree->addLink(root);
  for (Object& object : objects) {
    if (!object.active) continue;
    Joint joint;
    joint.type = JointType::floating;
    joint.name = joint.child = object.id.name();
    joint.parent = root;
    object.variable = tree->dof();
    tree->addLink(joint.child);
    tree->addJoint(joint);
  }
  manager = std::make_unique<ArticulatedCollisionManager>(tree);
  for (Object& object : objects) {
    if (!object.enabled) continue;
    if (!object.active) {
      bindStill(object, names);
      continue;
    }
    for (Part& part : object.parts) {
      part.body = object.id.name();
      part.object = std::make_shared<fcl::CollisionObjectd>(part.geometry);
      manager->bind(part.body, part.object, object.poses[static_cast<std::size_t>(part.shape)]);
    }
  }
  moved.clear();
}

void TesseractContactManager::Impl::setMargins() {
  manager->resetMargins();
  for (const auto& [pair, margin] : margins.getCollisionMarginPairData().getCollisionMargins()) {
    const Object *a = find(pair.first()), *b = find(pair.second());
    if (!a || !b || !a->enabled || !b->enabled || !(a->active || b->active)) continue;
    for (const Part& x : a->parts) {
      for (const Part& y : b->parts) {
        if (x.body != y.body) manager->setMargin(x.body, y.body, std::max(margin, 0.0));
      }
    }
  }
}

/// @param anew  pass the pairs to the manager even if none has changed.
void TesseractContactManager::Impl::askValidator(bool anew) {
  std::vector<bool> now;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t k = i + 1; k < objects.size(); ++k) {
      const Object &a = objects[i], &b = objects[k];
      if (!a.enabled || !b.enabled || !(a.active || b.active)) continue;
      now.push_back(collision::isContactAllowed(a.id, b.id, validator));
    }
  }
  if (!anew && now == allowed) return;
  allowed = std::move(now);
  AllowedCollisionMatrix matrix;
  std::size_t next = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t k = i + 1; k < objects.size(); ++k) {
      const Object &a = objects[i], &b = objects[k];
      if (!a.enabled || !b.enabled || !(a.active || b.active) || !allowed[next++]) continue;
      for (const Part& x : a.parts) {
        for (const Part& y : b.parts) matrix.allow(x.body, y.body);
      }
    }
  }
  manager->setAllowedCollisions(std::move(matrix));
  manager->setup();
}

void TesseractContactManager::Impl::prepare() {
  const bool anew = other_objects || other_margins;
  if (other_objects) rebuild();
  if (anew) setMargins();
  askValidator(anew);
  other_objects = other_margins = false;
  for (const Object* object : moved) {
    for (const Part& part : object->parts) {
      if (!part.object || !object->enabled) continue;
      part.object->setTransform(object->pose1 * object->poses[static_cast<std::size_t>(part.shape)]);
      manager->update(part.object);
    }
  }
  moved.clear();
}

JointMotion TesseractContactManager::Impl::motion() const {
  Eigen::VectorXd q0 = tree->neutralConfiguration(), q1 = q0;
  for (const Object& object : objects) {
    if (!object.active) continue;
    writePose(object.pose1, q0, object.variable);
    writePose(object.pose2, q1, object.variable);
  }
  return JointMotion::linear(*tree, q0, q1);
}

CertifiedRequest TesseractContactManager::Impl::request(const collision::ContactRequest& asked) const {
  CertifiedRequest out;
  static_cast<Tolerances&>(out) = options.tolerances;
  out.margin = std::max(margins.getDefaultCollisionMargin(), 0.0);
  out.mode = ContactMode::firstOfEveryPair;
  if (asked.type == collision::ContactTestType::FIRST && !asked.is_valid) {
    out.mode = options.any_contact ? ContactMode::any : ContactMode::first;
  } else {
    out.max_contacts = std::numeric_limits<std::size_t>::max();
  }
  return out;
}

std::pair<const Object*, const Part*> TesseractContactManager::Impl::owner(const BodyRef& body) const {
  for (const Object& object : objects) {
    for (const Part& part : object.parts) {
      if (part.object && part.object.get() == body.object) return {&object, &part};
    }
  }
  throw std::logic_error("TesseractContactManager: a contact of '" + body.name + "', which is no object");
}

collision::ContactResult TesseractContactManager::Impl::contact(const CertifiedContact& found,
                                                                const JointMotion& motion) const {
  collision::ContactResult out;
  std::pair<const Object*, const Part*> sides[2] = {owner(found.body1), owner(found.body2)};
  std::intptr_t pieces[2] = {found.b1, found.b2};
  Eigen::Vector3d points[2] = {found.nearest1, found.nearest2};
  out.normal = found.normal;
  const common::LinkIdPair key(sides[0].first->id, sides[1].first->id);
  if (key.first() != sides[0].first->id) {
    std::swap(sides[0], sides[1]);
    std::swap(pieces[0], pieces[1]);
    std::swap(points[0], points[1]);
    out.normal = -out.normal;
  }
  const double t = found.certain ? found.t_upper : found.t_lower;
  const Eigen::VectorXd q = motion.configuration(t);
  out.distance = std::min((points[1] - points[0]).norm(), std::max(0.0, margins.getCollisionMargin(key)));
  out.single_contact_point = points[0] == points[1];
  for (std::size_t i = 0; i < 2; ++i) {
    const Object& object = *sides[i].first;
    out.link_ids[i] = object.id;
    out.type_id[i] = object.mask;
    out.shape_id[i] = sides[i].second->shape;
    out.subshape_id[i] = static_cast<int>(pieces[i]);
    out.nearest_points[i] = points[i];
    out.transform[i] = object.pose1;
    out.cc_transform[i] = object.active ? object.pose2 : object.pose1;
    Eigen::Isometry3d M = object.pose1;
    if (object.active) {
      M = tree->linkPose(tree->linkId(object.id.name()), q);
      out.cc_time[i] = t;
      out.cc_type[i] = t <= 0   ? collision::ContinuousCollisionType::CCType_Time0
                       : t >= 1 ? collision::ContinuousCollisionType::CCType_Time1
                                : collision::ContinuousCollisionType::CCType_Between;
    }
    out.nearest_points_local[i] = M.inverse() * points[i];
  }
  return out;
}

TesseractContactManager::TesseractContactManager(std::string name, const TesseractOptions& options)
    : impl_(std::make_unique<Impl>()) {
  for (const double tolerance : {options.tolerances.tolerance_time, options.tolerances.tolerance_distance}) {
    if (!(tolerance > 0)) throw std::invalid_argument("TesseractContactManager: a tolerance is no positive number");
  }
  impl_->name = std::move(name);
  impl_->options = options;
}
TesseractContactManager::TesseractContactManager(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TesseractContactManager::~TesseractContactManager() = default;

std::string TesseractContactManager::getName() const {
  return impl_->name;
}

collision::ContinuousContactManager::UPtr TesseractContactManager::clone() const {
  auto copy = std::make_unique<Impl>();
  copy->name = impl_->name;
  copy->options = impl_->options;
  copy->objects = impl_->objects;
  for (Object& object : copy->objects) {
    for (Part& part : object.parts) part.object.reset();  // each manager has its own
  }
  copy->ids = impl_->ids;
  copy->active = impl_->active;
  copy->margins = impl_->margins;
  copy->validator = impl_->validator;
  return UPtr(new TesseractContactManager(std::move(copy)));
}

bool TesseractContactManager::addCollisionObject(const ObjectId& id, const int& mask_id,
                                                 const collision::CollisionShapesConst& shapes,
                                                 const common::VectorIsometry3d& shape_poses, bool enabled) {
  if (shapes.empty() || shapes.size() != shape_poses.size()) return false;
  Object object;
  object.id = id;
  object.mask = mask_id;
  object.shapes = shapes;
  object.poses = shape_poses;
  object.enabled = enabled;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    try {
      if (!id.isValid()) throw std::invalid_argument("it has no name");
      if (!shapes[i]) throw std::invalid_argument("it is null");
      requirePose(id, shape_poses[i]);
      for (auto& geometry : fromTesseractGeometry(*shapes[i])) {
        object.parts.push_back({static_cast<int>(i), std::move(geometry), nullptr, {}});
      }
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument("object '" + id.name() + "', shape " + std::to_string(i) + ": " + e.what());
    }
  }
  // An object that moves goes on moving: if it became an obstacle at its first pose, nobody would check its way.
  const bool was_active = impl_->active.count(id) > 0;
  removeCollisionObject(id);
  if (was_active) impl_->active.insert(id);
  impl_->objects.push_back(std::move(object));
  impl_->ids.push_back(id);
  impl_->moved.clear();  // pointers into objects; all is made anew
  impl_->other_objects = true;
  return true;
}

const collision::CollisionShapesConst& TesseractContactManager::getCollisionObjectGeometries(const ObjectId& id) const {
  static const collision::CollisionShapesConst none;
  const Object* object = impl_->find(id);
  return object ? object->shapes : none;
}

const common::VectorIsometry3d& TesseractContactManager::getCollisionObjectGeometriesTransforms(
    const ObjectId& id) const {
  static const common::VectorIsometry3d none;
  const Object* object = impl_->find(id);
  return object ? object->poses : none;
}

bool TesseractContactManager::hasCollisionObject(const ObjectId& id) const {
  return impl_->find(id);
}

bool TesseractContactManager::removeCollisionObject(const ObjectId& id) {
  const Object* object = impl_->find(id);
  if (!object) return false;
  impl_->objects.erase(impl_->objects.begin() + (object - impl_->objects.data()));
  impl_->ids.erase(std::find(impl_->ids.begin(), impl_->ids.end(), id));
  impl_->active.erase(id);
  impl_->moved.clear();  // pointers into objects; all is made anew
  impl_->other_objects = true;
  return true;
}

bool TesseractContactManager::enableCollisionObject(const ObjectId& id) {
  return impl_->setEnabled(id, true);
}
bool TesseractContactManager::disableCollisionObject(const ObjectId& id) {
  return impl_->setEnabled(id, false);
}

bool TesseractContactManager::isCollisionObjectEnabled(const ObjectId& id) const {
  const Object* object = impl_->find(id);
  return object && object->enabled;
}

void TesseractContactManager::setCollisionObjectsTransform(const ObjectId& id, const Eigen::Isometry3d& pose) {
  impl_->setPoses(id, pose, pose);
}

Eigen::Isometry3d TesseractContactManager::getCollisionObjectsTransform(const ObjectId& id) const {
  const Object* object = impl_->find(id);
  if (!object) throw std::out_of_range("there is no collision object '" + id.name() + "'");
  return object->pose1;
}

void TesseractContactManager::setCollisionObjectsTransform(const common::LinkIdTransformMap& transforms) {
  for (const auto& [id, pose] : transforms) impl_->setPoses(id, pose, pose);
}

void TesseractContactManager::setCollisionObjectsTransform(const ObjectId& id, const Eigen::Isometry3d& pose1,
                                                           const Eigen::Isometry3d& pose2) {
  impl_->setPoses(id, pose1, pose2);
}

void TesseractContactManager::setCollisionObjectsTransform(const common::LinkIdTransformMap& pose1,
                                                           const common::LinkIdTransformMap& pose2) {
  for (const auto& [id, begin] : pose1) {
    const auto end = pose2.find(id);
    if (end == pose2.end()) throw std::invalid_argument("object '" + id.name() + "' has a first pose, but no second");
    impl_->setPoses(id, begin, end->second);
  }
}

const std::vector<ObjectId>& TesseractContactManager::getCollisionObjects() const {
  return impl_->ids;
}

void TesseractContactManager::setActiveCollisionObjects(const std::unordered_set<ObjectId>& ids) {
  impl_->other_objects = impl_->other_objects || impl_->active != ids;
  impl_->active = ids;
}

const std::unordered_set<ObjectId>& TesseractContactManager::getActiveCollisionObjects() const {
  return impl_->active;
}

void TesseractContactManager::setCollisionMarginData(collision::CollisionMarginData collision_margin_data) {
  impl_->margins = std::move(collision_margin_data);
  impl_->other_margins = true;
}

const collision::CollisionMarginData& TesseractContactManager::getCollisionMarginData() const {
  return impl_->margins;
}

void TesseractContactManager::setCollisionMarginPairData(const collision::CollisionMarginPairData& pair_margin_data,
                                                         collision::CollisionMarginPairOverrideType override_type) {
  impl_->margins.apply(pair_margin_data, override_type);
  impl_->other_margins = true;
}

void TesseractContactManager::setDefaultCollisionMargin(double default_collision_margin) {
  impl_->margins.setDefaultCollisionMargin(default_collision_margin);
}

void TesseractContactManager::setCollisionMarginPair(const ObjectId& id1, const ObjectId& id2,
                                                     double collision_margin) {
  impl_->margins.setCollisionMargin(id1, id2, collision_margin);
  impl_->other_margins = true;
}

void TesseractContactManager::incrementCollisionMargin(double increment) {
  impl_->margins.incrementMargins(increment);
  impl_->other_margins = true;
}

void TesseractContactManager::setContactAllowedValidator(
    std::shared_ptr<const common::ContactAllowedValidator> validator) {
  impl_->validator = std::move(validator);
}

std::shared_ptr<const common::ContactAllowedValidator> TesseractContactManager::getContactAllowedValidator() const {
  return impl_->validator;
}

void TesseractContactManager::contactTest(collision::ContactResultMap& collisions,
                                          const collision::ContactRequest& request) {
  impl_->result = {};
  impl_->prepare();
  const JointMotion motion = impl_->motion();
  impl_->manager->continuousCollide(motion, impl_->request(request), impl_->result);
  std::set<std::pair<common::LinkIdPair, std::array<int, 2>>> seen;
  long kept = 0;
  for (const CertifiedContact& found : impl_->result.contacts) {  // the earliest first
    collision::ContactResult contact = impl_->contact(found, motion);
    const common::LinkIdPair key(contact.link_ids[0], contact.link_ids[1]);
    const bool closest = request.type == collision::ContactTestType::CLOSEST;
    const auto what = std::make_pair(key, closest ? std::array<int, 2>{} : contact.shape_id);
    if (seen.count(what)) continue;  // a later one
    if (request.is_valid && !(*request.is_valid)(contact)) continue;
    seen.insert(what);
    collisions.addContactResult(key, std::move(contact));
    ++kept;
    if (request.type == collision::ContactTestType::FIRST) break;
    if (request.type == collision::ContactTestType::LIMITED && request.contact_limit > 0 &&
        kept >= request.contact_limit) {
      break;
    }
  }
}

const CertifiedResult& TesseractContactManager::result() const {
  return impl_->result;
}

std::unique_ptr<collision::ContinuousContactManager> FclArticContactManagerFactory::create(
    const std::string& name, const YAML::Node& config) const {
  TesseractOptions options;
  if (config && config.IsMap()) {
    for (const auto& field : config) {
      const auto key = field.first.as<std::string>();
      try {
        if (key == "tolerance_time") {
          options.tolerances.tolerance_time = field.second.as<double>();
        } else if (key == "tolerance_distance") {
          options.tolerances.tolerance_distance = field.second.as<double>();
        } else if (key == "any_contact") {
          options.any_contact = field.second.as<bool>();
        } else {
          throw std::invalid_argument("it is unknown; tolerance_time, tolerance_distance and any_contact are known");
        }
      } catch (const std::exception& e) {
        throw std::invalid_argument("contact manager '" + name + "', field '" + key + "': " + e.what());
      }
    }
  } else if (config && !config.IsNull()) {
    throw std::invalid_argument("contact manager '" + name + "': its config is no map");
  }
  return std::make_unique<TesseractContactManager>(name, options);
}

}  // namespace fcl_artic

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): tesseract's loader looks for a variable
TESSERACT_ADD_CONTINUOUS_MANAGER_PLUGIN(fcl_artic::FclArticContactManagerFactory, FclArticContactManagerFactory);
