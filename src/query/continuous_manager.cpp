// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/continuous_manager.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "fcl/fcl_geometry.h"
#include "fcl/fcl_motion.h"
#include "geometry/box_overlap.h"
#include "model/bracket.h"
#include "numerics/constants.h"
#include "numerics/shown.h"
#include "query/claim_nothing.h"
#include "query/engine_query.h"
#include "query/pair_query.h"

namespace fcl_artic {
namespace {

using Object = fcl::ContinuousCollisionObjectd;
using Geometry = fcl::CollisionGeometryd;

/// Ends of unbounded boxes: far beyond all coordinates allowed (1e9 m), but finite, as trees are built of finite
/// numbers.
constexpr double kFarAway = 1e29;

/// A moving object, as it was read.
struct Item {
  Object* object = nullptr;
  std::shared_ptr<const Geometry> geometry;
  std::shared_ptr<const ShapeTree> shape;
  BodyMotion motion;
  BoxBounds box = {};  ///< in the world, over all of the motion
};

/// @param what  begins the messages.
Item readObject(const Object& object, const std::string& what) {
  Item item;
  item.geometry = object.collisionGeometry();
  if (!item.geometry) throw std::invalid_argument(what + " has no geometry");
  const fcl::MotionBased* motion = object.getMotion();
  if (!motion) {
    throw std::invalid_argument(
        what + " (" + geometryName(*item.geometry) +
        ") has no motion; what stands still has a TranslationMotion from its pose to the same pose");
  }
  try {
    item.shape = cachedGeometry(*item.geometry);
    item.motion = readMotion(*motion);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(what + ": " + e.what());
  }
  Eigen::Vector3d lower, upper;
  enclosePath(item.motion, item.shape->lower(), item.shape->upper(), lower, upper);
  for (int k = 0; k < 3; ++k) {  // written so that NaN, too, ends far away
    item.box.lo[k] = lower[k] > -kFarAway ? std::min(lower[k], kFarAway) : -kFarAway;
    item.box.hi[k] = upper[k] < kFarAway ? std::max(upper[k], -kFarAway) : kFarAway;
  }
  return item;
}

Item readObject(Object* object, const std::string& what) {
  if (!object) throw std::invalid_argument(what + " is null");
  Item item = readObject(*object, what);
  item.object = object;
  return item;
}

fcl::AABBd publicBox(const BoxBounds& box) {
  fcl::AABBd aabb;
  for (int k = 0; k < 3; ++k) {
    aabb.min_[k] = box.lo[k] > -kFarAway ? box.lo[k] : -kInfinity;
    aabb.max_[k] = box.hi[k] < kFarAway ? box.hi[k] : kInfinity;
  }
  return aabb;
}

/// The box grown by the margin to all sides: a sum of doubles is at most one step from the true one, in any rounding
/// mode.
BoxBounds grown(const BoxBounds& box, double margin) {
  if (margin == 0) return box;
  BoxBounds out;
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = std::nextafter(box.lo[k] - margin, -kInfinity);
    out.hi[k] = std::nextafter(box.hi[k] + margin, kInfinity);
  }
  return out;
}

void requireQuery(ContinuousCollisionManager::Callback callback, double margin) {
  if (!callback) throw std::invalid_argument("collide: the callback is null");
  if (!(margin >= 0) || !std::isfinite(margin)) {
    throw std::invalid_argument("collide: the margin is " + shown(margin) + ", not a number >= 0");
  }
}

/// Runs a query; nothing is claimed before it has answered.
template <class Query>
void answerPairs(CertifiedPairsResult& result, Query&& query) {
  const auto reset = [&] { result = CertifiedPairsResult(); };
  reset();
  resetUnlessAnswered(reset, query);
}

/// Collects the answers of pairs into one.
class Earliest {
 public:
  /// @throws std::invalid_argument for a request that solvePair() refuses.
  Earliest(const CertifiedPairRequest& request, CertifiedPairsResult& result) : request_(request), result_(result) {
    makeQuery(request);
    if (request.certificate) {
      throw std::invalid_argument(
          "ContinuousCollisionManager: there are no certificates of many pairs; ask collide() of each two objects");
    }
    if (request.measure_times) begin_ = Clock::now();
    request_.progress = nullptr;
  }

