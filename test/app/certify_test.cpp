// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic certify: plans of files, one or many; what is wrong with them; mending.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>

#include "../plans/numpy_sample.h"
#include "run_program.h"

namespace certify_test {

namespace {

using Json = nlohmann::json;

// As in program_test.cpp.
const double kContactAngle = M_PI / 3 - std::asin(0.15 / 0.6);

class CertifyProgramTest : public ProgramTest {
 protected:
  Outcome certify(const std::string& plans, const std::string& more = "") const {
    return run("certify " + plans + " " + armAndBall() + " " + more);
  }
  Outcome certifyFile(const std::string& name, const std::string& content, const std::string& more = "") const {
    return certify(write(name, content), more);
  }

  /// A block of 0.1 m that slides in x and y within 1 m each way, in the plane of a ball of radius 0.2 at (0.5, 0).
  std::string gantry(
      const std::string& obstacles =
          R"(<collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.2"/></geometry></collision>)") const {
    const std::string limit = R"(<limit lower="-2" upper="2" effort="1" velocity="1"/>)";
    return "--robot " +
           write("gantry.urdf", R"(<robot name="gantry"><link name="base"/><link name="carriage"/>
  <link name="tool"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="base"/><child link="carriage"/><axis xyz="1 0 0"/>)" +
                                    limit + R"(</joint>
  <joint name="y" type="prismatic"><parent link="carriage"/><child link="tool"/><axis xyz="0 1 0"/>)" +
                                    limit + R"(</joint>
</robot>)") +
           " --scene " +
           write("things.urdf", R"(<robot name="things"><link name="ball">)" + obstacles + "</link></robot>");
  }
};

const std::string kJointTrajectory = R"("joint_names": ["rail", "hinge"], "points": [
  {"positions": [0, 0], "velocities": [], "time_from_start": {"sec": 1, "nanosec": 0}},
  {"positions": [0, 0.25], "velocities": [], "time_from_start": {"sec": 3, "nanosec": 0}},
  {"positions": [0.5, 1.25], "velocities": [], "time_from_start": {"sec": 5, "nanosec": 0}}])";

/// 0.5 rad/s from t = 3 on, where the hinge is at 0.25. OMPL's text has no times: its waypoints are 0, 1, 2.
TEST_F(CertifyProgramTest, ThroughEveryReaderTheSameVerdictAndTime) {
  const std::string points = "[[0, 0], [0.25, 0], [1.25, 0.5]]";
  const std::string files[] = {
      write("a.csv", "rail,time,hinge\n0,1,0\n0,3,0.25\n0.5,5,1.25\n"),
      write("b.json", R"({"joints": ["hinge", "rail"], "times": [1, 3, 5], "waypoints": )" + points + "}"),
      write("c.json", "{" + kJointTrajectory + "}"),
      write("d.json", R"({"joint_trajectory": {)" + kJointTrajectory + "}}"),
      write("e.json", R"({"model_id": "arm", "trajectory": [{"joint_trajectory": {)" + kJointTrajectory + "}}]}"),
      write("f.jsonl", R"({"times": [1, 3, 5], "waypoints": )" + points + "}\n"),
      write("g.yaml", "joint_trajectory: {" + kJointTrajectory + "}\n"),
      write("h.path", "0 0\n0.25 0\n1.25 0.5\n\n"),
      write("i.npz", numpySample()),
  };
  std::string all;
  for (const std::string& file : files) all += file + " ";
  const Outcome run = certify(all, "--json");
  ASSERT_EQ(run.status, 1) << run.err;
  const Json answer = Json::parse(run.out);
  ASSERT_EQ(answer.at("plans").size(), std::size(files));
  const Json& first = answer.at("plans").at(0);
  const double wanted = 3 + (kContactAngle - 0.25) / 0.5;
  EXPECT_LE(first.at("t_lower"), wanted + 1e-9);
  EXPECT_GE(first.at("t_upper"), wanted - 1e-9);
  EXPECT_NEAR(first.at("t_upper"), wanted, 2e-6);
  for (const Json& plan : answer.at("plans")) {
    SCOPED_TRACE(plan.at("file").dump());
    EXPECT_EQ(plan.at("status"), "contact");
    EXPECT_EQ(plan.at("waypoint"), 1);
    EXPECT_EQ(plan.at("interpolation"), "linear");
    EXPECT_EQ(plan.at("contacts").at(0).at("body2").at("name"), "ball");
    if (plan.at("timed") == false) {
      EXPECT_NEAR(plan.at("t_lower"), 1 + (wanted - 3) / 2, 2e-6);
      continue;
    }
    EXPECT_EQ(plan.at("t_lower"), first.at("t_lower"));
    EXPECT_EQ(plan.at("t_upper"), first.at("t_upper"));
    EXPECT_EQ(plan.at("q_at_t_lower"), first.at("q_at_t_lower"));
  }
  EXPECT_EQ(answer.at("summary").at("contact"), 9);
  // A plan of its own, as check says it.
  const Outcome text = certify(files[0]);
  EXPECT_EQ(text.status, 1);
  EXPECT_NE(text.out.find("linear, 3 waypoints, t 1 to 5 s\nafter waypoint 1\nCONTACT: first contact at t = 4.08903"),
            std::string::npos)
      << text.out;
}

