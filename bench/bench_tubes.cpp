// SPDX-License-Identifier: BSD-3-Clause
//
// What tolerances of joints cost a robot that checks itself: edges that are lost by one margin for all pairs, by a
// margin for each pair, and by the manager's tolerances, where all three cover the same errors of the joints; a free
// edge and set-up, with tolerances over without. FCL_ARTIC_DATA names the folder with robots/, problems/ and edges/.
//
// The margin for all pairs is the largest way of any point that is seen at configurations drawn within the joints'
// limits. Those of pairs, and of links against the world, are the largest bound M (doc/NUMERICS.md, section 14) there.
// A proof by margins needs at least these. Pairs of neighbours without an entry in the SRDF keep no uniform margin, as
// CertifiedRequest::margin has it.
//
// Exit status 1 when a configuration within the tolerances of an edge called free touches.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fmt/format.h>

#include "options.h"
#include "planning/problems.h"
#include "random_motion.h"
#include "setup_cost.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using namespace fcl_artic::planning_data;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using LinkNames = std::pair<std::string, std::string>;

struct Options {
  std::vector<std::string> robots{"panda", "ur5", "fanuc_m10ia"};
  std::string environment = "table_pick";
  double degrees = 0.3, length = 2.7;
  std::size_t edges = 20000, timed = 2000, samples = 2000, scenes = 10;
  int passes = 6, setups = 15;
  unsigned seed = 1;
};

/// Points whose convex hull holds a geometry, in its own frame.
std::vector<Vector3d> pointsOf(const fcl::CollisionObjectd& object) {
  const fcl::CollisionGeometryd& geometry = *object.collisionGeometry();
  std::vector<Vector3d> points;
  if (const auto* const mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(&geometry)) {
    points.assign(mesh->vertices, mesh->vertices + mesh->num_vertices);
    const auto less = [](const Vector3d& a, const Vector3d& b) {
      return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    };
    std::sort(points.begin(), points.end(), less);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
  }
  for (int corner = 0; corner < 8; ++corner) {  // of a shape's box
    points.emplace_back((corner & 1 ? geometry.aabb_local.max_ : geometry.aabb_local.min_).x(),
                        (corner & 2 ? geometry.aabb_local.max_ : geometry.aabb_local.min_).y(),
                        (corner & 4 ? geometry.aabb_local.max_ : geometry.aabb_local.min_).z());
  }
  return points;
}

/// How far errors of the joints that turn, `angle` each, move links against each other: the bound M at a configuration.
class Levers {
 public:
  Levers(const Robot& robot, double angle) : tree_(*robot.tree), angle_(angle) {
    std::map<LinkId, std::vector<Vector3d>> points;
    for (const LinkGeometry& geometry : robot.geometry) {
      for (const Vector3d& p : pointsOf(*geometry.object)) points[geometry.link].push_back(geometry.offset * p);
    }
    for (const auto& [link, all] : points) {
      Eigen::Matrix3Xd& columns = points_[link] = Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(all.size()));
      for (std::size_t i = 0; i < all.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = all[i];
      outer_[link] = outermost(columns);
    }
    for (JointId j = 0; j < tree_.numJoints(); ++j) {
      if (turns(j)) joints_.push_back(j);
    }
  }

  const std::map<LinkId, Eigen::Matrix3Xd>& points() const { return points_; }
  const std::vector<JointId>& joints() const { return joints_; }

  void moveTo(const VectorXd& q) {
    tree_.forwardKinematics(q, poses_);
    for (const JointId j : joints_) {
      const Joint& joint = tree_.joint(j);
      const Eigen::Isometry3d at = poses_[static_cast<std::size_t>(tree_.linkId(joint.parent))] * joint.origin;
      for (const auto& [link, points] : points_) {
        const Eigen::Isometry3d back = poses_[static_cast<std::size_t>(link)].inverse() * at;
        const Vector3d axis = back.linear() * joint.axis.normalized();
        const Eigen::Matrix3Xd r = points.colwise() - back.translation();
        const double square = (r.colwise().squaredNorm() - (axis.transpose() * r).cwiseAbs2()).maxCoeff();
        stray_[{j, link}] = 2 * std::sin(0.5 * angle_) * std::sqrt(std::max(0.0, square));
      }
    }
  }

