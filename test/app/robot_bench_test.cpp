// SPDX-License-Identifier: BSD-3-Clause
// The verb `bench robot` and its parts: the motions that it draws, and answers that contradict each other.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <regex>

#include <nlohmann/json.hpp>

#include "bench/bars.h"
#include "bench/motion_timing.h"
#include "bench/robot_bench.h"
#include "planning/fcl_state_check.h"
#include "random_motions.h"
#include "run_program.h"
#include "world.h"

namespace fcl_artic::app {
namespace robot_bench_test {
namespace {

using Json = nlohmann::json;

/// A hinge with limits, a rail with limits, a wheel without, a ball joint.
KinematicTree manyJoints() {
  KinematicTree tree("joints");
  for (const char* link : {"base", "a", "b", "c", "d"}) tree.addLink(link);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  tree.addJoint(Joint::revolute("hinge", "base", "a", Eigen::Vector3d::UnitZ(), here, -0.05, 2));
  tree.addJoint(Joint::prismatic("rail", "a", "b", Eigen::Vector3d::UnitX(), here, -0.1, 0.3));
  tree.addJoint(Joint::continuous("wheel", "b", "c", Eigen::Vector3d::UnitX(), here));
  Joint ball;
  ball.name = "ball";
  ball.type = JointType::spherical;
  ball.parent = "c";
  ball.child = "d";
  tree.addJoint(ball);
  return tree;
}

double turn(const MotionEnds& ends, int first) {
  const Eigen::Quaterniond a(Eigen::Vector4d(ends.from.segment<4>(first))),
      b(Eigen::Vector4d(ends.to.segment<4>(first)));
  return a.angularDistance(b);
}

/// A virtual joint, as some makers give it, of a robot that drives.
KinematicTree driving() {
  KinematicTree tree("driving");
  for (const char* link : {"world", "a", "b"}) tree.addLink(link);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  tree.addJoint(Joint::prismatic("x", "world", "a", Eigen::Vector3d::UnitX(), here, -999999, 999999));
  tree.addJoint(Joint::revolute("turn", "a", "b", Eigen::Vector3d::UnitZ(), here, -999999, 999999));
  return tree;
}

TEST(RandomMotionsTest, LimitsThatNoMotionMayReachAreNone) {
  const KinematicTree tree = driving();
  RandomMotions random(tree, 0.1, 1);
  for (int i = 0; i < 100; ++i) {
    const MotionEnds ends = random.next();
    EXPECT_NO_THROW(JointMotion::linear(tree, ends.from, ends.to));
    EXPECT_LE(std::abs(ends.from[0]), 1);
    EXPECT_LE(std::abs(ends.from[1]), M_PI);
    EXPECT_LE(std::abs(ends.to[1] - ends.from[1]), 0.1 + 1e-6);
    EXPECT_LT(numSteps(tree, ends, 0.01), 10);
  }
}

TEST(RandomMotionsTest, KeepWithinLimitsAndStep) {
  const KinematicTree tree = manyJoints();
  const double angle = 0.1;
  RandomMotions random(tree, angle, 1), same(tree, angle, 1);
  double hinge = 0, rail = 0, wheel = 0, ball = 0;
  for (int i = 0; i < 2000; ++i) {
    const MotionEnds ends = random.next(), again = same.next();
    ASSERT_EQ(ends.from, again.from);
    ASSERT_EQ(ends.to, again.to);
    ASSERT_NO_THROW(tree.requireConfiguration(ends.to, "to"));
    ASSERT_TRUE(tree.limitNotes(ends.from).empty());
    ASSERT_TRUE(tree.limitNotes(ends.to).empty());
    const Eigen::VectorXd step = (ends.to - ends.from).cwiseAbs();
    hinge = std::max(hinge, step[0]);
    rail = std::max(rail, step[1]);
    wheel = std::max(wheel, step[2]);
    ball = std::max(ball, turn(ends, 3));
  }
  // Ends are rounded to 1e-6; in 2000 draws the largest is hardly 1 % below the bound.
  for (const double largest : {hinge, wheel, ball}) {
    EXPECT_LE(largest, angle + 2e-6);
    EXPECT_GT(largest, 0.99 * angle);
  }
  const double part = angle / (2 * M_PI) * 0.4;
  EXPECT_LE(rail, part + 2e-6);
  EXPECT_GT(rail, 0.98 * part);
}

TEST(RandomMotionsTest, AreWrittenInFull) {
  const KinematicTree tree = manyJoints();
  RandomMotions random(tree, 0.1, 2);
  const MotionEnds ends = random.next();
  std::istringstream text(configurationText(ends.from));
  std::string word;
  int v = 0;
  for (; std::getline(text, word, ','); ++v) EXPECT_EQ(std::stod(word), ends.from[v]) << word;
  EXPECT_EQ(v, tree.dof());
  EXPECT_LE(configurationText(ends.from.head(3)).size(), 3 * sizeof("-0.123456"));
}

TEST(RandomMotionsTest, NeedAJoint) {
  KinematicTree tree("stone");
  tree.addLink("stone");
  const std::string message = messageOf<std::invalid_argument>([&] { RandomMotions(tree, 0.1, 1); });
  expectContains(message, "robot 'stone' has no joint that moves");
}

// 1 % of the hinge's range of 2.05 and the rail's of 0.4 together: sqrt(2.05^2 + 0.4^2) / 100 = 0.02089; of the
// wheel: pi / 100. OMPL's distance of rotations is half their angle, and at most pi / 2.
TEST(RandomMotionsTest, StepsAreCountedAsOmplDoes) {
  const KinematicTree tree = manyJoints();
  MotionEnds ends{tree.neutralConfiguration(), tree.neutralConfiguration()};
  EXPECT_EQ(numSteps(tree, ends, 0.01), 1);
  ends.to[0] = 0.2;  // 0.2 / 0.02089 = 9.6
  EXPECT_EQ(numSteps(tree, ends, 0.01), 10);
  ends.to[2] = 0.5;  // 0.5 / (pi / 100) = 15.9
  EXPECT_EQ(numSteps(tree, ends, 0.01), 16);
  ends.to.segment<4>(3) = Eigen::Quaterniond(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY())).coeffs();
  EXPECT_EQ(numSteps(tree, ends, 0.01), 32);  // 0.5 / (pi / 200) = 31.8
}

/// A hinge from 0 to 1; a motion is in contact if it comes beyond 0.9, and begins in contact beyond 0.95.
struct Fake {
  KinematicTree tree{"fake"};
  Questions questions;
  int asked = 0;  ///< collision queries

