// SPDX-License-Identifier: BSD-3-Clause
//
// The continuous broad phase against brute force: all pairs by fcl_artic::collide() of two objects.
#include "fcl_artic/continuous_manager.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <thread>

#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/solid_mesh.h"

namespace fcl_artic {
namespace continuous_manager_test {
namespace {

using Eigen::Vector3d;
using Object = fcl::ContinuousCollisionObjectd;
using Pairs = std::set<std::pair<const Object*, const Object*>>;

fcl::Transform3d at(double x, double y, double z) {
  return fcl::Transform3d(Eigen::Translation3d(x, y, z));
}

std::unique_ptr<Object> make(const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
                             const std::shared_ptr<fcl::MotionBased>& motion) {
  return std::make_unique<Object>(geometry, motion);
}
std::unique_ptr<Object> sphere(double radius, const fcl::Transform3d& from, const fcl::Transform3d& to) {
  return make(std::make_shared<fcl::Sphered>(radius), std::make_shared<fcl::TranslationMotiond>(from, to));
}

/// A cube of 2 m, closed.
std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> cubeMesh() {
  std::vector<Vector3d> v;
  for (int i = 0; i < 8; ++i) v.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  const std::size_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<fcl::Triangle> t;
  for (const auto& s : sides) {
    t.emplace_back(s[0], s[1], s[2]);
    t.emplace_back(s[0], s[2], s[3]);
  }
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  mesh->beginModel();
  mesh->addSubModel(v, t);
  mesh->endModel();
  return mesh;
}

class Scene {
 public:
  /// Objects of all shapes and motions that start somewhere in a cube.
  Scene(int seed, int count, double size, double way) : random_(static_cast<unsigned>(seed)) {
    for (int i = 0; i < count; ++i) objects.push_back(make(geometry(i), motion(i, size, way)));
  }
  std::vector<Object*> pointers() const {
    std::vector<Object*> all;
    for (const auto& object : objects) all.push_back(object.get());
    return all;
  }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vector3d vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }

  std::vector<std::unique_ptr<Object>> objects;

 private:
  std::shared_ptr<fcl::CollisionGeometryd> geometry(int i) {
    switch (i % 5) {
      case 0:
        return std::make_shared<fcl::Boxd>(uniform(0.1, 0.6), uniform(0.1, 0.6), uniform(0.1, 0.6));
      case 1:
        return std::make_shared<fcl::Sphered>(uniform(0.1, 0.3));
      case 2:
        return std::make_shared<fcl::Capsuled>(uniform(0.05, 0.2), uniform(0.1, 0.5));
      case 3:
        return std::make_shared<fcl::Cylinderd>(uniform(0.05, 0.2), uniform(0.1, 0.5));
      default: {
        auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
        mesh->beginModel();
        for (int k = 0; k < 4; ++k) mesh->addTriangle(vector(0.3), vector(0.3), vector(0.3));
        mesh->endModel();
        return mesh;
      }
    }
  }
  std::shared_ptr<fcl::MotionBased> motion(int i, double size, double way) {
    fcl::Transform3d from = fcl::Transform3d::Identity(), to = from;
    from.translation() = vector(size / 2);
    to.translation() = from.translation() + vector(way);
    const Vector3d turn = vector(2);
    from.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    const Vector3d more = vector(1.8);
    to.linear() = from.linear() * Eigen::AngleAxisd(more.norm(), more.normalized()).toRotationMatrix();
    switch (i % 4) {
      case 0:
        return std::make_shared<fcl::TranslationMotiond>(from, to);
      case 1: {
        const Vector3d reference = vector(0.3);
        return std::make_shared<fcl::InterpMotion<double>>(from.linear(), from.translation(), to.linear(),
                                                           to.translation(), reference);
      }
      case 2:
        return std::make_shared<fcl::ScrewMotion<double>>(from, to);
      default: {
        Vector3d t[4], r[4];
        for (int k = 0; k < 4; ++k) {
          t[k] = from.translation() + vector(way);
          r[k] = vector(1.5);
        }
        return std::make_shared<fcl::SplineMotion<double>>(t[0], t[1], t[2], t[3], r[0], r[1], r[2], r[3]);
      }
    }
  }
  std::mt19937_64 random_;
};

Status ask(const Object* a, const Object* b, CertifiedPairResult& result) {
  return collide(a, b, CertifiedRequest(), result);
}

Pairs pairsThatTouch(const std::vector<Object*>& objects) {
  Pairs pairs;
  CertifiedPairResult result;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size(); ++j) {
      if (ask(objects[i], objects[j], result) != Status::free) pairs.emplace(objects[i], objects[j]);
    }
  }
  return pairs;
}

