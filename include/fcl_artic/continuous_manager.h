// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <fcl/broadphase/broadphase_continuous_collision_manager.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "fcl_artic/export.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/request.h"

namespace fcl_artic {

/// Box in the world that certainly holds the object at every time of its motion, rounding included; infinite where the
/// object is. (fcl::ContinuousCollisionObject::computeAABB() does not hold the motion; this neither calls it nor
/// changes what getAABB() returns.)
/// @throws std::invalid_argument: null geometry or motion, and what fcl_artic::continuousCollide refuses of either.
FCL_ARTIC_EXPORT fcl::AABBd sweptAABB(const fcl::ContinuousCollisionObjectd& object);

/// Two moving objects and what was found of them.
struct MovingPair {
  fcl::ContinuousCollisionObjectd* object1 = nullptr;
  fcl::ContinuousCollisionObjectd* object2 = nullptr;
  CertifiedPairResult result;
};

/// The answer for many moving objects. Always written in full.
struct CertifiedPairsResult : Bracket {
  /// Empty when free. Otherwise the pair with the earliest t_lower comes first; with ContactMode::first it is the only
  /// one, with firstOfEveryPair all that are not proven free follow. Pairs of the same t_lower are in order of
  /// registration.
  std::vector<MovingPair> pairs;
  /// Pairs that touch at t = 0, where that was ignored (CertifiedPairRequest::ignore_initial_contact).
  std::vector<std::pair<fcl::ContinuousCollisionObjectd*, fcl::ContinuousCollisionObjectd*>> ignored_initial_contacts;
  QueryStatistics statistics;  ///< summed over the pairs
};

/// Continuous collision of many moving objects, in FCL's manager idiom: boxes around whole motions tell which pairs may
/// meet. What FCL declares for this, BroadPhaseContinuousCollisionManager, is no base of this class: its collide()
/// takes callbacks for pairs of *still* objects, so that no moving pair could be delivered through it.
///
/// Objects, geometries and motions stay the caller's and are never written to. An object is read when it is registered
/// or updated: whoever then changes its motion or geometry in place calls update(). An object without motion is
/// refused; one that stands still has a motion from a pose to the same pose, `fcl::TranslationMotiond(tf, tf)`. Many
/// still objects that touch each other are best kept in a manager of their own, to be asked against the moving ones.
///
/// After setup() all const members may be called from many threads at once.
class FCL_ARTIC_EXPORT ContinuousCollisionManager {
 public:
  using Object = fcl::ContinuousCollisionObjectd;
  /// Is given two objects and cdata; returns true to stop.
  using Callback = fcl::ContinuousCollisionCallBack<double>;

  ContinuousCollisionManager();
  ~ContinuousCollisionManager();
  ContinuousCollisionManager(ContinuousCollisionManager&&) noexcept;
  ContinuousCollisionManager& operator=(ContinuousCollisionManager&&) noexcept;

  /// @throws std::invalid_argument: null, registered already, or what sweptAABB() throws. Nothing is changed then.
  void registerObject(Object* object);
  void registerObjects(const std::vector<Object*>& objects);
  /// @throws std::invalid_argument when it is not registered.
  void unregisterObject(Object* object);

  /// Makes all changes effective; needed before the first query and after objects were registered or unregistered.
  void setup();
  /// Reads motions and geometries again, of all objects or of some, and makes all changes effective. (Of a mesh that is
  /// what it was, that costs a comparison.)
  /// @throws std::invalid_argument as registerObject(); when one is not registered. Nothing is changed then.
  void update();
  void update(Object* object);
  void update(const std::vector<Object*>& objects);
  void clear();

  /// In order of registration.
  void getObjects(std::vector<Object*>& objects) const;
  std::size_t size() const;
  bool empty() const { return size() == 0; }
  /// sweptAABB() of a registered object, as it was read last.
  fcl::AABBd sweptAABB(const Object* object) const;

  /// Hands every pair whose swept boxes come within `margin` of each other to the callback, once, until it returns
  /// true: all that touch at some time are among them. Pairs and their objects come in order of registration.
  /// @param margin  m; for callbacks that ask whether objects come nearer than that.
  /// @throws std::logic_error when objects were registered or unregistered after the last setup() or update().
  /// @throws std::invalid_argument: callback null, margin negative or not finite.
  void collide(void* cdata, Callback callback, double margin = 0) const;
  /// One object against all registered ones but itself. It need not be registered, and is read then; else it is taken
  /// as read last.
  /// @throws std::invalid_argument also what registerObject() throws of an object.
  void collide(Object* object, void* cdata, Callback callback, double margin = 0) const;
  /// Objects of this manager, which come first, against those of another one. An object is not paired with itself; two
  /// that are in both managers are paired once.
  void collide(const ContinuousCollisionManager* other, void* cdata, Callback callback, double margin = 0) const;

  /// First contact of all pairs of registered objects, or the proof that there is none.
  /// @param request  check_scene and check_self have no meaning here, progress is not called. max_contacts is per pair,
  ///   work_budget for all of them together.
  /// When it throws, the result is reset: undecided on [0, 1].
  /// @throws std::invalid_argument for a tolerance that is not a positive number (0 is none), and a margin that is
  ///   negative or not finite.
  /// @throws std::logic_error as collide().
  void continuousCollide(const CertifiedPairRequest& request, CertifiedPairsResult& result) const;
  /// The same for the pairs that the corresponding collide() asks about.
  void continuousCollide(Object* object, const CertifiedPairRequest& request, CertifiedPairsResult& result) const;
  void continuousCollide(const ContinuousCollisionManager* other, const CertifiedPairRequest& request,
                         CertifiedPairsResult& result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