  Fake() {
    tree.addLink("base");
    tree.addLink("arm");
    tree.addJoint(
        Joint::revolute("hinge", "base", "arm", Eigen::Vector3d::UnitZ(), Eigen::Isometry3d::Identity(), 0, 1));
    questions.collide = [this](const MotionEnds& ends, ContactMode, CertifiedResult& result) {
      ++asked;
      const double from = ends.from[0], to = ends.to[0];
      result.status = std::max(from, to) > 0.9 ? Status::contact : Status::free;
      result.t_lower = from > 0.95 ? 0 : 0.5;
      result.t_upper = result.t_lower;
      result.certain = !result.isFree();
    };
    questions.clearance = [](const MotionEnds&) {};
    questions.sampleInContact = [](const MotionEnds& ends) {
      return ends.to[0] > 0.9 ? std::optional<double>(1) : std::nullopt;
    };
  }

  DrawnMotions draw(std::vector<Contradiction>& wrong, std::size_t wanted = 50) {
    RandomMotions random(tree, 0.1, 1);
    return drawMotions(random, wanted, questions, wrong, [](double) {});
  }
};

TEST(MotionTimingTest, MotionsAreSortedByWhatTheyMeet) {
  Fake fake;
  std::vector<Contradiction> wrong;
  const DrawnMotions drawn = fake.draw(wrong);
  EXPECT_EQ(drawn.free.size(), 50u);
  EXPECT_EQ(drawn.contact.size(), 50u);
  EXPECT_EQ(drawn.proven.size(), 50u);
  EXPECT_GT(drawn.drawn_free, 100u);  // nine in ten
  EXPECT_GT(drawn.touching.size(), 5u);
  EXPECT_EQ(drawn.drawn, drawn.drawn_free + drawn.drawn_contact + drawn.drawn_touching);
  EXPECT_LT(drawn.drawn, 1000u);
  for (const MotionEnds& ends : drawn.free) EXPECT_LE(std::max(ends.from[0], ends.to[0]), 0.9);
  for (const MotionEnds& ends : drawn.touching) EXPECT_GT(ends.from[0], 0.95);
  int shown = 0;
  const std::vector<TimedRow> rows = timeMotions(drawn, 2, fake.questions, wrong, [&](double share) {
    ++shown;
    EXPECT_LE(share, 1 + 1e-12);
  });
  EXPECT_TRUE(wrong.empty());
  ASSERT_EQ(rows.size(), 9u);
  EXPECT_GE(shown, 2 * 5 * 50);
  for (const TimedRow& row : rows) {
    EXPECT_FALSE(row.us.empty()) << row.motions << row.question;
    EXPECT_GT(row.slowest(), 0) << row.motions << row.question;
    EXPECT_LE(row.quantile(0.5), row.quantile(0.999));
    EXPECT_LE(row.quantile(0.999), row.slowest());
  }
  // Motions that come back below 0.9 are seen by no sample at their end.
  const std::size_t unseen = static_cast<std::size_t>(
      std::count_if(drawn.contact.begin(), drawn.contact.end(), [](const auto& ends) { return ends.to[0] <= 0.9; }));
  EXPECT_GT(unseen, 0u);
  EXPECT_EQ(rows.back().question, "FCL, 1 %");
  EXPECT_EQ(rows.back().motions, "contact");
  EXPECT_EQ(rows.back().missed, unseen);
}

TEST(MotionTimingTest, DrawingEndsWhereNothingTouches) {
  Fake fake;
  fake.questions.collide = [](const MotionEnds&, ContactMode, CertifiedResult& result) {
    result.status = Status::free;
  };
  std::vector<Contradiction> wrong;
  const DrawnMotions drawn = fake.draw(wrong, 7);
  EXPECT_EQ(drawn.drawn, 140u);
  EXPECT_EQ(drawn.free.size(), 7u);
  fake.questions.sampleInContact = nullptr;
  const std::vector<TimedRow> rows = timeMotions(drawn, 1, fake.questions, wrong, [](double) {});
  EXPECT_EQ(rows.size(), 7u);
  EXPECT_TRUE(wrong.empty());
  for (const TimedRow& row : rows) EXPECT_EQ(row.us.size(), row.motions == "free" ? 7u : 0u) << row.question;
}

TEST(MotionTimingTest, AnAnswerThatContradictsAnotherIsFound) {
  Fake fake;
  const auto right = fake.questions.collide;
  fake.questions.collide = [&](const MotionEnds& ends, ContactMode mode, CertifiedResult& result) {
    right(ends, mode, result);
    if (mode == ContactMode::any && ends.from[0] > 0.5) result.status = Status::free;
  };
  std::vector<Contradiction> wrong;
  const DrawnMotions drawn = fake.draw(wrong);
  ASSERT_EQ(wrong.size(), drawn.drawn_contact + drawn.drawn_touching);
  expectContains(wrong[0].text, "first says contact (proven) from t = 0");
  expectContains(wrong[0].text, "any says free");
  // Asked again: an answer that was another one before.
  wrong.clear();
  timeMotions(drawn, 1, fake.questions, wrong, [](double) {});
  ASSERT_EQ(wrong.size(), drawn.contact.size() + drawn.touching.size());
  expectContains(wrong[0].text, "asked again, any says free; it was contact");
}

TEST(MotionTimingTest, AStateInContactOnAFreeMotionIsFound) {
  Fake fake;
  std::vector<Contradiction> wrong;
  const DrawnMotions drawn = fake.draw(wrong);
  fake.questions.sampleInContact = [&](const MotionEnds& ends) {
    return ends.from == drawn.free[3].from || ends.to[0] > 0.9 ? std::optional<double>(0.25) : std::nullopt;
  };
  timeMotions(drawn, 1, fake.questions, wrong, [](double) {});
  ASSERT_EQ(wrong.size(), 1u);
  EXPECT_EQ(wrong[0].text, "proven free, FCL says contact at t = 0.25");
  EXPECT_EQ(wrong[0].motion.to, drawn.free[3].to);
}

TEST(MotionTimingTest, ContradictionsAreNamedAndFailTheBench) {
  const auto told = [](std::size_t number, int& status) {
    std::vector<Contradiction> wrong(number, {{Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)}, "it can't be"});
    testing::internal::CaptureStderr();
    status = tellContradictions(wrong, [](const MotionEnds& ends) { return "ask " + configurationText(ends.to); });
    return testing::internal::GetCapturedStderr();
  };
  int status = -1;
  EXPECT_EQ(told(0, status), "");
  EXPECT_EQ(status, 0);
  EXPECT_EQ(told(1, status), "fcl_artic: answers contradict each other: it can't be\nask 1\n");
  EXPECT_EQ(status, 1);
  expectContains(told(13, status), "3 more of these");
}

TEST(WorldOptionsTest, ArgumentsAreReadyForAShell) {
  WorldOptions o;
  o.robot.robot = "it's/my robot.urdf";
  o.robot.srdf = "a.srdf";
  o.robot.base = "-1,0,0";
  o.scenes = {"b.obj", "c$d.obj"};
  o.scale = 0.001;
  EXPECT_EQ(shellArguments(o),
            R"('it'\''s/my robot.urdf' --srdf a.srdf --base=-1,0,0 --scene b.obj --scene 'c$d.obj' --scale 0.001)");
}

// One run in which the machine does something else is no slow query.
TEST(MotionTimingTest, TheSlowestAreAskedAgain) {
  Fake fake;
  std::vector<Contradiction> wrong;
  const DrawnMotions drawn = fake.draw(wrong);
  const auto right = fake.questions.collide;
  int pauses = 0;
  fake.questions.collide = [&](const MotionEnds& ends, ContactMode mode, CertifiedResult& result) {
    right(ends, mode, result);
    const bool free = ends.from == drawn.free[7].from;
    if (!free || mode != ContactMode::first || ++pauses > 1) return;
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(50)) continue;
  };
  const std::vector<TimedRow> rows = timeMotions(drawn, 1, fake.questions, wrong, [](double) {});
  EXPECT_GT(pauses, 1);
  EXPECT_LT(rows[0].us[7], 50e3);
}