/// Between waypoints from rest to rest the cubic is q1 (3 s² - 2 s³): half way at half the time; so is the quintic.
TEST_F(CertifyProgramTest, SplinesAreSaidAndGoByTheirVelocities) {
  const std::string to = std::to_string(2 * kContactAngle);
  const std::string cubic = "t,hinge,rail,hinge_vel,rail_vel\n10,0,0,0,0\n14," + to + ",0,0,0\n";
  const std::string quintic =
      "t,hinge,rail,hinge/velocity,rail/velocity,hinge/acceleration,rail/acceleration\n"
      "10,0,0,0,0,0,0\n14," +
      to + ",0,0,0,0,0\n";
  for (const auto& [content, name] : {std::pair(cubic, "cubic"), std::pair(quintic, "quintic")}) {
    const Outcome run = certifyFile("way.csv", content, "--json");
    ASSERT_EQ(run.status, 1) << run.err;
    const Json plan = Json::parse(run.out).at("plans").at(0);
    EXPECT_EQ(plan.at("interpolation"), name);
    EXPECT_NEAR(plan.at("t_lower"), 12, 1e-5);
  }
  // 2/3 of the way: s = 0.6130 of the cubic, 2/3 of the line.
  const std::string far = std::to_string(1.5 * kContactAngle);
  const std::string to_far = "t,hinge,rail,hinge_vel,rail_vel\n0,0,0,0,0\n1," + far + ",0,0,0\n";
  EXPECT_NEAR(Json::parse(certifyFile("way.csv", to_far, "--json").out).at("plans").at(0).at("t_lower"), 0.6130, 1e-4);
  EXPECT_NEAR(
      Json::parse(certifyFile("way.csv", to_far, "--json --interpolation linear").out).at("plans").at(0).at("t_lower"),
      2.0 / 3, 1e-5);
  const Outcome none = certifyFile("way.csv", "hinge,rail\n0,0\n1,0\n", "--interpolation cubic");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.out.find("cubic needs velocities"), std::string::npos) << none.out;
  EXPECT_EQ(certifyFile("way.csv", cubic, "--interpolation blends").status, 2);
  // Straight from waypoint to waypoint it stays before the ball; the controller's spline swings beyond the middle ones.
  const std::string swing = "t,hinge,rail\n0,0,0\n1,0.78,0\n2,0.78,0\n3,0,0\n4,0,0\n";
  EXPECT_EQ(certifyFile("way.csv", swing, "--interpolation jtc").status, 0);
  const Outcome upsampled = certifyFile("way.csv", swing, "--interpolation jtc-upsampled");
  EXPECT_EQ(upsampled.status, 1);
  EXPECT_NE(upsampled.out.find("way.csv: jtc-upsampled, 5 waypoints, t 0 to 4 s\n"), std::string::npos)
      << upsampled.out;
  EXPECT_NE(upsampled.out.find("CONTACT: first contact at t = 1.0197"), std::string::npos) << upsampled.out;
  EXPECT_EQ(
      certifyFile("way.csv", "t,hinge,rail\n0,0,0\n1,0.4,0\n2,0,0\n", "--interpolation blends --blend 0.5").status, 0);
}

TEST_F(CertifyProgramTest, ManyPlansAreATableAndTheWorstCounts) {
  const std::string free = R"({"waypoints": [[0, 0], [0.5, 0]]})",
                    hit = R"({"id": 7, "waypoints": [[0, 0], [1.5, 0]]})",
                    wrong = R"({"waypoints": [[0, 0], [0.5, 9]]})";
  const Outcome fine = certifyFile("plans.jsonl", free + "\n" + free + "\n");
  EXPECT_EQ(fine.status, 0) << fine.err;
  EXPECT_NE(fine.out.find("2 plans: 2 free, 0 in contact, 0 undecided, 0 wrong"), std::string::npos) << fine.out;
  const Outcome one = certifyFile("one.jsonl", wrong + "\n");
  EXPECT_NE(one.out.find("1 plan: 0 free, 0 in contact, 0 undecided, 1 wrong"), std::string::npos) << one.out;
  const std::string csv = path("rows.csv");
  const Outcome mixed =
      certifyFile("plans.jsonl", free + "\n" + hit + "\n", "--failed-only --clearance --threads 2 --csv " + csv);
  EXPECT_EQ(mixed.status, 1) << mixed.err;
  EXPECT_NE(mixed.out.find("plans.jsonl line 2 7: contact within ["), std::string::npos) << mixed.out;
  EXPECT_NE(mixed.out.find("'arm' and 'ball' at ("), std::string::npos) << mixed.out;
  EXPECT_EQ(mixed.out.find("line 1"), std::string::npos) << mixed.out;
  std::istringstream rows(read(csv));
  std::string line;
  int lines = 0;
  for (; std::getline(rows, line); ++lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 28) << line;
  EXPECT_EQ(lines, 3);
  const Outcome error = certifyFile("plans.jsonl", free + "\n" + wrong + "\n" + hit + "\n" + "{\n");
  EXPECT_EQ(error.status, 2);
  EXPECT_NE(error.out.find("line 2: error: waypoint 1: joint 'rail' at 9 is beyond its limits [-1, 1]"),
            std::string::npos)
      << error.out;
  EXPECT_NE(error.out.find("line 4: error: it is no JSON"), std::string::npos) << error.out;
  EXPECT_NE(error.out.find("4 plans: 1 free, 1 in contact, 0 undecided, 2 wrong"), std::string::npos) << error.out;
  EXPECT_EQ(certifyFile("plans.jsonl", free + "\n" + wrong + "\n", "--ignore-limits").status, 0);
  EXPECT_EQ(certifyFile("plans.jsonl", hit + "\n", "--budget 1").status, 3);
  // The same bits on any number of threads.
  std::string many;
  for (int i = 0; i < 40; ++i) many += R"({"waypoints": [[0, 0], [)" + std::to_string(0.05 * i) + ", 0.1]]}\n";
  Json answers[2];
  for (int threads : {1, 3}) {
    answers[threads / 3] =
        Json::parse(certifyFile("many.jsonl", many, "--json --threads " + std::to_string(threads)).out).at("plans");
    for (Json& plan : answers[threads / 3]) plan.erase("us");
  }
  EXPECT_EQ(answers[0].size(), 40u);
  EXPECT_EQ(answers[0], answers[1]);
}

