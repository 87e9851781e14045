// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fmt/format.h>

#include "bench/bars.h"
#include "bench/step_bench.h"
#include "bench/table1.h"
#include "exit_status.h"
#include "files/files.h"
#include "generator.h"
#include "kinematics/angles.h"
#include "outputs.h"
#include "redon_options.h"

namespace fcl_artic::app {
namespace {

constexpr std::size_t kTriangles = 10000;

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
  s.pipes = modelOf(generator::pipes(kTriangles, 2), Eigen::Vector3d::Zero(), 1);
  s.tip_object = std::make_unique<fcl::CollisionObjectd>(s.tip);
  s.pipes_object = std::make_unique<fcl::CollisionObjectd>(s.pipes);
  s.manager = std::make_unique<ArticulatedCollisionManager>(s.tree);
  s.manager->bind(fmt::format("link{}", joints), s.tip_object.get());
  s.manager->registerObject(s.pipes_object.get(), "pipes");
  s.manager->setup();
  return s;
}

/// Steps from free configurations, 10 degrees shared among the joints.
std::vector<JointMotion> collidingSteps(const Snake& s, int joints, const DepthOptions& o) {
  Random random(o.seed);
  std::vector<JointMotion> motions;
  CertifiedResult result;
  for (std::uint64_t tries = 0; motions.size() < o.queries; ++tries) {
    if (tries > 2000000) throw std::runtime_error("depth: no colliding steps are found");
    Eigen::VectorXd q0(joints), q1(joints);
    for (int v = 0; v < joints; ++v) {
      q0[v] = random.uniform(v == 0 ? -3.1 : -2.0 / joints, v == 0 ? 3.1 : 2.0 / joints);
      q1[v] = q0[v] + random.sign() * 10 * kRadiansPerDegree / joints;
    }
    const JointMotion motion = JointMotion::linear(*s.tree, q0, q1);
    s.manager->continuousCollide(motion, CertifiedRequest(), result);
    if (result.status == Status::contact && result.t_lower > 0.05) motions.push_back(motion);
  }
  return motions;
}

int runDepth(DepthOptions& o) {
  removeEarlierOutputs({{"--csv", &o.csv}, {"--svg", &o.svg}}, {});
  Table table;
  table.columns = {{"joints", "joints"},
                   {"equations", "solver"},
                   {"n_e", "equations"},
                   {"intervals", "intervals"},
                   {"evaluations", "evaluations"},
                   {"chain steps", "chain_steps"},
                   {"equations ms", "equations_ms"},
                   {"factor", "factor"}};
  BarChart chart;
  chart.title = "Equations solved all at once and one by one";
  chart.y_label = "ms";
  chart.logarithmic = true;
  chart.series = {{"simultaneous", {}}, {"independent", {}}};
  std::size_t differ = 0;
  for (const int joints : o.joints) {
    const Snake s = makeSnake(joints);
    const std::vector<JointMotion> motions = collidingSteps(s, joints, o);
    CertifiedRequest request;
    request.method = Method::redon2004;
    request.redon = o.redon;
    chart.groups.push_back(std::to_string(joints));
    for (BarChart::Series& series : chart.series) {
      request.redon.simultaneous = series.name == "simultaneous";
      const StepCosts costs = measureSteps(*s.manager, motions, request, o.passes, true, differ);
      series.values.push_back(costs.solving * 1e-3);
      table.rows.push_back({std::to_string(joints), series.name, fmt::format("{:.0f}", costs.equations),
                            fmt::format("{:.1f}", costs.intervals), fmt::format("{:.0f}", costs.evaluations),
                            fmt::format("{:.0f}", costs.steps), fmt::format("{:.4f}", costs.solving * 1e-3),
                            request.redon.simultaneous
                                ? ""
                                : fmt::format("{:.1f}", series.values.back() / chart.series[0].values.back())});
    }
  }
  fmt::print(
      "An arm of 1.2 m whose last link carries a hand, in Pipes of {} triangles:\n"
      "{} colliding steps for each chain, 10 degrees shared among its joints, the\n"
      "fastest of {} runs each. Counts and ms, of the equations alone: means.\n\n{}",
      kTriangles, o.queries, o.passes, textOf(table, 2));
  if (differ) fmt::print("{} verdicts differ from one another\n", differ);
  if (!o.csv.empty()) files::write(o.csv, csvOf(table));
  if (!o.svg.empty()) files::write(o.svg, toSvg({chart}));
  return differ ? kExitContact : kExitFree;
}

}  // namespace

void addDepth(CLI::App& bench, int& exit_status) {
  auto options = std::make_shared<DepthOptions>();
  DepthOptions& o = *options;
  CLI::App* verb =
      bench.add_subcommand("depth", "Equations solved all at once and one by one, as the chain gets deeper");
  verb->footer("Exit status: 0 all verdicts agree, 1 they don't, 2 error.");
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
