// SPDX-License-Identifier: BSD-3-Clause
//
// The extension module fcl_artic._fcl_artic. One file per topic; the package fcl_artic shows its names.
#include <pybind11/pybind11.h>

#include "docstrings.h"
#include "geometry.h"
#include "kinematics.h"
#include "motion.h"
#include "options.h"
#include "result.h"
#include "robot.h"
#include "scene.h"
#include "world.h"

PYBIND11_MODULE(_fcl_artic, module) {
  using namespace fcl_artic::python;
  module.doc() = "Certified continuous collision detection for articulated robots: what fcl_artic is made of.";
  module.attr("__version__") = FCL_ARTIC_VERSION;
  bindRequest(module);
  bindKinematics(module);
  bindGeometry(module);
  bindResults(module);
  bindLinkPairs(module);
  bindRobot(module);
  bindScene(module);
  bindRigid(module);
  bindWorld(module);
  documentProperties(module);
}