// A comment about units helps most if the plan is wrong.
TEST_F(CertifyProgramTest, APlanThatIsWrongKeepsItsNotes) {
  const Outcome text = certifyFile("wrong.csv", "# lengths in mm\nhinge,rail\n0,0\n0,9\n");
  EXPECT_EQ(text.status, 2);
  EXPECT_NE(text.out.find("error: waypoint 1: joint 'rail' at 9"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("note: line 1 says '# lengths in mm': lengths are taken in m"), std::string::npos)
      << text.out;
  const Json plan = Json::parse(certify(path("wrong.csv"), "--json").out).at("plans").at(0);
  EXPECT_EQ(plan.at("status"), "error");
  EXPECT_EQ(plan.at("notes").size(), 1u) << plan;
}

// No tool is followed along tangents of half angles, and the cure is named.
TEST_F(CertifyProgramTest, ALineIsOfCurvesThatAControllerRuns) {
  const Outcome refused =
      certifyFile("line.csv", "hinge,rail\n0,0\n0.1,0\n", "--line tip=1mm --interpolation tangent-half-angle");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("--interpolation linear, cubic, quintic or jtc"), std::string::npos) << refused.err;
}

TEST_F(CertifyProgramTest, FilesFoldersAndStandardInput) {
  write("folder/b.csv", "hinge,rail\n0,0\n0.5,0\n");
  write("folder/a.jsonl", R"({"waypoints": [[0, 0], [0.5, 0]]})");
  write("folder/readme.md", "no plan");
  const Outcome folder = certify(path("folder"));
  EXPECT_EQ(folder.status, 0) << folder.err;
  EXPECT_LT(folder.out.find("a.jsonl"), folder.out.find("b.csv"));
  EXPECT_NE(folder.out.find("2 plans: 2 free"), std::string::npos) << folder.out;
  std::filesystem::create_directory(path("folder/old"));
  const Outcome more = certify(path("folder"));
  EXPECT_NE(more.out.find("passed over, as folders or without a plan's ending: old/, readme.md"), std::string::npos)
      << more.out;
  std::filesystem::create_directory(path("empty"));
  EXPECT_EQ(certify(path("empty")).status, 2);
  EXPECT_EQ(certify("/nowhere.csv").status, 2);
  const Outcome unknown = certifyFile("way.plan", "hinge,rail\n0,0\n0.5,0\n");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("--format says what it is"), std::string::npos) << unknown.err;
  EXPECT_EQ(certifyFile("way.plan", "hinge,rail\n0,0\n0.5,0\n", "--format csv").status, 0);
  EXPECT_EQ(certify("- --format csv <" + write("in", "hinge,rail\n0,0\n0.5,0\n")).status, 0);
  EXPECT_EQ(run("certify --robot " + arm() + " --scene " + ball() + " " + path("folder/b.csv")).status, 0);
}

/// A second scene after one --scene is no plan, and must not be left out of the scene.
TEST_F(CertifyProgramTest, WhatIsNoPlanStopsTheRun) {
  const std::string plan = write("way.csv", "hinge,rail\n0,0\n0.5,0\n");
  const std::string second = write("wall.obj", "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n");
  const std::string out = path("safe.csv");
  const Outcome two =
      run("certify " + plan + " --robot " + arm() + " --scene " + ball() + " " + second + " --out " + out);
  EXPECT_EQ(two.status, 2);
  EXPECT_NE(two.err.find("wall.obj' is no plan by its ending"), std::string::npos) << two.err;
  EXPECT_EQ(two.out, "");
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(run("certify " + plan + " " + armAndBall() + " --scene " + second).status, 0);
}

