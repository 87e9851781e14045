// SPDX-License-Identifier: BSD-3-Clause
#include "edges/certify_edges.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <unordered_map>

#include <fmt/format.h>

#include "certificate/sha256.h"
#include "configuration.h"
#include "edges/columns.h"
#include "edges/inputs.h"
#include "edges/ranks.h"
#include "edges/run_folder.h"
#include "edges/scene_source.h"
#include "elapsed.h"
#include "exit_status.h"
#include "fcl_artic/certificate.h"
#include "files/files.h"
#include "outputs.h"
#include "report/request_json.h"
#include "threads/parallel.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// "850", "12.3 k", "4.56 M"
std::string shortNumber(double x) {
  if (x < 1e4) return fmt::format("{:.0f}", x);
  if (x < 1e6) return fmt::format("{:.1f} k", x / 1e3);
  return x < 1e9 ? fmt::format("{:.2f} M", x / 1e6) : fmt::format("{:.3f} G", x / 1e9);
}
std::string duration(double seconds) {
  const auto s = static_cast<std::int64_t>(seconds);
  if (s >= 86400) return fmt::format("{} d {} h", s / 86400, s % 86400 / 3600);
  if (s >= 3600) return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
  return s >= 60 ? fmt::format("{} min {} s", s / 60, s % 60) : fmt::format("{} s", s);
}

/// Shows on standard error how much is done, its rate, and the time that is left. On a terminal it renews one line each
/// second; elsewhere it writes a line now and then, as logs of jobs want it.
class EdgeProgress {
 public:
  /// @param rows  of all. @param shown  whether to show anything.
  EdgeProgress(double rows, bool shown) : rows_(rows), shown_(shown), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~EdgeProgress() { wipe(); }
  EdgeProgress(const EdgeProgress&) = delete;
  EdgeProgress& operator=(const EdgeProgress&) = delete;

  /// @param here  rows that this process has computed or, of finished blocks, passed over. @param all  the same of all
  /// ranks.
  /// @param computed  of `here`, those computed now.
  void show(std::int64_t all, std::int64_t here, std::int64_t computed, int ranks) {
    const double elapsed = secondsSince(begin_);
    if (!shown_ || elapsed < next_) return;
    next_ = elapsed + (terminal_ ? 1 : kSecondsPerLine);
    // Blocks that were there already cost next to nothing: the rate is that of what is computed.
    const double share = here > 0 ? static_cast<double>(computed) / static_cast<double>(here) : 0;
    const double rate = share * static_cast<double>(all) / elapsed;
    const double left = rows_ - static_cast<double>(all);
    std::string text = fmt::format("{} of {} rows, {:.1f} %", shortNumber(static_cast<double>(all)), shortNumber(rows_),
                                   100 * static_cast<double>(all) / rows_);
    if (rate > 0) text += fmt::format(", {} rows/s, {} left", shortNumber(rate), duration(left / rate));
    if (ranks > 1) text += fmt::format(", {} ranks", ranks);
    fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "fcl_artic: ", text, terminal_ ? "" : "\n");
    std::fflush(stderr);
    drawn_ = true;
  }
  void wipe() {
    if (terminal_ && drawn_) std::fputs("\r\x1b[K", stderr);
    drawn_ = false;
  }

 private:
  static constexpr double kSecondsPerLine = 30;
  const double rows_;
  const bool shown_, terminal_;
  bool drawn_ = false;
  double next_ = 2;
  const Clock::time_point begin_ = Clock::now();
};

/// All that the answers depend on, but for the engine.
Json describe(const WorldOptions& world, const World& read, const EdgesOptions& o, const EdgeSource& edges,
              const SceneSource& scenes) {
  std::vector<std::string> links;
  for (LinkId link = 0; link < read.robot.tree->numLinks(); ++link) links.push_back(read.robot.tree->linkName(link));

  const std::string common = obstaclesHash(read.scene, read.scene.obstacles.size() - read.attachments.size());
  Json scene_names = Json::object();
  scene_names["count"] = scenes.size();
  scene_names["sha256"] = certificate::sha256Text(scenes.hash() + common);
  constexpr std::size_t kNamed = 10000;
  if (scenes.size() <= kNamed) {
    Json& names = scene_names["names"] = Json::array();
    for (std::size_t s = 0; s < scenes.size(); ++s) names.push_back(scenes.name(s));
  }
  Json request = requestJson(o.request);
  request.update({{"scale", world.scale},
                  {"point_radius", world.point_radius},
                  {"unknown_cells", world.unknown_cells},
                  {"ignore_limits", o.columns.ignore_limits},
                  {"limit_tolerance", o.columns.limit_tolerance},
                  {"turns", static_cast<int>(o.columns.turns)},
                  {"certificates", o.certificates}});
  return {{"version", FCL_ARTIC_VERSION},
          {"robot", {{"name", read.robot.tree->name()}, {"sha256", robotHash(read)}, {"links", links}}},
          {"edges", {{"count", edges.size()}, {"trajectories", edges.areTrajectories()}, {"sha256", edges.hash()}}},
          {"scenes", scene_names},
          {"request", request},
          {"cut",
           {{"scenes", scenes.size()},
            {"edges", edges.size()},
            {"block_rows", o.block_rows},
            {"scene_of_edge", edges.hasScenes()}}}};
}

