// SPDX-License-Identifier: BSD-3-Clause
// certify --edges: many edges times many scenes, against `check` one by one; killed, damaged, cut off, and merged.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "edges/inputs.h"
#include "hdf5/hdf5.h"
#include "run_program.h"

namespace edges_test {

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;
using fcl_artic::hdf5::File;
using fcl_artic::hdf5::Image;

class EdgesTest : public ProgramTest {
 protected:
  /// A ball and a box in the arm's way, a file each.
  void writeScenes() const {
    ball();
    fs::create_directories(folder_ / "scenes");
    fs::copy_file(path("ball.urdf"), path("scenes/a_ball.urdf"), fs::copy_options::overwrite_existing);
    write("scenes/b_box.urdf", R"(<robot name="box"><link name="box"><collision><origin xyz="0.2 -0.7 0"/>
      <geometry><box size="0.3 0.2 0.2"/></geometry></collision></link></robot>)");
    write("scenes/notes.txt", "no scene");
  }

  /// Random edges of the arm, the joints in the other order than the robot's, two columns each.
  std::string edges(std::size_t count, unsigned seed = 1, const std::string& name = "edges.h5") const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> hinge(-1, 2), rail(-1, 1);
    from_.clear();
    to_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      for (auto* ends : {&from_, &to_}) {
        ends->push_back(rail(random));
        ends->push_back(hinge(random));
      }
    }
    Image image;
    image.add("from", {count, 2}, from_.data());
    image.add("to", {count, 2}, to_.data());
    image.attribute("from", "joints", std::vector<std::string>{"rail", "hinge"});
    return write(name, image.bytes());
  }

  std::string command(const std::string& out, const std::string& more = "") const {
    return "certify --edges " + path("edges.h5") + " --robot " + path("arm.urdf") + " --scenes " + path("scenes") +
           " --out " + path(out) + " --threads 1 " + more;
  }
  Json summary(const std::string& out) const { return Json::parse(read(path(out + "/summary.json"))); }
  std::string hash(const std::string& out) const { return summary(out).at("table_sha256"); }
  std::string block(const std::string& out, int number) const {
    char name[64];
    std::snprintf(name, sizeof name, "/blocks/block-%07d.h5", number);
    return path(out + name);
  }

  /// Starts the program, and kills it if it still runs after so many ms. @return whether it was killed.
  bool runAndKill(const std::string& arguments, int ms) const {
    const pid_t child = fork();
    if (child == 0) {
      setpgid(0, 0);
      const int null = open("/dev/null", O_WRONLY);
      dup2(null, 1);
      dup2(null, 2);
      const std::string line = std::string("exec \"") + FCL_ARTIC_PROGRAM + "\" " + arguments;
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(ms);
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() >= end) {
        kill(child, SIGKILL);
        waitpid(child, &status, 0);
        return WIFSIGNALED(status);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  mutable std::vector<double> from_, to_;  ///< of edges(): rail, hinge
};

/// A column of a table of two dimensions, row by row.
template <class T>
std::vector<T> column(const File& table, const std::string& name) {
  std::vector<T> values;
  table.read(name, 0, table.shape(name)[0], values);
  return values;
}

const char* const kStatus[] = {"missing", "free", "contact", "undecided", "refused"};

TEST_F(EdgesTest, TheTableSaysWhatCheckSaysOneByOne) {
  constexpr std::size_t kEdges = 150;
  arm();
  writeScenes();
  edges(kEdges);
  const Outcome done = run(command("made", "--block-rows 40"));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("300 rows in 8 blocks"), std::string::npos) << done.out;
  EXPECT_NE(done.err.find("passed over, as a scene's ending is none of theirs: notes.txt"), std::string::npos)
      << done.err;

  const File table(path("made/table.h5"));
  ASSERT_EQ(table.shape("status"), (std::vector<std::size_t>{2, kEdges}));
  const auto status = column<std::int64_t>(table, "status"), certain = column<std::int64_t>(table, "certain");
  const auto link = column<std::int64_t>(table, "link"), obstacle = column<std::int64_t>(table, "obstacle");
  const auto other = column<std::int64_t>(table, "other_link");
  const auto lower = column<double>(table, "t_lower"), upper = column<double>(table, "t_upper");
  const std::vector<std::string> links = table.strings("", "links");
  std::map<std::string, int> seen;
  const char* const scenes[] = {"scenes/a_ball.urdf", "scenes/b_box.urdf"};
  const char* const names[] = {"ball", "box"};
  for (std::size_t s = 0; s < 2; ++s) {
    std::string questions;
    for (std::size_t e = 0; e < kEdges; ++e) {
      questions += Json{{"from", {from_[2 * e + 1], from_[2 * e]}}, {"to", {to_[2 * e + 1], to_[2 * e]}}}.dump() + "\n";
    }
    const Outcome one_by_one = run("check --robot " + path("arm.urdf") + " --scene " + path(scenes[s]) + " --lines " +
                                   write("q.jsonl", questions));
    std::istringstream lines(one_by_one.out);
    std::string line;
    for (std::size_t e = 0; e < kEdges; ++e) {
      ASSERT_TRUE(std::getline(lines, line)) << one_by_one.err;
      const Json answer = Json::parse(line);
      const std::size_t row = s * kEdges + e;
      const std::string said = kStatus[status[row]];
      ++seen[said];
      ASSERT_EQ(said, answer.at("status")) << "scene " << s << ", edge " << e;
      EXPECT_EQ(lower[row], answer.at("t_lower").get<double>());
      EXPECT_EQ(upper[row], answer.at("t_upper").get<double>());
      if (said != "contact") {
        EXPECT_EQ(link[row], -1);
        continue;
      }
      EXPECT_EQ(certain[row] != 0, answer.at("certain").get<bool>());
      const Json& contact = answer.at("contacts").at(0);
      ASSERT_GE(link[row], 0);
      EXPECT_EQ(links.at(static_cast<std::size_t>(link[row])), contact.at("body1").at("name"));
      EXPECT_EQ(other[row], -1);
      EXPECT_EQ(obstacle[row], 0);
      EXPECT_EQ(contact.at("body2").at("name"), names[s]);
    }
  }
  std::printf("of %zu rows: %d free, %d contact\n", status.size(), seen["free"], seen["contact"]);
  EXPECT_GT(seen["free"], 50);
  EXPECT_GT(seen["contact"], 50);
}

