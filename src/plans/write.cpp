// SPDX-License-Identifier: BSD-3-Clause
#include "plans/write.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "plans/document.h"

namespace fcl_artic::plans {
namespace {

std::string csvOf(const Plan& plan) {
  std::string out = plan.times.empty() ? "" : "time";
  const auto addNames = [&](const Plan::Rows& rows, const char* ending) {
    if (rows.empty()) return;
    for (const std::string& joint : plan.joints) out += fmt::format("{}{}{}", out.empty() ? "" : ",", joint, ending);
    for (const auto& [joint, value] : plan.state) out += fmt::format(",{}{}", joint, ending);
  };
  addNames(plan.positions, "");
  addNames(plan.velocities, "/velocity");
  addNames(plan.accelerations, "/acceleration");
  out += '\n';
  for (std::size_t k = 0; k < plan.positions.size(); ++k) {
    std::string line = plan.times.empty() ? "" : fmt::format("{}", plan.times[k]);
    for (const Plan::Rows* rows : {&plan.positions, &plan.velocities, &plan.accelerations}) {
      if (rows->empty()) continue;
      for (const double value : (*rows)[k]) line += fmt::format("{}{}", line.empty() ? "" : ",", value);
      for (const auto& [joint, value] : plan.state) line += fmt::format(",{}", rows == &plan.positions ? value : 0);
    }
    out += line + '\n';
  }
  return out;
}

std::string matrixOf(const Plan& plan) {
  std::string out;
  for (const std::vector<double>& row : plan.positions) {
    for (const double value : row) out += fmt::format("{} ", value);
    out += '\n';
  }
  return out;
}

/// {sec, nanosec}: to the nearest nanosecond, as messages have it.
Json durationOf(double seconds) {
  const double whole = std::floor(seconds);
  const double nanoseconds = std::round((seconds - whole) * 1e9);
  if (nanoseconds >= 1e9) return {{"sec", static_cast<std::int64_t>(whole) + 1}, {"nanosec", 0}};
  return {{"sec", static_cast<std::int64_t>(whole)}, {"nanosec", static_cast<std::int64_t>(nanoseconds)}};
}

Json documentOf(const Plan& plan) {
  Json out = Json::object();
  if (!plan.name.empty()) out["name"] = plan.name;
  if (!plan.state.empty()) out["state"] = plan.state;
  if (plan.times.empty()) {
    out["joints"] = plan.joints;
    out["waypoints"] = plan.positions;
    return out;
  }
  Json points = Json::array();
  for (std::size_t k = 0; k < plan.positions.size(); ++k) {
    Json point = {{"positions", plan.positions[k]}};
    if (!plan.velocities.empty()) point["velocities"] = plan.velocities[k];
    if (!plan.accelerations.empty()) point["accelerations"] = plan.accelerations[k];
    point["time_from_start"] = durationOf(plan.times[k]);
    points.push_back(std::move(point));
  }
  out["joint_trajectory"] = {{"joint_names", plan.joints}, {"points", std::move(points)}};
  return out;
}

}  // namespace

std::string writePlans(const std::vector<Plan>& plans, Format format) {
  for (const Plan& plan : plans) {
    if (plan.joints.empty()) throw std::invalid_argument("a plan without names of its joints is not written");
  }
  const bool single = format == Format::csv || format == Format::ompl;
  if (single && plans.size() != 1) {
    throw std::invalid_argument(
        fmt::format("{} plans, where the format holds one: .json and .jsonl hold many", plans.size()));
  }
  switch (format) {
    case Format::csv:
      return csvOf(plans[0]);
    case Format::ompl:
      return matrixOf(plans[0]);
    case Format::jsonl: {
      std::string out;
      for (const Plan& plan : plans) out += documentOf(plan).dump() + "\n";
      return out;
    }
    case Format::json:
    case Format::yaml: {
      Json all = Json::array();
      for (const Plan& plan : plans) all.push_back(documentOf(plan));
      return (plans.size() == 1 ? all[0] : all).dump(1) + "\n";
    }
    case Format::numpy:
      break;
  }
  throw std::invalid_argument("NumPy's format is not written: .json and .csv are");
}

}  // namespace fcl_artic::plans
