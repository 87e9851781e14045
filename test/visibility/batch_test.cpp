// SPDX-License-Identifier: BSD-3-Clause
// Batches of motions, whose stage 2 is drawn in one pass: the answers are those of one motion after the other.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <random>
#include <stdexcept>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "answers.h"
#include "fcl_artic/fcl_artic.h"
#include "harness.h"
#include "recorder.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace batch_test {

namespace {

using namespace fcl_artic;
using Eigen::Vector3d;
using Culler = std::shared_ptr<const VisibilityCuller>;

/// FCL_ARTIC_VISIBILITY_MOTIONS=100000 in the environment makes it a campaign.
std::size_t motions(std::size_t usual) {
  return campaign::fromEnvironment("FCL_ARTIC_VISIBILITY_MOTIONS", usual);
}

/// An arm of four joints among balls, bars and a mesh of pyramids, and a box that moves; links are checked against each
/// other too, and against a post on the base.
class Batches : public testing::Test {
 protected:
  Batches() : manager_(tree_) {
    for (int i = 0; i < 4; ++i) {
      bind("link" + std::to_string(i), std::make_shared<fcl::Capsuled>(0.05, 0.35), {0, 0, 0.1});
    }
    bind("base", std::make_shared<fcl::Boxd>(0.04, 0.04, 1.6), {0.5, 0.5, 0.8});  // links at its side: not looked at
    std::uniform_real_distribution<double> u(-1, 1);
    const auto place = [&]() -> Vector3d {
      return Vector3d(1.3 * u(random_), 1.3 * u(random_), 0.8 + 1.2 * u(random_));
    };
    for (int i = 0; i < 25; ++i) obstacle(std::make_shared<fcl::Sphered>(0.06), place());
    for (int i = 0; i < 10; ++i) obstacle(std::make_shared<fcl::Boxd>(0.05, 0.05, 0.6), place());
    const auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    mesh->beginModel();
    for (int i = 0; i < 150; ++i) {
      const Vector3d at = place(), a = 0.1 * Vector3d(u(random_), u(random_), u(random_)),
                     b = 0.1 * Vector3d(u(random_), u(random_), u(random_)),
                     c = 0.1 * Vector3d(u(random_), u(random_), u(random_));
      mesh->addTriangle(at, at + a, at + b);
      mesh->addTriangle(at, at + b, at + c);
      mesh->addTriangle(at, at + c, at + a);
    }
    mesh->endModel();
    obstacle(mesh, Vector3d::Zero());
    manager_.registerObject(&moving_);
    manager_.setup();
  }
  void bind(const std::string& link, const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Vector3d& at) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(geometry));
    manager_.bind(link, objects_.back().get(), Eigen::Isometry3d(Eigen::Translation3d(at)));
  }
  void obstacle(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Vector3d& at) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(geometry, Eigen::Isometry3d(Eigen::Translation3d(at))));
    manager_.registerObject(objects_.back().get());
  }
  std::vector<JointMotion> make(std::size_t n) {
    std::vector<JointMotion> all;
    std::uniform_real_distribution<double> u(-1, 1);
    for (std::size_t i = 0; i < n; ++i) {
      Eigen::VectorXd q(4), dq(4);
      for (Eigen::Index k = 0; k < 4; ++k) {
        q[k] = k == 2 ? 0.3 * u(random_) : 3 * u(random_);
        dq[k] = (k == 2 ? 0.1 : 0.4) * u(random_);
      }
      all.push_back(JointMotion::linear(*tree_, q, q + dq));
    }
    return all;
  }

  std::mt19937_64 random_{5};
  std::shared_ptr<const KinematicTree> tree_ = test::fourJoints();
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::ContinuousCollisionObjectd moving_{
      std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2),
      std::make_shared<fcl::TranslationMotiond>(fcl::Transform3d(Eigen::Translation3d(1, 1, 0.3)),
                                                fcl::Transform3d(Eigen::Translation3d(-1, 1, 0.5)))};
  ArticulatedCollisionManager manager_;
};

/// Of mode `on`: a contact that was found with something taken out, and not again without. Its bits are seldom others.
bool standsWronglyWithOn(const CertifiedResult& result) {
  const VisibilityStatistics& s = result.statistics.visibility;
  return result.status == Status::contact && s.pairs > 0 && s.repeated == 0;
}

struct Counts {
  std::uint64_t contacts = 0, pairs = 0, culled = 0, whole = 0, whole_in_contact = 0, repeated = 0, trials = 0;
  void add(const CertifiedResult& result) {
    const VisibilityStatistics& s = result.statistics.visibility;
    contacts += result.status == Status::contact;
    pairs += s.pairs;
    culled += s.culled;
    const bool none_left = s.pairs > 0 && s.culled == s.pairs;
    whole += none_left;
    whole_in_contact += none_left && result.status == Status::contact;
    repeated += s.repeated;
    trials += s.trials;
  }
};