TEST(MotionTimingTest, ARowAloneIsTimed) {
  Fake fake;
  std::vector<Contradiction> wrong;
  const DrawnMotions drawn = fake.draw(wrong);
  for (const TimedRow& row : timeMotions(drawn, 1, fake.questions, wrong, [](double) {})) {
    const auto alone = timeMotions(
        drawn, 1, fake.questions, wrong, [](double) {}, row.name());
    ASSERT_EQ(alone.size(), 1u);
    EXPECT_EQ(alone[0].name(), row.name());
    EXPECT_EQ(alone[0].us.size(), row.us.size());
  }
}

TEST(TimedRowTest, QuantilesAreTimesOfTheRow) {
  TimedRow row{"free", "first", {}, 0};
  EXPECT_EQ(row.quantile(0.5), 0);
  for (int i = 1000; i >= 1; --i) row.us.push_back(i);
  EXPECT_EQ(row.quantile(0.5), 500);
  EXPECT_EQ(row.quantile(0.999), 999);
  EXPECT_EQ(row.slowest(), 1000);
  EXPECT_EQ(row.mean(), 500.5);
}

// Links of the arm, which stands along x, and its slide 2 m above; a box that one of them holds.
TEST_F(ProgramTest, FclChecksCarriedObjectsAsTheManagerDoes) {
  const Robot robot = loadUrdf(arm());
  const auto box = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.1, 0.1, 0.1));
  const Eigen::VectorXd q = robot.tree->neutralConfiguration();
  const auto at = [](double x, double y, double z) { return Eigen::Isometry3d(Eigen::Translation3d(x, y, z)); };
  using planning_data::CarriedObject;
  using planning_data::FclStateCheck;
  const LinkId link = robot.tree->linkId("arm");
  const auto collides = [&](const std::vector<CarriedObject>& carried) {
    return FclStateCheck(robot, {}, carried).collides(q);
  };
  EXPECT_FALSE(collides({}));
  EXPECT_FALSE(collides({{"box", box, link, at(0.5, 0, 0), {}}}));       // in the link that carries it
  EXPECT_TRUE(collides({{"box", box, link, at(0, 0, 2), {}}}));          // in the other one
  EXPECT_FALSE(collides({{"box", box, link, at(0, 0, 2), {"slide"}}}));  // which it may touch
  const CarriedObject other{"other", box, robot.tree->linkId("slide"), at(0, 0, -1), {}};
  EXPECT_TRUE(collides({{"box", box, link, at(0, 0, 1), {}}, other}));  // two of two links
  EXPECT_FALSE(collides({{"box", box, link, at(0, 0, 1), {}}, {"other", box, link, at(0, 0, 1), {}}}));  // of one
}

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

