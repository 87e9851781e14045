// SPDX-License-Identifier: BSD-3-Clause
// --speed: objects that move by themselves, for as long as a whole plan takes; and everywhere else no answer.
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace speed_test {

namespace {

using Json = nlohmann::json;

// The arm stays at hinge = 0, but for a hair. The ball's centre is 0.6 sin(60°) off the arm's axis, its surface that
// less 0.15 off the arm. At 0.1 m/s it comes there in ten times that.
const double kMeeting = 10 * (0.519615242270663 - 0.15);  // 3.696 s

class SpeedProgramTest : public ProgramTest {
 protected:
  /// Two pieces of the same length, the arm all but still.
  static std::string way(double duration) {
    return "t,hinge,rail\n0,0,0\n" + std::to_string(duration / 2) + ",0,0.1\n" + std::to_string(duration) +
           ",-1e-7,0.2\n";
  }
  Outcome check(const std::string& csv, const std::string& more) const {
    return run("check " + armAndBall() + " --trajectory " + write("way.csv", csv) + " " + more);
  }
  Outcome certify(const std::string& name, const std::string& content, const std::string& more) const {
    return run("certify " + write(name, content) + " " + armAndBall() + " " + more);
  }
  /// It ends with an error that names the option and says what to do.
  static void expectRefused(const Outcome& run, const std::string& cure) {
    EXPECT_EQ(run.status, 2) << run.out << run.err;
    EXPECT_NE((run.out + run.err).find("--speed"), std::string::npos) << run.out << run.err;
    EXPECT_NE((run.out + run.err).find(cure), std::string::npos) << run.out << run.err;
    EXPECT_EQ((run.out + run.err).find("FREE"), std::string::npos) << run.out << run.err;
  }
};

TEST_F(SpeedProgramTest, TheClockRunsThroughAllPieces) {
  // Each half of the second way by itself would be free.
  for (const char* speed : {"--speed ball=0.1", "--speed ball=0.1m/s"}) {
    EXPECT_EQ(check(way(3.6), speed).status, 0);
    const Outcome contact = check(way(4), std::string("--json ") + speed);
    ASSERT_EQ(contact.status, 1) << contact.err;
    const Json answer = Json::parse(contact.out);
    EXPECT_LE(answer.at("t_lower").get<double>(), kMeeting + 1e-6);
    EXPECT_GE(answer.at("t_lower").get<double>(), kMeeting - 1e-3);
    EXPECT_NE(answer.at("tolerances").get<std::string>().find("up to 0.1 m "), std::string::npos) << contact.out;
  }
  EXPECT_EQ(check(way(4), "").status, 0) << "nobody moves";
}

TEST_F(SpeedProgramTest, CertifiesPlansWithTimes) {
  EXPECT_EQ(certify("a.csv", way(3.6), "--speed ball=0.1").status, 0);
  EXPECT_EQ(certify("a.csv", way(4), "--speed ball=0.1").status, 1);
  // Times that begin later: the ball is at its place then.
  const std::string later = R"({"joints": ["hinge", "rail"], "times": [10, 12, 13.6], "waypoints": )";
  EXPECT_EQ(certify("b.json", later + "[[0, 0], [0, 0.1], [0, 0.2]]}", "--speed ball=0.1").status, 0);
  // What is written is certified again, with its times.
  EXPECT_EQ(certify("a.csv", way(3.6), "--speed ball=0.1 --out " + path("free.json")).status, 0);
  EXPECT_FALSE(read(path("free.json")).empty());
  const Outcome no_times = certify("a.csv", way(3.6), "--speed ball=0.1 --out " + path("free.path"));
  EXPECT_TRUE(read(path("free.path")).empty()) << no_times.out;
}

TEST_F(SpeedProgramTest, ANameStandsForAllShapes) {
  const std::string person = write("person.urdf", R"(<robot name="person"><link name="person">
  <collision><origin xyz="0.3 0.8 0"/><geometry><sphere radius="0.1"/></geometry></collision>
  <collision><origin xyz="0.3 0.519615242270663 0"/><geometry><sphere radius="0.1"/></geometry></collision>
</link></robot>)");
  const std::string ask = "check --robot " + arm() + " --scene " + person + " --trajectory ";
  EXPECT_EQ(run(ask + write("short.csv", way(3.6)) + " --speed person=0.1").status, 0);
  EXPECT_EQ(run(ask + write("long.csv", way(4)) + " --speed person=0.1").status, 1);
}

#ifdef FCL_ARTIC_VERIFY
TEST_F(SpeedProgramTest, CertificatesStateSpeedsWithTheTimesOfThePlan) {
  const auto verify = [&](const std::string& name, const std::string& more) {
    const std::string command = std::string("\"") + FCL_ARTIC_VERIFY + "\" " + more + " " + path(name + ".world") +
                                " " + path(name) + " >" + path("said") + " 2>&1";
    const int status = std::system(command.c_str());
    return Outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("said")), ""};
  };
  const auto plan = [&](const std::string& name, double duration) { return "--plan " + write(name, way(duration)); };
  ASSERT_EQ(check(way(3.6), "--speed ball=0.1 --certificate " + path("proof")).status, 0);
  ASSERT_EQ(certify("a.csv", way(3.6), "--speed ball=0.1 --certificate " + path("certified")).status, 0);
  for (const char* name : {"proof", "certified"}) {
    const Outcome same = verify(name, plan("same.csv", 3.6));
    EXPECT_EQ(same.status, 0) << same.out;
    EXPECT_NE(same.out.find("for every way of 'ball' at up to 0.1 m/s from 0 s on, in at most 3.6"), std::string::npos)
        << same.out;
    EXPECT_EQ(verify(name, plan("sooner.csv", 3.5)).status, 0) << "the ball gets less far";
    const Outcome later = verify(name, plan("later.csv", 3.601));
    EXPECT_EQ(later.status, 1) << "the ball gets farther";
    EXPECT_NE(later.out.find("bodies that move by themselves get farther"), std::string::npos) << later.out;
    const Outcome timeless = verify(name, "--plan " + write("none.csv", "hinge,rail\n0,0\n0,0.1\n-1e-7,0.2\n"));
    EXPECT_EQ(timeless.status, 1);
    EXPECT_NE(timeless.out.find("has no times"), std::string::npos) << timeless.out;
  }
  // Up to where the ball may be met, and no farther.
  ASSERT_EQ(check(way(4), "--speed ball=0.1 --certificate " + path("met")).status, 1);
  const Outcome met = verify("met", plan("met.csv", 4));
  EXPECT_EQ(met.status, 0) << met.out;
  EXPECT_NE(met.out.find("until t = "), std::string::npos) << met.out;
}
#endif

