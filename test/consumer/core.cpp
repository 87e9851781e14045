// SPDX-License-Identifier: BSD-3-Clause
// A bar on a slide that meets a box, with nothing but the installed core library: exit status 0 when the answer is
// right.
#include <cmath>
#include <iostream>
#include <memory>

#include <fcl/geometry/shape/box.h>
#include <fcl_artic/fcl_artic.h>

int main() {
  using namespace fcl_artic;
  auto tree = std::make_shared<KinematicTree>("slide");
  tree->addLink("rail");
  tree->addLink("bar");
  Joint slide;
  slide.name = "slide";
  slide.type = JointType::prismatic;
  slide.parent = "rail";
  slide.child = "bar";
  tree->addJoint(slide);

  const auto cube = std::make_shared<fcl::Boxd>(1, 1, 1);
  fcl::CollisionObjectd bar(cube), obstacle(cube, fcl::Transform3d(Eigen::Translation3d(3, 0, 0)));
  ArticulatedCollisionManager manager(tree);
  manager.bind("bar", &bar);
  manager.registerObject(&obstacle, "obstacle");
  manager.setup();

  const auto go = [&](double from, double to) {
    CertifiedResult result;
    manager.continuousCollide(
        JointMotion::linear(*tree, Eigen::VectorXd::Constant(1, from), Eigen::VectorXd::Constant(1, to)),
        CertifiedRequest(), result);
    return result;
  };
  // Faces meet at a way of 2 of 4.
  const CertifiedResult hit = go(0, 4);
  const bool right = hit.status == Status::contact && hit.t_lower <= 0.5 && hit.t_lower > 0.499 && go(0, 1.5).isFree();
  std::cout << (right ? "right" : "wrong") << ": contact from t = " << hit.t_lower << '\n';
  return right ? 0 : 1;
}