TEST_F(EdgesTest, RowsSayWhatFreeDoesNotSpeakOf) {
  // Two edges from within the box of the second scene: one stays in it, one leaves it. A third one is nowhere near.
  arm();
  writeScenes();
  const std::vector<double> from = {0, -1.3, 0, -1.3, 0, 1.5}, to = {0, -1.31, 0, 1.5, 0, 1.6};
  Image image;
  image.add("from", {3, 2}, from.data());
  image.add("to", {3, 2}, to.data());
  image.attribute("from", "joints", std::vector<std::string>{"rail", "hinge"});
  write("edges.h5", image.bytes());
  ASSERT_EQ(run(command("strict", "--ignore-limits")).status, 0);
  const File strict(path("strict/table.h5"));
  ASSERT_EQ(column<std::int64_t>(strict, "status"), (std::vector<std::int64_t>{1, 2, 1, 2, 2, 1}))
      << "else it tells nothing";
  EXPECT_EQ(column<std::int64_t>(strict, "ignored_initial"), (std::vector<std::int64_t>{0, 0, 0, 0, 0, 0}));
  const Outcome done = run(command("run", "--ignore-limits --ignore-initial-contact"));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(
      done.out.find("; 1 free but for the initial contact of some pair; 1 free but for pairs that never come apart\n"),
      std::string::npos)
      << done.out;
  const File table(path("run/table.h5"));
  EXPECT_EQ(column<std::int64_t>(table, "ignored_initial"), (std::vector<std::int64_t>{0, 0, 0, 1, 1, 0}));
  EXPECT_EQ(column<std::int64_t>(table, "never_apart"), (std::vector<std::int64_t>{0, 0, 0, 1, 0, 0}));
  const Json counts = summary("run");
  EXPECT_EQ(counts.at("free_with_never_apart_pairs"), 1);
  EXPECT_EQ(counts.at("free_with_ignored_initial_contacts"), 1);
  EXPECT_EQ(counts.at("free_with_unproven_allowed_pairs"), 0);
  // Other blocks of the same rows: the same counts.
  ASSERT_EQ(run(command("blocks", "--ignore-limits --ignore-initial-contact --block-rows 2")).status, 0);
  EXPECT_EQ(summary("blocks").at("free_with_never_apart_pairs"), 1);
}