  /// @param b  below 0: the world.
  double between(LinkId a, LinkId b) const {
    std::vector<JointId> path = joints(a), other;
    if (b < 0) return sum(path, 0, path.size(), a);
    other = joints(b);
    while (!path.empty() && !other.empty() && path.back() == other.back()) {
      path.pop_back();
      other.pop_back();
    }
    path.insert(path.end(), other.rbegin(), other.rend());
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m <= path.size(); ++m)
      least = std::min(least, sum(path, 0, m, a) + sum(path, m, path.size(), b));
    return least;
  }

  /// The largest way of a point of any link where all joints are off by their tolerance, over their signs. (A flip of
  /// all signs changes it by no more than the square of the angle.)
  double largestWay(const VectorXd& q) const {
    std::vector<Eigen::Isometry3d> exact, off;
    tree_.forwardKinematics(q, exact);
    double most = 0;
    for (unsigned signs = 0; signs < 1u << (joints_.size() - 1); ++signs) {
      VectorXd moved = q;
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        moved[tree_.jointVariable(joints_[i])] += signs >> i & 1 ? angle_ : -angle_;
      }
      tree_.forwardKinematics(moved, off);
      for (const auto& [link, points] : outer_) {
        const Eigen::Isometry3d& a = exact[static_cast<std::size_t>(link)];
        const Eigen::Isometry3d& b = off[static_cast<std::size_t>(link)];
        const Eigen::Matrix3d turn = b.linear() - a.linear();
        const Vector3d way = b.translation() - a.translation();
        most = std::max(most, ((turn * points).colwise() + way).colwise().squaredNorm().maxCoeff());
      }
    }
    return std::sqrt(most);
  }

 private:
  /// The points that are farthest in one of 200 directions, spread by the golden angle.
  static Eigen::Matrix3Xd outermost(const Eigen::Matrix3Xd& points) {
    std::set<Eigen::Index> farthest;
    for (int i = 0; i < 200; ++i) {
      const double z = (i + 0.5) / 100 - 1, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
      Eigen::Index at = 0;
      (Eigen::RowVector3d(r * std::cos(turn), r * std::sin(turn), z) * points).maxCoeff(&at);
      farthest.insert(at);
    }
    Eigen::Matrix3Xd outer(3, static_cast<Eigen::Index>(farthest.size()));
    Eigen::Index column = 0;
    for (const Eigen::Index at : farthest) outer.col(column++) = points.col(at);
    return outer;
  }
  bool turns(JointId j) const {
    const Joint& joint = tree_.joint(j);
    return !joint.mimics && (joint.type == JointType::revolute || joint.type == JointType::continuous);
  }
  /// From the link up.
  std::vector<JointId> joints(LinkId link) const {
    std::vector<JointId> path;
    for (; tree_.parentJoint(link) >= 0; link = tree_.parentLink(link)) {
      if (turns(tree_.parentJoint(link))) path.push_back(tree_.parentJoint(link));
    }
    return path;
  }
  double sum(const std::vector<JointId>& path, std::size_t begin, std::size_t end, LinkId link) const {
    double all = 0;
    for (std::size_t i = begin; i < end; ++i) all += stray_.at({path[i], link});
    return all;
  }

  const KinematicTree& tree_;
  const double angle_;
  std::map<LinkId, Eigen::Matrix3Xd> points_, outer_;
  std::vector<JointId> joints_;
  std::vector<Eigen::Isometry3d> poses_;
  std::map<std::pair<JointId, LinkId>, double> stray_;  ///< largest way of the link's points by the joint's error
};

struct Margins {
  double seen = 0;                      ///< m, the largest way of a point
  double bound = 0;                     ///< m, of a link against the world
  std::map<std::string, double> links;  ///< m, of each against the world
  std::map<LinkNames, double> pairs;    ///< m, by checkedLinkPairs()
};

VectorXd anyConfiguration(const KinematicTree& tree, std::mt19937& random) {
  VectorXd q = tree.neutralConfiguration();
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    if (tree.isAngle(v)) q[v] = std::uniform_real_distribution<double>(joint.lower, joint.upper)(random);
  }
  return q;
}

Margins marginsOf(Levers& levers, const KinematicTree& tree, const std::vector<LinkNames>& pairs, const Options& o) {
  std::mt19937 random(o.seed);
  Margins margins;
  for (std::size_t i = 0; i < o.samples; ++i) {
    const VectorXd q = anyConfiguration(tree, random);
    levers.moveTo(q);
    margins.seen = std::max(margins.seen, levers.largestWay(q));
    for (const auto& entry : levers.points()) {
      double& most = margins.links[tree.linkName(entry.first)];
      most = std::max(most, levers.between(entry.first, -1));
      margins.bound = std::max(margins.bound, most);
    }
    for (const LinkNames& pair : pairs) {
      double& most = margins.pairs[pair];
      most = std::max(most, levers.between(tree.linkId(pair.first), tree.linkId(pair.second)));
    }
  }
  return margins;
}

