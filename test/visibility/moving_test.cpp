// SPDX-License-Identifier: BSD-3-Clause
// Stage 2 between two bodies that move: links and links, links and obstacles that move. Pairs that touch, by FCL's own
// static test of their poses at one time of the motion, are never culled; what is culled is looked at densely by the
// same test; what is swept holds the link; answers are those without the stage.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include "fcl_artic/fcl_artic.h"
#include "harness.h"
#include "recorder.h"
#include "with_and_without.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace moving_test {

namespace {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Culler = std::shared_ptr<const VisibilityCuller>;
using Mesh = fcl::BVHModel<fcl::OBBRSSd>;
using visibility::Drawing;

/// FCL_ARTIC_VISIBILITY_PAIRS=1000000 in the environment makes it a campaign.
std::uint64_t pairs(std::uint64_t usual) {
  return campaign::fromEnvironment("FCL_ARTIC_VISIBILITY_PAIRS", usual);
}

class Random : public campaign::Random {
 public:
  using campaign::Random::Random;
  Vector3d inCube() {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    return {x, y, z};
  }
  Eigen::VectorXd vector(Eigen::Index n, double most) {
    Eigen::VectorXd v(n);
    for (double& x : v) x = uniform(-most, most);
    return v;
  }
};

/// Triangles all around, with room between them.
std::shared_ptr<Mesh> bush(int triangles, Random& random) {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  for (int i = 0; i < triangles; ++i) {
    const Vector3d at = random.uniform(0.25, 0.7) * random.inCube().normalized();
    const double size = random.logUniform(0.01, 0.15);
    mesh->addTriangle(at, at + size * random.inCube(), at + size * random.inCube());
  }
  mesh->endModel();
  return mesh;
}

/// A corner of a bar along z, of eight.
Vector3d cornerOf(const Vector3d& sides, int c) {
  return 0.5 * sides.cwiseProduct(Vector3d(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1));
}

std::shared_ptr<Mesh> bar(const Vector3d& sides) {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  const auto corner = [&](int c) -> Vector3d { return cornerOf(sides, c); };
  for (int k = 0; k < 3; ++k) {
    const int u = 1 << k, v = 1 << (k + 1) % 3, w = 1 << (k + 2) % 3;
    for (const int at : {0, w}) {
      mesh->addTriangle(corner(at), corner(at + u), corner(at + u + v));
      mesh->addTriangle(corner(at), corner(at + u + v), corner(at + v));
    }
  }
  mesh->endModel();
  return mesh;
}

enum class Partner { link, obstacle };

/// A bar on the last of six links, and a bush: on the second one, four joints before it, on the same link of an arm
/// beside it, on the base, in turns by the seed, or as an obstacle that moves. Both stand askew in their links' frames.
class Pair {
 public:
  static constexpr int kJoints = 6, kBar = 5, kBush = 1, kBase = -1;

  Pair(Partner partner, std::uint64_t seed) : partner_(partner), random_(seed) {
    auto tree = std::make_shared<KinematicTree>("arm");
    tree->addLink("base");
    for (int i = 0; i < kJoints; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = i == 3 ? JointType::prismatic : JointType::revolute;
      parents_.push_back(i == kBush + 1 && seed % 3 == 1 ? kBase : i - 1);  // the joints after it are another arm's
      joint.parent = nameOf(parents_.back());
      joint.child = nameOf(i);
      joint.axis = random_.inCube().normalized();
      joint.origin = Eigen::Translation3d(0.15 * random_.inCube()) *
                     Eigen::AngleAxisd(random_.uniform(-3, 3), random_.inCube().normalized());
      tree->addLink(joint.child);
      tree->addJoint(joint);
      joints_.push_back(joint);
    }
    tree_ = tree;
    const double thickness = random_.logUniform(0.001, 0.06);
    sides_ << thickness, thickness, random_.uniform(0.1, 0.3);
    bar_ = bar(sides_);
    bush_ = bush(static_cast<int>(random_.uniform(1, 60)), random_);
    bar_object_ = std::make_unique<fcl::CollisionObjectd>(bar_);
    bush_object_ = std::make_unique<fcl::CollisionObjectd>(bush_);
    manager_ = std::make_unique<ArticulatedCollisionManager>(tree_);
    bar_offset_ = askew();
    if (partner == Partner::link) {  // bound first: of two arms' links it is the one that the other is seen from
      bush_link_ = seed % 3 == 2 ? kBase : kBush;
      bush_offset_ = askew();
      manager_->bind(nameOf(bush_link_), bush_object_.get(), bush_offset_);
    }
    manager_->bind(nameOf(kBar), bar_object_.get(), bar_offset_);
    if (partner == Partner::obstacle) {
      from_ = 0.2 * random_.inCube();
      path_ = 0.3 * random_.inCube();
      turn_ = random_.uniform(-1, 1) * random_.inCube().normalized();
      const Isometry3d begin = obstaclePose(0), end = obstaclePose(1);
      moving_ = std::make_unique<fcl::ContinuousCollisionObjectd>(
          bush_, std::make_shared<fcl::InterpMotion<double>>(begin.linear(), begin.translation(), end.linear(),
                                                             end.translation(), Vector3d(0, 0, 0)));
      manager_->registerObject(moving_.get());
    }
    manager_->setup();
  }

