// SPDX-License-Identifier: BSD-3-Clause
// The curves between waypoints, the refusals, and the verdict.
#include <atomic>
#include <cmath>
#include <iostream>
#include <limits>
#include <thread>

#include "fcl_artic_moveit/certifier.h"
#include "models.h"

namespace fcl_artic_moveit {
namespace {

using fcl_artic::Status;
using moveit::core::RobotState;

/// Rail from 0 to 1 and back to 0 in 1 s and 2 s, with rates where they are given.
robot_trajectory::RobotTrajectory railTrip(const Surroundings& all, bool velocities, bool accelerations) {
  auto trip = all.trajectory("all", {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}});
  trip.setWayPointDurationFromPrevious(2, 2);
  const double v[] = {0, 0.5, 0}, a[] = {0, -1, 0.25};
  for (std::size_t k = 0; k < 3; ++k) {
    if (velocities) trip.getWayPointPtr(k)->setVariableVelocity("rail", v[k]);
    if (accelerations) trip.getWayPointPtr(k)->setVariableAcceleration("rail", a[k]);
  }
  return trip;
}

double railAt(const Motion& motion, double t) {
  return motion.trajectory.configuration(t)[0];
}

/// The polynomial's conditions at both ends, by differences: values, velocities, accelerations.
TEST(Motion, AutoTakesTheMostThatTheWaypointsGive) {
  const Surroundings all(slider());
  const RobotTree robot = toTree(*all.model);
  ASSERT_EQ(robot.tree->variableName(0), "rail");
  const Motion linear = toMotion(robot, railTrip(all, false, false));
  EXPECT_EQ(linear.interpolation, Interpolation::linear);
  EXPECT_EQ(linear.times, (std::vector<double>{0, 1, 3}));
  EXPECT_TRUE(linear.timed);
  EXPECT_NEAR(railAt(linear, 0.25), 0.25, 1e-12);
  EXPECT_NEAR(railAt(linear, 2), 0.5, 1e-12);
  EXPECT_EQ(linear.waypointBefore(0.5), 0U);
  EXPECT_EQ(linear.waypointBefore(1), 1U);
  EXPECT_EQ(linear.waypointBefore(3), 2U);

  const Motion cubic = toMotion(robot, railTrip(all, true, false));
  EXPECT_EQ(cubic.interpolation, Interpolation::cubic);
  // q = 3 s² - 2 s³ + 0.5 (s³ - s²): Hermite, with velocity 0.5 at the end; s = 0.5: 0.5 - 0.0625.
  EXPECT_NEAR(railAt(cubic, 0.5), 0.4375, 1e-12);
  EXPECT_EQ(toMotion(robot, railTrip(all, true, false), {Interpolation::linear, Turns::ask}).interpolation,
            Interpolation::linear);

  const Motion quintic = toMotion(robot, railTrip(all, true, true));
  EXPECT_EQ(quintic.interpolation, Interpolation::quintic);
  const double h = 1e-4;
  EXPECT_NEAR(railAt(quintic, 1), 1, 1e-12);
  EXPECT_NEAR((railAt(quintic, 1 + h) - railAt(quintic, 1 - h)) / (2 * h), 0.5, 1e-6);
  EXPECT_NEAR((railAt(quintic, 1 + h) - 2 * railAt(quintic, 1) + railAt(quintic, 1 - h)) / (h * h), -1, 1e-2);
  EXPECT_EQ(toMotion(robot, railTrip(all, true, true), {Interpolation::cubic, Turns::ask}).interpolation,
            Interpolation::cubic);
}

/// The names of `fcl_artic certify --interpolation`, each with the curve that it is of waypoints with all rates and of
/// positions alone. Half way from 0 to 1: the upsampled spline of rails 0, 1, 0 at times 0, 1, 3 has the velocity
/// 2 v = 3 (2/3 - 1/6) at the middle one, so 1/2 - 3/4 / 8; the parabola's blend of 0.25 s ends before.
TEST(Motion, NamesAreThoseOfTheProgram) {
  const Surroundings all(slider());
  const RobotTree robot = toTree(*all.model);
  const struct {
    const char* name;
    Interpolation of_rates, of_positions;
    double half_way;  // of positions alone
  } curves[] = {{"auto", Interpolation::quintic, Interpolation::linear, 0.5},
                {"linear", Interpolation::linear, Interpolation::linear, 0.5},
                {"blends", Interpolation::blends, Interpolation::blends, 0.5},
                {"jtc", Interpolation::quintic, Interpolation::linear, 0.5},
                {"jtc-upsampled", Interpolation::quintic, Interpolation::jtcUpsampled, 0.5 - 0.75 / 8},
                {"jtc-none", Interpolation::jtcNone, Interpolation::jtcNone, 0.5},
                {"tangent-half-angle", Interpolation::tangentHalfAngle, Interpolation::tangentHalfAngle, 0.5}};
  for (const auto& curve : curves) {
    SCOPED_TRACE(curve.name);
    MotionOptions options;
    options.interpolation = interpolationNamed(curve.name);
    options.blend = 0.25;
    EXPECT_EQ(toMotion(robot, railTrip(all, true, true), options).interpolation, curve.of_rates);
    const Motion motion = toMotion(robot, railTrip(all, false, false), options);
    EXPECT_EQ(motion.interpolation, curve.of_positions);
    EXPECT_NEAR(railAt(motion, 0.5), curve.half_way, 1e-12);
  }
  EXPECT_EQ(interpolationNamed("cubic"), Interpolation::cubic);
  EXPECT_EQ(interpolationNamed("quintic"), Interpolation::quintic);
  const auto notes = [&](Interpolation kind) { return toMotion(robot, railTrip(all, false, false), {kind}).notes; };
  EXPECT_TRUE(notes(Interpolation::jtc).empty());
  expectContains(notes(Interpolation::jtcNone).at(0), "the controller gives each waypoint at once");
  expectContains(notes(Interpolation::jtcUpsampled).at(0), "no goals of its action");
  expectContains(refusal([] { (void)interpolationNamed("totg"); }), "certify its result, by interpolation jtc");
}

TEST(Motion, WaypointsWithoutTimesAreNumbered) {
  const Surroundings all(slider());
  const RobotTree robot = toTree(*all.model);
  const auto way = all.trajectory("all", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0);
  const Motion motion = toMotion(robot, way);
  EXPECT_FALSE(motion.timed);
  EXPECT_EQ(motion.times, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(motion.interpolation, Interpolation::linear);
  const auto one = all.trajectory("all", {{0.5, 0, 0}});
  EXPECT_EQ(railAt(toMotion(robot, one), 0.7), 0.5);
  auto late = all.trajectory("all", {{0, 0, 0}, {1, 0, 0}});
  late.setWayPointDurationFromPrevious(0, 0.5);
  EXPECT_EQ(toMotion(robot, late).times, (std::vector<double>{0.5, 1.5}));
  expectContains(toMotion(robot, late).notes.at(0), "the first waypoint is at t = 0.5");
}

TEST(Motion, RefusalsNameWaypointAndJoint) {
  const Surroundings all(slider());
  const RobotTree robot = toTree(*all.model);
  const auto why = [&](const robot_trajectory::RobotTrajectory& trajectory,
                       Interpolation kind = Interpolation::automatic) {
    return refusal([&] { (void)toMotion(robot, trajectory, {kind, Turns::ask}); });
  };
  const std::vector<std::vector<double>> three{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  expectContains(why(all.trajectory("all", {})), "no waypoint");
  auto bad = all.trajectory("all", three);
  bad.setWayPointDurationFromPrevious(2, 0);
  expectContains(why(bad), "waypoint 2: its time 1 is not later than that of waypoint 1");
  bad.setWayPointDurationFromPrevious(2, std::numeric_limits<double>::quiet_NaN());
  expectContains(why(bad), "waypoint 2: its time nan");
  bad = all.trajectory("all", three);
  bad.getWayPointPtr(1)->setVariablePosition("turn", std::numeric_limits<double>::infinity());
  expectContains(why(bad), "waypoint 1: joint variable 'turn' is inf");
  expectContains(why(all.trajectory("rail_only", three)),
                 "waypoint 2: 'turn' moves from 0 to 1 and is not in the group");
  bad = all.trajectory("all", three);
  bad.getWayPointPtr(1)->setVariableVelocity("turn", 1);
  expectContains(why(bad), "waypoint 1 has velocities, waypoint 2 has none");
  expectContains(why(all.trajectory("all", three), Interpolation::cubic), "cubic needs velocities");
  expectContains(why(railTrip(all, true, false), Interpolation::quintic), "quintic needs accelerations");
  expectContains(why(railTrip(all, false, true)), "accelerations and no velocities");
  auto untimed = railTrip(all, true, false);
  for (std::size_t k = 1; k < 3; ++k) untimed.setWayPointDurationFromPrevious(k, 0);
  expectContains(why(untimed, Interpolation::cubic), "cubic needs times");
  auto trip = railTrip(all, true, false);
  trip.getWayPointPtr(1)->setVariableVelocity("turn", std::numeric_limits<double>::quiet_NaN());
  expectContains(why(trip), "waypoint 1: the velocity of 'turn' is nan");
  expectContains(refusal([] { (void)interpolationNamed("straight"); }),
                 "auto, linear, cubic, quintic, blends, jtc, jtc-upsampled, jtc-none, tangent-half-angle are");
  expectContains(refusal([] { (void)turnsNamed("no"); }), "ask, given, shortest are");
}

/// A car that drives in the plane with a wheel on it that turns forever, on a base that floats.
moveit::core::RobotModelConstPtr car(const std::string& drive = "") {
  return modelOf("<robot name='car'>" + boxLink("base", 0.1, 0.1, 0.1) + boxLink("body", 0.4, 0.2, 0.2) +
                     boxLink("wheel", 0.3, 0.05, 0.05, "0.15 0 0.3") + joint("drive", "planar", "base", "body") +
                     joint("spin", "continuous", "body", "wheel", "<axis xyz='0 0 1'/>") + "</robot>",
                 "<robot name='car'><virtual_joint name='fly' type='floating' parent_frame='odom' child_link='base'/>"
                 "<group name='drives'><joint name='drive'/><joint name='spin'/></group>"
                 "<group name='flies'><joint name='fly'/></group>" +
                     drive + "</robot>");
}

/// The first values are the floating base's: at (1, 2, 3), turned by half a turn about z.
std::vector<double> carAt(double x, double y, double theta, double spin, double fly_z = 3) {
  return {1, 2, fly_z, 0, 0, 1, 0, x, y, theta, spin};
}

TEST(Motion, JointsThatTurnForever) {
  const Surroundings all(car());
  const RobotTree robot = toTree(*all.model);
  const auto way = all.trajectory("drives", {carAt(0, 0, 0, 3), carAt(0, 0, 0, -3)});
  expectContains(refusal([&] { (void)toMotion(robot, way); }), "'spin' turns forever and goes by -6 rad");
  const int spin = robot.tree->jointVariable(robot.tree->jointId("spin"));
  EXPECT_NEAR(toMotion(robot, way, {Interpolation::automatic, Turns::given}).trajectory.configuration(0.5)[spin], 0,
              1e-12);
  EXPECT_NEAR(
      std::abs(toMotion(robot, way, {Interpolation::automatic, Turns::shortest}).trajectory.configuration(0.5)[spin]),
      3.14159265358979, 1e-9);
  // The controller takes the values as they are: nothing is asked, and the shorter way round is none of its ways.
  EXPECT_NEAR(toMotion(robot, way, {Interpolation::jtc}).trajectory.configuration(0.5)[spin], 0, 1e-12);
  for (const Interpolation kind : {Interpolation::jtc, Interpolation::jtcUpsampled, Interpolation::jtcNone}) {
    expectContains(refusal([&] { (void)toMotion(robot, way, {kind, Turns::shortest}); }), "says which way round");
  }
  const auto turn = all.trajectory("drives", {carAt(0, 0, 3, 0), carAt(0, 0, -3, 0)});
  expectContains(refusal([&] { (void)toMotion(robot, turn); }), "'drive/theta' turns forever");
}

TEST(Motion, BaseThatFloatsAndStandsStill) {
  const Surroundings all(car());
  const RobotTree robot = toTree(*all.model);
  auto way = all.trajectory("drives", {carAt(0, 0, 0, 0), carAt(1, 1, 1, 1)});
  for (std::size_t k = 0; k < 2; ++k) {
    way.getWayPointPtr(k)->setVariableVelocity("spin", 0.5);
    way.getWayPointPtr(k)->setVariableAcceleration("spin", 1);
  }
  const Motion motion = toMotion(robot, way);
  EXPECT_EQ(motion.interpolation, Interpolation::quintic);
  const Eigen::VectorXd q = motion.trajectory.configuration(0.5);
  for (int v = 0; v < 7; ++v) EXPECT_EQ(q[v], carAt(0, 0, 0, 0)[static_cast<std::size_t>(v)]);
  EXPECT_NEAR(q[robot.tree->jointVariable(robot.tree->jointId("drive"))], 0.5, 1e-12);

  auto moves = all.trajectory("flies", {carAt(0, 0, 0, 0), carAt(0, 0, 0, 0, 4)});
  EXPECT_NEAR(toMotion(robot, moves).trajectory.configuration(0.5)[2], 3.5, 1e-12);
  expectContains(refusal([&] { (void)toMotion(robot, moves, {Interpolation::jtc}); }), "joint 'fly' floats and moves");
  for (std::size_t k = 0; k < 2; ++k) moves.getWayPointPtr(k)->setVariableVelocity("fly/trans_z", 0.5);
  expectContains(refusal([&] { (void)toMotion(robot, moves); }), "joint 'fly' floats and moves");
  auto still = all.trajectory("flies", {carAt(0, 0, 0, 0), carAt(0, 0, 0, 0)});
  for (std::size_t k = 0; k < 2; ++k) still.getWayPointPtr(k)->setVariableVelocity("fly/rot_x", 0.5);
  expectContains(refusal([&] { (void)toMotion(robot, still); }), "joint 'fly' floats and moves");
}

TEST(Motion, DifferentialDriveHasToBeStated) {
  const Surroundings all(car("<joint_property joint_name='drive' property_name='motion_model' value='diff_drive'/>"));
  const RobotTree robot = toTree(*all.model);
  const auto way = all.trajectory("drives", {carAt(0, 0, 0, 0), carAt(1, 0, 1, 0)});
  expectContains(refusal([&] { (void)toMotion(robot, way); }), "joint 'drive' has a differential drive");
  EXPECT_EQ(toMotion(robot, way, {Interpolation::linear, Turns::ask}).interpolation, Interpolation::linear);
  const auto spins = all.trajectory("drives", {carAt(0, 0, 0, 0), carAt(0, 0, 0, 1)});
  EXPECT_EQ(toMotion(robot, spins).interpolation, Interpolation::linear);
}

/// The finger's end is at x = rail + 1.15. A wall at x from 1.65 on is met when the rail is at 0.5.
TEST(Certifier, FirstContactWorkedNumber) {
  Surroundings all(slider());
  all.add("wall", std::make_shared<shapes::Box>(0.1, 1, 1), {1.7, 0, 0});
  const Certifier certifier;
  auto trip = railTrip(all, false, false);
  Verdict verdict = certifier.certify(*all.env, all.acm, trip);
  EXPECT_EQ(verdict.status, Status::contact);
  EXPECT_TRUE(verdict.certain);
  EXPECT_NEAR(verdict.t_lower, 0.5, 1e-5);
  EXPECT_LE(verdict.t_lower, 0.5);
  EXPECT_EQ(verdict.waypoint, 0U);
  ASSERT_EQ(verdict.contacts.size(), 2U);
  EXPECT_EQ(verdict.contacts[0].body1.id, "finger");
  EXPECT_EQ(verdict.contacts[0].body2.id, "wall");
  EXPECT_NEAR(verdict.contacts[0].point.x(), 1.65, 1e-5);
  EXPECT_NEAR(verdict.contacts[0].normal.x(), 1, 1e-5);
  EXPECT_EQ(verdict.contacts[1].body1.id, "arm");
  EXPECT_NEAR(verdict.contacts[1].t, 0.65, 1e-5) << "the arm ends at x = rail + 1";
  ASSERT_EQ(verdict.joints.size(), 3U);
  EXPECT_EQ(verdict.joints[0].first, "rail");
  EXPECT_NEAR(verdict.joints[0].second, 0.5, 1e-5);
  expectContains(verdict.message, "link 'finger' and object 'wall' touch at t = 0.5");
  expectContains(verdict.message, "after waypoint 0 of 3");
  expectContains(verdict.message, "with rail = 0.5 turn = 0 reach = 0");
  expectContains(verdict.message, "also: link 'arm' and object 'wall' touch at t = 0.65");
  expectContains(verdict.message, "allow the pair");
  // With a margin of 0.25 when the rail is at 0.25; with padding likewise. (Links of the robot are nearer to each
  // other.)
  auto links_may = all.acm;
  links_may.setEntry("finger", std::vector<std::string>{"arm", "cart"}, true);
  CertifierOptions options;
  options.margin = 0.25;
  verdict = certifier.certify(*all.env, links_may, trip, nullptr, options);
  EXPECT_NEAR(verdict.t_lower, 0.25, 1e-5);
  expectContains(verdict.message,
                 "link 'finger' and object 'wall' come nearer than 0.25 m (margin 0.25 m) at t = 0.25");
  all.env->setLinkPadding("finger", 0.25);
  verdict = certifier.certify(*all.env, all.acm, trip);
  EXPECT_NEAR(verdict.t_lower, 0.25, 1e-5);
  expectContains(verdict.message,
                 "link 'finger' and object 'wall' come nearer than 0.25 m (padding 0.25 m) at t = 0.25");
  options.margin = 0.125;
  verdict = certifier.certify(*all.env, links_may, trip, nullptr, options);
  EXPECT_NEAR(verdict.t_lower, 0.125, 1e-5);
  expectContains(verdict.message, "come nearer than 0.375 m (padding 0.25 m, margin 0.125 m)");
  all.env->setLinkPadding("finger", 0);
  // Every waypoint of this one is free, MoveIt says so; between them the finger goes through a thin pole.
  all.world->removeObject("wall");
  all.add("pole", std::make_shared<shapes::Cylinder>(0.005, 1), {1.6, 0, 0});
  for (std::size_t k = 0; k < trip.getWayPointCount(); ++k) {
    // The finger is at 1.05 to 1.15 (waypoints 0 and 2) and 2.05 to 2.15 (waypoint 1); the arm ends at 2.
    const bool theirs = all.moveitCollides(trip.getWayPoint(k), "all");
    EXPECT_EQ(theirs, k == 1) << "the arm is in the pole at waypoint 1";
  }
  auto swing = all.trajectory("all", {{0.5, -1, 0}, {0.5, 1, 0}});
  EXPECT_FALSE(all.moveitCollides(swing.getWayPoint(0), "all"));
  EXPECT_FALSE(all.moveitCollides(swing.getWayPoint(1), "all"));
  verdict = certifier.certify(*all.env, all.acm, swing);
  EXPECT_EQ(verdict.status, Status::contact);
  all.world->removeObject("pole");
  verdict = certifier.certify(*all.env, all.acm, swing);
  EXPECT_TRUE(verdict.isFree());
  EXPECT_GE(verdict.pairs, 1U);
  expectContains(verdict.message, "free: proven for");
}

/// Parabolas around waypoint 1 are pieces of their own: what touches in them before the next waypoint is named too. The
/// rail is at 0.5 at t = 0.5, before the blend of 0.25 s, and at 0.65 at t = 0.65.
TEST(Certifier, BlendsHaveMorePiecesThanWaypoints) {
  Surroundings all(slider());
  all.add("wall", std::make_shared<shapes::Box>(0.1, 1, 1), {1.7, 0, 0});
  all.add("far", std::make_shared<shapes::Box>(0.1, 1, 1), {1.99, 0, 0});  // the finger meets it at 0.79, in the blend
  CertifierOptions options;
  options.motion.interpolation = Interpolation::blends;
  options.motion.blend = 0.25;
  const Verdict verdict = Certifier().certify(*all.env, all.acm, railTrip(all, false, false), nullptr, options);
  EXPECT_NEAR(verdict.t_lower, 0.5, 1e-5);
  ASSERT_EQ(verdict.contacts.size(), 3U) << verdict.message;
  EXPECT_NEAR(verdict.contacts[1].t, 0.65, 1e-5);
  EXPECT_EQ(verdict.contacts[2].body2.id, "far");
  EXPECT_GT(verdict.contacts[2].t, 0.79) << "later than straight";
}

TEST(Certifier, BudgetThatRunsOutIsUndecided) {
  Surroundings all(slider());
  for (int i = 0; i < 40; ++i) {
    all.add("ball" + std::to_string(i), std::make_shared<shapes::Sphere>(0.05),
            {1.2 * std::cos(0.1 * i - 2), 1.2 * std::sin(0.1 * i - 2), 0.11});
  }
  CertifierOptions options;
  options.budget = 1;
  const auto swing = all.trajectory("all", {{0, -1, 0}, {0, 1, 0}});
  const Certifier certifier;
  Verdict verdict = certifier.certify(*all.env, all.acm, swing, nullptr, options);
  EXPECT_EQ(verdict.status, Status::undecided);
  expectContains(verdict.message, "the budget ran out");
  EXPECT_FALSE(verdict.out_of_time);
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, swing).isFree());
  // A limit of time, which is looked at between two waypoints too.
  options.budget = 0;
  options.time_limit = 1e-9;
  const auto way = all.trajectory("all", {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}});
  verdict = certifier.certify(*all.env, all.acm, way, nullptr, options);
  EXPECT_EQ(verdict.status, Status::undecided);
  EXPECT_TRUE(verdict.out_of_time);
  expectContains(verdict.message, "undecided: the time ran out");
  options.time_limit = 3600;
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, way, nullptr, options).isFree());
  const auto why = [&](const CertifierOptions& wrong) {
    return refusal([&] { (void)certifier.certify(*all.env, all.acm, way, nullptr, wrong); });
  };
  options.margin = -1;
  expectContains(why(options), "margin -1");
  options.margin = 0;
  options.time_limit = -1;
  expectContains(why(options), "time limit -1");
  options.time_limit = 0;
  options.motion.mimic_tolerance = std::numeric_limits<double>::quiet_NaN();
  expectContains(why(options), "mimic tolerance nan");
  options.motion.mimic_tolerance = 0;
  options.motion.interpolation = Interpolation::blends;
  expectContains(why(options), "blends needs a blend");
  options.motion.interpolation = Interpolation::jtc;
  options.motion.turns = Turns::shortest;
  expectContains(why(options), "says which way round");
}

