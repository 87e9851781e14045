// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "exit_status.h"
#include "files/files.h"
#include "outputs.h"
#include "pipe_steps.h"
#include "progress.h"
#include "step_costs.h"
#include "tables.h"

namespace fcl_artic::app {
namespace {

struct IdeasOptions : PipeOptions {
  int passes = 2;
  std::uint64_t budget = 10000000;
  std::string csv;
};

/// The method with one option, or two, other than by default, as it is written.
struct Idea {
  std::string name;
  RedonOptions options;
};

std::vector<Idea> ideas() {
  std::vector<Idea> all{{"defaults", {}}};
  const auto add = [&](const std::string& name) -> RedonOptions& {
    all.push_back({name, {}});
    return all.back().options;
  };
  for (const int level : {0, 3, 6}) add(fmt::format("refinement_level {}", level)).refinement_level = level;
  add("no newton").newton = false;
  add("no early_validity").early_validity = false;
  RedonOptions& late = add("no early_validity, no newton");
  late.early_validity = late.newton = false;
  add("no in_time_order").in_time_order = false;
  add("no simultaneous").simultaneous = false;
  add("links_in_world").links_in_world = true;
  add("intervalChain").enclosure = MotionEnclosure::intervalChain;
  add("taylor").enclosure = MotionEnclosure::taylor;
  all.push_back({"asWritten()", RedonOptions::asWritten()});
  return all;
}

/// Costs of one option, on one set of steps.
struct Row {
  std::string option;
  double degrees;
  bool colliding;
  StepCosts costs;
};

/// A number of these costs, with its names in the text and in the CSV.
struct Figure {
  const char *title, *key;
  double (*of)(const StepCosts&);
};
constexpr Figure kFigures[] = {
    {"total, ms, mean", "total_ms", [](const StepCosts& c) { return c.total * 1e-3; }},
    {"total, ms, median", "median_ms", [](const StepCosts& c) { return c.median * 1e-3; }},
    {"box tests", "box_tests", [](const StepCosts& c) { return c.box_tests; }},
    {"leaf pairs", "leaf_pairs", [](const StepCosts& c) { return c.leaf_pairs; }},
    {"equations, n_e", "equations", [](const StepCosts& c) { return c.equations; }},
    {"time intervals, s_max", "s_max", [](const StepCosts& c) { return c.intervals; }},
    {"equations bounded over an interval, a n_e", "a_ne", [](const StepCosts& c) { return c.evaluations; }},
};

/// A line for each option, a column for each set of steps. @param rows  options one after the other.
std::string textOf(const std::vector<Row>& rows, const Figure& figure) {
  Table table;
  table.columns = {{"option", ""}};
  for (const Row& row : rows) {
    if (row.option == rows.front().option) {
      table.columns.push_back({fmt::format("{:g} {}", row.degrees, row.colliding ? "COL" : "FREE"), ""});
    }
    if (table.rows.empty() || table.rows.back()[0] != row.option) table.rows.push_back({row.option});
    table.rows.back().push_back(row.costs.undecided ? "" : fourDigits(figure.of(row.costs)));
  }
  return fmt::format("{}\n{}", figure.title, textOf(table, 1));
}

std::string csvOf(const std::vector<Row>& rows) {
  Table table;
  table.columns = {{"", "option"}, {"", "degrees"}, {"", "steps"}, {"", "undecided"}};
  for (const Figure& figure : kFigures) table.columns.push_back({"", figure.key});
  for (const Row& row : rows) {
    table.rows.push_back({row.option, fmt::format("{:g}", row.degrees), row.colliding ? "COL" : "NO-COL",
                          std::to_string(row.costs.undecided)});
    for (const Figure& figure : kFigures) table.rows.back().push_back(fmt::format("{:.4f}", figure.of(row.costs)));
  }
  return csvOf(table);
}

int runIdeas(IdeasOptions& o) {
  removeEarlierOutputs({{"--csv", &o.csv}}, {});
  const PumaInPipes scenery = pumaInPipes(o);
  const std::vector<Idea> all = ideas();
  std::vector<Row> rows;
  std::size_t differ = 0;
  {
    ProgressBar bar;
    std::vector<CloseSteps> sets;
    for (const double degrees : o.angles) sets.push_back(closeSteps(scenery, o, degrees));
    for (const Idea& idea : all) {
      CertifiedRequest request;
      request.method = Method::redon2004;
      request.redon = idea.options;
      request.work_budget = o.budget;
      request.check_self = o.self;
      for (const CloseSteps& set : sets) {
        for (const bool colliding : {true, false}) {
          bar.show(static_cast<double>(rows.size()) / static_cast<double>(2 * all.size() * sets.size()));
          rows.push_back({idea.name, set.degrees, colliding,
                          measureSteps(*scenery.manager, colliding ? set.colliding : set.free, request, o.passes,
                                       colliding, differ)});
        }
      }
    }
  }
  fmt::print(
      "{}Method redon2004 without culling by visibility; counts are means.\n"
      "-: a step came to no end within {} tests and evaluations.\n",
      description(scenery, o, o.passes), o.budget);
  for (const Figure& figure : kFigures) fmt::print("\n{}", textOf(rows, figure));
  if (differ) fmt::print("{} verdicts differ from one another\n", differ);
  if (!o.csv.empty()) files::write(o.csv, csvOf(rows));
  return differ ? kExitContact : kExitFree;
}

}  // namespace

void addIdeas(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<IdeasOptions>();
  IdeasOptions& o = *options;
  o.angles = {1, 5, 30};
  CLI::App* verb = program.add_subcommand(
      "ideas", "What each idea of Redon et al. 2004 is worth: the paper's method, its options one by one");
  verb->footer("Exit status: 0 all verdicts agree, 1 they don't, 2 error.");
  addPipeOptions(*verb, o);
  verb->add_option("--passes", o.passes, "Runs of each query; the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option(
          "--budget", o.budget,
          "Tests after which a query ends undecided; 0: the library's own, after which the standard method answers")
      ->capture_default_str();
  verb->add_option("--csv", o.csv, "Write the table as CSV")->type_name("FILE");
  verb->callback([options, &exit_status] { exit_status = runIdeas(*options); });
}

}  // namespace fcl_artic::app