/// A scene that can't be set up.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The robot's manager, and the obstacles of one scene after the other in it.
class Stage {
 public:
  /// @param speaks  whether notes of the scenes are printed.
  Stage(const World& world, const SceneSource& scenes, bool speaks)
      : world_(world),
        scenes_(scenes),
        manager_(world.makeManager()),
        told_(world.scene.notes.begin(), world.scene.notes.end()),
        speaks_(speaks) {}

  /// Replaces the obstacles: those of this scene and the world's own stand there, and no others.
  /// @throws naming the scene.
  void enter(std::size_t scene) {
    if (scene_ == static_cast<std::ptrdiff_t>(scene)) return;
    scene_ = -1;
    try {
      // (Names of obstacles that others have are made unique.)
      const Scene all = combineScenes({world_.scene, scenes_.load(scene)}, *world_.robot.tree);
      tellNotes(scene, all.notes);
      std::vector<std::shared_ptr<const fcl::CollisionObjectd>> objects;
      std::vector<std::string> names;
      for (std::size_t i = 0; i < all.obstacles.size(); ++i) {
        const std::size_t own = world_.scene.obstacles.size(), carried = world_.attachments.size();
        if (i >= own - carried && i < own) continue;
        objects.push_back(all.obstacles[i].object);
        names.push_back(all.obstacles[i].name);
      }
      manager_.replaceObstacles(objects, names);
      number_of_.clear();
      for (const auto& object : objects) number_of_.emplace(object.get(), static_cast<std::int32_t>(number_of_.size()));
    } catch (const std::exception& error) {
      throw SceneError(fmt::format("scene {} ('{}'): {}", scene, scenes_.name(scene), error.what()));
    }
    scene_ = static_cast<std::ptrdiff_t>(scene);
  }

  const ArticulatedCollisionManager& manager() const { return manager_; }
  std::int32_t numberOf(const BodyRef& body) const { return number_of_.at(body.object); }

 private:
  /// Prints each note once. If there are more than anybody would read, prints only the first ones.
  void tellNotes(std::size_t scene, const std::vector<std::string>& notes) {
    constexpr std::size_t kMaxTold = 50;
    for (const std::string& note : notes) {
      if (!speaks_ || !told_.insert(note).second || ++num_told_ > kMaxTold) continue;
      printNotes({note}, fmt::format("scene {} ('{}')", scene, scenes_.name(scene)));
      if (num_told_ == kMaxTold) fmt::print(stderr, "fcl_artic: note: notes of further scenes are not printed\n");
    }
  }

  const World& world_;
  const SceneSource& scenes_;
  ArticulatedCollisionManager manager_;
  std::set<std::string> told_;
  std::size_t num_told_ = 0;
  const bool speaks_;
  std::ptrdiff_t scene_ = -1;
  std::unordered_map<const fcl::CollisionObjectd*, std::int32_t> number_of_;
};

/// Answers blocks.
class Answerer {
 public:
  Answerer(Stage& stage, EdgeSource& edges, const EdgesOptions& options, const RunFolder& folder, int threads)
      : stage_(stage), edges_(edges), options_(options), folder_(folder), threads_(threads) {}

  /// Computes a block.
  void answer(std::size_t block) {
    const Cut cut = folder_.cut();
    const std::size_t begin = cut.begin(block), count = cut.count(block);
    rows_.assign(count, options_.certificates);
    records_.clear();
    worlds_.clear();
    if (!cut.scene_of_edge) {
      answerSome({cut.sceneOf(block), begin, count}, 0);
    } else {
      const std::vector<std::int64_t> scenes = edges_.scenes(begin, count);
      for (std::size_t i = 0; i < count;) {
        if (scenes[i] < 0 || static_cast<std::size_t>(scenes[i]) >= cut.scenes) {
          throw std::runtime_error(fmt::format("'{}', edge {}: there is no scene {}, they are numbered 0 to {}",
                                               options_.edges, begin + i, scenes[i], cut.scenes - 1));
        }
        std::size_t end = i + 1;
        while (end < count && scenes[end] == scenes[i]) ++end;
        answerSome({static_cast<std::size_t>(scenes[i]), begin + i, end - i}, i);
        i = end;
      }
    }
  }
  const Columns& rows() const { return rows_; }            ///< of the block
  const std::string& records() const { return records_; }  ///< certificates of it

