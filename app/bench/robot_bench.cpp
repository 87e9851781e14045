// SPDX-License-Identifier: BSD-3-Clause
#include "bench/robot_bench.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/bars.h"
#include "elapsed.h"
#include "exit_status.h"
#include "files/files.h"
#include "kinematics/angles.h"
#include "outputs.h"
#include "planning/fcl_state_check.h"
#include "progress.h"
#include "random_motions.h"
#include "usage.h"
#include "visibility_options.h"
#include "world.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;
using planning_data::CarriedObject;
using planning_data::FclStateCheck;

constexpr double kResolution = 0.01;  // OMPL's default
constexpr std::size_t kContradictionsShown = 10;

struct RobotBenchOptions {
  WorldOptions world;
  VisibilityChoice visibility;
  double angle = 5;  ///< degrees
  std::size_t motions = 1000;
  std::uint64_t seed = 1;
  int passes = 3;
  bool no_fcl = false, json = false;
  std::string csv, svg, only;
};

/// Resident memory of this process, kB; nothing where the system does not say.
std::optional<double> residentKilobytes() {
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  if (!(statm >> size >> resident)) return std::nullopt;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1024;
}

/// Contents of the robot and its scene, and the cost of setting them up.
struct Setup {
  std::size_t links_with_geometry = 0, robot_triangles = 0, scene_triangles = 0;
  std::size_t checked_pairs = 0, pairs_apart = 0, pairs_allowed = 0;
  double load_ms = 0, proofs_ms = 0, setup_ms = 0;
  std::optional<double> setup_kilobytes;
};

std::size_t numTriangles(const fcl::CollisionObjectd& object) {
  const auto* mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(object.collisionGeometry().get());
  return mesh ? static_cast<std::size_t>(mesh->num_tris) : 0;
}

/// Measures a motion in all ways: the manager's queries, and FCL's check of states.
class MeasuredRobot {
 public:
  MeasuredRobot(const WorldOptions& options, const VisibilityChoice& visibility) : world_(options) {
    request_.visibility = visibility.mode;
    (void)makeCuller(visibility.executor);             // refused before files are read
    auto measured = [last = Clock::now()]() mutable {  // ms since it was last called
      const auto now = Clock::now();
      return std::chrono::duration<double, std::milli>(now - std::exchange(last, now)).count();
    };
    world_.readRobot();
    world_.readScene();
    setup_.load_ms = measured();
    const std::optional<double> before = residentKilobytes();
    const LinkPairReport report = world_.provePairs(request_.margin);
    setup_.proofs_ms = measured();
    manager_.emplace(world_.makeManager());
    setup_.setup_ms = measured();
    useVisibility(visibility, *manager_);
    if (const std::optional<double> after = residentKilobytes()) setup_.setup_kilobytes = *after - before.value_or(0);
    allowed_for_fcl_ = options.robot.srdf.empty() ? report.needNoCheck() : world_.robot.allowed;
    count(report, !options.robot.srdf.empty());
  }

  const Setup& setup() const { return setup_; }
  VisibilityMode visibility() const { return request_.visibility; }
  /// The work of stage 2 in all of the manager's queries for first or any contacts.
  const QueryStatistics& stage2() const { return stage2_; }
  const World& world() const { return world_; }
  std::vector<std::string> notes() const { return world_.notes(*manager_); }
  const KinematicTree& tree() const { return *world_.robot.tree; }

  Questions questions(bool with_fcl) {
    Questions out;
    out.collide = [this](const MotionEnds& ends, ContactMode mode, CertifiedResult& result) {
      request_.mode = mode;
      request_.max_contacts = mode == ContactMode::any ? 0 : 1;  // the verdict, as a planner asks; the contact
      manager_->continuousCollide(JointMotion::linear(tree(), ends.from, ends.to), request_, result);
      addStage2(result.statistics);
    };
    out.clearance = [this](const MotionEnds& ends) {
      (void)manager_->clearance(JointMotion::linear(tree(), ends.from, ends.to));
    };
    if (with_fcl) {
      makeStateCheck();
      out.sampleInContact = [this](const MotionEnds& ends) { return sampleInContact(ends); };
    }
    return out;
  }

 private:
  void addStage2(const QueryStatistics& s) {
    VisibilityStatistics::forEachField(
        [&](const char*, auto field) { stage2_.visibility.*field += s.visibility.*field; });
    if (!s.visibility_executor.empty()) stage2_.visibility_executor = s.visibility_executor;
    if (!s.visibility_fallback.empty()) stage2_.visibility_fallback = s.visibility_fallback;
  }

