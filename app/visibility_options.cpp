// SPDX-License-Identifier: BSD-3-Clause
#include "visibility_options.h"

#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::pair<std::string, VisibilityMode>>& modes() {
  static const std::vector<std::pair<std::string, VisibilityMode>> kModes{{"off", VisibilityMode::off},
                                                                          {"on", VisibilityMode::on},
                                                                          {"automatic", VisibilityMode::automatic},
                                                                          {"at-once", VisibilityMode::atOnce}};
  return kModes;
}

}  // namespace

void addVisibilityOptions(CLI::App& verb, VisibilityChoice& o) {
  std::vector<std::string> names;
  for (const auto& [name, mode] : modes()) names.push_back(name);
  verb.add_option_function<std::string>(
          "--visibility",
          [&o](const std::string& given) {
            for (const auto& [name, mode] : modes()) {
              if (name == given) o.mode = mode;
            }
          },
          "Stage 2, culling by visibility: off, on, automatic (when it saves time); at-once: what it proves is used "
          "for "
          "contacts too, whose last digits may then be others")
      ->check(CLI::IsMember(names))
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

std::string nameOf(VisibilityMode wanted) {
  for (const auto& [name, mode] : modes()) {
    if (mode == wanted) return name;
  }
  return {};
}

Json visibilityJson(VisibilityMode mode, const QueryStatistics& s) {
  if (mode == VisibilityMode::off) return {};
  Json out{{"mode", nameOf(mode)},
           {"used", !s.visibility_executor.empty()},
           {"executor", s.visibility_executor.empty() ? Json() : Json(s.visibility_executor)},
           {"fallback", s.visibility_fallback.empty() ? Json() : Json(s.visibility_fallback)}};
  VisibilityStatistics::forEachField([&](const char* name, auto field) { out[name] = s.visibility.*field; });
  return out;
}

std::string visibilityText(const QueryStatistics& s) {
  if (s.visibility_executor.empty()) return "not used";
  const VisibilityStatistics& v = s.visibility;
  return fmt::format(
      "executor {}: {} pairs seen, {} proven free, and {} nodes of others; {} pieces drawn, {} queries {}{}",
      s.visibility_executor, v.pairs, v.culled, v.nodes, v.pieces, v.repeated, "solved again",
      s.visibility_fallback.empty() ? "" : " (" + s.visibility_fallback + ")");
}

}  // namespace fcl_artic::app
