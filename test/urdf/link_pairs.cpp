// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of links that classifyLinkPairs() calls "never", against FCL. Each is sampled within the joints' limits, mostly
// near the closest poses that a search with FCL's distances finds; none may touch. Beside it: pairs by kind, the time,
// and what sampling as MoveIt's assistant does it takes and says.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <list>
#include <random>
#include <set>

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <CLI/CLI.hpp>

#include "fcl_artic/urdf/urdf.h"
#include "random_tree.h"

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::VectorXd;

namespace {

struct Options {
  std::vector<std::string> robots;
  int trees = 0;
  std::uint64_t seed = 1;
  long samples = 10000;
  int threads = 0;
  long moveit_samples = 10000;
  bool spoil = false;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Two links by FCL alone. They are placed in the frame of their nearest common ancestor, and shapes whose spheres
/// about FCL's own boxes are apart are not asked.
class Judge {
 public:
  Judge(const Robot& robot, const std::string& link1, const std::string& link2) : tree_(*robot.tree) {
    std::vector<JointId> path1 = pathTo(tree_.linkId(link1)), path2 = pathTo(tree_.linkId(link2));
    std::size_t shared = 0;
    while (shared < path1.size() && shared < path2.size() && path1[shared] == path2[shared]) ++shared;
    path1.erase(path1.begin(), path1.begin() + static_cast<std::ptrdiff_t>(shared));
    path2.erase(path2.begin(), path2.begin() + static_cast<std::ptrdiff_t>(shared));
    for (const auto* path : {&path1, &path2}) {
      for (const JointId j : *path) {
        if (tree_.joint(j).type != JointType::fixed) variables_.insert(tree_.jointVariable(j));
      }
    }
    of1_ = {path1, shapesOf(robot, link1)};
    of2_ = {path2, shapesOf(robot, link2)};
  }

  bool touch(const VectorXd& q) {
    return anyPair(q, true, [](const auto* g1, const Isometry3d& M1, const auto* g2, const Isometry3d& M2) {
      fcl::CollisionResultd result;
      return fcl::collide(g1, M1, g2, M2, fcl::CollisionRequestd(), result) > 0;
    });
  }
  /// FCL's distance, or that of the middles where it has none for these two.
  double distance(const VectorXd& q) {
    double least = 1e9;
    anyPair(q, false, [&](const auto* g1, const Isometry3d& M1, const auto* g2, const Isometry3d& M2) {
      fcl::DistanceResultd result;
      fcl::DistanceRequestd request;
      least = std::min(least, fcl::distance(g1, M1, g2, M2, request, result));
      return false;
    });
    return least;
  }
  const std::set<int>& variables() const { return variables_; }

 private:
  struct Shape {
    const fcl::CollisionGeometryd* geometry;
    Isometry3d offset;
  };
  struct Side {
    std::vector<JointId> path;  // from the common ancestor to the link
    std::vector<Shape> shapes;
  };

