// SPDX-License-Identifier: BSD-3-Clause
#include "table1.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fmt/format.h>

#include "bars.h"
#include "exit_status.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "generator.h"
#include "progress.h"
#include "redon_options.h"
#include "step_bench.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

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

/// A robot and a scene, ready for queries.
struct Scenery {
  Robot robot;
  std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> mesh;
  std::unique_ptr<fcl::CollisionObjectd> obstacle;
  std::unique_ptr<ArticulatedCollisionManager> manager;
};

Robot makePuma() {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("fcl_artic_puma560_{}", std::random_device()());
  generator::writePuma560(folder.string());
  struct Remove {
    std::filesystem::path folder;
    ~Remove() {
      std::error_code ignored;
      std::filesystem::remove_all(folder, ignored);
    }
  } remove{folder};
  return loadUrdf((folder / "puma560.urdf").string());
}

std::unique_ptr<Scenery> pumaInPipes(std::size_t triangles, std::uint64_t seed) {
  auto s = std::make_unique<Scenery>();
  s->robot = makePuma();
  const generator::Mesh pipes = generator::pipes(triangles, seed);
  s->mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  s->mesh->beginModel(static_cast<int>(pipes.triangles.size()), static_cast<int>(pipes.vertices.size()));
  std::vector<fcl::Triangle> faces;
  for (const auto& t : pipes.triangles) faces.emplace_back(t[0], t[1], t[2]);
  s->mesh->addSubModel(pipes.vertices, faces);
  s->mesh->endModel();
  s->obstacle = std::make_unique<fcl::CollisionObjectd>(s->mesh);
  s->manager = std::make_unique<ArticulatedCollisionManager>(s->robot.tree);
  s->robot.addTo(*s->manager);
  s->manager->registerObject(s->obstacle.get(), "pipes");
  s->manager->setup();
  return s;
}

/// Random steps from free configurations within the joints' limits: every joint by the angle, up or down.
/// @return colliding ones, free ones.
std::array<std::vector<JointMotion>, 2> makeSteps(const Scenery& s, double angle, std::size_t count,
                                                  std::uint64_t seed) {
  const KinematicTree& tree = *s.robot.tree;
  Random random(seed);
  std::array<std::vector<JointMotion>, 2> sets;
  CertifiedRequest request;
  CertifiedResult result;
  for (std::uint64_t tries = 0; sets[0].size() < count || sets[1].size() < count; ++tries) {
    if (tries > 20000000) throw std::runtime_error("table1: no colliding steps are found in this scene");
    Eigen::VectorXd q0(tree.dof()), q1(tree.dof());
    for (int v = 0; v < tree.dof(); ++v) {
      const Joint& joint = tree.joint(tree.variableJoint(v));
      const bool limited = joint.lower < joint.upper;
      q0[v] = random.uniform(limited ? joint.lower : -3.14, limited ? joint.upper : 3.14);
      q1[v] = q0[v] + random.sign() * angle;
    }
    const JointMotion motion = JointMotion::linear(tree, q0, q1);
    s.manager->continuousCollide(motion, request, result);
    if (result.status == Status::contact && result.t_lower == 0) continue;
    auto& set = sets[result.status == Status::contact ? 0 : 1];
    if (set.size() < count) set.push_back(motion);
  }
  return sets;
}

constexpr const char* kNoExecutor = "none";
constexpr const char *kAsWritten = "redon2004-as-written", *kRedon = "redon2004", *kStandard = "standard";

struct Table1Options {
  std::vector<double> angles{1, 5, 15, 30};
  std::size_t queries = 20, triangles = 100000;
  std::uint64_t seed = 1;
  int passes = 3;
  double tolerance = 1e-6;
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  std::string executor = "osmesa";
#else
  std::string executor = "cpu";
#endif
  std::vector<std::string> methods{kAsWritten, kRedon, kStandard};
  RedonOptions redon;
  std::string csv, svg;
};

/// Stage 2 by this executor, or by what takes its place.
std::shared_ptr<const VisibilityCuller> makeCuller(const std::string& executor) {
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  if (executor == "osmesa") return makeOffscreenCuller(OffscreenBackend::osmesa);
  if (executor == "egl") return makeOffscreenCuller(OffscreenBackend::egl);
#else
  if (executor == "osmesa" || executor == "egl")
    throw std::invalid_argument("this program was built without the executor " + executor);
#endif
  return std::make_shared<VisibilityCuller>();
}

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
    request.method = name == kStandard ? Method::standard : Method::redon2004;
    request.redon = o.redon;
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
  std::vector<StepCosts> costs;  ///< by variant
};