  /// Writes it, with the worlds that its certificates are about.
  /// @throws std::runtime_error naming the file.
  void write(std::size_t block) const {
    for (const auto& [scene, text] : worlds_) {
      const std::string path = folder_.worldPath(scene);
      if (!fs::exists(path)) files::write(path, *text);
    }
    folder_.writeBlock(block, rows_, records_);
  }

  /// Why the first row that was refused was; empty: none was.
  const std::string& refusal() const { return refusal_; }

 private:
  /// @param at  row of the block that the segment begins with.
  void answerSome(const Segment& segment, std::size_t at) {
    stage_.enter(segment.scene);
    for (std::size_t done = 0; done < segment.count; done += kMotionsAtOnce) {
      const std::size_t n = std::min(kMotionsAtOnce, segment.count - done);
      edges_.read(segment.begin + done, n, some_);
      const ArticulatedCollisionManager& manager = stage_.manager();
      if (edges_.areTrajectories()) {
        results_.resize(some_.trajectories.size());
        parallelFor(results_.size(), threads_, [&](std::size_t i) {
          manager.continuousCollide(some_.trajectories[i], options_.request, results_[i]);
        });
      } else {
        manager.continuousCollide(some_.motions, options_.request, results_, threads_);
      }
      for (std::size_t i = 0; i < some_.asked.size(); ++i) put(results_[i], segment.scene, at + done + some_.asked[i]);
      for (const auto& [row, why] : some_.refused) {
        rows_.status[at + done + row] = static_cast<std::int8_t>(RowStatus::refused);
        if (refusal_.empty()) refusal_ = why;
      }
    }
  }

  void put(const CertifiedResult& result, std::size_t scene, std::size_t row) {
    putRow(
        result, [&](const BodyRef& body) { return stage_.numberOf(body); }, row, rows_);
    if (!options_.certificates || !result.certificate || !*result.certificate) return;
    worlds_[scene] = result.certificate->world;
    rows_.certificate[row] = static_cast<std::int64_t>(records_.size());
    records_ += result.certificate->record();
  }

  Stage& stage_;
  EdgeSource& edges_;
  const EdgesOptions& options_;
  const RunFolder& folder_;
  int threads_;
  EdgeRows some_;
  std::vector<CertifiedResult> results_;
  Columns rows_;
  std::string records_, refusal_;
  std::map<std::size_t, std::shared_ptr<const std::string>> worlds_;  ///< of the block's certificates
};

/// The fate of the blocks that a process took.
struct Outcome {
  bool blocks_failed = true, something_else_failed = false;  ///< else: rows are refused, --auto-srdf is not written
};

