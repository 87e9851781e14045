// SPDX-License-Identifier: BSD-3-Clause
// Logs as others write them: separators, names of columns, columns without names, degrees, values beyond limits.
#include <array>

#include "arm.h"
#include "kinematics/angles.h"

namespace logs_test {

using namespace fcl_artic;
using namespace fcl_artic::plans;

PlanMotion read(const KinematicTree& tree, const std::string& content, const ColumnOptions& columns = {},
                const MotionOptions& options = {}) {
  return toMotion(tree, parsePlans(tree, content, Format::csv, columns).at(0), options);
}

std::string refusedWith(const KinematicTree& tree, const std::string& content, const ColumnOptions& columns = {},
                        const MotionOptions& options = {}) {
  return refusal([&] { (void)read(tree, content, columns, options); });
}

/// Hinge 0, 0.25, 1.25 and rail 0, 0, 0.5 at t = 1, 3, 5, however it is written; what was taken for what is said.
void expectTheLog(const PlanMotion& motion, bool timed, const std::string& taken) {
  SCOPED_TRACE(taken);
  ASSERT_EQ(motion.waypoints.size(), 3u);
  EXPECT_EQ(motion.waypoints[1], Eigen::Vector2d(0.25, 0));
  EXPECT_EQ(motion.waypoints[2], Eigen::Vector2d(1.25, 0.5));
  EXPECT_EQ(motion.times, timed ? (std::vector<double>{1, 3, 5}) : (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(motion.interpolation, Interpolation::linear);
  ASSERT_FALSE(motion.notes.empty());
  EXPECT_EQ(motion.notes[0], taken);
}

TEST(PlanLogsTest, UsualLayoutsAreTakenAndSaid) {
  const KinematicTree tree = armTree();
  const std::string by_place = "its columns are taken so: time = column 0, hinge = column 1, rail = column 2";
  // numpy.savetxt without a header, with times and without
  expectTheLog(read(tree, "# from the robot\n1.0 0.0 0.0\n3.0e+00 2.5e-01 0\n5 1.25\t0.5\n"), true, by_place);
  expectTheLog(read(tree, "0.0 0.0\n0.25 0.0\n1.25 0.5\n"), false,
               "its columns are taken so: hinge = column 0, rail = column 1");
  expectTheLog(read(tree, "1;0;0\n3;0.25;0\n5;1.25;0.5\n"), true, by_place);
  // RTDE, j0 on, q1 on, joint_1 on
  for (const auto& [time, hinge, rail] : {std::array<std::string, 3>{"timestamp", "actual_q_0", "actual_q_1"},
                                          {"t", "j0", "j1"},
                                          {"Time", "q1", "q2"},
                                          {"time [s]", "Joint_1", "Joint_2"},
                                          {"secs", "q[0]", "q[1]"}}) {
    const std::string taken = "its columns are taken so: time = " + time + ", hinge = " + hinge + ", rail = " + rail;
    for (const char* separator : {",", ";", "; ", "\t"}) {
      const std::string s = separator;
      expectTheLog(read(tree, time + s + hinge + s + rail + "\n1" + s + "0" + s + "0\n3" + s + "0.25" + s + "0\n5" + s +
                                  "1.25" + s + "0.5\n"),
                   true, taken);
    }
  }
  // PlotJuggler, in any order
  expectTheLog(read(tree,
                    "__time,/joint_states/rail/position,/joint_states/hinge/position,/joint_states/hinge/effort\n"
                    "1,0,0,9\n3,0,0.25,9\n5,0.5,1.25,9\n"),
               true,
               "its columns are taken so: time = __time, rail = /joint_states/rail/position, hinge = "
               "/joint_states/hinge/position; left out: /joint_states/hinge/effort");
  // Columns that have the robot's own names need no note.
  EXPECT_EQ(read(tree, "time,hinge,rail\n0,0,0\n5,1.25,0.5\n").notes.size(), 0u);
}

TEST(PlanLogsTest, VelocitiesOfALogCount) {
  const KinematicTree tree = armTree();
  const PlanMotion motion =
      read(tree, "timestamp,actual_q_0,actual_q_1,actual_qd_0,actual_qd_1\n0,0,0,0,0\n1,0.5,0,0.25,0\n");
  EXPECT_EQ(motion.interpolation, Interpolation::cubic);
  expectContains(motion.notes.at(0), "rail/velocity = actual_qd_1");
}

TEST(PlanLogsTest, ColumnsMayBeSaid) {
  const KinematicTree tree = armTree();
  ColumnOptions options;
  options.skip = {"gripper"};
  const std::string log = "stamp,hinge,rail,gripper\n1,0,0,8\n3,0.25,0,8\n5,1.25,0.5,8\n";
  expectContains(refusedWith(tree, log), "no joint 'stamp'");
  expectContains(refusedWith(tree, log), "--skip leaves a column out, --columns says what all of them are");
  options.time = "stamp";
  expectTheLog(read(tree, log, options), true,
               "its columns are taken so: time = stamp, hinge = hinge, rail = rail; left out: gripper");
  ColumnOptions all;
  all.columns = {"time", "hinge", "rail", "-"};
  expectTheLog(read(tree, log, all), true,
               "its columns are taken so: time = stamp, hinge = hinge, rail = rail; left out: gripper");
  expectTheLog(read(tree, "1 0 0 8\n3 0.25 0 8\n5 1.25 0.5 8\n", all), true,
               "its columns are taken so: time = column 0, hinge = column 1, rail = column 2; left out: column 3");
  options.skip = {"griper"};
  expectContains(refusedWith(tree, log, options), "--skip: line 1 has no column 'griper'");
  options.skip = {};
  options.time = "clock";
  expectContains(refusedWith(tree, log, options), "--time: line 1 has no column 'clock'");
  all.columns.pop_back();
  expectContains(refusedWith(tree, log, all), "line 1 has 4 columns, --columns names 3");
  all.columns = {"time", "hinge", "hinge", "-"};
  expectContains(refusedWith(tree, log, all), "line 1: two columns are 'hinge', 1 and 2");
  all.columns = {"time", "hing", "rail", "-"};
  expectContains(refusedWith(tree, log, all), "did you mean 'hinge'");
}

// A first row that is broken is no line of names, and the names that NumPy writes in a comment count.
TEST(PlanLogsTest, NoRowAndNoNameIsLost) {
  const KinematicTree tree = armTree();
  ColumnOptions all;
  all.columns = {"hinge", "rail"};
  for (const char* first : {"0.5,0.1x\n", "0.5,\n", "1e-400,0.1\n", "0.5,--\n"}) {
    expectContains(refusedWith(tree, first + std::string("0.25,0\n1,0.5\n"), all),
                   "line 1 neither names columns nor is a row of numbers");
  }
  EXPECT_EQ(read(tree, "a,b\n0.25,0\n1,0.5\n", all).waypoints.size(), 2u);
  for (const char* names : {"# rail,hinge\n", "#rail hinge\n", "# made by hand\n# rail;hinge \n"}) {
    EXPECT_EQ(read(tree, names + std::string("0.25,0\n0.5,1\n")).waypoints[1], Eigen::Vector2d(1, 0.5)) << names;
  }
  EXPECT_EQ(read(tree, "# 2 columns\n0.25,0\n1,0.5\n").waypoints[1], Eigen::Vector2d(1, 0.5));
  expectContains(refusedWith(tree, "# rail elbow\n0.25,0\n1,0.5\n"), "no joint 'elbow'");
}

// Of two columns that say the same, nobody knows which one counts.
TEST(PlanLogsTest, AQuantityOfAJointHasOneColumn) {
  const KinematicTree tree = armTree();
  const std::string rows = "0 0 0 0 0 5\n1 0.25 0 0 0 5\n";
  expectContains(refusedWith(tree, "time hinge rail hinge/velocity rail/velocity hinge_vel\n" + rows),
                 "line 1: two columns are 'hinge/velocity', 3 and 5");
  expectContains(refusedWith(tree, "time hinge rail rail_acc hinge_acc rail.acceleration\n" + rows),
                 "line 1: two columns are 'rail/acceleration', 3 and 5");
}

// A hand whose rail stays, given once for all logs.
TEST(PlanLogsTest, JointsThatStayNeedNoColumn) {
  const KinematicTree tree = armTree();
  MotionOptions options;
  options.state = {{"rail", 0.5}};
  ColumnOptions columns;
  columns.joints = unnamedColumns(tree, options);
  EXPECT_EQ(columns.joints, std::vector<std::string>{"hinge"});
  for (const char* log : {"0\n0.25\n", "1 0\n3 0.25\n", "q1\n0\n0.25\n", "Time;q1\n1;0\n3;0.25\n"}) {
    EXPECT_EQ(read(tree, log, columns, options).waypoints.at(1), Eigen::Vector2d(0.25, 0.5)) << log;
  }
  EXPECT_EQ(toMotion(tree, parsePlans(tree, "0\n0.25\n", Format::ompl).at(0), options).waypoints.at(1),
            Eigen::Vector2d(0.25, 0.5));
}

// If a value has two possible meanings, the reader asks.
TEST(PlanLogsTest, NothingIsGuessed) {
  const KinematicTree tree = armTree();
  expectContains(refusedWith(tree, "q1,q2,q3\n0,0,0\n1,0,0\n"), "no joint 'q1'");  // more than there are joints
  expectContains(refusedWith(tree, "q1,q3\n0,0\n1,0\n"), "no joint 'q1'");         // one is missing
  expectContains(refusedWith(tree, "q2,q3\n0,0\n1,0\n"), "no joint 'q2'");         // from 2 on
  expectContains(refusedWith(tree, "0 0 0\n0 1 0\n"), "names no columns");         // the first one does not rise
  expectContains(refusedWith(tree, "0 0 0 0\n1 1 0 0\n"), "names no columns");
  expectContains(refusedWith(tree, "Time;q1;q2\n0;0,5;0\n1;1;0\n"), "'0,5' is not a finite number");
  expectContains(refusedWith(tree, "time,Time,hinge,rail\n0,0,0,0\n1,1,1,0\n"), "no joint 'Time'");
}

TEST(PlanLogsTest, Degrees) {
  const KinematicTree tree = armTree();
  MotionOptions degrees;
  degrees.degrees = true;
  const std::string log = "hinge,rail\n0,0\n90,0.5\n";
  const double right = 90 * kRadiansPerDegree;
  EXPECT_EQ(read(tree, log, {}, degrees).waypoints.at(1), Eigen::Vector2d(right, 0.5));
  EXPECT_EQ(read(tree, "hinge,rail\n0,0\n90deg,0.5\n").waypoints.at(1), Eigen::Vector2d(right, 0.5));
  EXPECT_EQ(toMotion(tree, parsePlans(tree, "0 0\n90 0.5\n", Format::ompl).at(0), degrees).waypoints.at(1),
            Eigen::Vector2d(right, 0.5));
  const PlanMotion spline = read(tree, "t,hinge,rail,hinge_vel,rail_vel\n0,0,0,180,1\n1,90,0.5,0,0\n", {}, degrees);
  EXPECT_NEAR(spline.trajectory.piece(0).dq()[0], 2 * right, 1e-12);
  // Where values say so, it is asked; where a length is too far, or radians would do, it is not.
  expectContains(refusedWith(tree, log), "are these degrees? --degrees says so; --ignore-limits");
  expectContains(read(tree, "hinge,rail\n0,0\n1.5,0.5\n", {}, degrees).notes.back(), "are these radians?");
  for (const std::string& note : read(tree, log, {}, degrees).notes) EXPECT_EQ(note.find("radians"), std::string::npos);
  EXPECT_EQ(refusedWith(tree, "hinge,rail\n0,0\n200,0.5\n").find("degrees?"), std::string::npos);
  EXPECT_EQ(refusedWith(tree, "hinge,rail\n0,0\n90,5\n").find("degrees?"), std::string::npos);
  EXPECT_EQ(refusedWith(tree, log.substr(0, log.find("90")) + "9000,0.5\n", {}, degrees).find("degrees?"),
            std::string::npos);
  expectContains(refusedWith(tree, "hinge,rail\n0,0\n90deg,0.5\n", {}, degrees), "leave one out");
  expectContains(refusedWith(tree, "hinge,rail\n0,0\n1,90deg\n"), "is no angle");
  expectContains(refusedWith(tree, "time,hinge,rail\n0,0,0\n1deg,1,0\n"), "is no angle");
}

TEST(PlanLogsTest, ALittleBeyondALimitIsNotedOnce) {
  const KinematicTree tree = armTree();
  const auto log = [](const std::string& hinge, const std::string& rail) {
    return "hinge,rail\n0,0\n" + hinge + "," + rail + "\n" + hinge + "," + rail + "\n1,0\n";
  };
  const PlanMotion sensor = read(tree, log("2.00011", "0"));
  ASSERT_EQ(sensor.notes.size(), 1u);
  EXPECT_EQ(sensor.notes[0], "joint 'hinge': waypoints 1 to 2 are beyond its limits [-1, 2], by at most 0.00011 rad");
  EXPECT_EQ(sensor.waypoints[1][0], 2.00011) << "it goes where the log says";
  EXPECT_EQ(read(tree, log("-1.0000000001", "-1.00009")).notes.size(), 2u);
  expectContains(refusedWith(tree, log("2.0011", "0")), "waypoint 1: joint 'hinge' at 2.0011 is beyond its limits");
  expectContains(refusedWith(tree, log("0", "1.00011")), "joint 'rail' at 1.00011");
  MotionOptions options;
  options.limit_tolerance = 0;
  expectContains(refusedWith(tree, log("2.0000001", "0"), {}, options), "is beyond");
  options.ignore_limits = true;
  const PlanMotion far = read(tree, log("2.5", "0"), {}, options);
  ASSERT_EQ(far.notes.size(), 1u);
  expectContains(far.notes[0], "by at most 0.5 rad");
}

}  // namespace logs_test
