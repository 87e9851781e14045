// SPDX-License-Identifier: BSD-3-Clause
// Section 5.1.1: each link's own refinement level; and 5.2.4: what Newton's step saves.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "../support/allow_neighbours.h"
#include "fcl_artic/fcl_artic.h"
#include "meshes.h"
#include "redon/parts.h"

namespace levels_test {

namespace {

using Eigen::Vector3d;
using namespace fcl_artic;

/// Geometry at a joint each; the joints hang on the base, or on one another.
struct Arm {
  struct Part {
    JointType type;
    Vector3d axis, origin;
    redon_test::MeshPtr mesh;
  };
  Arm(const std::vector<Part>& parts, bool chain) : tree(std::make_shared<KinematicTree>("arm")) {
    tree->addLink("base");
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string number = std::to_string(i);
      Joint joint;
      joint.name = "joint" + number;
      joint.type = parts[i].type;
      joint.axis = parts[i].axis.normalized();
      joint.origin.translation() = parts[i].origin;
      joint.parent = chain && i ? "link" + std::to_string(i - 1) : "base";
      joint.child = "link" + number;
      tree->addLink(joint.child);
      tree->addJoint(joint);
    }
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      objects.push_back(std::make_unique<fcl::CollisionObjectd>(parts[i].mesh));
      manager->bind("link" + std::to_string(i), objects.back().get());
    }
  }
  void addObstacle(const redon_test::MeshPtr& mesh, const Vector3d& place) {
    objects.push_back(std::make_unique<fcl::CollisionObjectd>(mesh, Eigen::Isometry3d(Eigen::Translation3d(place))));
    manager->registerObject(objects.back().get());
  }
  CertifiedResult ask(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1, const CertifiedRequest& request) {
    CertifiedResult result;
    manager->continuousCollide(JointMotion::linear(*tree, q0, q1), request, result);
    return result;
  }
  std::shared_ptr<KinematicTree> tree;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  std::unique_ptr<ArticulatedCollisionManager> manager;
};

CertifiedRequest paper() {
  CertifiedRequest request;
  request.method = Method::redon2004;
  return request;
}

TEST(Levels, PairsOfBoundsAreThoseOfThePapersExample) {
  const int r0 = 1, r1 = 2;
  std::vector<std::pair<int, int>> pairs;
  for (int k = 0; k < 4; ++k) pairs.emplace_back(redon::partHolding(r0, k, 2), redon::partHolding(r1, k, 2));
  const std::vector<std::pair<int, int>> printed{{0, 0}, {0, 1}, {1, 2}, {1, 3}};  // [0, 0.5] and [0, 0.25], ...
  EXPECT_EQ(pairs, printed);
}

/// Two needles beside each other that slide along themselves, by what makes their levels 1 and 2: their boxes in the
/// world's axes meet all the time, their oriented boxes never.
TEST(Levels, TwoLinksAreTestedOncePerSubIntervalOfTheFinerOne) {
  const Vector3d way = Vector3d(1, 1, 0).normalized(), side = Vector3d(1, -1, 0).normalized();
  const auto needle = redon_test::triangle(-way, way, 1e-3 * Vector3d::UnitZ());
  Arm arm({{JointType::prismatic, way, Vector3d::Zero(), needle}, {JointType::prismatic, way, 0.2 * side, needle}},
          false);
  arm.manager->setup();
  for (const auto& [level0, level1] : {std::pair<int, int>{1, 2}, {2, 1}, {0, 0}, {3, 1}, {4, 4}}) {
    // A link of size 1 moves by no more than an eighth in a sub-interval.
    const Eigen::Vector2d q1(0.12 * (1 << level0), 0.12 * (1 << level1));
    CertifiedRequest request = paper();
    request.redon.links_in_world = true;
    const CertifiedResult world = arm.ask(Eigen::Vector2d::Zero(), q1, request);
    EXPECT_TRUE(world.isFree());
    EXPECT_EQ(world.statistics.redon.box_tests, 1u << std::max(level0, level1)) << level0 << " " << level1;
    EXPECT_EQ(world.statistics.redon.leaf_pairs, 0u);
    // Seen from the one the other moves by the difference.
    request.redon.links_in_world = false;
    const CertifiedResult relative = arm.ask(Eigen::Vector2d::Zero(), q1, request);
    EXPECT_TRUE(relative.isFree());
    int level = 0;
    while (std::abs(q1[0] - q1[1]) > 0.125 * (1 << level)) ++level;
    EXPECT_EQ(relative.statistics.redon.box_tests, 1u << level) << level0 << " " << level1;
  }
}

