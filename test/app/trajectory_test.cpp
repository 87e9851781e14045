// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic check --trajectory: times, columns, refusals.
#include <cmath>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace trajectory_test {

namespace {

using Json = nlohmann::json;

// As in program_test.cpp.
const double kContactAngle = M_PI / 3 - std::asin(0.15 / 0.6);

class TrajectoryProgramTest : public ProgramTest {
 protected:
  Outcome check(const std::string& csv, const std::string& more = "") const {
    return run("check " + armAndBall() + " --trajectory " + write("way.csv", csv) + " " + more);
  }
};

TEST_F(TrajectoryProgramTest, ContactIsInTheTimeOfTheFile) {
  // Second column order, blanks, comments; 0.5 rad/s from t = 3 on, where the hinge is at 0.25.
  const std::string csv = "# a way\nrail, time ,hinge\r\n0,1,0\n\n0,3,0.25\n0.5,5,1.25\n";
  const double wanted = 3 + (kContactAngle - 0.25) / 0.5;
  const Outcome run = check(csv, "--json");
  ASSERT_EQ(run.status, 1) << run.err;
  const Json answer = Json::parse(run.out);
  EXPECT_EQ(answer.at("t_begin"), 1);
  EXPECT_EQ(answer.at("t_end"), 5);
  EXPECT_LE(answer.at("t_lower"), wanted + 1e-9);
  EXPECT_GE(answer.at("t_upper"), wanted - 1e-9);
  EXPECT_LE(answer.at("t_upper").get<double>() - answer.at("t_lower").get<double>(), 1.1e-6);
  EXPECT_NEAR(answer.at("q_at_t_lower").at("hinge"), kContactAngle, 1e-5);
  EXPECT_EQ(answer.at("q_to").at("rail"), 0.5);
  EXPECT_NEAR(answer.at("contacts").at(0).at("t_lower"), wanted, 1e-5);

  const Outcome text = check(csv);
  EXPECT_EQ(text.status, 1);
  EXPECT_EQ(text.out.rfind("CONTACT: first contact at t = 4.08903", 0), 0u) << text.out;
  EXPECT_NEAR(wanted, 4.08903, 1e-5);
  EXPECT_EQ(check("t,hinge\n0,0\n1,0.5\n", "--state rail=0").status, 0);
}

/// From rest to rest between two waypoints: q = q1 (3 s^2 - 2 s^3), half way at half the time; and the same by the
/// velocities of both. A word means one curve in all verbs, and none is made up.
TEST_F(TrajectoryProgramTest, CurvesAreThoseOfCertify) {
  const std::string to = std::to_string(2 * kContactAngle), rest = "--state rail=0 --json ";
  const auto timeOf = [&](const Outcome& run) {
    EXPECT_EQ(run.status, 1) << run.err;
    return run.status == 1 ? Json::parse(run.out).at("t_lower").get<double>() : -1;
  };
  const std::string positions = "t,hinge\n10,0\n14," + to + "\n",
                    velocities = "t,hinge,hinge_vel\n10,0,0\n14," + to + ",0\n";
  EXPECT_NEAR(timeOf(check(positions, rest + "--interpolation jtc-upsampled")), 12, 1e-5);  // six digits
  EXPECT_NEAR(timeOf(check(velocities, rest)), 12, 1e-5);
  EXPECT_NEAR(timeOf(check(velocities, rest + "--interpolation cubic")), 12, 1e-5);
  const Outcome none = check(positions, rest + "--interpolation cubic");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("cubic needs velocities"), std::string::npos) << none.err;
  const Outcome totg = check(positions, rest + "--interpolation totg");
  EXPECT_EQ(totg.status, 2);
  EXPECT_NE(totg.err.find("by interpolation jtc"), std::string::npos) << totg.err;
}

