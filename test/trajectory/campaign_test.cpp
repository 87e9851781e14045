// SPDX-License-Identifier: BSD-3-Clause
//
// Random trees of all joint kinds on random trajectories against dense sampling with FCL's static test of boxes.
#include <cstdio>
#include <random>

#include <fcl/narrowphase/collision.h>

#include "../support/allow_neighbours.h"
#include "scene.h"

namespace trajectory_test {
namespace campaign_test {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double lower, double upper) {
    return lower + (upper - lower) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  Vector3d vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Quaterniond rotation() {
    Eigen::Vector4d q;
    do q = {in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)};
    while (q.norm() > 1 || q.norm() < 0.1);
    return Quaterniond(q.normalized());
  }

 private:
  std::mt19937_64 engine_;
};

/// FCL's answer is off by rounding. A hit counts for boxes that are this much smaller on each side, in m, and boxes
/// that are proven to touch must do so if they are as much larger.
constexpr double kAround = 1e-5;
constexpr int kCases = 2000;

struct Body {
  int link;  ///< -1: obstacle
  Isometry3d offset;
  std::shared_ptr<fcl::Boxd> small, large;
};

struct Case {
  Scene scene;
  std::vector<Body> bodies;
  std::vector<Joint> joints;

  explicit Case(Random& random) {
    static const JointType kinds[] = {JointType::revolute, JointType::continuous, JointType::prismatic,
                                      JointType::fixed,    JointType::planar,     JointType::spherical,
                                      JointType::floating};
    std::string master;
    const int links = 2 + random.below(5);
    for (int i = 1; i <= links; ++i) {
      const JointType type = kinds[random.below(7)];
      const bool simple = KinematicTree::numVariables(type) == 1;
      const Mimic mimic = {master, random.in(-1.5, 1.5), random.in(-0.2, 0.2)};
      const bool follows = simple && !master.empty() && random.below(3) == 0;
      const std::string name = "l" + std::to_string(i), joint = "j" + std::to_string(i);
      const int parent = random.below(4) ? i - 1 : random.below(i);
      scene.add(joint, type, parent ? "l" + std::to_string(parent) : "base", name,
                random.vector(1) + Vector3d(0, 0, 1.1), Isometry3d(translation(random.vector(0.5)) * random.rotation()),
                follows ? &mimic : nullptr);
      if (simple && !follows) master = joint;
    }
    for (int i = 0; i < links + 3; ++i) {
      const Vector3d side(random.in(0.05, 0.5), random.in(0.05, 0.5), random.in(0.05, 0.5));
      Body body = {i < links ? i + 1 : -1, Isometry3d::Identity(),
                   std::make_shared<fcl::Boxd>(side - Vector3d::Constant(2 * kAround)),
                   std::make_shared<fcl::Boxd>(side + Vector3d::Constant(2 * kAround))};
      body.offset = translation(random.vector(i < links ? 0.2 : 1.8)) * random.rotation();
      const auto box = std::make_shared<fcl::Boxd>(side);
      if (i < links) {
        scene.bind("l" + std::to_string(i + 1), box, body.offset);
      } else {
        scene.obstacle("o" + std::to_string(i), box, body.offset);
      }
      bodies.push_back(body);
    }
    AllowedCollisionMatrix allowed;  // of the links only every fourth pair is watched: else most trees begin in contact
    for (int i = 1; i <= links; ++i) {
      for (int j = i + 1; j <= links; ++j) {
        if ((i + j) % 4) allowed.allow("l" + std::to_string(i), "l" + std::to_string(j));
        if ((i + j) % 4 == 0) watched_.emplace_back(i - 1, j - 1);
      }
    }
    scene.ready().setAllowedCollisions(allowed);
    for (int i = 0; i < links; ++i) {
      for (int o = 0; o < 3; ++o) watched_.emplace_back(i, links + o);
    }
  }

  JointTrajectory trajectory(Random& random) const {
    const KinematicTree& tree = *scene.tree;
    const int n = 2 + random.below(3);
    const bool cubic = random.below(2);
    std::vector<double> times{random.in(-5, 5)};
    std::vector<VectorXd> q, v;
    for (int k = 0; k < n; ++k) {
      if (k > 0) times.push_back(times.back() + random.in(0.2, 3));
      VectorXd x(tree.dof()), rate(tree.dof());
      for (int i = 0; i < tree.dof(); ++i) {
        x[i] = random.in(-1, 1) * (tree.isAngle(i) ? 2 : 0.4);
        rate[i] = random.in(-0.5, 0.5);
      }
      for (JointId j = 0; j < tree.numJoints(); ++j) {
        const int i = tree.quaternionVariable(j);
        if (i < 0) continue;
        x.segment<4>(i) = random.rotation().coeffs();
        rate[i + 3] = 0;
      }
      q.push_back(x);
      v.push_back(rate);
    }
    return cubic ? JointTrajectory::cubic(tree, times, q, v) : JointTrajectory::linear(tree, times, q);
  }