/// Swings through the pole between two valid waypoints: a way around is found, timed within the joints' limits, and
/// certified as any other; untimed ways stay untimed. A trajectory that begins in contact has none.
TEST(Certifier, RepairGoesAround) {
  if (!Certifier::canRepair()) GTEST_SKIP() << "built without fcl_artic's component ompl";
  Surroundings all(slider());
  all.add("pole", std::make_shared<shapes::Cylinder>(0.005, 1), {1.6, 0, 0});
  const Certifier certifier;
  for (const double step : {1.0, 0.0}) {
    const auto swing = all.trajectory("all", {{0.5, -1, 0}, {0.5, 1, 0}}, step);
    ASSERT_EQ(certifier.certify(*all.env, all.acm, swing).status, Status::contact);
    const Repair mended = certifier.repair(*all.env, all.acm, swing, {}, {});
    EXPECT_GE(mended.detours, 1U);
    EXPECT_TRUE(certifier.certify(*all.env, all.acm, *mended.trajectory).isFree());
    EXPECT_EQ(mended.verdict.timed, step > 0);
    const moveit::core::RobotState &first = mended.trajectory->getFirstWayPoint(),
                                   &last = mended.trajectory->getLastWayPoint();
    EXPECT_NEAR(first.getVariablePosition("turn"), -1, 1e-9);
    EXPECT_NEAR(last.getVariablePosition("turn"), 1, 1e-9);
    for (std::size_t k = 0; step > 0 && k < mended.trajectory->getWayPointCount(); ++k) {
      EXPECT_LE(std::abs(mended.trajectory->getWayPoint(k).getVariableVelocity("turn")), 1 + 1e-6);
    }
  }
  const auto from = all.trajectory("all", {{0.5, 0, 0}, {0.5, 1, 0}});
  try {
    (void)certifier.repair(*all.env, all.acm, from, {}, {});
    ADD_FAILURE() << "it begins in contact";
  } catch (const std::runtime_error& error) {
    expectContains(error.what(), "its start touches something");
  }
}

