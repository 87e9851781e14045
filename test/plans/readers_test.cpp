// SPDX-License-Identifier: BSD-3-Clause
// One plan in every format: the same numbers. An error in a file names waypoint and joint.
#include <array>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <random>

#include "arm.h"
#include "numpy_sample.h"
#include "plans/carried.h"
#include "plans/write.h"
#include "text/utf8.h"

namespace fcl_artic::plans {
namespace readers_test {
namespace {

/// An array file of version 1.0.
std::string npy(const std::string& descr, bool fortran, const std::string& shape, const std::string& data) {
  std::string header =
      "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
  header.resize(118, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + data;
}

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

const std::string kCsv = "rail, time ,hinge\r\n# a comment\n0,1,0\n\n0,3,0.25\n0.5,5,1.25\n";
const std::string kPlain =
    R"({"name": "p", "joints": ["hinge", "rail"], "times": [1, 3, 5], "waypoints": [[0, 0], [0.25, 0], [1.25, 0.5]]})";
const std::string kByName =
    R"({"times": [1, 3, 5], "waypoints": [{"rail": 0, "hinge": 0}, {"hinge": 0.25, "rail": 0}, {"rail": 0.5, "hinge": 1.25}]})";
const std::string kJointTrajectory = R"({"header": {"frame_id": ""}, "joint_names": ["rail", "hinge"], "points": [
  {"positions": [0, 0], "velocities": [], "accelerations": [], "effort": [], "time_from_start": {"sec": 1, "nanosec": 0}},
  {"positions": [0, 0.25], "time_from_start": {"secs": 2, "nsecs": 1000000000}},
  {"positions": [0.5, 1.25], "time_from_start": 5.0}]})";

std::string jointTrajectory() {
  std::string text = kJointTrajectory;
  const std::string wrong = R"("secs": 2, "nsecs": 1000000000)";
  return text.replace(text.find(wrong), wrong.size(), R"("secs": 3, "nsecs": 0)");
}
std::string robotTrajectory() {
  return R"({"joint_trajectory": )" + jointTrajectory() +
         R"(, "multi_dof_joint_trajectory": {"joint_names": [], "points": []}})";
}
/// As `ros2 topic echo --full-length /display_planned_path` prints it.
const std::string kDisplayYaml = R"(model_id: arm
trajectory:
- joint_trajectory:
    header:
      stamp:
        sec: 0
        nanosec: 0
      frame_id: world
    joint_names:
    - hinge
    points:
    - positions:
      - 0.0
      velocities: []
      time_from_start:
        sec: 1
        nanosec: 0
    - positions: [0.25]
      velocities: []
      time_from_start: {sec: 3, nanosec: 0}
    - positions:
      - 1.25
      velocities: []
      time_from_start:
        sec: 5
        nanosec: 0
  multi_dof_joint_trajectory:
    joint_names: []
    points: []
trajectory_start:
  joint_state:
    name: [hinge, rail, gripper]
    position: [0.0, 0.125, 3.0]
  multi_dof_joint_state:
    joint_names:
    - virtual_joint
    transforms:
    - translation: {x: 0.0, y: 0.0, z: 0.0}
      rotation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}
  attached_collision_objects: []
  is_diff: false
---
)";

void expectThePlan(const PlanMotion& motion, const std::string& what, double rail_at_start = 0) {
  SCOPED_TRACE(what);
  ASSERT_EQ(motion.waypoints.size(), 3u);
  EXPECT_EQ(motion.times, (std::vector<double>{1, 3, 5}));
  EXPECT_TRUE(motion.timed);
  EXPECT_EQ(motion.interpolation, Interpolation::linear);
  const double wanted[3][2] = {
      {0, rail_at_start}, {0.25, rail_at_start}, {1.25, rail_at_start == 0 ? 0.5 : rail_at_start}};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(motion.waypoints[k][0], wanted[k][0]) << k;
    EXPECT_EQ(motion.waypoints[k][1], wanted[k][1]) << k;
  }
}

PlanMotion only(const KinematicTree& tree, const std::string& content, Format format,
                const MotionOptions& options = {}) {
  const std::vector<Plan> plans = parsePlans(tree, content, format);
  EXPECT_EQ(plans.size(), 1u);
  return toMotion(tree, plans.at(0), options);
}

TEST(PlanReadersTest, EveryFormatSaysTheSame) {
  const KinematicTree tree = armTree();
  expectThePlan(only(tree, kCsv, Format::csv), "csv");
  expectThePlan(only(tree, kPlain, Format::json), "json, joints and waypoints");
  expectThePlan(only(tree, kByName, Format::json), "json, waypoints by name");
  expectThePlan(only(tree, "{\"plans\": [" + kPlain + "]}", Format::json), "json, plans");
  expectThePlan(only(tree, jointTrajectory(), Format::json), "JointTrajectory");
  expectThePlan(only(tree, robotTrajectory(), Format::json), "RobotTrajectory");
  expectThePlan(only(tree, "{\"trajectory\": [" + robotTrajectory() + "]}", Format::json), "DisplayTrajectory");
  expectThePlan(only(tree, "{\"goal\": {\"trajectory\": " + jointTrajectory() + "}}", Format::json),
                "an action's goal");
  expectThePlan(only(tree, numpySample(), Format::numpy), "npz");
  const std::string plain_line = kPlain + "\n\n" + kByName + "\n";
  const std::vector<Plan> lines = parsePlans(tree, plain_line, Format::jsonl);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].name, "line 1 p");
  EXPECT_EQ(lines[1].name, "line 3");
  for (const Plan& plan : lines) expectThePlan(toMotion(tree, plan, {}), plan.name);
}

// A comment is of all plans of a file, and looked at once. (With the square of the documents, these take 20 s.)
TEST(PlanReadersTest, TimeToReadGrowsWithTheFile) {
  constexpr int kPlans = 8000;
  std::string documents;
  for (int k = 0; k < kPlans; ++k) documents += "---\n# in degrees\nwaypoints: [[0, 0], [1, 0.5]]\n";
  const std::clock_t begin = std::clock();
  const std::vector<Plan> plans = parsePlans(armTree(), documents, Format::yaml);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 3);
  ASSERT_EQ(plans.size(), std::size_t{kPlans});
  EXPECT_EQ(plans.back().other_angles, "line 2 says '# in degrees'");
}

