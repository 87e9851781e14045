// SPDX-License-Identifier: BSD-3-Clause
// What stands in for the parts of the program that need OMPL, in builds without it.
#include <stdexcept>

#include "certify_bench.h"
#include "mend.h"
#include "planning_bench.h"
#include "rigid_bench.h"

namespace fcl_artic::app {

int benchPlanning(const PlanningBenchOptions&) {
  throw std::runtime_error("bench planning: this program was built without OMPL (component ompl)");
}

int benchCertify(const CertifyBenchOptions&) {
  throw std::runtime_error("bench certify: this program was built without OMPL (component ompl)");
}

int benchRigid(const RigidBenchOptions&) {
  throw std::runtime_error("bench rigid: this program was built without OMPL (component ompl)");
}

void requireMending() {
  throw std::runtime_error(
      "--mend: this program was built without OMPL, which finds the detours; install it (Debian: libompl-dev) and "
      "build "
      "again");
}

Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>&, const plans::PlanMotion&, plans::Turns,
            const MendOptions&) {
  requireMending();
  return {};
}

}  // namespace fcl_artic::app
