// SPDX-License-Identifier: BSD-3-Clause
//
// The extension module fcl_artic._fcl_artic. One file per topic; the package fcl_artic shows its names.
#include <pybind11/pybind11.h>

#include "docstrings.h"
#include "fcl_artic/instruction_set.h"
#include "functions.h"
#include "geometry.h"
#include "kinematics.h"
#include "motion.h"
#include "options.h"
#include "result.h"
#include "robot.h"
#include "scene.h"
#include "turns.h"
#include "world.h"

PYBIND11_MODULE(_fcl_artic, module) {
  using namespace fcl_artic::python;
  module.doc() = "Certified continuous collision detection for articulated robots: what fcl_artic is made of.";
  module.attr("__version__") = FCL_ARTIC_VERSION;
  module.def("instruction_set", &fcl_artic::instructionSet,
             "The instructions that queries are answered with: 'avx512', 'avx2', 'sse2', 'neon' or 'portable'. The\n"
             "environment variable FCL_ARTIC_ISA asks for another of them, before the first query.");
  watchForks();
  watchEnd();
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
  completeFunctions(module);
}
