// SPDX-License-Identifier: BSD-3-Clause
// The verbs of bench_tables: on a few steps, and on a single problem.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <vector>

#include "run_program.h"

namespace tables_test {

namespace {

// Free steps this close to pipes this coarse compare triangles.
const std::string kFewSteps = " --queries 2 --passes 1 --angles 5 --triangles 2000 --closeness 0.002";

TEST_F(ProgramTest, Table1PutsBothMethodsBesideThePrintedTimes) {
  const Outcome run = this->run("table1" + kFewSteps + " --csv " + path("table1.csv") + " --svg " + path("table1.svg"));
  EXPECT_EQ(run.status, 0) << run.out << run.err;  // the verdicts agree
  expectContains(run.out, "32.37");                // Redon 2004, Table 1: 5 degrees, colliding, total
  expectContains(run.out, "8.0184");
  for (const char* method : {"as-written", "redon2004", "standard"}) expectContains(run.out, method);
  std::ifstream csv(path("table1.csv"));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(csv, line);) {
    rows.emplace_back();
    std::istringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    ASSERT_EQ(rows.back().size(), 19u) << line;
  }
  ASSERT_EQ(rows.size(), 15u);  // head; twice the printed row, and three methods with stage 2 and without
  const auto column = [&](const std::string& key) {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), key) - rows[0].begin());
  };
  int compared = 0;
  for (const auto& row : rows) {
    if (row[column("method")] != "redon2004") continue;
    EXPECT_GT(std::stod(row[column("leaf_pairs")]), 0) << row[column("steps")];
    EXPECT_GT(std::stod(row[column("median_ms")]), 0);
    ++compared;
  }
  EXPECT_EQ(compared, 2);  // colliding and free
  EXPECT_TRUE(std::filesystem::exists(path("table1.svg")));
}

TEST_F(ProgramTest, Table1RefusesStepsThatCompareNoTriangles) {
  // Steps of 0.01 degrees at any distance.
  const Outcome run =
      this->run("table1 --queries 2 --passes 1 --angles 0.01 --triangles 1000 --closeness 5 --executor none --csv " +
                path("table1.csv"));
  EXPECT_EQ(run.status, 2) << run.out;
  expectContains(run.err, "the free steps of 0.01 degrees have no leaf pairs");
  expectContains(read(path("table1.csv")), "0.01,NO-COL,refused,");
  expectContains(read(path("table1.csv")), "0.01,COL,standard,");
}

TEST_F(ProgramTest, Table1TakesPipesAsOneMeshToo) {
  const std::string command =
      "table1 --queries 2 --passes 1 --angles 5 --triangles 10000 --closeness 0.002 --executor none";
  const Outcome apart = this->run(command), one = this->run(command + " --one-mesh");
  EXPECT_EQ(apart.status, 0) << apart.err;
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_TRUE(std::regex_search(apart.out, std::regex("10000 triangles, [2-9][0-9]* obstacles"))) << apart.out;
  expectContains(one.out, "10000 triangles, one mesh");
}

TEST_F(ProgramTest, IdeasHasARowForEachOption) {
  const Outcome run = this->run("ideas" + kFewSteps + " --csv " + path("ideas.csv"));
  EXPECT_EQ(run.status, 0) << run.out << run.err;
  const std::string csv = read(path("ideas.csv"));
  for (const char* option :
       {"defaults", "refinement_level 0", "no newton", "no early_validity", "no in_time_order", "no simultaneous"}) {
    expectContains(run.out, std::string("\n") + option + " ");
    expectContains(csv, std::string("\n") + option + ",5,COL,0,");
    expectContains(csv, std::string("\n") + option + ",5,NO-COL,0,");
  }
  // One by one there are as many intervals as evaluations; all at once, few.
  std::smatch all, single;
  const std::string number = "([0-9.]+)", counts = ",5,COL,0(?:,[0-9.]+){5}," + number + "," + number + "\n";
  ASSERT_TRUE(std::regex_search(csv, all, std::regex("\ndefaults" + counts)));
  ASSERT_TRUE(std::regex_search(csv, single, std::regex("\nno simultaneous" + counts)));
  EXPECT_LT(std::stod(all[1]), std::stod(all[2]));
  EXPECT_EQ(single[1], single[2]);

  const Outcome short_of_work = this->run("ideas" + kFewSteps + " --budget 10 --csv " + path("ideas.csv"));
  EXPECT_EQ(short_of_work.status, 0) << short_of_work.err;
  expectContains(read(path("ideas.csv")), "\ndefaults,5,COL,2,");  // both undecided
}

