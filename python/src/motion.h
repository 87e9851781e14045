// SPDX-License-Identifier: BSD-3-Clause
//
// Motions of rigid bodies in Python: FCL's kinds, a link's, and those of one's own.
#pragma once

#include <functional>
#include <memory>

#include <fcl/math/motion/motion_base.h>

#include "array.h"
#include "recipe.h"

namespace fcl_artic::python {

/// A motion as Python holds it; it is not changed once it is made. Its functions belong to the recipe: keep the recipe
/// as long as `motion` or `pose`.
struct Motion {
  const char* kind = "";
  std::shared_ptr<const fcl::MotionBased> motion;
  /// The pose at t, with the GIL held: of a twin, as FCL's motions keep the last pose in themselves.
  std::function<Eigen::Isometry3d(double t)> pose;
  Recipe recipe;

  /// For Python's garbage collector.
  int visit(visitproc visit, void* arg) const { return recipe.visit(visit, arg); }
};

/// A motion, or a pose to stand still at. @throws py::type_error naming `what`.
Motion motionOf(py::handle value, const char* what);

void bindRigid(py::module_& module);

}  // namespace fcl_artic::python