/// A run leaves no earlier file under a name that it does not write: a plan that collides must not stand there as a
/// free one.
TEST_F(CertifyProgramTest, FilesOfEarlierRunsAreNotLeft) {
  const std::string free = "hinge,rail\n0,0\n0.5,0\n", touching = "hinge,rail\n0,0\n1.5,0\n";
  const std::string out = path("safe.csv"), csv = path("rows.csv"), proof = path("proof.fac");
  const std::string outputs = " --out " + out + " --csv " + csv + " --certificate " + proof;
  const auto exist = [&](const std::string& file) { return std::filesystem::exists(file); };
  EXPECT_EQ(certifyFile("free.csv", free, outputs).status, 0);
  EXPECT_TRUE(exist(out) && exist(csv) && exist(proof) && exist(proof + ".world"));
  EXPECT_EQ(certifyFile("touching.csv", touching, outputs).status, 1);
  EXPECT_FALSE(exist(out));
  EXPECT_TRUE(exist(csv));
  EXPECT_EQ(certifyFile("free.csv", free, outputs).status, 0);
  EXPECT_TRUE(exist(out));
  // A run that ends with an error leaves nothing either.
  EXPECT_EQ(certifyFile("free.csv", free, outputs + " --state elbow=1").status, 2);
  EXPECT_FALSE(exist(out) || exist(csv) || exist(proof) || exist(proof + ".world"));
  // A link stays one.
  std::filesystem::create_symlink(path("target.csv"), path("link.csv"));
  write("target.csv", free);
  EXPECT_EQ(certifyFile("free.csv", free, " --out " + path("link.csv")).status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.csv")));
  EXPECT_TRUE(exist(path("target.csv")));
  EXPECT_EQ(certifyFile("touching.csv", touching, " --out " + path("link.csv")).status, 1);
  EXPECT_FALSE(exist(path("target.csv")));
}

// Straight from waypoint to waypoint the arm stays below the ball; by its velocities it would swing through it.
TEST_F(CertifyProgramTest, WhatIsWrittenIsReadAsWhatWasProven) {
  const std::string content = "t,hinge,rail,hinge_vel,rail_vel\n0,0,0,8,0\n1,0.5,0,-8,0\n";
  EXPECT_EQ(certifyFile("way.csv", content).status, 1);
  for (const char* ending : {"csv", "json", "jsonl", "yaml", "path"}) {
    const std::string out = path(std::string("out.") + ending);
    ASSERT_EQ(certifyFile("way.csv", content, "--interpolation linear --out " + out).status, 0) << ending;
    const Outcome again = certify(out);
    EXPECT_EQ(again.status, 0) << ending << again.out;
  }
  // A spline stays one, in what can hold it, with a part of its joints named and the rest in its state.
  const std::string spline = "t,hinge,hinge_vel\n0,0,0\n0.3333333333333333,0.3,0.1\n1,0.5,0\n",
                    state = "--state rail=0.25 ";
  for (const char* ending : {"csv", "json", "jsonl", "yaml"}) {
    const std::string out = path(std::string("out.") + ending);
    ASSERT_EQ(certifyFile("spline.csv", spline, state + "--out " + out).status, 0) << ending;
    const Outcome again = certify(out, "--json");
    ASSERT_EQ(again.status, 0) << ending << again.out;
    EXPECT_EQ(Json::parse(again.out).at("plans").at(0).at("interpolation"), "cubic") << ending;
  }
  const Outcome refused = certifyFile("spline.csv", spline, state + "--out " + path("out.path"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("OMPL's text holds no cubic plan"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(path("out.path")));
  const std::string line = "hinge\n0\n0.5\n";
  ASSERT_EQ(certifyFile("line.csv", line, state + "--out " + path("out.path")).status, 0);
  EXPECT_EQ(read(path("out.path")), "0 0.25 \n0.5 0.25 \n");
}

// A hand of a clock that goes from 10 past the half to 10 to it, past the full hour: nothing stands at the half.
TEST_F(CertifyProgramTest, TurnsAreWrittenAsTheyWereTaken) {
  const std::string clock = "--robot " + write("clock.urdf", R"(<robot name="clock"><link name="base"/>
  <link name="hand"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/></joint></robot>)") +
                            " --scene " + ball();
  const std::string way = write("way.csv", "turn\n3\n-3\n");
  EXPECT_EQ(this->run("certify " + way + " " + clock + " --turns given").status, 1);
  for (const char* ending : {"csv", "json", "jsonl", "yaml", "path"}) {
    const std::string out = path(std::string("out.") + ending);
    ASSERT_EQ(this->run("certify " + way + " " + clock + " --turns shortest --out " + out).status, 0) << ending;
    EXPECT_EQ(this->run("certify " + out + " " + clock).status, 0) << ending << read(out);
  }
}

TEST_F(CertifyProgramTest, OutputsAreNoInputs) {
  const std::string plan = "hinge,rail\n0,0\n0.5,0\n", file = write("way.csv", plan);
  for (const std::string& more : {" --out " + file, " --csv " + file,
                                  " --out " + path("x.csv") + " --csv " + path("x.csv"), " --certificate " + ball()}) {
    const Outcome run = certify(file, more);
    EXPECT_EQ(run.status, 2) << more;
    EXPECT_TRUE(run.err.find("is a file that this run reads") != std::string::npos ||
                run.err.find("name one file") != std::string::npos)
        << run.err;
    EXPECT_EQ(read(file), plan);
    EXPECT_TRUE(std::filesystem::exists(ball()));
  }
  // The same holds for a folder of plans.
  write("folder/way.csv", plan);
  EXPECT_EQ(certify(path("folder"), " --out " + path("folder/way.csv")).status, 2);
  EXPECT_EQ(read(path("folder/way.csv")), plan);
}

TEST_F(CertifyProgramTest, OtherJointsAndCarriedObjectsAreAskedFor) {
  const Outcome missing = certifyFile("way.csv", "hinge\n0\n0.5\n");
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.out.find("way.csv: error: the plan has no joint 'rail': --state rail=VALUE gives its value"),
            std::string::npos)
      << missing.out;
  EXPECT_EQ(certifyFile("way.csv", "hinge\n0\n0.5\n", "--state rail=0.5").status, 0);
  EXPECT_EQ(certifyFile("way.csv", "hinge\n0\n0.5\n", "--state elbow=0.5").status, 2);
  EXPECT_EQ(certifyFile("way.path", "0\n0.5\n", "--joints hinge --state rail=0").status, 0);
  const std::string message =
      R"({"trajectory": [{"joint_trajectory": {)" + kJointTrajectory +
      R"(}}], "trajectory_start": {"attached_collision_objects": [{"object": {"id": "cup"}}]}})";
  const Outcome carrying = certifyFile("way.json", message);
  EXPECT_EQ(carrying.status, 2);
  EXPECT_NE(carrying.out.find("carries 'cup': --attach says what that is"), std::string::npos) << carrying.out;
  EXPECT_EQ(
      certifyFile("way.json", message, "--attach slide=" + write("cup.urdf", R"(<robot name="cup"><link name="cup">
    <collision><geometry><sphere radius="0.01"/></geometry></collision></link></robot>)"))
          .status,
      1);
}

/// Another object than the message's, or one of two, is no answer about what the robot carries.
TEST_F(CertifyProgramTest, EveryCarriedObjectIsAttachedByItsName) {
  const auto thing = [](const std::string& link) {
    return "<link name=\"" + link + R"("><collision><geometry><sphere radius="0.01"/></geometry></collision></link>)";
  };
  const auto message = [](const std::string& carried) {
    return R"({"trajectory": [{"joint_trajectory": {"joint_names": ["rail", "hinge"], "points": [
      {"positions": [0, 0], "time_from_start": 0}, {"positions": [0, 0.25], "time_from_start": 1}]}}],
      "trajectory_start": {"attached_collision_objects": [)" +
           carried + "]}}";
  };
  const auto refused = [&](const std::string& carried, const std::string& attach, const std::string& reason) {
    const Outcome run = certifyFile("way.json", message(carried), attach);
    EXPECT_EQ(run.status, 2) << run.out << run.err;
    EXPECT_NE(run.out.find(reason), std::string::npos) << run.out;
  };
  const std::string cup = R"({"link_name": "slide", "object": {"id": "cup"}})",
                    spoon = R"({"object": {"id": "spoon"}})", nameless = R"({"object": {}})";
  const std::string cup_file =
                        " --attach slide=" + write("cup.urdf", "<robot name=\"cup\">" + thing("body") + "</robot>"),
                    cup_link = " --attach slide=" + write("x.urdf", "<robot name=\"x\">" + thing("cup") + "</robot>"),
                    spoon_file =
                        " --attach slide=" + write("spoon.urdf", "<robot name=\"s\">" + thing("s") + "</robot>"),
                    moved = " --attach arm=" + path("cup.urdf") + "@0,0,9";
  EXPECT_EQ(certifyFile("way.json", message(cup), cup_file).status, 0);
  EXPECT_EQ(certifyFile("way.json", message(cup), cup_link).status, 0);
  EXPECT_EQ(certifyFile("way.json", message(cup + ", " + spoon), cup_file + spoon_file).status, 0);
  EXPECT_EQ(certifyFile("way.json", message(nameless + ", " + cup), spoon_file + cup_link).status, 0);
  refused(cup, spoon_file, "carries 'cup': --attach says what that is; what is attached is 's'");
  refused(cup + ", " + spoon, cup_file, "carries 'spoon': --attach says what that is");
  refused(cup + ", " + nameless, cup_file, "carries an object without a name: --attach says what that is");
  refused(cup, moved, "link 'slide' carries 'cup', and it is attached to 'arm', which moves against it");
}

