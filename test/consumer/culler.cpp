// SPDX-License-Identifier: BSD-3-Clause
// The component visibility: an executor there is, whatever drivers this machine has.
#include <cstdio>

#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/visibility/offscreen.h>

int main() {
  const auto culler = fcl_artic::makeOffscreenCuller(fcl_artic::OffscreenBackend::egl);
  std::printf("executor %s %s\n", culler->executor().c_str(), culler->fallbackReason().c_str());
  return culler->executor() == "egl" || (culler->executor() == "cpu" && !culler->fallbackReason().empty()) ? 0 : 1;
}