TEST(PlanReadersTest, YamlAsRosPrintsIt) {
  const KinematicTree tree = armTree();
  const PlanMotion motion = only(tree, kDisplayYaml, Format::yaml);
  expectThePlan(motion, "yaml", 0.125);
  ASSERT_EQ(motion.notes.size(), 2u);
  expectContains(motion.notes[0], "'gripper', which the robot lacks");
  expectContains(motion.notes[1], "first waypoint is at t = 1");
  expectThePlan(only(tree, jointTrajectory(), Format::yaml), "JSON is YAML");
  const std::vector<Plan> two = parsePlans(tree, kDisplayYaml + kDisplayYaml, Format::yaml);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].name, "document 1");
  std::string cut = kDisplayYaml;
  cut.replace(cut.find("[0.25]"), 6, "[0.25, '...']");
  expectContains(refusalOf(tree, cut, Format::yaml), "--full-length");
  expectContains(refusalOf(tree, "a: 1\na: 2\n", Format::yaml), "line 2, column 1: the key 'a' is there twice");
  expectContains(refusalOf(tree, R"({"waypoints": [[0, 0]], "from": [0, 0], "to": [1, 1]})", Format::json),
                 "has both 'waypoints' and 'from'");
  expectContains(refusalOf(tree, R"({"from": [0, 0], "start": [0, 0], "to": [1, 1]})", Format::json),
                 "has both 'from' and 'start'");
  expectContains(refusalOf(tree, std::string(200000, '['), Format::json), "nested more than 100 deep");
  expectContains(refusalOf(tree, "a: &x [1]\nb: *x\n", Format::yaml), "alias");
  expectContains(refusalOf(tree, npy("<f0", false, "(1000000000000, 1)", ""), Format::numpy), "items have no size");
  expectContains(refusalOf(tree, "a: [1\n", Format::yaml), "no YAML");
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "- ";
  expectContains(refusalOf(tree, deep + "1\n", Format::yaml), "nested more than 100 deep");
  EXPECT_NE(refusalOf(tree, std::string(100000, '['), Format::yaml), "");
  EXPECT_NE(refusalOf(tree, std::string(100000, '['), Format::json), "");
  EXPECT_NE(refusalOf(tree, std::string(10000, '[') + std::string(10000, ']'), Format::json), "");
}

TEST(PlanReadersTest, OmplText) {
  const KinematicTree tree = armTree();
  for (const std::string text :
       {"0 0 \n0.25 0 \n1.25 0.5 \n\n",
        "Geometric path with 3 states\nRealVectorState [0 0]\nRealVectorState [0.25 0]\n"
        "RealVectorState [1.25 0.5]\n\n",
        "Geometric path with 3 states\nCompound state [\nSO2State [0]\nRealVectorState [0]\n]\n"
        "Compound state [\nSO2State [0.25]\nRealVectorState [0]\n]\n"
        "Compound state [\nSO2State [1.25]\nRealVectorState [0.5]\n]\n"}) {
    const PlanMotion motion = only(tree, text, Format::ompl);
    EXPECT_FALSE(motion.timed);
    EXPECT_EQ(motion.times, (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(motion.waypoints[1][0], 0.25);
    EXPECT_EQ(motion.waypoints[2][1], 0.5);
  }
  MotionOptions other;
  other.joints = {"rail", "hinge"};
  EXPECT_EQ(only(tree, "0 0\n1 0.5\n", Format::ompl, other).waypoints[1][0], 0.5);
  expectContains(refusalOf(tree, "0 0 1\n0 0 1\n", Format::ompl),
                 "waypoint 0 has 3 values and no names; robot 'arm' has 2");
  expectContains(refusalOf(tree, "0 0\n0\n", Format::ompl), "waypoint 1 has 1 positions for 2 joints");
  expectContains(refusalOf(tree, "0 0\n0 x\n", Format::ompl), "line 2: 'x' is not a number (waypoint 1)");
  expectContains(refusalOf(tree, "0 0\n0.5 nan\n", Format::ompl), "waypoint 1, joint 'rail': nan");
  expectContains(refusalOf(tree, "0 0\n0.5 3\n", Format::ompl), "waypoint 1: joint 'rail' at 3 is beyond its limits");
  expectContains(refusalOf(tree, "0 0\n]\n", Format::ompl), "line 2: a bracket that nothing opens (waypoint 1)");
  expectContains(refusalOf(tree, "0 0\nCompound state [\nSO2State [0]\n", Format::ompl), "waypoint 1, the last state");
  expectContains(refusalOf(tree, "Compound state [\nSO2State [0]\n", Format::ompl), "cut short");
  // Numbers that stand where none belong.
  expectContains(refusalOf(tree, "0 0\nRealVectorState [0 0] 1 0.5\n", Format::ompl), "line 2: 'RealVectorState'");
  expectContains(refusalOf(tree, "0 0\nRealVectorState 1 [0 0]\n", Format::ompl), "'RealVectorState 1' is no state");
  expectContains(refusalOf(tree, "Compound state [ 1\nRealVectorState [0 0]\n]\n", Format::ompl), "line 1: 'Compound'");
}

/// Tags say what a value means: ROS has !degrees and !radians.
TEST(PlanReadersTest, TagsOfYaml) {
  const KinematicTree tree = armTree();
  const auto yaml = [](const std::string& value) { return "waypoints:\n- [0, 0]\n- [" + value + ", 0.5]\n"; };
  EXPECT_EQ(only(tree, yaml("!!float 1"), Format::yaml).waypoints[1][0], 1);
  expectContains(refusalOf(tree, yaml("!degrees 1"), Format::yaml), "line 3, column 4: the tag !degrees, which is not");
  expectContains(refusalOf(tree, yaml("!!str 1"), Format::yaml), "is not a number");
  expectContains(refusalOf(tree, "waypoints: !degrees\n- [0, 0]\n- [1, 0.5]\n", Format::yaml), "the tag !degrees");
  expectContains(refusalOf(tree, "!millimetres\nwaypoints:\n- [0, 0]\n- [1, 0.5]\n", Format::yaml), "the tag !mill");
}

// For yaml-cpp a comma in place of a value is an empty document, again and again.
TEST(PlanReadersTest, SignsOfYamlThatBeginNoValueAreRefused) {
  const KinematicTree tree = armTree();
  expectContains(refusalOf(tree, "!\"\",65535,", Format::yaml), "line 1, column 4: a sign that begins no value");
  expectContains(refusalOf(tree, ",", Format::yaml), "a sign that begins no value");
  EXPECT_EQ(parsePlans(tree, "--- [[0, 0], [1, 0.5]]\n--- [[0, 0], [1, 0.25]]\n...\n", Format::yaml).size(), 2u);
}

TEST(PlanReadersTest, Arrays) {
  const KinematicTree tree = armTree();
  const std::vector<double> c_order{0, 0, 0.25, 0, 1.25, 0.5}, fortran{0, 0.25, 1.25, 0, 0, 0.5};
  std::vector<double> big = c_order;
  for (double& x : big) {
    auto* bytes = reinterpret_cast<char*>(&x);
    std::reverse(bytes, bytes + sizeof x);
  }
  const std::vector<float> single(c_order.begin(), c_order.end());
  for (const std::string& content :
       {npy("<f8", false, "(3, 2)", raw(c_order)), npy("<f8", true, "(3, 2)", raw(fortran)),
        npy(">f8", false, "(3, 2)", raw(big)), npy("<f4", false, "(3, 2)", raw(single))}) {
    const PlanMotion motion = only(tree, content, Format::numpy);
    EXPECT_EQ(motion.waypoints[1], Eigen::Vector2d(0.25, 0));
    EXPECT_EQ(motion.waypoints[2], Eigen::Vector2d(1.25, 0.5));
  }
  std::vector<double> many = c_order;
  many.insert(many.end(), c_order.rbegin(), c_order.rend());
  const std::vector<Plan> two = parsePlans(tree, npy("<f8", false, "(2, 3, 2)", raw(many)), Format::numpy);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].positions[0][0], 0.5);
  EXPECT_EQ(two[1].name, "array[1]");
  expectContains(refusalOf(tree, npy("<f8", false, "(3, 3)", raw(c_order)), Format::numpy),
                 "48 bytes of data, its header says 72");
  expectContains(refusalOf(tree, npy("<c16", false, "(3, 1)", raw(c_order)), Format::numpy), "type '<c16'");
  expectContains(refusalOf(tree, npy("<f8", false, "(0, 2)", ""), Format::numpy), "empty");
  expectContains(refusalOf(tree, npy("<f8", false, "(6,)", raw(c_order)), Format::numpy),
                 "waypoints by joints are wanted");
  const std::string own = numpySample();
  std::string damaged = own;
  damaged[80] = static_cast<char>(damaged[80] ^ 8);
  expectContains(refusalOf(tree, damaged, Format::numpy), "'positions.npy'");
  expectContains(refusalOf(tree, own.substr(0, own.size() - 40), Format::numpy), "cut short");
}

