// SPDX-License-Identifier: BSD-3-Clause
#include "tables.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "bench/bars.h"
#include "exit_status.h"
#include "files/files.h"
#include "outputs.h"
#include "pipe_steps.h"
#include "progress.h"
#include "step_costs.h"
#include "usage.h"
#include "visibility_options.h"

namespace fcl_artic::app {
namespace {

/// Table 1 as printed in the paper (Redon, Kim, Lin, Manocha 2004), in ms: dynamic BVH culling, dynamic SV culling,
/// exact contact, total; colliding first. (At 5 degrees, colliding, the printed parts don't sum to the printed total.)
struct Printed {
  double degrees;
  double colliding[4], free[4];
};
constexpr Printed kPrinted[] = {
    {1, {0.0014, 11.9552, 11.8, 23.7566}, {0.0012, 2.9801, 3.3123, 6.2936}},
    {5, {0.0017, 16.1848, 17.9427, 32.3713}, {0.0013, 4.3327, 3.6844, 8.0184}},
    {15, {0.0018, 22.1523, 30.5652, 52.7193}, {0.0015, 3.9728, 5.4548, 9.4291}},
    {30, {0.0018, 18.6973, 85.4134, 104.1125}, {0.0013, 4.4477, 18.7761, 23.2251}},
};

const double* printedAt(double degrees, bool colliding) {
  for (const Printed& p : kPrinted) {
    if (p.degrees == degrees) return colliding ? p.colliding : p.free;
  }
  return nullptr;
}

constexpr const char* kNoExecutor = "none";
constexpr const char *kAsWritten = "as-written", *kRedon = "redon2004", *kStandard = "standard";

struct Table1Options : PipeOptions {
  int passes = 3;
  double tolerance = 1e-6;
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  std::string executor = "osmesa";
#else
  std::string executor = "cpu";
#endif
  std::vector<std::string> methods{kAsWritten, kRedon, kStandard};
  std::string csv, svg;
};

/// A row for each of these and each kind of steps.
struct Variant {
  std::string name;
  CertifiedRequest request;
};

/// The paper's method as the paper has it, with what this library adds to it, and the library's own; each with stage 2
/// and without.
std::vector<Variant> variantsOf(const Table1Options& o) {
  std::vector<Variant> all;
  for (const std::string& name : o.methods) {
    CertifiedRequest request;
    request.tolerance_time = o.tolerance;
    request.check_self = o.self;
    request.method = name == kStandard ? Method::standard : Method::redon2004;
    if (name == kAsWritten) request.redon = RedonOptions::asWritten();
    if (o.executor != kNoExecutor) {
      request.visibility = VisibilityMode::on;
      all.push_back({name, request});
    }
    request.visibility = VisibilityMode::off;
    all.push_back({name, request});
  }
  return all;
}

/// Steps of one angle and one kind.
struct Group {
  double degrees;
  bool colliding;
  std::vector<StepCosts> costs;  ///< By variant; empty: the steps are refused.
};

/// Total of a method without stage 2, us; 0: it was not asked for.
double totalOf(const Group& group, const std::vector<Variant>& variants, const std::string& name) {
  for (std::size_t v = 0; v < group.costs.size(); ++v) {
    if (variants[v].name == name && variants[v].request.visibility == VisibilityMode::off) return group.costs[v].total;
  }
  return 0;
}

/// Factors are of totals: the printed one's, and that of the paper's method as written and without stage 2.
Table tableOf(const std::vector<Group>& groups, const std::vector<Variant>& variants) {
  Table table;
  table.columns = {{"angle", "degrees"},
                   {"steps", "steps"},
                   {"method", "method"},
                   {"BVH ms", "bvh_ms"},
                   {"SV ms", "sv_ms"},
                   {"exact ms", "exact_ms"},
                   {"total ms", "total_ms"},
                   {"median", "median_ms"},
                   {"factor", "printed_by_this"},
                   {"written :", "as_written_by_this"},
                   {"p95 ms", "p95_ms"},
                   {"SV pairs", "sv_pairs"},
                   {"SV culled", "sv_culled"},
                   {"box tests", "box_tests"},
                   {"leaf pairs", "leaf_pairs"},
                   {"equations", "equations"},
                   {"s_max", "s_max"},
                   {"a n_e", "a_ne"},
                   {"chain steps", "chain_steps"}};
  for (const Group& group : groups) {
    const std::string angle = fmt::format("{:g}", group.degrees), kind = group.colliding ? "COL" : "NO-COL";
    const double* printed = printedAt(group.degrees, group.colliding);
    if (printed) {
      std::vector<std::string> row{angle, kind, "printed"};
      for (int i = 0; i < 4; ++i) row.push_back(fourDigits(printed[i]));
      row.resize(table.columns.size());
      table.rows.push_back(row);
    }
    if (group.costs.empty()) {
      std::vector<std::string> row{angle, kind, "refused"};
      for (const Column& column : table.columns) {
        if (row.size() < table.columns.size()) row.push_back(column.key == "leaf_pairs" ? "0.0" : "");
      }
      table.rows.push_back(row);
    }
    for (std::size_t v = 0; v < group.costs.size(); ++v) {
      const StepCosts& c = group.costs[v];
      const auto ms = [](double us) { return us < 0 ? std::string() : fourDigits(us * 1e-3); };
      std::vector<std::string> row{angle, kind, variants[v].name + (c.sv < 0 ? "" : " +SV")};
      for (const double us : {c.bvh, c.sv, c.exact, c.total, c.median}) row.push_back(ms(us));
      row.push_back(printed ? fmt::format("{:.1f}", 1e3 * printed[3] / c.total) : "");
      const double written = totalOf(group, variants, kAsWritten);
      row.push_back(written > 0 ? fmt::format("{:.1f}", written / c.total) : "");
      row.push_back(ms(c.p95));
      for (const double count : {c.sv_pairs, c.sv_culled}) row.push_back(c.sv < 0 ? "" : fmt::format("{:.1f}", count));
      for (const double count : {c.box_tests, c.leaf_pairs, c.equations, c.intervals, c.evaluations, c.steps}) {
        row.push_back(variants[v].request.method == Method::redon2004 ? fmt::format("{:.1f}", count) : "");
      }
      table.rows.push_back(row);
    }
  }
  return table;
}

std::string svgOf(const std::vector<Group>& groups, const std::vector<Variant>& variants, const Table1Options& o) {
  BarChart chart;
  chart.title = "Total time of continuous collision detection, PUMA 560 in Pipes";
  chart.y_label = "ms";
  chart.logarithmic = true;
  chart.series = {{"paper, as printed", {}}};
  for (const std::string& name : o.methods) chart.series.push_back({name, {}});
  for (const bool colliding : {true, false}) {
    for (const Group& group : groups) {
      if (group.colliding != colliding) continue;
      const double* printed = printedAt(group.degrees, colliding);
      chart.groups.push_back(fmt::format("{:g}° {}", group.degrees, colliding ? "hit" : "free"));
      chart.series[0].values.push_back(printed ? printed[3] : 0);
      for (std::size_t i = 0; i < o.methods.size(); ++i) {
        chart.series[i + 1].values.push_back(totalOf(group, variants, o.methods[i]) * 1e-3);
      }
    }
  }
  return toSvg({chart});
}

int runTable1(Table1Options& o) {
  removeEarlierOutputs({{"--csv", &o.csv}, {"--svg", &o.svg}}, {});
  const PumaInPipes scenery = pumaInPipes(o);
  const bool stage2 = o.executor != kNoExecutor;
  const auto culler = makeCuller(stage2 ? o.executor : "cpu");
  scenery.manager->setVisibility(culler);
  const std::string executor = stage2 ? culler->executor() : kNoExecutor;  // ready before times are taken
  const std::vector<Variant> variants = variantsOf(o);
  std::vector<Group> groups;
  std::vector<std::string> refusals;
  std::string sets;
  std::size_t differ = 0;
  {
    ProgressBar bar;
    for (std::size_t i = 0; i < o.angles.size(); ++i) {
      const CloseSteps steps = closeSteps(scenery, o, o.angles[i]);
      sets += steps.summary();
      if (!steps.refusal().empty()) refusals.push_back(steps.refusal());
      for (const bool colliding : {true, false}) {
        Group group{o.angles[i], colliding, {}};
        for (const Variant& variant : variants) {
          if (!colliding && !steps.refusal().empty()) break;
          bar.show(static_cast<double>(groups.size() * variants.size() + group.costs.size()) /
                   static_cast<double>(2 * o.angles.size() * variants.size()));
          group.costs.push_back(measureSteps(*scenery.manager, colliding ? steps.colliding : steps.free,
                                             variant.request, o.passes, colliding, differ));
        }
        groups.push_back(group);
      }
    }
  }
  const Table table = tableOf(groups, variants);
  fmt::print(
      "{}{}Times are means but for median and p95; the factors are those by which a mean total\n"
      "is below the printed one (factor) and below that of as-written (written :).\n{}\n{}",
      description(scenery, o, o.passes),
      !stage2 ? ""
              : fmt::format("+SV: with culling by visibility, executor {}{}.\n", executor,
                            executor == o.executor ? "" : fmt::format("\n({})", culler->fallbackReason())),
      sets, textOf(table, 3));
  if (differ) fmt::print("{} verdicts differ from one another\n", differ);
  if (!o.csv.empty()) files::write(o.csv, csvOf(table));
  if (!o.svg.empty()) files::write(o.svg, svgOf(groups, variants, o));
  if (!refusals.empty()) throw std::runtime_error(fmt::format("refused: {}", fmt::join(refusals, "; ")));
  return differ ? kExitContact : kExitFree;
}

}  // namespace

void addTable1(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<Table1Options>();
  Table1Options& o = *options;
  CLI::App* verb = program.add_subcommand(
      "table1", "Table 1 of Redon et al. 2004: the paper's method, and the library's own, beside the printed times");
  verb->footer(
      "A row of free steps in none of which triangles are compared is refused, with exit status 2: it would not "
      "measure\n"
      "exact contact. A smaller --closeness mends it.\n"
      "Exit status: 0 all methods agree on all verdicts, 1 they don't, 2 error.");
  addPipeOptions(*verb, o);
  verb->add_option("--passes", o.passes, "Runs of each query; the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--tolerance-time", o.tolerance, "Wanted width of the bracket of the contact time")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--methods", o.methods, "Rows of the table")
      ->check(CLI::IsMember({kAsWritten, kRedon, kStandard}))
      ->capture_default_str();
  verb->add_option("--executor", o.executor, "That culls by visibility; none: no rows with it")
      ->check(CLI::IsMember({kNoExecutor, "cpu", "osmesa", "egl"}))
      ->capture_default_str();
  verb->add_option("--csv", o.csv, "Write the table as CSV")->type_name("FILE");
  verb->add_option("--svg", o.svg, "Draw the totals")->type_name("FILE");
  verb->callback([options, &exit_status] { exit_status = runTable1(*options); });
}

}  // namespace fcl_artic::app