struct Delivery {
  std::vector<std::pair<const Object*, const Object*>> pairs;
  std::size_t stop_after = 0;  ///< 0: never
  Pairs set() const { return Pairs(pairs.begin(), pairs.end()); }
};
bool deliver(Object* a, Object* b, void* data) {
  auto& delivery = *static_cast<Delivery*>(data);
  delivery.pairs.emplace_back(a, b);
  return delivery.pairs.size() == delivery.stop_after;
}

bool subset(const Pairs& part, const Pairs& whole) {
  return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

bool overlap(const fcl::AABBd& a, const fcl::AABBd& b) {
  return (a.min_.array() <= b.max_.array()).all() && (b.min_.array() <= a.max_.array()).all();
}

template <class Operation>
void expectRefused(Operation&& operation, const std::string& why) {
  try {
    operation();
    FAIL() << "not refused: " << why;
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
  }
}

// A ball on its way within a cube: free of its surface, not of the solid, whoever asks.
TEST(ContinuousManager, SolidMeshes) {
  for (const bool solid : {false, true}) {
    const auto mesh = cubeMesh();
    const std::shared_ptr<fcl::CollisionGeometryd> cube = solid ? makeSolid(*mesh) : mesh;
    const auto still = std::make_shared<fcl::TranslationMotiond>(at(0, 0, 0), at(0, 0, 0));
    const auto around = make(cube, still), within = sphere(0.1, at(-0.5, 0, 0), at(0.5, 0, 0)),
               beside = sphere(0.1, at(2, 0, 0), at(3, 0, 0));
    ContinuousCollisionManager manager, other;
    manager.registerObjects({around.get(), beside.get()});
    other.registerObject(within.get());
    manager.setup();
    other.setup();
    const Status wanted = solid ? Status::contact : Status::free;
    CertifiedPairsResult result;
    manager.continuousCollide(CertifiedRequest(), result);
    EXPECT_EQ(result.status, Status::free);
    manager.continuousCollide(within.get(), CertifiedRequest(), result);
    EXPECT_EQ(result.status, wanted);
    manager.continuousCollide(&other, CertifiedRequest(), result);
    EXPECT_EQ(result.status, wanted);
    manager.registerObject(within.get());
    manager.setup();
    manager.continuousCollide(CertifiedRequest(), result);
    EXPECT_EQ(result.status, wanted);
    if (!solid) continue;
    ASSERT_EQ(result.pairs.size(), 1u);
    EXPECT_EQ(result.t_lower, 0);
    EXPECT_EQ(result.t_upper, 0);
    EXPECT_TRUE(result.certain);
  }
}

void expectSame(const CertifiedPairResult& a, const CertifiedPairResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.t_lower, b.t_lower);
  EXPECT_EQ(a.t_upper, b.t_upper);
  EXPECT_EQ(a.certain, b.certain);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) EXPECT_EQ(a.contacts[i].point, b.contacts[i].point);
}

TEST(BroadPhaseTest, AllAgainstAllDeliversWhatTouchesAndLittleMore) {
  for (const int seed : {1, 2, 3}) {
    const Scene scene(seed, 120, 7, 1);
    ContinuousCollisionManager manager;
    manager.registerObjects(scene.pointers());
    manager.setup();
    Delivery delivery;
    manager.collide(&delivery, deliver);

    const Pairs delivered = delivery.set(), touching = pairsThatTouch(scene.pointers());
    EXPECT_EQ(delivered.size(), delivery.pairs.size()) << "a pair came twice, seed " << seed;
    EXPECT_TRUE(subset(touching, delivered)) << "seed " << seed;
    EXPECT_GT(touching.size(), 10u);
    EXPECT_LT(delivered.size(), 120 * 119 / 2 / 20);
    Pairs boxes_meet;
    const auto all = scene.pointers();
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        if (overlap(sweptAABB(*all[i]), sweptAABB(*all[j]))) boxes_meet.emplace(all[i], all[j]);
      }
    }
    EXPECT_EQ(delivered, boxes_meet);
    const auto indices = [&](const std::pair<const Object*, const Object*>& pair) {
      const auto index = [&](const Object* object) { return std::find(all.begin(), all.end(), object) - all.begin(); };
      return std::make_pair(index(pair.first), index(pair.second));
    };
    EXPECT_TRUE(std::is_sorted(delivery.pairs.begin(), delivery.pairs.end(),
                               [&](const auto& a, const auto& b) { return indices(a) < indices(b); }));
  }
}

