// SPDX-License-Identifier: BSD-3-Clause
//
// The work of the one certified rival in print, A. Amice, P. Werner, R. Tedrake, "Certifying Bimanual RRT Motion Plans
// in a Second" (2024, arXiv 2310.16603), done by ours: edges along which the tangent of half of each angle goes
// straight (JointMotion::tangentHalfAngle()), of pendulums of 2 to 15 links amid 10 to 100 boxes, and of two arms with
// shelves. What their scenes leave open (sizes, the length of an edge) is drawn here with a seed and said below. Each
// edge's ends are free, as a planner's are.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fmt/format.h>

#include "fcl_artic/manager.h"
#include "options.h"
#include "random.h"
#ifdef FCL_ARTIC_HAS_URDF
#include "fcl_artic/urdf/urdf.h"
#endif

using namespace fcl_artic;
using namespace fcl_artic::bench;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr Answer kFree = 2;

/// A robot in its scene, with what the manager points to.
struct World {
  std::string name;
  std::shared_ptr<const KinematicTree> tree;
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> objects;
  std::unique_ptr<ArticulatedCollisionManager> manager;
  double setup_ms = 0;

  void hold(std::shared_ptr<const KinematicTree> robot) {
    tree = std::move(robot);
    manager = std::make_unique<ArticulatedCollisionManager>(tree);
  }
  template <class Geometry>
  void bind(LinkId link, const Geometry& geometry, const Eigen::Isometry3d& offset) {
    objects.push_back(std::make_shared<fcl::CollisionObjectd>(std::make_shared<Geometry>(geometry)));
    manager->bind(link, objects.back(), offset);
  }
  void addBox(const Eigen::Vector3d& sides, const Eigen::Vector3d& at, double yaw = 0) {
    const Eigen::Isometry3d pose(Eigen::Translation3d(at) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
    objects.push_back(std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(sides), pose));
    manager->registerObject(objects.back(), fmt::format("box{}", objects.size()));
  }
  void setUp() {
    const auto begin = std::chrono::steady_clock::now();
    manager->setup();
    setup_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  }
  bool free(const Eigen::VectorXd& q) const { return manager->collide(q, CertifiedRequest()).isFree(); }
};

Eigen::Isometry3d along(const Eigen::Vector3d& x) {
  return Eigen::Isometry3d(Eigen::Translation3d(x));
}

/// A chain in a plane, 1.5 m long in all, whose links are bars 2 cm wide, amid boxes of 5 to 15 cm that stand anywhere
/// in its reach but 25 cm from its base.
World makePendulum(int links, int boxes, std::uint64_t seed) {
  constexpr double kReach = 1.5, kWidth = 0.02, kFreeOfBase = 0.25;
  const double length = kReach / links;
  auto tree = std::make_shared<KinematicTree>("pendulum");
  tree->addLink("base");
  for (int i = 1; i <= links; ++i) {
    const std::string name = fmt::format("link{}", i), before = i == 1 ? "base" : fmt::format("link{}", i - 1);
    tree->addLink(name);
    tree->addJoint(Joint::revolute(fmt::format("joint{}", i), before, name, Eigen::Vector3d::UnitZ(),
                                   along({i == 1 ? 0 : length, 0, 0}), -3, 3));
  }
  World world;
  world.name = fmt::format("pendulum, {} boxes", boxes);
  world.hold(tree);
  for (int i = 1; i <= links; ++i) {
    world.bind(i, fcl::Boxd(length, kWidth, kWidth), along({0.5 * length, 0, 0}));
  }
  Random random(seed);
  for (int i = 0; i < boxes;) {
    const Eigen::Vector3d at(random.uniform(-kReach, kReach), random.uniform(-kReach, kReach), 0);
    const double a = random.uniform(0.05, 0.15), b = random.uniform(0.05, 0.15), yaw = random.uniform(-kPi, kPi);
    if (at.norm() < kFreeOfBase + 0.5 * (a + b) || at.norm() > kReach) continue;
    world.addBox({a, b, 0.1}, at, yaw);
    ++i;
  }
  world.setUp();
  return world;
}