  void count(const LinkPairReport& report, bool with_srdf) {
    const Robot& robot = world_.robot;
    std::set<LinkId> links;
    for (const LinkGeometry& g : robot.geometry) {
      links.insert(g.link);
      setup_.robot_triangles += numTriangles(*g.object);
    }
    setup_.links_with_geometry = links.size();
    for (const Scene::Obstacle& o : world_.scene.obstacles) setup_.scene_triangles += numTriangles(*o.object);
    setup_.pairs_apart = report.count(LinkPairKind::never);
    setup_.checked_pairs = manager_->checkedLinkPairs().size() - (with_srdf ? 0 : setup_.pairs_apart);
    const auto isNeighbour = [](const LinkPairFinding& pair) { return pair.neighbours && pair.touchThroughout(); };
    const auto neighbours =
        static_cast<std::size_t>(std::count_if(report.pairs.begin(), report.pairs.end(), isNeighbour));
    setup_.pairs_allowed =
        with_srdf ? report.pairs.size() - setup_.pairs_apart - neighbours : report.alwaysTouching().pairs().size();
  }

  /// FCL leaves out the pairs that we need not look at either.
  void makeStateCheck() {
    Robot robot = world_.robot;
    robot.allowed = allowed_for_fcl_;
    Scene scene = world_.scene;
    const std::size_t num_standing = scene.obstacles.size() - world_.attachments.size();
    std::vector<CarriedObject> carried;
    for (std::size_t i = 0; i < world_.attachments.size(); ++i) {
      const Attachment& a = world_.attachments[i];
      const Scene::Obstacle& o = scene.obstacles[num_standing + i];
      carried.push_back({o.name, o.object, tree().linkId(a.link), a.pose, a.touch_links});
    }
    scene.obstacles.resize(num_standing);
    state_check_.emplace(robot, scene, carried);
  }

  /// Samples in the order of OMPL's discrete motion validator: the end, then the middle, then the middles of the
  /// halves.
  std::optional<double> sampleInContact(const MotionEnds& ends) {
    const JointMotion motion = JointMotion::linear(tree(), ends.from, ends.to);
    if (state_check_->collides(motion.configuration(1))) return 1;
    const int steps = numSteps(tree(), ends, kResolution);
    std::queue<std::pair<int, int>> open;  // first and last sample
    if (steps > 1) open.emplace(1, steps - 1);
    for (; !open.empty(); open.pop()) {
      const auto [first, last] = open.front();
      const int middle = (first + last) / 2;
      const double t = static_cast<double>(middle) / steps;
      if (state_check_->collides(motion.configuration(t))) return t;
      if (first < middle) open.emplace(first, middle - 1);
      if (middle < last) open.emplace(middle + 1, last);
    }
    return std::nullopt;
  }

  World world_;
  Setup setup_;
  AllowedCollisionMatrix allowed_for_fcl_;
  std::optional<ArticulatedCollisionManager> manager_;
  std::optional<FclStateCheck> state_check_;
  CertifiedRequest request_;
  QueryStatistics stage2_;
};

/// All that one run found out.
struct Outcome {
  const RobotBenchOptions& options;
  const MeasuredRobot& asked;
  DrawnMotions drawn;
  std::vector<TimedRow> rows;
  std::vector<Contradiction> contradictions;

  std::size_t numProven() const {
    return static_cast<std::size_t>(std::count(drawn.proven.begin(), drawn.proven.end(), true));
  }
  const TimedRow* samplesOfContacts() const {
    for (const TimedRow& row : rows) {
      if (row.motions == "contact" && row.question == "FCL, 1 %") return &row;
    }
    return nullptr;
  }
  /// The row with the slowest of the manager's collision queries; null if there were none.
  const TimedRow* slowestRow() const {
    const TimedRow* slowest = nullptr;
    for (const TimedRow& row : rows) {
      if (row.ours() && !row.us.empty() && (!slowest || row.slowest() > slowest->slowest())) slowest = &row;
    }
    return slowest;
  }
  const MotionEnds& slowestOf(const TimedRow& row) const {
    const auto& motions = row.motions == "free"      ? drawn.free
                          : row.motions == "contact" ? drawn.contact
                                                     : drawn.touching;
    return motions[static_cast<std::size_t>(std::max_element(row.us.begin(), row.us.end()) - row.us.begin())];
  }
  /// The command that asks about a motion.
  std::string commandOf(const MotionEnds& ends) const {
    return fmt::format("fcl_artic check {} --from={} --to={}", shellArguments(options.world),
                       configurationText(ends.from), configurationText(ends.to));
  }
};

