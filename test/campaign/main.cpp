// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>
#include <CLI/CLI.hpp>

#include "fcl_artic/instruction_set.h"
#include "generator.h"
#include "run.h"
#include "scene_file.h"

namespace {

/// One line for each query, in their order.
class AnswerLines {
 public:
  explicit AnswerLines(std::uint64_t queries) : lines_(queries) {}
  /// Different queries from different threads.
  void set(std::uint64_t query, const campaign::Scene& scene, const fcl_artic::CertifiedResult& result) {
    static const char* const verdicts[] = {"free", "contact", "undecided"};
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    for (const char c : campaign::describe(scene)) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    char line[200];
    std::snprintf(line, sizeof line, "%llu %016llx %s %s %a %a\n", static_cast<unsigned long long>(query),
                  static_cast<unsigned long long>(hash), verdicts[static_cast<int>(result.status)],
                  result.certain ? "certain" : "-", result.t_lower, result.t_upper);
    lines_[query] = line;
  }
  void write(const std::string& file) const {
    std::FILE* out = std::fopen(file.c_str(), "w");
    if (!out) throw std::runtime_error("can't write '" + file + "'");
    for (const std::string& line : lines_) std::fputs(line.c_str(), out);
    const bool failed = std::ferror(out) != 0;
    if (std::fclose(out) != 0 || failed) throw std::runtime_error("can't write '" + file + "'");
  }

 private:
  std::vector<std::string> lines_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Seeded queries to fcl_artic against an oracle of its own. Exit status 0: no fault, and hits between 30 and "
      "70 %; 1: otherwise; 2: wrong use."};
  campaign::Options options;
  std::string spoil = "none";
  std::uint64_t replay = 0;
  app.add_option("--queries", options.queries, "number of queries")->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the campaign")->capture_default_str();
  app.add_option("--threads", options.threads, "threads")->capture_default_str()->check(CLI::Range(1, 1024));
  app.add_option("--class", options.family, "only this class")->check(CLI::IsMember(campaign::families()));
  const auto* again = app.add_option("--replay", replay, "run the query of this seed (with --class) and dump it");
  app.add_option("--spoil", spoil,
                 "spoil the answers on purpose, to see that it is noticed: late, drop, invent, widen, point, "
                 "normal, poses, certain, pair")
      ->capture_default_str();
  app.add_flag("--try-spoiling", options.try_corruptions,
               "spoil a copy of each answer in each way, and count what is noticed");
  std::string answers;
  app.add_option("--answers", answers,
                 "write each query's answer to this file, a line each: number, hash of the scene, verdict, t_lower and "
                 "t_upper with all bits. scripts/compare-answers compares two of them");
  std::string write;
  app.add_option("--scenes", options.scenes, "ask about the scenes of this file, which --write-scenes has written")
      ->excludes("--queries")
      ->excludes("--seed")
      ->excludes("--class");
  app.add_option("--write-scenes", write, "write all scenes to this file, with all bits");
  bool unjudged = false;
  app.add_flag("--unjudged", unjudged, "ask only: nothing is examined, and the exit status is 0");
  bool redon = false;
  app.add_flag("--redon2004", redon, "ask for the paper's method");
  CLI11_PARSE(app, argc, argv);
  options.judge = !unjudged;
  if (redon) options.how.method = fcl_artic::Method::redon2004;
  try {
    if (*again) {
      if (options.family.empty()) {
        std::fprintf(stderr, "campaign: --replay needs --class\n");
        return 2;
      }
      std::string words;
      const bool good = campaign::replay(options.family, replay, options.how, words);
      std::fputs(words.c_str(), stdout);
      return good ? 0 : 1;
    }
    options.corruption = campaign::corruptionOf(spoil);
    if (!options.scenes.empty()) options.queries = campaign::readScenes(options.scenes).size();
    const bool terminal = isatty(STDERR_FILENO);
    std::atomic<std::uint64_t> shown{0};
    options.progress = [&](std::uint64_t done) {
      const std::uint64_t percent = 100 * done / options.queries;
      if (terminal && percent > shown.exchange(std::max<std::uint64_t>(shown, percent)))
        std::fprintf(stderr, "\r%3d %%", static_cast<int>(percent));
    };
    AnswerLines lines(answers.empty() ? 0 : options.queries);
    std::vector<campaign::Scene> written(write.empty() ? 0 : options.queries);
    options.answered = [&](std::uint64_t i, const campaign::Scene& scene, const fcl_artic::CertifiedResult& result) {
      if (!answers.empty()) lines.set(i, scene, result);
      if (!write.empty()) written[i] = scene;
    };
    std::printf("instruction set: %s\n", fcl_artic::instructionSet());
    const campaign::Report report = campaign::run(options);
    if (!answers.empty()) lines.write(answers);
    if (!write.empty()) campaign::writeScenes(written, write);
    if (terminal) std::fprintf(stderr, "\r");
    std::fputs(campaign::toText(report).c_str(), stdout);
    if (unjudged) return 0;
    const double share = report.total.hitShare();
    return report.total.faulty() == 0 && (!options.family.empty() || (share >= 0.3 && share <= 0.7)) ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "campaign: %s\n", e.what());
    return 2;
  }
}
