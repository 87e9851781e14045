// SPDX-License-Identifier: BSD-3-Clause
//
// A guard at a controller's rate: a Panda in a cell of boxes and a CAD mesh, two persons as capsules, and a cloud of a
// depth camera that another thread renews. FCL_ARTIC_DATA names the folder with robots/. The guard is asked for every
// period of trajectories that it lets run. Printed are its times, its tests, and the cost of a frame.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "clouds.h"
#include "fcl_artic/guard.h"
#include "fcl_artic/point_cloud.h"
#include "planning/problems.h"
#include "random.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Clock = std::chrono::steady_clock;

namespace {

struct Options {
  int answers = 10000, points = 307200;
  double rate = 250, frames = 30, voxel = 0.02, tolerance = 0.3, speed = 1;
  std::string mesh = "data/pipes.obj";
  bool persons = true, self = true;
};

double usSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

/// Of the processor on this thread: it does not count while others run.
double processorUs() {
  timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

std::shared_ptr<fcl::CollisionObjectd> object(const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
                                              const Vector3d& at) {
  return std::make_shared<fcl::CollisionObjectd>(geometry, Isometry3d(Translation3d(at)));
}

/// Times in order, and what they are at a share of them.
struct Times {
  std::vector<double> us;
  void sort() { std::sort(us.begin(), us.end()); }
  double at(double share) const {
    return us.empty() ? 0
                      : us[std::min(us.size() - 1, static_cast<std::size_t>(share * static_cast<double>(us.size())))];
  }
  std::string text() const {
    return fmt::format("median {:.0f}, 99 % {:.0f}, 99.9 % {:.0f}, worst {:.0f} us", at(0.5), at(0.99), at(0.999),
                       us.empty() ? 0 : us.back());
  }
};

JointTrajectory randomWay(const Robot& robot, const VectorXd& from, const Options& o, Random& random) {
  const KinematicTree& tree = *robot.tree;
  std::vector<VectorXd> waypoints{from}, still{VectorXd::Zero(tree.dof())};
  std::vector<double> times{0};
  for (int k = 0; k < 4; ++k) {
    VectorXd next = waypoints.back();
    for (int v = 0; v < std::min<int>(7, tree.dof()); ++v) {
      const Joint& joint = tree.joint(tree.variableJoint(v));
      next[v] = std::min(joint.upper - 0.1, std::max(joint.lower + 0.1, next[v] + 1.2 * (random.uniform() - 0.5)));
    }
    waypoints.push_back(next);
    still.push_back(still[0]);
    times.push_back(times.back() + 1 / o.speed);
  }
  return JointTrajectory::quintic(tree, times, waypoints, still, still);
}

void run(const Options& o) {
  const std::filesystem::path data = planning_data::sharedData();
  if (data.empty()) {
    std::cout << "bench_guard skipped: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return;
  }
  const Robot robot = planning_data::readRobot(data, "panda");
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  Scene pipes = loadScene(o.mesh);
  pipes.addTo(manager);
  manager.registerObject(object(std::make_shared<fcl::Boxd>(0.1, 3, 2), {-0.9, 0, 1}), "fence");
  manager.registerObject(object(std::make_shared<fcl::Boxd>(3, 0.1, 2), {0, 1.5, 1}), "side");
  Random random(1);
  const auto cloudOf = [&](std::vector<Vector3d> points) {
    return PointCloud(std::move(points), 0.005).thinned(o.voxel);
  };
  manager.registerObject(object(cloudOf(frameOf(o.points, random)), Vector3d::Zero()), "camera");
  const auto person = std::make_shared<fcl::Capsuled>(0.25, 1.2);
  const auto seenAt = [&](int who, double now) {
    const double angle = (who ? -0.4 : 0.3) * now + 2 * who, far = 1.7 + 0.5 * std::sin(0.7 * now + who);
    return object(person, {far * std::cos(angle), far * std::sin(angle), 0.85});
  };
  for (int who = 0; o.persons && who < 2; ++who) {
    manager.registerObject(seenAt(who, 0), fmt::format("person{}", who));
    manager.setObjectTolerance(fmt::format("person{}", who), {0.05, 0, Vector3d::Zero()});
    manager.setObjectSpeed(fmt::format("person{}", who), {1.6, 0});
  }
  if (o.tolerance > 0) manager.setJointTolerances({o.tolerance * 3.14159265358979 / 180, 0});
  LiveScene live(std::move(manager), 0);

  GuardOptions options;
  options.deceleration = VectorXd::Constant(robot.tree->dof(), 10);
  options.period = 1 / o.rate;
  options.most_age = 1;
  options.check_self = o.self;
  Guard guard(robot.tree, options);
  VectorXd q = robot.tree->neutralConfiguration();
  const double ready[] = {0, -0.785, 0, -2.356, 0, 1.571, 0.785};
  for (int v = 0; v < 7; ++v) q[v] = ready[v];

  std::mutex place;
  VectorXd robot_at = q;
  std::atomic<bool> go_on{true};
  const Clock::time_point start = Clock::now();
  const auto clock = [&] { return 1e-6 * usSince(start); };
  Times thin, self, swap;
  std::size_t in_cloud = 0;
  std::thread camera([&] {
    Random own(2);
    std::vector<std::vector<Vector3d>> frames;
    for (int i = 0; i < 4; ++i) frames.push_back(frameOf(o.points, own));
    for (int frame = 0; go_on; ++frame) {
      const double seen_at = clock();
      VectorXd here;
      {
        const std::lock_guard<std::mutex> lock(place);
        here = robot_at;
      }
      Clock::time_point begin = Clock::now();
      const auto cloud = cloudOf(frames[static_cast<std::size_t>(frame % 4)]);
      thin.us.push_back(usSince(begin));
      begin = Clock::now();
      std::vector<Vector3d> left = cloud->points();
      live.latest()->manager.removeSelf(left, here, 0.02);
      self.us.push_back(usSince(begin));
      in_cloud = left.size();
      begin = Clock::now();
      live.renew(seen_at, [&](ArticulatedCollisionManager& scene) {
        scene.replaceObject("camera", object(std::make_shared<PointCloud>(left, 0.02), Vector3d::Zero()));
        for (int who = 0; o.persons && who < 2; ++who) {
          scene.replaceObject(fmt::format("person{}", who), seenAt(who, seen_at));
        }
      });
      swap.us.push_back(usSince(begin));
      std::this_thread::sleep_until(start + std::chrono::microseconds(static_cast<long>(1e6 * (frame + 1) / o.frames)));
    }
  });

  Times ask, worked, full, refused;
  std::vector<double> tests;
  std::size_t slow = 0, stop = 0;
  GuardAnswer answer;
  double path_time = 0, speed = 0;
  JointTrajectory way = randomWay(robot, q, o, random);
  guard.follow(way);
  for (int n = 0; n < o.answers; ++n) {
    std::this_thread::sleep_until(start + std::chrono::microseconds(static_cast<long>(1e6 * n / o.rate)));
    const auto scene = live.latest();
    const double now = std::max(clock(), scene->seen_at);
    const Clock::time_point begin = Clock::now();
    const double work_before = processorUs();
    guard.ask(*scene, now, path_time, speed, answer);
    const double us = usSince(begin), work = processorUs() - work_before;
    if (n >= 100) {  // the first ones get their memory
      ask.us.push_back(us);
      worked.us.push_back(work);
      (answer.speed == 1 ? full : refused).us.push_back(us);
      tests.push_back(static_cast<double>(answer.tests));
    }
    slow += answer.speed > 0 && answer.speed < 1;
    stop += answer.speed == 0;
    speed = speed > answer.speed ? std::max(answer.speed, speed - answer.braking / o.rate) : answer.speed;
    path_time += speed / o.rate;
    {
      const std::lock_guard<std::mutex> lock(place);
      robot_at = way.configuration(path_time);
    }
    if (path_time >= way.endTime() || (speed == 0 && n % 100 == 0)) {  // there, or it waits too long: another way
      way = randomWay(robot, way.configuration(path_time), o, random);
      guard.follow(way);
      path_time = speed = 0;
    }
  }
  go_on = false;
  camera.join();
  for (Times* times : {&ask, &worked, &full, &refused, &thin, &self, &swap}) times->sort();
  std::sort(tests.begin(), tests.end());
  std::cout << fmt::format("{} answers, {} slow, {} stop; {} points of {} in the last cloud\n", o.answers, slow, stop,
                           in_cloud, o.points);
  std::cout << "answer:     " << ask.text()
            << fmt::format("; {} tests at most, median {}\n", tests.back(), tests[tests.size() / 2]);
  std::cout << "  processor " << worked.text() << "\n";
  std::cout << "full speed: " << full.text() << "\nslow, stop: " << refused.text() << "\n";
  std::cout << "a frame:    thinned " << thin.text() << "\n            robot removed " << self.text()
            << "\n            set up and swapped " << swap.text() << "\n";
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("A guard's answers beside a camera (FCL_ARTIC_DATA names the data)");
  Options o;
  app.add_option("--answers", o.answers, "how many")->check(CLI::Range(200, 1000000000))->capture_default_str();
  app.add_option("--points", o.points, "of a frame")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--rate", o.rate, "answers per second of the trajectory")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--frames", o.frames, "per second")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--voxel", o.voxel, "m, of thinning")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--tolerance", o.tolerance, "deg, of all joints")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--speed", o.speed, "of the trajectories; 1: about 0.6 rad/s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--mesh", o.mesh, "of the cell")->capture_default_str();
  app.add_flag("!--no-persons", o.persons, "without persons");
  app.add_flag("!--no-self", o.self, "without pairs of two links");
  CLI11_PARSE(app, argc, argv);
  run(o);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "bench_guard: " << error.what() << "\n";
  return 2;
}
