// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iomanip>
#include <iostream>

#include <fcl/geometry/shape/capsule.h>
#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

// Where a sensor has recorded a person: he walks in, stays for a while and leaves.
static Eigen::Vector3d recorded(double t) {
  const double way = 1.2 * std::clamp(std::min(t - 0.5, 5.5 - t), 0.0, 1.35);  // m
  return {2.6 - way, 0.3, 0.9};
}

// A controller's loop at 250 Hz, in simulated time. Frames of the sensor come at 30 Hz, 12 ms after they were taken.
int main() {
  using namespace fcl_artic;
  constexpr double kPeriod = 0.004, kFrame = 1.0 / 30, kLatency = 0.012;  // s
  const Robot robot = loadUrdf("data/puma560/puma560.urdf");
  Eigen::VectorXd q0(6), q1(6);
  q0 << -2.1, 0.3, -1.0, -0.1, -0.1, 0.0;
  q1 << 0.9, 0.2, -1.2, 0.0, 0.2, 0.0;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(6);
  const auto trajectory = JointTrajectory::cubic(*robot.tree, {0, 3, 6}, {q0, q1, q0}, {rest, rest, rest});

  ArticulatedCollisionManager cell(robot.tree);
  robot.addTo(cell);
  const auto body = std::make_shared<fcl::Capsuled>(0.3, 1.2);
  const auto personAt = [&](double t) {
    return std::make_shared<fcl::CollisionObjectd>(body, Eigen::Isometry3d(Eigen::Translation3d(recorded(t))));
  };
  cell.registerObject(personAt(0), "person");
  cell.setObjectSpeed("person", {1.6, 0});                                // m/s
  cell.setObjectTolerance("person", {0.03, 0, Eigen::Vector3d::Zero()});  // m: the sensor's error
  cell.setJointTolerances({0.005, 0});                                    // rad: the drives' error
  LiveScene scene(std::move(cell), 0);

  GuardOptions options;
  options.deceleration = Eigen::VectorXd::Constant(6, 8);  // rad/s²
  options.period = kPeriod;
  Guard guard(robot.tree, options);
  guard.follow(trajectory);

  double path_time = 0, speed = 0, seen_at = 0;
  GuardAnswer answer;
  for (int tick = 0; path_time < trajectory.endTime() - 1e-6; ++tick) {
    const double now = tick * kPeriod;
    if (now >= seen_at + kFrame + kLatency) {  // on the sensor's thread
      seen_at += kFrame;
      scene.renew(seen_at, [&](ArticulatedCollisionManager& cell) { cell.replaceObject("person", personAt(seen_at)); });
    }
    // [cycle]
    guard.ask(*scene.latest(), now, path_time, speed, answer);
    const double change = answer.braking * kPeriod, before = speed;
    speed = std::clamp(answer.speed, speed - change, speed + change);
    path_time += kPeriod * (before + speed) / 2;
    // [cycle ends]
    if (tick % 125 == 0) {
      std::cout << now << " s: speed " << std::setprecision(2) << speed << std::setprecision(6);
      if (answer.reason == GuardReason::near) std::cout << ", " << answer.body1.name << " and " << answer.body2.name;
      std::cout << '\n';
    }
  }
  std::cout << "at its goal\n";
}
