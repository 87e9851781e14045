// SPDX-License-Identifier: BSD-3-Clause
#include "stage2.h"

#include <fmt/format.h>

#include "text/counted.h"

namespace fcl_artic::app {

using Json = nlohmann::ordered_json;

Json visibilityJson(VisibilityMode mode, const QueryStatistics& s) {
  if (mode == VisibilityMode::off) return {};
  Json out{{"mode", "on"},
           {"used", !s.visibility_executor.empty()},
           {"executor", s.visibility_executor.empty() ? Json() : Json(s.visibility_executor)},
           {"fallback", s.visibility_fallback.empty() ? Json() : Json(s.visibility_fallback)}};
  VisibilityStatistics::forEachField([&](const char* name, auto field) { out[name] = s.visibility.*field; });
  return out;
}

std::string visibilityText(const QueryStatistics& s) {
  if (s.visibility_executor.empty()) return "not used";
  const VisibilityStatistics& v = s.visibility;
  return fmt::format("executor {}: {} seen, {} proven free, and {} of others; {} drawn, {} solved again{}",
                     s.visibility_executor, text::counted(v.pairs, "pair"), v.culled, text::counted(v.nodes, "node"),
                     text::counted(v.pieces, "piece"), text::counted(v.repeated, "query", "queries"),
                     s.visibility_fallback.empty() ? "" : " (" + s.visibility_fallback + ")");
}

}  // namespace fcl_artic::app