  /// @return true when nothing that follows can change the answer.
  bool operator()(const Item& a, const Item& b) {
    MovingPair pair;
    pair.object1 = a.object;
    pair.object2 = b.object;
    const std::uint64_t work = countedWork(result_.statistics);
    const std::uint64_t budget = request_.work_budget;
    const bool spent = budget != 0 && work >= budget;
    if (spent) {  // the pair stays undecided from t = 0 on
      pair.result.tf1_at_lower = a.motion.pose(0);
      pair.result.tf2_at_lower = b.motion.pose(0);
      pair.result.tf1_at_upper = a.motion.pose(1);
      pair.result.tf2_at_upper = b.motion.pose(1);
    } else {
      request_.work_budget = budget == 0 ? 0 : budget - work;
      solvePair({*a.shape, a.motion, a.geometry.get()}, {*b.shape, b.motion, b.geometry.get()}, request_, pair.result);
      request_.work_budget = budget;
      add(pair.result.statistics);
    }
    if (pair.result.ignored_initial_contact) result_.ignored_initial_contacts.emplace_back(a.object, b.object);
    result_.never_apart_pairs += pair.result.never_apart;
    if (pair.result.isFree()) return false;

    const CertifiedPairResult& r = pair.result;
    if (request_.mode == ContactMode::any && r.status == Status::contact && r.certain) {
      // The pairs that follow are not asked, so nothing is claimed about the time before the contact.
      first_ = {};
      engine::joinLower(first_, 0);
      engine::joinUpper(first_, engine::provenBy(r));
      result_.pairs.clear();
      result_.pairs.push_back(std::move(pair));
      return true;
    }
    engine::joinLower(first_, r.t_lower);
    engine::joinUpper(first_, engine::provenBy(r));
    if (request_.mode == ContactMode::firstOfEveryPair || result_.pairs.empty()) {
      result_.pairs.push_back(std::move(pair));
    } else if (r.t_lower < result_.pairs[0].result.t_lower) {
      result_.pairs[0] = std::move(pair);
    }
    const CertifiedPairResult& first = result_.pairs[0].result;
    return spent || (request_.mode == ContactMode::first && first.certain && first.t_upper == 0);
  }

  /// @param pairs  number of pairs that were asked about.
  void finish(std::size_t pairs) {
    std::stable_sort(result_.pairs.begin(), result_.pairs.end(),
                     [](const MovingPair& a, const MovingPair& b) { return a.result.t_lower < b.result.t_lower; });
    if (result_.pairs.empty()) {
      result_.status = Status::free;
      result_.t_lower = 1;
    } else {
      const CertifiedPairResult& first = result_.pairs[0].result;
      result_.status = first.status;
      result_.t_lower = first_.t_lower;
      result_.t_upper = std::min(1.0, first_.t_upper);
      const bool close = engine::isCertain(first_, request_.tolerance_time, false);
      result_.certain = first.status == Status::contact && (first.certain || close);
    }
    result_.statistics.pairs = pairs;
    if (request_.measure_times) {
      result_.statistics.total_us = std::chrono::duration<double, std::micro>(Clock::now() - begin_).count();
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  void add(const QueryStatistics& s) {
    ++result_.statistics.pairs_after_culling;
    addWork(s, result_.statistics);
  }

  CertifiedPairRequest request_;
  CertifiedPairsResult& result_;
  engine::FirstContact first_;  ///< of all pairs that are not free; if any contact ended the search, of its pair
  Clock::time_point begin_;
};

}  // namespace

fcl::AABBd sweptAABB(const fcl::ContinuousCollisionObjectd& object) {
  return publicBox(readObject(object, "sweptAABB: the object").box);
}

struct ContinuousCollisionManager::Impl {
  std::vector<Item> items;                               ///< in order of registration
  std::unordered_map<const Object*, std::size_t> index;  ///< into items
  bool ready = true;                                     ///< as long as there is nothing to set up