TEST(PlanReadersTest, HeadsOfArraysAreReadStrictly) {
  const KinematicTree tree = armTree();
  const std::string data = raw<double>({0, 0, 1, 0.5});
  EXPECT_EQ(only(tree, npy("<f8", false, "(2L, 2)", data), Format::numpy).waypoints[1][1], 0.5);
  expectContains(refusalOf(tree, npy("<f8", false, "(-2, 2)", data), Format::numpy),
                 "a shape of other than whole numbers");
  std::string text = npy("<f8", false, "(2, 2)", data);
  text.replace(text.find("False"), 5, "1    ");
  expectContains(refusalOf(tree, text, Format::numpy), "fortran_order of its header is neither True nor False");
}

TEST(PlanReadersTest, PosesOfPlanarAndFloatingJoints) {
  const KinematicTree tree = cartTree();
  const auto message = [](const std::string& second_pose,
                          const std::string& drone = R"({"x": 0, "y": 0, "z": 0.96, "w": -0.28})") {
    return R"({"joint_trajectory": {"joint_names": ["wheel"], "points": [
        {"positions": [0], "time_from_start": {"sec": 0, "nanosec": 0}},
        {"positions": [1], "time_from_start": {"sec": 2, "nanosec": 500000000}}]},
      "multi_dof_joint_trajectory": {"joint_names": ["drive", "fly"], "points": [
        {"transforms": [{"translation": {"x": 0, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
                        {"translation": {"x": 1, "y": 2, "z": 3}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}}],
         "time_from_start": {"sec": 0, "nanosec": 0}},
        {"transforms": [)" +
           second_pose + R"(, {"translation": {"x": 1, "y": 2, "z": 4}, "rotation": )" + drone + R"(}],
         "time_from_start": {"sec": 2, "nanosec": 500000000}}]}})";
  };
  const std::string turned =
      R"({"translation": {"x": 0.5, "y": 1, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0.7071067811865476, "w": 0.7071067811865476}})";
  const PlanMotion motion = only(tree, message(turned), Format::json);
  const Eigen::VectorXd& q = motion.waypoints[1];
  EXPECT_EQ(motion.times[1], 2.5);
  EXPECT_EQ(q[0], 0.5);
  EXPECT_EQ(q[1], 1);
  EXPECT_NEAR(q[2], M_PI / 2, 1e-15);
  EXPECT_EQ(q[3], 1);  // the wheel
  EXPECT_EQ(q[6], 4);
  EXPECT_EQ(q[9], 0.96);
  EXPECT_EQ(q[10], -0.28);
  // Half a turn, and as near to one as a file of six digits can say: which way round?
  for (const char* half : {R"({"x": 0, "y": 0, "z": 1, "w": 0})", R"({"x": 0, "y": 0, "z": 1, "w": 0.000001})",
                           R"({"x": 0.6, "y": 0.8, "z": 0, "w": -1e-9})", R"({"x": 0, "y": 3, "z": 0, "w": 0})"}) {
    expectContains(refusalOf(tree, message(turned, half), Format::json),
                   "waypoint 1: joint 'fly' turns by half a turn from waypoint 0, which says not which way round");
  }
  EXPECT_EQ(only(tree, message(turned, R"({"x": 0, "y": 0, "z": 1, "w": 0.0001})"), Format::json).waypoints.size(), 2u);
  const std::string tilted =
      R"({"translation": {"x": 0.5, "y": 1, "z": 0}, "rotation": {"x": 0.6, "y": 0, "z": 0, "w": 0.8}})";
  expectContains(refusalOf(tree, message(tilted), Format::json),
                 "waypoint 1, joint 'drive': the pose leaves the plane");
  const KinematicTree arm = armTree();
  expectContains(refusalOf(arm, message(turned), Format::json), "robot 'arm' has no planar or floating joint 'drive'");
}

