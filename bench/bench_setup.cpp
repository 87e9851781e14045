// SPDX-License-Identifier: BSD-3-Clause
//
// What large robots cost: set-up, set-up again after an obstacle has come, memory, and free motions. Links of many
// elements, each a ball of its own, beside the same balls as one PointCloud; and chains of many links. Clouds of a
// depth camera as obstacles, and thinned. With FCL_ARTIC_DATA also what another scene costs a Panda: a manager made
// anew, one that shares the robot, obstacles replaced in one.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "clouds.h"
#include "fcl_artic/manager.h"
#include "fcl_artic/point_cloud.h"
#include "planning/problems.h"
#include "random.h"
#include "setup_cost.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

namespace {

struct Model {
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
Model armOfBalls(std::size_t elements, bool as_cloud, std::uint64_t seed) {
  Model robot;
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
Model snake(std::size_t links) {
  Model robot;
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
  explicit World(const Model& robot_in) : robot(robot_in), manager(robot.tree) {
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
  const Model& robot;
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

/// Clouds of a depth camera, each the obstacle of a robot that is set up, until queries can be asked again; and a
/// frame, thinned.
void measureClouds(const std::vector<int>& sizes, int frame, std::uint64_t seed) {
  constexpr int kRepeats = 9;
  constexpr double kRadius = 0.005, kVoxel = 0.02;
  const Model robot = snake(8);
  World world(robot);
  for (const int size : sizes) {
    for (const bool in_rows : {true, false}) {
      Random random(seed);
      std::vector<Vector3d> points = frameOf(size, random);
      for (std::size_t i = in_rows ? 0 : points.size(); i > 1; --i) {
        std::swap(points[i - 1], points[static_cast<std::size_t>(random.index(static_cast<int>(i)))]);
      }
      std::vector<double> ms, bytes;
      for (int repeat = 0; repeat < kRepeats; ++repeat) {
        const auto cloud = std::make_shared<fcl::CollisionObjectd>(std::make_shared<PointCloud>(points, kRadius));
        const double before = residentMegabytes();
        const auto begin = Clock::now();
        world.manager.registerObject(cloud, "cloud");
        world.manager.setup();
        ms.push_back(1e-3 * microsecondsSince(begin));
        bytes.push_back(1e6 * (residentMegabytes() - before) / static_cast<double>(points.size()));
        world.manager.unregisterObject(cloud);
        world.manager.setup();
      }
      fmt::print("{:<28} ready after {:7.2f} ms, at least {:7.2f}; beside its points {:5.1f} bytes a point\n",
                 fmt::format("cloud of {}, {}", points.size(), in_rows ? "in rows" : "shuffled"), rank(ms, 0.5),
                 rank(ms, 0), rank(bytes, 0.5));
      std::fflush(stdout);
    }
  }
  Random random(seed);
  const PointCloud cloud(frameOf(frame, random), kRadius);
  std::vector<double> ms;
  std::size_t left = 0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto begin = Clock::now();
    left = cloud.thinned(kVoxel)->points().size();
    ms.push_back(1e-3 * microsecondsSince(begin));
  }
  fmt::print("{:<28} {:7.2f} ms, at least {:7.2f}; {} points left\n",
             fmt::format("{} thinned to {} m", cloud.points().size(), kVoxel), rank(ms, 0.5), rank(ms, 0), left);
}

/// Whether one is free and the other is not, or their first contacts can't be the same.
bool contradict(const CertifiedResult& a, const CertifiedResult& b) {
  return a.isFree() != b.isFree() || (!a.isFree() && (a.t_lower > b.t_upper || b.t_lower > a.t_upper));
}

using Objects = std::vector<std::shared_ptr<const fcl::CollisionObjectd>>;

Vector3d direction(Random& random) {
  Vector3d v;
  do {
    for (double& x : v) x = random.uniform(-1, 1);
  } while (v.squaredNorm() > 1 || v.squaredNorm() < 1e-4);
  return v.normalized();
}

/// In a shell about the robot; sizes as many of them still leave room between.
Objects makeScene(std::size_t count, bool mixed, Random& random) {
  const double most = 0.4 / std::cbrt(static_cast<double>(count));
  Objects objects;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = most * random.uniform(0.2, 1), b = most * random.uniform(0.2, 1),
                 c = most * random.uniform(0.2, 1);
    std::shared_ptr<fcl::CollisionGeometryd> shape;
    switch (mixed ? random.index(4) : 0) {
      case 0:
        shape = std::make_shared<fcl::Boxd>(a, b, c);
        break;
      case 1:
        shape = std::make_shared<fcl::Sphered>(a / 2);
        break;
      case 2:
        shape = std::make_shared<fcl::Cylinderd>(a / 2, b);
        break;
      default:
        shape = std::make_shared<fcl::Capsuled>(a / 2, b);
    }
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() = Eigen::AngleAxisd(random.uniform(0, 3), direction(random)).toRotationMatrix();
    M.translation() = direction(random) * random.uniform(0.4, 1.2);
    objects.push_back(std::make_shared<fcl::CollisionObjectd>(shape, M));
  }
  return objects;
}

struct Times {
  std::vector<double> us;
  std::string text() const { return fmt::format("{:9.1f} {:9.1f}", rank(us, 0.5), rank(us, 0)); }
};

/// Verdicts and brackets.
std::string answersOf(const ArticulatedCollisionManager& manager, const std::vector<JointMotion>& motions) {
  std::string bytes;
  for (const JointMotion& motion : motions) {
    CertifiedResult result;
    manager.continuousCollide(motion, {}, result);
    const double numbers[] = {static_cast<double>(result.status), result.t_lower, result.t_upper};
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
    if (const CertifiedContact* const c = result.first()) bytes += c->body1.name + c->body2.name;
  }
  return bytes;
}

/// Scenes of boxes, then of shapes of four kinds, and the ways to them.
/// @return scenes in which the ways' answers differ.
int measureSwaps(const std::filesystem::path& data, const std::vector<std::size_t>& counts, std::size_t swaps,
                 std::uint64_t seed) {
  constexpr std::size_t kSlow = 10;  // once in so many scenes the slow ways, and the answers of all
  const Robot robot = planning_data::readRobot(data, "panda");
  ArticulatedCollisionManager first(robot.tree);
  robot.addTo(first);
  first.setup();

  Random random(seed);
  std::vector<JointMotion> motions;
  for (int i = 0; i < 12; ++i) {
    Eigen::VectorXd q0(robot.tree->dof()), q1(robot.tree->dof());
    for (int v = 0; v < robot.tree->dof(); ++v) {
      const Joint& joint = robot.tree->joint(robot.tree->variableJoint(v));
      q0[v] = random.uniform(joint.lower, joint.upper);
      q1[v] = q0[v] + random.uniform(-0.3, 0.3);
    }
    motions.push_back(JointMotion::linear(*robot.tree, q0, q1));
  }

  fmt::print("us, median and least of {} scenes\n", swaps);
  fmt::print("{:<24} {:>19} {:>19} {:>19} {:>19} {:>19}\n", "obstacles", "made anew", "setup() again", "shareRobot()",
             "replaced, new", "replaced, moved");
  int different = 0;
  for (const bool mixed : {false, true}) {
    for (const std::size_t count : counts) {
      Times anew, again, shared, replaced, moved;
      ArticulatedCollisionManager kept = first.shareRobot(), by_setup = first.shareRobot();
      Objects before;
      for (std::size_t s = 0; s < swaps; ++s) {
        const Objects scene = makeScene(count, mixed, random);
        auto begin = Clock::now();
        kept.replaceObstacles(scene);
        replaced.us.push_back(microsecondsSince(begin));

        // The same geometries, elsewhere.
        Objects elsewhere;
        for (const auto& object : scene) {
          auto copy = std::make_shared<fcl::CollisionObjectd>(*object);
          copy->setTranslation(-object->getTranslation());
          elsewhere.push_back(copy);
        }
        begin = Clock::now();
        kept.replaceObstacles(elsewhere);
        moved.us.push_back(microsecondsSince(begin));
        kept.replaceObstacles(scene);

        if (s % kSlow != 0) continue;
        begin = Clock::now();
        ArticulatedCollisionManager fresh(robot.tree);
        robot.addTo(fresh);
        for (std::size_t i = 0; i < count; ++i) fresh.registerObject(scene[i]);
        fresh.setup();
        anew.us.push_back(microsecondsSince(begin));

        begin = Clock::now();
        for (const auto& object : before) by_setup.unregisterObject(object);
        for (std::size_t i = 0; i < count; ++i) by_setup.registerObject(scene[i], "obstacle" + std::to_string(i));
        by_setup.setup();
        again.us.push_back(microsecondsSince(begin));
        before = scene;

        begin = Clock::now();
        ArticulatedCollisionManager other = first.shareRobot();
        shared.us.push_back(microsecondsSince(begin));
        other.replaceObstacles(scene);
        const std::string wanted = answersOf(fresh, motions);
        different += answersOf(kept, motions) != wanted || answersOf(other, motions) != wanted ||
                     answersOf(by_setup, motions) != wanted;
      }
      fmt::print("{:<24} {} {} {} {} {}\n", fmt::format("{} {}", count, mixed ? "shapes of four kinds" : "boxes"),
                 anew.text(), again.text(), shared.text(), replaced.text(), moved.text());
      std::fflush(stdout);
    }
  }
  return different;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Set-up, memory and free motions of links of many elements, and of chains of many links");
  std::vector<std::size_t> elements{100, 1000, 10000, 100000}, links{50, 100, 200, 400};
  std::vector<std::size_t> obstacles{20, 200, 2000};
  std::vector<int> clouds{100000, 1000000};
  int frame = 307200;
  std::size_t motions = 40, swaps = 60;
  std::uint64_t seed = 1;
  app.add_option("--elements", elements, "Balls on one link")->capture_default_str();
  app.add_option("--links", links, "Of a chain with seven joints that turn")->capture_default_str();
  app.add_option("--clouds", clouds, "Points of clouds that are obstacles")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--frame", frame, "Points that are thinned")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--motions", motions, "Random motions of up to 0.5 rad a joint, of chains 0.05")
      ->capture_default_str();
  app.add_option("--obstacles", obstacles, "Of scenes of which one takes another's place")->capture_default_str();
  app.add_option("--swaps", swaps, "Such scenes of each number")->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  int contradictions = 0;
  for (const std::size_t count : elements) {
    Asked asked;
    {
      const Model robot = armOfBalls(count, false, seed);
      const World world(robot);
      asked = ask(world, motions, 0.5, seed);
      print(fmt::format("{} elements", count), world, asked);
    }
    const Model robot = armOfBalls(count, true, seed);
    const World world(robot);
    const Asked as_cloud = ask(world, motions, 0.5, seed);
    print(fmt::format("{} as one PointCloud", count), world, as_cloud);
    for (std::size_t i = 0; i < motions; ++i) contradictions += contradict(asked.answers[i], as_cloud.answers[i]);
  }
  for (const std::size_t count : links) {
    const Model robot = snake(count);
    const World world(robot);
    print(fmt::format("chain of {} links", count), world, ask(world, motions, 0.05, seed));
  }
  measureClouds(clouds, frame, seed);
  fmt::print("answers of elements that contradict those of the cloud: {}\n", contradictions);
  const std::filesystem::path data = planning_data::sharedData();
  if (data.empty()) {
    fmt::print("no scenes: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n");
    return contradictions ? 1 : 0;
  }
  const int different = measureSwaps(data, obstacles, swaps, seed);
  fmt::print("scenes with answers that differ: {}\n", different);
  return contradictions || different ? 1 : 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "bench_setup: {}\n", e.what());
  return 2;
}