TEST_F(CertifyProgramTest, ColumnsWithoutNamesAreSaid) {
  const Outcome text = certifyFile("way.path", "0 0\n0.25 0\n");
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("note: the plan names no joints: its columns are taken for hinge, rail\n"), std::string::npos)
      << text.out;
  const Outcome named = certifyFile("way.csv", "rail,hinge\n0,0\n0,0.25\n", "--json");
  EXPECT_EQ(Json::parse(named.out).at("plans").at(0).at("joints"), (Json{"rail", "hinge"}));
  EXPECT_EQ(Json::parse(named.out).at("plans").at(0).at("joints_named"), true);
  const Outcome unnamed = certifyFile("way.path", "0 0\n0 0.25\n", "--json --joints rail,hinge");
  EXPECT_EQ(Json::parse(unnamed.out).at("plans").at(0).at("joints"), (Json{"rail", "hinge"}));
  EXPECT_EQ(Json::parse(unnamed.out).at("plans").at(0).at("joints_named"), false);
  const Outcome counted = certifyFile("way.csv", "q1,q2\n0,0\n0.25,0\n", "--json");
  EXPECT_EQ(Json::parse(counted.out).at("plans").at(0).at("joints"), (Json{"hinge", "rail"}));
  EXPECT_EQ(Json::parse(counted.out).at("plans").at(0).at("joints_named"), false);
  const Outcome once = certifyFile("way.csv", "q1,q2\n0,0\n0.25,0\n");
  EXPECT_NE(once.out.find("its columns are taken so: hinge = q1, rail = q2"), std::string::npos) << once.out;
  EXPECT_EQ(once.out.find("names no joints"), std::string::npos) << once.out;
  certifyFile("way.csv", "rail,hinge\n0,0\n0,0.25\n");
  const Outcome table = certify(path("way.path") + " " + path("way.csv"));
  EXPECT_NE(table.out.find("note: 1 of 2 plans names no joints: its columns are taken for hinge, rail\n"),
            std::string::npos)
      << table.out;
}