/// A jaw that mimics the finger, beside it at y from 0.475 to 0.525. The post's face is at y = 0.5255.
struct Jaw : Surroundings {
  Jaw()
      : Surroundings(
            slider("<disable_collisions link1='cart' link2='arm'/>",
                   boxLink("jaw", 0.05, 0.05, 0.05, "0 0.5 0") +
                       joint("follow", "prismatic", "arm", "jaw",
                             "<axis xyz='0 1 0'/><mimic joint='reach' multiplier='1' offset='0'/>", "1 0 0"))) {
    add("post", std::make_shared<shapes::Box>(0.05, 0.1, 0.1), {1.5, 0.5755, 0});
  }
  /// The rail goes from 0 to 1, with the jaw at `follow` on the first `measured` waypoints, and at 0 then.
  robot_trajectory::RobotTrajectory way(const std::string& group, double follow, std::size_t measured) const {
    robot_trajectory::RobotTrajectory out(model, group);
    for (std::size_t k = 0; k < 3; ++k) {
      moveit::core::RobotState at(state);
      at.setVariablePosition("rail", 0.5 * static_cast<double>(k));
      at.setVariablePosition("follow", k < measured ? follow : 0);
      at.update();
      out.addSuffixWayPoint(at, k ? 1 : 0);
    }
    return out;
  }
};