/// Two arms of seven joints, of the size of a KUKA iiwa, 0.5 m apart before a shelf, on a table: what is bundled.
World makeTwoArms() {
  auto tree = std::make_shared<KinematicTree>("two_arms");
  tree->addLink("world");
  constexpr double kLengths[] = {0.21, 0.21, 0.21, 0.2, 0.2, 0.1, 0.15}, kRadius = 0.05;
  for (const char* side : {"left", "right"}) {
    std::string before = "world";
    for (int i = 0; i < 7; ++i) {
      const std::string name = fmt::format("{}{}", side, i + 1);
      tree->addLink(name);
      const double y = side[0] == 'l' ? 0.25 : -0.25;
      const Eigen::Isometry3d origin = i == 0 ? along({0, y, 0.15}) : along({0, 0, kLengths[i - 1]});
      const double limit = i % 2 ? 2.09 : 2.96;
      tree->addJoint(Joint::revolute(fmt::format("{}_joint{}", side, i + 1), before, name,
                                     i % 2 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ(), origin, -limit,
                                     limit));
      before = name;
    }
  }
  World world;
  world.name = "two arms, shelf (bundled)";
  world.hold(tree);
  for (const char* side : {"left", "right"}) {
    for (int i = 0; i < 7; ++i) {
      const LinkId link = tree->linkId(fmt::format("{}{}", side, i + 1));
      const Eigen::Isometry3d middle = along({0, 0, 0.5 * kLengths[i]});
      if (i < 6) {
        world.bind(link, fcl::Capsuled(kRadius, kLengths[i] - 0.02), middle);
      } else {
        world.bind(link, fcl::Boxd(0.146, 0.05, kLengths[i]), along({0, 0, 0.5 * kLengths[i] + 0.06}));
      }
    }
  }
  world.addBox({2.5, 2.5, 0.2}, {0.4, 0, -0.11});
  for (const double y : {-0.3, 0.3}) world.addBox({0.3, 0.016, 0.8}, {0.75, y, 0.42});
  for (const double z : {0.05, 0.3, 0.55, 0.8}) world.addBox({0.3, 0.58, 0.016}, {0.75, 0, z});
  for (const double y : {-0.85, 0.85}) {
    for (const double x : {-0.25, 0.25}) world.addBox({0.05, 0.5, 0.21}, {x, y, 0.1});
  }
  world.setUp();
  return world;
}

#ifdef FCL_ARTIC_HAS_URDF
/// Two KUKA iiwa with grippers in the cell of the rival's authors (RobotLocomotion/gcs-science-robotics): shelves, bins
/// and a table on which both stand.
World makeDualIiwa(const std::filesystem::path& data) {
  const std::filesystem::path folder = data / "robots" / "dual_iiwa";
  const Robot robot = loadUrdf((folder / "dual_iiwa.urdf").string());
  const Scene cell = loadScene((folder / "cell.urdf").string());
  World world;
  world.name = "dual iiwa in its cell";
  world.hold(robot.tree);
  robot.addTo(*world.manager);
  cell.addTo(*world.manager);
  for (const LinkGeometry& g : robot.geometry) world.objects.push_back(g.object);
  for (const Scene::Obstacle& o : cell.obstacles) world.objects.push_back(o.object);
  world.setUp();
  const LinkPairReport report = world.manager->classifyLinkPairs();
  AllowedCollisionMatrix allowed = report.needNoCheck();
  for (const Scene::Obstacle& o : cell.obstacles) {  // both stand on the table, exactly
    if (o.name.find("table") == std::string::npos) continue;
    for (const char* base : {"iiwa_1::iiwa_link_0", "iiwa_2::iiwa_link_0"}) allowed.allow(base, o.name);
  }
  world.manager->setAllowedCollisions(allowed);
  world.manager->setLinkPairProofs(report.proofs);
  world.setUp();
  return world;
}
#endif

