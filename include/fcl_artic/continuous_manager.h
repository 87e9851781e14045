// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcl/broadphase/broadphase_continuous_collision_manager.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "fcl_artic/export.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/request.h"

namespace fcl_artic {

/// Returns a box in the world, m, that is proven to hold the object at every time of its motion, rounding included;
/// infinite where the object is unbounded. (fcl::ContinuousCollisionObject::computeAABB() does not hold the motion;
/// this function neither calls it nor changes what getAABB() returns.)
/// @throws std::invalid_argument for a null geometry or motion, and for what fcl_artic::continuousCollide() refuses of
///   either.
FCL_ARTIC_EXPORT fcl::AABBd sweptAABB(const fcl::ContinuousCollisionObjectd& object);

/// Two moving objects and the answer for them.
struct MovingPair {
  fcl::ContinuousCollisionObjectd* object1 = nullptr;  ///< The first object: as registered, or as given to the query.
  fcl::ContinuousCollisionObjectd* object2 = nullptr;  ///< The second object, as registered.
  /// The pair's own verdict, bracket, contacts and poses; body 1 is object1.
  CertifiedPairResult result;
};

/// The answer for many moving objects: verdict and bracket of all pairs together (Bracket), and the pairs found. A
/// query writes every field; if it throws, the result is reset to its defaults.
struct CertifiedPairsResult : Bracket {
  /// Pairs that are not proven free, in the order of their t_lower, and of registration if that is the same. With
  /// ContactMode::firstOfEveryPair these are all (if the work budget runs out, up to the first pair that it leaves
  /// undecided). With ContactMode::first it is only the first. With ContactMode::any it is one whose contact is
  /// proven, if any is.
  std::vector<MovingPair> pairs;
  /// Pairs that touch at t = 0 and were ignored (CertifiedPairRequest::ignore_initial_contact).
  std::vector<std::pair<fcl::ContinuousCollisionObjectd*, fcl::ContinuousCollisionObjectd*>> ignored_initial_contacts;
  /// Number of these that are proven apart, by their margin, nowhere on the motion: `free` says nothing of them.
  std::size_t never_apart_pairs = 0;
  /// Work, summed over the pairs. `pairs` counts all pairs asked about, `pairs_after_culling` those whose boxes meet.
  QueryStatistics statistics;
};

/// Returns what a free motion's answer does not cover, in the words of exceptionsOf(const CertifiedResult&).
FCL_ARTIC_EXPORT std::string exceptionsOf(const CertifiedPairsResult& result);
/// Prints verdict and bracket on one line, without a line end, and what `free` does not speak of.
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const CertifiedPairsResult& result);

/// Certified continuous collision detection of many moving objects, in FCL's manager idiom: boxes around whole motions
/// decide which pairs may meet. FCL's BroadPhaseContinuousCollisionManager is no base of this class: its collide()
/// takes callbacks for pairs of *still* objects, so that no moving pair could be delivered through it.
///
/// Objects, geometries and motions stay the caller's, are never written to, and must stay alive while registered. An
/// object is read when it is registered or updated: call update() after its motion or geometry was changed in place. An
/// object without motion is refused; one that stands still has a motion from a pose to the same pose,
/// `fcl::TranslationMotiond(tf, tf)`. Many still objects that touch each other are best kept in a manager of their own,
/// to be asked against the moving ones.
///
/// After setup() all const members may be called from many threads at once. Members that are not const must not run
/// beside any other. A manager that was moved from may only be destroyed or assigned to.
class FCL_ARTIC_EXPORT ContinuousCollisionManager {
 public:
  /// FCL's type of moving objects.
  using Object = fcl::ContinuousCollisionObjectd;
  /// Function that gets the two objects of a pair and cdata, and returns true to stop.
  using Callback = fcl::ContinuousCollisionCallBack<double>;

  /// Creates a manager without objects.
  ContinuousCollisionManager();
  /// Releases the objects, which stay the caller's.
  ~ContinuousCollisionManager();
  /// Takes over all objects of another manager.
  ContinuousCollisionManager(ContinuousCollisionManager&&) noexcept;
  /// Takes over all objects of another manager.
  ContinuousCollisionManager& operator=(ContinuousCollisionManager&&) noexcept;

  /// Adds an object. Needs setup().
  /// @param object  kept as a pointer; must stay alive until it is unregistered.
  /// @throws std::invalid_argument: null, registered already, or what sweptAABB() throws. Nothing is changed then.
  void registerObject(Object* object);
  /// Adds objects: all of them or, if this throws, none. Needs setup().
  /// @throws std::invalid_argument as registerObject(), naming the object by its index.
  void registerObjects(const std::vector<Object*>& objects);
  /// Removes an object. Needs setup().
  /// @throws std::invalid_argument if it is not registered.
  void unregisterObject(Object* object);