TEST_F(ProgramTest, BenchRobotPrintsATable) {
  const Outcome run =
      this->run("bench robot " + arm() + " --scene " + ball() + " --motions 20 --passes 1 --angle 20 --csv " +
                path("t.csv") + " --svg " + path("t.svg"));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  for (const char* part : {"arm: 3 links, 2 with geometry", "scene: 1 object, 0 carried by links", "set-up:",
                           "random motions", "touching at the start", "clearance", "FCL, 1 %", "slowest", "missed"}) {
    expectContains(run.out, part);
  }
  std::istringstream lines(run.out);
  for (std::string line; std::getline(lines, line);) {
    const bool command = line.rfind("fcl_artic check", 0) == 0;
    EXPECT_TRUE(command || line.size() <= 100) << line;
  }
  const std::string csv = read(path("t.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 10);
  expectContains(csv, "contact,\"first\",20,");
  expectContains(read(path("t.svg")), "FCL, 1 %");
}

TEST_F(ProgramTest, BenchRobotNamesTheSlowestMotion) {
  const Outcome run =
      this->run("bench robot " + arm() + " --scene " + ball() + " --motions 20 --passes 1 --angle 20 --seed 5 --json");
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json.at("robot"), "arm");
  EXPECT_EQ(json.at("links_with_geometry"), 2);
  EXPECT_EQ(json.at("scene").at("objects"), 1);
  EXPECT_EQ(json.at("seed"), 5);
  EXPECT_TRUE(json.at("contradictions").empty());
  for (const char* time : {"load", "proofs", "setup"}) EXPECT_GT(json.at("setup_ms").at(time).get<double>(), 0) << time;
  const Json& drawn = json.at("drawn");
  EXPECT_GE(drawn.at("free"), 20);
  EXPECT_GE(drawn.at("contact"), 20);
  EXPECT_EQ(drawn.at("all").get<int>(),
            drawn.at("free").get<int>() + drawn.at("contact").get<int>() + drawn.at("touching_at_start").get<int>());
  ASSERT_EQ(json.at("rows").size(), 9u);
  double slowest = 0;
  for (const Json& row : json.at("rows")) {
    if (row.at("number") == 0) continue;
    EXPECT_LE(row.at("median_us"), row.at("p999_us"));
    if (row.at("question") == "first" || row.at("question") == "any") {
      slowest = std::max(slowest, row.at("slowest_us").get<double>());
    }
  }
  EXPECT_EQ(json.at("slowest").at("us"), slowest);
  EXPECT_LE(json.at("fcl").at("missed"), json.at("fcl").at("proven_contacts"));
  // Its command asks about that very motion.
  std::string command = json.at("slowest").at("command");
  ASSERT_EQ(command.rfind("fcl_artic check ", 0), 0u);
  const Outcome check = this->run(command.substr(10) + " --json");
  EXPECT_EQ(check.status, json.at("slowest").at("motions") == "free" ? 0 : 1) << check.err << command;
  expectContains(command, "--auto-srdf /dev/null");
  expectContains(command, "--scene");
}

TEST_F(ProgramTest, BenchRobotTakesWhatCheckTakes) {
  const std::string block =
      write("block.obj", "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const Outcome run = this->run("bench robot --robot " + arm() + " --scene " + ball() + " --attach arm=" + block +
                                "@1.05,-0.05,0 --floating-base --motions 5 --passes 1 --json");
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json.at("scene").at("carried"), 1);
  const std::string command = json.at("slowest").at("command");
  for (const char* part : {"--floating-base", "--attach arm="}) expectContains(command, part);
  const int status = this->run(command.substr(10)).status;
  EXPECT_EQ(status, json.at("slowest").at("motions") == "free" ? 0 : 1);
}