TEST(BroadPhaseTest, OneAgainstAllRegisteredOrNot) {
  const Scene scene(4, 100, 5, 2);
  std::vector<Object*> all = scene.pointers();
  const Pairs touching = pairsThatTouch(all);
  const std::vector<Object*> guests(all.end() - 10, all.end());
  ContinuousCollisionManager manager;
  manager.registerObjects({all.begin(), all.end() - 10});
  manager.setup();
  std::size_t hits = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Delivery delivery;
    manager.collide(all[i], &delivery, deliver);
    std::set<const Object*> found;
    for (const auto& [a, b] : delivery.pairs) {
      EXPECT_EQ(a, all[i]);
      EXPECT_NE(b, all[i]);
      EXPECT_TRUE(found.insert(b).second);
    }
    for (std::size_t j = 0; j + 10 < all.size(); ++j) {
      if (j == i || touching.count({all[std::min(i, j)], all[std::max(i, j)]}) == 0) continue;
      EXPECT_EQ(found.count(all[j]), 1u) << i << " " << j;
      ++hits;
    }
    EXPECT_LT(found.size(), all.size() / 2);
  }
  EXPECT_GT(hits, 50u);
}

TEST(BroadPhaseTest, ManagerAgainstManagerGivesEachPairOnce) {
  const Scene scene(5, 90, 4, 1);
  const std::vector<Object*> all = scene.pointers();
  const Pairs touching = pairsThatTouch(all);
  // Objects 30 to 59 are in both.
  ContinuousCollisionManager first, second;
  first.registerObjects({all.begin(), all.begin() + 60});
  second.registerObjects({all.begin() + 30, all.end()});
  first.setup();
  second.setup();
  Delivery delivery;
  first.collide(&second, &delivery, deliver);
  Pairs found, asked;
  for (const auto& [a, b] : delivery.pairs) {
    EXPECT_NE(a, b);
    EXPECT_TRUE(found.insert(std::minmax(a, b)).second) << "a pair came twice";
  }
  std::size_t hits = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    for (std::size_t j = std::max<std::size_t>(i + 1, 30); j < 90; ++j) {
      asked.insert(std::minmax<const Object*>(all[i], all[j]));
      if (touching.count({all[i], all[j]})) {
        EXPECT_EQ(found.count(std::minmax<const Object*>(all[i], all[j])), 1u) << i << " " << j;
        ++hits;
      }
    }
  }
  EXPECT_TRUE(subset(found, asked));
  EXPECT_GT(hits, 30u);
  CertifiedPairsResult result;
  first.continuousCollide(&second, CertifiedRequest(), result);
  EXPECT_EQ(result.statistics.pairs, asked.size());

  Delivery own, same;
  first.collide(&own, deliver);
  first.collide(&first, &same, deliver);
  EXPECT_FALSE(own.pairs.empty());
  EXPECT_EQ(own.pairs, same.pairs);
}

TEST(BroadPhaseTest, TrueStops) {
  const Scene scene(6, 60, 3, 1);
  ContinuousCollisionManager manager, other;
  manager.registerObjects(scene.pointers());
  manager.setup();
  other.registerObjects(scene.pointers());
  other.setup();
  Delivery all;
  manager.collide(&all, deliver);
  ASSERT_GT(all.pairs.size(), 20u);
  for (const std::size_t after : {1u, 7u}) {
    Delivery delivery, against, one;
    delivery.stop_after = against.stop_after = after;
    one.stop_after = 1;
    manager.collide(&delivery, deliver);
    EXPECT_EQ(delivery.pairs.size(), after);
    EXPECT_TRUE(std::equal(delivery.pairs.begin(), delivery.pairs.end(), all.pairs.begin()));
    manager.collide(&other, &against, deliver);
    EXPECT_EQ(against.pairs.size(), after);
    auto* busy = const_cast<Object*>(all.pairs[0].first);
    manager.collide(busy, &one, deliver);
    EXPECT_EQ(one.pairs.size(), 1u);
  }
}

TEST(BroadPhaseTest, FirstContactIsTheEarliestOfAllPairs) {
  int certain = 0, free = 0, several = 0;
  for (int seed = 10; seed < 30; ++seed) {
    const Scene scene(seed, 24, seed < 25 ? 3 : 9, 1);
    const std::vector<Object*> all = scene.pointers();
    ContinuousCollisionManager manager;
    manager.registerObjects(all);
    manager.setup();
    // A pair that touches from the beginning would always win.
    std::vector<MovingPair> truth;
    CertifiedRequest request;
    request.ignore_initial_contact = true;
    double t_upper = 1;
    std::size_t ignored = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        MovingPair pair{all[i], all[j], {}};
        collide(all[i], all[j], request, pair.result);
        ignored += pair.result.ignored_initial_contact;
        if (pair.result.isFree()) continue;
        truth.push_back(pair);
        t_upper = std::min(t_upper, pair.result.t_upper);
      }
    }
    std::stable_sort(truth.begin(), truth.end(),
                     [](const MovingPair& a, const MovingPair& b) { return a.result.t_lower < b.result.t_lower; });
    CertifiedPairsResult result;
    manager.continuousCollide(request, result);
    EXPECT_EQ(result.ignored_initial_contacts.size(), ignored);
    EXPECT_EQ(result.statistics.pairs, 24u * 23 / 2);
    EXPECT_LT(result.statistics.pairs_after_culling, result.statistics.pairs / 2);
    several += truth.size() > 3;
    if (truth.empty()) {
      ++free;
      EXPECT_TRUE(result.isFree());
      EXPECT_EQ(result.t_lower, 1);
      EXPECT_TRUE(result.pairs.empty());
      continue;
    }
    EXPECT_EQ(result.status, Status::contact);
    EXPECT_EQ(result.t_lower, truth[0].result.t_lower);
    EXPECT_EQ(result.t_upper, t_upper);
    certain += result.certain;
    ASSERT_EQ(result.pairs.size(), 1u);
    EXPECT_EQ(result.pairs[0].object1, truth[0].object1);
    EXPECT_EQ(result.pairs[0].object2, truth[0].object2);
    expectSame(result.pairs[0].result, truth[0].result);

    request.mode = ContactMode::firstOfEveryPair;
    manager.continuousCollide(request, result);
    ASSERT_EQ(result.pairs.size(), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_EQ(result.pairs[i].object1, truth[i].object1);
      EXPECT_EQ(result.pairs[i].object2, truth[i].object2);
      expectSame(result.pairs[i].result, truth[i].result);
    }
  }
  EXPECT_GE(certain, 10);
  EXPECT_GE(several, 5);
  EXPECT_GE(free, 1);
}

