// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl_artic/continuous_manager.h>

// A row of crates falls to the floor while a ball rolls along below them: which two meet first, and when?
int main() {
  const auto at = [](double x, double y, double z) { return fcl::Transform3d(Eigen::Translation3d(x, y, z)); };
  std::vector<std::unique_ptr<fcl::ContinuousCollisionObjectd>> objects;
  const auto add = [&](auto geometry, const fcl::Transform3d& from, const fcl::Transform3d& to) {
    objects.push_back(std::make_unique<fcl::ContinuousCollisionObjectd>(
        geometry, std::make_shared<fcl::TranslationMotiond>(from, to)));
  };
  add(std::make_shared<fcl::Halfspaced>(Eigen::Vector3d::UnitZ(), 0), at(0, 0, 0), at(0, 0, 0));
  add(std::make_shared<fcl::Sphered>(0.25), at(-5, 0, 0.3), at(5, 0, 0.3));
  const auto crate = std::make_shared<fcl::Boxd>(0.5, 0.5, 0.5);
  for (int i = -3; i <= 3; ++i) add(crate, at(i, 0, 2 + 0.3 * i), at(i, 0, 0.2 + 0.3 * i));

  fcl_artic::ContinuousCollisionManager manager;
  for (const auto& object : objects) manager.registerObject(object.get());
  manager.setup();
  fcl_artic::CertifiedPairsResult result;
  manager.continuousCollide(fcl_artic::CertifiedRequest(), result);

  if (result.isFree()) {
    std::cout << "proven free\n";
  } else {
    const fcl_artic::MovingPair& pair = result.pairs.front();
    const fcl_artic::CertifiedContact& contact = pair.result.contacts.front();
    const bool ball = pair.object1 == objects[1].get();
    std::cout << (ball ? "the ball" : "the floor") << " meets a crate at t = " << result.t_lower
              << ", x = " << contact.point.transpose() << "; proven free before\n";
  }
}
