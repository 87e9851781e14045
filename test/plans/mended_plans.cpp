// SPDX-License-Identifier: BSD-3-Clause
//
// Plans in collision, mended by the program, judged by samples of FCL. Plans of random arms' ways among random posts
// and plates go to `certify --mend --clearance --out`, and each plan of the file that it writes is looked at anew. Its
// ends and the joints' limits are kept. No state along it collides, at steps of 1e-4 rad. No link is nearer to an
// obstacle than the stated clearance. Prints what was mended and what was not; exit status 1 for a finding, or for
// fewer mended plans than were asked for.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcl/narrowphase/distance.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "fcl_artic/fcl_artic.h"
#include "fcl_artic/urdf/urdf.h"
#include "planning/fcl_state_check.h"

namespace mended_plans {
namespace {

using namespace fcl_artic;
using Json = nlohmann::json;
using Row = std::vector<double>;

struct Options {
  std::string data, program;
  std::vector<std::string> robots{"panda", "fanuc_m10ia", "puma560", "ur5_coarse"};
  int plans = 63;  ///< mended ones, for each robot and scene
  std::uint64_t seed = 1;
  double step = 1e-4, mend_time = 5;
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return a + (b - a) * std::ldexp(static_cast<double>(engine_() >> 11), -53); }

 private:
  std::mt19937_64 engine_;
};

std::string box(int number, const Eigen::Vector3d& at, const Eigen::Vector3d& size) {
  return fmt::format(
      "<link name='box{}'><collision><origin xyz='{} {} {}'/><geometry><box size='{} {} {}'/></geometry></collision>"
      "</link>{}\n",
      number, at.x(), at.y(), at.z(), size.x(), size.y(), size.z(),
      number == 0 ? ""
                  : fmt::format("<joint name='j{}' type='fixed'><parent link='box0'/><child link='box{}'/></joint>",
                                number, number));
}

/// Posts, or plates, around the robot's base within its reach.
std::string sceneOf(bool plates, double reach, Random& random) {
  std::string text = "<robot name='scene'>\n";
  for (int i = 0; i < 8; ++i) {
    const double angle = random.in(0, 2 * M_PI), far = random.in(0.4, 0.8) * reach;
    const Eigen::Vector3d at(far * std::cos(angle), far * std::sin(angle), random.in(0.1, 0.8) * reach);
    const double thin = random.in(0.01, 0.05);
    text += plates ? box(i, at, {0.3 * reach, 0.2 * reach, thin})
                   : box(i, {at.x(), at.y(), 0.5 * reach}, {thin, thin, 1.5 * reach});
  }
  return text + "</robot>\n";
}

struct Tally {
  int asked = 0, mended = 0, samples = 0, distances = 0;
  std::map<std::string, int> reasons;  ///< of those that were not mended
  std::vector<std::string> findings;
  std::vector<double> clearances, deviations, ratios, ms;
};

/// One robot in one scene.
class Cell {
 public:
  Cell(const Options& options, const std::string& robot, bool plates, const std::filesystem::path& folder)
      : options_(options),
        name_(robot + (plates ? ", plates" : ", posts")),
        folder_(folder),
        random_(options.seed * 1000 + static_cast<std::uint64_t>(robot.size() * 2 + plates)) {
    const std::string files = options.data + "/robots/" + robot + "/" + robot;
    urdf_ = files + ".urdf";
    robot_ = loadUrdf(urdf_);
    if (std::filesystem::exists(files + ".srdf")) {
      srdf_ = files + ".srdf";
      robot_.allowed = loadSrdf(srdf_, *robot_.tree);
    }
    const double reach = std::min(1.5, 0.8 * reachUpper(*robot_.tree, robot_.geometry));
    std::ofstream(folder / "scene.urdf") << sceneOf(plates, reach, random_);
    scene_ = loadScene((folder / "scene.urdf").string());
    manager_ = std::make_unique<ArticulatedCollisionManager>(robot_.tree);
    robot_.addTo(*manager_);
    scene_.addTo(*manager_);
    manager_->setup();
  }

  /// Some plans are not mended: others are drawn in their place.
  void run(Tally& tally) {
    constexpr int kRounds = 5;
    for (int round = 0; round < kRounds && tally.mended < options_.plans; ++round) {
      const int wanted = options_.plans - tally.mended;
      std::vector<std::vector<Row>> plans;
      for (int draws = 0; static_cast<int>(plans.size()) < wanted && draws < 200 * wanted; ++draws) {
        if (auto plan = drawPlan(); !plan.empty()) plans.push_back(std::move(plan));
      }
      if (!plans.empty()) mendAndJudge(plans, tally);
    }
  }