/// A link that is far from everything is bounded over the whole motion only.
TEST(Levels, FarLinksAreNotRefined) {
  const auto box = redon_test::boxMesh(0.05, 0.05, 0.5);
  Arm arm({{JointType::revolute, Vector3d::UnitX(), Vector3d::Zero(), box}}, true);
  arm.addObstacle(redon_test::boxMesh(0.1, 0.1, 0.1), Vector3d(0, 0, 5));
  arm.manager->setup();
  Eigen::VectorXd q0(1), q1(1);
  q0 << 0;
  q1 << 1;
  const CertifiedResult far = arm.ask(q0, q1, paper());
  EXPECT_TRUE(far.isFree());
  EXPECT_EQ(far.statistics.redon.steps_bounded, 1u);
  EXPECT_EQ(far.statistics.redon.box_tests, 0u);
}

/// A vertex that comes to a face on a circle: the time to any accuracy.
TEST(Newton, IntervalsGrowSlowlyWithTheAccuracyWhereBisectionsGrowByOneForEachBit) {
  Arm arm({{JointType::revolute, Vector3d::UnitZ(), Vector3d::Zero(),
            redon_test::triangle({1, 0, 0}, {0.2, 0.01, 0}, {0.2, -0.01, 0.01})}},
          true);
  arm.addObstacle(redon_test::triangle({0.3, 0.5, -1}, {1.3, 0.5, -1}, {0.8, 0.5, 1}), Vector3d::Zero());
  arm.manager->setup();
  Eigen::VectorXd q0(1), q1(1);
  q0 << 0;
  q1 << 1;
  const double exact = std::asin(0.5);
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    CertifiedRequest request = paper();
    request.tolerance_time = tolerance;
    std::uint64_t intervals[2];
    for (const bool newton : {false, true}) {
      request.redon.newton = newton;
      const CertifiedResult result = arm.ask(q0, q1, request);
      ASSERT_EQ(result.status, Status::contact);
      EXPECT_TRUE(result.certain);
      EXPECT_LE(result.t_lower, exact);
      EXPECT_GE(result.t_upper, exact);
      EXPECT_LE(result.t_upper - result.t_lower, tolerance);
      intervals[newton] = result.statistics.redon.intervals;
    }
    std::cout << "to " << tolerance << ": " << intervals[true] << " intervals, by bisection " << intervals[false]
              << '\n';
    const double bits = -std::log2(tolerance) - 6;  // sub-intervals of 1/64 at the finest
    EXPECT_GE(static_cast<double>(intervals[false]), bits);
    EXPECT_LE(static_cast<double>(intervals[true]), 6 + 0.2 * bits);
  }
}