TEST_F(SpeedProgramTest, RefusesPlansWithoutAClock) {
  const std::string speed = "--speed ball=0.1 ";
  expectRefused(run("check " + armAndBall() + " --from 0,0 --to 0,0.1 " + speed), "--trajectory");
  const std::string lines = write("lines.jsonl", R"({"waypoints": [[0, 0], [0, 0.1]], "times": [0, 1]})");
  expectRefused(run("check " + armAndBall() + " --lines " + lines + " " + speed), "--trajectory");
  const Outcome no_times = check("hinge,rail\n0,0\n0,0.1\n", speed);
  EXPECT_EQ(no_times.status, 2);
  EXPECT_NE(no_times.err.find("give the plan times"), std::string::npos) << no_times.err;
  const Outcome plan = certify("a.path", "0 0\n0 0.1\n\n", speed);
  EXPECT_EQ(plan.status, 2) << plan.out;
  EXPECT_NE((plan.out + plan.err).find("give the plan times"), std::string::npos) << plan.out;
}

/// The parts of a message follow each other, and each is asked by itself: the second one would begin with the ball at
/// its place.
TEST_F(SpeedProgramTest, RefusesMessagesInParts) {
  const auto part = [](const char* from, const char* to) {
    return std::string(R"({"joint_trajectory": {"joint_names": ["rail", "hinge"], "points": [{"positions": [)") + from +
           R"(, 0], "time_from_start": {"sec": 0, "nanosec": 0}}, {"positions": [)" + to +
           R"(, 0], "time_from_start": {"sec": 2, "nanosec": 0}}]}})";
  };
  const std::string both =
                        R"({"model_id": "arm", "trajectory": [)" + part("0", "0.1") + ", " + part("0.1", "0.2") + "]}",
                    one = R"({"model_id": "arm", "trajectory": [)" + part("0", "0.1") + "]}";
  EXPECT_EQ(certify("both.json", both, "").status, 0);
  EXPECT_EQ(certify("one.json", one, "--speed ball=0.1").status, 0);
  const Outcome refused = certify("both.json", both, "--speed ball=0.1");
  EXPECT_EQ(refused.status, 2) << refused.out;
  EXPECT_NE((refused.out + refused.err).find("join the parts"), std::string::npos) << refused.out;
}

TEST_F(SpeedProgramTest, RefusesWhatSplitsPlans) {
  const std::string speed = " --speed ball=0.1 ", arm_ball = armAndBall();
  expectRefused(certify("a.csv", way(3.6), "--mend" + speed), "without --speed");
  expectRefused(run("bench robot " + arm() + " --scene " + ball() + speed), "check --trajectory");
  expectRefused(run("roadmap make " + arm_ball + speed + "--out " + path("map.csv")), "check --trajectory");
  expectRefused(run("certify --edges " + write("edges.h5", "none") + " " + arm_ball + speed + "--out " + path("edges")),
                "check --trajectory");
}

/// The page measures distances part by part: not where these depend on what was before.
TEST_F(SpeedProgramTest, NoPageShowsDistancesOfParts) {
  const std::string page = path("page.html");
  for (const bool moves : {false, true}) {
    EXPECT_EQ(check(way(3.6), "--html " + page + (moves ? " --speed ball=0.1" : "")).status, 0);
    EXPECT_EQ(read(page).find("obstacles move by themselves") != std::string::npos, moves);
  }
}

TEST_F(SpeedProgramTest, RefusesWhatIsNoSpeed) {
  for (const char* wrong :
       {"ball", "=1", "ball=-1", "ball=fast", "ball=1km/h", "ball=1deg", "ball=inf", "ball=1 --speed ball=2"}) {
    expectRefused(check(way(3.6), std::string("--speed ") + wrong), "");
  }
  const Outcome unknown = check(way(3.6), "--speed bal=0.1");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("'ball'"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace speed_test
