// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

int main() {
  using namespace fcl_artic;
  const Robot robot = loadUrdf("data/puma560/puma560.urdf");  // with an SRDF: see below
  const Scene scene = loadScene("data/pipes.obj");

  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);  // links, and the pairs of them that may touch
  scene.addTo(manager);  // obstacles
  manager.setup();

  Eigen::VectorXd q0(6), q1(6);  // rad, in the order of robot.tree->variableName(v)
  q0 << -2.1, 1.0, -1.0, -0.1, -0.1, 0.0;
  q1 << -0.1, 0.3, -2.3, -1.0, 1.1, 0.0;
  const CertifiedResult result = manager.continuousCollide(q0, q1);

  std::cout << result << '\n';  // "free: proven", or "contact within [t_lower, t_upper], proven"
  if (const CertifiedContact* c = result.first()) std::cout << *c << '\n';  // who, when, where
}