#ifdef FCL_ARTIC_HAS_PLANS
/// The way around the ball is looked at in closed form: the block is a square of side 0.1 in the ball's plane.
TEST_F(CertifyProgramTest, MendsAndCertifiesAgain) {
  const std::string out = path("safe.csv");
  const Outcome run = this->run("certify " + write("way.csv", "time,x,y\n0,-0.2,0\n1,0,0\n2,1,0\n3,1.2,0\n") + " " +
                                gantry() + " --mend --json --out " + out);
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  const Json plan = Json::parse(run.out).at("plans").at(0);
  EXPECT_EQ(plan.at("status"), "contact");
  EXPECT_NEAR(plan.at("t_lower"), 1.25, 1e-5);
  EXPECT_EQ(plan.at("waypoint"), 1);
  const Json& mended = plan.at("mended");
  EXPECT_EQ(mended.at("status"), "free");
  EXPECT_EQ(mended.at("detours"), 1);
  EXPECT_GE(mended.at("deviation"), 0.24);
  EXPECT_GT(mended.at("length_ratio"), 1.05);
  EXPECT_LT(mended.at("length_ratio"), 3);
  // The plan that was written begins and ends as the given one does, and no point of it touches.
  std::istringstream rows(read(out));
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "time,x,y");
  std::vector<std::array<double, 3>> way;
  for (std::array<double, 3> row; std::getline(rows, line); way.push_back(row)) {
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &row[0], &row[1], &row[2]), 3) << line;
    if (!way.empty()) {
      EXPECT_GT(row[0], way.back()[0]);
    }
  }
  ASSERT_GE(way.size(), 5u);
  EXPECT_EQ(way.front(), (std::array<double, 3>{0, -0.2, 0}));
  EXPECT_EQ(way[1], (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(way.back()[1], 1.2);
  EXPECT_EQ(way.back()[2], 0);
  for (std::size_t k = 1; k < way.size(); ++k) {
    for (int i = 0; i <= 1000; ++i) {
      const double s = i / 1000.0, x = way[k - 1][1] + s * (way[k][1] - way[k - 1][1]),
                   y = way[k - 1][2] + s * (way[k][2] - way[k - 1][2]);
      const double dx = std::max(0.0, std::abs(x - 0.5) - 0.05), dy = std::max(0.0, std::abs(y) - 0.05);
      ASSERT_GT(std::hypot(dx, dy), 0.205) << "at " << x << ", " << y;
    }
  }
  // The plan that was written is free for the plain path too.
  EXPECT_EQ(this->run("certify " + out + " " + gantry()).status, 0);
  EXPECT_EQ(
      this->run("certify " + path("way.csv") + " " + gantry() + " --mend --margin 0.05 --out " + path("wide.json"))
          .status,
      0);
  EXPECT_EQ(this->run("certify " + path("wide.json") + " " + gantry() + " --margin 0.05").status, 0);
}

// A straight motion's end, as computed, is not the plan's number.
TEST_F(CertifyProgramTest, MendedPlansEndAtThePlansOwnNumbers) {
  const double from = -0.3, to = 0.9;
  ASSERT_NE(from + (to - from), to);
  const std::string out = path("safe.csv");
  const Outcome run = this->run("certify " + write("way.csv", "time,x,y\n0,-0.3,0\n1,0.9,0\n") + " " + gantry() +
                                " --mend --out " + out);
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  const std::string rows = read(out), last = rows.substr(rows.rfind('\n', rows.size() - 2) + 1);
  EXPECT_EQ(last.substr(last.find(',')), ",0.9,0\n") << rows;
}

TEST_F(CertifyProgramTest, MendedPlansKeepAClearanceAndSayWhatTheyAre) {
  const std::string way = write("way.csv", "time,x,y\n0,-0.2,0\n1,0,0\n2,1,0\n3,1.2,0\n");
  for (const double clearance : {0.005, 0.03}) {
    const Outcome run =
        this->run("certify " + way + " " + gantry() + " --mend --json --mend-clearance " + std::to_string(clearance));
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    const Json mended = Json::parse(run.out).at("plans").at(0).at("mended");
    EXPECT_EQ(mended.at("clearance_kept"), clearance);
    EXPECT_GE(mended.at("clearance").at("lower"), 0.98 * clearance);
    EXPECT_EQ(mended.at("deviation_unit"), "m");
    EXPECT_TRUE(mended.at("deviation_joint") == "y" || mended.at("deviation_joint") == "x");
    EXPECT_LT(mended.at("deviation"), 0.8);
    EXPECT_GT(mended.at("added_time"), 0);
    EXPECT_LT(mended.at("added_time"), 2);
    EXPECT_NEAR(mended.at("t_end").get<double>() - 3, mended.at("added_time").get<double>(), 1e-6);
  }
  const Outcome text = this->run("certify " + way + " " + gantry() + " --mend");
  for (const char* said :
       {"at 0.005 m beyond the margin", " m ('", " s longer", "make its time law anew", "clearance at least 0.00"}) {
    EXPECT_NE(text.out.find(said), std::string::npos) << said << text.out;
  }
  // Without times nothing is said of time; with no clearance asked for none is kept.
  const Outcome untimed =
      this->run("certify " + write("u.csv", "x,y\n0,0\n1,0\n") + " " + gantry() + " --mend --json --mend-clearance 0");
  EXPECT_TRUE(Json::parse(untimed.out).at("plans").at(0).at("mended").at("added_time").is_null());
  EXPECT_EQ(Json::parse(untimed.out).at("plans").at(0).at("mended").at("clearance_kept"), 0);
}

TEST_F(CertifyProgramTest, APlanAndWhatItIsMendedToAreShown) {
  const std::string plans = write("plans.jsonl",
                                  "{\"name\": \"clear\", \"waypoints\": [[0, 1], [1, 1]]}\n{\"name\": \"through\", "
                                  "\"waypoints\": [[0, 0], [1, 0]]}\n");
  const std::string page = path("plan.html"), mended = path("plan.mended.html");
  const Outcome run = this->run("certify " + plans + " " + gantry() + " --mend --html " + page);
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("through, and what it is mended to in " + mended), std::string::npos) << run.out;
  EXPECT_NE(read(page).find("first contact at t = "), std::string::npos);
  EXPECT_NE(read(mended).find("free: proven for the whole motion"), std::string::npos);
  // A file that this run does not write is removed.
  ASSERT_EQ(this->run("certify " + plans + " " + gantry() + " --html " + page).status, 1);
  EXPECT_FALSE(std::filesystem::exists(mended));
#ifdef FCL_ARTIC_HAS_PICTURES
  const Outcome drawn = this->run("certify " + plans + " " + gantry() + " --size 64x64 --image " + path("plan.png"));
  EXPECT_EQ(drawn.status, 1) << drawn.err;
  EXPECT_EQ(read(path("plan.png")).rfind("\x89PNG", 0), 0u);
#endif
}