/// Ways to cover the joints' errors.
enum Way { kNot, kByPairs, kByTube, kWays };
using Managers = std::array<std::unique_ptr<ArticulatedCollisionManager>, kWays>;

void cover(ArticulatedCollisionManager& manager, Way way, double angle, const Margins& margins) {
  if (way == kByTube) manager.setJointTolerances({angle, 0});
  if (way != kByPairs) return;
  for (const auto& [link, margin] : margins.links) manager.setMargin(link, margin);
  for (const auto& [pair, margin] : margins.pairs) manager.setMargin(pair.first, pair.second, margin);
}

std::unique_ptr<ArticulatedCollisionManager> managerOf(const Robot& robot, Way way, double angle,
                                                       const Margins& margins = {}) {
  auto manager = std::make_unique<ArticulatedCollisionManager>(robot.tree);
  robot.addTo(*manager);
  cover(*manager, way, angle, margins);
  manager->setup();
  return manager;
}

CertifiedRequest question(double margin = 0) {
  CertifiedRequest request;  // a planner's
  request.mode = ContactMode::any;
  request.max_contacts = 1;
  request.tolerance_distance = 1e-5;
  request.margin = margin;
  return request;
}

JointMotion edge(const KinematicTree& tree, double length, std::mt19937& random) {
  std::vector<std::string> names;
  for (int v = 0; v < tree.dof(); ++v) {
    if (tree.isAngle(v)) names.push_back(tree.variableName(v));
  }
  for (bool within = false;;) {
    const Ends ends = randomEnds(tree, names, length, random, within);
    if (!within) continue;
    VectorXd q0 = tree.neutralConfiguration(), q1 = q0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      q0[tree.findVariable(names[i])] = ends.from[i];
      q1[tree.findVariable(names[i])] = ends.to[i];
    }
    return JointMotion::linear(tree, q0, q1);
  }
}

/// Edges that one way of covering the errors does not prove free.
struct Lost {
  std::size_t count = 0;
  std::map<LinkNames, std::size_t> by;
  /// @return whether it is free.
  bool ask(const ArticulatedCollisionManager& manager, const JointMotion& motion, const CertifiedRequest& request) {
    CertifiedResult result;
    manager.continuousCollide(motion, request, result);
    if (result.isFree()) return true;
    ++count;
    if (const CertifiedContact* const c = result.first()) ++by[std::minmax(c->body1.name, c->body2.name)];
    return false;
  }
  /// The pair that most of them are lost by.
  const std::pair<const LinkNames, std::size_t>& most() const {
    const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
    return *std::max_element(by.begin(), by.end(), less);
  }
};

/// A configuration at a random time of the motion, each joint off by its tolerance or less.
VectorXd within(const KinematicTree& tree, const JointMotion& motion, double angle, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  VectorXd q = motion.configuration(unit(random));
  for (int v = 0; v < tree.dof(); ++v) {
    if (tree.isAngle(v)) q[v] += angle * std::clamp(6 * unit(random) - 3, -1.0, 1.0);
  }
  return q;
}

/// An edge, and who is asked about it.
struct Timed {
  const Managers* managers;
  JointMotion motion;
  bool isFreeByAll() const {
    const auto isFree = [&](const auto& manager) { return manager->isFree(motion, question()); };
    return std::all_of(managers->begin(), managers->end(), isFree);
  }
};