/// MoveIt keeps what /joint_states says of fingers: a mimic joint that the group does not move stands there.
TEST(Certifier, AMimicJointOutsideTheGroupStandsWhereItIs) {
  const Jaw all;
  const Certifier certifier;
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, all.way("rail_only", 0, 3)).isFree());
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, all.way("rail_only", 1e-4, 3)).isFree()) << "0.4 mm from the post";
  Verdict verdict = certifier.certify(*all.env, all.acm, all.way("rail_only", 1e-3, 3));
  EXPECT_EQ(verdict.status, Status::contact) << "0.5 mm within it, where its master would have it 0.5 mm before it";
  expectContains(verdict.message, "link 'jaw' and object 'post' touch");
  EXPECT_EQ(certifier.certify(*all.env, all.acm, all.way("rail_only", 0.1, 3)).status, Status::contact);
  // Planners that put it where its master has it, from the second waypoint on.
  EXPECT_EQ(certifier.certify(*all.env, all.acm, all.way("rail_only", 1e-3, 1)).status, Status::contact);
  expectContains(refusal([&] { (void)certifier.certify(*all.env, all.acm, all.way("rail_only", 2e-3, 1)); }),
                 "waypoint 1: 'follow' moves from 0.002 to 0");
}

TEST(Certifier, AMimicJointOfTheGroupHasATolerance) {
  const Jaw all;
  const Certifier certifier;
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, all.way("all", 0, 3)).notes.empty());
  const Verdict verdict = certifier.certify(*all.env, all.acm, all.way("all", 1e-4, 1));
  EXPECT_TRUE(verdict.isFree());
  ASSERT_EQ(verdict.notes.size(), 1U);
  expectContains(verdict.notes[0], "waypoint 0: joint 'follow' is 0.0001 off");
  const auto why = [&](double follow, const CertifierOptions& options) {
    return refusal([&] { (void)certifier.certify(*all.env, all.acm, all.way("all", follow, 1), nullptr, options); });
  };
  expectContains(why(2e-3, {}), "waypoint 0: joint 'follow' is at 0.002");
  expectContains(why(std::numeric_limits<double>::quiet_NaN(), {}), "joint 'follow' is at nan");
  CertifierOptions exact;
  exact.motion.mimic_tolerance = 0;
  expectContains(why(1e-4, exact), "`mimic_tolerance` says how far");
}