/// The contact's time is that of its tangent; a trajectory of one piece and a motion say the same.
TEST_F(TrajectoryProgramTest, TangentHalfAngleGoesByTangents) {
  const double wanted = std::tan(kContactAngle / 2) / std::tan(0.75);
  const std::string law = "--interpolation tangent-half-angle";
  for (const Outcome& run : {check("t,hinge\n0,0\n1,1.5\n", law + " --state rail=0 --json"),
                             this->run("check " + armAndBall() + " --from 0,0 --to 1.5,0 --json " + law)}) {
    ASSERT_EQ(run.status, 1) << run.err;
    EXPECT_NEAR(Json::parse(run.out).at("t_lower"), wanted, 2e-6);
  }
  EXPECT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 1,0 --shortest " + law).status, 2);
  const Outcome beyond = this->run("check " + armAndBall() + " --from 0,0 --to 3.2,0 " + law);
  EXPECT_EQ(beyond.status, 2);
  EXPECT_NE(beyond.err.find("hinge"), std::string::npos) << beyond.err;
}

/// joint_trajectory_controller goes as the values say: never the shorter way round.
TEST_F(TrajectoryProgramTest, TheControllerTakesNoShorterWay) {
  const std::string line = write("one.jsonl", "{\"from\": [0, 0], \"to\": [0.5, 0]}\n");
  for (const std::string& motion : {std::string(" --from 0,0 --to 0.5,0"), " --lines " + line}) {
    EXPECT_EQ(this->run("check " + armAndBall() + motion + " --interpolation jtc").status, 0) << motion;
    const Outcome both = this->run("check " + armAndBall() + motion + " --interpolation jtc --shortest");
    EXPECT_EQ(both.status, 2) << motion;
    EXPECT_NE(both.err.find("--shortest excludes --interpolation jtc"), std::string::npos) << both.err;
  }
  const std::string csv = "t,hinge,rail\n0,0,0\n1,0.5,0\n";
  for (const char* kind : {"jtc", "jtc-upsampled", "jtc-none"}) {
    EXPECT_EQ(check(csv, std::string("--shortest --interpolation ") + kind).status, 2) << kind;
  }
}

TEST_F(TrajectoryProgramTest, NobodyGuessesWhereAJointStands) {
  const std::string csv = "t,hinge\n0,0\n1,0.5\n", wanted = "has no joint 'rail': --state rail=VALUE";
  for (const std::string& motion :
       {" --trajectory " + write("some.csv", csv), std::string(" --from hinge=0 --to hinge=0.5")}) {
    const Outcome run = this->run("check " + armAndBall() + motion);
    EXPECT_EQ(run.status, 2) << motion;
    EXPECT_NE(run.err.find(wanted), std::string::npos) << run.err;
    EXPECT_EQ(this->run("check " + armAndBall() + motion + " --state rail=0").status, 0);
  }
  const Outcome line = this->run("check " + armAndBall() + " --lines " +
                                 write("some.jsonl", "{\"from\": {\"hinge\": 0}, \"to\": [0, 0]}\n"));
  EXPECT_EQ(line.status, 2);
  EXPECT_NE(line.out.find(wanted), std::string::npos) << line.out;
  // A question that is asked in two ways has the same answer.
  for (const std::string& motion :
       {" --trajectory " + write("all.csv", "t,hinge,rail\n0,0,0\n1,0,0.5\n"), std::string(" --from 0,0 --to 0,0.5"),
        std::string(" --from hinge=0,rail=0 --to hinge=0,rail=0.5")}) {
    const Outcome run = this->run("check " + armAndBall() + motion + " --state rail=0");
    EXPECT_EQ(run.status, 2) << motion;
    EXPECT_NE(run.err.find("has joint 'rail' at 0, and "), std::string::npos) << run.err;
  }
}