std::string headOf(const Outcome& o) {
  const Setup& s = o.asked.setup();
  const World& world = o.asked.world();
  const bool with_srdf = !o.options.world.robot.srdf.empty();
  std::string out = fmt::format("{}: {} links, {} with geometry, {} triangles\n", o.asked.tree().name(),
                                o.asked.tree().numLinks(), s.links_with_geometry, s.robot_triangles);
  out += fmt::format("pairs of links: {} checked, {} proven apart within the joints' limits, {} {}\n", s.checked_pairs,
                     s.pairs_apart, s.pairs_allowed,
                     with_srdf ? "allowed by the SRDF without a proof" : "always in contact (allowed)");
  if (!world.scene.obstacles.empty()) {
    out += fmt::format("scene: {} object{}, {} carried by links, {} triangles\n", world.scene.obstacles.size(),
                       world.scene.obstacles.size() == 1 ? "" : "s", world.attachments.size(), s.scene_triangles);
  }
  out += fmt::format("set-up: {:.1f} ms to read the files, {:.1f} ms for proofs of pairs, {:.1f} ms in setup()\n",
                     s.load_ms, s.proofs_ms, s.setup_ms);
  if (s.setup_kilobytes) {
    out += fmt::format("memory: proofs and setup() add {:.0f} kB to the resident set (/proc/self/statm)\n",
                       *s.setup_kilobytes);
  }
  const DrawnMotions& d = o.drawn;
  out += fmt::format(
      "{} random motions, each joint by at most {:g} degrees: {} free, {} in contact, {}\n"
      "touching at the start; at most {} of each are timed, the fastest of {} passes, of the slowest {}\n"
      "more\n",
      d.drawn, o.options.angle, d.drawn_free, d.drawn_contact, d.drawn_touching, o.options.motions, o.options.passes,
      kPassesOfSlowest);
  return out;
}

std::string tableOf(const Outcome& o) {
  std::string out = fmt::format("{:<24}{:<12}{:>9}{:>12}{:>12}{:>14}{:>14}\n", "motions", "question", "number",
                                "median us", "mean us", "99.9 % us", "slowest us");
  for (const TimedRow& row : o.rows) {
    out += fmt::format("{:<24}{:<12}{:>9}", row.motions, row.question, row.us.size());
    if (row.us.empty()) {
      out += fmt::format("{:>12}{:>12}{:>14}{:>14}\n", "-", "-", "-", "-");
    } else {
      out += fmt::format("{:>12.2f}{:>12.2f}{:>14.2f}{:>14.2f}\n", row.quantile(0.5), row.mean(), row.quantile(0.999),
                         row.slowest());
    }
  }
  return out;
}

std::string textOf(const Outcome& o) {
  std::string out = headOf(o) + '\n' + tableOf(o) + '\n';
  if (const TimedRow* samples = o.samplesOfContacts()) {
    out += fmt::format("missed: FCL's samples, 1 % of the joint space apart, see nothing of {} of {} proven contacts\n",
                       samples->missed, o.numProven());
  }
  if (const TimedRow* row = o.slowestRow()) {
    out += fmt::format("slowest: {:.2f} us, {}, {}:\n{}\n", row->slowest(), row->motions, row->question,
                       o.commandOf(o.slowestOf(*row)));
  }
  if (o.asked.visibility() != VisibilityMode::off) {
    out += fmt::format("stage 2, on: {}\n", visibilityText(o.asked.stage2()));
  }
  for (const std::string& note : o.asked.notes()) out += fmt::format("note: {}\n", note);
  return out;
}

std::string csvOf(const Outcome& o) {
  std::string out = "motions,question,number,median_us,mean_us,p999_us,slowest_us,missed\n";
  for (const TimedRow& row : o.rows) {
    out += fmt::format("{},\"{}\",{},{:.3f},{:.3f},{:.3f},{:.3f},{}\n", row.motions, row.question, row.us.size(),
                       row.quantile(0.5), row.mean(), row.quantile(0.999), row.slowest(), row.missed);
  }
  return out;
}