TEST(BroadPhaseTest, AnyContactEndsTheSearch) {
  int contacts = 0, free = 0;
  std::uint64_t asked = 0, asked_for_the_first = 0;
  for (int seed = 10; seed < 40; ++seed) {
    const Scene scene(seed, 24, seed < 30 ? 3 : 9, 1);
    ContinuousCollisionManager manager;
    manager.registerObjects(scene.pointers());
    manager.setup();
    CertifiedRequest request;
    request.ignore_initial_contact = true;
    CertifiedPairsResult first, any;
    manager.continuousCollide(request, first);
    request.mode = ContactMode::any;
    manager.continuousCollide(request, any);
    asked_for_the_first += first.statistics.pairs_after_culling;
    asked += any.statistics.pairs_after_culling;
    EXPECT_EQ(any.status, first.status);
    if (any.isFree()) {
      ++free;
      continue;
    }
    // No more may be claimed about times before the contact than is known of all pairs.
    EXPECT_LE(any.t_lower, first.t_upper);
    EXPECT_GE(any.t_upper, first.t_lower);
    if (!any.certain) continue;
    ++contacts;
    ASSERT_EQ(any.pairs.size(), 1u);
    CertifiedPairResult alone;
    collide(any.pairs[0].object1, any.pairs[0].object2, request, alone);
    expectSame(any.pairs[0].result, alone);
    EXPECT_TRUE(alone.certain);
    EXPECT_EQ(any.t_upper, alone.t_upper);
  }
  EXPECT_GE(contacts, 15);
  EXPECT_GE(free, 1);
  EXPECT_LT(2 * asked, asked_for_the_first);
}

TEST(BroadPhaseTest, ContactTimeInClosedForm) {
  // Two spheres of radius 0.5 meet when their centres are 1 apart: 10 - 12 t = 1. Nothing shows of the other, later
  // pair.
  const auto a = sphere(0.5, at(0, 0, 0), at(6, 0, 0)), b = sphere(0.5, at(10, 0, 0), at(4, 0, 0));
  const auto c = sphere(0.5, at(0, 5, 0), at(6, 5, 0)), d = sphere(0.5, at(11, 5, 0), at(5, 5, 0));
  ContinuousCollisionManager manager;
  manager.registerObjects({c.get(), d.get(), a.get(), b.get()});
  manager.setup();
  CertifiedPairsResult result;
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_EQ(result.status, Status::contact);
  EXPECT_TRUE(result.certain);
  EXPECT_LE(result.t_lower, 0.75);
  EXPECT_GE(result.t_upper, 0.75);
  EXPECT_LT(result.t_upper - result.t_lower, 2e-6);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].object1, a.get());
  EXPECT_EQ(result.pairs[0].object2, b.get());

  manager.continuousCollide(d.get(), CertifiedRequest(), result);  // 11 - 12 t = 1
  EXPECT_NEAR(result.t_lower, 5.0 / 6, 2e-6);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].object1, d.get());
  EXPECT_EQ(result.pairs[0].object2, c.get());
}

TEST(BroadPhaseTest, EqualTimesGoByRegistration) {
  const auto still = sphere(0.5, at(0, 0, 0), at(0, 0, 0));
  const auto first = sphere(0.5, at(5, 0, 0), at(0, 0, 0)), second = sphere(0.5, at(5, 0, 0), at(0, 0, 0));
  for (const bool swapped : {false, true}) {
    ContinuousCollisionManager movers, scene;
    movers.registerObjects(swapped ? std::vector<Object*>{second.get(), first.get()}
                                   : std::vector<Object*>{first.get(), second.get()});
    movers.setup();
    scene.registerObject(still.get());
    scene.setup();
    CertifiedPairsResult result;
    movers.continuousCollide(&scene, CertifiedRequest(), result);
    ASSERT_EQ(result.pairs.size(), 1u);
    EXPECT_EQ(result.pairs[0].object1, swapped ? second.get() : first.get());
  }
}

