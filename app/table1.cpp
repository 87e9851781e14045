// SPDX-License-Identifier: BSD-3-Clause
#include "table1.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
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
#include "fcl_artic/fcl_artic.h"
#include "fcl_artic/urdf/urdf.h"
#include "generator.h"
#include "progress.h"
#include "redon_options.h"

namespace fcl_artic::app {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

/// Numbers that are the same on every machine (splitmix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform(double a, double b) { return a + (b - a) * static_cast<double>(next() >> 11) * 0x1p-53; }
  double sign() { return next() & 1 ? 1 : -1; }

 private:
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ z >> 27) * 0x94d049bb133111ebull;
    return z ^ z >> 31;
  }
  std::uint64_t state_;
};

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

/// Means over queries, us and counts; the times of a query are those of its fastest run.
struct Cell {
  double bvh = 0, exact = 0, total = 0;
  double solving = 0;  ///< part of `exact`: the equations
  double sv = -1;      ///< below 0: the stage is off
  std::vector<double> totals;
  double box_tests = 0, leaf_pairs = 0, equations = 0, intervals = 0, evaluations = 0, steps = 0;
  double median() const { return at(0.5); }
  double p95() const { return at(0.95); }

 private:
  double at(double part) const {
    std::vector<double> sorted = totals;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  }
};

/// @param[out] differ  queries whose verdict is not `contact`.
Cell measure(const ArticulatedCollisionManager& manager, const std::vector<JointMotion>& motions,
             CertifiedRequest request, int passes, bool contact, std::size_t& differ) {
  request.measure_times = true;
  Cell cell;
  CertifiedResult result;
  if (request.visibility != VisibilityMode::off) cell.sv = 0;
  for (const JointMotion& motion : motions) {
    QueryStatistics best;
    best.total_us = 1e300;
    for (int pass = 0; pass < passes; ++pass) {
      manager.continuousCollide(motion, request, result);
      if (result.statistics.total_us < best.total_us) best = result.statistics;
    }
    differ += (result.status == Status::contact) != contact;
    const bool paper = request.method == Method::Redon2004;
    const double bvh = paper ? best.redon.culling_us : best.culling_us;
    cell.bvh += bvh;
    if (cell.sv >= 0) cell.sv += best.visibility_us;
    cell.exact += best.total_us - bvh - (cell.sv >= 0 ? best.visibility_us : 0);
    cell.total += best.total_us;
    cell.solving += best.redon.equations_us;
    cell.totals.push_back(best.total_us);
    cell.box_tests += static_cast<double>(paper ? best.redon.box_tests : best.node_tests);
    cell.leaf_pairs += static_cast<double>(paper ? best.redon.leaf_pairs : best.leaf_tests);
    cell.equations += static_cast<double>(best.redon.equations);
    cell.intervals += static_cast<double>(paper ? best.redon.intervals : best.batches);
    cell.evaluations += static_cast<double>(paper ? best.redon.evaluations : best.certificates);
    cell.steps += static_cast<double>(best.redon.steps_bounded);
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, motions.size()));
  for (double* x : {&cell.bvh, &cell.exact, &cell.total, &cell.solving, &cell.box_tests, &cell.leaf_pairs,
                    &cell.equations, &cell.intervals, &cell.evaluations, &cell.steps}) {
    *x /= n;
  }
  if (cell.sv >= 0) cell.sv /= n;
  return cell;
}

void writeFile(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("can't write '" + path + "'");
}

struct Table1Options {
  std::vector<double> angles{1, 5, 15, 30};
  std::size_t queries = 50, triangles = 100000;
  std::uint64_t seed = 1;
  int passes = 3;
  double tolerance = 1e-6;
  RedonOptions redon;
  std::string csv, svg;
};

struct Row {
  double degrees;
  Cell paper[2], own[2];  ///< colliding, free
};

const Printed* printedAt(double degrees) {
  for (const Printed& p : kPrinted) {
    if (p.degrees == degrees) return &p;
  }
  return nullptr;
}

std::string ms(double us) {
  return us < 0 ? "-" : fmt::format("{:.4f}", us * 1e-3);
}