TEST_F(EdgesTest, TrajectoriesNumbersOfConfigurationsAndScenesOfTheirOwn) {
  arm();
  writeScenes();
  // The arm meets the ball on its way from 0 to 1.5, not up to 0.5; the box below it on its way to -1.
  const double q[] = {0, 0, 0.5, 0, 1.5, 0, -1, 0};
  {
    Image image;
    image.add("configurations", {4, 2}, q);
    const std::int64_t ends[] = {0, 1, 0, 2, 0, 3};
    image.add("edges", {3, 2}, ends);
    write("edges.h5", image.bytes());
  }
  ASSERT_EQ(run(command("numbers")).status, 0);
  const auto numbers = column<std::int64_t>(File(path("numbers/table.h5")), "status");
  EXPECT_EQ(numbers, (std::vector<std::int64_t>{1, 2, 1, 1, 1, 2}));
  {
    Image image;
    const double way[] = {0, 0, 0.5, 0, 1.5, 0, 0, 0, -1, 0};
    const double times[] = {10, 11, 13, 5, 6};
    image.add("waypoints", {5, 2}, way);
    image.add("times", {5}, times);
    const std::int64_t first[] = {0, 3, 5};
    image.add("first", {3}, first);
    const std::int64_t scene[] = {0, 1};
    image.add("scene", {2}, scene);
    write("edges.h5", image.bytes());
  }
  ASSERT_EQ(run(command("ways")).status, 0);
  const File ways(path("ways/table.h5"));
  ASSERT_EQ(ways.shape("status"), std::vector<std::size_t>{2});
  EXPECT_EQ(column<std::int64_t>(ways, "status"), (std::vector<std::int64_t>{2, 2}));
  const double contact = M_PI / 3 - std::asin(0.15 / 0.6);  // as in program_test.cpp
  const auto lower = column<double>(ways, "t_lower"), upper = column<double>(ways, "t_upper");
  EXPECT_LE(lower[0], 11 + 2 * (contact - 0.5) + 1e-9);
  EXPECT_GE(upper[0], 11 + 2 * (contact - 0.5) - 1e-9);
  EXPECT_NEAR(upper[0], 11 + 2 * (contact - 0.5), 1e-5);
  EXPECT_GT(lower[1], 5);
}

TEST_F(EdgesTest, WhatIsKilledGoesOnToTheSameTable) {
  arm();
  writeScenes();
  edges(40000);
  const std::string cut = "--block-rows 1000 --quiet --any";
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run(command("undisturbed", cut)).status, 0);
  const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
  const std::string wanted = hash("undisturbed");
  std::mt19937 random(7);
  int killed = 0;
  const std::vector<std::string> shards[] = {{""}, {"--shard 1/3", "--shard 2/3", "--shard 3/3"}};
  for (const auto& parts : shards) {
    const std::string out = "killed" + std::to_string(parts.size());
    for (const std::string& part : parts) {
      for (int k = 0; k < 3; ++k) {
        // (Each run goes on where the one before was killed.)
        killed += runAndKill(command(out, cut + " " + part),
                             std::uniform_int_distribution<int>(
                                 1, static_cast<int>(whole.count()) / (2 + static_cast<int>(parts.size())))(random));
      }
      const Outcome last = run(command(out, cut + " " + part));
      ASSERT_EQ(last.status, 0) << last.err;
    }
    ASSERT_EQ(run("certify --merge --out " + path(out)).status, 0);
    EXPECT_EQ(hash(out), wanted) << parts.size() << " shards";
    for (const auto& entry : fs::directory_iterator(path(out + "/blocks"))) {
      EXPECT_EQ(entry.path().extension(), ".h5") << "left behind: " << entry.path();
    }
  }
  std::printf("%d of 12 runs were killed, an undisturbed one takes %d ms\n", killed, static_cast<int>(whole.count()));
  EXPECT_GT(killed, 2);
}

#ifdef FCL_ARTIC_MPIRUN
TEST_F(EdgesTest, RanksMakeTheSameTable) {
  arm();
  writeScenes();
  edges(10000);
  const std::string cut = "--block-rows 500 --quiet --any";
  ASSERT_EQ(run(command("alone", cut)).status, 0);
  for (const char* ranks : {"2", "3"}) {
    const std::string out = std::string("ranks") + ranks;
    const std::string line =
        std::string(geteuid() == 0 ? "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 " : "") +
        FCL_ARTIC_MPIRUN + " --oversubscribe --bind-to none -n " + ranks + " " + FCL_ARTIC_PROGRAM + " " +
        command(out, cut) + " >" + path("out") + " 2>" + path("err");
    ASSERT_EQ(std::system(line.c_str()), 0) << read(path("err"));
    EXPECT_EQ(hash(out), hash("alone")) << ranks << " ranks";
  }
  // A job without MPI's own starter.
  EXPECT_EQ(run(command("ranks2", cut + " --shard 1/1")).status, 0);
}
#endif

