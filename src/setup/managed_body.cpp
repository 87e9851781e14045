// SPDX-License-Identifier: BSD-3-Clause
#include "setup/managed_body.h"

#include <cstring>
#include <stdexcept>

#include "fcl/fcl_geometry.h"
#include "fcl/fcl_motion.h"
#include "setup/shared_shapes.h"

namespace fcl_artic {

namespace {

std::shared_ptr<const fcl::CollisionGeometryd> geometryOf(const ManagedBody& body) {
  // NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage): one of the two is there
  return body.object ? body.object->collisionGeometry() : body.moving->collisionGeometry();
}

}  // namespace

bool ManagedBody::isAsRead() const {
  if (moving) return false;
  const std::shared_ptr<const fcl::CollisionGeometryd> current = geometryOf(*this);
  if (current != geometry || !(neverChanges(*current) || content->sameAs(*current))) return false;
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): other bits are another reading
  return link >= 0 || std::memcmp(object->getTransform().data(), transform.data(), 16 * sizeof(double)) == 0;
}

void ManagedBody::readAgain() {
  if (link < 0) return readObstacle();
  readCarried(attached ? "attached object '" + name + "'" : "geometry of link '" + name + "'");
}

void ManagedBody::readShape(const std::string& what) {
  const std::shared_ptr<const fcl::CollisionGeometryd> current = geometryOf(*this);
  if (!current) throw std::invalid_argument(what + ": the object has no geometry");
  const bool known = content && ((current == geometry && neverChanges(*current)) || content->sameAs(*current));
  if (!known) {
    try {
      const SharedShape read = readShared(*current);
      shape = read.shape;
      content = read.content;
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument(what + ": " + e.what());
    }
  }
  geometry = current;
}

void ManagedBody::readCarried(const std::string& what) {
  readShape(what);
  requireBounded(what);
}

void ManagedBody::requireBounded(const std::string& what) const {
  if (size() >= engine::kUnbounded) throw std::invalid_argument(what + ": it is unbounded, and no link carries that");
}

void ManagedBody::readObstacle() {
  const std::string what = "obstacle '" + name + "'";
  if (object) {
    const RigidTransform M = requireRigid(object->getTransform(), what);
    readShape(what);
    transform = object->getTransform();
    offset = M;
    return;
  }
  readShape(what);
  const fcl::MotionBased* read = moving->getMotion();
  if (!read) throw std::invalid_argument(what + ": it has no motion");
  try {
    motion = readMotion(*read);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(what + ": " + e.what());
  }
  const bool bounded = size() < engine::kUnbounded;
  const Eigen::Vector3d far = Eigen::Vector3d::Constant(engine::kUnbounded);
  if (bounded) enclosePath(motion, shape->lower(), shape->upper(), path_lower, path_upper);
  path_lower = bounded ? path_lower.cwiseMax(-far) : Eigen::Vector3d(-far);
  path_upper = bounded ? path_upper.cwiseMin(far) : far;
}

void ManagedBody::worldBox(const Eigen::Isometry3d& M, const engine::Placement& placement, double* lo,
                           double* hi) const {
  const Eigen::Vector3d c = 0.5 * (shape->lower() + shape->upper()), h = 0.5 * (shape->upper() - shape->lower());
  const Eigen::Vector3d center = M * c, half = M.linear().cwiseAbs() * h;
  // The placement's own error and a dozen roundings of numbers no larger than these.
  const double pad = 0x1p-52 * (placement.ulps + 32) * (c.cwiseAbs().sum() + h.sum() + placement.length);
  for (int k = 0; k < 3; ++k) {
    lo[k] = center[k] - half[k] - pad;
    hi[k] = center[k] + half[k] + pad;
  }
}

}  // namespace fcl_artic
