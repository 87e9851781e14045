// SPDX-License-Identifier: BSD-3-Clause
#include "step_costs.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

namespace fcl_artic::app {

StepCosts measureSteps(const ArticulatedCollisionManager& manager, const std::vector<JointMotion>& motions,
                       CertifiedRequest request, int passes, bool contact, std::size_t& differ) {
  request.measure_times = true;
  const bool paper = request.method == Method::redon2004, stage2 = request.visibility != VisibilityMode::off;
  // The paper's method by itself, whatever it takes. (A budget would turn stage 2 off.)
  if (paper && !stage2 && request.work_budget == 0) request.work_budget = std::numeric_limits<std::uint64_t>::max();
  StepCosts sum;
  std::vector<double> totals;
  CertifiedResult result;
  for (const JointMotion& motion : motions) {
    QueryStatistics best;
    best.total_us = 1e300;
    for (int pass = 0; pass < passes; ++pass) {
      manager.continuousCollide(motion, request, result);
      if (result.statistics.total_us < best.total_us) best = result.statistics;
    }
    sum.undecided += result.status == Status::undecided;
    differ += result.status == (contact ? Status::free : Status::contact);
    const double sv = paper && stage2 ? best.redon.visibility_us : best.visibility.us;
    const double bvh = paper ? best.redon.culling_us : best.culling_us;
    sum.bvh += bvh;
    sum.sv += sv;
    sum.exact += best.total_us - bvh - sv;
    sum.total += best.total_us;
    sum.solving += best.redon.equations_us;
    totals.push_back(best.total_us);
    sum.sv_pairs += static_cast<double>(best.visibility.pairs);
    sum.sv_culled += static_cast<double>(best.visibility.culled);
    sum.box_tests += static_cast<double>(best.redon.box_tests);
    sum.leaf_pairs += static_cast<double>(best.redon.leaf_pairs);
    sum.equations += static_cast<double>(best.redon.equations);
    sum.intervals += static_cast<double>(best.redon.intervals);
    sum.evaluations += static_cast<double>(best.redon.evaluations);
    sum.steps += static_cast<double>(best.redon.steps_bounded);
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, motions.size()));
  for (double* x : {&sum.bvh, &sum.sv, &sum.exact, &sum.total, &sum.solving, &sum.sv_pairs, &sum.sv_culled,
                    &sum.box_tests, &sum.leaf_pairs, &sum.equations, &sum.intervals, &sum.evaluations, &sum.steps}) {
    *x /= n;
  }
  if (!stage2) sum.sv = -1;
  std::sort(totals.begin(), totals.end());
  const auto at = [&](double part) {
    return totals.empty() ? 0 : totals[static_cast<std::size_t>(part * static_cast<double>(totals.size() - 1))];
  };
  sum.median = at(0.5);
  sum.p95 = at(0.95);
  return sum;
}

namespace {

constexpr std::size_t kColumns = 80, kGap = 2;

std::size_t widthOf(const Table& table, std::size_t column) {
  std::size_t width = table.columns[column].title.size();
  for (const auto& row : table.rows) width = std::max(width, row[column].size());
  return width;
}

/// The first `names` columns, then those from `begin` to `end`.
std::string partOf(const Table& table, std::size_t names, std::size_t begin, std::size_t end) {
  std::string out;
  const auto add = [&](const auto& cellOf) {
    std::string line;
    for (std::size_t c = 0; c < end; c = c + 1 == names ? begin : c + 1) {
      const std::size_t width = widthOf(table, c);
      line += c < names ? fmt::format("{:<{}}", cellOf(c), width + (c + 1 < names ? kGap : 0))
                        : fmt::format("{:>{}}", cellOf(c), width + kGap);
    }
    out += line + '\n';
  };
  add([&](std::size_t c) { return table.columns[c].title; });
  for (const auto& row : table.rows) {
    const auto first = row.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = row.begin() + static_cast<std::ptrdiff_t>(end);
    if (std::all_of(first, last, [](const std::string& cell) { return cell.empty(); })) continue;
    add([&](std::size_t c) { return row[c].empty() ? std::string("-") : row[c]; });
  }
  return out;
}

}  // namespace

std::string fourDigits(double x) {
  return fmt::format("{:.{}f}", x, x < 10 ? 4 : x < 100 ? 2 : x < 1000 ? 1 : 0);
}

std::string textOf(const Table& table, std::size_t names) {
  std::size_t before = 0;
  for (std::size_t c = 0; c < names; ++c) before += widthOf(table, c) + (c + 1 < names ? kGap : 0);
  std::string out;
  for (std::size_t begin = names; begin < table.columns.size();) {
    std::size_t end = begin, width = before;
    do {
      width += widthOf(table, end) + kGap;
    } while (++end < table.columns.size() && width + widthOf(table, end) + kGap <= kColumns);
    if (begin > names) out += '\n';
    out += partOf(table, names, begin, end);
    begin = end;
  }
  return out;
}

std::string csvOf(const Table& table) {
  std::string out;
  const auto add = [&](std::size_t c, const std::string& cell) {
    out += cell;
    out += c + 1 < table.columns.size() ? ',' : '\n';
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c) add(c, table.columns[c].key);
  for (const auto& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) add(c, row[c]);
  }
  return out;
}

}  // namespace fcl_artic::app
