// SPDX-License-Identifier: BSD-3-Clause
//
// What large robots cost: set-up, set-up again after an obstacle has come, memory, and free motions. Links of many
// elements, each a ball of its own, beside the same balls as one PointCloud; and chains of many links.
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "fcl_artic/manager.h"
#include "fcl_artic/point_cloud.h"
#include "random.h"
#include "setup_cost.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

namespace {

struct Robot {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("robot");
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> objects;
  std::vector<std::pair<LinkId, Isometry3d>> bound;

  void add(const std::string& link, const std::shared_ptr<fcl::CollisionGeometryd>& geometry, const Vector3d& at) {
    objects.push_back(std::make_shared<fcl::CollisionObjectd>(geometry));
    bound.emplace_back(tree->linkId(link), Isometry3d(Translation3d(at)));
  }
};

Isometry3d up(double z) {
  return Isometry3d(Translation3d(0, 0, z));
}

/// Two links of a metre on a shoulder and an elbow, a hand on a wrist; the first one is a tube of `elements` balls.
Robot armOfBalls(std::size_t elements, bool as_cloud, std::uint64_t seed) {
  Robot robot;
  for (const char* link : {"base", "upper", "lower", "hand"}) robot.tree->addLink(link);
  robot.tree->addJoint(Joint::revolute("shoulder", "base", "upper", Vector3d::UnitX(), up(0.2), -2, 2));
  robot.tree->addJoint(Joint::revolute("elbow", "upper", "lower", Vector3d::UnitY(), up(1), -2, 2));
  robot.tree->addJoint(Joint::revolute("wrist", "lower", "hand", Vector3d::UnitX(), up(0.6), -2, 2));
  constexpr double kRadius = 0.02;
  Random random(seed);
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < elements; ++i) {
    const double angle = random.uniform(0, 2 * M_PI), z = random.uniform(0.2, 0.8);
    points.emplace_back(0.1 * std::cos(angle), 0.1 * std::sin(angle), z);
  }
  robot.add("base", std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2), Vector3d::Zero());
  if (as_cloud) {
    robot.add("upper", std::make_shared<PointCloud>(std::move(points), kRadius), Vector3d::Zero());
  } else {
    const auto ball = std::make_shared<fcl::Sphered>(kRadius);
    for (const Vector3d& point : points) robot.add("upper", ball, point);
  }
  for (int i = 0; i < 8; ++i) robot.add("lower", std::make_shared<fcl::Sphered>(0.05), Vector3d(0, 0, 0.15 + 0.05 * i));
  robot.add("hand", std::make_shared<fcl::Boxd>(0.1, 0.05, 0.1), Vector3d(0, 0, 0.1));
  return robot;
}

/// A snake of boxes of 5 cm, seven of its joints turning, evenly among fixed ones.
Robot snake(std::size_t links) {
  Robot robot;
  const auto box = std::make_shared<fcl::Boxd>(0.03, 0.03, 0.03);
  for (std::size_t i = 0; i < links; ++i) {
    const std::string name = fmt::format("link{}", i), below = fmt::format("link{}", i - 1);
    robot.tree->addLink(name);
    if (i > 0) {
      const bool turns = i * 7 / links != (i - 1) * 7 / links || i == 1;
      const std::string joint = fmt::format("joint{}", i);
      if (turns) {
        const Vector3d axis = i % 2 ? Vector3d::UnitX() : Vector3d::UnitY();
        robot.tree->addJoint(Joint::continuous(joint, below, name, axis, up(0.05)));
      } else {
        robot.tree->addJoint(Joint::fixed(joint, below, name, up(0.05)));
      }
    }
    robot.add(name, box, Vector3d::Zero());
  }
  return robot;
}

