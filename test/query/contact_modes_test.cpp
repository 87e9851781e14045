// SPDX-License-Identifier: BSD-3-Clause
//
// Properties that the contact modes have in common: the pairs that they leave out, and the number of contacts that they
// report. Also, the bracket is joined of all contacts before any of them is dropped.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/math/motion/translation_motion.h>

#include "arms.h"
#include "fcl_artic/continuous_collision.h"
#include "meshes.h"

namespace contact_modes_test {

namespace {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const ContactMode kModes[] = {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair};
const Method kMethods[] = {Method::standard, Method::redon2004};

std::shared_ptr<fcl::CollisionGeometryd> box(double side) {
  return std::make_shared<fcl::Boxd>(side, side, side);
}

/// Geometries of which every proof of contact has something to prove: vertices in solids, chords, triangles, balls
/// inside closed meshes, single pieces.
std::vector<std::shared_ptr<fcl::CollisionGeometryd>> geometries() {
  return {cubeMesh(0.1), fineBoxMesh(Vector3d::Constant(0.1), 6), box(0.2), std::make_shared<fcl::Sphered>(0.1)};
}

TEST(ContactModes, PairsInContactAtTheStartAreLeftOutByAllOfThem) {
  // Deep in contact at x = 0, apart from |x| = 0.15 on, whatever the two are, and free then.
  int asked = 0;
  for (const auto& moving : geometries()) {
    for (const auto& still : geometries()) {
      Cart cart(moving);
      auto obstacle = object(still, pose({-0.05, 0.01, 0.02}));
      cart.manager->registerObject(obstacle.get(), "obstacle");
      cart.manager->setup();
      for (const ContactMode mode : kModes) {
        for (const Method method : kMethods) {
          for (const double margin : {0.0, 0.01}) {
            CertifiedRequest request;
            request.mode = mode;
            request.method = method;
            request.margin = margin;
            request.ignore_initial_contact = true;
            const CertifiedResult r = cart.run(0, 1, request);
            EXPECT_EQ(r.status, Status::free) << static_cast<int>(mode);
            EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
            request.ignore_initial_contact = false;
            const CertifiedResult seen = cart.run(0, 1, request);
            EXPECT_EQ(seen.status, Status::contact);
            EXPECT_EQ(seen.t_lower, 0);
            ++asked;
          }
        }
      }
    }
  }
  EXPECT_EQ(asked, 4 * 4 * 3 * 2 * 2);
}

TEST(ContactModes, PairQueriesLeaveOutContactAtTheStartInAllOfThem) {
  for (const auto& moving : geometries()) {
    for (const auto& still : geometries()) {
      const fcl::TranslationMotiond away(pose({0, 0, 0}), pose({1, 0, 0}));
      const fcl::TranslationMotiond rests(pose({-0.05, 0.01, 0.02}), pose({-0.05, 0.01, 0.02}));
      for (const ContactMode mode : kModes) {
        CertifiedRequest request;
        request.mode = mode;
        request.ignore_initial_contact = true;
        CertifiedPairResult r;
        EXPECT_EQ(continuousCollide(moving.get(), &away, still.get(), &rests, request, r), Status::free)
            << static_cast<int>(mode);
        EXPECT_TRUE(r.ignored_initial_contact);
      }
    }
  }
}

TEST(ContactModes, PairsThatComeBackAreReportedAfterTheyHaveParted) {
  // x(t) = 1.6 t (1 - t): in contact at both ends, apart from x = 0.15 on, before t = 0.11, to t = 0.89.
  int certain = 0;
  for (const auto& moving : geometries()) {
    for (const auto& still : geometries()) {
      Cart cart(moving);
      auto obstacle = object(still, pose({-0.05, 0.01, 0.02}));
      cart.manager->registerObject(obstacle.get(), "obstacle");
      cart.manager->setup();
      MatrixXd x(1, 3);
      x << 0, 1.6, -1.6;
      const JointMotion there_and_back = JointMotion::polynomial(*cart.tree, x);
      for (const ContactMode mode : kModes) {
        CertifiedRequest request;
        request.mode = mode;
        request.ignore_initial_contact = true;
        CertifiedResult r;
        cart.manager->continuousCollide(there_and_back, request, r);
        ASSERT_EQ(r.status, Status::contact) << static_cast<int>(mode);
        EXPECT_EQ(r.ignored_initial_contacts.size(), 1u);
        EXPECT_GT(r.t_upper, 0.85);
        for (const CertifiedContact& contact : r.contacts) {
          EXPECT_GT(contact.t_lower, 0.1) << "its bracket begins before it is watched";
          EXPECT_GT(contact.t_upper, 0.85);
          certain += contact.certain;
        }
      }
    }
  }
  EXPECT_GT(certain, 40);
}

TEST(ContactModes, WhatIsLeftOutDoesNotDependOnTheTolerance) {
  // Balls in contact for |x| <= 0.15, x(t) = 0.15 + 1.2 (0.03^2 - (t - 0.33)^2): apart from t = 0.3 to 0.36, which
  // holds parts of 1/64 and none of 1/8, and again from 0.83 on.
  Cart cart;
  auto still = ball(0.05);
  cart.manager->registerObject(still.get(), "still");
  cart.manager->setup();
  MatrixXd x(1, 3);
  x << 0.15 + 1.2 * (0.03 * 0.03 - 0.33 * 0.33), 1.2 * 2 * 0.33, -1.2;
  const JointMotion motion = JointMotion::polynomial(*cart.tree, x);
  for (const ContactMode mode : kModes) {
    for (const Method method : kMethods) {
      for (const double tolerance : {1e-6, 1e-3, 0.01, 0.05, 0.2}) {
        CertifiedRequest request;
        request.mode = mode;
        request.method = method;
        request.ignore_initial_contact = true;
        request.tolerance_time = tolerance;
        CertifiedResult r;
        cart.manager->continuousCollide(motion, request, r);
        EXPECT_EQ(r.status, Status::contact) << "mode " << static_cast<int>(mode) << ", tolerance " << tolerance;
        EXPECT_LE(r.t_lower, 0.36 + kRounding);
        EXPECT_GE(r.t_upper, 0.36 - kRounding);
      }
    }
  }
}

/// A triangle mesh with spikes of random lengths along -x, on a plate in the plane x = 0.
std::shared_ptr<Mesh> spikes(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vector3d> v;
  std::vector<fcl::Triangle> t;
  for (int i = 0; i < 12; ++i) {
    const Vector3d foot(0, 2 * unit(random) - 1, 2 * unit(random) - 1);
    const std::size_t first = v.size();
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * (k + unit(random)) * 3.14159 / 3;
      v.push_back(foot + 0.2 * Vector3d(0, std::cos(angle), std::sin(angle)));
    }
    v.push_back(foot - Vector3d(0.2 + 0.1 * unit(random), 0, 0));
    for (std::size_t k = 0; k < 3; ++k) t.emplace_back(first + k, first + (k + 1) % 3, first + 3);
  }
  return meshOf(v, t);
}

TEST(ContactModes, BracketIsJoinedBeforeContactsAreDropped) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  int several = 0;
  for (int i = 0; i < 200; ++i) {
    Cart cart(spikes(random));
    auto wall = object(spikes(random), pose({1, 0, 0}, 3.14159 * unit(random), Vector3d(unit(random), 1, 0.2)));
    auto other = object(spikes(random), pose({1 + 0.02 * unit(random), 0.1, 0}, 3, Vector3d::UnitZ()));
    cart.manager->registerObject(wall.get(), "wall");
    cart.manager->registerObject(other.get(), "other");
    cart.manager->setup();
    for (const Method method : kMethods) {
      CertifiedRequest request;
      request.mode = ContactMode::firstOfEveryPair;
      request.method = method;
      request.tolerance_time = 0.1;
      request.max_contacts = 1000;
      const CertifiedResult all = cart.run(0, 1, request);
      several += all.contacts.size() > 1;
      EXPECT_LE(all.contacts.size(), 2u) << "one of each pair";
      for (const std::size_t most : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
        request.max_contacts = most;
        const CertifiedResult cut = cart.run(0, 1, request);
        EXPECT_EQ(cut.status, all.status);
        EXPECT_EQ(cut.t_lower, all.t_lower) << i << ": " << most << " contacts";
        EXPECT_LE(cut.contacts.size(), most);
      }
    }
  }
  EXPECT_GT(several, 100);  // of 400
}