struct Edge {
  Eigen::VectorXd q0, q1;
};

/// Edges with free ends: q0 anywhere within `within` of the joints' limits, each joint of q1 at most `step` away.
/// @param bent  limits of all joints but the first, rad.
std::vector<Edge> drawEdges(const World& world, std::size_t count, double within, double bent, double step,
                            std::uint64_t seed) {
  const KinematicTree& tree = *world.tree;
  Random random(seed);
  std::vector<Edge> edges;
  const Eigen::Index n = tree.dof();
  for (std::size_t tried = 0; edges.size() < count; ++tried) {
    if (tried > 2000 * count) throw std::runtime_error(world.name + ": hardly any configuration is free");
    Edge edge{Eigen::VectorXd(n), Eigen::VectorXd(n)};
    for (Eigen::Index v = 0; v < n; ++v) {
      const double most = std::min(within * tree.joint(tree.variableJoint(static_cast<int>(v))).upper, v ? bent : 10.0);
      edge.q0[v] = random.uniform(-most, most);
      edge.q1[v] = std::clamp(edge.q0[v] + random.uniform(-step, step), -most, most);
    }
    if (world.free(edge.q0) && world.free(edge.q1)) edges.push_back(std::move(edge));
  }
  return edges;
}

/// What became of the edges of one row.
struct Decided {
  std::size_t free = 0, contact = 0, uncertain = 0, undecided = 0;
};

class Bench {
 public:
  Bench(Report& report, std::size_t edges, int passes) : report_(report), edges_(edges), passes_(passes) {}

  /// @param theirs  what the paper prints for that work; empty: nothing.
  void add(const World& world, const std::string& set, double size, const std::vector<Edge>& edges,
           const std::string& theirs) {
    std::vector<JointMotion> tangents, straight;
    for (const Edge& edge : edges) {
      tangents.push_back(JointMotion::tangentHalfAngle(*world.tree, edge.q0, edge.q1));
      straight.push_back(JointMotion::linear(*world.tree, edge.q0, edge.q1));
    }
    const auto ask = [&](const std::vector<JointMotion>& motions, ContactMode mode) {
      return [&world, &motions, mode](std::size_t i) -> Answer {
        CertifiedRequest request;
        request.mode = mode;
        static thread_local CertifiedResult result;
        world.manager->continuousCollide(motions[i], request, result);
        return result.isFree() ? kFree : result.t_lower;
      };
    };
    const char* const names[] = {"tangent law, first contact", "tangent law, any contact", "straight, first contact"};
    const std::vector<Measured> all = measureInTurns(
        edges.size(), passes_,
        {ask(tangents, ContactMode::first), ask(tangents, ContactMode::any), ask(straight, ContactMode::first)});
    for (std::size_t way = 0; way < all.size(); ++way) {
      Row row = all[way].row;
      row.scene = world.name;
      row.set = set;
      row.method = names[way];
      row.size = size;
      const Decided decided =
          count(world, way == 2 ? straight : tangents, way == 1 ? ContactMode::any : ContactMode::first);
      const double n = static_cast<double>(edges.size());
      row.per_query = {{"certified_free", static_cast<double>(decided.free) / n},
                       {"contact_proven", static_cast<double>(decided.contact) / n},
                       {"uncertain", static_cast<double>(decided.uncertain) / n},
                       {"undecided", static_cast<double>(decided.undecided) / n}};
      csv_ += fmt::format("\"{}\",\"{}\",{:g},\"{}\",{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.1f},\"{}\"\n", row.scene,
                          set, size, row.method, edges.size(), decided.free, decided.contact, decided.uncertain,
                          decided.undecided, row.median_us, row.mean_us, row.max_us, world.setup_ms,
                          way == 2 ? "" : theirs);
      undecided_ += decided.undecided + decided.uncertain;
      asked_ += edges.size();
      report_.addRow(std::move(row));
    }
  }