TEST_F(EdgesTest, ADamagedBlockIsNamedAndTheOthersStay) {
  arm();
  writeScenes();
  edges(6000);
  const std::string cut = "--block-rows 2000 --quiet";
  ASSERT_EQ(run(command("made", cut)).status, 0);
  const std::string wanted = hash("made"), path1 = block("made", 1), whole = read(path1);
  // A bit of the rows, a bit anywhere, half of the file, nothing of it, another block's, another run's.
  std::vector<std::string> damaged;
  int flipped = 0, harmless = 0;
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 40 + 1) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    damaged.push_back(changed);
  }
  flipped = static_cast<int>(damaged.size());
  damaged.push_back(whole.substr(0, whole.size() / 2));
  damaged.emplace_back();
  damaged.push_back(read(block("made", 2)));
  // One more free, one less in contact: rows and their hash as they were.
  const auto at = whole.find("{\"missing\":0,\"free\":");
  ASSERT_NE(at, std::string::npos);
  const std::string counts = whole.substr(at, whole.find('}', at) - at);
  const auto changed = [&](const char* key, int by) {
    const auto value = counts.find(std::string("\"") + key + "\":") + std::string(key).size() + 3;
    const std::string now = std::to_string(std::stoi(counts.substr(value)) + by);
    std::string text = whole;
    return text.replace(at + value, now.size(), now);
  };
  damaged.push_back(changed("free", 1));               // another sum
  damaged.push_back(changed("contact_uncertain", 1));  // other counts of as many rows
  for (std::size_t k = 0; k < damaged.size(); ++k) {
    write("made/blocks/block-0000001.h5", damaged[k]);
    const Outcome merged = run("certify --merge --out " + path("made"));
    // A bit that HDF5 does not use changes no row: the table is the same then.
    if (merged.status == 0 && k < static_cast<std::size_t>(flipped)) {
      ++harmless;
      EXPECT_EQ(hash("made"), wanted);
      continue;
    }
    ASSERT_EQ(merged.status, 2) << k;
    EXPECT_NE(merged.err.find(path1), std::string::npos) << merged.err;
    EXPECT_NE(merged.err.find("block 1 "), std::string::npos) << merged.err;
  }
  std::printf("of %d flipped bits %d are in no row\n", flipped, harmless);
  EXPECT_GT(flipped - harmless, 10);
  write("made/blocks/block-0000001.h5", whole.substr(0, whole.size() / 2));
  const Outcome again = run(command("made", cut));
  EXPECT_EQ(again.status, 2);
  EXPECT_NE(again.err.find(path1), std::string::npos) << again.err;
  // As the message says.
  fs::remove(path1);
  ASSERT_EQ(run(command("made", cut)).status, 0);
  EXPECT_EQ(hash("made"), wanted);
}