TEST(BroadPhaseTest, UpdateAfterMotionOrGeometryChanged) {
  const auto geometry = std::make_shared<fcl::Sphered>(0.5);
  const auto motion = std::make_shared<fcl::TranslationMotiond>(at(0, 0, 0), at(0, 0, 4));
  const auto a = make(geometry, motion), b = sphere(0.5, at(5, 0, 0), at(5, 0, 4));
  ContinuousCollisionManager manager;
  manager.registerObjects({a.get(), b.get()});
  manager.setup();
  CertifiedPairsResult result;
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_TRUE(result.isFree());

  *motion = fcl::TranslationMotiond(at(0, 0, 0), at(8, 0, 4));  // 1 apart at t = 1/2
  manager.update(a.get());
  EXPECT_GE(manager.sweptAABB(a.get()).max_[0], 8.5);
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_EQ(result.status, Status::contact);
  EXPECT_NEAR(result.t_lower, 0.5, 2e-6);

  *motion = fcl::TranslationMotiond(at(0, 0, 0), at(0, 0, 4));
  manager.update();
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_TRUE(result.isFree());

  geometry->radius = 4.6;
  manager.update(std::vector<Object*>{a.get(), b.get()});
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_EQ(result.status, Status::contact);
  EXPECT_EQ(result.t_lower, 0);

  manager.unregisterObject(a.get());
  manager.registerObject(a.get());
  EXPECT_EQ(manager.sweptAABB(b.get()).min_[0], sweptAABB(*b).min_[0]);
  manager.unregisterObject(b.get());
  EXPECT_THROW(manager.continuousCollide(CertifiedRequest(), result), std::logic_error);
  manager.setup();
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_TRUE(result.isFree());
  EXPECT_EQ(manager.size(), 1u);
  manager.clear();
  EXPECT_TRUE(manager.empty());
}

