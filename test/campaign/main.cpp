// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>
#include <CLI/CLI.hpp>

#include "arms.h"
#include "fcl_artic/instruction_set.h"
#include "fcl_artic/query_text.h"
#include "modes/rules.h"
#include "pairs/pair_campaign.h"
#ifdef CAMPAIGN_HAS_URDF
#include "urdf/tree_campaign.h"
#endif

namespace {

/// One line for each query, in their order.
class AnswerLines {
 public:
  explicit AnswerLines(std::uint64_t queries) : lines_(queries) {}
  /// Different queries from different threads.
  /// @param query  its text. Its first lines are about who wrote it, and are not hashed.
  void set(std::uint64_t index, const std::string& query, const fcl_artic::CertifiedResult& result) {
    static const char* const verdicts[] = {"free", "contact", "undecided"};
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    for (std::size_t i = query.find("\"robot\""); i < query.size(); ++i)
      hash = (hash ^ static_cast<unsigned char>(query[i])) * 1099511628211u;
    lines_[index] = campaign::format("%llu %016llx %s %s %a %a\n", static_cast<unsigned long long>(index),
                                     static_cast<unsigned long long>(hash), verdicts[static_cast<int>(result.status)],
                                     result.certain ? "certain" : "-", result.t_lower, result.t_upper);
  }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

/// Files of queries and of answers, which the campaign of arms alone has.
struct Files {
  std::string record, recorded, answers;
};

void writeFile(const std::string& file, const std::vector<std::string>& parts) {
  if (file.empty()) return;
  std::ofstream out(file, std::ios::binary);
  for (const std::string& part : parts) out << part;
  if (!out.flush()) throw std::runtime_error("can't write '" + file + "'");
}

/// The queries of a file that --record has written: texts one after the other, each of which ends with a line "}".
std::vector<std::string> readQueries(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("can't read '" + file + "'");
  std::vector<std::string> queries(1);
  for (std::string line; std::getline(in, line);) {
    queries.back() += line + "\n";
    if (line == "}") queries.emplace_back();
  }
  queries.pop_back();
  return queries;
}

campaign::Report askRecorded(const Files& files, campaign::Options& options) {
  const std::vector<std::string> queries = readQueries(files.recorded);
  options.cases = queries.size();
  AnswerLines lines(options.cases);
  campaign::Campaign recorded;
  recorded.look = [&](campaign::Case& c) {
    const std::string& query = queries[c.index];
    c.query([&] { return query; });
    lines.set(c.index, query, fcl_artic::readQuery(query).ask());
  };
  recorded.number = [](std::uint64_t, std::uint64_t index) { return campaign::CaseId{"", index}; };
  recorded.name = "recorded";
  campaign::Report report = run(recorded, options);
  writeFile(files.answers, lines.lines());
  return report;
}

campaign::Report runArms(campaign::Arms arms, const campaign::Options& options, const Files& files) {
  if (files.record.empty() && files.answers.empty()) return run(campaignOf(std::move(arms)), options);
  AnswerLines lines(options.cases);
  std::vector<std::string> queries(options.cases);
  arms.judges.push_back([&](const campaign::Asked& asked, campaign::Case& c) {
    queries[c.index] = asked.question.manager->writeQuery(*asked.question.motion, asked.answers[0].request);
    lines.set(c.index, queries[c.index], asked.result(0));
  });
  campaign::Report report = run(campaignOf(std::move(arms)), options);
  writeFile(files.answers, lines.lines());
  writeFile(files.record, queries);
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
                     "run the case of this seed (with --class), describe it, and write its queries to --failed");
  app.add_option("--failed", options.folder,
                 "folder for the queries of cases that fail: fcl_artic check --replay asks them again.")
      ->capture_default_str();
  app.add_flag("--try-spoiling", options.mutants,
               "spoil a copy of each answer in each way, and count what the judge notices");
  Files files;
  app.add_option("--answers", files.answers,
                 "arms: write each query's answer to this file, a line each: number, hash of the query, verdict, "
                 "t_lower and t_upper with all bits. scripts/compare-answers compares two of them");
  app.add_option("--record", files.record, "arms: write all queries to this file, with all bits");
  app.add_option("--recorded", files.recorded, "ask the queries of this file, which --record has written; unjudged")
      ->excludes("--of")
      ->excludes("--queries")
      ->excludes("--seed")
      ->excludes("--class")
      ->excludes("--record");
  bool unjudged = false, redon = false;
  app.add_flag("--unjudged", unjudged, "arms: ask only; nothing is examined");
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
      const bool good = campaign::replay(chosen, again, options.folder, words);
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
    const campaign::Report report = !files.recorded.empty() ? askRecorded(files, options)
                                    : what == "arms"        ? runArms(std::move(arms), options, files)
                                                            : run(chosen, options);
    if (terminal) std::fprintf(stderr, "\r");
    std::fputs(toText(report).c_str(), stdout);
    return report.total.faults() == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "campaign: %s\n", e.what());
    return 2;
  }
}