TEST_F(EdgesTest, WhatWasNotComputedIsNeverFree) {
  arm();
  writeScenes();
  edges(300);
  const std::string cut = "--block-rows 100 --quiet";
  ASSERT_EQ(run(command("made", cut)).status, 0);
  const Json all = summary("made");
  fs::remove(block("made", 4));
  const Outcome refused = run("certify --merge --out " + path("made"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("1 of 6 blocks are missing: 4"), std::string::npos) << refused.err;
  // Also in the table that was made while it was there.
  for (const bool merged_anew : {false, true}) {
    if (merged_anew) {
      ASSERT_EQ(run("certify --merge --partial --out " + path("made")).status, 0);
      EXPECT_EQ(summary("made").at("missing"), 100);
      EXPECT_LT(summary("made").at("free"), all.at("free"));
      EXPECT_NE(hash("made"), all.at("table_sha256"));
    }
    const auto status = column<std::int64_t>(File(path("made/table.h5")), "status");
    ASSERT_EQ(status.size(), 600u);
    for (std::size_t row = 0; row < status.size(); ++row) EXPECT_EQ(status[row] == 0, row >= 400 && row < 500) << row;
  }
}

TEST_F(EdgesTest, ErrorsNameTheThingAndLoseNothing) {
  arm();
  writeScenes();
  edges(300);
  const std::string cut = "--block-rows 100 --quiet";
  ASSERT_EQ(run(command("wanted", cut)).status, 0);
  const std::string wanted = hash("wanted");

  // A scene that can't be read: the other one's blocks are done.
  const std::string box = read(path("scenes/b_box.urdf"));
  write("scenes/b_box.urdf", "<robot name='x'>");
  Outcome bad = run(command("made", cut));
  EXPECT_EQ(bad.status, 2);
  EXPECT_NE(bad.err.find("b_box.urdf"), std::string::npos) << bad.err;
  write("scenes/b_box.urdf", box);

  // A file that may not grow, as on a full disk: blocks are larger than 1 KiB.
  const std::string limited = "ulimit -f 1; exec \"" + std::string(FCL_ARTIC_PROGRAM) + "\" ";
  write("full.sh", limited + command("full", cut) + " 2>" + path("err"));
  EXPECT_EQ(WEXITSTATUS(std::system(("bash " + path("full.sh")).c_str())), 2);
  EXPECT_NE(read(path("err")).find("cannot write"), std::string::npos) << read(path("err"));
  EXPECT_NE(read(path("err")).find("full/"), std::string::npos) << read(path("err"));
  ASSERT_EQ(run(command("full", cut)).status, 0);
  EXPECT_EQ(hash("full"), wanted);

  // Other inputs than the folder's.
  const Outcome other = run(command("wanted", cut + " --margin 0.01"));
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("'request.margin' was 0.0 and is 0.01"), std::string::npos) << other.err;
  EXPECT_EQ(hash("wanted"), wanted);

  const struct {
    std::string arguments, named;
  } cases[] = {
      {command("x") + "--scenes " + path("gone.urdf"), "gone.urdf': no such file"},
      {command("x") + "--shard 0/3", "--shard '0/3'"},
      {command("x") + "--shard 4/3", "--shard '4/3'"},
      {command("x") + "--block-rows 0", "--block-rows"},
      {"certify --merge --out " + path("nowhere"), "nowhere/run.json"},
      {"certify --edges " + path("arm.urdf") + " --robot " + path("arm.urdf") + " --out " + path("x"),
       "arm.urdf': can't be read as an HDF5 file"},
      {"certify --edges " + path("edges.h5") + " --robot " + path("arm.urdf"), "--out DIR"},
      {"certify --edges " + path("edges.h5") + " --out " + path("x"), "--robot"},
  };
  for (const auto& one : cases) {
    const Outcome outcome = run(one.arguments);
    EXPECT_EQ(outcome.status, 2) << one.arguments;
    EXPECT_NE(outcome.err.find(one.named), std::string::npos) << one.arguments << "\n" << outcome.err;
  }
}

TEST_F(EdgesTest, AWrongColumnIsNamed) {
  arm();
  writeScenes();
  const double q[] = {0, 0, 0.5, 0, 1.5, 0};
  const auto file = [&](const std::vector<std::string>& joints, const std::vector<std::string>& sets,
                        std::size_t columns) {
    Image image;
    for (const std::string& set : sets) image.add(set, {6 / columns, columns}, q);
    if (!joints.empty()) image.attribute("", "joints", joints);
    write("edges.h5", image.bytes());
  };
  const struct {
    std::vector<std::string> joints, sets;
    std::size_t columns;
    std::string named;
  } cases[] = {
      {{"rail", "hinges"},
       {"from", "to"},
       2,
       "column 1 of dataset 'from' is of joint 'hinges', which robot 'arm' does not have; did you mean 'hinge'?"},
      {{"rail", "rail"}, {"from", "to"}, 2, "joint 'rail' twice"},
      {{}, {"from", "to"}, 3, "dataset 'from' has 3 columns, robot 'arm' has 2 joints"},
      {{"hinge"}, {"from", "to"}, 1, "no column of joint 'rail'; --state rail=VALUE"},
      {{}, {"from"}, 2, "there is no dataset 'to'"},
      {{}, {"start", "goal"}, 2, "found 'goal', 'start'"},
      {{}, {"configurations"}, 2, "there is no dataset 'edges'"},
  };
  for (const auto& one : cases) {
    file(one.joints, one.sets, one.columns);
    const Outcome outcome = run(command("x"));
    EXPECT_EQ(outcome.status, 2) << one.named;
    EXPECT_NE(outcome.err.find(one.named), std::string::npos) << one.named << "\n" << outcome.err;
    EXPECT_FALSE(fs::exists(path("x/run.json")));
  }
  file({"hinge"}, {"from", "to"}, 1);
  EXPECT_EQ(run(command("state", "--state rail=0.5")).status, 0);
}

