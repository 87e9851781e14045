// SPDX-License-Identifier: BSD-3-Clause
//
// A Panda amid a cloud of points, as a scanner sees 20 bumpy bodies: each point a ball, beside the same points as the
// cells of an OcTree. Set-up, memory, and queries of free and of colliding random motions; and the cloud's answers
// beside FCL's of each ball at samples of the motions. FCL_ARTIC_DATA names the folder with robots/ and problems/.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "arm_scene.h"
#include "planning/problems.h"
#include "random_motion.h"
#include "setup_cost.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;

namespace {

using Eigen::Vector3d;

/// Points of the bodies' surfaces, each off by up to a third of a radius.
std::vector<Vector3d> scan(std::size_t n, double radius, Random& random) {
  std::vector<TriangleMesh> meshes;
  while (meshes.size() < 20) {
    BumpyEllipsoid body;
    body.centre = Vector3d(random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-0.2, 1.1));
    body.half.setConstant(random.uniform(0.05, 0.12));
    if (body.centre.head<2>().norm() > 0.3) meshes.push_back(body.mesh(80, 40));
  }
  const TriangleMesh all = merge(meshes);
  std::vector<Vector3d> points;
  while (points.size() < n) {
    const auto& t = all.triangles[static_cast<std::size_t>(random.index(static_cast<int>(all.triangles.size())))];
    double u = random.uniform(0, 1), v = random.uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vector3d a = all.vertices[t[0]], b = all.vertices[t[1]], c = all.vertices[t[2]];
    const Vector3d off(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    points.push_back(a + u * (b - a) + v * (c - a) + radius / 3 * off);
  }
  return points;
}

std::shared_ptr<fcl::OcTreed> cellsOf(const std::vector<Vector3d>& points, double size) {
  const auto tree = std::make_shared<octomap::OcTree>(size);
  for (const Vector3d& p : points) tree->updateNode(p[0], p[1], p[2], true, true);
  tree->updateInnerOccupancy();
  return std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
}

struct World {
  World(const Robot& robot, const std::shared_ptr<fcl::CollisionGeometryd>& obstacle) : manager(robot.tree) {
    const double before = megabytes();
    const auto begin = Clock::now();
    robot.addTo(manager);
    manager.registerObject(std::make_shared<fcl::CollisionObjectd>(obstacle), "scan");
    manager.setup();
    setup_ms = 1e-3 * microsecondsSince(begin);
    memory = megabytes() - before;
  }
  ArticulatedCollisionManager manager;
  double setup_ms, memory;
};

/// Times of all motions, the fastest of three runs each; and whether they are free.
void measure(const char* what, std::size_t points, const World& world, const std::vector<JointMotion>& motions,
             std::vector<CertifiedResult>& answers) {
  std::vector<double> times[2];  // colliding, free
  answers.resize(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    double best = 1e300;
    for (int pass = 0; pass < 3; ++pass) {
      const auto begin = Clock::now();
      world.manager.continuousCollide(motions[i], CertifiedRequest(), answers[i]);
      best = std::min(best, microsecondsSince(begin));
    }
    times[answers[i].isFree()].push_back(best);
  }
  fmt::print(
      "{:>8} {:7} set-up {:7.1f} ms, {:6.1f} MB; free {:4}: {:6.1f} us, 99 % {:7.1f}; contact {:4}: {:6.1f} us, 99 % "
      "{:7.1f}\n",
      points, what, world.setup_ms, world.memory, times[1].size(), rank(times[1], 0.5), rank(times[1], 0.99),
      times[0].size(), rank(times[0], 0.5), rank(times[0], 0.99));
}

/// Samples of the motions at which FCL finds a ball touched before the cloud's t_lower: missed or late.
/// @param[out] touched  motions with a touched sample.
int judge(const Robot& robot, const PointCloud& cloud, const std::vector<JointMotion>& motions,
          const std::vector<CertifiedResult>& answers, int& touched) {
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> balls;
  std::vector<fcl::CollisionObjectd*> all;
  const auto ball = std::make_shared<fcl::Sphered>(cloud.radius(0));
  for (const Vector3d& p : cloud.points()) {
    balls.push_back(std::make_unique<fcl::CollisionObjectd>(ball, Eigen::Isometry3d(Eigen::Translation3d(p))));
    all.push_back(balls.back().get());
  }
  fcl::DynamicAABBTreeCollisionManagerd tree;
  tree.registerObjects(all);
  tree.setup();
  int faults = 0;
  std::vector<Eigen::Isometry3d> M_0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const double before = answers[i].isFree() ? 1 : answers[i].t_lower;
    for (int k = 0; k <= 100; ++k) {
      const double t = k / 100.0;
      robot.tree->forwardKinematics(motions[i].configuration(t), M_0);
      bool hit = false;
      for (const LinkGeometry& g : robot.geometry) {
        fcl::CollisionObjectd link(*g.object);
        link.setTransform(M_0[static_cast<std::size_t>(g.link)] * g.offset);
        link.computeAABB();
        struct Found {
          bool any = false;
        } found;
        tree.collide(&link, &found, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
          fcl::CollisionResultd result;
          auto* f = static_cast<Found*>(data);
          f->any = fcl::collide(a, b, fcl::CollisionRequestd(), result) > 0;
          return f->any;
        });
        hit = hit || found.any;
      }
      if (!hit) continue;
      ++touched;
      if (t < before || answers[i].isFree()) {
        fmt::print("motion {}: FCL finds contact at {}, the answer is free before {}\n", i, t, before);
        ++faults;
      }
      break;
    }
  }
  return faults;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Motions of a Panda amid clouds of points, beside the same points as an OcTree's cells");
  std::vector<std::size_t> sizes{10000, 100000, 1000000};
  std::size_t num_motions = 400, judged = 40;
  double radius = 0.003;
  std::uint64_t seed = 1;
  app.add_option("--points", sizes, "Sizes of clouds")->capture_default_str();
  app.add_option("--motions", num_motions, "Random motions of 0.35 rad a joint")->capture_default_str();
  app.add_option("--judge", judged, "Motions that FCL samples, ball by ball")->capture_default_str();
  app.add_option("--radius", radius, "Of the points, m; the cells' edges are twice as long")->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const std::filesystem::path data = planning_data::sharedData();
  if (data.empty()) {
    fmt::print("bench_points skipped: FCL_ARTIC_DATA does not name a folder with robots/ and problems/\n");
    return 0;
  }
  const Robot robot = planning_data::readRobot(data, "panda");

  int faults = 0;
  for (const std::size_t size : sizes) {
    Random random(seed);
    const auto cloud = std::make_shared<PointCloud>(scan(size, radius, random), radius);
    const World points(robot, cloud);
    std::vector<JointMotion> motions;
    CertifiedResult start;
    while (motions.size() < num_motions) {
      Eigen::VectorXd q0(robot.tree->dof()), q1(robot.tree->dof());
      for (int v = 0; v < robot.tree->dof(); ++v) {
        const Joint& joint = robot.tree->joint(robot.tree->variableJoint(v));
        q0[v] = random.uniform(joint.lower, joint.upper);
        q1[v] = std::clamp(q0[v] + random.uniform(-0.35, 0.35), joint.lower, joint.upper);
      }
      points.manager.continuousCollide(JointMotion::linear(*robot.tree, q0, q0), CertifiedRequest(), start);
      if (start.isFree()) motions.push_back(JointMotion::linear(*robot.tree, q0, q1));
    }
    std::vector<CertifiedResult> answers, of_cells;
    measure("points", size, points, motions, answers);
    {
      const World cells(robot, cellsOf(cloud->points(), 2 * radius));
      measure("OcTree", size, cells, motions, of_cells);
    }
    if (judged == 0) continue;
    motions.erase(motions.begin() + static_cast<std::ptrdiff_t>(std::min(judged, motions.size())), motions.end());
    int touched = 0;
    faults += judge(robot, *cloud, motions, answers, touched);
    fmt::print("{:>8} {} of {} motions touched a ball at FCL's samples; missed or late: {}\n", size, touched,
               motions.size(), faults);
  }
  return faults ? 1 : 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "bench_points: {}\n", e.what());
  return 2;
}