/// A robot, set up, beside a box out of its way; what that took.
struct World {
  explicit World(const Robot& robot_in) : robot(robot_in), manager(robot.tree) {
    const double before = megabytes();
    auto begin = Clock::now();
    for (std::size_t i = 0; i < robot.objects.size(); ++i) {
      manager.bind(robot.bound[i].first, robot.objects[i], robot.bound[i].second);
    }
    manager.setup();
    setup_ms = 1e-3 * microsecondsSince(begin);
    memory = megabytes() - before;
    begin = Clock::now();
    const auto box = std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1);
    manager.registerObject(std::make_shared<fcl::CollisionObjectd>(box, Isometry3d(Translation3d(0, 0.4, 0.9))), "box");
    manager.setup();
    again_ms = 1e-3 * microsecondsSince(begin);
  }
  const Robot& robot;
  ArticulatedCollisionManager manager;
  double setup_ms, again_ms, memory;
};

struct Asked {
  std::vector<CertifiedResult> answers;
  std::array<std::vector<double>, 2> us;  ///< in contact, free: the fastest of three each
};

Asked ask(const World& world, std::size_t count, double angle, std::uint64_t seed) {
  Random random(seed);
  Asked asked;
  const int n = world.robot.tree->dof();
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::VectorXd q0(n), q1(n);
    for (int v = 0; v < n; ++v) {
      q0[v] = random.uniform(-0.3, 0.3);
      q1[v] = q0[v] + random.uniform(-angle, angle);
    }
    const JointMotion motion = JointMotion::linear(*world.robot.tree, q0, q1);
    CertifiedResult result;
    double best = 1e300;
    for (int pass = 0; pass < 3; ++pass) {
      const auto begin = Clock::now();
      world.manager.continuousCollide(motion, {}, result);
      best = std::min(best, microsecondsSince(begin));
    }
    asked.us[result.isFree()].push_back(best);
    asked.answers.push_back(std::move(result));
  }
  return asked;
}

void print(const std::string& what, const World& world, const Asked& asked) {
  fmt::print(
      "{:<28} set-up {:8.1f} ms, again {:8.1f} ms, {:7.1f} MB; free {:3}: {:9.1f} us; contact {:3}: {:9.1f} us\n", what,
      world.setup_ms, world.again_ms, world.memory, asked.us[1].size(), rank(asked.us[1], 0.5), asked.us[0].size(),
      rank(asked.us[0], 0.5));
  std::fflush(stdout);
}

/// Whether one is free and the other is not, or their first contacts can't be the same.
bool contradict(const CertifiedResult& a, const CertifiedResult& b) {
  return a.isFree() != b.isFree() || (!a.isFree() && (a.t_lower > b.t_upper || b.t_lower > a.t_upper));
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Set-up, memory and free motions of links of many elements, and of chains of many links");
  std::vector<std::size_t> elements{100, 1000, 10000, 100000}, links{50, 100, 200, 400};
  std::size_t motions = 40;
  std::uint64_t seed = 1;
  app.add_option("--elements", elements, "Balls on one link")->capture_default_str();
  app.add_option("--links", links, "Of a chain with seven joints that turn")->capture_default_str();
  app.add_option("--motions", motions, "Random motions of up to 0.5 rad a joint, of chains 0.05")
      ->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  int contradictions = 0;
  for (const std::size_t count : elements) {
    Asked asked;
    {
      const Robot robot = armOfBalls(count, false, seed);
      const World world(robot);
      asked = ask(world, motions, 0.5, seed);
      print(fmt::format("{} elements", count), world, asked);
    }
    const Robot robot = armOfBalls(count, true, seed);
    const World world(robot);
    const Asked as_cloud = ask(world, motions, 0.5, seed);
    print(fmt::format("{} as one PointCloud", count), world, as_cloud);
    for (std::size_t i = 0; i < motions; ++i) contradictions += contradict(asked.answers[i], as_cloud.answers[i]);
  }
  for (const std::size_t count : links) {
    const Robot robot = snake(count);
    const World world(robot);
    print(fmt::format("chain of {} links", count), world, ask(world, motions, 0.05, seed));
  }
  fmt::print("answers of elements that contradict those of the cloud: {}\n", contradictions);
  return contradictions ? 1 : 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "bench_setup: {}\n", e.what());
  return 2;
}