/// As MoveIt Task Constructor has it: a scene, whose state carries what it carries, and a trajectory.
TEST(Certifier, SceneAndTrajectory) {
  planning_scene::PlanningScene scene(slider());
  const Surroundings all(scene.getRobotModel());
  const auto trip = railTrip(all, false, false);
  const Certifier certifier;
  EXPECT_TRUE(certifier.certify(scene, trip).isFree());
  scene.getWorldNonConst()->addToObject("wall", std::make_shared<shapes::Box>(0.1, 1, 1),
                                        Eigen::Isometry3d(Eigen::Translation3d(1.7, 0, 0)));
  EXPECT_NEAR(certifier.certify(scene, trip).t_lower, 0.5, 1e-5);
  Surroundings::attach(scene.getCurrentStateNonConst(), "tool", "finger", std::make_shared<shapes::Sphere>(0.1),
                       {0.2, 0, 0}, {"finger"});
  expectContains(refusal([&] { (void)certifier.certify(scene, trip); }), "the robot starts with 'tool'");
}

TEST(Certifier, BodiesThatComeAndGoAreRefused) {
  Surroundings all(slider());
  const auto box = std::make_shared<shapes::Box>(0.1, 0.1, 0.1);
  auto swing = all.trajectory("all", {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}});
  Surroundings::attach(*swing.getWayPointPtr(1), "tool", "finger", box, {0.2, 0, 0}, {"finger"});
  const Certifier certifier;
  expectContains(refusal([&] { (void)certifier.certify(*all.env, all.acm, swing); }),
                 "waypoint 1 does not carry 'tool'");
  for (const std::size_t k : {0, 2}) {
    Surroundings::attach(*swing.getWayPointPtr(k), "tool", "finger", box, {0.2, k ? 0.01 : 0.0, 0}, {"finger"});
  }
  expectContains(refusal([&] { (void)certifier.certify(*all.env, all.acm, swing); }),
                 "waypoint 2 does not carry 'tool'");
  swing.removeWayPoint(2);
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, swing).isFree());
}

