// SPDX-License-Identifier: BSD-3-Clause
// Stands in for --mend in builds without OMPL.
#include <stdexcept>

#include "mend.h"

namespace fcl_artic::app {

void requireMending() {
  throw std::runtime_error(
      "--mend: this program was built without OMPL, which finds the detours; install it (Debian: libompl-dev) and "
      "build again");
}

Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>&, const plans::PlanMotion&, plans::Turns,
            const MendOptions&) {
  requireMending();
  return {};
}

}  // namespace fcl_artic::app
