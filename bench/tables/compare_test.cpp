// SPDX-License-Identifier: BSD-3-Clause
// The verb `compare` as a user runs it, and the children that it works with.
#include <csignal>
#include <stdexcept>
#include <thread>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "children.h"
#include "run_program.h"

namespace compare_test {

namespace {

using fcl_artic::app::runInChildren;
using fcl_artic::app::TaskResult;
using End = TaskResult::End;

TaskResult answer(double time) {
  TaskResult r;
  r.end = End::answered;
  r.contact = true;
  r.time = time;
  return r;
}

TEST(ChildrenTest, EachTaskEndsAsItDoesAndTheOthersGoOn) {
  const auto results = runInChildren(8, 0.3, [](std::size_t i) {
    if (i == 1) std::raise(SIGSEGV);
    if (i == 2) std::abort();
    if (i == 4) throw std::runtime_error("no");
    if (i == 5) std::this_thread::sleep_for(std::chrono::seconds(30));
    if (i == 6) _exit(0);  // gone without an answer
    return answer(static_cast<double>(i));
  });
  const std::vector<End> wanted{End::answered, End::crashed,   End::crashed, End::answered,
                                End::refused,  End::timed_out, End::crashed, End::answered};
  ASSERT_EQ(results.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(results[i].end, wanted[i]) << i;
  EXPECT_EQ(results[3].time, 3);
  EXPECT_EQ(results[7].time, 7);
}

TEST(ChildrenTest, NothingToDoIsDone) {
  EXPECT_TRUE(runInChildren(0, 1, [](std::size_t) { return answer(0); }).empty());
}

TEST(ChildrenTest, TheParentsStateStaysAsItIs) {
  int touched = 0;
  const auto results = runInChildren(3, 1, [&](std::size_t) { return answer(++touched); });
  EXPECT_EQ(touched, 0);
  EXPECT_EQ(results[2].time, 3);  // one child did all three
}

using CompareTest = ProgramTest;

TEST_F(CompareTest, FclArticIsRightAndFclIsNot) {
  const Outcome run = this->run("compare --queries 30 --seed 7 --json");
  ASSERT_EQ(run.status, 0) << run.err << run.out;
  const nlohmann::json all = nlohmann::json::parse(run.out);
  ASSERT_EQ(all.at("sets").size(), 3u);
  for (const auto& set : all.at("sets")) {
    EXPECT_EQ(set.at("queries"), 30);
    EXPECT_GT(set.at("hits"), 5);
    EXPECT_LT(set.at("hits"), 27);
    for (const auto& way : set.at("ways")) {
      int sum = 0;
      for (const char* grade : {"right", "late", "early", "missed", "false", "refused", "crashed", "timed_out"})
        sum += way.at(grade).get<int>();
      EXPECT_EQ(sum, 30) << way;
    }
    int ours = 0;
    for (const auto& way : set.at("ways")) {
      if (way.at("way").get<std::string>().rfind("fcl_artic", 0) != 0) continue;
      ++ours;
      EXPECT_EQ(way.at("right"), 30) << way;
    }
    EXPECT_GE(ours, set == all.at("sets").at(0) ? 2 : 1) << "both methods where both bodies are meshes";
    EXPECT_LT(set.at("ways").front().at("right"), 30);
  }
  // What FCL is known for: its public advancement loses mesh contacts and crashes where a shape comes before a mesh.
  EXPECT_GT(all.at("sets").at(0).at("ways").at(2).at("missed"), 5);
  EXPECT_GT(all.at("sets").at(2).at("ways").at(2).at("crashed"), 2);
  // Its oriented routine is right on meshes, within its tolerance.
  EXPECT_GE(all.at("sets").at(0).at("ways").at(3).at("right"), 29);
}

TEST_F(CompareTest, TheSameSeedGivesTheSameCounts) {
  const auto counts = [&] {
    nlohmann::json all = nlohmann::json::parse(this->run("compare --queries 10 --set shapes --seed 3 --json").out);
    for (auto& way : all.at("sets").at(0).at("ways")) way.erase("median_us"), way.erase("p95_us");
    return all;
  };
  EXPECT_EQ(counts(), counts());
}

TEST_F(CompareTest, PrintsATable) {
  const Outcome run = this->run("compare --queries 5 --set meshes");
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* part :
       {"meshes: 5 queries", "right", "missed", "timed out", "median us", "FCL naive, 1000 steps", "fcl_artic"})
    EXPECT_NE(run.out.find(part), std::string::npos) << part << " in\n" << run.out;
  EXPECT_EQ(run.out.find("shapes:"), std::string::npos);
  EXPECT_EQ(run.err, "");
}

TEST_F(CompareTest, WrongUseIsTwo) {
  EXPECT_EQ(run("compare --queries 0").status, 2);
  EXPECT_EQ(run("compare --set spheres").status, 2);
  EXPECT_EQ(run("compare --time-limit -1").status, 2);
}

}  // namespace

}  // namespace compare_test