TEST(BroadPhaseTest, FloorIsMetFromAnyDistance) {
  const auto floor = make(std::make_shared<fcl::Halfspaced>(Vector3d::UnitZ(), 0),
                          std::make_shared<fcl::TranslationMotiond>(at(0, 0, 0), at(0, 0, 0)));
  const auto falling = sphere(0.5, at(4000, -7000, 2), at(4000, -7000, 0));  // meets the floor at t = 3/4
  const auto flying = sphere(0.5, at(0, 0, 2), at(5, 0, 2));
  ContinuousCollisionManager manager;
  manager.registerObjects({flying.get(), floor.get(), falling.get()});
  manager.setup();
  EXPECT_EQ(manager.sweptAABB(floor.get()).min_[2], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(manager.sweptAABB(floor.get()).max_[0], std::numeric_limits<double>::infinity());
  Delivery delivery;
  manager.collide(&delivery, deliver);
  EXPECT_EQ(delivery.set().count({floor.get(), falling.get()}), 1u);
  EXPECT_EQ(delivery.set().count({flying.get(), falling.get()}), 0u);
  CertifiedPairsResult result;
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_EQ(result.status, Status::contact);
  EXPECT_TRUE(result.certain);
  EXPECT_NEAR(result.t_lower, 0.75, 2e-6);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(result.pairs[0].object2, falling.get());
}

TEST(BroadPhaseTest, SweptBoxesHoldThePathAndNotMuchMore) {
  // FCL's computeAABB() crashes for the first of these motions and cuts the others' paths off.
  Scene scene(7, 100, 4, 3);
  double slack = 0;
  int motions = 0;
  for (const auto& object : scene.objects) {
    const fcl::AABBd box = sweptAABB(*object);
    const fcl::CollisionGeometryd& geometry = *object->collisionGeometry();
    std::shared_ptr<fcl::MotionBased> copy;
    const fcl::MotionBased* motion = object->getMotion();
    if (const auto* m = dynamic_cast<const fcl::TranslationMotiond*>(motion)) {
      copy = std::make_shared<fcl::TranslationMotiond>(*m);
    } else if (const auto* m = dynamic_cast<const fcl::InterpMotion<double>*>(motion)) {
      copy = std::make_shared<fcl::InterpMotion<double>>(*m);
    } else if (const auto* m = dynamic_cast<const fcl::ScrewMotion<double>*>(motion)) {
      copy = std::make_shared<fcl::ScrewMotion<double>>(*m);
    } else {
      copy = std::make_shared<fcl::SplineMotion<double>>(dynamic_cast<const fcl::SplineMotion<double>&>(*motion));
    }
    fcl::AABBd seen;
    for (int k = 0; k < 100; ++k) {
      fcl::Transform3d M;
      copy->integrate(k < 2 ? k : scene.uniform(0, 1));
      copy->getCurrentTransform(M);
      for (int p = 0; p < 10; ++p) {
        Vector3d x = scene.vector(1);
        if (const auto* sphere = dynamic_cast<const fcl::Sphered*>(&geometry)) {
          x = sphere->radius * x.normalized();
        } else if (const auto* shape = dynamic_cast<const fcl::Boxd*>(&geometry)) {
          x = 0.5 * shape->side.cwiseProduct(x.cwiseSign());
        } else if (const auto* shape = dynamic_cast<const fcl::Capsuled*>(&geometry)) {
          x = shape->radius * x.normalized() + Vector3d(0, 0, std::copysign(0.5 * shape->lz, x[2]));
        } else if (const auto* shape = dynamic_cast<const fcl::Cylinderd*>(&geometry)) {
          x << shape->radius * x.head<2>().normalized(), std::copysign(0.5 * shape->lz, x[2]);
        } else {
          const auto& mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>&>(geometry);
          x = mesh.vertices[p % mesh.num_vertices];
        }
        x = M * x;
        seen += x;
        // FCL's own poses are rounded.
        ASSERT_TRUE((box.min_.array() <= x.array() + 1e-13).all() && (box.max_.array() >= x.array() - 1e-13).all())
            << motions << ": " << x.transpose();
      }
    }
    slack += (box.max_ - box.min_).maxCoeff() / (seen.max_ - seen.min_).maxCoeff();
    ++motions;
  }
  EXPECT_LT(slack / motions, 1.25);  // boxes of the shapes' boxes, turned
}

TEST(BroadPhaseTest, MarginReachesFartherThanTheBoxes) {
  const auto a = sphere(0.5, at(0, 0, 0), at(0, 0, 4)), b = sphere(0.5, at(1.3, 0, 4), at(1.3, 0, 0));  // pass at 0.3
  ContinuousCollisionManager manager;
  manager.registerObjects({a.get(), b.get()});
  manager.setup();
  CertifiedRequest request;
  CertifiedPairsResult result;
  for (const double margin : {0.0, 0.299, 0.301}) {
    request.margin = margin;
    Delivery delivery;
    manager.collide(&delivery, deliver, margin);
    EXPECT_EQ(delivery.pairs.size(), margin > 0.3 ? 1u : 0u);
    manager.continuousCollide(request, result);
    EXPECT_EQ(result.isFree(), margin < 0.3) << margin;
    manager.continuousCollide(a.get(), request, result);
    EXPECT_EQ(result.isFree(), margin < 0.3) << margin;
  }
}

TEST(BroadPhaseTest, SpentBudgetIsUndecided) {
  const Scene scene(8, 40, 3, 1);
  ContinuousCollisionManager manager;
  manager.registerObjects(scene.pointers());
  manager.setup();
  CertifiedRequest request;
  request.ignore_initial_contact = true;
  CertifiedPairsResult whole, part;
  manager.continuousCollide(request, whole);
  ASSERT_EQ(whole.status, Status::contact);
  const std::uint64_t work = whole.statistics.node_tests + whole.statistics.leaf_tests;
  int undecided = 0;
  for (const std::uint64_t budget : {std::uint64_t{1}, work / 4, work / 2, 2 * work}) {
    request.work_budget = budget;
    manager.continuousCollide(request, part);
    EXPECT_FALSE(part.isFree());
    EXPECT_LE(part.t_lower, whole.t_upper);
    if (budget < work) {
      EXPECT_LT(part.statistics.node_tests + part.statistics.leaf_tests, budget + work / 4);
    }
    if (budget > work) {
      EXPECT_EQ(part.status, Status::contact);
      EXPECT_EQ(part.t_lower, whole.t_lower);
    }
    if (part.status == Status::undecided) {
      ++undecided;
      EXPECT_FALSE(part.certain);
    }
  }
  EXPECT_GE(undecided, 2);
}

TEST(BroadPhaseTest, EightThreadsGiveOneAnswer) {
  const Scene scene(9, 80, 4, 1);
  ContinuousCollisionManager manager;
  manager.registerObjects(scene.pointers());
  manager.setup();
  CertifiedRequest request;
  request.mode = ContactMode::firstOfEveryPair;
  CertifiedPairsResult alone;
  manager.continuousCollide(request, alone);
  ASSERT_GT(alone.pairs.size(), 20u);
  std::vector<CertifiedPairsResult> results(8);
  std::vector<Delivery> deliveries(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < 8; ++i) {
    threads.emplace_back([&, i] {
      manager.continuousCollide(request, results[i]);
      manager.collide(&deliveries[i], deliver);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(deliveries[i].pairs, deliveries[0].pairs);
    ASSERT_EQ(results[i].pairs.size(), alone.pairs.size());
    for (std::size_t k = 0; k < alone.pairs.size(); ++k) {
      EXPECT_EQ(results[i].pairs[k].object1, alone.pairs[k].object1);
      EXPECT_EQ(results[i].pairs[k].object2, alone.pairs[k].object2);
      expectSame(results[i].pairs[k].result, alone.pairs[k].result);
    }
  }
}

TEST(BroadPhaseTest, BadInputIsRefusedAndChangesNothing) {
  const auto a = sphere(0.5, at(0, 0, 0), at(2, 0, 0)), b = sphere(0.5, at(2, 0, 0), at(0, 0, 0));
  const auto stranger = sphere(0.5, at(0, 3, 0), at(0, 3, 0));
  Object motionless(std::make_shared<fcl::Sphered>(1)),
      shapeless(nullptr, std::make_shared<fcl::TranslationMotiond>(at(0, 0, 0), at(0, 0, 0)));
  const auto flat = std::make_shared<fcl::Boxd>(1, 1, 1);
  flat->side[1] = std::nan("");
  const auto not_finite = make(flat, std::make_shared<fcl::TranslationMotiond>(at(0, 0, 0), at(0, 0, 0)));
  Object* const null = nullptr;

  ContinuousCollisionManager manager;
  manager.registerObjects({a.get(), b.get()});
  manager.setup();
  expectRefused([&] { manager.registerObject(null); }, "registerObject: the object is null");
  expectRefused([&] { manager.registerObject(a.get()); }, "registerObject: the object is registered already");
  expectRefused([&] { manager.registerObject(&motionless); }, "(Sphere) has no motion");
  expectRefused([&] { manager.registerObject(&shapeless); }, "has no geometry");
  expectRefused([&] { manager.registerObject(not_finite.get()); }, "Box");
  expectRefused([&] { manager.registerObjects({stranger.get(), null}); }, "object 1 is null");
  expectRefused([&] { manager.registerObjects({stranger.get(), stranger.get()}); }, "object 1 is registered already");
  expectRefused([&] { manager.unregisterObject(stranger.get()); }, "unregisterObject: the object is not registered");
  expectRefused([&] { manager.update(stranger.get()); }, "update: object 0 is not registered");
  expectRefused([&] { manager.update(std::vector<Object*>{a.get(), null}); }, "object 1 is not registered");
  expectRefused([&] { manager.sweptAABB(stranger.get()); }, "sweptAABB: the object is not registered");
  expectRefused([&] { sweptAABB(motionless); }, "has no motion");
  expectRefused([&] { manager.collide(nullptr, nullptr); }, "callback is null");
  Delivery delivery;
  expectRefused([&] { manager.collide(&delivery, deliver, -1); }, "margin");
  expectRefused([&] { manager.collide(&delivery, deliver, std::nan("")); }, "margin");
  expectRefused([&] { manager.collide(null, &delivery, deliver); }, "the object is null");
  const ContinuousCollisionManager* const no_manager = nullptr;
  expectRefused([&] { manager.collide(no_manager, &delivery, deliver); }, "manager is null");
  CertifiedPairsResult result;
  result.status = Status::free;
  CertifiedRequest request;
  request.margin = -1;
  expectRefused([&] { manager.continuousCollide(request, result); }, "margin");
  EXPECT_EQ(result.status, Status::undecided);
  EXPECT_TRUE(delivery.pairs.empty());

  std::vector<Object*> objects;
  manager.getObjects(objects);
  EXPECT_EQ(objects, (std::vector<Object*>{a.get(), b.get()}));
  manager.collide(&delivery, deliver);  // still set up
  EXPECT_EQ(delivery.pairs.size(), 1u);
  manager.registerObject(stranger.get());
  EXPECT_THROW(manager.collide(&delivery, deliver), std::logic_error);
}

TEST(BroadPhaseTest, EmptyManagerIsFree) {
  const ContinuousCollisionManager manager;
  CertifiedPairsResult result;
  manager.continuousCollide(CertifiedRequest(), result);
  EXPECT_TRUE(result.isFree());
  EXPECT_EQ(result.statistics.pairs, 0u);
}

TEST(BroadPhaseTest, FclsDefaultCallbackKeepsTheEarliest) {
  // Four spheres on two parallel lines: pairs meet at 3/4 and 5/6; FCL's callback keeps what came last.
  const auto a = sphere(0.5, at(0, 0, 0), at(6, 0, 0)), b = sphere(0.5, at(10, 0, 0), at(4, 0, 0));
  const auto c = sphere(0.5, at(0, 5, 0), at(6, 5, 0)), d = sphere(0.5, at(11, 5, 0), at(5, 5, 0));
  const std::vector<Object*> one_order{a.get(), b.get(), c.get(), d.get()};
  for (const std::vector<Object*>& order : {one_order, {one_order.rbegin(), one_order.rend()}}) {
    ContinuousCollisionManager manager;
    manager.registerObjects(order);
    manager.setup();
    fcl::DefaultContinuousCollisionData<double> data;
    data.request.toc_err = 1e-6;
    manager.collide(&data, fcl_artic::DefaultContinuousCollisionFunction<double>);
    EXPECT_TRUE(data.result.is_collide);
    EXPECT_NEAR(data.result.time_of_contact, 0.75, 2e-6);
    EXPECT_FALSE(data.done);
    CertifiedPairsResult result;
    manager.continuousCollide(CertifiedRequest(), result);
    EXPECT_EQ(data.result.time_of_contact, result.t_lower);
  }
}

// A thousand moving objects, a motion with more states than its ends, and the poses at contact.
TEST(BroadPhaseTest, Fcl419HowToUseAContinuousManager) {
  std::vector<std::unique_ptr<Object>> objects;
  const auto geometry = std::make_shared<fcl::Sphered>(0.3);
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      for (int z = 0; z < 10; ++z) {
        objects.push_back(
            make(geometry, std::make_shared<fcl::TranslationMotiond>(at(x, y, z), at(x + 1.5, y + 1.5, z + 1.5))));
      }
    }
  }
  // Through four control points, from far away into the swarm, which itself moves in parallel and stays clear.
  const Vector3d zero = Vector3d::Zero();
  objects.push_back(
      make(std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2),
           std::make_shared<fcl::SplineMotion<double>>(Vector3d(20, 0, 0), Vector3d(18, 4, 4), Vector3d(6, 6, 6),
                                                       Vector3d(-6, 6, 6), zero, zero, zero, zero)));
  ContinuousCollisionManager manager;
  for (const auto& object : objects) manager.registerObject(object.get());
  manager.setup();
  CertifiedPairsResult result;
  manager.continuousCollide(CertifiedRequest(), result);
  ASSERT_EQ(result.status, Status::contact);
  ASSERT_TRUE(result.certain);
  EXPECT_EQ(result.pairs[0].object2, objects.back().get());

  const MovingPair& pair = result.pairs[0];
  const auto touchAt = [&](const fcl::Transform3d& tf1, const fcl::Transform3d& tf2) {
    fcl::CollisionRequestd request;
    fcl::CollisionResultd contact;
    return fcl::collide(pair.object1->collisionGeometry().get(), tf1, pair.object2->collisionGeometry().get(), tf2,
                        request, contact) > 0;
  };
  EXPECT_FALSE(touchAt(pair.result.tf1_at_lower, pair.result.tf2_at_lower));
  EXPECT_TRUE(touchAt(pair.result.tf1_at_upper, pair.result.tf2_at_upper));
}