struct Named {
  std::string name;
  Culler culler;
};
std::vector<Named> executors() {
  std::vector<Named> all{{"cpu", std::make_shared<VisibilityCuller>()}};
  VisibilityOptions options;
  options.rule = VisibilityRule::occlusion;
  all.push_back({"cpu, occlusion", std::make_shared<VisibilityCuller>(options)});
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  all.push_back({"osmesa", makeOffscreenCuller(OffscreenBackend::osmesa)});
  all.push_back({"egl", makeOffscreenCuller(OffscreenBackend::egl)});
#endif
  return all;
}

TEST_F(Batches, AnswersAreThoseOfOneAfterTheOther) {
  const std::vector<JointMotion> all = make(motions(2000));
  CertifiedRequest request;
  std::vector<CertifiedResult> off(all.size()), at_once(all.size()), batch;
  for (std::size_t i = 0; i < all.size(); ++i) manager_.continuousCollide(all[i], request, off[i]);
  for (const Named& executor : executors()) {
    manager_.setVisibility(executor.culler);
    for (const VisibilityMode mode : {VisibilityMode::on, VisibilityMode::atOnce, VisibilityMode::automatic}) {
      request.visibility = mode;
      if (mode == VisibilityMode::atOnce && executor.name == "cpu") {
        for (std::size_t i = 0; i < all.size(); ++i) manager_.continuousCollide(all[i], request, at_once[i]);
      }
      Counts counts;
      for (const int threads : {1, 3}) {
        manager_.continuousCollide(all, request, batch, threads);
        ASSERT_EQ(batch.size(), all.size());
        counts = Counts();
        std::uint64_t differ = 0, kept = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
          counts.add(batch[i]);
          kept += standsWronglyWithOn(batch[i]);
          const bool bits = mode != VisibilityMode::atOnce;
          differ += bits ? !test::sameBits(off[i], batch[i]) : !test::agree(off[i], batch[i]);
          if (mode == VisibilityMode::atOnce && executor.name == "cpu") differ += !test::sameBits(at_once[i], batch[i]);
        }
        EXPECT_EQ(differ, 0u) << executor.name << ", mode " << static_cast<int>(mode) << ", threads " << threads;
        if (mode == VisibilityMode::on) {
          EXPECT_EQ(kept, 0u) << executor.name << ", threads " << threads;
        }
      }
      const auto n = static_cast<double>(all.size());
      EXPECT_GT(static_cast<double>(counts.contacts), 0.2 * n);
      EXPECT_LT(static_cast<double>(counts.contacts), 0.8 * n);
      if (mode == VisibilityMode::automatic) continue;  // what it does is a matter of time
      std::cout << executor.name << (mode == VisibilityMode::on ? ", on: " : ", at once: ") << all.size()
                << " motions, " << counts.contacts << " with contact, " << counts.pairs << " pairs seen, "
                << counts.culled << " culled, " << counts.whole << " motions without any left, " << counts.repeated
                << " solved again\n";
      EXPECT_EQ(executor.culler->fallbackReason(), "");
      EXPECT_GT(static_cast<double>(counts.culled), 0.3 * static_cast<double>(counts.pairs));
      EXPECT_GT(static_cast<double>(counts.whole), 0.05 * n);
      EXPECT_GT(counts.whole_in_contact, 0u) << "with something else than what the stage has taken out";
      if (mode == VisibilityMode::atOnce) {
        EXPECT_EQ(counts.repeated, 0u);
      }
    }
  }
}

/// All that a request can say, with few motions each.
TEST_F(Batches, AllRequestsAreAnsweredAsOneByOne) {
  const std::vector<JointMotion> all = make(150);
  std::vector<CertifiedResult> batch;
  CertifiedResult off, alone;
  for (int k = 0; k < 64; ++k) {
    CertifiedRequest request;
    request.mode = std::array{ContactMode::first, ContactMode::any,
                              ContactMode::firstOfEveryPair}[static_cast<std::size_t>(k % 3)];
    request.max_contacts = k % 4 ? 3 : 1;
    request.ignore_initial_contact = k & 1;
    request.margin = k & 2 ? 0.02 : 0;
    request.check_self = (k & 4) != 0;
    request.check_scene = (k & 24) != 24;
    request.work_budget = k & 32 ? 40 : 0;
    request.certificate = k == 1;
    request.method = k % 16 == 5 ? Method::redon2004 : Method::standard;
    for (const VisibilityMode mode : {VisibilityMode::on, VisibilityMode::atOnce, VisibilityMode::automatic}) {
      const bool bits = mode != VisibilityMode::atOnce;
      request.visibility = mode;
      manager_.continuousCollide(all, request, batch, 2);
      for (std::size_t i = 0; i < all.size(); ++i) {
        request.visibility = VisibilityMode::off;
        manager_.continuousCollide(all[i], request, off);
        request.visibility = mode;
        if (bits) {
          ASSERT_TRUE(test::sameBits(off, batch[i])) << k << " " << i;
        } else {
          manager_.continuousCollide(all[i], request, alone);
          ASSERT_TRUE(test::sameBits(alone, batch[i])) << k << " " << i;
          if (request.work_budget == 0) {
            ASSERT_TRUE(test::agree(off, batch[i])) << k << " " << i;
          }
        }
        if (request.certificate) {
          ASSERT_TRUE(batch[i].certificate) << i;
        }
      }
    }
  }
}