  const std::string& name() const { return name_; }

 private:
  void mendAndJudge(const std::vector<std::vector<Row>>& plans, Tally& tally) {
    const Json answer = mend(plans);
    std::ifstream written(folder_ / "safe.jsonl");
    for (std::size_t k = 0; k < plans.size(); ++k) {
      ++tally.asked;
      const Json& one = answer.at("plans").at(k);
      if (!one.contains("mended") || one.at("mended").at("status") != "free") {
        const std::string why = one.contains("mended") ? one.at("mended").value("error", "not free again") : "none";
        ++tally.reasons[why.substr(0, 60)];
        continue;
      }
      std::string line;
      const auto fault = [&](const std::string& what) {
        tally.findings.push_back(fmt::format("{}, plan {}: {}", name_, tally.asked, what));
      };
      if (!std::getline(written, line)) {
        fault("mended, and not written");
        continue;
      }
      ++tally.mended;
      const Json& mended = one.at("mended");
      tally.clearances.push_back(mended.at("clearance").at("lower"));
      tally.deviations.push_back(mended.at("deviation"));
      tally.ratios.push_back(mended.at("length_ratio"));
      tally.ms.push_back(mended.at("ms"));
      judge(plans[k], Json::parse(line), tally.clearances.back(), tally, fault);
    }
  }

  /// Three waypoints, each free, and the way between them in contact; empty: this time none.
  std::vector<Row> drawPlan() {
    const KinematicTree& tree = *robot_.tree;
    std::vector<Eigen::VectorXd> way;
    for (int k = 0; k < 3; ++k) {
      Eigen::VectorXd q(tree.dof());
      for (int v = 0; v < tree.dof(); ++v) {
        const Joint& joint = tree.joint(tree.variableJoint(v));
        double low = hasLimits(joint) ? joint.lower : -M_PI, high = hasLimits(joint) ? joint.upper : M_PI;
        if (k > 0) low = std::max(low, way.back()[v] - 0.5), high = std::min(high, way.back()[v] + 0.5);
        q[v] = random_.in(low, high);
      }
      if (!manager_->collide(q).isFree()) return {};
      way.push_back(q);
    }
    bool contact = false;
    for (int k = 0; k < 2; ++k) contact = contact || !manager_->isFree(way[k], way[k + 1]);
    if (!contact) return {};
    std::vector<Row> rows;
    for (const Eigen::VectorXd& q : way) rows.emplace_back(q.begin(), q.end());
    return rows;
  }

  Json mend(const std::vector<std::vector<Row>>& plans) const {
    std::vector<std::string> names;
    for (int v = 0; v < robot_.tree->dof(); ++v) names.push_back(robot_.tree->variableName(v));
    std::ofstream file(folder_ / "plans.jsonl");
    for (const auto& plan : plans) file << Json{{"joints", names}, {"waypoints", plan}}.dump() << '\n';
    file.close();
    const std::string command = fmt::format(
        "'{}' certify '{}' --robot '{}' {} --scene '{}' --mend --mend-time {} --clearance --json --out '{}' >'{}' "
        "2>'{}'",
        options_.program, (folder_ / "plans.jsonl").string(), urdf_, srdf_.empty() ? "" : "--srdf '" + srdf_ + "'",
        (folder_ / "scene.urdf").string(), options_.mend_time, (folder_ / "safe.jsonl").string(),
        (folder_ / "answer.json").string(), (folder_ / "err").string());
    std::filesystem::remove(folder_ / "safe.jsonl");
    (void)std::system(command.c_str());
    std::ifstream in(folder_ / "answer.json");
    std::stringstream text;
    text << in.rdbuf();
    try {
      return Json::parse(text.str());
    } catch (const Json::exception&) {
      std::stringstream err;
      err << std::ifstream(folder_ / "err").rdbuf();
      throw std::runtime_error(name_ + ": no answer: " + err.str());
    }
  }

