// SPDX-License-Identifier: BSD-3-Clause
// The curves between waypoints, beside an evaluation of its own: Bézier curves in long doubles, by de Casteljau.
#include <random>

#include "arm.h"

namespace fcl_artic::plans {
namespace motion_test {
namespace {

/// The curve of one joint between two waypoints h apart: that of the degree with these values and derivatives at its
/// ends. A Bézier curve of degree n has the derivatives n (b1 - b0) and n (n - 1) (b2 - 2 b1 + b0) at its ends.
struct End {
  long double q, v, a;
};

long double bezier(std::vector<long double> b, long double s) {
  for (std::size_t n = b.size() - 1; n > 0; --n) {
    for (std::size_t i = 0; i < n; ++i) b[i] += s * (b[i + 1] - b[i]);
  }
  return b[0];
}

long double cubicAt(const End& e0, const End& e1, long double h, long double s) {
  return bezier({e0.q, e0.q + h * e0.v / 3, e1.q - h * e1.v / 3, e1.q}, s);
}

long double quinticAt(const End& e0, const End& e1, long double h, long double s) {
  const long double b1 = e0.q + h * e0.v / 5, b4 = e1.q - h * e1.v / 5;
  return bezier({e0.q, b1, 2 * b1 - e0.q + h * h * e0.a / 20, 2 * b4 - e1.q + h * h * e1.a / 20, b4, e1.q}, s);
}

/// Within the bound of NUMERICS.md, section 12; evaluation at one time adds little.
TEST(PlanMotionTest, SplinesAreThoseOfTheirValues) {
  const KinematicTree tree = armTree();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worst = 0;
  for (int run = 0; run < 300; ++run) {
    Plan plan;
    plan.joints = {"rail", "hinge"};
    double t = 0.1 + unit(random);
    for (int k = 0; k < 4; ++k) {
      plan.times.push_back(t += 0.01 + 2 * std::abs(unit(random)));
      plan.positions.push_back({unit(random), unit(random)});
      plan.velocities.push_back({3 * unit(random), 3 * unit(random)});
      plan.accelerations.push_back({10 * unit(random), 10 * unit(random)});
    }
    for (const bool quintic : {false, true}) {
      Plan one = plan;
      if (!quintic) one.accelerations.clear();
      const PlanMotion motion = toMotion(tree, one, {});
      ASSERT_EQ(motion.interpolation, quintic ? Interpolation::quintic : Interpolation::cubic);
      for (std::size_t k = 0; k < 3; ++k) {
        const double h = plan.times[k + 1] - plan.times[k];
        for (int i = 0; i <= 20; ++i) {
          const double s = i / 20.0;
          const Eigen::VectorXd q = motion.trajectory.piece(k).configuration(s);
          for (std::size_t j = 0; j < 2; ++j) {
            const End e0{plan.positions[k][j], plan.velocities[k][j], plan.accelerations[k][j]},
                e1{plan.positions[k + 1][j], plan.velocities[k + 1][j], plan.accelerations[k + 1][j]};
            const long double wanted = quintic ? quinticAt(e0, e1, h, s) : cubicAt(e0, e1, h, s);
            long double size = 0;
            for (const End& e : {e0, e1})
              size = std::max({size, std::abs(e.q), h * std::abs(e.v), h * h * std::abs(e.a)});
            const double error = static_cast<double>(std::abs(q[j == 0 ? 1 : 0] - wanted) / size);
            worst = std::max(worst, error);
          }
        }
      }
    }
  }
  EXPECT_LT(worst, 2e-13);
  EXPECT_GT(worst, 1e-17);  // they are not the same arithmetic
}

TEST(PlanMotionTest, InterpolationIsAsGivenOrAsAsked) {
  const KinematicTree tree = armTree();
  Plan plan;
  plan.joints = {"hinge", "rail"};
  plan.positions = {{0, 0}, {1, 0}, {0, 0.5}};
  MotionOptions options;
  EXPECT_EQ(toMotion(tree, plan, options).interpolation, Interpolation::linear);
  const auto refused = [&](Interpolation kind, const std::string& reason) {
    options.interpolation = kind;
    expectContains(refusal([&] { (void)toMotion(tree, plan, options); }), reason);
  };
  refused(Interpolation::cubic, "cubic needs velocities");
  plan.velocities = {{0, 0}, {1, 0}, {0, 0}};
  refused(Interpolation::automatic, "cubic needs times");
  plan.times = {0, 1, 2};
  refused(Interpolation::quintic, "quintic needs accelerations");
  options.interpolation = Interpolation::linear;
  EXPECT_NEAR(toMotion(tree, plan, options).trajectory.configuration(0.5)[0], 0.5, 1e-15);
  options.interpolation = Interpolation::automatic;
  // Hermite: q(1/2) = 1/2 - h v1 / 8.
  EXPECT_NEAR(toMotion(tree, plan, options).trajectory.configuration(0.5)[0], 0.375, 1e-15);
  plan.accelerations = {{0, 0}, {0, 0}, {0, 0}};
  // Quintic: q(1/2) = 1/2 - 5/32 h v1.
  EXPECT_NEAR(toMotion(tree, plan, options).trajectory.configuration(0.5)[0], 0.5 - 5.0 / 32, 1e-15);
  options.interpolation = Interpolation::blends;
  options.blend = 0.25;
  const PlanMotion blends = toMotion(tree, plan, options);
  // Half way through the blend it has cut the corner by |change of speed| blend / 4 = 2 * 0.25 / 4.
  EXPECT_NEAR(blends.trajectory.configuration(1)[0], 0.875, 1e-15);
  EXPECT_EQ(blends.waypointBefore(0.9), 0u);
  EXPECT_EQ(blends.waypointBefore(1), 1u);
  EXPECT_EQ(blends.waypointBefore(2.5), 2u);
  options.blend = 1.2;
  expectContains(refusal([&] { (void)toMotion(tree, plan, options); }), "overlap");
}

TEST(PlanMotionTest, LongTurnsAreAskedFor) {
  KinematicTree tree("wheel");
  tree.addLink("base");
  tree.addLink("wheel");
  addJoint(tree, "turn", JointType::continuous, "base", "wheel");
  Plan plan;
  plan.positions = {{3}, {-3}};
  MotionOptions options;
  expectContains(refusal([&] { (void)toMotion(tree, plan, options); }),
                 "joint 'turn' turns forever and goes by -6 rad from waypoint 0 to 1");
  options.turns = Turns::given;
  EXPECT_NEAR(toMotion(tree, plan, options).trajectory.configuration(0.5)[0], 0, 1e-15);
  options.turns = Turns::shortest;
  EXPECT_NEAR(toMotion(tree, plan, options).trajectory.configuration(1)[0], 2 * M_PI - 3, 1e-15);
  plan.positions = {{1}, {-1}};
  EXPECT_EQ(toMotion(tree, plan, {}).waypoints[1][0], -1);
}

/// OMPL prints x, y, z and the quaternion, a state a line.
TEST(PlanMotionTest, HalfTurnsOfQuaternionsHaveNoSense) {
  KinematicTree tree("body");
  tree.addLink("world");
  tree.addLink("body");
  addJoint(tree, "fly", JointType::floating, "world", "body");
  for (const Interpolation kind : {Interpolation::linear, Interpolation::automatic}) {
    MotionOptions options;
    options.interpolation = kind;
    options.turns = Turns::shortest;
    expectContains(refusalOf(tree, "0 0 0 0 0 0 1\n1 0 0 0 0 0.6 0.8\n2 0 0 0 0 -0.8 0.6\n", Format::ompl, options),
                   "waypoint 2: joint 'fly' turns by half a turn from waypoint 1");
  }
  const PlanMotion said =
      toMotion(tree, parsePlans(tree, "0 0 0 0 0 0 1\n1 0 0 0 0 0.6 0.8\n2 0 0 0 0 1 0\n", Format::ompl).at(0), {});
  EXPECT_EQ(said.waypoints.size(), 3u);  // a waypoint between says it
}

TEST(PlanMotionTest, ColumnsWithoutNamesAreSaid) {
  const KinematicTree tree = armTree();
  Plan plan;
  plan.positions = {{0, 0}, {1, 0.5}};
  const PlanMotion motion = toMotion(tree, plan, {});
  EXPECT_FALSE(motion.named);
  EXPECT_EQ(motion.joints, (std::vector<std::string>{"hinge", "rail"}));
  MotionOptions options;
  options.joints = {"rail", "hinge"};
  EXPECT_FALSE(toMotion(tree, plan, options).named);
  EXPECT_EQ(toMotion(tree, plan, options).joints, options.joints);
  plan.joints = {"rail", "hinge"};
  EXPECT_TRUE(toMotion(tree, plan, {}).named);
  EXPECT_TRUE(toMotion(tree, plan, options).named);  // the same names
  options.joints = {"hinge", "rail"};
  expectContains(refusal([&] { (void)toMotion(tree, plan, options); }),
                 "--joints (Python: joints) is hinge, rail, and the plan names its joints itself: rail, hinge");
  // Numbered columns are of the given joints, in whatever order.
  ColumnOptions columns;
  columns.joints = options.joints;
  const Plan numbered = parsePlans(tree, "q2,q1\n0,0\n0.5,1\n", Format::csv, columns).at(0);
  EXPECT_EQ(toMotion(tree, numbered, options).waypoints[1], Eigen::Vector2d(1, 0.5));
}

/// Two waypoints: q1 (3 s² - 2 s³). Three at equal times, 0, 1, 2: 4 v1 = 3 (q2 - q0), so 3/2 at the middle, and half
/// way to it 1/2 - (3/2) / 8. At times 0, 1, 3 and for all others velocity and acceleration go on without a jump.
TEST(PlanMotionTest, TheUpsampledCurveIsOneSmoothSpline) {
  const KinematicTree tree = armTree();
  MotionOptions options;
  options.interpolation = Interpolation::jtcUpsampled;
  Plan plan;
  plan.positions = {{0, 0}, {1, 0.5}};
  EXPECT_NEAR(toMotion(tree, plan, options).trajectory.configuration(0.25)[0], 3.0 / 16 - 2.0 / 64, 1e-15);
  plan.positions = {{0, 0}, {1, 0.25}, {2, 0.5}};
  const PlanMotion even = toMotion(tree, plan, options);
  EXPECT_EQ(even.interpolation, Interpolation::jtcUpsampled);
  expectContains(even.notes.at(0), "policy_frequency");
  EXPECT_NEAR(even.trajectory.configuration(0.5)[0], 0.5 - 1.5 / 8, 1e-15);
  EXPECT_NEAR(even.trajectory.configuration(1.5)[1], 0.25 * (1.5 + 1.5 / 8), 1e-15);

  plan.times = {2, 3, 5, 5.5, 6.5, 9};
  plan.positions = {{0, 0}, {1, 0.5}, {-0.5, 0.25}, {1.5, 0}, {1.5, -0.5}, {0.25, 0.5}};
  const JointTrajectory way = toMotion(tree, plan, options).trajectory;
  const auto derivatives = [&](std::size_t k, double s) {                // of the hinge, by t
    const double h = way.times()[k + 1] - way.times()[k], d = 1.0 / 64;  // exact differences of a cubic
    const auto q = [&](double at) { return way.piece(k).configuration(at)[0]; };
    const double c3 = (q(1) - 3 * q(2.0 / 3) + 3 * q(1.0 / 3) - q(0)) * 4.5;
    const double second = (q(0.5 + d) - 2 * q(0.5) + q(0.5 - d)) / (d * d) + 6 * c3 * (s - 0.5);
    const double middle = (q(0.5 + d) - q(0.5 - d)) / (2 * d) - c3 * d * d;
    const double first =
        middle + (q(0.5 + d) - 2 * q(0.5) + q(0.5 - d)) / (d * d) * (s - 0.5) + 3 * c3 * (s - 0.5) * (s - 0.5);
    return Eigen::Vector2d(first / h, second / (h * h));
  };
  for (std::size_t k = 0; k + 1 < plan.times.size(); ++k) {
    EXPECT_NEAR(way.configuration(plan.times[k])[0], plan.positions[k][0], 1e-14);
    if (k == 0) continue;
    // Second differences over 1/64 lose 1/64² of 16 digits.
    EXPECT_LT((derivatives(k - 1, 1) - derivatives(k, 0)).norm(), 1e-9) << k;
  }
  EXPECT_NEAR(derivatives(0, 0)[0], 0, 1e-10);
  EXPECT_NEAR(derivatives(4, 1)[0], 0, 1e-10);
}

TEST(PlanMotionTest, CurvesHaveTheNamesOfWhatRunsThem) {
  const KinematicTree tree = armTree();
  Plan plan;
  plan.positions = {{0, 0}, {1, 0.5}};
  plan.times = {0, 1};
  MotionOptions options;
  for (const char* name :
       {"auto", "linear", "cubic", "quintic", "blends", "jtc", "jtc-upsampled", "jtc-none", "tangent-half-angle"}) {
    EXPECT_STREQ(toString(interpolationNamed(name)), name);
  }
  options.interpolation = Interpolation::jtc;
  EXPECT_EQ(toMotion(tree, plan, options).interpolation, Interpolation::linear);
  options.interpolation = Interpolation::jtcNone;
  const PlanMotion jumps = toMotion(tree, plan, options);
  EXPECT_EQ(jumps.interpolation, Interpolation::jtcNone);
  expectContains(jumps.notes.at(0), "the controller jumps from waypoint to waypoint");
  // With velocities a message is passed through.
  plan.velocities = {{0, 0}, {0, 0}};
  options.interpolation = Interpolation::jtcUpsampled;
  EXPECT_EQ(toMotion(tree, plan, options).interpolation, Interpolation::cubic);
  options.interpolation = Interpolation::jtc;
  EXPECT_EQ(toMotion(tree, plan, options).interpolation, Interpolation::cubic);
  expectContains(refusal([] { (void)interpolationNamed("totg"); }), "by interpolation jtc");
  expectContains(refusal([] { (void)interpolationNamed("wild"); }), "auto, linear, cubic");
  expectContains(refusal([] { (void)turnsNamed("wild"); }), "'wild' is no value of turns: ask, given, shortest are");
  expectContains(refusal([] {
                   (void)restToRestVelocities({0, 1}, {Eigen::VectorXd::Zero(1)});
                 }),
                 "2 times for 1 waypoints");

  // The controller takes turns as they are, and has no quaternions.
  const KinematicTree cart = cartTree();
  plan = Plan();
  plan.joints = {"wheel"};
  plan.positions = {{3}, {-3}};
  plan.times = {0, 1};
  for (int v = 0; v < cart.dof(); ++v) {
    if (cart.variableName(v) != "wheel") options.state[cart.variableName(v)] = cart.neutralConfiguration()[v];
  }
  expectContains(
      refusal([&] {
        (void)toMotion(cart, plan, {Interpolation::automatic, 0, Turns::ask, false, 1e-3, false, {}, options.state});
      }),
      "turns forever");
  EXPECT_EQ(toMotion(cart, plan, options).trajectory.configuration(0.5)[cart.jointVariable(1)], 0);
  options.turns = Turns::shortest;
  expectContains(refusal([&] { (void)toMotion(cart, plan, options); }), "as the values say");
  options.turns = Turns::ask;
  options.state.erase("fly/rot_z");
  options.state.erase("fly/rot_w");
  plan.joints = {"wheel", "fly/rot_z", "fly/rot_w"};
  plan.positions = {{0, 0, 1}, {0, 0.6, 0.8}};
  expectContains(refusal([&] { (void)toMotion(cart, plan, options); }),
                 "joint 'fly' has a quaternion, and jtc runs none");
}

TEST(PlanMotionTest, OtherJointsKeepTheirState) {
  const KinematicTree tree = armTree();
  Plan plan;
  plan.joints = {"hinge"};
  plan.positions = {{0}, {1}};
  plan.state = {{"rail", 0.25}, {"hinge", 0.5}};  // the plan's own waypoints come first
  EXPECT_EQ(toMotion(tree, plan, {}).waypoints[1], Eigen::Vector2d(1, 0.25));
  MotionOptions options;
  options.state = {{"rail", 1.5}};
  const PlanMotion motion = toMotion(tree, plan, options);
  EXPECT_EQ(motion.waypoints[1], Eigen::Vector2d(1, 1.5));
  ASSERT_EQ(motion.notes.size(), 3u);
  expectContains(motion.notes[0], "joint 'rail' is at 1.5, as asked for; the plan's own start state has it at 0.25");
  expectContains(motion.notes[1], "joint 'rail' stays at 1.5, beyond its limits");
  expectContains(motion.notes[2], "joint 'hinge' begins at 0, the start state has it at 0.5");
  options.state = {{"rail", 0}, {"hinge", 0}};
  expectContains(refusal([&] { (void)toMotion(tree, plan, options); }),
                 "has joint 'hinge' at 0, and waypoint 1 has it at 1");
  options.state = {{"rail", 1.5}};
  plan.state = {{"elbow", 1}};
  expectContains(refusal([&] { (void)toMotion(tree, plan, {}); }), "no joint 'elbow'");
  plan.positions[1][0] = 2.5;
  options.ignore_limits = true;
  plan.state.clear();
  expectContains(toMotion(tree, plan, options).notes[1],
                 "joint 'hinge': waypoint 1 is beyond its limits [-1, 2], by at most 0.5 rad");
}

}  // namespace
}  // namespace motion_test
}  // namespace fcl_artic::plans