Json jsonOf(const Outcome& o) {
  const Setup& s = o.asked.setup();
  const World& world = o.asked.world();
  const DrawnMotions& d = o.drawn;
  Json out = {{"robot", o.asked.tree().name()},
              {"links", o.asked.tree().numLinks()},
              {"links_with_geometry", s.links_with_geometry},
              {"triangles", s.robot_triangles},
              {"pairs", {{"checked", s.checked_pairs}, {"apart", s.pairs_apart}, {"allowed", s.pairs_allowed}}},
              {"scene",
               {{"objects", world.scene.obstacles.size()},
                {"carried", world.attachments.size()},
                {"triangles", s.scene_triangles}}},
              {"setup_ms", {{"load", s.load_ms}, {"proofs", s.proofs_ms}, {"setup", s.setup_ms}}},
              {"resident_growth_kB", s.setup_kilobytes ? Json(*s.setup_kilobytes) : Json()},
              {"angle_degrees", o.options.angle},
              {"seed", o.options.seed},
              {"passes", o.options.passes},
              {"drawn",
               {{"all", d.drawn},
                {"free", d.drawn_free},
                {"contact", d.drawn_contact},
                {"touching_at_start", d.drawn_touching}}},
              {"rows", Json::array()}};
  for (const TimedRow& row : o.rows) {
    Json one = {{"motions", row.motions}, {"question", row.question}, {"number", row.us.size()}};
    if (!row.us.empty()) {
      one["median_us"] = row.quantile(0.5);
      one["mean_us"] = row.mean();
      one["p999_us"] = row.quantile(0.999);
      one["slowest_us"] = row.slowest();
    }
    out["rows"].push_back(one);
  }
  if (const TimedRow* samples = o.samplesOfContacts()) {
    out["fcl"] = {{"resolution", kResolution}, {"proven_contacts", o.numProven()}, {"missed", samples->missed}};
  }
  const auto values = [](const Eigen::VectorXd& q) { return std::vector<double>(q.begin(), q.end()); };
  if (const TimedRow* row = o.slowestRow()) {
    const MotionEnds& ends = o.slowestOf(*row);
    out["slowest"] = {{"us", row->slowest()},      {"motions", row->motions}, {"question", row->question},
                      {"from", values(ends.from)}, {"to", values(ends.to)},   {"command", o.commandOf(ends)}};
  }
  out["contradictions"] = Json::array();
  for (const Contradiction& c : o.contradictions) {
    out["contradictions"].push_back({{"text", c.text},
                                     {"from", values(c.motion.from)},
                                     {"to", values(c.motion.to)},
                                     {"command", o.commandOf(c.motion)}});
  }
  out["visibility"] = visibilityJson(o.asked.visibility(), o.asked.stage2());
  out["notes"] = o.asked.notes();
  return out;
}

std::string plotOf(const Outcome& o) {
  const auto chart = [&](const std::string& title, double share) {
    BarChart out{title, "us", true, {"free", "contact", "touching at the start"}, {}};
    for (const char* question : {"first", "any", "FCL, 1 %"}) {
      out.series.push_back({question, {}});
      for (const std::string& motions : out.groups) {
        out.series.back().values.push_back(0);  // no bar
        for (const TimedRow& row : o.rows) {
          if (row.motions == motions && row.question == question) out.series.back().values.back() = row.quantile(share);
        }
      }
    }
    return out;
  };
  return toSvg({chart(o.asked.tree().name() + ": a motion, median", 0.5), chart("99.9 % of all motions", 0.999),
                chart("the slowest motion", 1)});
}