/// All that an object holds is certified, for the robot that it names.
TEST(PlanReadersTest, AClocksTimesAreCountedFromTheFirst) {
  const KinematicTree tree = armTree();
  const Plan plan = parsePlans(tree, "time,hinge,rail\n1700000000.5,0,0\n1700000002,1,0\n", Format::csv).at(0);
  EXPECT_EQ(plan.times, (std::vector<double>{0, 1.5}));
  expectContains(plan.notes.at(0), "counted from the first, 1700000000.500000 s");
  EXPECT_EQ(parsePlans(tree, "time,hinge,rail\n5,0,0\n7,1,0\n", Format::csv).at(0).times, (std::vector<double>{5, 7}));
}

TEST(PlanReadersTest, AnObjectHoldsOnePlanOfThisRobot) {
  const KinematicTree tree = armTree();
  const std::string
      points =
          R"("points": [{"positions": [0, 0], "time_from_start": 0}, {"positions": [1, 0], "time_from_start": 1}])",
      joints = R"({"joint_names": ["hinge", "rail"], )" + points + "}",
      robot =
          R"({"joint_trajectory": )" + joints + R"(, "multi_dof_joint_trajectory": {"joint_names": [], "points": []}})";
  const auto errorOf = [&](const std::string& document) {
    const std::vector<Plan> plans = parsePlans(tree, document, Format::json);
    EXPECT_EQ(plans.size(), 1u) << document;
    return plans.at(0).error;
  };
  for (const std::string& two : {R"({"trajectory": [)" + robot + R"(], "planned_trajectory": )" + robot + "}",
                                 R"({"joint_trajectory": )" + joints + R"(, "waypoints": [[0, 0], [1, 0]]})",
                                 R"({"joint_trajectory": )" + joints + ", " + points + "}",
                                 R"({"plans": [{"from": [0, 0], "to": [1, 0]}], "trajectory": )" + robot + "}",
                                 R"({"from": [0, 0], "to": [1, 0], "msg": )" + robot + "}"}) {
    expectContains(errorOf(two), "it holds more than one plan, in '");
  }
  expectContains(errorOf(R"({"trajectory": )" + joints + R"(, "multi_dof_trajectory": )" + joints + "}"),
                 "joint 'hinge' of robot 'arm' is neither planar nor floating");
  for (const std::string& one :
       {R"({"trajectory": )" + joints + R"(, "multi_dof_trajectory": {"joint_names": [], "points": []}})",
        R"({"goal": {"trajectory": )" + joints + "}}", std::string(R"({"start": [0, 0], "goal": [1, 0]})"),
        R"({"model_id": "arm", "trajectory": [)" + robot + "]}",
        R"({"model_id": "", "trajectory": [)" + robot + "]}"}) {
    EXPECT_EQ(errorOf(one), "") << one;
  }
  const Plan ran = parsePlans(tree, R"({"planned_trajectory": )" + robot + R"(, "executed_trajectory": )" + robot + "}",
                              Format::json)
                       .at(0);
  EXPECT_EQ(ran.error, "");
  expectContains(ran.notes.at(0), "executed_trajectory");
  expectContains(errorOf(R"({"model_id": "panda", "trajectory": [)" + robot + "]}"),
                 R"(the message is for the robot "panda" (model_id), and this one is 'arm')");
}

TEST(PlanReadersTest, PartsOfADisplayFollowEachOther) {
  const KinematicTree tree = armTree();
  const auto part = [](const std::string& joint, double to) {
    return R"({"joint_trajectory": {"joint_names": [")" + joint +
           R"("], "points": [{"positions": [0.1], "time_from_start": 0}, {"positions": [)" + std::to_string(to) +
           R"(], "time_from_start": 1}]}})";
  };
  const std::string start =
      R"("trajectory_start": {"joint_state": {"name": ["hinge", "rail"], "position": [0.1, 0.1]}})";
  const std::vector<Plan> plans = parsePlans(
      tree, "{\"trajectory\": [" + part("hinge", 1) + ", " + part("rail", 0.5) + "], " + start + "}", Format::json);
  ASSERT_EQ(plans.size(), 2u);
  EXPECT_EQ(toMotion(tree, plans[0], {}).waypoints[1], Eigen::Vector2d(1, 0.1));
  EXPECT_EQ(toMotion(tree, plans[1], {}).waypoints[0],
            Eigen::Vector2d(1, 0.1));  // the hinge is where the first left it
  EXPECT_EQ(toMotion(tree, plans[1], {}).waypoints[1], Eigen::Vector2d(1, 0.5));
  // A gap between parts is nobody's way; nor is one that follows a wrong part.
  const std::string joined = part("hinge", 1) + ", " + part("hinge", 0.5);
  const std::vector<Plan> apart =
      parsePlans(tree, "{\"trajectory\": [" + joined + ", " + part("hinge", 2) + "], " + start + "}", Format::json);
  ASSERT_EQ(apart.size(), 3u);
  EXPECT_EQ(apart[0].error, "");
  expectContains(apart[1].error,
                 "'hinge' is at 0.1 at its begin, and at 1 where the parts of the message before it end");
  expectContains(apart[2].error, "the part before it, is wrong");
  const std::string moved =
      R"("trajectory_start": {"multi_dof_joint_state": {"joint_names": ["virtual"], "transforms": [
        {"translation": {"x": 0, "y": 0.1, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}}]}})";
  expectContains(refusalOf(tree, "{\"trajectory\": [" + part("hinge", 1) + "], " + moved + "}", Format::json),
                 "--base");
  const std::string carrying =
      R"("trajectory_start": {"attached_collision_objects": [{"link_name": "arm", "object": {"id": "cup"}}]})";
  const std::vector<Carried> carried =
      parsePlans(tree, "{\"trajectory\": [" + part("hinge", 1) + "], " + carrying + "}", Format::json).at(0).carried;
  ASSERT_EQ(carried.size(), 1u);
  EXPECT_EQ(carried[0].name, "cup");
  EXPECT_EQ(carried[0].link, "arm");
}

