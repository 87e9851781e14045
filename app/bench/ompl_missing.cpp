// SPDX-License-Identifier: BSD-3-Clause
// What stands in for the benchmarks that need OMPL, in builds without it.
#include <stdexcept>

#include "bench/certify_bench.h"
#include "bench/planning_bench.h"
#include "bench/rigid_bench.h"

namespace fcl_artic::app {

int benchPlanning(PlanningBenchOptions&) {
  throw std::runtime_error("bench planning: this program was built without OMPL (component ompl)");
}

int benchCertify(CertifyBenchOptions&) {
  throw std::runtime_error("bench certify: this program was built without OMPL (component ompl)");
}

int benchRigid(RigidBenchOptions&) {
  throw std::runtime_error("bench rigid: this program was built without OMPL (component ompl)");
}

}  // namespace fcl_artic::app