/// The executor cpu; counts what it is asked, lies or fails when told to.
struct Watched : visibility::Executor {
  struct Orders {
    int runs = 0, fail_at = -1;
    bool lie = false;
    std::size_t windows = 0;
  };
  explicit Watched(Orders& told) : orders(told) {}
  void run(const visibility::Batch& batch, std::vector<std::uint8_t>& may) override {
    if (++orders.runs == orders.fail_at) throw std::runtime_error("lost");
    orders.windows = std::max(orders.windows, batch.windows.size());
    cpu.run(batch, may);
    for (std::size_t i = 0; i < may.size() && orders.lie; ++i) {
      if (batch.objects[i].group % 3 == 0) may[i] = 0;
    }
  }
  Orders& orders;
  visibility::CpuExecutor cpu;
};
Culler watched(Watched::Orders& orders, const VisibilityOptions& options = {}) {
  const auto culler =
      std::make_shared<VisibilityCuller>(options, "watched", [&orders] { return std::make_unique<Watched>(orders); });
  EXPECT_EQ(culler->executor(), "watched");
  orders.runs = 0;
  orders.windows = 0;
  return culler;
}

TEST_F(Batches, HundredsOfMotionsAreDrawnInOnePass) {
  const std::vector<JointMotion> all = make(700);
  Watched::Orders orders;
  manager_.setVisibility(watched(orders));
  CertifiedRequest request;
  std::vector<CertifiedResult> results;
  for (const VisibilityMode mode : {VisibilityMode::on, VisibilityMode::atOnce}) {
    orders.runs = 0;
    request.visibility = mode;
    manager_.continuousCollide(all, request, results, 1);
    EXPECT_EQ(orders.runs, 3) << "passes of 256 motions";
    EXPECT_GT(orders.windows, 100u) << "of hundreds of motions and their links";
    for (const CertifiedResult& result : results) {
      EXPECT_TRUE(result.statistics.visibility.pairs == 0 || result.statistics.visibility_executor == "watched");
    }
  }
}

/// Views of many pixels take memory: a pass then takes fewer motions, and the answers are the same.
TEST_F(Batches, PassesOfFineViewsTakeFewerMotions) {
  const std::vector<JointMotion> all = make(300);
  VisibilityOptions options;
  options.resolution = 128;
  Watched::Orders orders;
  manager_.setVisibility(watched(orders, options));
  CertifiedRequest request;
  std::vector<CertifiedResult> off, results;
  manager_.continuousCollide(all, request, off);
  request.visibility = VisibilityMode::on;
  manager_.continuousCollide(all, request, results, 1);
  EXPECT_GT(orders.runs, 2) << "passes";
  const std::size_t most = 8388608 / (3 * 128 * 128);  // 2^23 pixels in three views of a window
  EXPECT_GT(orders.windows, most / 2);
  EXPECT_LT(orders.windows, most + 4) << "no more than those of one motion beyond";
  for (std::size_t i = 0; i < all.size(); ++i) ASSERT_TRUE(test::sameBits(off[i], results[i])) << i;
}

/// What a pass culls wrongly is missed: the comparison above sees faults.
TEST_F(Batches, WrongCullsAreSeen) {
  const std::vector<JointMotion> all = make(300);
  Watched::Orders orders;
  const Culler culler = watched(orders);
  orders.lie = true;
  CertifiedRequest request;
  std::vector<CertifiedResult> off, results;
  manager_.continuousCollide(all, request, off);
  manager_.setVisibility(culler);
  for (const VisibilityMode mode : {VisibilityMode::on, VisibilityMode::atOnce}) {
    request.visibility = mode;
    manager_.continuousCollide(all, request, results, 1);
    int differ = 0;
    for (std::size_t i = 0; i < all.size(); ++i) differ += !test::agree(off[i], results[i]);
    std::cout << differ << " of " << all.size() << " answers differ\n";
    EXPECT_GT(differ, 5);
  }
}

/// Where drawing fails nothing is culled, cpu takes over, and the answers stay what they are.
TEST_F(Batches, AnExecutorThatFailsCostsNothingButTime) {
  const std::vector<JointMotion> all = make(700);
  Watched::Orders orders;
  manager_.setVisibility(watched(orders));
  orders.fail_at = 2;
  CertifiedRequest request;
  std::vector<CertifiedResult> off, results;
  manager_.continuousCollide(all, request, off);
  request.visibility = VisibilityMode::on;
  manager_.continuousCollide(all, request, results, 1);
  EXPECT_EQ(orders.runs, 2);
  std::uint64_t culled[3] = {0, 0, 0};
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_TRUE(test::sameBits(off[i], results[i])) << i;
    culled[i / 256] += results[i].statistics.visibility.culled;
  }
  EXPECT_GT(culled[0], 0u);
  EXPECT_EQ(culled[1], 0u) << "the pass that failed";
  EXPECT_GT(culled[2], 0u) << "by cpu";
  EXPECT_EQ(results.back().statistics.visibility_fallback, "watched: lost");
}

}  // namespace

}  // namespace batch_test