/// An arm of three turns round obstacles: all levels, by the whole turns too.
TEST(Levels, LargeMotionsHaveTheSameAnswerAtEveryLevel) {
  const auto link = redon_test::boxMesh(0.25, 0.04, 0.03);
  int contacts = 0, free = 0, decided = 0, undecided = 0;
  for (const double degrees : {90., 180., 270., 360.}) {
    for (int scene = 0; scene < 6; ++scene) {
      Arm arm({{JointType::revolute, Vector3d::UnitZ(), Vector3d(0.25, 0, 0), link},
               {JointType::revolute, Vector3d(0, 1, 0.2), Vector3d(0.5, 0, 0), link},
               {JointType::revolute, Vector3d(0.1, 1, 0), Vector3d(0.5, 0, 0), link}},
              true);
      // Neighbours touch: only obstacles are asked about.
      const double turn = 0.7 * scene;
      arm.addObstacle(redon_test::boxMesh(0.1, 0.1, 0.1), Vector3d(0.25 + (0.8 + 0.13 * scene) * std::cos(turn),
                                                                   0.8 * std::sin(turn), 0.16 - 0.03 * scene));
      arm.manager->setup();
      CertifiedRequest request;
      request.check_self = false;
      const Eigen::Vector3d q0(0.2 * scene, 0.1, -0.2),
          q1 = q0 + degrees * 0.017453292519943295 * Vector3d(1, scene % 2 ? 0.1 : -0.15, 0.1);
      const CertifiedResult standard = arm.ask(q0, q1, request);
      ++(standard.isFree() ? free : contacts);
      request.method = Method::redon2004;
      for (const RedonOptions& options : {RedonOptions(), RedonOptions::asWritten()}) {
        for (int level = -1; level <= 6; ++level) {
          request.redon = options;
          request.redon.refinement_level = level;
          request.work_budget = 300000;  // a turn undivided may have no end
          const CertifiedResult result = arm.ask(q0, q1, request);
          const std::string name =
              std::to_string(degrees) + " degrees, scene " + std::to_string(scene) + ", level " + std::to_string(level);
          if (result.status == Status::undecided) {
            ++undecided;
            EXPECT_LE(result.t_lower, standard.isFree() ? 1 : standard.t_upper) << name;
            continue;
          }
          ++decided;
          ASSERT_EQ(result.status, standard.status) << name;
          if (!standard.isFree()) {
            EXPECT_NEAR(result.t_lower, standard.t_lower, 2e-6) << name;
          }
        }
      }
    }
  }
  std::cout << contacts << " contacts, " << free << " free motions; " << decided << " answers, " << undecided
            << " undecided\n";
  EXPECT_GE(contacts, 5);
  EXPECT_GE(free, 5);
  EXPECT_GE(decided, 200);
}

/// Two arms beside each other, one of them as much slower as it happens to be: links meet links, seen from one another
/// and in the world.
TEST(Levels, LinksThatMeetLinksHaveTheSameAnswerSeenFromTheWorld) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto link = redon_test::boxMesh(0.03, 0.04, 0.2);
  auto tree = std::make_shared<KinematicTree>("arms");
  tree->addLink("base");
  for (int arm = 0; arm < 2; ++arm) {
    for (int i = 0; i < 2; ++i) {
      Joint joint;
      const std::string name = std::to_string(arm) + std::to_string(i);
      joint.name = "joint" + name;
      joint.type = JointType::revolute;
      joint.axis = i ? Vector3d::UnitY() : Vector3d(0.3, 1, arm).normalized();
      joint.origin.translation() = i ? Vector3d(0, 0, 0.5) : Vector3d(0.3 * arm, 0, 0);
      joint.parent = i ? "link" + std::to_string(arm) + "0" : "base";
      joint.child = "link" + name;
      tree->addLink(joint.child);
      tree->addJoint(joint);
    }
  }
  ArticulatedCollisionManager manager(tree);
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  for (const char* name : {"link00", "link01", "link10", "link11"}) {
    objects.push_back(std::make_unique<fcl::CollisionObjectd>(link));
    manager.bind(name, objects.back().get(), Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.22)));
  }
  fcl_artic::test::setUpWithoutNeighbours(manager);  // the standard method has them
  int contacts = 0, free = 0;
  for (int i = 0; i < 600; ++i) {
    Eigen::Vector4d q0, dq;
    for (int v = 0; v < 4; ++v) q0[v] = 0.6 * uniform(random), dq[v] = 1.5 * uniform(random);
    dq.head<2>() *= std::pow(10, uniform(random) - 1);
    const JointMotion motion = JointMotion::linear(*tree, q0, q0 + dq);
    CertifiedRequest request;
    CertifiedResult standard, result;
    manager.continuousCollide(motion, request, standard);
    if (!standard.isFree() && (!standard.certain || standard.t_lower == 0)) continue;
    ++(standard.isFree() ? free : contacts);
    request.method = Method::redon2004;
    for (const RedonOptions& options : {RedonOptions(), RedonOptions::asWritten()}) {
      for (const bool in_world : {false, true}) {
        request.redon = options;
        request.redon.links_in_world = in_world;
        manager.continuousCollide(motion, request, result);
        ASSERT_EQ(result.status, standard.status) << i << (in_world ? " in the world" : "");
        EXPECT_EQ(result.statistics.redon.pairs_by_standard, 0u);
        if (!standard.isFree()) {
          EXPECT_NEAR(result.t_lower, standard.t_lower, 2e-6) << i << (in_world ? " in the world" : "");
        }
      }
    }
  }
  std::cout << contacts << " contacts, " << free << " free motions\n";
  EXPECT_GE(contacts, 50);
  EXPECT_GE(free, 50);
}