std::string textOf(const std::vector<Row>& rows) {
  std::string out = fmt::format("{:>5}  {:<8} {:<22}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "angle", "steps", "method",
                                "BVH ms", "SV ms", "exact ms", "total ms", "median", "p95");
  for (const Row& row : rows) {
    const Printed* printed = printedAt(row.degrees);
    for (int c = 0; c < 2; ++c) {
      const char* kind = c ? "NO-COL" : "COL";
      if (printed) {
        const double* p = c ? printed->free : printed->colliding;
        out += fmt::format("{:>5}  {:<8} {:<22}{:>12.4f}{:>12.4f}{:>12.4f}{:>12.4f}\n", row.degrees, kind,
                           "paper, as printed", p[0], p[1], p[2], p[3]);
      }
      for (const auto& [name, cell] :
           {std::pair<const char*, const Cell*>{"redon2004", &row.paper[c]}, {"standard", &row.own[c]}}) {
        out += fmt::format("{:>5}  {:<8} {:<22}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", row.degrees, kind, name,
                           ms(cell->bvh), ms(cell->sv), ms(cell->exact), ms(cell->total), ms(cell->median()),
                           ms(cell->p95()));
      }
    }
  }
  out += fmt::format("\n{:>5}  {:<8}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>14}{:>14}\n", "angle", "steps", "box tests",
                     "leaf pairs", "equations", "s_max", "a n_e", "chain steps", "printed/redon", "redon/standard");
  for (const Row& row : rows) {
    const Printed* printed = printedAt(row.degrees);
    for (int c = 0; c < 2; ++c) {
      const Cell& p = row.paper[c];
      out += fmt::format(
          "{:>5}  {:<8}{:>12.0f}{:>12.0f}{:>12.0f}{:>12.1f}{:>12.0f}{:>12.0f}{:>14}{:>14.1f}\n", row.degrees,
          c ? "NO-COL" : "COL", p.box_tests, p.leaf_pairs, p.equations, p.intervals, p.evaluations, p.steps,
          printed ? fmt::format("{:.1f}", 1e3 * (c ? printed->free : printed->colliding)[3] / p.total) : "-",
          p.total / row.own[c].total);
    }
  }
  return out;
}

std::string csvOf(const std::vector<Row>& rows) {
  std::string out =
      "degrees,steps,method,bvh_ms,sv_ms,exact_ms,total_ms,median_ms,p95_ms,box_tests,leaf_pairs,equations,s_max,a_ne,"
      "chain_steps\n";
  for (const Row& row : rows) {
    const Printed* printed = printedAt(row.degrees);
    for (int c = 0; c < 2; ++c) {
      const char* kind = c ? "NO-COL" : "COL";
      if (printed) {
        const double* p = c ? printed->free : printed->colliding;
        out += fmt::format("{},{},printed,{},{},{},{},,,,,,,,\n", row.degrees, kind, p[0], p[1], p[2], p[3]);
      }
      for (const auto& [name, cell] :
           {std::pair<const char*, const Cell*>{"redon2004", &row.paper[c]}, {"standard", &row.own[c]}}) {
        const bool paper = cell == &row.paper[c];
        out += fmt::format("{},{},{},{:.6f},{},{:.6f},{:.6f},{:.6f},{:.6f}", row.degrees, kind, name, cell->bvh * 1e-3,
                           cell->sv < 0 ? "" : fmt::format("{:.6f}", cell->sv * 1e-3), cell->exact * 1e-3,
                           cell->total * 1e-3, cell->median() * 1e-3, cell->p95() * 1e-3);
        out += paper ? fmt::format(",{:.1f},{:.1f},{:.1f},{:.2f},{:.1f},{:.1f}\n", cell->box_tests, cell->leaf_pairs,
                                   cell->equations, cell->intervals, cell->evaluations, cell->steps)
                     : ",,,,,,\n";
      }
    }
  }
  return out;
}

std::string svgOf(const std::vector<Row>& rows) {
  BarChart chart;
  chart.title = "Total time of continuous collision detection, PUMA 560 in Pipes";
  chart.y_label = "ms";
  chart.logarithmic = true;
  BarChart::Series printed{"paper, as printed", {}}, paper{"redon2004", {}}, own{"standard", {}};
  for (int c = 0; c < 2; ++c) {
    for (const Row& row : rows) {
      chart.groups.push_back(fmt::format("{:g}° {}", row.degrees, c ? "free" : "hit"));
      const Printed* p = printedAt(row.degrees);
      printed.values.push_back(p ? (c ? p->free : p->colliding)[3] : 0);
      paper.values.push_back(row.paper[c].total * 1e-3);
      own.values.push_back(row.own[c].total * 1e-3);
    }
  }
  chart.series = {printed, paper, own};
  return toSvg({chart});
}