  ArticulatedCollisionManager& manager() { return *manager_; }
  const KinematicTree& tree() const { return *tree_; }
  Random& random() { return random_; }
  const Vector3d& barSides() const { return sides_; }

  Isometry3d barPose(const Eigen::VectorXd& q) const { return linkPose(q, kBar) * bar_offset_; }
  /// At time t, where it is an obstacle.
  Isometry3d bushPose(const Eigen::VectorXd& q, double t) const {
    return partner_ == Partner::link ? linkPose(q, bush_link_) * bush_offset_ : obstaclePose(t);
  }
  /// By FCL's static test.
  bool touches(const Eigen::VectorXd& q, double t) const {
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(bar_.get(), barPose(q), bush_.get(), bushPose(q, t), request, result) > 0;
  }
  double distance(const Eigen::VectorXd& q, double t) const {
    const fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    return fcl::distance(bar_.get(), barPose(q), bush_.get(), bushPose(q, t), request, result);
  }
  /// Configurations that touch at time t and that do not, as near to each other as doubles allow, about.
  bool findGrazing(double t, Eigen::VectorXd& touching, Eigen::VectorXd& free) {
    int found = 0;
    for (int i = 0; i < 400 && found != 3; ++i) {
      const Eigen::VectorXd q = random_.vector(kJoints, 3);
      const bool hit = touches(q, t);
      (hit ? touching : free) = q;
      found |= hit ? 1 : 2;
    }
    if (found != 3) return false;
    for (int i = 0; i < 45; ++i) {
      const Eigen::VectorXd middle = 0.5 * (touching + free);
      (touches(middle, t) ? touching : free) = middle;
    }
    return true;
  }
  JointMotion motionThrough(const Eigen::VectorXd& q, double t, const Eigen::VectorXd& rate) const {
    return JointMotion::linear(*tree_, q - t * rate, q + (1 - t) * rate);
  }

 private:
  static std::string nameOf(int link) { return link == kBase ? "base" : "link" + std::to_string(link); }
  Isometry3d askew() {
    return Eigen::Translation3d(0.1 * random_.inCube()) *
           Eigen::AngleAxisd(random_.uniform(-3, 3), random_.inCube().normalized());
  }
  Isometry3d linkPose(const Eigen::VectorXd& q, int link) const {
    if (link == kBase) return Isometry3d::Identity();
    const Joint& joint = joints_[static_cast<std::size_t>(link)];
    Isometry3d M = linkPose(q, parents_[static_cast<std::size_t>(link)]) * joint.origin;
    if (joint.type == JointType::prismatic) {
      M.translate(q[link] * joint.axis);
    } else {
      M.rotate(Eigen::AngleAxisd(q[link], joint.axis));
    }
    return M;
  }
  /// The screw of fcl::InterpMotion, as it is asked for: turned by a part of turn_ about the reference point 0.
  Isometry3d obstaclePose(double t) const {
    Isometry3d M = Isometry3d::Identity();
    M.translate(from_ + t * path_);
    M.rotate(Eigen::AngleAxisd(t * turn_.norm(), turn_.normalized()));
    return M;
  }