/// If a joint that follows another one stands elsewhere in the message, the plan is of another robot than the tree.
TEST(PlanReadersTest, MimicJointsOfTheStartStandWhereTheirMastersHaveThem) {
  const KinematicTree tree = gripperTree();
  const auto message = [](const std::string& names, const std::string& positions) {
    return R"({"trajectory": [{"joint_trajectory": {"joint_names": ["hinge"], "points": [
        {"positions": [0], "time_from_start": 0}, {"positions": [1], "time_from_start": 1}]}}],
      "trajectory_start": {"joint_state": {"name": [)" +
           names + R"(], "position": [)" + positions + "]}}}";
  };
  const std::string all = R"("finger", "hinge", "rail")";
  EXPECT_EQ(only(tree, message(all, "-0.1, 0, 0.4"), Format::json).waypoints[0][1], 0.4);
  EXPECT_EQ(only(tree, message(all, "-0.1000005, 0, 0.4"), Format::json).waypoints[0][1], 0.4);
  expectContains(refusalOf(tree, message(all, "0.02, 0, 0.4"), Format::json),
                 "trajectory_start: joint 'finger' is at 0.02, where the joint that it mimics, 'rail', has it at -0.1");
  expectContains(refusalOf(tree, message(all, "NaN, 0, 0.4"), Format::json), "joint 'finger' is at nan");
  expectContains(refusalOf(tree, message(R"("finger", "hinge")", "0.02, 0"), Format::json),
                 "joint 'finger' is at 0.02, and the joint that it mimics, 'rail', has no value there");
}

/// Every object that is carried is attached by its name, to its link; none stands for two.
TEST(PlanReadersTest, CarriedObjectsAreThoseThatAreAttached) {
  KinematicTree tree = armTree();
  for (const char* link : {"hand", "flange"}) {
    tree.addLink(link);
    tree.addJoint(Joint::fixed(link, "arm", link));
  }
  const LinkId arm = tree.linkId("arm"), hand = tree.linkId("hand"), slide = tree.linkId("slide");
  const auto require = [&](const std::vector<Carried>& carried, const std::vector<Attached>& attached) {
    Plan plan;
    plan.carried = carried;
    requireCarried(tree, plan, attached, "say what");
  };
  const auto refused = [&](const std::vector<Carried>& carried, const std::vector<Attached>& attached,
                           const std::string& reason) {
    expectContains(refusal([&] { require(carried, attached); }), reason);
  };
  const Attached cup{"mug", {"cup", "cup#2"}, hand}, saucer{"saucer", {"plate"}, hand};
  EXPECT_NO_THROW(require({}, {cup}));
  EXPECT_NO_THROW(require({{"cup", "hand"}}, {saucer, cup}));
  EXPECT_NO_THROW(require({{"cup", "flange"}}, {cup}));  // stands still against the hand
  EXPECT_NO_THROW(require({{"mug", ""}, {"saucer", "arm"}}, {cup, saucer}));
  EXPECT_NO_THROW(require({{"", ""}, {"cup", ""}}, {cup, saucer}));
  EXPECT_NO_THROW(require({{"plate", "arm"}, {"cup", ""}}, {{"things", {"cup", "plate"}, arm}}));
  refused({{"cup", ""}}, {}, "the robot carries 'cup': say what");
  refused({{"cup", ""}, {"saucer", ""}}, {cup},
          "the robot carries 'saucer': say what; what is attached is 'cup', 'cup#2'");
  refused({{"saucer", ""}}, {cup}, "the robot carries 'saucer'");
  refused({{"cup", ""}, {"mug", ""}}, {cup}, "the robot carries 'mug'");  // one object for two
  refused({{"mug", ""}, {"cup", ""}}, {cup}, "the robot carries 'mug'");  // in either order
  refused({{"cup", ""}, {"cup", ""}}, {saucer, cup}, "the robot carries 'cup'");
  refused({{"cup", ""}, {"", ""}}, {cup}, "the robot carries an object without a name: say what");
  refused({{"cup", "slide"}}, {cup},
          "link 'slide' carries 'cup', and it is attached to 'hand', which moves against it");
  refused({{"plate", "hand"}}, {{"", {"plate"}, slide}}, "link 'hand' carries 'plate', and it is attached to 'slide'");
  refused({{"cup", "hnd"}}, {cup}, "robot 'arm' has no such link; did you mean 'hand'?");
}