  template <class Fault>
  void judge(const std::vector<Row>& given, const Json& written, double clearance, Tally& tally, const Fault& fault) {
    const KinematicTree& tree = *robot_.tree;
    std::vector<Eigen::VectorXd> way;
    for (int v = 0; v < tree.dof(); ++v) {
      if (written.at("joints").at(static_cast<std::size_t>(v)) != tree.variableName(v)) return fault("other joints");
    }
    for (const Json& row : written.at("waypoints")) {
      const Row values = row;
      way.push_back(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
    }
    if (Row(way.front().begin(), way.front().end()) != given.front()) fault("another start");
    if (Row(way.back().begin(), way.back().end()) != given.back()) fault("another goal");
    for (const Eigen::VectorXd& q : way) {
      for (const std::string& note : tree.limitNotes(q)) fault(note);
    }
    planning_data::FclStateCheck check(robot_, scene_);
    constexpr int kStates = 100;  // for one distance
    for (std::size_t k = 0; k + 1 < way.size(); ++k) {
      const Eigen::VectorXd change = way[k + 1] - way[k];
      const int steps = std::max(1, static_cast<int>(std::ceil(change.cwiseAbs().maxCoeff() / options_.step)));
      for (int i = 0; i <= steps; ++i) {
        const Eigen::VectorXd q = way[k] + change * (static_cast<double>(i) / steps);
        ++tally.samples;
        if (check.collides(q)) return fault(fmt::format("in contact between waypoints {} and {}", k, k + 1));
        if (i % kStates > 0) continue;
        ++tally.distances;
        // FCL's distances are as near as 1e-6.
        if (const double d = distance(q); d < clearance - 1e-5) {
          return fault(fmt::format("{} m from an obstacle, where a clearance of {} m is stated", d, clearance));
        }
      }
    }
  }

  double distance(const Eigen::VectorXd& q) const {
    std::vector<Eigen::Isometry3d> poses;
    robot_.tree->forwardKinematics(q, poses);
    double least = 1e9;
    for (const LinkGeometry& g : robot_.geometry) {
      fcl::CollisionObjectd link(*g.object);
      link.setTransform(poses[static_cast<std::size_t>(g.link)] * g.offset);
      link.computeAABB();
      for (const Scene::Obstacle& o : scene_.obstacles) {
        fcl::CollisionObjectd obstacle(*o.object);
        obstacle.computeAABB();
        if (link.getAABB().distance(obstacle.getAABB()) >= least) continue;
        fcl::DistanceResultd result;
        least = std::min(least, fcl::distance(&link, &obstacle, fcl::DistanceRequestd(), result));
      }
    }
    return least;
  }

  const Options& options_;
  const std::string name_;
  const std::filesystem::path folder_;
  Random random_;
  std::string urdf_, srdf_;
  Robot robot_;
  Scene scene_;
  std::unique_ptr<ArticulatedCollisionManager> manager_;
};

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

int run(const Options& options) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("mended_plans.{}", getpid());
  std::filesystem::create_directories(folder);
  std::size_t findings = 0;
  int asked = 0, mended = 0;
  for (const std::string& robot : options.robots) {
    for (const bool plates : {false, true}) {
      Tally tally;
      Cell cell(options, robot, plates, folder);
      const auto begin = std::chrono::steady_clock::now();
      cell.run(tally);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      fmt::print(
          "{}: {} of {} mended, {} samples and {} distances in {:.0f} s; clearance {:.4f} to {:.4f} m, median "
          "deviation {:.3f}, median length {:.3f}, median {:.0f} ms; {} findings\n",
          cell.name(), tally.mended, tally.asked, tally.samples, tally.distances, seconds,
          quantile(tally.clearances, 0), quantile(tally.clearances, 1), quantile(tally.deviations, 0.5),
          quantile(tally.ratios, 0.5), quantile(tally.ms, 0.5), tally.findings.size());
      for (const auto& [why, count] : tally.reasons) fmt::print("  not mended, {}: {}\n", count, why);
      for (const std::string& finding : tally.findings) fmt::print("  FINDING: {}\n", finding);
      std::fflush(stdout);
      findings += tally.findings.size();
      asked += tally.asked;
      mended += tally.mended;
    }
  }
  std::filesystem::remove_all(folder);
  const int wanted = 2 * options.plans * static_cast<int>(options.robots.size());
  fmt::print("{} plans in collision, {} mended, of {} that were asked for, {} findings\n", asked, mended, wanted,
             findings);
  return findings == 0 && mended == wanted ? 0 : 1;
}

}  // namespace
}  // namespace mended_plans

int main(int argc, char** argv) {
  CLI::App app("Mends plans in collision, and judges what is written by samples of FCL");
  mended_plans::Options options;
  app.add_option("--data", options.data, "Folder with robots/ROBOT/ROBOT.urdf")->required();
  app.add_option("--program", options.program, "fcl_artic")->required();
  app.add_option("--robots", options.robots, "Robots")->delimiter(',');
  app.add_option("--plans", options.plans, "Mended plans for each robot and scene");
  app.add_option("--seed", options.seed, "Seed");
  app.add_option("--step", options.step, "Largest step of a joint between samples, rad or m");
  app.add_option("--mend-time", options.mend_time, "Seconds for a plan, at most");
  CLI11_PARSE(app, argc, argv);
  return mended_plans::run(options);
}