TEST(ContactModes, ContactsOfTheFirstModeMayAllBeTheFirst) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> unit(0, 1);
  int several = 0;
  for (int i = 0; i < 200; ++i) {
    Cart cart(spikes(random));
    // Two in one place, met at the same time, and a third.
    std::vector<std::shared_ptr<fcl::CollisionObjectd>> walls;
    const auto shape = spikes(random);
    const fcl::Transform3d there = pose({1, 0, 0}, 3.14159 * unit(random), Vector3d(unit(random), 1, 0.2));
    for (const char* name : {"wall", "other", "third"}) {
      const bool third = walls.size() == 2;
      walls.push_back(object(third ? spikes(random) : shape, third ? pose({1.01, 0, 0}) : there));
      cart.manager->registerObject(walls.back().get(), name);
    }
    cart.manager->setup();
    for (const Method method : kMethods) {
      CertifiedRequest request;
      request.method = method;
      request.tolerance_time = 0.1;
      request.max_contacts = 1000;
      const CertifiedResult r = cart.run(0, 1, request);
      several += r.contacts.size() > 1;
      std::set<std::string> seen;
      for (std::size_t k = 0; k < r.contacts.size(); ++k) {
        const CertifiedContact& contact = r.contacts[k];
        EXPECT_GE(contact.t_lower, r.t_lower) << i;
        EXPECT_LE(contact.t_lower, r.t_upper) << i << ": proven to be later than another one";
        EXPECT_TRUE(k == 0 || r.contacts[k - 1].t_lower <= contact.t_lower) << i;
        EXPECT_TRUE(seen.insert(contact.body2.name).second) << i << ": two of one pair";
      }
      if (r.certain) {
        ASSERT_FALSE(r.contacts.empty());
        EXPECT_EQ(r.contacts[0].t_upper, r.t_upper) << i;
      }
    }
  }
  EXPECT_GT(several, 100);  // of 400
}

