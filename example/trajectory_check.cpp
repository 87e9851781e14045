// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <string>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

// The contents of MoveIt's trajectory messages: names of joints, and points with positions, velocities and a time.
struct Point {
  std::vector<double> positions, velocities;  // rad, rad/s
  double time_from_start;                     // s
};

int main() {
  using namespace fcl_artic;
  const std::vector<std::string> joint_names = {"joint3", "joint2", "joint1", "joint4", "joint5", "joint6"};
  const std::vector<Point> points = {{{-1.0, 1.0, -2.1, -0.1, -0.1, 0.0}, {0, 0, 0, 0, 0, 0}, 0.0},
                                     {{-1.4, 0.8, -0.7, -0.05, 0.0, 0.0}, {-0.4, -0.2, 1.2, 0, 0.1, 0}, 1.5},
                                     {{-2.0, 0.4, 0.9, 0.0, 0.2, 0.0}, {0, 0, 0, 0, 0, 0}, 3.0}};
  const Robot robot = loadUrdf("data/puma560/puma560.urdf");
  const Scene scene = combineScenes({loadScene("data/pipes.obj")}, *robot.tree);
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  scene.addTo(manager);
  manager.setup();

  std::vector<double> times;
  std::vector<Eigen::VectorXd> positions, velocities;
  for (const Point& point : points) {
    times.push_back(point.time_from_start);
    positions.push_back(robot.tree->neutralConfiguration());
    velocities.push_back(Eigen::VectorXd::Zero(robot.tree->dof()));
    for (std::size_t j = 0; j < joint_names.size(); ++j) {
      const int variable = robot.tree->jointVariable(robot.tree->jointId(joint_names[j]));
      positions.back()[variable] = point.positions[j];
      velocities.back()[variable] = point.velocities[j];
    }
  }
  const auto trajectory = JointTrajectory::cubic(*robot.tree, times, positions, velocities);

  const auto check = [&](const std::string& what) {
    CertifiedResult result;
    manager.continuousCollide(trajectory, CertifiedRequest(), result);
    if (result.isFree()) {
      ClearanceRequest scene_only;
      scene_only.check_self = false;  // links that are near by construction
      const Clearance clearance = manager.clearance(trajectory, scene_only);
      std::cout << what << ": proven free, never nearer than " << clearance.lower << " m to the scene\n";
      return;
    }
    const CertifiedContact& contact = result.contacts.front();
    std::cout << what << ": " << contact.body1.name << " meets " << contact.body2.name << " at " << result.t_lower
              << " s\n";
  };
  check("empty-handed");

  // The same with a bar in the hand.
  fcl::CollisionObjectd bar(std::make_shared<fcl::Boxd>(0.02, 0.02, 0.5));
  manager.registerObject(&bar, "bar");
  manager.attach("flange", &bar, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.27)), {"wrist_bend"});
  manager.setup();
  check("with a bar");
}
