// SPDX-License-Identifier: BSD-3-Clause
// The verbs `bench table1` and `bench depth`, on a few steps, and `bench planning`, on a single problem.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <vector>

#ifdef FCL_ARTIC_HAS_PLANS
#include "bars.h"
#endif
#include "run_program.h"

namespace {

TEST_F(ProgramTest, BenchTable1PutsBothMethodsBesideThePrintedTimes) {
  const Outcome run = this->run("bench table1 --queries 2 --passes 1 --angles 5 --triangles 2000 --csv " +
                                path("table1.csv") + " --svg " + path("table1.svg"));
  EXPECT_EQ(run.status, 0) << run.out << run.err;  // the verdicts agree
  expectContains(run.out, "32.3713");              // Redon 2004, Table 1: 5 degrees, colliding, total
  expectContains(run.out, "8.0184");
  expectContains(run.out, "redon2004-as-written");
  expectContains(run.out, "standard");
  std::ifstream csv(path("table1.csv"));
  int rows = 0;
  for (std::string line; std::getline(csv, line); ++rows) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 18) << line;
  }
  EXPECT_EQ(rows, 15);  // head; twice the printed row, and three methods with stage 2 and without
  EXPECT_TRUE(std::filesystem::exists(path("table1.svg")));
}

TEST_F(ProgramTest, BenchDepthSolvesBothWays) {
  const Outcome run = this->run("bench depth --joints 2 8 --queries 2 --passes 1");
  EXPECT_EQ(run.status, 0) << run.out << run.err;
  expectContains(run.out, "simultaneous");
  expectContains(run.out, "independent");
}

#ifndef FCL_ARTIC_HAS_PLANS

TEST_F(ProgramTest, BenchPlanningIsNotThereWithoutOmpl) {
  const Outcome run = this->run("bench planning --data " + path("nowhere"));
  EXPECT_EQ(run.status, 2);
  expectContains(run.err, "built without OMPL");
}

#else

using fcl_artic::app::BarChart;
using fcl_artic::app::toSvg;

std::vector<double> heightsOfBars(const std::string& svg) {
  const std::regex bar("width=\"[0-9.]+\" height=\"([0-9.]+)\" fill=\"#");
  std::vector<double> heights;
  for (std::sregex_iterator i(svg.begin(), svg.end(), bar), end; i != end; ++i) {
    if ((*i)[1] != "10") heights.push_back(std::stod((*i)[1]));  // those of the legend
  }
  return heights;
}

TEST(Bars, HeightsAreInProportion) {
  const BarChart linear = {"title", "percent", false, {"a", "b"}, {{"one", {20, 40}}, {"two", {0, 10}}}};
  const std::vector<double> h = heightsOfBars(toSvg({linear}));  // a: one, two; b: one, two
  ASSERT_EQ(h.size(), 4u);
  EXPECT_NEAR(h[2], 2 * h[0], 0.11);  // printed to a tenth
  EXPECT_EQ(h[1], 0);
  EXPECT_NEAR(h[3], h[0] / 2, 0.11);
  const BarChart logarithmic = {
      "title", "ms", true, {"a"}, {{"one", {10}}, {"two", {100}}, {"three", {1}}, {"four", {0}}}};
  const std::vector<double> l = heightsOfBars(toSvg({logarithmic}));
  ASSERT_EQ(l.size(), 4u);
  EXPECT_NEAR(l[1], 2 * l[0], 0.11);
  EXPECT_EQ(l[2], 0);  // the axis begins there
  EXPECT_EQ(l[3], 0);
}

TEST_F(ProgramTest, BenchPlanningNamesWhatIsMissing) {
  const Outcome run = this->run("bench planning --data " + path("nowhere"));
  EXPECT_EQ(run.status, 2);
  expectContains(run.err, "nowhere");
  EXPECT_EQ(this->run("bench").status, 2);
}

TEST_F(ProgramTest, BenchPlanningOnOneProblem) {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  if (!data || !std::filesystem::exists(std::filesystem::path(data) / "problems")) {
    GTEST_SKIP() << "FCL_ARTIC_DATA does not name a folder with robots/ and problems/";
  }
  const Outcome run = this->run("bench planning --environment table_pick --problems 1 --out " + path("planning"));
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* validator : {"FCL, OMPL's 1 %", "FCL, 0.1 %", "fcl_artic"}) expectContains(run.out, validator);
  const std::string table = read(path("planning/planning.txt"));
  ASSERT_FALSE(table.empty());
  EXPECT_EQ(run.out.rfind(table, 0), 0u) << table;
  std::istringstream csv(read(path("planning/planning.csv")));
  std::string line;
  int rows = 0;
  for (std::getline(csv, line); std::getline(csv, line); ++rows) {
    expectContains(line, "panda,table_pick,1,1,");
    if (line.find("fcl_artic") != std::string::npos) {
      EXPECT_EQ(line.substr(line.size() - 8), ",0,0,0,0") << line;
    }
  }
  EXPECT_EQ(rows, 3);
  EXPECT_EQ(heightsOfBars(read(path("planning/planning.svg"))).size(), 12u);  // four charts of three bars
}

#endif

}  // namespace
