// SPDX-License-Identifier: BSD-3-Clause
// If files can't be read to their end or written, the program gives an error that names the file, and never a verdict.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include <nlohmann/json.hpp>

#include "files/files.h"
#include "run_program.h"
#ifdef FCL_ARTIC_HAS_PLANS
#include "planning/problems.h"
#endif

namespace streams_test {

namespace {

namespace fs = std::filesystem;
using namespace fcl_artic;

/// A file that says "contact" by what stands at its end, and the program's arguments that read it.
struct Input {
  std::string file, arguments;
};

class StreamsTest : public ProgramTest {
 protected:
  std::string motion() const { return " --from 0,0 --to 90deg,0"; }

  /// One file of each format; the hinge meets the last thing in the file, at 60°.
  std::vector<Input> inputs() const {
    std::vector<Input> all;
    const auto add = [&](const std::string& name, const std::string& content, const std::string& before,
                         const std::string& after) {
      const std::string file = write(name, content);
      all.push_back({file, "check " + before + file + after});
    };
    const std::string robot = "--robot " + arm();
    std::string way = "time,hinge\n";
    for (int i = 0; i <= 157; ++i) way += std::to_string(i) + "," + std::to_string(0.01 * i) + "\n";
    add("way.csv", way, armAndBall() + " --state rail=0 --trajectory ", "");
    add("robot.urdf", read(arm()), "--scene " + ball() + " --robot ", motion());
    // 200 boxes far away, and a last one in the way.
    std::string scene = "(scene)\n", urdf = "<robot name=\"w\"><link name=\"base\"/>\n";
    const auto center = [](int i) { return i < 200 ? std::to_string(5 + i) + " 0 0" : std::string("0.3 0.5196 0"); };
    for (int i = 0; i <= 200; ++i) {
      const std::string number = std::to_string(i);
      scene += "* o" + number + "\n1\nbox\n0.1 0.1 0.1\n" + center(i) + "\n0 0 0 1\n0 0 0 0\n";
      urdf += "<link name=\"l" + number + "\"><collision><origin xyz=\"" + center(i) +
              "\"/><geometry><sphere radius=\"0.1\"/></geometry></collision></link>\n<joint name=\"j" + number +
              "\" type=\"fixed\"><parent link=\"base\"/><child link=\"l" + number + "\"/></joint>\n";
    }
    add("w.scene", scene + ".\n", robot + " --scene ", motion());
    add("w.urdf", urdf + "</robot>\n", robot + " --scene ", motion());
    // The same of triangles.
    std::string obj, stl = "solid w\n", vertices, faces;
    const auto corner = [](int i, int k) {
      const double x = i < 200 ? 5 + i : 0.3, y = i < 200 ? 0 : 0.5196;
      return std::to_string(k == 1 ? x + 0.1 : x) + " " + std::to_string(y) + " " + std::to_string(k == 2 ? 0.2 : -0.2);
    };
    for (int i = 0; i <= 200; ++i) {
      stl += "facet normal 0 0 1\n outer loop\n";
      for (int k = 0; k < 3; ++k) {
        vertices += corner(i, k) + "\n";
        obj += "v " + corner(i, k) + "\n";
        stl += "  vertex " + corner(i, k) + "\n";
      }
      const auto index = [&](int k) { return " " + std::to_string(3 * i + k); };
      obj += "f" + index(1) + index(2) + index(3) + "\n";
      stl += " endloop\nendfacet\n";
      faces += "3" + index(0) + index(1) + index(2) + "\n";
    }
    add("w.obj", obj, robot + " --scene ", motion());
    add("w.stl", stl + "endsolid w\n", robot + " --scene ", motion());
    add("w.off", "OFF\n603 201 0\n" + vertices + faces, robot + " --scene ", motion());
    add("w.ply",
        "ply\nformat ascii 1.0\nelement vertex 603\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 201\nproperty list uchar int vertex_indices\nend_header\n" +
            vertices + faces,
        robot + " --scene ", motion());
    return all;
  }
};

TEST_F(StreamsTest, ReadErrorIsNoEndOfAFile) {
#ifndef FCL_ARTIC_READ_ERROR
  GTEST_SKIP() << "ReadErrorIsNoEndOfAFile: a sanitizer comes first";
#else
  std::vector<Input> all = inputs();
  const std::string srdf = write("a.srdf", "<robot name=\"arm\">\n<!-- " + std::string(5000, 'x') + " -->\n</robot>\n");
  for (const Input& input : all) ASSERT_EQ(run(input.arguments).status, 1) << input.arguments;
  all.push_back({srdf, "check " + armAndBall() + " --srdf " + srdf + motion()});
  for (const Input& input : all) {
    const std::size_t size = fs::file_size(input.file);
    for (const std::size_t after : {std::size_t{0}, size / 2, size * 9 / 10, size - 1}) {
      ::setenv("FCL_ARTIC_FAIL_FILE", input.file.c_str(), 1);
      ::setenv("FCL_ARTIC_FAIL_AFTER", std::to_string(after).c_str(), 1);
      ::setenv("LD_PRELOAD", FCL_ARTIC_READ_ERROR, 1);
      const Outcome failed = run(input.arguments);
      ::unsetenv("LD_PRELOAD");
      EXPECT_EQ(failed.status, 2) << input.file << " fails after " << after << "\n" << failed.out;
      EXPECT_EQ(failed.out, "");
      expectContains(failed.err, "'" + input.file + "'");
      expectContains(failed.err, "Input/output error");
    }
  }
#endif
}

TEST_F(StreamsTest, FileThatIsCutShortIsNeverFree) {
  for (const Input& input : inputs()) {
    const std::string whole = read(input.file), ending = fs::path(input.file).extension();
    // A part of such a file is a file too, and nobody can tell that it is not whole: these have tests of their own.
    if (ending == ".obj" || ending == ".csv") continue;
    for (const double part : {0.1, 0.5, 0.9, 0.99}) {
      // At the end of a line, where a reader is least likely to see it.
      const std::size_t size =
          whole.rfind('\n', static_cast<std::size_t>(part * static_cast<double>(whole.size()))) + 1;
      std::ofstream(input.file, std::ios::binary) << whole.substr(0, size);
      const Outcome cut = run(input.arguments);
      EXPECT_EQ(cut.status, 2) << input.file << " of " << size << " bytes\n" << cut.out;
      EXPECT_EQ(cut.out, "");
      expectContains(cut.err, input.file);
    }
    std::ofstream(input.file, std::ios::binary) << whole;
  }
}

TEST_F(StreamsTest, TrajectoryThatIsCutShortIsSeenWhereItCanBe) {
  const std::string csv = write("cut.csv", "time,hinge,rail\n0,0,0\n1,0.5,0\n2,0.6");
  const std::string check = "check " + armAndBall() + " --trajectory " + csv;
  const Outcome cut = run(check);
  EXPECT_EQ(cut.status, 2) << cut.out;
  expectContains(cut.err, "cut.csv': line 4 has 2 columns, the first line names 3");
  write("cut.csv", "time,hinge,rail\n0,0,0\n1,0.5,0");
  expectContains(run(check + " --json").out, "the last line has no line end: the file may be cut short");
  write("cut.csv", "time,hinge,rail\n0,0,0\n1,0.5,0\n");
  EXPECT_EQ(run(check + " --json").out.find("cut short"), std::string::npos);
}

TEST_F(StreamsTest, FolderIsNoFile) {
  const auto folder = [&](const std::string& name) {
    fs::create_directories(path(name));
    return path(name);
  };
  for (const std::string& option : {"--trajectory " + folder("d.csv"), "--srdf " + folder("d.srdf") + motion(),
                                    "--scene " + folder("d.scene") + motion(), "--scene " + folder("d.bt") + motion(),
                                    "--scene " + folder("d.stl") + motion(), "--scene " + folder("d.urdf") + motion(),
                                    "--auto-srdf " + folder("e.srdf") + motion()}) {
    const Outcome outcome = run("check " + armAndBall() + " " + option);
    EXPECT_EQ(outcome.status, 2) << option << "\n" << outcome.out;
    EXPECT_EQ(outcome.out, "");
    expectContains(outcome.err, option.substr(option.find('/'), option.find(' ', option.find('/')) - option.find('/')));
  }
  EXPECT_EQ(run("check --robot " + folder("d.urdf") + motion()).status, 2);
}

TEST_F(StreamsTest, FullStandardOutputIsAnError) {
  const std::string program = std::string("\"") + FCL_ARTIC_PROGRAM + "\" ";
  const std::string check = "check " + armAndBall() + " --from 0,0 --to 40deg,0";
  ASSERT_EQ(run(check).status, 0);
  for (const std::string& arguments : {check, check + " --json", check + " --robot nowhere.urdf --json",
                                       "generate pipes --triangles 1000 " + path("p.obj"), std::string("--version"),
                                       std::string("check --help"), std::string("generate --help")}) {
    for (const char* to : {">/dev/full", ">&-"}) {
      const int status = std::system((program + arguments + " " + to + " 2>\"" + path("err") + "\"").c_str());
      EXPECT_EQ(WEXITSTATUS(status), 2) << arguments << to;
      if (to[1] == '/' && arguments.find("nowhere") == std::string::npos) {
        expectContains(read(path("err")), "cannot write standard output");
      }
    }
  }
}

TEST_F(StreamsTest, FullDeviceIsAnErrorOfEveryWriter) {
  // By way of a link: a writer that removes what it failed to write must not get at the device.
  const std::string full = path("full");
  fs::create_symlink("/dev/full", full);
  std::vector<std::string> writers = {"check " + armAndBall() + " --from 0,0 --to 40deg,0 --auto-srdf " + full,
                                      "check " + armAndBall() + " --from 0,0 --to 40deg,0 --html " + full,
                                      "generate pipes --triangles 1000 " + full};
#ifdef FCL_ARTIC_HAS_PICTURES
  writers.push_back("check " + armAndBall() + " --from 0,0 --to 40deg,0 --size 64x64 --image " + full);
#endif
  for (const char* option : {" --csv", " --svg"}) {
    writers.push_back("bench robot " + arm() + " --no-fcl --motions 2 --passes 1" + option + " " + full);
  }
  for (const std::string& arguments : writers) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.out;
    expectContains(outcome.err, "cannot write '" + full + "': No space left on device");
  }
}

// A limit on the size of files is a disk that fills up after some bytes.
TEST_F(StreamsTest, HalfAFileIsNotLeftBehind) {
  std::string urdf = "<robot name=\"w\"><link name=\"base\"/>\n";
  for (int i = 0; i < 40; ++i) {
    const std::string number = std::to_string(i);
    urdf += "<link name=\"ball_" + number +
            "\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>\n" + "<joint name=\"j" +
            number + "\" type=\"fixed\"><parent link=\"base\"/><child link=\"ball_" + number + "\"/></joint>\n";
  }
  const std::string robot = write("many.urdf", urdf + "</robot>\n");
  const std::string program = std::string("\"") + FCL_ARTIC_PROGRAM + "\" ", to = path("kept/a.srdf");
  write("kept/a.srdf", "old");
  const std::string check = "check --robot " + robot + " --no-self --from '' --to '' --auto-srdf ";
  const auto limited = [&](const std::string& arguments) {
    const std::string command =
        "trap '' XFSZ; ulimit -f 16; " + program + arguments + " >/dev/null 2>\"" + path("err") + "\"";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  ASSERT_EQ(run(check + path("whole.srdf")).status, 3);  // nothing is checked: there is no scene
  ASSERT_GT(fs::file_size(path("whole.srdf")), 32768u);
  EXPECT_EQ(limited(check + to), 2);
  expectContains(read(path("err")), "cannot write '" + to + "': File too large");
  EXPECT_FALSE(fs::exists(to));  // nor is that of an earlier run left, to be taken for this one's
  EXPECT_EQ(limited(check + path("kept/new.srdf")), 2);
  EXPECT_EQ(limited("generate pipes --triangles 2000 " + path("kept/p.obj")), 2);
  EXPECT_EQ(std::distance(fs::directory_iterator(path("kept")), fs::directory_iterator()), 0);
}

TEST_F(StreamsTest, FilesAreReplacedAsAWhole) {
  const std::string file = write("real/file", "old");
  ASSERT_EQ(::chmod(file.c_str(), 0640), 0);
  fs::create_symlink("real/file", path("link"));
  files::write(path("link"), "new");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(files::read(file), "new");
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
  files::write(path("fresh"), std::string("a\0b", 3));
  EXPECT_EQ(files::read(path("fresh")), std::string("a\0b", 3));
  files::write(path("empty"), "");
  EXPECT_EQ(files::read(path("empty")), "");
  expectContains(messageOf([&] { files::write(path("no/where"), ""); }),
                 "cannot write '" + path("no/where") + "': No such file");
  expectContains(messageOf([&] { files::read(path("none")); }), "none': cannot be read: No such file");
  expectContains(messageOf([&] { files::read(folder_.string()); }), "is a directory, not a file");
  expectContains(messageOf([&] { files::read("/proc/self/mem"); }), "cannot be read: Input/output error");
}

TEST_F(StreamsTest, ALinkToAFileThatIsNotThereYetIsFollowed) {
  fs::create_directories(path("real"));
  fs::create_symlink("real/file", path("inner"));
  fs::create_symlink("inner", path("outer"));
  files::write(path("outer"), "new");
  EXPECT_TRUE(fs::is_symlink(path("outer")) && fs::is_symlink(path("inner")));
  EXPECT_EQ(read(path("real/file")), "new");
  fs::create_symlink("round", path("round"));
  expectContains(messageOf([&] { files::write(path("round"), "new"); }), "cannot write '" + path("round") + "'");
  // A run that fails takes an earlier one's file away, and the next one writes it again.
  fs::create_symlink("real/page.html", path("page.html"));
  const std::string html = " --html " + path("page.html"), check = "check " + armAndBall() + motion() + html;
  EXPECT_EQ(run(check).status, 1);
  EXPECT_TRUE(fs::exists(path("real/page.html")));
  EXPECT_EQ(run("check --robot " + write("bad.urdf", "<robot") + motion() + html).status, 2);
  EXPECT_FALSE(fs::exists(path("real/page.html")));
  EXPECT_EQ(run(check).status, 1);
  EXPECT_TRUE(fs::is_symlink(path("page.html")) && fs::exists(path("real/page.html")));
  // Two names of one file that is not there yet.
  fs::remove(path("real/page.html"));
  const Outcome twice = run(check + " --certificate " + path("real/page.html"));
  EXPECT_EQ(twice.status, 2);
  expectContains(twice.err, "--html and --certificate name one file");
}

/// A disk that fills up: of files that belong together all are new, or all are as before.
TEST_F(StreamsTest, FilesThatBelongTogetherAreWrittenTogether) {
  const std::string first = write("first", "old"), second = write("second", "old"), large(1 << 16, 'x');
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit small = before;
  small.rlim_cur = 1 << 15;
  const auto action = ::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = messageOf([&] { files::writeTogether({{first, "new"}, {second, large}}); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, action);
  expectContains(message, "cannot write '" + second + "': File too large");
  EXPECT_EQ(read(first), "old");
  EXPECT_EQ(read(second), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
  files::writeTogether({{first, "new"}, {second, large}});
  EXPECT_EQ(read(first), "new");
  EXPECT_EQ(read(second), large);
}

/// Whenever a writer is killed: the second file is of the first one's time, or there is none.
TEST_F(StreamsTest, AWriterThatIsKilledLeavesNoOldFileBesideANewOne) {
  const std::string first = path("first"), second = path("second");
  int both = 0;
  for (int round = 0; round < 40; ++round) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int version = 0;; ++version) {
        const std::string text = std::to_string(round) + "." + std::to_string(version);
        files::writeTogether({{first, text}, {second, text}});
      }
    }
    for (int k = 0; k < 10000 && !fs::exists(second); ++k) ::usleep(1000);
    ::usleep(static_cast<useconds_t>(137 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    if (!fs::exists(second)) continue;
    ++both;
    EXPECT_EQ(read(second), read(first)) << "round " << round;
  }
  std::printf("both files after %d of 40 kills\n", both);
  EXPECT_GT(both, 0);
}

TEST_F(StreamsTest, AnOutputThatCannotBeWrittenLeavesTheAnswers) {
  const std::string full = path("full");
  fs::create_symlink("/dev/full", full);
  const std::string reason = "cannot write '" + full + "': No space left on device";
  const std::string check = "check " + armAndBall() + motion();
  const std::string plan = write("plan.csv", "time,hinge,rail\n0,0,0\n1,0.5,0\n");
  const std::string certify = "certify " + plan + " " + armAndBall();
  std::vector<std::pair<std::string, std::string>> runs = {
      {check + " --html " + full, "contact"},
      {check + " --certificate " + full, "contact"},
      {check + " --auto-srdf " + full, "contact"},
      {"srdf --robot " + arm() + " --write " + full, "arm and slide"}};
#ifdef FCL_ARTIC_HAS_PLANS
  fs::create_symlink("/dev/full", path("full.csv"));
  for (const char* option : {" --csv ", " --html ", " --certificate ", " --auto-srdf "})
    runs.emplace_back(certify + option + full, "FREE: ");
#endif
  for (const auto& [arguments, said] : runs) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    expectContains(outcome.err, "error: " + reason);
    expectContains(outcome.out, said);
    if (arguments.rfind("srdf", 0) == 0) continue;
    expectContains(outcome.out, reason);
    const nlohmann::json json = nlohmann::json::parse(run(arguments + " --json").out);
    EXPECT_EQ(json.dump().find("\"error\":\""), std::string::npos) << json;
    expectContains(json.at("notes").dump(), reason);
  }
#ifdef FCL_ARTIC_HAS_PLANS
  const Outcome out = run(certify + " --out " + path("full.csv"));
  EXPECT_EQ(out.status, 2);
  expectContains(out.out, "FREE: ");
#endif
}

#ifdef FCL_ARTIC_HAS_PLANS
TEST_F(StreamsTest, ProblemsThatAreCutShortNameTheirFile) {
  KinematicTree tree("r");
  const std::string whole = R"({"joints": [], "locked_joints": {}, "problems": [{"index": 1, "start": [], "goal": [],
    "obstacles": [{"name": "o", "type": "sphere", "radius": 1, "position": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]}]}]})";
  EXPECT_EQ(planning_data::readEnvironment(write("p.json", whole), tree).problems.size(), 1u);
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    const std::string file = write("p.json", whole.substr(0, size));
    expectContains(messageOf([&] { planning_data::readEnvironment(file, tree); }), file);
    expectContains(messageOf([&] { planning_data::readTrace(file); }), file);
    expectContains(messageOf([&] { planning_data::readMissed(file); }), file);
  }
  const std::string wrong = write("p.json", R"({"joints": "none"})");
  expectContains(messageOf([&] { planning_data::readEnvironment(wrong, tree); }), wrong);
  expectContains(messageOf([&] { planning_data::readEnvironment(folder_, tree); }), "is a directory");
}
#endif

}  // namespace

}  // namespace streams_test