// A link of two geometries, an obstacle of many triangles: one pair of bodies, and the one contact is the earliest.
TEST(ContactModes, APairOfBodiesIsOneWhateverItsGeometries) {
  for (const ContactMode mode : kModes) {
    for (const Method method : kMethods) {
      for (const bool as_trajectory : {false, true}) {
        Cart cart(cubeMesh(0.1));  // half its side; its front is at x + 0.1
        const auto ahead = object(fineBoxMesh(Vector3d::Constant(0.1), 6));
        cart.manager->bind("cart", ahead.get(), pose({0.1, 0.5, 0}));
        const auto wall = object(fineBoxMesh(Vector3d(0.2, 2, 2), 12), pose({1, 0, 0}));
        const auto later = object(fineBoxMesh(Vector3d(0.2, 2, 2), 12), pose({1.02, 0, 0}));
        cart.manager->registerObject(wall.get(), "wall");
        cart.manager->registerObject(later.get(), "later");
        cart.manager->setup();
        CertifiedRequest request;
        request.mode = mode;
        request.method = method;
        request.max_contacts = 1000;
        CertifiedResult r;
        if (as_trajectory) {
          const auto at = [](double x) { return VectorXd::Constant(1, x); };
          cart.manager->continuousCollide(JointTrajectory::linear(*cart.tree, {0, 0.5, 1}, {at(0), at(0.5), at(1)}),
                                          request, r);
        } else {
          r = cart.run(0, 1, request);
        }
        ASSERT_EQ(r.status, Status::contact);
        EXPECT_EQ(r.contacts.size(), mode == ContactMode::firstOfEveryPair ? 2u : 1u);
        EXPECT_EQ(r.first()->body2.name, "wall");
        if (mode == ContactMode::any) continue;
        EXPECT_EQ(r.first()->o1, ahead->collisionGeometry().get());
        EXPECT_NEAR(r.first()->t_lower, 0.6, 1e-5);
        EXPECT_EQ(r.first()->t_upper, r.t_upper);
        if (r.contacts.size() > 1) EXPECT_NEAR(r.contacts[1].t_lower, 0.62, 1e-5);
      }
    }
  }
}

TEST(ContactModes, TheAnswerDoesNotDependOnHowManyContactsAreReported) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 100; ++i) {
    Cart cart(spikes(random));
    auto wall = object(spikes(random), pose({1, 0, 0}, 3.14159 * unit(random), Vector3d(unit(random), 1, 0.2)));
    cart.manager->registerObject(wall.get(), "wall");
    cart.manager->setup();
    for (const ContactMode mode : kModes) {
      CertifiedRequest request;
      request.mode = mode;
      const CertifiedResult one = cart.run(0, 1, request);
      request.max_contacts = 10;
      const CertifiedResult ten = cart.run(0, 1, request);
      EXPECT_EQ(one.t_lower, ten.t_lower) << i;
      EXPECT_EQ(one.t_upper, ten.t_upper) << i;
      EXPECT_EQ(one.certain, ten.certain) << i;
    }
  }
}