  std::vector<JointId> pathTo(LinkId link) const {
    std::vector<JointId> path;
    for (JointId j = tree_.parentJoint(link); j >= 0; j = tree_.parentJoint(tree_.linkId(tree_.joint(j).parent))) {
      path.insert(path.begin(), j);
    }
    return path;
  }
  std::vector<Shape> shapesOf(const Robot& robot, const std::string& link) const {
    std::vector<Shape> shapes;
    for (const LinkGeometry& g : robot.geometry) {
      if (tree_.linkName(g.link) == link) shapes.push_back({g.object->collisionGeometry().get(), g.offset});
    }
    return shapes;
  }
  Isometry3d place(const Side& side, const VectorXd& q) const {
    Isometry3d M = Isometry3d::Identity();
    for (const JointId j : side.path) {
      M = M * tree_.joint(j).origin;
      if (tree_.joint(j).type != JointType::fixed) M = M * tree_.jointPose(j, q);
    }
    return M;
  }
  template <class F>
  bool anyPair(const VectorXd& q, bool near_only, const F& f) const {
    const Isometry3d M1 = place(of1_, q), M2 = place(of2_, q);
    for (const Shape& a : of1_.shapes) {
      const Isometry3d Ma = M1 * a.offset;
      const Eigen::Vector3d middle = Ma * a.geometry->aabb_center;
      for (const Shape& b : of2_.shapes) {
        const Isometry3d Mb = M2 * b.offset;
        const double reach = 1.000001 * (a.geometry->aabb_radius + b.geometry->aabb_radius);
        if (near_only && (Mb * b.geometry->aabb_center - middle).norm() > reach) continue;
        if (f(a.geometry, Ma, b.geometry, Mb)) return true;
      }
    }
    return false;
  }
  const KinematicTree& tree_;
  Side of1_, of2_;
  std::set<int> variables_;
};

std::pair<double, double> rangeOf(const KinematicTree& tree, int v) {
  const Joint& joint = tree.joint(tree.variableJoint(v));
  if (hasLimits(joint)) return {joint.lower, joint.upper};
  return tree.isAngle(v) ? std::make_pair(-3.2, 3.2) : std::make_pair(0.0, 0.0);
}

/// Samples one pair; half of them about the closest poses known so far, ever nearer.
/// @return number that touch.
long sample(const KinematicTree& tree, Judge& judge, pairs::Random& random, long samples, double& closest) {
  std::vector<std::pair<double, double>> ranges(static_cast<std::size_t>(tree.dof()));
  for (const int v : judge.variables()) ranges[static_cast<std::size_t>(v)] = rangeOf(tree, v);
  VectorXd q = tree.neutralConfiguration();
  const auto draw = [&](const VectorXd* about, double reach) -> const VectorXd& {
    for (const int v : judge.variables()) {
      const auto& [lower, upper] = ranges[static_cast<std::size_t>(v)];
      q[v] = about ? std::clamp((*about)[v] + reach * random.uniform(-1, 1) * (upper - lower), lower, upper)
                   : random.uniform(lower, upper);
      if (random.chance(0.05)) q[v] = random.chance(0.5) ? lower : upper;
    }
    return q;
  };
  // Where they come nearest: some random starts, each followed.
  std::vector<VectorXd> nearest;
  closest = 1e9;
  const long starts = std::clamp(samples / 500, 3l, 30l);
  for (long s = 0; s < starts; ++s) {
    VectorXd best = draw(nullptr, 0);
    double least = judge.distance(best), reach = 0.3;
    for (int i = 0; i < 60; ++i) {
      const double d = judge.distance(draw(i < 10 ? nullptr : &best, reach));
      if (d < least) {
        least = d;
        best = q;
      } else if (i >= 10) {
        reach *= 0.9;
      }
    }
    closest = std::min(closest, least);
    nearest.push_back(best);
  }
  long touching = 0;
  for (long i = 0; i < samples; ++i) {
    const VectorXd* about = i % 4 == 0 ? nullptr : &nearest[static_cast<std::size_t>(i) % nearest.size()];
    touching += judge.touch(draw(about, 0.2 * std::pow(10, -3 * random.unit())));
  }
  return touching;
}

/// Pairs that never touched in so many random configurations, and the time for that.
std::set<std::pair<std::string, std::string>> neverAsMoveItSays(const Robot& robot, const LinkPairReport& report,
                                                                long samples, std::uint64_t seed) {
  const KinematicTree& tree = *robot.tree;
  pairs::Random random(seed);
  std::list<std::pair<Judge, const LinkPairFinding*>> open;
  for (const LinkPairFinding& pair : report.pairs) {
    open.emplace_back(Judge(robot, pair.link1, pair.link2), &pair);
  }
  for (long i = 0; i < samples; ++i) {
    VectorXd q = tree.neutralConfiguration();
    for (int v = 0; v < tree.dof(); ++v) {
      if (KinematicTree::numVariables(tree.joint(tree.variableJoint(v)).type) != 1) continue;
      const auto [lower, upper] = rangeOf(tree, v);
      q[v] = random.uniform(lower, upper);
    }
    open.remove_if([&](auto& pair) { return pair.first.touch(q); });
  }
  std::set<std::pair<std::string, std::string>> never;
  for (const auto& pair : open) never.emplace(pair.second->link1, pair.second->link2);
  return never;
}

struct Sum {
  long never = 0, samples = 0, touching = 0;
};

void look(const Robot& robot, const Options& options, std::uint64_t seed, bool verbose, Sum& sum) {
  LinkPairOptions search;
  search.threads = options.threads;
  const double begin = seconds();
  LinkPairReport report = generateAllowedCollisions(robot, search);
  const double time = seconds() - begin;
  std::string moveit;
  if (verbose && options.moveit_samples > 0) {
    const double start = seconds();
    const auto never = neverAsMoveItSays(robot, report, options.moveit_samples, seed);
    const double sampling = seconds() - start;
    const auto other = neverAsMoveItSays(robot, report, options.moveit_samples, seed + 1);
    std::vector<std::pair<std::string, std::string>> unlike;
    std::set_symmetric_difference(never.begin(), never.end(), other.begin(), other.end(), std::back_inserter(unlike));
    long wrong = 0;
    for (const LinkPairFinding& pair : report.pairs) {
      wrong += pair.kind == LinkPairKind::sometimes && never.count({pair.link1, pair.link2});
    }
    char text[200];
    std::snprintf(text, sizeof text, "; %ld samples: %.2f s, never %zu, of which %ld touch, %zu differ by seed",
                  options.moveit_samples, sampling, never.size(), wrong, unlike.size());
    moveit = text;
  }
  pairs::Random random(seed);
  double closest_of_all = 1e9;
  long pairs_of_this = 0;
  for (const LinkPairFinding& pair : report.pairs) {
    const bool claimed = pair.kind == LinkPairKind::never || (options.spoil && pair.kind == LinkPairKind::sometimes);
    if (!claimed) continue;
    Judge judge(robot, pair.link1, pair.link2);
    double closest;
    const long touching = sample(*robot.tree, judge, random, options.samples, closest);
    closest_of_all = std::min(closest_of_all, closest);
    ++pairs_of_this;
    sum.samples += options.samples;
    sum.touching += touching;
    if (touching > 0 && !options.spoil) {
      std::printf("FAULT: %s: %s and %s are never to touch, and do in %ld samples\n", robot.tree->name().c_str(),
                  pair.link1.c_str(), pair.link2.c_str(), touching);
    }
    if (touching > 0 && options.spoil && pair.kind == LinkPairKind::sometimes) ++sum.never;
  }
  if (!options.spoil) sum.never += pairs_of_this;
  if (!verbose) return;
  std::printf("%-14s %zu pairs: never %zu, always %zu, sometimes %zu, unproven %zu; %.3f s%s; closest %.2g m\n",
              robot.tree->name().c_str(), report.pairs.size(), report.count(LinkPairKind::never),
              report.count(LinkPairKind::always), report.count(LinkPairKind::sometimes),
              report.count(LinkPairKind::unproven), time, moveit.c_str(), closest_of_all);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Pairs of links that are proven never to touch, sampled by FCL near their closest poses. Exit status 0: "
      "none touches; 1: one does; 2: wrong use."};
  Options options;
  app.add_option("robots", options.robots, "URDF files");
  app.add_option("--trees", options.trees, "and so many random trees")->capture_default_str();
  app.add_option("--seed", options.seed, "seed of trees and samples")->capture_default_str();
  app.add_option("--samples", options.samples, "samples of each pair")->capture_default_str();
  app.add_option("--threads", options.threads, "threads of the proof")->capture_default_str();
  app.add_option("--moveit", options.moveit_samples, "samples of all pairs, as MoveIt's assistant takes them; 0: none")
      ->capture_default_str();
  app.add_flag("--spoil", options.spoil,
               "take pairs that touch sometimes for such that never do: how many are noticed");
  CLI11_PARSE(app, argc, argv);
  try {
    Sum sum;
    for (const std::string& path : options.robots) look(loadUrdf(path), options, options.seed, true, sum);
    const std::string folder =
        (std::filesystem::temp_directory_path() / ("link_pairs_" + std::to_string(std::random_device()()))).string();
    std::filesystem::create_directories(folder);
    urdf_trees::writeMeshes(folder);
    for (int i = 0; i < options.trees; ++i) {
      pairs::Random random(pairs::Random::mix(options.seed, static_cast<std::uint64_t>(i)));
      const urdf_trees::RandomTree tree(random, folder);
      std::ofstream(folder + "/tree.urdf") << tree.urdf(random);
      look(loadUrdf(folder + "/tree.urdf"), options, options.seed + static_cast<std::uint64_t>(i), false, sum);
    }
    std::filesystem::remove_all(folder);
    std::printf("%s %ld, samples %ld, touching %ld\n", options.spoil ? "noticed" : "proven pairs", sum.never,
                sum.samples, sum.touching);
    return sum.touching > 0 && !options.spoil;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "link_pairs: %s\n", error.what());
    return 2;
  }
}
