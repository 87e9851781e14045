// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>
#include <CLI/CLI.hpp>

#include "arms.h"
#include "fcl_artic/instruction_set.h"
#include "modes/rules.h"
#include "pairs/pair_campaign.h"
#include "scene_file.h"
#ifdef CAMPAIGN_HAS_URDF
#include "urdf/tree_campaign.h"
#endif

namespace {

/// One line for each query, in their order.
class AnswerLines {
 public:
  explicit AnswerLines(std::uint64_t queries) : lines_(queries) {}
  /// Different queries from different threads.
  void set(const campaign::Asked& asked, const campaign::Case& c) {
    static const char* const verdicts[] = {"free", "contact", "undecided"};
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    for (const char one : campaign::toText({asked.scene}))
      hash = (hash ^ static_cast<unsigned char>(one)) * 1099511628211u;
    const fcl_artic::CertifiedResult& result = asked.result(0);
    lines_[c.index] = campaign::format("%llu %016llx %s %s %a %a\n", static_cast<unsigned long long>(c.index),
                                       static_cast<unsigned long long>(hash), verdicts[static_cast<int>(result.status)],
                                       result.certain ? "certain" : "-", result.t_lower, result.t_upper);
  }
  std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line;
    return all;
  }

 private:
  std::vector<std::string> lines_;
};

/// Files of scenes and of answers, which the campaign of arms alone has.
struct Files {
  std::string scenes, write_scenes, answers;
};

campaign::Report runArms(campaign::Arms arms, campaign::Options& options, const Files& files) {
  if (!files.scenes.empty()) {
    const std::vector<campaign::Scene> scenes = campaign::readScenes(files.scenes);
    std::vector<campaign::CaseId> ids;
    for (const campaign::Scene& scene : scenes) ids.push_back({scene.family, scene.seed});
    options.cases = ids.size();
    arms.number = [ids](std::uint64_t, std::uint64_t index) { return ids[index]; };
    arms.draw = [&files](campaign::Asked& asked, campaign::Case& c) {
      // For each thread its own: making an fcl::CollisionObject writes to its geometry.
      static thread_local const std::vector<campaign::Scene> own = campaign::readScenes(files.scenes);
      asked.scene = own[c.index];
      asked.question = prepare(asked.scene);
    };
  }
  AnswerLines lines(files.answers.empty() ? 0 : options.cases);
  std::vector<campaign::Scene> written(files.write_scenes.empty() ? 0 : options.cases);
  arms.judges.push_back([&](const campaign::Asked& asked, campaign::Case& c) {
    if (!files.answers.empty()) lines.set(asked, c);
    if (!written.empty()) written[c.index] = asked.scene;
  });
  campaign::Report report = run(campaignOf(arms), options);
  if (!files.answers.empty()) campaign::writeFile(lines.text(), files.answers);
  if (!files.write_scenes.empty()) campaign::writeFile(toText(written), files.write_scenes);
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Seeded queries to fcl_artic, against judges of their own. Exit status 0: no fault; 1: otherwise; 2: "
      "wrong use."};
  std::map<std::string, std::function<campaign::Campaign()>> others = {{"pairs", pair_campaign::campaignOfPairs},
                                                                       {"modes", modes::campaignOfModes}};
#ifdef CAMPAIGN_HAS_URDF
  others["trees"] = [] { return urdf_trees::campaignOfTrees(); };
#endif
  std::vector<std::string> names{"arms"};
  for (const auto& [name, one] : others) names.push_back(name);
  std::string what = "arms";
  campaign::Options options;
  options.cases = 20000;
  campaign::CaseId again;
  app.add_option("--of", what,
                 "arms: arms, trees and bodies among obstacles; pairs: two moving bodies; modes: all modes "
                 "against each other; trees: robots from URDF text")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  app.add_option("--queries", options.cases, "number of cases")->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the campaign")->capture_default_str();
  app.add_option("--threads", options.threads, "threads; 0: one for each core")->check(CLI::Range(0, 1024));
  app.add_option("--class", options.family, "only this class of cases");
  const auto* replay =
      app.add_option("--replay", again.seed,
                     "run the case of this seed (with --class) and describe it; of arms as a file for --scenes");
  app.add_flag("--try-spoiling", options.mutants,
               "spoil a copy of each answer in each way, and count what the judge notices");
  Files files;
  app.add_option("--answers", files.answers,
                 "arms: write each query's answer to this file, a line each: number, hash of the scene, verdict, "
                 "t_lower and t_upper with all bits. scripts/compare-answers compares two of them");
  app.add_option("--scenes", files.scenes, "arms: ask about the scenes of this file, which --write-scenes has written")
      ->excludes("--queries")
      ->excludes("--seed")
      ->excludes("--class");
  app.add_option("--write-scenes", files.write_scenes, "arms: write all scenes to this file, with all bits");
  bool unjudged = false, redon = false;
  app.add_flag("--unjudged", unjudged, "arms: ask only; nothing is examined, and the exit status is 0");
  app.add_flag("--redon2004", redon, "arms: ask for the paper's method");
  CLI11_PARSE(app, argc, argv);
  try {
    campaign::Arms arms;
    if (unjudged) arms.judges.clear();
    if (redon) arms.ways = {campaign::byMethod(fcl_artic::Method::redon2004)};
    const campaign::Campaign chosen = what == "arms" ? campaignOf(arms) : others.at(what)();
    if (*replay) {
      again.family = options.family;
      std::string words;
      const bool good = campaign::replay(chosen, again, words);
      std::fputs(words.c_str(), stdout);
      return good ? 0 : 1;
    }
    const bool terminal = isatty(STDERR_FILENO);
    std::atomic<std::uint64_t> shown{0};
    options.progress = [&](std::uint64_t done) {
      const std::uint64_t percent = 100 * done / std::max<std::uint64_t>(1, options.cases);
      if (terminal && percent > shown.exchange(std::max<std::uint64_t>(shown, percent)))
        std::fprintf(stderr, "\r%3d %%", static_cast<int>(percent));
    };
    std::printf("instruction set: %s\n", fcl_artic::instructionSet());
    const campaign::Report report = what == "arms" ? runArms(std::move(arms), options, files) : run(chosen, options);
    if (terminal) std::fprintf(stderr, "\r");
    std::fputs(toText(report).c_str(), stdout);
    return unjudged || report.total.faults() == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "campaign: %s\n", e.what());
    return 2;
  }
}