// One body of several parts that move against each other: continuous self-collision by collide() of the manager itself.
TEST(BroadPhaseTest, Fcl523SelfCollision) {
  const auto finger = std::make_shared<fcl::Boxd>(0.1, 0.1, 1);
  const Eigen::Matrix3d straight = Eigen::Matrix3d::Identity();
  const auto closing = [&](double x, double angle) {  // turns about its lower end
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
    const Vector3d base(x, 0, 0), up(0, 0, 0.5);
    return std::make_shared<fcl::InterpMotion<double>>(straight, base + up, turned, base + turned * up, Vector3d(-up));
  };
  const auto left = make(finger, closing(-0.3, 0.6)), right = make(finger, closing(0.3, -0.6));
  const auto palm = make(std::make_shared<fcl::Boxd>(1, 0.2, 0.1),
                         std::make_shared<fcl::TranslationMotiond>(at(0, 0, -0.2), at(0, 0, -0.2)));
  ContinuousCollisionManager manager;
  manager.registerObjects({palm.get(), left.get(), right.get()});
  manager.setup();
  CertifiedPairsResult result;
  manager.continuousCollide(CertifiedRequest(), result);
  ASSERT_EQ(result.status, Status::contact);
  ASSERT_TRUE(result.certain);
  EXPECT_EQ(result.pairs[0].object1, left.get());
  EXPECT_EQ(result.pairs[0].object2, right.get());
  // By symmetry when the left one's inner upper edge reaches x = 0: 0.05 cos a + sin a = 0.3.
  const double angle = std::asin(0.3 / std::hypot(1, 0.05)) - std::atan(0.05);
  EXPECT_LE(result.t_lower, angle / 0.6 + 1e-12);
  EXPECT_NEAR(result.t_lower, angle / 0.6, 3e-6);
  fcl::DefaultContinuousCollisionData<double> data;
  data.request.toc_err = 1e-6;
  manager.collide(&data, fcl_artic::DefaultContinuousCollisionFunction<double>);
  EXPECT_TRUE(data.result.is_collide);
  EXPECT_EQ(data.result.time_of_contact, result.t_lower);
}

}  // namespace
}  // namespace continuous_manager_test
}  // namespace fcl_artic