/// Nobody applies the units that a comment or a column's name speaks of.
TEST(PlanReadersTest, UnitsBesideTheValuesAreNoted) {
  const KinematicTree tree = armTree();
  const auto notesOf = [&](const std::string& content, Format format, bool degrees, const ColumnOptions& columns) {
    MotionOptions options;
    options.degrees = degrees;
    std::string all;
    for (const std::string& note : toMotion(tree, parsePlans(tree, content, format, columns).at(0), options).notes)
      all += note + "\n";
    return all;
  };
  const std::string rows = "hinge,rail\n0,0\n1,0.5\n",
                    yaml = "{joints: [hinge, rail], waypoints: [[0, 0], [1, 0.5]]}\n";
  const std::string in_rad = ": angles are taken in rad", in_m = ": lengths are taken in m, and times in s";
  struct {
    std::string text, note;
  } const kComments[] = {{"# joint angles in degrees", in_rad},
                         {"#deg", in_rad},
                         {"# hinge(DEG)", in_rad},
                         {"# in \xC2\xB0", in_rad},
                         {"# in \xB0", in_rad},
                         {"# rail [mm]", in_m},
                         {"# t in ms\r", in_m},
                         {"# in cm/s", in_m}};
  for (const auto& [comment, note] : kComments) {
    for (const bool above : {true, false}) {
      const std::string csv = above ? comment + "\n" + rows : rows + comment + "\n";
      const std::string all = notesOf(csv, Format::csv, false, {});
      expectContains(all, "line " + std::string(above ? "1" : "4") + " says '" + comment.substr(0, comment.find('\r')));
      expectContains(all, note);
    }
    if (!text::isUtf8(comment)) continue;
    expectContains(notesOf(yaml + comment + "\n", Format::yaml, false, {}), note);
    expectContains(notesOf("--- " + comment + "\n" + yaml, Format::yaml, false, {}), note);
  }
  expectContains(notesOf("\xEF\xBB\xBF# in degrees\n" + rows, Format::csv, false, {}), "line 1 says '# in degrees'");
  expectContains(notesOf("\"# in degrees\"\n" + rows, Format::csv, false, {}), in_rad);
  expectContains(notesOf("{joints: [hinge, rail], # deg\nwaypoints: [[0, 0], [1, 0.5]]}\n", Format::yaml, false, {}),
                 "line 1 says '# deg'");
  // Who says --degrees, knows; of lengths that says nothing.
  EXPECT_EQ(notesOf("# degrees\n" + rows, Format::csv, true, {}).find(in_rad), std::string::npos);
  expectContains(notesOf("# degrees and mm\n" + rows, Format::csv, true, {}), in_m);
  // One note of each kind, of the first line.
  const std::string two = notesOf("# degrees\n# still degrees\n" + rows, Format::csv, false, {});
  expectContains(two, "line 1 says '# degrees'");
  EXPECT_EQ(two.find("still"), std::string::npos);
  // Names that the caller gives another meaning; a variable's own name and a column that is left out are none.
  ColumnOptions columns;
  columns.columns = {"hinge", "rail"};
  expectContains(notesOf("hinge_deg,rail [mm]\n0,0\n1,0.5\n", Format::csv, false, columns),
                 "line 1 says 'hinge_deg'" + in_rad);
  expectContains(notesOf("hinge_deg,rail [mm]\n0,0\n1,0.5\n", Format::csv, false, columns),
                 "line 1 says 'rail [mm]'" + in_m);
  columns = {};
  columns.skip = {"deg"};
  EXPECT_EQ(notesOf("hinge,rail,deg\n0,0,7\n1,0.5,7\n", Format::csv, false, columns).find(in_rad), std::string::npos);
  // Words that only hold such letters.
  EXPECT_EQ(notesOf("# of degenerate programmes, radians, metres\n" + rows, Format::csv, false, {}), "");
}

TEST(PlanReadersTest, RefusesNamingWaypointAndJoint) {
  const KinematicTree tree = armTree();
  const auto json = [&](const std::string& from, const std::string& to, const std::string& reason) {
    std::string text = jointTrajectory();
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    expectContains(refusalOf(tree, text.replace(at, from.size(), to), Format::json), reason);
  };
  json("\"rail\", \"hinge\"", "\"rail\", \"hing\"",
       "robot 'arm' has no joint 'hing'; its joints are: hinge, rail; did you mean 'hinge'?");
  json("\"rail\", \"hinge\"", "\"rail\", \"rail\"", "names joint 'rail' twice");
  json("[0, 0.25]", "[0]", "waypoint 1 has 1 positions for 2 joints");
  json("[0, 0.25]", "[0, NaN]", "waypoint 1, joint 'hinge': nan of its positions is not a finite number");
  json("[0, 0.25]", "[-Infinity, 0]", "waypoint 1, joint 'rail': -inf");
  json("[0, 0.25]", "[0, null]", "waypoint 1, positions, value 1: null is not a number");
  json("[0, 0.25]", "[0, 2.5]", "waypoint 1: joint 'hinge' at 2.5 is beyond its limits [-1, 2]; --ignore-limits");
  json("\"secs\": 3", "\"secs\": 1", "waypoint 1: its time 1 is not later than that of waypoint 0, 1");
  json("\"secs\": 3", "\"secs\": 0", "waypoint 1: its time 0 is not later than that of waypoint 0, 1");
  json("\"nsecs\": 0", "\"nsecs\": 1000000000", "waypoint 1, time_from_start: 1000000000 nanoseconds");
  json("\"velocities\": []", "\"velocities\": [0, 0]", "waypoint 1 has no velocities, the one before has");
  json("\"velocities\": []", "\"velocities\": [0]", "waypoint 0 has 1 velocities for 2 joints");
  json("\"points\"", "\"dots\"", "no plan in it");
  json("\"points\": [", "\"points\": [], \"others\": [", "the key 'others' is not known");
  json("\"joint_names\"", "\"points\": [], \"joint_names\"", "the key 'points' is there twice");
  json("{\"header\"", "{{\"header\"", "no JSON");
  expectContains(refusalOf(tree, R"({"joints": ["hinge", "rail"], "waypoints": [[0, 0]]})", Format::json),
                 "it has 1 waypoint, a plan needs two");
  expectContains(refusalOf(tree, R"({"joints": ["hinge"], "waypoints": [[0], [1]]})", Format::json),
                 "the plan has no joint 'rail': --state rail=VALUE gives its value");
  expectContains(refusalOf(tree, R"({"joint": ["hinge"], "waypoints": [[0], [1]]})", Format::json),
                 "the key 'joint' is not known");
  expectContains(refusalOf(tree, R"({"waypoints": [{"hinge": 0, "rail": 0}, {"hinge": 0}]})", Format::json),
                 "waypoint 1 has no value of joint 'rail'");
  expectContains(refusalOf(tree, "[]", Format::json), "an empty list");
  expectContains(refusalOf(tree, "", Format::json), "no JSON");
  expectContains(refusalOf(tree, "", Format::jsonl), "no plan in it");
  expectContains(refusalOf(tree, "", Format::ompl), "0 waypoints");
  expectContains(refusalOf(tree, "", Format::numpy), "no array of NumPy's");
  expectContains(refusalOf(tree, "", Format::csv), "it is empty");
  expectContains(refusalOf(tree, "time,hinge,rail\n0,0,0\n0,1,0\n", Format::csv),
                 "waypoint 1: its time 0 is not later");
  expectContains(refusalOf(tree, "time,hinge,rail\n0,0,0\n1,0\n", Format::csv),
                 "line 3 has 2 columns, the first line names 3 (waypoint 1)");
  expectContains(refusalOf(tree, "time,hinge,rail\n0,0,0\n1,nan,0\n", Format::csv),
                 "line 3, column 'hinge': 'nan' is not a finite number (waypoint 1)");
  expectContains(refusalOf(tree, "hinge,rail\n# from\n0,0\n\n1,0\n0,inf\n", Format::csv),
                 "line 6, column 'rail': 'inf' is not a finite number (waypoint 2)");
  expectContains(refusalOf(tree, "time,hinge,rail,hinge_vel\n0,0,0,0\n1,1,0,0\n", Format::csv),
                 "line 1: joint 'rail' has no column of its velocity");
  expectContains(refusalOf(tree, "time,hinge,elbow\n0,0,0\n1,1,0\n", Format::csv), "no joint 'elbow'");
}