/// A planner whose waypoints have lost the tool leaves a trajectory of another robot.
TEST(Certifier, BodiesOfTheStartAreOnTheWaypoints) {
  Surroundings all(slider());
  const auto box = std::make_shared<shapes::Box>(0.1, 0.1, 0.1);
  const auto swing = all.trajectory("all", {{0, -1, 0}, {0, 0, 0}});
  const Certifier certifier;
  moveit::core::RobotState start(swing.getWayPoint(0));
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, swing, &start).isFree());
  Surroundings::attach(start, "tool", "finger", box, {0.2, 0, 0}, {"finger"});
  const auto message = [&](const robot_trajectory::RobotTrajectory& way) {
    return refusal([&] { (void)certifier.certify(*all.env, all.acm, way, &start); });
  };
  expectContains(message(swing), "the robot starts with 'tool' on link 'finger', and waypoint 0 does not carry it");
  const auto carrying = [&](const shapes::ShapeConstPtr& shape, double x) {
    auto way = all.trajectory("all", {{0, -1, 0}, {0, 0, 0}});
    for (const std::size_t k : {0, 1}) {
      Surroundings::attach(*way.getWayPointPtr(k), "tool", "finger", shape, {x, 0, 0}, {"finger"});
    }
    return way;
  };
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, carrying(box, 0.2), &start).isFree());
  // Made of the same message again: another shape of the same kind.
  EXPECT_TRUE(certifier.certify(*all.env, all.acm, carrying(std::make_shared<shapes::Box>(0.1, 0.1, 0.1), 0.2), &start)
                  .isFree());
  expectContains(message(carrying(box, 0.21)), "waypoint 0 carries it otherwise");
  expectContains(message(carrying(std::make_shared<shapes::Sphere>(0.1), 0.2)), "waypoint 0 carries it otherwise");
}