  void finish() {
    report_.write("bench_rival.csv", csv_);
    report_.note(fmt::format("{} edges asked for; {} neither proven free nor in proven contact", asked_, undecided_));
    report_.note(
        "in print (Amice, Werner, Tedrake): 0.299 s an edge of two arms; of pendulums' edges 98 % certified with "
        "2 links, 20 % with 12");
  }
  std::size_t edges() const { return edges_; }

 private:
  static Decided count(const World& world, const std::vector<JointMotion>& motions, ContactMode mode) {
    Decided decided;
    CertifiedRequest request;
    request.mode = mode;
    for (const JointMotion& motion : motions) {
      const CertifiedResult result = world.manager->continuousCollide(motion, request);
      if (result.status == Status::undecided) {
        ++decided.undecided;
      } else if (result.isFree()) {
        ++decided.free;
      } else {
        ++(result.certain ? decided.contact : decided.uncertain);
      }
    }
    return decided;
  }

  Report& report_;
  std::size_t edges_;
  int passes_;
  std::string csv_ =
      "scene,set,size,method,edges,certified_free,contact_proven,uncertain,undecided,median_us,mean_us,"
      "max_us,setup_ms,in_print\n";
  std::size_t asked_ = 0, undecided_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Report report("bench_rival");
  CLI::App app("Edges straight in the tangents of half angles, as the certified rival's: pendulums, two arms");
  std::size_t count = 200;
  int passes = 3;
  std::uint64_t seed = 1;
  double step = 0.3;
  std::vector<int> links = {2, 3, 4, 6, 8, 10, 12, 15}, boxes = {10, 50, 100};
  std::vector<double> arm_steps = {0.1, 0.5};
  app.add_option("--edges", count, "edges of each row")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--passes", passes, "passes over the edges at least; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", seed, "of scenes and edges")->capture_default_str();
  app.add_option("--links", links, "of pendulums; none: no pendulums")->expected(0, -1)->capture_default_str();
  app.add_option("--boxes", boxes, "amid which they swing")->capture_default_str();
  app.add_option("--step", step, "each joint of a pendulum turns by at most this, rad")->capture_default_str();
  app.add_option("--arm-steps", arm_steps, "each joint of two arms turns by at most these, rad; none: no arms")
      ->expected(0, -1)
      ->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;

  Bench bench(report, count, passes);
  try {
    for (const int n : links) {
      for (const int m : boxes) {
        const World world = makePendulum(n, m, seed + static_cast<std::uint64_t>(1000 * n + m));
        const double bent = 3.5 / std::sqrt(static_cast<double>(n));  // long ones would lie across themselves
        bench.add(world, fmt::format("{} links", n), n, drawEdges(world, count, 0.95, bent, step, seed),
                  n == 2    ? "98 % certified"
                  : n == 12 ? "20 % certified"
                            : "");
      }
    }
    const auto addArms = [&](const World& world) {
      for (const double most : arm_steps) {
        bench.add(world, fmt::format("{:g} rad", most), most, drawEdges(world, count, 0.8, 10, most, seed),
                  "0.299 s an edge");
      }
    };
    if (!arm_steps.empty()) addArms(makeTwoArms());
#ifdef FCL_ARTIC_HAS_URDF
    const char* data = std::getenv("FCL_ARTIC_DATA");
    if (!arm_steps.empty() && data && std::filesystem::exists(std::filesystem::path(data) / "robots/dual_iiwa")) {
      addArms(makeDualIiwa(data));
    } else if (!arm_steps.empty()) {
      report.note("no dual iiwa: FCL_ARTIC_DATA does not name a folder with robots/dual_iiwa");
    }
#endif
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_rival: {}\n", error.what());
    return 1;
  }
  bench.finish();
  return report.finish();
}