/// Times of edges that are free whichever way errors are covered, by turns.
void compareTimes(const std::string& name, const std::vector<Timed>& edges, int passes, std::string& table) {
  CertifiedResult result;
  const CertifiedRequest request = question();
  std::vector<std::function<Answer(std::size_t)>> ways;
  for (int way = 0; way < kWays; ++way) {
    ways.emplace_back([&, way](std::size_t i) -> Answer {
      (*edges[i].managers)[static_cast<std::size_t>(way)]->continuousCollide(edges[i].motion, request, result);
      if (!result.isFree()) throw std::runtime_error("an edge that was free is not");
      return 2;
    });
  }
  const std::vector<Measured> measured = measureInTurns(edges.size(), passes, ways);
  const Measured& without = measured[kNot];
  table +=
      fmt::format("{:<24} {:>6} {:>8.2f} {:>8.2f}", name, edges.size(), without.row.median_us, without.row.mean_us);
  for (const Way way : {kByTube, kByPairs}) {
    const Measured& with = measured[way];
    std::vector<double> ratios;
    for (std::size_t i = 0; i < edges.size(); ++i) ratios.push_back(with.us[i] / without.us[i]);
    table += fmt::format(" {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f}", rank(ratios, 0.5),
                         with.row.median_us / without.row.median_us, with.row.mean_us / without.row.mean_us,
                         rank(ratios, 0.9), rank(ratios, 0.99));
  }
  table += '\n';
}

/// What the three tables are made of.
struct Tables {
  std::string losses, times, setups;
  std::size_t touched = 0;  ///< configurations that should not
};

void measureSetups(const Robot& robot, const std::string& name, double angle, int count, std::string& table) {
  std::vector<double> ms[2];
  for (int i = 0; i < count; ++i) {
    for (const bool with : {false, true}) {
      const auto begin = Clock::now();
      const auto manager = managerOf(robot, with ? kByTube : kNot, angle);
      ms[with].push_back(1e-3 * microsecondsSince(begin));
    }
  }
  table += fmt::format("{:<30} {:>12.1f} {:>9.1f} {:>12.2f} {:>10.1f} {:>9.1f} {:>10.2f}\n", name, rank(ms[0], 0.5),
                       rank(ms[1], 0.5), rank(ms[1], 0.5) / rank(ms[0], 0.5), rank(ms[0], 0), rank(ms[1], 0),
                       rank(ms[1], 0) / rank(ms[0], 0));
}

/// Edges in scenes that the robot stands in: those of its own problems, else the Panda's.
void timeInScenes(const std::filesystem::path& data, const std::string& name, const Robot& robot, const Managers& alone,
                  double angle, const Margins& margins, const Options& o, std::string& table) {
  std::filesystem::path path = problemsPath(data, name, o.environment);
  const bool own = std::filesystem::exists(path);
  const Robot panda = readRobot(data, "panda");
  if (!own) path = problemsPath(data, "panda", o.environment);
  const Environment environment = readEnvironment(path, own ? *robot.tree : *panda.tree);
  std::vector<Managers> scenes(std::min(o.scenes, environment.problems.size()));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (std::size_t way = 0; way < kWays; ++way) {
      scenes[i][way] = std::make_unique<ArticulatedCollisionManager>(alone[kNot]->shareRobot());
      environment.problems[i].scene.addTo(*scenes[i][way]);
      cover(*scenes[i][way], static_cast<Way>(way), angle, margins);
      scenes[i][way]->setup();
    }
  }
  std::mt19937 random(o.seed + 1);
  std::vector<Timed> edges;
  for (std::size_t tries = 0; edges.size() < o.timed && tries < 1000 * o.timed; ++tries) {
    const Timed timed{&scenes[tries % scenes.size()], edge(*robot.tree, o.length, random)};
    if (timed.isFreeByAll()) edges.push_back(timed);
  }
  compareTimes(name + " " + o.environment, edges, o.passes, table);
}