  /// Whether a watched pair of the smaller boxes, or of the larger ones, touches at t.
  bool touches(const JointTrajectory& x, double t, std::shared_ptr<fcl::Boxd> Body::*box) const {
    std::vector<Isometry3d> M;
    scene.tree->forwardKinematics(x.configuration(t), M);
    const auto pose = [&](const Body& b) {
      return b.link < 0 ? b.offset : M[static_cast<std::size_t>(b.link)] * b.offset;
    };
    for (const auto& [i, j] : watched_) {
      const Body &a = bodies[static_cast<std::size_t>(i)], &b = bodies[static_cast<std::size_t>(j)];
      if (carrier(*scene.tree, a.link) == carrier(*scene.tree, b.link)) continue;  // stand still against each other
      if (near(scene.tree.get(), a.link, b.link)) continue;
      fcl::CollisionRequestd request;
      fcl::CollisionResultd result;
      if (fcl::collide((a.*box).get(), pose(a), (b.*box).get(), pose(b), request, result) > 0) return true;
    }
    return false;
  }

 private:
  /// The nearest link at or above this one that a joint moves; 0: the base, which stands still as obstacles (-1) do.
  static int carrier(const KinematicTree& tree, int link) {
    if (link < 0) return 0;
    while (link > 0 && tree.joint(tree.parentJoint(link)).type == JointType::fixed) link = tree.parentLink(link);
    return link;
  }
  /// Neighbours may touch (every link has geometry but the base).
  static bool near(const KinematicTree* tree, int a, int b) {
    if (a < 0 || b < 0) return false;
    const auto type = [&](int link) { return tree->joint(tree->parentJoint(link)).type; };
    const auto isFree = [&](int link) {  // planar or floating, on what stands still
      if (type(link) != JointType::planar && type(link) != JointType::floating) return false;
      do link = tree->parentLink(link);
      while (link > 0 && type(link) == JointType::fixed);
      return link == 0;
    };
    if (tree->parentLink(a) == b) return !isFree(a);
    if (tree->parentLink(b) == a) return !isFree(b);
    const bool siblings = tree->parentLink(a) == 0 && tree->parentLink(b) == 0;
    return siblings && (type(a) == JointType::fixed || type(b) == JointType::fixed) && !isFree(a) && !isFree(b);
  }
  std::vector<std::pair<int, int>> watched_;
};

TEST(TrajectoryCampaign, NoContactIsMissed) {
  constexpr std::uint64_t kSeed = 20261121;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  int hits = 0, free = 0, at_start = 0, uncertain = 0, sampled = 0, pieces = 0;
  int of_kind[7] = {};
  for (std::uint64_t n = 0; n < kCases; ++n) {
    Random random(kSeed + n);
    Case c(random);
    test::setUpWithoutNeighbours(c.scene.ready());
    const JointTrajectory x = c.trajectory(random);
    pieces += static_cast<int>(x.numPieces());
    const CertifiedResult r = c.scene.run(x);
    ASSERT_NE(r.status, Status::undecided) << n;
    for (JointId j = 0; j < c.scene.tree->numJoints(); ++j) ++of_kind[static_cast<int>(c.scene.tree->joint(j).type)];
    if (r.isFree()) {
      ++free;
    } else {
      ++hits;
      at_start += r.t_upper <= x.beginTime();
      uncertain += !r.certain;
    }
    const double length = x.endTime() - x.beginTime();
    for (int s = 0; s <= 400; ++s) {
      const double t = x.beginTime() + length * s / 400;
      if (t >= r.t_lower && !r.isFree()) break;
      ASSERT_FALSE(c.touches(x, t, &Body::small))
          << "case " << n << " at " << t << ", said to be free before " << r.t_lower;
      ++sampled;
    }
    if (r.certain) {
      EXPECT_TRUE(c.touches(x, r.t_upper, &Body::large)) << "case " << n << ": nothing touches at " << r.t_upper;
      std::vector<Isometry3d> M;
      c.scene.tree->forwardKinematics(x.configuration(r.t_lower), M);
      for (std::size_t i = 0; i < M.size(); ++i) EXPECT_TRUE(M[i].isApprox(r.M_0_at_lower[i], 1e-12)) << n;
    }
  }
  std::printf("%d trajectories of %d pieces: %d contacts (%d at the start, %d not certain), %d free; %d samples\n",
              kCases, pieces, hits, at_start, uncertain, free, sampled);
  EXPECT_GT(hits - at_start, kCases / 5) << "too few contacts on the way";
  EXPECT_GT(free, kCases / 5);
  EXPECT_LT(uncertain, kCases / 100);
  for (const int count : of_kind) EXPECT_GT(count, kCases / 5);
}

}  // namespace
}  // namespace campaign_test
}  // namespace trajectory_test