TEST_F(TrajectoryProgramTest, RefusesWithLineAndColumn) {
  const auto refused = [&](const std::string& csv, const std::string& reason) {
    const Outcome run = check(csv, "--state rail=0");
    EXPECT_EQ(run.status, 2) << csv;
    EXPECT_NE(run.err.find(reason), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "");
  };
  refused("time,elbow\n0,0\n1,1\n", "line 1: robot 'arm' has no joint 'elbow'; its joints are: hinge, rail");
  refused("time,hinge,hinge\n0,0,0\n1,1,1\n", "line 1: column 'hinge' is there twice");
  refused("time,hinge\n0,0\n1,x\n", "line 3, column 'hinge': 'x' is not a finite number");
  refused("time,hinge\n0,0\n1,nan\n", "line 3, column 'hinge': 'nan'");
  refused("time,hinge\n0,0\n1,\n", "line 3, column 'hinge': ''");
  refused("time,hinge\n0,0\n1,1,1\n", "line 3 has 3 columns, the first line names 2");
  refused("time,hinge\n0,0\n0,1\n", "waypoint 1: its time 0 is not later than that of waypoint 0, 0");
  refused("time,hinge\n0,0\n", "it has 1 waypoint, a plan needs two");
  refused("", "it is empty");
  EXPECT_EQ(run("check " + armAndBall() + " --trajectory /nowhere.csv").status, 2);
  EXPECT_EQ(run("check " + armAndBall() + " --from 0,0").status, 2);
  EXPECT_EQ(run("check " + armAndBall()).status, 2);
  EXPECT_EQ(check("t,hinge\n0,0\n1,0.5\n", "--from 0,0").status, 2);
  EXPECT_EQ(check("t,hinge\n0,0\n1,0.5\n", "--interpolation wild").status, 2);
}

TEST_F(TrajectoryProgramTest, FloatingBaseByName) {
  const std::string robot = write("free.urdf", R"(<robot name="free"><link name="world"/><link name="body">
  <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="base" type="floating"><parent link="world"/><child link="body"/></joint></robot>)");
  // To the ball at (0.3, 0.52, 0) along y: they are 0.2 apart at y = 0.3196.
  const Outcome run =
      this->run("check --json --robot " + robot + " --scene " + ball() + " --trajectory " +
                write("fly.csv", "t,base/trans_x,base/trans_y,base/rot_z,base/rot_w\n0,0.3,0,0,1\n1,0.3,1,0.8,0.6\n") +
                " --state base/trans_z=0,base/rot_x=0,base/rot_y=0");
  ASSERT_EQ(run.status, 1) << run.err;
  EXPECT_NEAR(Json::parse(run.out).at("t_lower"), 0.519615242270663 - 0.2, 1e-5);
  // In the cube of edge 2 at the origin, octants 0, 1 and 7 are known, and 1 and 7 occupied.
  const std::string cells = write("cells.bt", std::string("# Octomap OcTree binary file\nid OcTree\nsize 4\n"
                                                          "res 0.000030517578125\ndata\n\x09\x80"));
  const std::string at = "-0.5,0.5,-0.5,0,0,0,1";
  const std::string still = "check --robot " + robot + " --scene " + cells + " --from " + at + " --to " + at;
  EXPECT_EQ(this->run(still).status, 0);
  EXPECT_EQ(this->run(still + " --unknown-cells").status, 1);
  // A point 0.15 beyond the ball's surface: a ball of 0.1 itself is free, one of 0.2 touches.
  const std::string scan = write("scan.xyz", "-0.25 0.5 -0.5\n");
  const std::string beside = "check --robot " + robot + " --scene " + scan + " --from " + at + " --to " + at;
  EXPECT_EQ(this->run(beside + " --point-radius 0.1").status, 0);
  EXPECT_EQ(this->run(beside + " --point-radius 0.2").status, 1);
  const Outcome no_radius = this->run(beside);
  EXPECT_EQ(no_radius.status, 2);
  EXPECT_NE(no_radius.err.find("--point-radius"), std::string::npos) << no_radius.err;
  const Outcome flat = this->run("check --robot " + robot + " --from 0,0,0,0,0,0,0 --to 0,0,0,0,0,0,1");
  EXPECT_EQ(flat.status, 2);
  EXPECT_NE(flat.err.find("quaternion of joint 'base'"), std::string::npos) << flat.err;
  EXPECT_NE(this->run("check --robot " + robot + " --from base=1 --to base=1").err.find("joint 'base' has 7 values"),
            std::string::npos);
}

}  // namespace

}  // namespace trajectory_test
