// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

int main() {
  using namespace fcl_artic;
  Robot robot = loadUrdf("data/puma560/puma560.urdf");
  // robot.allowed = loadSrdf("my.srdf", *robot.tree);  // pairs of links that are not checked
  const Scene scene = loadScene("data/pipes.obj");

  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  scene.addTo(manager);  // as obstacles
  manager.setup();

  Eigen::VectorXd q0(6), q1(6);  // rad, in the order of robot.tree->variableName(v)
  q0 << -2.1, 1.0, -1.0, -0.1, -0.1, 0.0;
  q1 << -0.1, 0.3, -2.3, -1.0, 1.1, 0.0;
  const CertifiedResult result = manager.continuousCollide(q0, q1);  // the straight line in joint space
  std::cout << result << '\n';  // "contact within [0.43395303..., 0.43395303...], proven", or "free: proven"
  if (const CertifiedContact* c = result.first()) std::cout << *c << '\n';  // who, when, where
}
