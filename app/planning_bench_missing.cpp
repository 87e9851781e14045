// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "planning_bench.h"

namespace fcl_artic::app {

int benchPlanning(const PlanningBenchOptions&) {
  throw std::runtime_error("bench planning: this program was built without OMPL (component ompl)");
}

}  // namespace fcl_artic::app
