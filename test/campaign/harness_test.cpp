// SPDX-License-Identifier: BSD-3-Clause
// The harness itself: no fault is lost, and none stays without a name that brings it back.
#include "harness.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

namespace campaign {
namespace harness_test {
namespace {

/// Faults at seeds that end in 3, exceptions at those that end in 7.
Campaign faulty() {
  Campaign campaign;
  campaign.families = {"even", "odd"};
  campaign.number = [](std::uint64_t seed, std::uint64_t index) {
    return CaseId{index % 2 ? "odd" : "even", seed + index};
  };
  campaign.look = [](Case& c) {
    c.tally.count("looked");
    if (c.words) *c.words += "seed " + std::to_string(c.id.seed) + "\n";
    if (c.id.seed % 10 == 3) c.fault("wrong", "once"), c.fault("wrong", "twice");
    if (c.id.seed % 10 == 7) throw std::runtime_error("lost");
  };
  return campaign;
}

Options hundred(int threads) {
  Options o;
  o.cases = 100;
  o.seed = 0;
  o.threads = threads;
  o.folder.clear();
  return o;
}

TEST(Harness, FaultsAreCountedByCasesAndNamed) {
  for (const int threads : {0, 1, 3}) {
    const Report report = run(faulty(), hundred(threads));
    EXPECT_EQ(report.total["cases"], 100u);
    EXPECT_EQ(report.total["looked"], 100u);
    EXPECT_EQ(report.families.at("odd")["cases"], 50u);
    EXPECT_EQ(report.total.faults("wrong"), 10u);
    EXPECT_EQ(report.total.faults("threw"), 10u);
    EXPECT_EQ(report.total.faults(), 20u);
    ASSERT_EQ(report.failures.size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(report.failures[i].id.seed, 10 * (i / 2) + (i % 2 ? 7 : 3));
    EXPECT_NE(toText(report).find("--class odd --replay 7: threw: lost\n"), std::string::npos);
  }
}

TEST(Harness, ACaseComesBackByItsName) {
  std::string words;
  EXPECT_FALSE(replay(faulty(), {"odd", 13}, "", words));
  EXPECT_EQ(words, "seed 13\nFAULT wrong: once\nFAULT wrong: twice\n");
  EXPECT_FALSE(replay(faulty(), {"odd", 17}, "", words));
  EXPECT_TRUE(replay(faulty(), {"odd", 15}, "", words));
}

/// Files of failed cases, and of no others.
TEST(Harness, QueriesOfFailedCasesAreWritten) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "harness_test_failed_cases";
  fs::remove_all(folder);
  Campaign campaign = faulty();
  campaign.name = "some/one";
  campaign.look = [look = campaign.look](Case& c) {
    c.query([&] { return "query of " + std::to_string(c.id.seed); });
    c.queryWithoutFile("it moves as it likes");
    look(c);
  };
  Options o = hundred(2);
  o.folder = folder.string();
  const std::string text = toText(run(campaign, o));
  const std::string file = (folder / "some_one-odd-13-1.json").string();
  EXPECT_NE(text.find("case 13, --class odd --replay 13: wrong: once\n"
                      "case 13, --class odd --replay 13: wrong: twice\n"
                      "  fcl_artic check --replay " +
                      file + "\n  no replay file: it moves as it likes\n"),
            std::string::npos)
      << text;
  std::ifstream in(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "query of 13");
  // Of ten cases of each kind as many as are named: each has two faults of the one kind, or one of the other.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 4 + 8);
  fs::remove_all(folder);
  std::string words;
  EXPECT_TRUE(replay(campaign, {"even", 2}, o.folder, words));
  EXPECT_NE(words.find("some_one-even-2-1.json"), std::string::npos) << words;
  fs::remove_all(folder);
  EXPECT_NE(toText(run(faulty(), o)).find("no replay file: the case has asked no query"), std::string::npos);
}

TEST(Harness, OneClassAloneIfThereIsSuch) {
  Options o = hundred(1);
  o.family = "even";
  const Report report = run(faulty(), o);
  EXPECT_EQ(report.families.size(), 1u);
  EXPECT_EQ(report.total["cases"], 100u);
  o.family = "neither";
  EXPECT_THROW(run(faulty(), o), std::invalid_argument);
}

/// Of a number that should be 0 the judge sees only what is above it.
TEST(Harness, MutantsAreCountedWhereTheyApply) {
  static const std::vector<Mutant<std::uint64_t, int>> mutants = {
      {"seen", 1, [](const std::uint64_t&, int& answer) { return ++answer > 0; }},
      {"unseen", 1, [](const std::uint64_t&, int& answer) { return --answer < 0; }},
      {"seldom", 1, [](const std::uint64_t& seed, int& answer) { return answer = 1, seed % 10 == 0; }}};
  Campaign campaign;
  campaign.look = [](Case& c) {
    const auto judge = [](int answer) {
      return answer > 0 ? std::vector<Finding>{{"wrong", ""}} : std::vector<Finding>();
    };
    tryMutants(mutants, c.id.seed, 0, judge, c);
  };
  Options o = hundred(1);
  EXPECT_TRUE(run(campaign, o).total.mutants().empty());
  o.mutants = true;
  const Tally all = run(campaign, o).total;
  ASSERT_EQ(all.mutants().size(), 3u);
  const std::uint64_t expected[][2] = {{100, 100}, {100, 0}, {10, 10}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [name, m] = all.mutants()[i];
    EXPECT_EQ(m.spoilt, expected[i][0]) << name;
    EXPECT_EQ(m.seen, expected[i][1]) << name;
  }
  EXPECT_EQ(all.faults(), 0u);
}

}  // namespace
}  // namespace harness_test
}  // namespace campaign