TEST(PlanReadersTest, WhatIsWrittenIsReadAgain) {
  const KinematicTree tree = armTree();
  Plan plan;
  plan.name = "p";
  plan.joints = {"rail", "hinge"};
  plan.times = {0.5, 1.0 / 3 + 1, 1e3};
  plan.positions = {{0.1, 1.0 / 3}, {-0.0, 1e-300}, {0.5, 1}};
  plan.velocities = {{0, 0}, {1, 2}, {0, 0}};
  plan.accelerations = {{0, 0}, {-1, 1e-7}, {0, 0}};
  for (const Format format : {Format::csv, Format::json, Format::jsonl, Format::yaml, Format::ompl}) {
    const Plan back = parsePlans(tree, writePlans({plan}, format), format).at(0);
    EXPECT_EQ(back.positions, plan.positions);
    if (format == Format::ompl) continue;
    EXPECT_EQ(back.joints, plan.joints);
    EXPECT_EQ(back.velocities, plan.velocities);
    EXPECT_EQ(back.accelerations, plan.accelerations);
    ASSERT_EQ(back.times.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back.times[k], plan.times[k], format == Format::csv ? 0 : 5.1e-10);
  }
  // Values of other joints come along.
  Plan part = plan;
  part.joints = {"hinge"};
  part.positions = part.velocities = part.accelerations = {{0}, {0.5}, {1}};
  part.state = {{"rail", 0.125}};
  for (const Format format : {Format::csv, Format::json, Format::jsonl}) {
    for (const bool timed : {true, false}) {
      Plan one = part;
      if (!timed) one.times.clear();
      MotionOptions straight;
      straight.interpolation = Interpolation::linear;
      const PlanMotion motion = only(tree, writePlans({one}, format), format, straight);
      EXPECT_EQ(motion.timed, timed);
      EXPECT_EQ(motion.waypoints[1], Eigen::Vector2d(0.5, 0.125));
    }
  }
  plan.times.clear();
  EXPECT_EQ(parsePlans(tree, writePlans({plan, plan}, Format::json), Format::json).at(1).positions, plan.positions);
  expectContains(refusal([&] { (void)writePlans({plan, plan}, Format::csv); }), "2 plans");
  expectContains(refusal([&] { (void)writePlans({plan}, Format::numpy); }), "not written");
}

// Parts of a file that say a place, an order or a motion, and were once passed over: the way of another plan was
// proven.
TEST(PlanReadersTest, NothingOfADocumentIsPassedOver) {
  const KinematicTree tree = armTree();
  const auto json = [&](const std::string& text, const std::string& reason) {
    expectContains(refusalOf(tree, text, Format::json), reason);
  };
  json(R"({"joints": ["rail", "hinge"], "plans": [{"waypoints": [[0, 0], [0.5, 0.5]]}]})",
       "the key 'joints' is not known");
  const std::string order = "some rows go by name and others do not";
  json(R"({"waypoints": [[0, 0.1], {"rail": 0.1, "hinge": 0.5}]})", "waypoint 1: " + order);
  json(R"({"waypoints": [{"rail": 0.1, "hinge": 0.5}, [0, 0.1]]})", "waypoint 1: " + order);
  json(R"({"from": [0, 0.1], "to": {"rail": 0.1, "hinge": 0.5}})", "waypoint 1: " + order);
  json(R"([[0, 0.1], {"rail": 0.1, "hinge": 0.5}])", "waypoint 1: " + order);
  json(R"({"waypoints": [[0, 0], [1, 1]], "times": [0, 1], "velocities": [{"rail": 1, "hinge": 2}]})",
       "waypoint 0, velocities: " + order);
  const PlanMotion ordered =
      only(tree, R"({"joints": ["rail", "hinge"], "waypoints": [[0, 0.5], {"hinge": 1, "rail": 0.25}]})", Format::json);
  EXPECT_EQ(ordered.waypoints[0], Eigen::Vector2d(0.5, 0));
  EXPECT_EQ(ordered.waypoints[1], Eigen::Vector2d(1, 0.25));
  EXPECT_EQ(only(tree, R"({"start": [0, 0], "goal": [1, 0.5]})", Format::json).waypoints[1], Eigen::Vector2d(1, 0.5));
  json(R"({"waypoints": [[0, 0], [1, 1]], "joints": ["hinge", "rail"], "joint_names": ["rail", "hinge"]})",
       "has both 'joints' and 'joint_names'");

  const std::string joints = jointTrajectory();
  const std::string base = R"({"joint_names": ["drive"], "points": []})";
  json("{\"trajectory\": " + joints + ", \"multi_dof_trajectory\": " + base + "}",
       "no planar or floating joint 'drive'");
  json("{\"trajectory\": " + joints + ", \"planned_trajectory\": " + joints + "}",
       "more than one plan, in 'trajectory' and in 'planned_trajectory'");
  json("{\"trajectory\": " + joints + ", \"offset\": 1}", "the key 'offset' is not known");
  json("{\"joint_trajectory\": " + joints + ", \"points\": []}", "the key 'points' is not known");
  json("{\"units\": \"deg\", " + joints.substr(1), "the key 'units' is not known");
  const auto start = [&](const std::string& state) {
    return "{\"trajectory\": " + joints + ", \"trajectory_start\": " + state + "}";
  };
  json(start(R"({"joint_state": {"name": ["rail", "rail"], "position": [0, 1]}})"), "joint 'rail' is there twice");
  json(start(R"({"joint_states": {}})"), "trajectory_start: the key 'joint_states' is not known");
  json(start(R"({"joint_state": [{"name": ["rail"], "position": [1]}]})"),
       "trajectory_start: 'joint_state' is no object");
  json(start(R"({"multi_dof_joint_state": "base"})"), "trajectory_start: 'multi_dof_joint_state' is no object");
  const std::string scaled = R"({"positions": [0, 0], "scale": 2, )";
  std::string point = joints;
  json(point.replace(point.find("{\"positions\": [0, 0], "), 22, scaled), "waypoint 0: the key 'scale' is not known");
  json(kPlain + std::string(1, '\0'), "byte 0");
  expectThePlan(only(tree, "{\"error_code\": {\"val\": 1}, \"trajectory\": " + joints + "}", Format::json),
                "a response");
}

