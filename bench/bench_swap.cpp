// SPDX-License-Identifier: BSD-3-Clause
//
// What another scene costs: a manager made anew, one that shares the robot, obstacles replaced in one. A Panda amid
// boxes, or amid boxes, spheres, cylinders and capsules. The answers of all of them have to be the same bits.
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "planning/problems.h"
#include "random.h"
#include "setup_cost.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using Eigen::Vector3d;

namespace {

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

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("What another scene costs: Panda, FCL_ARTIC_DATA");
  std::vector<std::size_t> counts{20, 200, 2000};
  std::size_t swaps = 60, slow = 10;
  std::uint64_t seed = 1;
  app.add_option("--obstacles", counts)->capture_default_str();
  app.add_option("--swaps", swaps, "Scenes of each number")->capture_default_str();
  app.add_option("--slow-ways", slow, "Also once in so many scenes the slow ways, and the answers of all")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const auto data = planning_data::sharedData();
  if (data.empty()) throw std::runtime_error("FCL_ARTIC_DATA names no folder with robots/, problems/ and edges/");
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

        if (s % slow != 0) continue;
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
  fmt::print("scenes with answers that differ: {}\n", different);
  return different ? 1 : 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "bench_swap: {}\n", e.what());
  return 2;
}