TEST_F(EdgesTest, RowsThatAreNoMotionAreRefusedNotFree) {
  arm();
  writeScenes();
  const double from[] = {0, 0, std::nan(""), 0, 0, 0, 0, 0}, to[] = {0.1, 0, 0, 0, 7, 0, 0.2, 0};
  Image image;
  image.add("from", {4, 2}, from);
  image.add("to", {4, 2}, to);
  write("edges.h5", image.bytes());
  const Outcome outcome = run(command("made"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("edge 1: joint 'hinge' is nan"), std::string::npos) << outcome.err;
  const auto status = column<std::int64_t>(File(path("made/table.h5")), "status");
  EXPECT_EQ(status, (std::vector<std::int64_t>{1, 4, 4, 1, 1, 4, 4, 1}));
  EXPECT_EQ(run(command("made")).status, 2) << "also when all was there";
  const Outcome beyond = run(command("beyond", "--ignore-limits"));
  EXPECT_EQ(beyond.status, 2);
  EXPECT_EQ(column<std::int64_t>(File(path("beyond/table.h5")), "status")[2], 2);
}

// The arm's limits are -1 to 2 rad and -1 to 1 m; of the file's columns the rail comes first.
TEST_F(EdgesTest, LimitsAreAsTolerantAsThoseOfPlans) {
  arm();
  writeScenes();
  const double from[] = {0, 2.0009, 0, 2.0011, 1.00009, 0, 1.00011, 0}, to[] = {0, 2.0001, 0, 2, 1, 0, 1, 0};
  Image image;
  image.add("from", {4, 2}, from);
  image.add("to", {4, 2}, to);
  image.attribute("from", "joints", std::vector<std::string>{"rail", "hinge"});
  write("edges.h5", image.bytes());
  const auto refused = [&](const std::string& out) {
    std::vector<bool> rows;
    for (const auto status : column<std::int64_t>(File(path(out + "/table.h5")), "status")) rows.push_back(status == 4);
    rows.resize(4);  // of the first scene
    return rows;
  };
  const Outcome outcome = run(command("made"));
  EXPECT_EQ(refused("made"), (std::vector<bool>{false, true, false, true})) << outcome.err;
  const auto notes = [](const Outcome& o) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = o.err.find("beyond its limits", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  EXPECT_NE(outcome.err.find("note: joint 'hinge': some values are beyond its limits [-1, 2], by at most 0.0009 rad"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("joint 'rail': some values are beyond its limits [-1, 1], by at most 9e-05 m"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(notes(outcome), 3u) << "a note a joint, and the first row that is refused: " << outcome.err;
  EXPECT_EQ(run(command("wide", "--limit-tolerance 0.01")).status, 0);
  EXPECT_EQ(refused("wide"), std::vector<bool>(4, false));
  (void)run(command("strict", "--limit-tolerance 0"));
  EXPECT_EQ(refused("strict"), std::vector<bool>(4, true));
}

// Answers that an earlier library has proven may be wrong: its rows and roadmaps are not believed.
TEST_F(EdgesTest, HashesKnowTheErrata) {
  std::istringstream errata(read(std::string(FCL_ARTIC_SOURCE) + "/doc/ERRATA.md"));
  int entries = 0;
  for (std::string line; std::getline(errata, line);) entries += line.rfind("**", 0) == 0;
  EXPECT_EQ(fcl_artic::app::kErrata, entries) << "a new entry raises the number";
}

TEST_F(EdgesTest, NotesOfScenesArePrinted) {
  arm();
  fs::create_directories(folder_ / "doors");
  write("doors/door.urdf", R"(<robot name="d"><link name="d"/><link name="e"><collision><origin xyz="9 9 9"/>
    <geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="j" type="continuous"><parent link="d"/><child link="e"/></joint></robot>)");
  edges(5);
  const Outcome run = this->run("certify --edges " + path("edges.h5") + " --robot " + path("arm.urdf") + " --scenes " +
                                path("doors") + " --out " + path("doors_out") + " --threads 1");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("note: scene 0 ('door.urdf'): "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("its joints stand at 0"), std::string::npos) << run.err;
}

TEST_F(EdgesTest, ScenesOfShapesAreThoseOfFiles) {
  arm();
  writeScenes();
  edges(200);
  Image image;
  const std::int64_t first[] = {0, 1, 2};
  const std::int8_t kind[] = {1, 0};
  const double size[] = {0.1, 0, 0, 0.3, 0.2, 0.2}, position[] = {0.3, 0.519615242270663, 0, 0.2, -0.7, 0};
  image.add("first", {3}, first);
  image.add("kind", {2}, kind);
  image.add("size", {2, 3}, size);
  image.add("position", {2, 3}, position);
  const std::string shapes = write("shapes.h5", image.bytes());
  ASSERT_EQ(run(command("files")).status, 0);
  const std::string base = "certify --edges " + path("edges.h5") + " --robot " + path("arm.urdf") + " --threads 1 ";
  ASSERT_EQ(run(base + "--scenes " + shapes + " --out " + path("shapes")).status, 0);
  EXPECT_EQ(hash("shapes"), hash("files"));
  // Bodies of --scene stand in all scenes.
  ASSERT_EQ(run(base + "--scenes " + shapes + " --scene " + path("ball.urdf") + " --out " + path("both")).status, 0);
  const auto both = column<std::int64_t>(File(path("both/table.h5")), "status");
  const auto one = column<std::int64_t>(File(path("shapes/table.h5")), "status");
  int touching = 0;
  for (std::size_t e = 0; e < 200; ++e) {
    touching += one[e] == 2 && one[200 + e] == 1;
    EXPECT_EQ(both[200 + e] == 2, one[e] == 2 || one[200 + e] == 2) << e;
  }
  EXPECT_GT(touching, 10);
}

TEST_F(EdgesTest, FilesThatLeaveRowsOutAreRefused) {
  arm();
  writeScenes();
  const double configurations[10] = {0, 0, 0.1, 0, 0.2, 0, 0.3, 0, 0.4, 0}, times[4] = {0, 1, 2, 3};
  const std::int64_t pairs[2] = {0, 1};
  const struct {
    std::vector<std::int64_t> first;
    bool times, ends;
    const char* named;  ///< empty: the file is good
  } trajectories[] = {
      {{0, 2, 5}, false, false, ""},
      {{1, 5}, false, false, "'first' goes from 1 to 5, and is to go from 0 to 5, the number of rows of 'waypoints'"},
      {{0, 2}, false, false, "'first' goes from 0 to 2, and is to go from 0 to 5"},
      {{0, 5}, true, false, "dataset 'times' is to be one column of 5 rows"},
      {{0, 5}, false, true, "there are edges in more than one form"},
  };
  for (const auto& one : trajectories) {
    Image image;
    image.add("waypoints", {5, 2}, configurations);
    image.add("first", {one.first.size()}, one.first.data());
    if (one.times) image.add("times", {4}, times);
    if (one.ends) {
      image.add("configurations", {5, 2}, configurations);
      image.add("edges", {1, 2}, pairs);
    }
    write("edges.h5", image.bytes());
    const Outcome outcome = run(command("made" + std::to_string(&one - trajectories)));
    EXPECT_EQ(outcome.status, *one.named ? 2 : 0) << one.named << outcome.err;
    EXPECT_NE(outcome.err.find(one.named), std::string::npos) << outcome.err;
  }

  edges(20);
  const std::int8_t kind[] = {1, 0};
  const double size[] = {0.1, 0, 0, 0.3, 0.2, 0.2}, position[] = {0.3, 0.5, 0, 0.2, -0.7, 0};
  for (const std::vector<std::int64_t>& first : {std::vector<std::int64_t>{0, 1}, {1, 2}, {2, 2}, {0, 1, 2}}) {
    Image image;
    image.add("first", {first.size()}, first.data());
    image.add("kind", {2}, kind);
    image.add("size", {2, 3}, size);
    image.add("position", {2, 3}, position);
    const Outcome outcome = run("certify --edges " + path("edges.h5") + " --robot " + path("arm.urdf") + " --scenes " +
                                write("shapes.h5", image.bytes()) + " --out " + path("shapes"));
    EXPECT_EQ(outcome.status, first.size() == 3 ? 0 : 2) << outcome.err;
    EXPECT_EQ(outcome.err.find("is to go from 0 to 2, the number of rows of 'kind'") == std::string::npos,
              first.size() == 3);
  }
}

TEST_F(EdgesTest, WhatAllBlocksMeetIsSaidOnce) {
  arm();
  writeScenes();
  const double configurations[4] = {0, 0, 0.1, 0};
  const std::int64_t pairs[4] = {0, 1, 0, 2};
  Image image;
  image.add("configurations", {2, 2}, configurations);
  image.add("edges", {2, 2}, pairs);
  write("edges.h5", image.bytes());
  const Outcome outcome = run(command("made"));
  EXPECT_EQ(outcome.status, 2);
  const std::string what = "edge 1: there is no configuration 2, they are numbered 0 to 1";
  ASSERT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find(what), outcome.err.rfind(what)) << outcome.err;
}

#ifdef FCL_ARTIC_VERIFY
TEST_F(EdgesTest, CertificatesOfBlocksAreProvenAgain) {
  arm();
  writeScenes();
  edges(60);
  ASSERT_EQ(run(command("made", "--block-rows 40 --certificates")).status, 0);
  const auto place = column<std::int64_t>(File(path("made/table.h5")), "certificate");
  const auto proofs = std::count_if(place.begin(), place.end(), [](std::int64_t at) { return at >= 0; });
  EXPECT_GT(proofs, 100);
  int files = 0;
  for (const auto& [scene, numbers] : {std::pair(0, std::vector<int>{0, 1}), std::pair(1, std::vector<int>{2, 3})}) {
    for (const int number : numbers) {
      char name[64];
      std::snprintf(name, sizeof name, "made/certificates/scene-%07d.world", scene);
      const std::string world = path(name);
      std::snprintf(name, sizeof name, "made/certificates/block-%07d.fac", number);
      const std::string line =
          std::string("\"") + FCL_ARTIC_VERIFY + "\" " + world + " " + path(name) + " >" + path("said");
      EXPECT_EQ(std::system(line.c_str()), 0) << read(path("said"));
      ++files;
    }
  }
  std::printf("%d proofs in %d files\n", static_cast<int>(proofs), files);
}

/// A block and its certificates are of one run.
TEST_F(EdgesTest, CertificatesBesideABlockAreItsOwn) {
  arm();
  writeScenes();
  edges(60);
  ASSERT_EQ(run(command("made", "--block-rows 40 --certificates")).status, 0);
  const File table(path("made/table.h5"));
  EXPECT_EQ(table.strings("", "sha256").at(0), summary("made").at("table_sha256"));
  const std::string own = path("made/certificates/block-0000001.fac"), content = read(own);
  for (const std::string& other : {read(path("made/certificates/block-0000000.fac")), content.substr(1)}) {
    write("made/certificates/block-0000001.fac", other);
    const Outcome merged = run("certify --merge --out " + path("made"));
    EXPECT_EQ(merged.status, 2);
    EXPECT_NE(merged.err.find("block 1 is damaged: '" + own + "'"), std::string::npos) << merged.err;
  }
  std::filesystem::remove(own);
  EXPECT_EQ(run("certify --merge --out " + path("made")).status, 2);
  write("made/certificates/block-0000001.fac", content);
  EXPECT_EQ(run("certify --merge --out " + path("made")).status, 0);
}
#endif

TEST_F(EdgesTest, GeneratedFilesAreThoseOfTheirSeed) {
  arm();
  const auto make = [&](const std::string& what, const std::string& name) {
    EXPECT_EQ(run("generate " + what + " " + path(name)).status, 0);
    return read(path(name));
  };
  const std::string e = "edges --robot " + path("arm.urdf") + " --count 500 --seed ";
  const std::string s = "scenes --count 5 --obstacles 8 --seed ";
  EXPECT_EQ(make(e + "3", "edges.h5"), make(e + "3", "e2.h5"));
  EXPECT_NE(make(e + "4", "e3.h5"), make(e + "3", "e2.h5"));
  EXPECT_EQ(make(s + "3", "s1.h5"), make(s + "3", "s2.h5"));
  const Outcome done = run("certify --edges " + path("edges.h5") + " --robot " + path("arm.urdf") + " --scenes " +
                           path("s1.h5") + " --out " + path("made"));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(summary("made").at("rows"), 2500);
  EXPECT_GT(summary("made").at("free"), 100);
  EXPECT_GT(summary("made").at("contact"), 100);
}

}  // namespace

}  // namespace edges_test