  // Made by build(), read by queries.
  std::vector<BoxBounds> boxes;
  std::vector<engine::Node> tree;

  void add(Object* object, const std::string& what) {
    if (index.count(object)) throw std::invalid_argument(what + " is registered already");
    items.push_back(readObject(object, what));
    index[object] = items.size() - 1;
    ready = false;
  }
  void build() {
    boxes.clear();
    for (const Item& item : items) boxes.push_back(item.box);
    tree = buildBoxTree(boxes);
    ready = true;
  }
  void requireReady() const {
    if (!ready) throw std::logic_error("ContinuousCollisionManager: call setup() after changing the objects");
  }
  const Item& item(int i) const { return items[static_cast<std::size_t>(i)]; }
  const Item* find(const Object* object) const {
    const auto known = index.find(object);
    return known == index.end() ? nullptr : &items[known->second];
  }
  /// Indices in order, of items from `begin` on whose boxes come near the box.
  void near(const BoxBounds& box, double margin, int begin, std::vector<int>& found) const {
    found.clear();
    appendOverlaps(tree, boxes, grown(box, margin), found);
    found.erase(std::remove_if(found.begin(), found.end(), [=](int i) { return i < begin; }), found.end());
    std::sort(found.begin(), found.end());
  }

  // The three kinds of query: each calls visit(item, item) for all pairs whose boxes meet, until it returns true, and
  // returns the number of all pairs.

  template <class Visit>
  std::size_t visitOwn(double margin, Visit&& visit) const {
    requireReady();
    const std::size_t n = items.size(), pairs = n == 0 ? 0 : n * (n - 1) / 2;
    std::vector<int> found;
    for (std::size_t i = 0; i < n; ++i) {
      near(items[i].box, margin, static_cast<int>(i) + 1, found);
      for (const int j : found) {
        if (visit(items[i], item(j))) return pairs;
      }
    }
    return pairs;
  }

  template <class Visit>
  std::size_t visitObject(Object* object, double margin, Visit&& visit) const {
    requireReady();
    Item read;
    const Item* one = find(object);
    const std::size_t pairs = items.size() - (one ? 1 : 0);
    if (!one) {
      read = readObject(object, "collide: the object");
      one = &read;
    }
    std::vector<int> found;
    near(one->box, margin, 0, found);
    for (const int j : found) {
      if (item(j).object != object && visit(*one, item(j))) break;
    }
    return pairs;
  }

  template <class Visit>
  std::size_t visitOther(const ContinuousCollisionManager* other_manager, double margin, Visit&& visit) const {
    if (!other_manager) throw std::invalid_argument("collide: the other manager is null");
    const Impl& other = *other_manager->impl_;
    if (&other == this) return visitOwn(margin, visit);
    requireReady();
    other.requireReady();
    std::size_t shared = 0;
    for (const Item& item : items) shared += other.index.count(item.object);
    const std::size_t pairs =
        items.size() * other.items.size() - shared - (shared == 0 ? 0 : shared * (shared - 1) / 2);
    std::vector<int> found;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Item& a = items[i];
      other.near(a.box, margin, 0, found);
      for (const int j : found) {
        const Item& b = other.item(j);
        if (a.object == b.object) continue;
        if (shared > 0 && other.index.count(a.object)) {
          const auto b_here = index.find(b.object);
          if (b_here != index.end() && b_here->second < i) continue;  // came as (b, a)
        }
        if (visit(a, b)) return pairs;
      }
    }
    return pairs;
  }
};

ContinuousCollisionManager::ContinuousCollisionManager() : impl_(std::make_unique<Impl>()) {}
ContinuousCollisionManager::~ContinuousCollisionManager() = default;
ContinuousCollisionManager::ContinuousCollisionManager(ContinuousCollisionManager&&) noexcept = default;
ContinuousCollisionManager& ContinuousCollisionManager::operator=(ContinuousCollisionManager&&) noexcept = default;

void ContinuousCollisionManager::registerObject(Object* object) {
  impl_->add(object, "registerObject: the object");
}

void ContinuousCollisionManager::registerObjects(const std::vector<Object*>& objects) {
  const std::size_t before = size();
  const bool ready = impl_->ready;
  try {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      impl_->add(objects[i], "registerObjects: object " + std::to_string(i));
    }
  } catch (...) {
    while (size() > before) {
      impl_->index.erase(impl_->items.back().object);
      impl_->items.pop_back();
    }
    impl_->ready = ready;
    throw;
  }
}