  Partner partner_;
  Random random_;
  std::vector<Joint> joints_;
  std::vector<int> parents_;  ///< of each joint: a link, or the base
  int bush_link_ = kBush;
  Isometry3d bar_offset_, bush_offset_;
  std::shared_ptr<const KinematicTree> tree_;
  std::shared_ptr<Mesh> bar_, bush_;
  Vector3d sides_, from_, path_, turn_;
  std::unique_ptr<fcl::CollisionObjectd> bar_object_, bush_object_;
  std::unique_ptr<fcl::ContinuousCollisionObjectd> moving_;
  std::unique_ptr<ArticulatedCollisionManager> manager_;
};

/// Whether the one pair was culled.
std::uint64_t culled(const CertifiedResult& result) {
  EXPECT_LE(result.statistics.visibility.pairs, 1u);
  return result.statistics.visibility.culled;
}

struct Counts {
  std::uint64_t queries = 0, asked = 0, wrong = 0, missed = 0, near = 0, culled = 0, drawn = 0, culled_near = 0;
};

/// Motions through a contact that just touches, and past it, in turns.
Counts examine(Partner partner, std::uint64_t n, const Culler& culler, Method method, std::uint64_t first_seed) {
  constexpr std::uint64_t kEach = 50;  // of one arm
  constexpr double kNear = 0.02;       // m
  Counts counts;
  CertifiedRequest request;
  request.visibility = VisibilityMode::on;
  request.method = method;
  CertifiedResult result;
  for (std::uint64_t seed = first_seed; counts.queries < n; ++seed) {
    Pair pair(partner, seed);
    pair.manager().setVisibility(culler);
    Random& random = pair.random();
    std::uint64_t failed = 0;
    for (std::uint64_t i = 0; i < kEach && counts.queries < n && failed < 2; ++i) {
      const double t = random.unit() < 0.1 ? (random.unit() < 0.5 ? 0 : 1) : random.unit();
      Eigen::VectorXd touching, free;
      if (!pair.findGrazing(t, touching, free)) {
        ++failed;
        continue;
      }
      const Eigen::VectorXd rate = random.logUniform(1e-3, 2) * random.vector(Pair::kJoints, 1);
      pair.manager().continuousCollide(pair.motionThrough(touching, t, rate), request, result);
      ++counts.queries;
      counts.asked += result.statistics.visibility.pairs;
      if (culled(result)) {
        ++counts.wrong;
        if (counts.wrong < 5) std::cout << "culled, and touches: seed " << seed << ", motion " << i << "\n";
      } else if (result.status == Status::free) {
        ++counts.missed;
      }

      const Eigen::VectorXd away = free + random.logUniform(1e-5, 0.3) * random.vector(Pair::kJoints, 1);
      if (pair.touches(away, t)) continue;
      const double distance = pair.distance(away, t);
      pair.manager().continuousCollide(pair.motionThrough(away, t, rate), request, result);
      ++counts.queries;
      counts.asked += result.statistics.visibility.pairs;
      counts.near += distance < kNear;
      if (!culled(result)) continue;
      ++counts.culled;
      counts.drawn += result.statistics.visibility.pieces > 0;
      counts.culled_near += distance < kNear;
      bool hit = false;
      for (int k = 0; k <= 48 && !hit; ++k) {
        // All over the motion, and near t.
        const double at = k <= 24 ? k / 24.0 : std::clamp(t + std::pow(0.7, k - 24) * (k % 2 ? 0.2 : -0.2), 0.0, 1.0);
        hit = pair.touches(away + (at - t) * rate, at);
      }
      counts.wrong += hit;
      if (hit && counts.wrong < 5)
        std::cout << "culled, and sampled to touch: seed " << seed << ", motion " << i << "\n";
    }
  }
  return counts;
}

const char* nameOf(Partner partner) {
  return partner == Partner::link ? "two links" : "link and moving obstacle";
}

void print(const std::string& how, Partner partner, const Counts& counts) {
  std::cout << how << ", " << nameOf(partner) << ": " << counts.queries << " motions, " << counts.asked
            << " pairs seen, " << counts.wrong << " culled wrongly; past a contact " << counts.culled << " culled ("
            << counts.drawn << " by drawing), " << counts.culled_near << " of the " << counts.near
            << " that pass within 20 mm\n";
}

class MovingPairs : public testing::TestWithParam<Partner> {};

TEST_P(MovingPairs, NoneThatTouchesIsCulled) {
  const auto require = [&](const std::string& how, const Culler& culler, Method method, std::uint64_t first_seed) {
    const Counts counts = examine(GetParam(), pairs(8000) / 8, culler, method, first_seed);
    print(how, GetParam(), counts);
    EXPECT_EQ(counts.wrong + counts.missed, 0u) << how;
    EXPECT_GT(counts.culled, counts.queries / 80) << how;
    EXPECT_EQ(culler->fallbackReason(), "") << how;
  };
  VisibilityOptions coarse;
  coarse.resolution = 8;
  const auto usual = std::make_shared<VisibilityCuller>();
  require("cpu", usual, Method::standard, 1000);
  require("cpu, 8 pixels", std::make_shared<VisibilityCuller>(coarse), Method::standard, 2000000);
  require("cpu, redon2004", usual, Method::redon2004, 5);
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  require("osmesa", makeOffscreenCuller(OffscreenBackend::osmesa), Method::standard, 7);
  require("egl", makeOffscreenCuller(OffscreenBackend::egl), Method::standard, 7000);
#endif
}

/// What is swept is drawn thinner than it is.
TEST_P(MovingPairs, ThinnerVolumesAreSeen) {
  const auto culler = test::changedBy([](Drawing& drawing) {
    for (auto& swept : drawing.swept) swept.radius *= 0.5;
  });
  const Counts counts = examine(GetParam(), 2000, culler, Method::standard, 11);
  print("half the radius", GetParam(), counts);
  EXPECT_GT(counts.wrong, 10u);
}

INSTANTIATE_TEST_SUITE_P(Partners, MovingPairs, testing::Values(Partner::link, Partner::obstacle),
                         [](const auto& info) {
                           return std::string(info.param == Partner::link ? "TwoLinks" : "MovingObstacle");
                         });

/// How far a volume reaches beyond the bar over an eighth of the motion, along random directions; below 0: not as far.
double roomIn(const Drawing& drawing, const visibility::Volume& volume, Pair& pair, const Eigen::VectorXd& q,
              const Eigen::VectorXd& rate, int eighth) {
  double room = HUGE_VAL;
  for (int k = 0; k < 24; ++k) {
    const Vector3d n = pair.random().inCube().normalized();
    const double held = test::support(drawing, volume, n) + 1e-12;
    for (int i = 0; i <= 16; ++i) {
      const double t = (eighth + i / 16.0) / 8;
      const Eigen::VectorXd at = q + t * rate;
      const Isometry3d seen = pair.bushPose(at, t).inverse() * pair.barPose(at);
      for (int c = 0; c < 8; ++c) room = std::min(room, held - n.dot(seen * cornerOf(pair.barSides(), c)));
    }
  }
  return room;
}

/// Corners of the bar, as the bush sees them at dense times, lie in what the stage was given: each volume that is drawn
/// holds the bar over one of the eighths, another one than the volume before it.
TEST(MovingVolumes, HoldTheLinkWhereTheOtherStands) {
  for (const Partner partner : {Partner::link, Partner::obstacle}) {
    for (const Method method : {Method::standard, Method::redon2004}) {
      double least_room = HUGE_VAL;
      std::uint64_t looked = 0;
      for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Pair pair(partner, seed);
        Drawing drawing;
        pair.manager().setVisibility(test::recordTo(drawing));
        CertifiedRequest request;
        request.visibility = VisibilityMode::on;
        request.method = method;
        Eigen::VectorXd touching, free;
        if (!pair.findGrazing(0.5, touching, free)) continue;
        const Eigen::VectorXd rate = pair.random().vector(Pair::kJoints, seed % 4 ? 0.3 : 1.5), q = free - 0.5 * rate;
        CertifiedResult result;
        pair.manager().continuousCollide(pair.motionThrough(q, 0, rate), request, result);
        if (result.statistics.visibility_executor != "changed" || result.statistics.redon.pairs_by_standard) continue;
        int eighth = 0;
        for (const visibility::Volume& swept : drawing.swept) {
          double room = -1;
          for (; eighth < 8 && room < 0; ++eighth) room = roomIn(drawing, swept, pair, q, rate, eighth);
          ASSERT_GE(room, 0) << "seed " << seed;
          least_room = std::min(least_room, room);
          ++looked;
        }
      }
      std::cout << nameOf(partner) << (method == Method::standard ? "" : ", redon2004") << ": " << looked
                << " volumes, least room " << least_room << " m\n";
      EXPECT_GT(looked, 100u);
      EXPECT_LT(least_room, 1e-3) << "not just large";
    }
  }
}