Outcome computeBlocks(const WorldOptions& world_options, EdgesOptions& o, Ranks& ranks,
                      std::optional<RunFolder>& folder) {
  World world(world_options);
  world.open(o.request);
  const KinematicTree& tree = *world.robot.tree;
  o.columns.state = parseValues(tree, o.state, "--state");
  EdgeSource edges(tree, o.edges, o.columns);
  const SceneSource scenes = o.scenes.empty() ? SceneSource() : SceneSource(o.scenes, sceneOptions(world_options));
  folder.emplace(o.out, describe(world_options, world, o, edges, scenes));
  const bool speaks = ranks.rank() == 0 && !o.quiet;
  Stage stage(world, scenes, !o.quiet);
  if (speaks) {
    printNotes(world.notes(stage.manager()));
    printNotes(scenes.notes());
  }
  const int threads = o.threads == 0 && ranks.size() > 1 ? 1 : o.threads;
  Answerer answerer(stage, edges, o, *folder, threads);
  const Cut cut = folder->cut();
  EdgeProgress progress(ranks.share() * static_cast<double>(cut.rows()), speaks);
  std::vector<std::string> errors;  // each once, whatever the number of blocks that meet it
  std::set<std::string> noted;
  const auto noteError = [&](const char* error) {
    if (noted.insert(error).second) errors.emplace_back(error);
  };
  std::set<std::size_t> bad_scenes;
  Counts counts;
  std::int64_t here = 0, computed = 0;
  for (std::int64_t taken; (taken = ranks.next()) < static_cast<std::int64_t>(cut.blocks());) {
    const auto block = static_cast<std::size_t>(taken);
    const auto rows = static_cast<std::int64_t>(cut.count(block));
    if (!cut.scene_of_edge && bad_scenes.count(cut.sceneOf(block))) continue;
    bool is_new = false;
    // If this block can't be computed, the reason is reported, and the others are computed all the same.
    try {
      if (const std::optional<Block> finished = folder->readBlock(block)) {
        counts.add(finished->counts);
      } else {
        is_new = true;
        answerer.answer(block);
        counts.add(answerer.rows());
      }
    } catch (const SceneError& error) {
      noteError(error.what());
      if (!cut.scene_of_edge) bad_scenes.insert(cut.sceneOf(block));
      continue;
    } catch (const std::runtime_error& error) {
      noteError(error.what());
      continue;
    }
    if (is_new) {
      answerer.write(block);  // a disk that takes no more ends it all
      computed += rows;
    }
    here += rows;
    progress.show(ranks.addDone(rows), here, computed, ranks.size());
  }
  progress.wipe();
  constexpr std::size_t kErrorsShown = 10;
  for (std::size_t i = 0; i < std::min(kErrorsShown, errors.size()); ++i)
    fmt::print(stderr, "fcl_artic: error: {}\n", errors[i]);
  if (errors.size() > kErrorsShown) fmt::print(stderr, "fcl_artic: {} more errors\n", errors.size() - kErrorsShown);
  if (!o.quiet) {
    for (const std::string& note : edges.limitNotes()) fmt::print(stderr, "fcl_artic: note: {}\n", note);
  }
  if (!answerer.refusal().empty())
    fmt::print(stderr, "fcl_artic: error: rows are refused, the first: {}\n", answerer.refusal());
  const bool unwritten = world.unwritten.exitStatus(kExitFree) != kExitFree;
  return {!errors.empty(), counts[RowStatus::refused] > 0 || unwritten};
}

void printSummary(const RunFolder& folder, const Json& summary, bool json) {
  if (json) {
    fmt::print("{}\n", summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  fmt::print("{} rows in {} blocks: {} free, {} contact", summary.at("rows").get<std::uint64_t>(),
             summary.at("blocks").get<std::uint64_t>(), summary.at("free").get<std::uint64_t>(),
             summary.at("contact").get<std::uint64_t>());
  for (const char* rare : {"undecided", "refused", "missing"}) {
    if (summary.at(rare) != 0) fmt::print(", {} {}", summary.at(rare).get<std::uint64_t>(), rare);
  }
  const std::pair<const char*, const char*> exceptions[] = {
      {"free_with_ignored_initial_contacts", "the initial contact of some pair"},
      {"free_with_never_apart_pairs", "pairs that never come apart"},
      {"free_with_unproven_allowed_pairs", "allowed pairs not proven apart"}};
  for (const auto& [key, what] : exceptions) {
    if (const auto rows = summary.at(key).get<std::uint64_t>(); rows > 0)
      fmt::print("; {} free but for {}", rows, what);
  }
  fmt::print("\n{}/table.h5, hash {}\n", folder.path(), summary.at("table_sha256").get<std::string>());
}

}  // namespace

int certifyEdges(const WorldOptions& world, EdgesOptions& o) {
  const std::unique_ptr<Ranks> ranks = openRanks(o.shard);
  std::optional<RunFolder> folder;
  Outcome outcome;
  std::string error;
  try {
    outcome = computeBlocks(world, o, *ranks, folder);
  } catch (const std::exception& thrown) {
    error = thrown.what();
    if (ranks->rank() == 0) fmt::print(stderr, "fcl_artic: error: {}\n", error);
  }
  // All ranks meet here, whatever became of each: if one stayed away, the others would wait for ever.
  constexpr int kDone = 0, kFailedInPart = 1, kFailed = 2;
  int first = kDone;
  const int worst = ranks->finish(outcome.blocks_failed           ? kFailed
                                  : outcome.something_else_failed ? kFailedInPart
                                                                  : kDone,
                                  first);
  if (ranks->rank() != 0 && !error.empty() && first != kFailed) {  // what all ranks find is said once
    fmt::print(stderr, "fcl_artic: rank {}: error: {}\n", ranks->rank(), error);
  }
  if (worst != kFailed && ranks->rank() == 0 && o.shard.empty()) {
    printSummary(*folder, folder->merge(false, Read::summary), false);  // each block was written or read just now
  }
  return worst == kDone ? kExitFree : kExitError;
}

int mergeEdges(const std::string& folder, bool partial, bool json) {
  const RunFolder run(folder);
  printSummary(run, run.merge(partial), json);
  return kExitFree;
}

}  // namespace fcl_artic::app