TEST(ContactModes, MaxContactsIsNeverExceededAndTheEarliestAreKept) {
  Cart cart;
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> balls;
  for (const double x : {0.9, 0.5, 0.7, 0.6, 0.8}) {
    balls.push_back(ball(0.1, {x, 0.1, 0}));
    cart.manager->registerObject(balls.back().get(), "at " + std::to_string(x).substr(0, 3));
  }
  cart.manager->setup();
  const double half_chord = std::sqrt(0.04 - 0.01);
  const JointTrajectory halves = JointTrajectory::linear(
      *cart.tree, {0, 0.5, 1}, {VectorXd::Constant(1, 0), VectorXd::Constant(1, 0.5), VectorXd::Constant(1, 1)});
  for (const ContactMode mode : kModes) {
    for (const Method method : kMethods) {
      for (const bool as_trajectory : {false, true}) {
        for (std::size_t most = 0; most < 7; ++most) {
          CertifiedRequest request;
          request.mode = mode;
          request.method = method;
          request.max_contacts = most;
          CertifiedResult r;
          if (as_trajectory) {
            cart.manager->continuousCollide(halves, request, r);
          } else {
            r = cart.run(0, 1, request);
          }
          EXPECT_EQ(r.status, Status::contact);
          const std::size_t expected =
              mode == ContactMode::firstOfEveryPair ? std::min<std::size_t>(most, 5) : std::min<std::size_t>(most, 1);
          ASSERT_EQ(r.contacts.size(), expected) << static_cast<int>(mode) << (as_trajectory ? " trajectory" : "");
          if (mode == ContactMode::any) continue;
          for (std::size_t i = 0; i < r.contacts.size(); ++i) {
            EXPECT_NEAR(r.contacts[i].t_lower, 0.5 + 0.1 * static_cast<double>(i) - half_chord, 1e-5);
          }
        }
      }
    }
  }
}

TEST(ContactModes, NoContactIsReportedWhereNoneIsAskedForAlsoOfUnboundedPairs) {
  const fcl::Halfspaced up(Vector3d::UnitZ(), 0), across(Vector3d::UnitX(), 0);
  const fcl::TranslationMotiond rests(pose({0, 0, 0}), pose({0, 0, 0}));
  CertifiedRequest request;
  for (const std::size_t most : {0, 1, 2}) {
    request.max_contacts = most;
    CertifiedPairResult r;
    EXPECT_EQ(continuousCollide(&up, &rests, &across, &rests, request, r), Status::contact);
    EXPECT_EQ(r.contacts.size(), std::min<std::size_t>(most, 1));
  }
}

void addTriangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, std::vector<Vector3d>& vertices,
                 std::vector<fcl::Triangle>& triangles) {
  const std::size_t first = vertices.size();
  vertices.insert(vertices.end(), {a, b, c});
  triangles.emplace_back(first, first + 1, first + 2);
}
/// A rectangle of two triangles, in a plane of z.
void addPlate(double x0, double x1, double y, double z, std::vector<Vector3d>& v, std::vector<fcl::Triangle>& t) {
  addTriangle({x0, -y, z}, {x1, -y, z}, {x1, y, z}, v, t);
  addTriangle({x0, -y, z}, {x1, y, z}, {x0, y, z}, v, t);
}