void ContinuousCollisionManager::unregisterObject(Object* object) {
  const auto known = impl_->index.find(object);
  if (known == impl_->index.end()) throw std::invalid_argument("unregisterObject: the object is not registered");
  const std::size_t i = known->second;
  impl_->index.erase(known);
  impl_->items.erase(impl_->items.begin() + static_cast<std::ptrdiff_t>(i));
  for (std::size_t j = i; j < size(); ++j) impl_->index[impl_->items[j].object] = j;
  impl_->ready = false;
}

void ContinuousCollisionManager::setup() {
  if (!impl_->ready) impl_->build();
}

void ContinuousCollisionManager::update() {
  std::vector<Object*> objects;
  getObjects(objects);
  update(objects);
}

void ContinuousCollisionManager::update(Object* object) {
  update(std::vector<Object*>{object});
}

void ContinuousCollisionManager::update(const std::vector<Object*>& objects) {
  std::vector<Item> items;  // all or nothing
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::string what = "update: object " + std::to_string(i);
    if (!impl_->find(objects[i])) throw std::invalid_argument(what + " is not registered");
    items.push_back(readObject(objects[i], what));
  }
  for (Item& item : items) impl_->items[impl_->index[item.object]] = std::move(item);
  impl_->build();
}

void ContinuousCollisionManager::clear() {
  *impl_ = Impl();
}

void ContinuousCollisionManager::getObjects(std::vector<Object*>& objects) const {
  objects.clear();
  for (const Item& item : impl_->items) objects.push_back(item.object);
}

std::size_t ContinuousCollisionManager::size() const {
  return impl_->items.size();
}

fcl::AABBd ContinuousCollisionManager::sweptAABB(const Object* object) const {
  const Item* item = impl_->find(object);
  if (!item) throw std::invalid_argument("sweptAABB: the object is not registered");
  return publicBox(item->box);
}

void ContinuousCollisionManager::collide(void* cdata, Callback callback, double margin) const {
  requireQuery(callback, margin);
  impl_->visitOwn(margin, [&](const Item& a, const Item& b) { return callback(a.object, b.object, cdata); });
}

void ContinuousCollisionManager::collide(Object* object, void* cdata, Callback callback, double margin) const {
  requireQuery(callback, margin);
  impl_->visitObject(object, margin, [&](const Item& a, const Item& b) { return callback(a.object, b.object, cdata); });
}

void ContinuousCollisionManager::collide(const ContinuousCollisionManager* other, void* cdata, Callback callback,
                                         double margin) const {
  requireQuery(callback, margin);
  impl_->visitOther(other, margin, [&](const Item& a, const Item& b) { return callback(a.object, b.object, cdata); });
}

void ContinuousCollisionManager::continuousCollide(const CertifiedPairRequest& request,
                                                   CertifiedPairsResult& result) const {
  answerPairs(result, [&] {
    Earliest earliest(request, result);
    earliest.finish(impl_->visitOwn(marginsOf(request).largest(), earliest));
  });
}

void ContinuousCollisionManager::continuousCollide(Object* object, const CertifiedPairRequest& request,
                                                   CertifiedPairsResult& result) const {
  answerPairs(result, [&] {
    Earliest earliest(request, result);
    earliest.finish(impl_->visitObject(object, marginsOf(request).largest(), earliest));
  });
}

void ContinuousCollisionManager::continuousCollide(const ContinuousCollisionManager* other,
                                                   const CertifiedPairRequest& request,
                                                   CertifiedPairsResult& result) const {
  answerPairs(result, [&] {
    Earliest earliest(request, result);
    earliest.finish(impl_->visitOther(other, marginsOf(request).largest(), earliest));
  });
}

}  // namespace fcl_artic