  /// Makes all changes effective. Needed before the first query and after objects were registered or unregistered.
  /// Reads no object again; update() does.
  void setup();
  /// Reads motions and geometries of all objects again, and makes all changes effective. (For a mesh that has not
  /// changed, this costs a comparison.)
  /// @throws std::invalid_argument for what sweptAABB() refuses. Nothing is changed then.
  void update();
  /// Reads motion and geometry of one object again, and makes all changes effective.
  /// @throws std::invalid_argument if it is not registered, or for what sweptAABB() refuses. Nothing is changed then.
  void update(Object* object);
  /// Reads motions and geometries of these objects again, and makes all changes effective.
  /// @throws std::invalid_argument if one is not registered, or for what sweptAABB() refuses. Nothing is changed then.
  void update(const std::vector<Object*>& objects);
  /// Removes all objects.
  void clear();

  /// Lists the objects in the order of registration.
  /// @param[out] objects  replaced.
  void getObjects(std::vector<Object*>& objects) const;
  /// Number of objects.
  std::size_t size() const;
  /// Whether there is no object.
  bool empty() const { return size() == 0; }
  /// Returns the swept box of a registered object, as it was read last (fcl_artic::sweptAABB()).
  /// @throws std::invalid_argument if it is not registered.
  fcl::AABBd sweptAABB(const Object* object) const;

  /// Hands every pair of registered objects whose swept boxes come within `margin` of each other to the callback, once,
  /// until it returns true. All pairs that come so near at some time are among them. Pairs, and the two objects of
  /// each, come in the order of registration.
  /// @param cdata   passed to the callback.
  /// @param margin  m, finite, at least 0; for callbacks that ask whether objects come nearer than that.
  /// @throws std::logic_error if objects were registered or unregistered after the last setup() or update().
  /// @throws std::invalid_argument: callback null, margin negative or not finite.
  void collide(void* cdata, Callback callback, double margin = 0) const;
  /// Hands every pair of one object and a registered one whose swept boxes come within `margin` of each other to the
  /// callback, once, until it returns true. The object comes first, and is not paired with itself.
  /// @param object  need not be registered; it is read by this call then, else it is taken as it was read last.
  /// @param cdata   passed to the callback.
  /// @param margin  m, finite, at least 0.
  /// @throws std::logic_error if objects were registered or unregistered after the last setup() or update().
  /// @throws std::invalid_argument: callback null, margin negative or not finite, what registerObject() refuses of an
  ///   object.
  void collide(Object* object, void* cdata, Callback callback, double margin = 0) const;
  /// Hands pairs of an object of this manager and one of another manager to the callback, until it returns true. These
  /// are all pairs whose swept boxes come within `margin` of each other, each once. The object of this manager comes
  /// first. An object is not paired with itself; two objects that are in both managers are paired once.
  /// @param other   not null; may be this manager.
  /// @param cdata   passed to the callback.
  /// @param margin  m, finite, at least 0.
  /// @throws std::logic_error if objects of either manager were registered or unregistered after its last setup() or
  ///   update().
  /// @throws std::invalid_argument: `other` or callback null, margin negative or not finite.
  void collide(const ContinuousCollisionManager* other, void* cdata, Callback callback, double margin = 0) const;

  /// Finds the first contact of all pairs of registered objects, or proves that there is none.
  /// @param request  max_contacts is per pair, work_budget for all pairs together; progress is not called.
  /// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
  /// @throws std::invalid_argument for tolerances that are not positive numbers, and margins that are negative or not
  ///   finite.
  /// @throws std::logic_error as collide().
  void continuousCollide(const CertifiedPairRequest& request, CertifiedPairsResult& result) const;
  /// Finds the first contact of one object with the registered ones, or proves that there is none. The object is not
  /// paired with itself, and is object1 of each MovingPair.
  /// @param object   need not be registered; it is read by this call then, else it is taken as it was read last.
  /// @param request  as for all pairs of registered objects.
  /// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
  /// @throws std::invalid_argument, std::logic_error as for all pairs, and for what registerObject() refuses of an
  ///   object.
  void continuousCollide(Object* object, const CertifiedPairRequest& request, CertifiedPairsResult& result) const;
  /// Finds the first contact of the objects of this manager with those of another one, or proves that there is none. An
  /// object is not paired with itself; two objects that are in both managers are paired once.
  /// @param other    not null; may be this manager.
  /// @param request  as for all pairs of registered objects.
  /// @param[out] result  written in full; reset (undecided on [0, 1]) if this throws.
  /// @throws std::invalid_argument, std::logic_error as for all pairs, for either manager, and if `other` is null.
  void continuousCollide(const ContinuousCollisionManager* other, const CertifiedPairRequest& request,
                         CertifiedPairsResult& result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