TEST(MovingAnswers, AreThoseWithoutTheStage) {
  for (const Partner partner : {Partner::link, Partner::obstacle}) {
    std::uint64_t contacts = 0, queries = 0, culled = 0;
    for (std::uint64_t seed = 100; seed < 130; ++seed) {
      Pair pair(partner, seed);
      Eigen::VectorXd touching, free;
      for (int i = 0; i < 40 && pair.findGrazing(0.5, touching, free); ++i) {
        const double most = pair.random().logUniform(0.05, 1);
        const Eigen::VectorXd q = i % 2 ? touching : free + pair.random().vector(Pair::kJoints, 0.3);
        const JointMotion motion = pair.motionThrough(q, 0.5, pair.random().vector(Pair::kJoints, most));
        CertifiedRequest request;
        request.mode = seed % 3 ? ContactMode::first : ContactMode::any;
        request.ignore_initial_contact = seed % 5 == 0;
        request.margin = seed % 2 ? 0.02 : 0;
        const CertifiedResult off = pair.manager().continuousCollide(motion, request);
        request.visibility = VisibilityMode::on;
        const CertifiedResult on = pair.manager().continuousCollide(motion, request);
        EXPECT_TRUE(test::sameBits(off, on)) << seed << " " << i;
        ++queries;
        contacts += off.status == Status::contact;
        culled += on.statistics.visibility.culled;
      }
    }
    std::cout << nameOf(partner) << ": " << queries << " queries, " << contacts << " with contact, " << culled
              << " culled\n";
    EXPECT_GT(contacts, queries / 4);
    EXPECT_LT(contacts, queries * 9 / 10);
    EXPECT_GT(culled, queries / 40);
  }
}

}  // namespace

}  // namespace moving_test