TEST_F(ProgramTest, BenchRobotWithoutFclHasNoSamples) {
  const Outcome run = this->run("bench robot " + arm() + " --no-fcl --motions 3 --passes 1");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.find("FCL"), std::string::npos) << run.out;
}

TEST_F(ProgramTest, BenchRobotRefusesWrongUse) {
  EXPECT_EQ(this->run("bench").status, 2);
  EXPECT_EQ(this->run("bench robot").status, 2);
  for (const char* option : {"--angle 0", "--motions 0", "--passes 0", "--angle 5deg", "--srdf nowhere.srdf"}) {
    EXPECT_EQ(this->run("bench robot " + arm() + " " + option).status, 2) << option;
  }
  const Outcome none = this->run("bench robot " + arm() + " --no-fcl --only 'free, FCL, 1 %'");
  EXPECT_EQ(none.status, 2);
  expectContains(none.err, "leave --no-fcl out");
  const Outcome missing = this->run("bench robot " + path("nowhere.urdf"));
  EXPECT_EQ(missing.status, 2);
  expectContains(missing.err, "nowhere.urdf");
  const Outcome stone =
      this->run("bench robot " + write("stone.urdf", "<robot name='stone'><link name='stone'/></robot>"));
  EXPECT_EQ(stone.status, 2);
  expectContains(stone.err, "no joint that moves");
}

}  // namespace
}  // namespace robot_bench_test
}  // namespace fcl_artic::app
