// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/ompl/motion_validator.h"

#include <algorithm>
#include <stdexcept>

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;
using ManagerPtr = std::shared_ptr<const ArticulatedCollisionManager>;

/// Where answers go: memory only, nothing is read from the last one.
CertifiedResult& scratch() {
  thread_local CertifiedResult result;
  return result;
}

/// What the constructors are given, refused before any of it is used.
const ob::SpaceInformationPtr& required(const ob::SpaceInformationPtr& si, const ManagerPtr& manager) {
  if (!si) throw std::invalid_argument("planning: the space information is null");
  if (!manager) throw std::invalid_argument("planning: the manager is null");
  return si;
}

JointMapping allJoints(const ob::SpaceInformationPtr& si, const ManagerPtr& manager) {
  required(si, manager);
  return JointMapping(*si->getStateSpace(), manager->sharedTree());
}

JointMapping ofManager(JointMapping mapping, const ManagerPtr& manager) {
  if (&mapping.tree() != &manager->tree()) {
    throw std::invalid_argument("planning: the joint mapping is of another tree than the manager");
  }
  return mapping;
}

CertifiedRequest asked(CertifiedRequest request, ContactMode mode) {
  request.mode = mode;
  request.max_contacts = 1;
  request.progress = nullptr;
  return request;
}

CertifiedRequest askedOfState(CertifiedRequest request) {
  request = asked(request, ContactMode::any);
  request.ignore_initial_contact = false;
  return request;
}

}  // namespace

CertifiedRequest planningRequest() {
  CertifiedRequest request;
  request.tolerance_time = 0x1p-12;
  request.tolerance_distance = 1e-5;
  return request;
}

ContinuousMotionValidator::ContinuousMotionValidator(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                     JointMapping mapping, const CertifiedRequest& request)
    : ob::MotionValidator(required(si, manager)), manager_(std::move(manager)),
      mapping_(ofManager(std::move(mapping), manager_)), any_(asked(request, ContactMode::any)),
      first_(asked(request, ContactMode::first)), apart_(askedOfState(request)) {
  first_.margin += 2 * request.tolerance_distance;
  // Decided before the room is used up.
  apart_.margin += request.tolerance_distance;
  apart_.tolerance_distance *= 0.5;
}

ContinuousMotionValidator::ContinuousMotionValidator(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                     const CertifiedRequest& request)
    : ContinuousMotionValidator(si, manager, allJoints(si, manager), request) {}

bool ContinuousMotionValidator::checkMotion(const ob::State* s1, const ob::State* s2) const {
  return count(provenFree(mapping_.motion(s1, s2)));
}

/// Planners go on from the motion's end. Where initial contacts are ignored there must be none, nor what may be taken for
/// one: the next motion would lead on through it.
bool ContinuousMotionValidator::provenFree(const JointMotion& motion) const {
  CertifiedResult& result = scratch();
  manager_->continuousCollide(motion, any_, result);
  return result.isFree() && (!any_.ignore_initial_contact || apartAt(motion, 1));
}

bool ContinuousMotionValidator::apartAt(const JointMotion& motion, double t) const {
  CertifiedResult& result = scratch();
  manager_->collide(motion.configuration(t), apart_, result);
  return result.isFree();
}

/// The gap at the first contact's t_lower may be next to nothing: planners would go on from a state that no motion
/// leaves, and that can't be told from one in contact. So the time is asked for with a margin; the verdict is not. What
/// was within the margin at the start, where that is ignored, must not touch without it, and be left behind by then.
/// @return a time up to which the motion is proven free; 1: all of it.
double ContinuousMotionValidator::freeWithRoom(const JointMotion& motion) const {
  CertifiedResult& result = scratch();
  const auto freeUntil = [&](const CertifiedRequest& request) {
    manager_->continuousCollide(motion, request, result);
    return result.isFree() ? 1 : result.t_lower;
  };
  const double t = freeUntil(first_);
  if (result.ignored_initial_contacts.empty()) return t;
  CertifiedRequest without = first_;
  without.margin = any_.margin;
  const double least = std::min(t, freeUntil(without));
  return apartAt(motion, least) ? least : 0;
}

bool ContinuousMotionValidator::checkMotion(const ob::State* s1, const ob::State* s2,
                                            std::pair<ob::State*, double>& lastValid) const try {
  const JointMotion motion = mapping_.motion(s1, s2);
  if (provenFree(motion)) return count(true);
  const double t = freeWithRoom(motion);
  if (t == 1) return count(true);  // a budget ran out in the other order of work
  lastValid.second = t;
  if (lastValid.first && lastValid.second > 0) {
    si_->getStateSpace()->interpolate(s1, s2, lastValid.second, lastValid.first);  // may write to s1 or s2
  } else if (lastValid.first && lastValid.first != s1) {
    si_->copyState(lastValid.first, s1);
  }
  return count(false);
} catch (...) {  // nothing but the start is left in the caller's hands
  lastValid.second = 0;
  if (lastValid.first && lastValid.first != s1) si_->copyState(lastValid.first, s1);
  throw;
}

/// The base class counts in plain members and its getters can't be overridden: so its members are what is counted in, by
/// atomic additions (C++17 has none for an integer that is not std::atomic, GCC and Clang have).
bool ContinuousMotionValidator::count(bool valid) const {
  __atomic_fetch_add(valid ? &valid_ : &invalid_, 1u, __ATOMIC_RELAXED);
  return valid;
}
unsigned int ContinuousMotionValidator::getValidMotionCount() const { return __atomic_load_n(&valid_, __ATOMIC_RELAXED); }
unsigned int ContinuousMotionValidator::getInvalidMotionCount() const {
  return __atomic_load_n(&invalid_, __ATOMIC_RELAXED);
}
double ContinuousMotionValidator::getValidMotionFraction() const {
  const double valid = getValidMotionCount(), invalid = getInvalidMotionCount();
  return valid == 0 ? 0 : valid / (valid + invalid);
}
void ContinuousMotionValidator::resetMotionCounter() {
  __atomic_store_n(&valid_, 0u, __ATOMIC_RELAXED);
  __atomic_store_n(&invalid_, 0u, __ATOMIC_RELAXED);
}

CollisionStateValidityChecker::CollisionStateValidityChecker(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                             JointMapping mapping, const CertifiedRequest& request)
    : ob::StateValidityChecker(required(si, manager)), manager_(std::move(manager)),
      mapping_(ofManager(std::move(mapping), manager_)), request_(askedOfState(request)) {}

CollisionStateValidityChecker::CollisionStateValidityChecker(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                             const CertifiedRequest& request)
    : CollisionStateValidityChecker(si, manager, allJoints(si, manager), request) {}

bool CollisionStateValidityChecker::isValid(const ob::State* state) const {
  thread_local Eigen::VectorXd q;
  mapping_.configuration(state, q);
  CertifiedResult& result = scratch();
  manager_->collide(q, request_, result);
  return result.isFree();
}

}  // namespace fcl_artic::planning
