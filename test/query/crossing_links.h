// SPDX-License-Identifier: BSD-3-Clause
//
// Two links that are meshes: one on the base, the other on two sliders along x, as links with one joint between them
// are not checked.
#pragma once

#include <memory>
#include <utility>

#include "arms.h"
#include "meshes.h"

namespace fcl_artic {
namespace test {

/// Links "still" and "moving", turned and put as `at` says.
struct CrossingLinks {
  fcl::CollisionObjectd still, moving;
  ArticulatedCollisionManager manager{sliderTree({"still", "between", "moving"})};
  Eigen::Isometry3d at;

  CrossingLinks(std::shared_ptr<Mesh> a, std::shared_ptr<Mesh> b, const Eigen::Isometry3d& at)
      : still(std::move(a)), moving(std::move(b)), at(at) {
    manager.bind("still", &still);
    manager.bind("moving", &moving, at);
    manager.setup();
  }
  /// @param from, to  way of "moving" along x, m.
  CertifiedResult run(double from, double to, ContactMode mode = ContactMode::any) const {
    CertifiedRequest request;
    request.mode = mode;
    return ask(manager, Eigen::VectorXd::Constant(2, 0.5 * from), Eigen::VectorXd::Constant(2, 0.5 * to), request);
  }
};

}  // namespace test
}  // namespace fcl_artic