#ifdef FCL_ARTIC_HAS_PLANS

TEST_F(ProgramTest, PlanningNamesWhatIsMissing) {
  const Outcome run = this->run("planning --data " + path("nowhere"));
  EXPECT_EQ(run.status, 2);
  expectContains(run.err, "nowhere");
}

TEST_F(ProgramTest, PlanningOnOneProblem) {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  if (!data || !std::filesystem::exists(std::filesystem::path(data) / "problems")) {
    GTEST_SKIP() << "FCL_ARTIC_DATA does not name a folder with robots/ and problems/";
  }
  const Outcome run = this->run("planning --environment table_pick --problems 1 --csv " + path("planning.csv"));
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* validator : {"FCL, OMPL's 1 %", "FCL, 0.1 %", "fcl_artic"}) expectContains(run.out, validator);
  std::istringstream csv(read(path("planning.csv")));
  std::string line;
  int rows = 0;
  for (std::getline(csv, line); std::getline(csv, line); ++rows) {
    expectContains(line, "panda,table_pick,1,1,");
    if (line.find("fcl_artic") != std::string::npos) {
      EXPECT_EQ(line.substr(line.size() - 8), ",0,0,0,0") << line;
    }
  }
  EXPECT_EQ(rows, 3);
}

/// A wall with a hole in the middle, and a bar that goes through it only straight.
TEST_F(ProgramTest, RigidPlansABarThroughAHole) {
  const auto box = [](std::ostream& out, int& vertices, const double(&lo)[3], const double(&hi)[3]) {
    for (int i = 0; i < 8; ++i) {
      out << "v " << (i & 1 ? hi : lo)[0] << " " << (i & 2 ? hi : lo)[1] << " " << (i & 4 ? hi : lo)[2] << "\n";
    }
    for (const auto& quad :
         {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
      out << "f";
      for (const int corner : quad) out << " " << vertices + corner;
      out << "\n";
    }
    vertices += 8;
  };
  int vertices = 0;
  std::ofstream bar(path("bar.obj"));
  box(bar, vertices, {-0.4, -0.1, -0.1}, {0.4, 0.1, 0.1});
  bar.close();
  vertices = 0;
  std::ofstream wall(path("wall.obj"));
  box(wall, vertices, {-0.05, -2, -2}, {0.05, 2, -0.3});
  box(wall, vertices, {-0.05, -2, 0.3}, {0.05, 2, 2});
  box(wall, vertices, {-0.05, -2, -0.3}, {0.05, -0.3, 0.3});
  box(wall, vertices, {-0.05, 0.3, -0.3}, {0.05, 2, 0.3});
  wall.close();
  const std::string problem =
      "[problem]\nname = hole\nrobot = bar.obj\nworld = wall.obj\nstart.x = -1\nstart.y = 0.5\nstart.z = 0\n"
      "start.theta = 0.3\nstart.axis.x = 0\nstart.axis.y = 0\nstart.axis.z = 1\ngoal.x = 1\ngoal.y = -0.5\ngoal.z = 0\n"
      "goal.theta = 0\ngoal.axis.x = 1\ngoal.axis.y = 0\ngoal.axis.z = 0\n";
  std::ofstream(path("hole.cfg")) << problem << "volume.min.x = -1.5\nvolume.min.y = -1.5\nvolume.min.z = -1.5\n"
                                  << "volume.max.x = 1.5\nvolume.max.y = 1.5\nvolume.max.z = 1.5\n";
  const Outcome run = this->run("rigid " + path("hole.cfg") + " --seeds 1 --csv " + path("rigid.csv"));
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  std::istringstream csv(read(path("rigid.csv")));
  std::string line;
  std::getline(csv, line);
  for (const std::string validator : {"FCL, OMPL's 1 %", "FCL, as OMPL.app", "fcl_artic"}) {
    std::getline(csv, line);
    expectContains(line, "hole,\"" + validator + "\",1,1,");
  }
  EXPECT_EQ(line.substr(line.size() - 4), ",0,0") << line;  // ours, seen to collide neither raw nor simplified

  std::ofstream(path("hole.cfg")) << problem;
  const Outcome unbounded = this->run("rigid " + path("hole.cfg"));
  EXPECT_EQ(unbounded.status, 2);
  expectContains(unbounded.err, "[problem] has no number 'volume.min.x'");
}

TEST_F(ProgramTest, CertifyFindsWhatSamplingHides) {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  if (!data || !std::filesystem::exists(std::filesystem::path(data) / "problems")) {
    GTEST_SKIP() << "FCL_ARTIC_DATA does not name a folder with robots/ and problems/";
  }
  const Outcome run =
      this->run("certify --environment bookshelf_small --problems 3 --mend-time 2 --csv " + path("certify.csv"));
  ASSERT_EQ(run.status, 0) << run.out << run.err;  // none that is seen to collide was certified free
  std::istringstream csv(read(path("certify.csv")));
  std::string line;
  int rows = 0, touching = 0;
  for (std::getline(csv, line); std::getline(csv, line); ++rows) {
    expectContains(line, "panda,bookshelf_small,");
    touching += line.find(",contact,") != std::string::npos;
  }
  EXPECT_EQ(rows, 3);
  EXPECT_GE(touching, 1);
}

TEST_F(ProgramTest, CertifyTakesPlansOfAnotherPlanner) {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  if (!data || !std::filesystem::exists(std::filesystem::path(data) / "problems")) {
    GTEST_SKIP() << "FCL_ARTIC_DATA does not name a folder with robots/ and problems/";
  }
  const std::string table_pick = R"({"name": "table_pick/1", "from": [0, -0.785, 0, -2.356, 0, 1.571, 0.785],)"
                                 R"( "to": [0.1, -0.785, 0, -2.356, 0, 1.571, 0.785]})";
  const std::string into_table = R"({"name": "table_pick/3", "from": [0, -0.785, 0, -2.356, 0, 1.571, 0.785],)"
                                 R"( "to": [0, 1.7, 0, -0.3, 0, 1.571, 0.785]})";
  std::ofstream(path("plans.jsonl")) << table_pick << "\n" << into_table << "\n";
  const Outcome run = this->run("certify --mend-time 1 --plans " + path("plans.jsonl") + " --csv " + path("given.csv"));
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  const std::string csv = read(path("given.csv"));
  expectContains(csv, "panda,table_pick,1,1,2,0,free,");
  expectContains(csv, "panda,table_pick,3,1,2,1,contact,");

  std::ofstream(path("plans.jsonl")) << R"({"name": "tabel_pick/1", "from": [0, -0.785, 0, -2.356, 0, 1.571, 0.785],)"
                                     << R"( "to": [0.1, -0.785, 0, -2.356, 0, 1.571, 0.785]})";
  const Outcome misnamed = this->run("certify --plans " + path("plans.jsonl"));
  EXPECT_EQ(misnamed.status, 2);
  expectContains(misnamed.err, "1 of 1 plans name no problem of panda's");
}

#endif

}  // namespace

}  // namespace tables_test