/// Total of a method without stage 2, us; 0: it was not asked for.
double totalOf(const Group& group, const std::vector<Variant>& variants, const std::string& name) {
  for (std::size_t v = 0; v < variants.size(); ++v) {
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
                   {"p95", "p95_ms"},
                   {"printed :", "printed_by_this"},
                   {"written :", "as_written_by_this"},
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
      for (int i = 0; i < 4; ++i) row.push_back(fmt::format("{:.4f}", printed[i]));
      row.resize(table.columns.size());
      table.rows.push_back(row);
    }
    for (std::size_t v = 0; v < variants.size(); ++v) {
      const StepCosts& c = group.costs[v];
      const auto ms = [](double us) { return us < 0 ? std::string() : fmt::format("{:.4f}", us * 1e-3); };
      std::vector<std::string> row{angle, kind, variants[v].name};
      for (const double us : {c.bvh, c.sv, c.exact, c.total, c.median, c.p95}) row.push_back(ms(us));
      row.push_back(printed ? fmt::format("{:.1f}", 1e3 * printed[3] / c.total) : "");
      const double written = totalOf(group, variants, kAsWritten);
      row.push_back(written > 0 ? fmt::format("{:.1f}", written / c.total) : "");
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

int runTable1(const Table1Options& o) {
  const auto scenery = pumaInPipes(o.triangles, o.seed);
  const auto culler = makeCuller(o.executor);
  scenery->manager->setVisibility(culler);
  const bool stage2 = o.executor != kNoExecutor;
  const std::string executor = stage2 ? culler->executor() : kNoExecutor;  // ready before times are taken
  const std::vector<Variant> variants = variantsOf(o);
  std::vector<Group> groups;
  std::size_t differ = 0;
  {
    ProgressBar bar;
    for (std::size_t i = 0; i < o.angles.size(); ++i) {
      const auto sets = makeSteps(*scenery, o.angles[i] * kRadiansPerDegree, o.queries, o.seed + 100 * i);
      for (const bool colliding : {true, false}) {
        Group group{o.angles[i], colliding, {}};
        for (const Variant& variant : variants) {
          bar.show(static_cast<double>(groups.size() * variants.size() + group.costs.size()) /
                   static_cast<double>(2 * o.angles.size() * variants.size()));
          group.costs.push_back(
              measureSteps(*scenery->manager, sets[colliding ? 0 : 1], variant.request, o.passes, colliding, differ));
        }
        groups.push_back(group);
      }
    }
  }
  const Table table = tableOf(groups, variants);
  fmt::print(
      "PUMA 560 in Pipes of {} triangles, every joint by the angle up or down;\n"
      "{} colliding and {} free steps each, the fastest of {} runs. The paper's own scene of\n"
      "that name is another one; its size isn't known.\n"
      "SV: culling by visibility, executor {}{}.\n"
      "printed : and written : are the factors by which a total is below the printed one\n"
      "and below that of redon2004-as-written without SV.\n\n{}",
      o.triangles, o.queries, o.queries, o.passes, executor,
      executor == o.executor ? "" : fmt::format("\n({})", culler->fallbackReason()), textOf(table, 3));
  if (differ) fmt::print("{} verdicts differ from one another\n", differ);
  if (!o.csv.empty()) files::write(o.csv, csvOf(table));
  if (!o.svg.empty()) files::write(o.svg, svgOf(groups, variants, o));
  return differ ? kExitContact : kExitFree;
}

}  // namespace

void addTable1(CLI::App& bench, int& exit_status) {
  auto options = std::make_shared<Table1Options>();
  Table1Options& o = *options;
  CLI::App* verb = bench.add_subcommand(
      "table1", "Table 1 of Redon et al. 2004: the paper's method, and the library's own, beside the printed times");
  verb->footer("Exit status: 0 both methods agree on all verdicts, 1 they don't, 2 error.");
  verb->add_option("--angles", o.angles, "Angle by which every joint moves, degrees")
      ->capture_default_str()
      ->type_name("DEG...");
  verb->add_option("--queries", o.queries, "Colliding steps and free steps for each angle")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--triangles", o.triangles, "Triangles of the pipes")
      ->check(CLI::Range(1000, 1000000))
      ->capture_default_str();
  verb->add_option("--seed", o.seed, "The same seed asks the same queries")->capture_default_str();
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
  addRedonOptions(*verb, o.redon);  // as written, boxes come first and validity late, whatever is given
  verb->callback([options, &exit_status] { exit_status = runTable1(*options); });
}

}  // namespace fcl_artic::app
