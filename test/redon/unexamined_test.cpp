// SPDX-License-Identifier: BSD-3-Clause
// A pair that the paper's method has not examined is not free. Three links each slide 1 m along x towards an obstacle
// of their own, so every contact has its time in closed form.
//
//     link 0  []-->     | mesh      t = times[0]
//     link 1  []-->     | mesh      t = times[1]
//     link 2  []-->     O sphere    t = times[2], a pair that is left to the standard method
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fcl_artic/fcl_artic.h"
#include "meshes.h"

namespace unexamined_test {

namespace {

using fcl_artic::CertifiedRequest;
using fcl_artic::CertifiedResult;
using fcl_artic::ContactMode;
using fcl_artic::Status;

constexpr int kLinks = 3;
constexpr double kNever = 3;

class Slides {
 public:
  explicit Slides(const std::array<double, kLinks>& times) {
    auto tree = std::make_shared<fcl_artic::KinematicTree>("slides");
    tree->addLink("base");
    for (int i = 0; i < kLinks; ++i) {
      fcl_artic::Joint joint;
      joint.name = "slide" + std::to_string(i);
      joint.type = fcl_artic::JointType::prismatic;
      joint.parent = "base";
      joint.child = "link" + std::to_string(i);
      joint.axis = Eigen::Vector3d::UnitX();
      joint.origin = Eigen::Isometry3d(Eigen::Translation3d(0, i, 0));
      tree->addLink(joint.child);
      tree->addJoint(joint);
    }
    tree_ = tree;
    manager_ = std::make_unique<fcl_artic::ArticulatedCollisionManager>(tree_);
    for (int i = 0; i < kLinks; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      add(redon_test::boxMesh(0.05, 0.05, 0.05), Eigen::Vector3d::Zero());
      manager_->bind("link" + std::to_string(i), objects_.back().get());
      if (i < 2) {
        add(redon_test::boxMesh(0.05, 0.05, 0.05), Eigen::Vector3d(0.1 + times[k], i + 0.01, 0.02));
      } else {
        add(std::make_shared<fcl::Sphered>(0.25), Eigen::Vector3d(0.3 + times[k], i, 0));
      }
      manager_->registerObject(objects_.back().get(), "obstacle" + std::to_string(i));
    }
    manager_->setup();
  }

  CertifiedResult ask(const CertifiedRequest& request) const {
    CertifiedResult result;
    const Eigen::VectorXd q0 = Eigen::VectorXd::Zero(kLinks), q1 = Eigen::VectorXd::Ones(kLinks);
    manager_->continuousCollide(fcl_artic::JointMotion::linear(*tree_, q0, q1), request, result);
    return result;
  }