/// Threads with scenes and attached bodies of their own get the answers that one alone gets.
TEST(Certifier, ThreadsGetTheSameAnswers) {
  const auto model = slider();
  const Certifier certifier;
  const auto ask = [&](int i) {
    Surroundings all(model);
    all.add("block", std::make_shared<shapes::Box>(0.1, 0.1, 0.1), {1.3, 0.02 * i, 0});
    if (i % 3 == 0) all.attach("tool", "finger", std::make_shared<shapes::Box>(0.3, 0.1, 0.1), {0.3, 0, 0}, {"finger"});
    const auto way = all.trajectory("all", {{0, -0.6 + 0.05 * (i % 10), 0}, {0.1, 0.2, 0.1}});
    const Verdict verdict = certifier.certify(*all.env, all.acm, way);
    return std::make_pair(verdict.status, verdict.t_lower);
  };
  std::vector<std::pair<Status, double>> alone, together(60);
  for (int i = 0; i < 60; ++i) alone.push_back(ask(i));
  std::atomic<int> next{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i; (i = next++) < 60;) together[static_cast<std::size_t>(i)] = ask(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
  int free = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_EQ(alone[i], together[i]) << i;
    free += alone[i].first == Status::free;
  }
  std::cout << free << " of 60 free\n";
  EXPECT_GE(free, 5);
  EXPECT_LE(free, 55);
}

}  // namespace
}  // namespace fcl_artic_moveit
