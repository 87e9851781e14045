// SPDX-License-Identifier: BSD-3-Clause
// Reads the installed robot and scene through the component urdf: exit status 0 when the answer is right.
#include <exception>
#include <iostream>
#include <string>

#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

int main(int, char** argv) try {
  using namespace fcl_artic;
  const std::string data = argv[1];
  const Robot robot = loadUrdf(data + "/puma560/puma560.urdf");
  const Scene scene = loadScene(data + "/pipes.obj");
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  scene.addTo(manager);
  manager.setup();

  Eigen::VectorXd q0(6), q1(6);
  q0 << -2.1, 1, -1, -0.1, -0.1, 0;
  q1 << 0.9, 0.4, -2, 0, 0.2, 0;
  CertifiedResult result;
  manager.continuousCollide(JointMotion::linear(*robot.tree, q0, q1), CertifiedRequest(), result);
  std::cout << (result.isFree() ? "free" : "not free") << '\n';
  return result.isFree() ? 0 : 1;
} catch (const std::exception& e) {
  std::cerr << e.what() << '\n';
  return 2;
}