// A small cart runs through two meshes that are open in front:
//
//     far   ______________________________________   plates above and below, from 0.2 to 0.9, and in them a plate
//     near            _____                          whose plane the cart's side lies in, from 0.6 on: never proven;
//     cart  []->        |          __________        plates above and below, and in them a triangle across the way,
//     near            _____                          met at 0.5545 and left at 0.5565, between the poses that are
//     tried. far   ______________________________________
//
// The far mesh is looked at first, as the cart is within its hull already; its contact ends the search.
TEST(ContactModes, AnyIsNotLateWhereItsContactIsNotProven) {
  Cart cart(box(0.002));
  std::vector<Vector3d> v;
  std::vector<fcl::Triangle> t;
  for (const double z : {-0.05, 0.05}) addPlate(0.2, 0.9, 0.05, z, v, t);
  addTriangle({0.601, 0.001, -0.03}, {0.601, 0.001, 0.03}, {0.9, 0.001, 0.03}, v, t);
  addTriangle({0.601, 0.001, -0.03}, {0.9, 0.001, 0.03}, {0.9, 0.001, -0.03}, v, t);
  const auto far = object(meshOf(v, t));
  v.clear();
  t.clear();
  for (const double z : {-0.02, 0.02}) addPlate(0.541, 0.57, 0.02, z, v, t);
  addTriangle({0.5555, -0.003, -0.003}, {0.5555, -0.003, 0.003}, {0.5555, 0.003, 0}, v, t);
  const auto near = object(meshOf(v, t));
  cart.manager->registerObject(far.get(), "far");
  cart.manager->registerObject(near.get(), "near");
  cart.manager->setup();
  CertifiedRequest request;
  const CertifiedResult first = cart.run(0, 1, request);
  ASSERT_TRUE(first.certain);
  EXPECT_EQ(first.contacts.at(0).body2.name, "near");
  EXPECT_LE(first.t_upper, 0.5546);
  request.mode = ContactMode::any;
  const CertifiedResult any = cart.run(0, 1, request);
  ASSERT_EQ(any.status, Status::contact);
  EXPECT_FALSE(any.certain) << "not the case that is meant";
  EXPECT_LE(any.t_lower, 0.5545 + kRounding);
  ASSERT_EQ(any.contacts.size(), 1u);
  EXPECT_EQ(any.contacts[0].body2.name, "far");
  EXPECT_GE(any.contacts[0].t_lower, any.t_lower);
}

// With ContactMode::any `certain` says that a contact is proven at or before t_upper, however early it may begin.
TEST(ContactModes, AnyIsCertainWhateverTheWidthOfItsBracket) {
  Cart cart(cubeMesh(0.1));
  auto wall = object(box(1), pose({1, 0, 0}));
  cart.manager->registerObject(wall.get(), "wall");
  cart.manager->setup();
  CertifiedRequest request;
  request.mode = ContactMode::any;
  const CertifiedResult r = cart.run(0, 1, request);
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  EXPECT_LE(r.t_lower, 0.4);
  EXPECT_GE(r.t_upper, 0.4);
  ASSERT_EQ(r.contacts.size(), 1u);
  EXPECT_GE(r.contacts[0].t_lower, r.t_lower);
  EXPECT_LE(r.contacts[0].t_lower, r.contacts[0].t_upper);
  EXPECT_TRUE(r.contacts[0].certain);
  EXPECT_EQ(r.contacts[0].t_upper, r.t_upper);
}

/// Boxes that come down on another one, and that would touch a little after the motion's end: at no time do they,
/// however wide the tolerance is.
TEST(ContactModes, WhatWouldTouchAfterTheEndDoesNot) {
  std::mt19937 random(3);
  const auto in = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  const auto table = fineBoxMesh({0.3, 0.3, 0.25}, 1), box = fineBoxMesh({0.1, 0.1, 0.1}, 1);
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  int free = 0, undecided = 0;
  for (int i = 0; i < 3000; ++i) {
    const double gap = std::pow(10, in(-9, -0.5));
    fcl::Transform3d from = still, to;
    from.translation() = Vector3d(in(-0.1, 0.1), in(-0.1, 0.1), 0.35 + gap);
    to = from;
    to.translation().z() -= gap * (1 - std::pow(10, in(-8, -0.1)));
    if (i % 2) to.linear() = Eigen::AngleAxisd(in(-0.5, 0.5), Vector3d::UnitZ()).toRotationMatrix();
    const double left = to.translation().z() - 0.35;
    CertifiedPairRequest request;
    request.mode = kModes[i % 3];
    request.tolerance_time = i % 4 ? std::pow(10, in(-8, 2)) : 1e-6;
    request.tolerance_distance = 1e-12;
    CertifiedPairResult result;
    continuousCollide(table.get(), still, still, box.get(), from, to, fcl::CCDM_LINEAR, request, result);
    for (const CertifiedContact& contact : result.contacts) {
      ASSERT_FALSE(contact.certain) << i << ": " << left << " m are left at the end, tolerance "
                                    << request.tolerance_time;
    }
    ASSERT_FALSE(result.status == Status::contact && result.certain) << i;
    free += result.isFree();
    undecided += !result.isFree() && left > 1e-12;
  }
  std::printf("%d free, %d not but for 1e-12 m\n", free, undecided);
  EXPECT_EQ(undecided, 0);
  EXPECT_GT(free, 2500);
}

}  // namespace

}  // namespace contact_modes_test