TEST(PlanReadersTest, BasesOfAGoalMove) {
  const KinematicTree tree = cartTree();
  const std::string pose = R"({"translation": {"x": 1, "y": 2, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}})";
  const std::string text = R"({"goal": {"trajectory": {"joint_names": ["wheel"], "points": [
      {"positions": [0], "time_from_start": 0}, {"positions": [1], "time_from_start": 1}]},
    "multi_dof_trajectory": {"joint_names": ["drive"], "points": [
      {"transforms": [)" + pose +
                           R"(], "time_from_start": 0}, {"transforms": [)" + pose + R"(], "time_from_start": 1}]}}})";
  const Plan plan = parsePlans(tree, text, Format::json).at(0);
  EXPECT_EQ(plan.error, "");
  EXPECT_EQ(plan.joints, (std::vector<std::string>{"wheel", "drive/x", "drive/y", "drive/theta"}));
  ASSERT_EQ(plan.positions.size(), 2u);
  EXPECT_EQ(plan.positions[1], (std::vector<double>{1, 1, 2, 0}));

  // The poses are against the link that the joint hangs on: another frame may stand elsewhere.
  const auto errorIn = [&](const std::string& frame) {
    std::string framed = text;
    const std::string at = "\"joint_names\": [\"drive\"]";
    framed.insert(framed.find(at), "\"header\": {\"frame_id\": \"" + frame + "\"}, ");
    return parsePlans(tree, framed, Format::json).at(0).error;
  };
  EXPECT_EQ(errorIn(""), "");
  EXPECT_EQ(errorIn(tree.joint(tree.jointId("drive")).parent), "");
  expectContains(errorIn("map"),
                 "its poses are in the frame \"map\" (header, frame_id), and joint 'drive' moves against");
}

TEST(PlanReadersTest, TextsThatAreCutShortAreSaid) {
  const KinematicTree tree = armTree();
  const std::string note = "the last line has no line end: the file may be cut short";
  const auto notes = [&](const std::string& text, Format format) { return only(tree, text, format).notes; };
  for (const auto& [text, format] : {std::pair<std::string, Format>{"0 0\n0.5 0.2", Format::ompl},
                                     {"waypoints:\n- [0, 0]\n- - 0.5\n  - 0.2", Format::yaml},
                                     {"hinge,rail\n0,0\n0.5,0.2", Format::csv}}) {
    EXPECT_EQ(notes(text, format), std::vector<std::string>{note}) << text;
    EXPECT_EQ(notes(text + "\n", format), std::vector<std::string>{}) << text;
  }
  const std::string states = "RealVectorState [0 0]\nRealVectorState [0.25 0]\n";
  expectContains(refusalOf(tree, "Geometric path with 3 states\n" + states, Format::ompl),
                 "its first line says 3 states, it has 2");
  expectContains(refusalOf(tree, "Geometric path with x states\n" + states, Format::ompl), "does not say how many");
  expectContains(refusalOf(tree, "Geometric path with 2 states\n" + states + "Geometric path with 2 states\n" + states,
                           Format::ompl),
                 "line 4: a second path begins");
  expectContains(refusalOf(tree, "RealVectorState [0]\nDiscreteState [1]\n", Format::ompl),
                 "line 2: 'DiscreteState' is no state of joints");
  // Its parser takes this byte for the end.
  expectContains(refusalOf(tree, "waypoints:\n- [0, 0]\n- [0, 1]\n\x04\n- [1, 1]\n", Format::yaml),
                 "control character");
  expectContains(refusalOf(tree, "waypoints: [[0, 0], [010, 0]]\n", Format::yaml), "\"010\" is not a number");
}

/// Whatever the bytes: plans, or an error that says something.
TEST(PlanReadersTest, DamagedFilesAreErrors) {
  const KinematicTree tree = armTree();
  const std::vector<double> numbers{0, 0, 0.25, 0, 1.25, 0.5};
  const std::vector<std::pair<std::string, Format>> files{
      {kCsv, Format::csv},
      {robotTrajectory(), Format::json},
      {kPlain + "\n" + kByName, Format::jsonl},
      {kDisplayYaml, Format::yaml},
      {numpySample(), Format::numpy},
      {npy("<f8", false, "(3, 2)", raw(numbers)), Format::numpy},
      {"Geometric path with 2 states\nCompound state [\nSO2State [0]\nRealVectorState [0]\n]\n1 1\n", Format::ompl}};
  std::mt19937 random(20040401);
  int refused = 0, accepted = 0;
  for (const auto& [content, format] : files) {
    for (int i = 0; i < 1500; ++i) {
      std::string text = content;
      for (int changes = 1 + static_cast<int>(random() % 3); changes > 0 && !text.empty(); --changes) {
        const std::size_t at = random() % text.size();
        if (random() % 4 == 0) {
          text.erase(at, random() % 20);
        } else {
          text[at] = static_cast<char>(random() % 2 ? random() : "0123456789[]{},:-\"\n "[random() % 20]);
        }
      }
      try {
        for (const Plan& plan : parsePlans(tree, text, format)) {
          (void)toMotion(tree, plan, {});
          ++accepted;
        }
      } catch (const std::invalid_argument& error) {
        EXPECT_STRNE(error.what(), "");
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 2000);
  EXPECT_GT(accepted, 500);
}

}  // namespace
}  // namespace readers_test
}  // namespace fcl_artic::plans