int runTable1(const Table1Options& o) {
  const auto scenery = pumaInPipes(o.triangles, o.seed);
  std::vector<Row> rows;
  std::size_t differ = 0;
  {
    ProgressBar bar;
    for (std::size_t i = 0; i < o.angles.size(); ++i) {
      const auto share = [&](double part) {
        bar.show((static_cast<double>(i) + part) / static_cast<double>(o.angles.size()));
      };
      const auto sets = makeSteps(*scenery, o.angles[i] * kRadiansPerDegree, o.queries, o.seed + 100 * i);
      share(0.2);
      Row row;
      row.degrees = o.angles[i];
      for (int c = 0; c < 2; ++c) {
        CertifiedRequest request;
        request.tolerance_time = o.tolerance;
        row.own[c] = measure(*scenery->manager, sets[static_cast<std::size_t>(c)], request, o.passes, c == 0, differ);
        request.method = Method::Redon2004;
        request.redon = o.redon;
        row.paper[c] = measure(*scenery->manager, sets[static_cast<std::size_t>(c)], request, o.passes, c == 0, differ);
        share(0.6 + 0.4 * c);
      }
      rows.push_back(row);
    }
  }
  fmt::print(
      "PUMA 560 in Pipes of {} triangles, every joint by the angle up or down; {} colliding and {} free steps each, "
      "the "
      "fastest of {} runs.\nThe paper's own scene of that name is another one; its size isn't known.\n\n{}",
      o.triangles, o.queries, o.queries, o.passes, textOf(rows));
  if (differ) fmt::print("{} verdicts differ from one another\n", differ);
  if (!o.csv.empty()) writeFile(o.csv, csvOf(rows));
  if (!o.svg.empty()) writeFile(o.svg, svgOf(rows));
  return differ ? kExitContact : kExitFree;
}

// --- Depth of the chain.

struct DepthOptions {
  std::vector<int> joints{2, 4, 6, 10, 15, 20, 30};
  std::size_t queries = 10;
  std::uint64_t seed = 1;
  int passes = 2;
  RedonOptions redon;
  std::string csv, svg;
};

/// An arm of n joints and 1.2 m whose last link carries a mesh, amid a mesh of pipes; the same path of the last link's
/// kind for all n: each joint turns by 10 degrees / n, up or down.
struct Snake {
  std::shared_ptr<KinematicTree> tree;
  std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> tip, pipes;
  std::unique_ptr<fcl::CollisionObjectd> tip_object, pipes_object;
  std::unique_ptr<ArticulatedCollisionManager> manager;
};

std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> modelOf(const generator::Mesh& mesh, const Eigen::Vector3d& shift,
                                                     double scale) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<Eigen::Vector3d> vertices;
  for (const Eigen::Vector3d& v : mesh.vertices) vertices.push_back(scale * (v - shift));
  std::vector<fcl::Triangle> faces;
  for (const auto& t : mesh.triangles) faces.emplace_back(t[0], t[1], t[2]);
  model->beginModel();
  model->addSubModel(vertices, faces);
  model->endModel();
  return model;
}

Snake makeSnake(int joints) {
  Snake s;
  s.tree = std::make_shared<KinematicTree>("snake");
  s.tree->addLink("link0");
  for (int i = 1; i <= joints; ++i) {
    s.tree->addLink(fmt::format("link{}", i));
    Joint joint;
    joint.name = fmt::format("joint{}", i);
    joint.type = JointType::revolute;
    joint.parent = fmt::format("link{}", i - 1);
    joint.child = fmt::format("link{}", i);
    joint.origin.translation() = i == 1 ? Eigen::Vector3d(0, 0, 0.5) : Eigen::Vector3d(1.2 / joints, 0, 0);
    joint.axis = i % 2 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    s.tree->addJoint(joint);
  }
  const generator::NamedMesh hand = generator::puma560Meshes().back();
  s.tip = modelOf(hand.mesh, Eigen::Vector3d::Zero(), 1);
  s.pipes = modelOf(generator::pipes(10000, 2), Eigen::Vector3d::Zero(), 1);
  s.tip_object = std::make_unique<fcl::CollisionObjectd>(s.tip);
  s.pipes_object = std::make_unique<fcl::CollisionObjectd>(s.pipes);
  s.manager = std::make_unique<ArticulatedCollisionManager>(s.tree);
  s.manager->bind(fmt::format("link{}", joints), s.tip_object.get());
  s.manager->registerObject(s.pipes_object.get(), "pipes");
  s.manager->setup();
  return s;
}