// Straight, and by way of a point 0.3 m off.
TEST_F(CertifyProgramTest, AToolKeepsToItsLine) {
  const std::string far_away =
      R"(<collision><origin xyz="0 0 9"/><geometry><sphere radius="0.1"/></geometry></collision>)";
  const auto certify = [&](const std::string& csv, const std::string& options) {
    return this->run("certify " + write("way.csv", csv) + " " + gantry(far_away) + " --json " + options);
  };
  const std::string straight = "x,y\n0,0\n0.5,0.15\n1,0.3\n", corner = "x,y\n0,0\n0.5,0.3\n1,0\n";
  const auto lineOf = [](const Outcome& run) { return Json::parse(run.out).at("plans").at(0).at("line"); };
  const Outcome kept = certify(straight, "--line tool=1mm,0.1deg");
  ASSERT_EQ(kept.status, 0) << kept.out << kept.err;
  EXPECT_EQ(lineOf(kept).at("status"), "kept");
  EXPECT_LT(lineOf(kept).at("distance_upper"), 1e-3);
  const Outcome left = certify(corner, "--line tool=29cm --out " + path("none.csv"));
  EXPECT_EQ(left.status, 2) << left.out;
  EXPECT_NE(left.err.find("'29cm' is no distance with its unit"), std::string::npos) << left.err;
  const Outcome far = certify(corner, "--line tool=290mm --out " + path("none.csv"));
  EXPECT_EQ(far.status, 1) << far.err;
  EXPECT_FALSE(std::filesystem::exists(path("none.csv")));
  EXPECT_EQ(lineOf(far).at("status"), "left");
  EXPECT_NEAR(lineOf(far).at("distance_lower").get<double>(), 0.3, 1e-2);
  EXPECT_EQ(Json::parse(far.out).at("summary").at("left_line"), 1);
  EXPECT_EQ(Json::parse(far.out).at("summary").at("free"), 0);
  EXPECT_EQ(certify(corner, "--line tool=310mm").status, 0);
  // A point 1 m beside the tool goes the same way.
  EXPECT_EQ(certify(straight, "--line tool=1mm,1deg@0,1,0").status, 0);
  EXPECT_EQ(certify(straight, "--line hand=1mm").status, 2);
  EXPECT_EQ(certify(straight, "--line tool=1").status, 2);
  EXPECT_EQ(certify("x,y\n0,0\n0,0\n", "--line tool=1mm").status, 2);
  // From (0, 0) by (0.5, 0.25) to (1, 0): a circle of radius 0.625; straight pieces leave it.
  EXPECT_EQ(lineOf(kept).at("via"), Json());
  std::ostringstream circle;
  circle.precision(17);
  circle << "x,y\n";
  for (int k = 0; k <= 32; ++k) {
    const double a = (k / 16.0 - 1) * std::asin(0.8);
    circle << 0.5 + 0.625 * std::sin(a) << ',' << 0.625 * std::cos(a) - 0.375 << '\n';
  }
  const std::string round = circle.str();
  const Outcome arc = certify(round, "--line tool=1mm --via 0.5,0.25,0");
  ASSERT_EQ(arc.status, 0) << arc.out << arc.err;
  EXPECT_EQ(lineOf(arc).at("via"), Json({0.5, 0.25, 0.0}));
  const double bow = 0.625 * (1 - std::cos(std::asin(0.8) / 32));
  EXPECT_NEAR(lineOf(arc).at("distance_upper").get<double>(), bow, 2e-5);
  EXPECT_NEAR(lineOf(arc).at("length").get<double>(), 1.25 * std::asin(0.8), 1e-9);
  EXPECT_EQ(certify(round, "--line tool=0.1mm --via 0.5,0.25,0").status, 1);
  EXPECT_EQ(certify(round, "--line tool=1mm").status, 1);
  EXPECT_EQ(certify(straight, "--line tool=1mm --via 0.5,0.15,0").status, 2);
  EXPECT_NE(certify(round, "--line tool=1mm --via 0.5,0.25").err.find("--via 0.5,0.25: is no point"),
            std::string::npos);
  EXPECT_EQ(certify(round, "--via 0.5,0.25,0").status, 2);
  const Outcome on_arc =
      this->run("certify " + write("way.csv", round) + " " + gantry(far_away) + " --line tool=1mm --via 0.5,0.25,0");
  EXPECT_NE(on_arc.out.find("'tool' keeps to its arc of 1.159 m: at most 0."), std::string::npos) << on_arc.out;
  const Outcome text = this->run("certify " + write("way.csv", corner) + " " + gantry(far_away) + " --line tool=1mm");
  EXPECT_NE(text.out.find("'tool' LEAVES its line of 1 m: at most 300"), std::string::npos) << text.out;
}

