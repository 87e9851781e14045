// SPDX-License-Identifier: BSD-3-Clause
#include "visibility_options.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace fcl_artic::app {

void addVisibilityOptions(CLI::App& verb, VisibilityChoice& o) {
  verb.add_option_function<std::string>(
          "--visibility",
          [&o](const std::string& mode) { o.mode = mode == "on" ? VisibilityMode::on : VisibilityMode::off; },
          "Stage 2, culling by visibility: off or on. Answers are the same")
      ->check(CLI::IsMember({"off", "on"}))
      ->default_str("off")
      ->group("Stage 2");
  verb.add_option("--executor", o.executor, "Who does stage 2: cpu, or OpenGL without a window by osmesa or egl")
      ->check(CLI::IsMember({"cpu", "osmesa", "egl"}))
      ->capture_default_str()
      ->group("Stage 2");
}

const std::vector<std::string>& executorNames() {
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  static const std::vector<std::string> kNames{"cpu", "osmesa", "egl"};
#else
  static const std::vector<std::string> kNames{"cpu"};
#endif
  return kNames;
}

std::shared_ptr<const VisibilityCuller> makeCuller(const std::string& executor) {
  if (executor == "cpu") return std::make_shared<const VisibilityCuller>();
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  if (executor == "osmesa") return makeOffscreenCuller(OffscreenBackend::osmesa);
  if (executor == "egl") return makeOffscreenCuller(OffscreenBackend::egl);
#endif
  throw std::invalid_argument(fmt::format("--executor {}: this program was built without it; it has {}", executor,
                                          fmt::join(executorNames(), ", ")));
}

void useVisibility(const VisibilityChoice& options, ArticulatedCollisionManager& manager) {
  const auto culler = makeCuller(options.executor);
  if (options.mode == VisibilityMode::off) return;
  (void)culler->executor();
  manager.setVisibility(culler);
}

}  // namespace fcl_artic::app