void measureRobot(const std::filesystem::path& data, const std::string& name, const Options& o, Tables& tables) {
  const Robot robot = readRobot(data, name);
  const KinematicTree& tree = *robot.tree;
  const double angle = o.degrees * std::acos(-1.0) / 180;
  measureSetups(robot, name, angle, o.setups, tables.setups);

  Managers managers;
  managers[kNot] = managerOf(robot, kNot, angle);
  Levers levers(robot, angle);
  const Margins margins = marginsOf(levers, tree, managers[kNot]->checkedLinkPairs(), o);
  managers[kByPairs] = managerOf(robot, kByPairs, angle, margins);
  managers[kByTube] = managerOf(robot, kByTube, angle);

  std::mt19937 random(o.seed);
  Lost by_uniform, by_pairs, by_tube;
  std::vector<Timed> timed;
  std::size_t edges = 0, asked = 0;
  for (; edges < o.edges; ++asked) {
    const Timed one{&managers, edge(tree, o.length, random)};
    if (!managers[kNot]->isFree(one.motion, question())) continue;
    ++edges;
    by_uniform.ask(*managers[kNot], one.motion, question(margins.seen));
    by_pairs.ask(*managers[kByPairs], one.motion, question());
    if (!by_tube.ask(*managers[kByTube], one.motion, question())) continue;
    if (timed.size() < o.timed && one.isFreeByAll()) timed.push_back(one);
    for (int k = 0; k < 4; ++k) {
      const VectorXd q = within(tree, one.motion, angle, random);
      tables.touched += !managers[kNot]->collide(q, question()).isFree();
    }
  }
  const auto share = [&](const Lost& lost) {
    return 100 * static_cast<double>(lost.count) / static_cast<double>(edges);
  };
  tables.losses +=
      fmt::format("{:<12} {:>9.1f} {:>9.1f} {:>8} {:>9.2f} % {:>9.2f} % {:>9.2f} % {:>12.2f}\n", name,
                  1000 * margins.seen, 1000 * margins.bound, edges, share(by_uniform), share(by_pairs), share(by_tube),
                  static_cast<double>(by_tube.count) / static_cast<double>(by_pairs.count));
  for (const auto& [way, lost] : {std::pair("uniform", &by_uniform), {"pairs", &by_pairs}, {"tube", &by_tube}}) {
    if (lost->by.empty()) continue;
    const auto& [pair, count] = lost->most();
    const auto found =
        margins.pairs.count(pair) ? margins.pairs.find(pair) : margins.pairs.find({pair.second, pair.first});
    tables.losses += fmt::format("   {}: {} by {} and {}, which need {:.1f} mm\n", way, count, pair.first, pair.second,
                                 1000 * found->second);
  }
  tables.losses += fmt::format("   {} of {} edges are free\n", edges, asked);
  compareTimes(name, timed, o.passes, tables.times);
  timeInScenes(data, name, robot, managers, angle, margins, o, tables.times);
}

}  // namespace

int main(int argc, char** argv) try {
  Report report("bench_tubes");
  CLI::App app("What tolerances of joints cost: edges lost, times of free edges and of set-up (FCL_ARTIC_DATA)");
  Options o;
  app.add_option("--robots", o.robots, "folders of FCL_ARTIC_DATA/robots")->capture_default_str();
  app.add_option("--degrees", o.degrees, "tolerance of each joint that turns")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--length", o.length, "of a random edge, rad")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--edges", o.edges, "that do not touch the robot itself")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--timed", o.timed, "of these, and as many in scenes")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--samples", o.samples, "configurations that margins are the largest of")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--environment", o.environment, "of the problems whose scenes are taken")->capture_default_str();
  app.add_option("--scenes", o.scenes, "at most")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--passes", o.passes, "over timed edges; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--setups", o.setups, "of each kind")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--seed", o.seed)->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;
  const std::filesystem::path data = sharedData();
  if (data.empty()) {
    std::cout << "bench_tubes skipped: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return 0;
  }
  Tables tables;
  for (const std::string& robot : o.robots) measureRobot(data, robot, o, tables);
  std::string text = fmt::format("bench_tubes\n{}\n\n", circumstances());
  text += fmt::format("{} degrees a joint; edges of {} rad that are free of self contact, and not proven so any more\n",
                      o.degrees, o.length);
  text += fmt::format("{:<12} {:>9} {:>9} {:>8} {:>11} {:>11} {:>11} {:>12}\n", "robot", "seen, mm", "bound, mm",
                      "edges", "uniform", "pairs", "tube", "tube/pairs");
  text += tables.losses;
  text += "\nfree edges: us without tolerances; ratios with them, then with margins of pairs\n";
  text += fmt::format("{:<24} {:>6} {:>8} {:>8}", "", "edges", "median", "mean");
  for (int way = 0; way < 2; ++way) {
    text += fmt::format(" {:>8} {:>8} {:>8} {:>8} {:>8}", "median", "medians", "means", "90 %", "99 %");
  }
  text += '\n' + tables.times;
  text += fmt::format("\nset-up of the robot, ms: without and with tolerances\n{:<30} {:>22} {:>12} {:>20} {:>10}\n",
                      "", "median", "ratio", "least", "ratio");
  text += tables.setups;
  text += fmt::format("\nconfigurations within the tolerances of edges called free that touch: {}\n", tables.touched);
  std::cout << text;
  report.write("bench_tubes.txt", text);
  return tables.touched ? 1 : 0;
} catch (const std::exception& error) {
  std::cerr << "bench_tubes: " << error.what() << '\n';
  return 1;
}