/// Leaf pairs that are solved in several sets, for their memory. The first contact is that of all sets, and progress
/// never reports a time after a later set's contact.
TEST(Levels, LeafPairsOfSeveralSetsHaveOneFirstContact) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto cloud = [&](double begin, int n) {
    std::vector<Vector3d> vertices;
    std::vector<fcl::Triangle> triangles;
    for (int i = 0; i < n; ++i) {
      const Vector3d place(begin + 0.5 + 0.5 * uniform(random), 0.04 * uniform(random), 0.04 * uniform(random));
      for (int k = 0; k < 3; ++k) {
        vertices.push_back(place + 0.03 * Vector3d(uniform(random), uniform(random), uniform(random)));
      }
      const auto first = static_cast<std::size_t>(3 * i);
      triangles.emplace_back(first, first + 1, first + 2);
    }
    return redon_test::mesh(vertices, triangles);
  };
  Arm arm({{JointType::prismatic, Vector3d::UnitX(), Vector3d::Zero(), cloud(-1.1, 600)}}, true);
  arm.addObstacle(cloud(0.1, 600), Vector3d::Zero());
  arm.manager->setup();
  Eigen::VectorXd q0(1), q1(1);
  q0 << 0;
  q1 << 1;
  const CertifiedResult standard = arm.ask(q0, q1, CertifiedRequest());
  ASSERT_EQ(standard.status, Status::contact);
  ASSERT_TRUE(standard.certain);
  for (const bool in_time_order : {true, false}) {
    CertifiedRequest request = paper();
    request.redon.refinement_level = 0;
    request.redon.in_time_order = in_time_order;
    request.redon.early_validity = request.redon.newton = false;  // many intervals: progress is told of now and then
    request.work_budget = std::uint64_t{1} << 40;                 // more than a query without one takes
    int told = 0;
    request.progress = [&](double t_lower) {
      ++told;
      EXPECT_LE(t_lower, standard.t_upper);
      return true;
    };
    const CertifiedResult result = arm.ask(q0, q1, request);
    EXPECT_GE(result.statistics.redon.leaf_pairs, 2u << 15) << "one set would do";
    ASSERT_EQ(result.status, Status::contact);
    EXPECT_TRUE(result.certain);
    EXPECT_NEAR(result.t_lower, standard.t_lower, 2e-6);
    EXPECT_GE(told, 2);
  }
}

/// A budget ends what would have no end, soon after it is spent.
TEST(Levels, TheBudgetCountsBoxesLeavesEquationsAndEvaluations) {
  const auto link = redon_test::boxMesh(0.25, 0.04, 0.03);
  Arm arm({{JointType::revolute, Vector3d(0.1, 0.2, 1), Vector3d::Zero(), link}}, true);
  for (int i = 0; i < 20; ++i) arm.addObstacle(link, Vector3d(0.3 * std::cos(i), 0.3 * std::sin(i), 0.0625));
  arm.manager->setup();
  Eigen::VectorXd q0(1), q1(1);
  q0 << 0;
  q1 << 3;
  int undecided = 0;
  for (const bool in_time_order : {false, true}) {
    for (const std::uint64_t budget : {100u, 1000u, 10000u}) {
      CertifiedRequest request = paper();
      request.check_self = false;
      request.redon.refinement_level = 0;
      request.redon.enclosure = MotionEnclosure::intervalChain;
      request.redon.in_time_order = in_time_order;
      request.work_budget = budget;
      const CertifiedResult result = arm.ask(q0, q1, request);
      const RedonStatistics& work = result.statistics.redon;
      const std::uint64_t spent = work.box_tests + work.leaf_pairs + work.equations + work.evaluations;
      undecided += result.status == Status::undecided;
      EXPECT_LE(spent, 3 * budget) << "the equations of one set of leaf pairs are made at once";
    }
  }
  EXPECT_GE(undecided, 4);
}

}  // namespace

}  // namespace levels_test