int benchRobot(RobotBenchOptions& options) {
  removeEarlierOutputs({{"--csv", &options.csv}, {"--svg", &options.svg}}, inputsOf(options.world));
  if (options.no_fcl && options.only.find("FCL") != std::string::npos) {
    throw std::invalid_argument("--only '" + options.only + "' is a row of FCL's: leave --no-fcl out");
  }
  MeasuredRobot asked(options.world, options.visibility);
  RandomMotions random(asked.tree(), options.angle * kRadiansPerDegree, options.seed);
  const Questions questions = asked.questions(!options.no_fcl);
  Outcome outcome{options, asked, {}, {}, {}};
  {
    ProgressBar bar;
    const auto show = [&bar](double from, double to) {
      return [&bar, from, to](double share) { bar.show(from + share * (to - from)); };
    };
    constexpr double kDrawing = 0.3;  // about that part of the whole work
    outcome.drawn = drawMotions(random, options.motions, questions, outcome.contradictions, show(0, kDrawing));
    outcome.rows =
        timeMotions(outcome.drawn, options.passes, questions, outcome.contradictions, show(kDrawing, 1), options.only);
  }
  if (options.json) {
    fmt::print("{}\n", jsonOf(outcome).dump(2));
  } else {
    fmt::print("{}", textOf(outcome));
  }
  if (!options.csv.empty()) files::write(options.csv, csvOf(outcome));
  if (!options.svg.empty()) files::write(options.svg, plotOf(outcome));
  return asked.world().unwritten.exitStatus(
      tellContradictions(outcome.contradictions, [&](const MotionEnds& ends) { return outcome.commandOf(ends); }));
}

}  // namespace

int tellContradictions(const std::vector<Contradiction>& wrong,
                       const std::function<std::string(const MotionEnds&)>& commandOf) {
  for (std::size_t i = 0; i < std::min(wrong.size(), kContradictionsShown); ++i) {
    fmt::print(stderr, "fcl_artic: answers contradict each other: {}\n{}\n", wrong[i].text, commandOf(wrong[i].motion));
  }
  if (wrong.size() > kContradictionsShown) {
    fmt::print(stderr, "fcl_artic: {} more of these\n", wrong.size() - kContradictionsShown);
  }
  return wrong.empty() ? kExitFree : kExitContact;
}

void addRobotBench(CLI::App& bench, int& exit_status) {
  auto options = std::make_shared<RobotBenchOptions>();
  RobotBenchOptions& o = *options;
  CLI::App* verb =
      bench.add_subcommand("robot", "What queries cost on one's own robot and scene, beside FCL's samples");
  verb->footer(
      "Motions begin anywhere within the joints' limits (+-180 degrees or +-1 m where there are none) and end there.\n"
      "They are asked for the first contact and for any, free ones for their clearance too (200 at most), and sampled\n"
      "by FCL as OMPL's discrete motion validator does by default: the end and, where the motion is longer than 1 % "
      "of\n"
      "the joint space's extent, states in between. Motions are drawn until --motions of them are free and as many in\n"
      "contact, 20 times as many in all at most; those that touch at the start are counted and timed by themselves.\n"
      "Without --srdf the pairs of links that need no check are found first, with proof, as by --auto-srdf.\n"
      "Exit status: 0, 1 when answers contradict each other (first and any, or a state in contact for FCL on a motion\n"
      "that is proven free), 2 error.");
  addWorldOptions(*verb, o.world);
  for (const char* name : {"--margin-of", "--margin-pair", "--margins", "--allow"}) {
    verb->remove_option(verb->get_option(name));  // FCL's check of states knows none of these
  }
  addVisibilityOptions(*verb, o.visibility);
  verb->add_option("--angle", o.angle,
                   "Each joint moves by at most this, in degrees, either way; a length by the same part of its range\n"
                   "as this is of 360")
      ->check(requirePositive)
      ->capture_default_str()
      ->type_name("DEGREES");
  verb->add_option("--motions", o.motions, "Motions of each kind")->check(CLI::PositiveNumber)->capture_default_str();
  verb->add_option("--seed", o.seed, "The same seed asks about the same motions")->capture_default_str();
  verb->add_option("--passes", o.passes,
                   fmt::format("Runs of each query, of the slowest ones {} more; the fastest counts", kPassesOfSlowest))
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--only", o.only, "Time this row of the table alone, as for a profile: 'free, first'")
      ->check(
          CLI::IsMember({"free, first", "free, any", "contact, first", "contact, any", "touching at the start, first",
                         "touching at the start, any", "free, clearance", "free, FCL, 1 %", "contact, FCL, 1 %"}))
      ->type_name("ROW");
  verb->add_flag("--no-fcl", o.no_fcl, "Do not sample with FCL");
  verb->add_flag("--json", o.json, "Print all of it in JSON");
  verb->add_option("--csv", o.csv, "Write the table as CSV")->type_name("FILE");
  verb->add_option("--svg", o.svg, "Draw the times")->type_name("FILE");
  verb->callback([options, &exit_status] { exit_status = benchRobot(*options); });
}

}  // namespace fcl_artic::app
