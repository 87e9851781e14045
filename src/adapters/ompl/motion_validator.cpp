// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/ompl/motion_validator.h"

#include <algorithm>
#include <stdexcept>

#include <ompl/base/ScopedState.h>

namespace fcl_artic::planning {
namespace {

namespace ob = ::ompl::base;
using ManagerPtr = std::shared_ptr<const ArticulatedCollisionManager>;

/// Memory for answers: nothing is read from the last one.
CertifiedResult& scratch() {
  thread_local CertifiedResult result;
  return result;
}

/// An edge of a plan has no time of its own: every query would begin with moving obstacles where they are at t = 0.
const ArticulatedCollisionManager& requireStill(const ArticulatedCollisionManager& manager) {
  thread_local std::vector<const fcl::ContinuousCollisionObjectd*> moving;
  manager.getObjects(moving);
  if (moving.empty() && !manager.hasSpeeds()) return manager;
  throw std::invalid_argument(
      "planning: an obstacle moves, and each edge of a plan would begin where the obstacle does: plan without it, and "
      "ask the manager about the whole trajectory with its times");
}

/// Checks the constructors' arguments before any of them is used.
const ob::SpaceInformationPtr& required(const ob::SpaceInformationPtr& si, const ManagerPtr& manager) {
  if (!si) throw std::invalid_argument("planning: the space information is null");
  if (!manager) throw std::invalid_argument("planning: the manager is null");
  requireStill(*manager);
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
  request.max_contacts = 0;  // the verdict is all that is wanted
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

// A lemma for planners. M is a pair's margin, its own or the request's, with what the request adds to it, and delta the
// request's tolerance_distance. A state s is *apart* when collide() proves, at the configuration that the mapping reads
// from s, that all pairs are farther than M + delta from each other: roomAt(s).
//
// Lemma. Let s_0, ..., s_n be states of which each motion s_k -> s_k+1 was accepted, or s_k+1 is the last valid state,
// at a time > 0, of a motion from s_k. With ignore_initial_contact: on any s_k -> s_k+1 with k >= 1 nothing comes
// within its margin, no pair excepted. On s_0 -> s_1 the only exceptions are pairs that touch at s_0 (no proof holds
// them apart there), until they have separated. If s_0 is apart, there is no exception. Without ignore_initial_contact
// nothing is excepted at all.
//
// Proof. Each s_k -> s_k+1 is proven by provenFree(), that to a last valid state too, but for pairs that are ignored.
// Its end is apart (1): both checkMotion() ask roomAt(s_k+1). From a state that is apart nothing is ignored (2):
// ignoring() asks roomAt(s_k), the same query of the same numbers, which gives the same answer. QED
//
// Neither the kind of planner nor the order of its questions matters, as both are questions about a state. The proof
// needs (2). Take a pair that is delta from touching: nothing promises that a query which ignores initial contacts sees
// it as apart at t = 0.
//
// The room is added to every pair's margin (added_margin), those of its own too. A pair whose own margin is 0, beside a
// request with a larger one, has the room as others do.
ContinuousMotionValidator::ContinuousMotionValidator(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                     JointMapping mapping, const CertifiedRequest& request)
    : ob::MotionValidator(required(si, manager)),
      manager_(std::move(manager)),
      mapping_(ofManager(std::move(mapping), manager_)),
      any_(asked(request, ContactMode::any)),
      first_(asked(request, ContactMode::first)),
      apart_(askedOfState(request)) {
  // Twice the room that a state must have: the state is the motion's up to roundings, and a query may leave the last
  // half open.
  first_.added_margin += 2 * request.tolerance_distance;
  apart_.added_margin += request.tolerance_distance;
  apart_.tolerance_distance *= 0.5;
  apart_.visibility = VisibilityMode::off;  // it might leave to the clock which of two proofs is tried
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): kept, by the constructor that this one calls
ContinuousMotionValidator::ContinuousMotionValidator(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                     const CertifiedRequest& request)
    : ContinuousMotionValidator(si, manager, allJoints(si, manager), request) {}

bool ContinuousMotionValidator::checkMotion(const ob::State* s1, const ob::State* s2) const {
  return count(provenFree(mapping_.motion(s1, s2), s2, ignoring(s1)));
}

/// Whether a state is apart: valid by itself, and to be left again.
bool ContinuousMotionValidator::roomAt(const ob::State* state) const {
  thread_local Eigen::VectorXd q;
  mapping_.configuration(state, q);
  CertifiedResult& result = scratch();
  requireStill(*manager_).collide(q, apart_, result);
  return result.isFree();
}

/// Whether pairs that touch at the start of a motion from this state are ignored.
bool ContinuousMotionValidator::ignoring(const ob::State* s1) const {
  return any_.ignore_initial_contact && !roomAt(s1);
}

bool ContinuousMotionValidator::provenFree(const JointMotion& motion, const ob::State* s2, bool ignoring) const {
  CertifiedRequest request = any_;
  request.ignore_initial_contact = ignoring;
  CertifiedResult& result = scratch();
  requireStill(*manager_).continuousCollide(motion, request, result);
  return result.isFree() && (!any_.ignore_initial_contact || roomAt(s2));
}

/// The gap at the first contact's t_lower may be tiny: planners would go on from a state that no motion can leave, and
/// that no proof separates from contact. So the time, but not the verdict, is asked for with a larger margin. A pair
/// that is ignored because it is within the larger margin at the start must still not touch without that margin.
/// @return a time up to which the motion is proven free; 1: all of it.
double ContinuousMotionValidator::timeWithRoom(const JointMotion& motion, bool ignoring) const {
  CertifiedResult& result = scratch();
  const auto freeUntil = [&](CertifiedRequest request) {
    request.ignore_initial_contact = ignoring;
    requireStill(*manager_).continuousCollide(motion, request, result);
    return result.isFree() ? 1 : result.t_lower;
  };
  const double t = freeUntil(first_);
  if (result.ignored_initial_contacts.empty()) return t;
  CertifiedRequest without = first_;
  without.added_margin = any_.added_margin;
  return std::min(t, freeUntil(without));
}

bool ContinuousMotionValidator::checkMotion(const ob::State* s1, const ob::State* s2,
                                            std::pair<ob::State*, double>& lastValid) const try {
  const JointMotion motion = mapping_.motion(s1, s2);
  const bool ignored = ignoring(s1);
  if (provenFree(motion, s2, ignored)) return count(true);
  double t = timeWithRoom(motion, ignored);
  if (t == 1 && roomAt(s2)) return count(true);  // a budget ran out in the other order of work
  ob::ScopedState<> last(si_->getStateSpace());
  if (t > 0) {
    si_->getStateSpace()->interpolate(s1, s2, t, last.get());
    // The motion to the state itself: that is not quite the first part of the one to s2 (JointMapping on orientations).
    if (!roomAt(last.get()) || !provenFree(mapping_.motion(s1, last.get()), last.get(), ignored)) t = 0;
  }
  if (lastValid.first && (t > 0 || lastValid.first != s1)) {  // which may be s1 or s2
    si_->copyState(lastValid.first, t > 0 ? last.get() : s1);
  }
  lastValid.second = t;
  return count(false);
} catch (...) {  // nothing but the start is left in the caller's hands
  lastValid.second = 0;
  if (lastValid.first && lastValid.first != s1) si_->copyState(lastValid.first, s1);
  throw;
}

/// The base class counts in plain members, and its getters can't be overridden. So its members are counted up by atomic
/// additions, which GCC and Clang have. (C++17 has none for an integer that is not std::atomic.)
bool ContinuousMotionValidator::count(bool valid) const {
  __atomic_fetch_add(valid ? &valid_ : &invalid_, 1u, __ATOMIC_RELAXED);
  return valid;
}
unsigned int ContinuousMotionValidator::getValidMotionCount() const {
  return __atomic_load_n(&valid_, __ATOMIC_RELAXED);
}
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
    : ob::StateValidityChecker(required(si, manager)),
      manager_(std::move(manager)),
      mapping_(ofManager(std::move(mapping), manager_)),
      request_(askedOfState(request)) {}

// NOLINTNEXTLINE(performance-unnecessary-value-param): kept, by the constructor that this one calls
CollisionStateValidityChecker::CollisionStateValidityChecker(const ob::SpaceInformationPtr& si, ManagerPtr manager,
                                                             const CertifiedRequest& request)
    : CollisionStateValidityChecker(si, manager, allJoints(si, manager), request) {}

bool CollisionStateValidityChecker::isValid(const ob::State* state) const {
  thread_local Eigen::VectorXd q;
  mapping_.configuration(state, q);
  CertifiedResult& result = scratch();
  requireStill(*manager_).collide(q, request_, result);
  return result.isFree();
}

}  // namespace fcl_artic::planning