 private:
  void add(const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Eigen::Vector3d& place) {
    objects_.push_back(
        std::make_unique<fcl::CollisionObjectd>(geometry, Eigen::Isometry3d(Eigen::Translation3d(place))));
  }
  std::shared_ptr<const fcl_artic::KinematicTree> tree_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::unique_ptr<fcl_artic::ArticulatedCollisionManager> manager_;
};

CertifiedRequest paper() {
  CertifiedRequest request;
  request.method = fcl_artic::Method::redon2004;
  return request;
}

/// A contact of a pair left to the standard method ends no search whose equations wait for the last box.
TEST(Unexamined, BoxesFirstFindsWhatComesBeforeTheStandardMethodsContact) {
  for (const double own : {0.1, 0.3, 0.69, 0.71, kNever}) {
    const Slides slides({own, kNever, 0.7});
    const double first = std::min(own, 0.7);
    for (int combination = 0; combination < 8; ++combination) {
      CertifiedRequest request = paper();
      request.redon.in_time_order = combination & 1;
      request.redon.simultaneous = combination & 2;
      request.redon.refinement_level = combination & 4 ? 4 : -1;
      const CertifiedResult result = slides.ask(request);
      ASSERT_EQ(result.status, Status::contact);
      EXPECT_TRUE(result.certain);
      EXPECT_GE(result.t_lower, first - 1.01e-6) << "own contact " << own << ", switches " << combination;
      EXPECT_LE(result.t_lower, first + 1e-12) << "own contact " << own << ", switches " << combination;
      EXPECT_EQ(result.statistics.redon.pairs_by_standard, 3u);  // all with the sphere
    }
  }
}

/// Where the budget runs out, pairs that were not come to are not free.
TEST(Unexamined, BudgetOfEveryPairClaimsNothingOfPairsThatWereNotComeTo) {
  int undecided = 0, answered = 0;
  for (const auto& times : {std::array<double, kLinks>{0.268, 0.766, kNever},
                            {0.766, 0.268, kNever},
                            {0.766, 0.9, 0.268},
                            {kNever, 0.268, 0.766}}) {
    const Slides slides(times);
    const double first = *std::min_element(times.begin(), times.end());
    for (int combination = 0; combination < 8; ++combination) {
      for (std::uint64_t budget = 1; budget < 6000; budget += 1 + budget / 8) {
        CertifiedRequest request = paper();
        request.mode = combination & 1 ? ContactMode::firstOfEveryPair : ContactMode::first;
        request.redon.in_time_order = combination & 2;
        request.redon.simultaneous = combination & 4;
        request.max_contacts = 100;
        request.work_budget = budget;
        const CertifiedResult result = slides.ask(request);
        ASSERT_NE(result.status, Status::free);
        EXPECT_LE(result.t_lower, first + 1e-12) << "switches " << combination << ", budget " << budget;
        ++(result.status == Status::undecided ? undecided : answered);
      }
    }
  }
  EXPECT_GE(undecided, 400);
  EXPECT_GE(answered, 400);
}

/// Progress is what is proven of all pairs, in any order of search.
TEST(Unexamined, ProgressClaimsNothingOfPairsThatWereNotComeTo) {
  int told = 0;
  for (const auto& times : {std::array<double, kLinks>{0.268, 0.766, kNever}, {0.766, 0.9, 0.268}}) {
    const Slides slides(times);
    for (int combination = 0; combination < 8; ++combination) {
      CertifiedRequest request = paper();
      request.mode = combination & 1 ? ContactMode::firstOfEveryPair : ContactMode::first;
      request.redon.in_time_order = combination & 2;
      request.redon.simultaneous = combination & 4;
      request.progress = [&](double t_lower) {
        ++told;
        EXPECT_LE(t_lower, 0.268 + 1e-12) << "switches " << combination;
        return true;
      };
      slides.ask(request);
    }
  }
  EXPECT_GE(told, 8);
}

/// The bracket is that of all pairs, however few contacts are wanted, and no more are reported.
TEST(Unexamined, TheBracketIsJoinedBeforeContactsAreDropped) {
  for (const auto& times :
       {std::array<double, kLinks>{0.3, 0.30004, 0.30002}, {0.30004, 0.3, 0.30002}, {0.30002, 0.30004, 0.3}}) {
    const Slides slides(times);
    for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
      for (const std::size_t most : {1u, 2u, 3u, 100u}) {
        CertifiedRequest request = paper();
        request.mode = mode;
        request.max_contacts = most;
        request.tolerance_time = 1e-3;
        const CertifiedResult result = slides.ask(request);
        ASSERT_EQ(result.status, Status::contact);
        EXPECT_LE(result.t_lower, 0.3 + 1e-12);
        EXPECT_GE(result.t_upper, 0.3 - 1e-12);
        EXPECT_LE(result.contacts.size(), most);
        EXPECT_GE(result.contacts.size(), mode == ContactMode::firstOfEveryPair ? std::min<std::size_t>(most, 3) : 1);
      }
    }
  }
}

/// Any contact is the first one here, with its narrow bracket, of the standard method's pairs too.
TEST(Unexamined, AnyContactIsTheFirst) {
  const Slides slides({0.9, kNever, 0.7});
  CertifiedRequest request = paper();
  request.mode = ContactMode::any;
  const CertifiedResult result = slides.ask(request);
  ASSERT_EQ(result.status, Status::contact);
  EXPECT_TRUE(result.certain);
  EXPECT_NEAR(result.t_lower, 0.7, 1.01e-6);
  EXPECT_LE(result.t_upper - result.t_lower, 1.01e-6);
}

}  // namespace

}  // namespace unexamined_test