int runDepth(const DepthOptions& o) {
  struct Line {
    int joints;
    Cell simultaneous, independent;
  };
  std::vector<Line> lines;
  std::size_t differ = 0;
  for (const int joints : o.joints) {
    const Snake s = makeSnake(joints);
    Random random(o.seed);
    std::vector<JointMotion> motions;
    CertifiedRequest request;
    CertifiedResult result;
    for (std::uint64_t tries = 0; motions.size() < o.queries; ++tries) {
      if (tries > 2000000) throw std::runtime_error("depth: no colliding steps are found");
      Eigen::VectorXd q0(joints), q1(joints);
      for (int v = 0; v < joints; ++v) {
        q0[v] = random.uniform(v == 0 ? -3.1 : -2.0 / joints, v == 0 ? 3.1 : 2.0 / joints);
        q1[v] = q0[v] + random.sign() * 10 * kRadiansPerDegree / joints;
      }
      const JointMotion motion = JointMotion::linear(*s.tree, q0, q1);
      s.manager->continuousCollide(motion, request, result);
      if (result.status == Status::contact && result.t_lower > 0.05) motions.push_back(motion);
    }
    request.method = Method::Redon2004;
    request.redon = o.redon;
    Line line;
    line.joints = joints;
    request.redon.simultaneous = true;
    line.simultaneous = measure(*s.manager, motions, request, o.passes, true, differ);
    request.redon.simultaneous = false;
    line.independent = measure(*s.manager, motions, request, o.passes, true, differ);
    lines.push_back(line);
  }
  fmt::print("{:>6}  {:<13}{:>12}{:>12}{:>14}{:>14}{:>14}{:>14}\n", "joints", "equations", "n_e", "intervals",
             "evaluations", "chain steps", "equations ms", "factor");
  std::string csv = "joints,solver,equations,intervals,evaluations,chain_steps,equations_ms\n";
  BarChart chart;
  chart.title = "Equations solved all at once and one by one";
  chart.y_label = "ms";
  chart.logarithmic = true;
  chart.series = {{"simultaneous", {}}, {"independent", {}}};
  for (const Line& line : lines) {
    chart.groups.push_back(std::to_string(line.joints));
    for (const auto& [name, cell] : {std::pair<const char*, const Cell*>{"simultaneous", &line.simultaneous},
                                     {"independent", &line.independent}}) {
      const bool alone = cell == &line.independent;
      fmt::print("{:>6}  {:<13}{:>12.0f}{:>12.1f}{:>14.0f}{:>14.0f}{:>14.3f}{:>14}\n", line.joints, name,
                 cell->equations, cell->intervals, cell->evaluations, cell->steps, cell->solving * 1e-3,
                 alone ? fmt::format("{:.1f}", line.independent.solving / line.simultaneous.solving) : "");
      csv += fmt::format("{},{},{:.1f},{:.2f},{:.1f},{:.1f},{:.6f}\n", line.joints, name, cell->equations,
                         cell->intervals, cell->evaluations, cell->steps, cell->solving * 1e-3);
      chart.series[alone].values.push_back(cell->solving * 1e-3);
    }
  }
  if (differ) fmt::print("{} verdicts differ from one another\n", differ);
  if (!o.csv.empty()) writeFile(o.csv, csv);
  if (!o.svg.empty()) writeFile(o.svg, toSvg({chart}));
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
  verb->add_option("--csv", o.csv, "Write the table as CSV")->type_name("FILE");
  verb->add_option("--svg", o.svg, "Draw the totals")->type_name("FILE");
  addRedonOptions(*verb, o.redon);
  verb->callback([options, &exit_status] { exit_status = runTable1(*options); });
}

void addDepth(CLI::App& bench, int& exit_status) {
  auto options = std::make_shared<DepthOptions>();
  DepthOptions& o = *options;
  CLI::App* verb =
      bench.add_subcommand("depth", "Equations solved all at once and one by one, as the chain gets deeper");
  verb->add_option("--joints", o.joints, "Joints of the chain")
      ->check(CLI::Range(1, 200))
      ->capture_default_str()
      ->type_name("N...");
  verb->add_option("--queries", o.queries, "Colliding steps for each chain")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--seed", o.seed, "The same seed asks the same queries")->capture_default_str();
  verb->add_option("--passes", o.passes, "Runs of each query; the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--csv", o.csv, "Write the table as CSV")->type_name("FILE");
  verb->add_option("--svg", o.svg, "Draw the times")->type_name("FILE");
  addRedonOptions(*verb, o.redon);
  verb->callback([options, &exit_status] { exit_status = runDepth(*options); });
}

}  // namespace fcl_artic::app