// A table that the block rests on, or stands 1 mm above: it touches, or is nearer than the clearance, all the time.
TEST_F(CertifyProgramTest, MendsWhatOnlyTouchesWhatItMay) {
  const auto world = [&](const char* z) {
    return gantry(
        std::string(R"(<collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.2"/></geometry></collision>
<collision name="table"><origin xyz="0 0 )") +
        z + R"("/><geometry><box size="8 8 0.1"/></geometry></collision>)");
  };
  const std::string way = write("way.csv", "x,y\n0,0\n1,0\n");
  const auto mended = [&](const char* z, const std::string& more) {
    const Outcome run = this->run("certify " + way + " " + world(z) + " --mend --json " + more);
    EXPECT_EQ(run.status, 0) << run.out << run.err;
    return Json::parse(run.out).at("plans").at(0).at("mended");
  };
  const std::string allow = "--allow 'tool,ball#2'";
  EXPECT_GE(mended("-0.1", allow).at("clearance").at("lower"), 0.0049);
  const Json ignored = mended("-0.1", "--ignore-initial-contact");
  EXPECT_EQ(ignored.at("status"), "free");
  EXPECT_EQ(ignored.at("ignored_initial_contacts").size(), 1u);
  EXPECT_GE(ignored.at("clearance").at("lower"), 0.0049);
  const Json near = mended("-0.101", "");
  EXPECT_EQ(near.at("clearance_kept"), 0.005);
  EXPECT_LE(near.at("clearance").at("upper"), 0.0011);
}

TEST_F(CertifyProgramTest, SaysWhyItCannotMend) {
  EXPECT_NE(this->run("certify " + write("way.csv", "x,y\n0,0\n1,0\n") + " " + gantry() +
                      " --mend --interpolation jtc-upsampled")
                .err.find("a controller that upsamples positions goes another way"),
            std::string::npos);
  const auto refused = [&](const std::string& csv, const std::string& world, const std::string& reason) {
    const Outcome run = this->run("certify " + write("way.csv", csv) + " " + world + " --mend --mend-time 0.3 --out " +
                                  path("none.csv"));
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_NE(run.out.find("not mended: " + reason), std::string::npos) << run.out;
    EXPECT_FALSE(std::filesystem::exists(path("none.csv")));
  };
  refused("x,y\n0.5,0\n1,0\n", gantry(), "its start touches something");
  refused("x,y\n0,0\n0.5,0.1\n", gantry(), "its goal touches something");
  const std::string wall =
      R"(<collision><origin xyz="0.5 0 0"/><geometry><box size="0.1 9 1"/></geometry></collision>)";
  refused("x,y\n0,0\n1,0\n", gantry(wall), "no way around what it touches after waypoint 0 was found in 0.3 s");
}
#endif

}  // namespace

}  // namespace certify_test
