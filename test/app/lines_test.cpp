// SPDX-License-Identifier: BSD-3-Clause
// `check --lines`: a question a line, an answer a line.
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace lines_test {

namespace {

using Json = nlohmann::json;

class LinesTest : public ProgramTest {
 protected:
  struct Answers {
    int status = -1;
    std::vector<Json> lines;
    std::string err;
  };
  Answers ask(const std::string& questions, const std::string& options = "") const {
    const Outcome run = this->run("check " + armAndBall() + " --lines " + write("q.jsonl", questions) + " " + options);
    Answers answers{run.status, {}, run.err};
    std::istringstream all(run.out);
    for (std::string line; std::getline(all, line);) answers.lines.push_back(Json::parse(line));
    return answers;
  }
};

TEST_F(LinesTest, AnswersComeInOrder) {
  const Answers a =
      ask("{\"id\": \"one\", \"from\": [0, 0], \"to\": [\"40deg\", 0]}\n\n"
          "{\"start\": {\"hinge\": 0, \"rail\": 0}, \"goal\": {\"hinge\": \"90deg\", \"rail\": 0}, \"id\": [2]}\n"
          "{\"waypoints\": [[0, 0], [0.5, 0], {\"hinge\": 1.5707963267948966, \"rail\": 0}]}\n"
          "{\"waypoints\": [[0, 0], [\"90deg\", 0]], \"times\": [10, 20]}");
  EXPECT_EQ(a.status, 1) << a.err;
  ASSERT_EQ(a.lines.size(), 4u);
  EXPECT_EQ(a.lines[0].at("line"), 1);
  EXPECT_EQ(a.lines[0].at("id"), "one");
  EXPECT_EQ(a.lines[0].at("status"), "free");
  EXPECT_TRUE(a.lines[0].at("contacts").empty());
  EXPECT_EQ(a.lines[1].at("line"), 3);
  EXPECT_EQ(a.lines[1].at("id"), Json({2}));
  EXPECT_EQ(a.lines[1].at("status"), "contact");
  // As the program's tests work out: the arm touches the ball at this part of the way.
  const double contact = (M_PI / 3 - std::asin(0.15 / 0.6)) / (M_PI / 2);
  EXPECT_NEAR(a.lines[1].at("t_lower").get<double>(), contact, 2e-6);
  EXPECT_EQ(a.lines[1].at("contacts").at(0).at("body2").at("name"), "ball");
  EXPECT_NEAR(a.lines[1].at("q_at_t_lower").at("hinge").get<double>(), contact * M_PI / 2, 1e-5);
  EXPECT_FALSE(a.lines[2].contains("id"));
  const double second = (contact * M_PI / 2 - 0.5) / (M_PI / 2 - 0.5);
  EXPECT_NEAR(a.lines[2].at("t_lower").get<double>(), 1 + second, 1e-5);
  EXPECT_NEAR(a.lines[3].at("t_lower").get<double>(), 10 + 10 * contact, 1e-4);
}

TEST_F(LinesTest, NotesAndWhatWasNotCheckedAreSaid) {
  const std::string free = "{\"from\": [0, 0], \"to\": [0.1, 0]}\n";
  const Answers nothing = ask(free, "--no-self --no-scene");
  EXPECT_EQ(nothing.status, 3);
  EXPECT_EQ(nothing.lines.at(0).at("nothing_checked"), true);
  EXPECT_EQ(ask(free).lines.at(0).at("nothing_checked"), false);
  const Answers beyond = ask("{\"waypoints\": [[0, 0], [2.5, 0]]}\n");
  EXPECT_NE(beyond.lines.at(0).at("notes").dump().find("waypoint 1 is beyond its limits"), std::string::npos)
      << beyond.lines[0];
  // Notes of robot and scene: here that the scene's joint stands at 0.
  const std::string scene =
      write("door.urdf",
            "<robot name='d'><link name='d'/><link name='e'><collision><origin xyz='9 9 9'/><geometry>"
            "<sphere radius='0.1'/></geometry></collision></link><joint name='j' type='continuous'>"
            "<parent link='d'/><child link='e'/></joint></robot>");
  EXPECT_NE(ask(free, "--scene " + scene).err.find("its joints stand at 0"), std::string::npos);
}

TEST_F(LinesTest, KeysAreThereOnceAndNestingEnds) {
  const Answers a = ask("{\"from\": [0, 0], \"to\": [0, 0], \"to\": [1, 0]}\n" + std::string(200000, '[') + "\n");
  EXPECT_EQ(a.status, 2);
  ASSERT_EQ(a.lines.size(), 2u);
  EXPECT_NE(a.lines[0].at("error").get<std::string>().find("the key 'to' is there twice"), std::string::npos);
  EXPECT_NE(a.lines[1].at("error").get<std::string>().find("nested more than"), std::string::npos);
}

TEST_F(LinesTest, TheStatusIsThatOfTheWorst) {
  const std::string free = "{\"from\": [0, 0], \"to\": [0.1, 0]}\n", hit = "{\"from\": [0, 0], \"to\": [1.5, 0]}\n";
  EXPECT_EQ(ask(free).status, 0);
  EXPECT_EQ(ask(free + hit + free).status, 1);
  EXPECT_EQ(ask(hit, "--budget 1").status, 3);
  EXPECT_EQ(ask(free + "nonsense\n" + hit).status, 2);
}

// A line that is wrong does not take the others with it.
TEST_F(LinesTest, ErrorsNameTheLine) {
  const struct {
    const char *line, *named;
  } cases[] = {
      {"nonsense", "is no JSON"},
      {"[1, 2]", "is no JSON object"},
      {"{\"from\": [0, 0]}", "has neither 'to' nor 'goal'"},
      {"{\"from\": [0, 0], \"to\": [0, 0], \"goal\": [0, 0]}", "has both 'to' and 'goal'"},
      {"{\"from\": [0, 0], \"to\": [0, 0], \"margn\": 1}", "has 'margn', which is not read"},
      {"{\"from\": [0, 0, 0], \"to\": [0, 0]}", "from has 3 values, robot 'arm' has 2 joints: hinge, rail"},
      {"{\"from\": [0, 0], \"to\": {\"hing\": 1}}", "did you mean 'hinge'?"},
      {"{\"from\": [0, 0], \"to\": [0, null]}", "null is neither a number nor"},
      {"{\"from\": [0, 0], \"to\": [0, \"1deg\"]}", "'rail'"},
      {"{\"from\": [0, 0], \"to\": 3}", "3 is neither a list"},
      {"{\"waypoints\": [[0, 0]]}", "two or more"},
      {"{\"waypoints\": [[0, 0], [0, 0]], \"times\": [0]}", "2 numbers are needed"},
      {"{\"waypoints\": [[0, 0], [0, 0]], \"times\": [1, 0]}", "line 2: "},
      {"{\"waypoints\": [[0, 0], [0, 0]], \"from\": [0, 0]}", "both 'waypoints' and 'from'"},
      {"{\"from\": [0, 0], \"to\": [0, 0], \"times\": [0, 1]}", "no waypoints"},
      {"{\"from\": [1e999, 0], \"to\": [0, 0]}", "line 2: "},
      {"{\"id\": \"\xff\"}", "is no JSON"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.line);
    const std::string good = "{\"from\": [0, 0], \"to\": [0.1, 0]}\n";
    const Answers a = ask(good + c.line + "\n" + good);
    EXPECT_EQ(a.status, 2);
    ASSERT_EQ(a.lines.size(), 3u);
    EXPECT_EQ(a.lines[1].at("line"), 2);
    EXPECT_EQ(a.lines[1].at("status"), "error");
    const std::string error = a.lines[1].at("error");
    EXPECT_EQ(error.rfind("line 2: ", 0), 0u) << error;
    EXPECT_NE(error.find(c.named), std::string::npos) << error;
    EXPECT_EQ(a.lines[2].at("status"), "free");
  }
}

TEST_F(LinesTest, StandardInputIsADash) {
  const std::string file = write("q.jsonl", "{\"from\": [0, 0], \"to\": [0.1, 0]}\n");
  const Outcome run = this->run("check " + armAndBall() + " --lines - <" + file);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out).at("status"), "free");
}

TEST_F(LinesTest, NothingAskedIsAnError) {
  const Answers none = ask("\n \n");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("has no line to answer"), std::string::npos) << none.err;
  const std::string trajectory = "--trajectory " + write("x.csv", "time,hinge\n0,0\n1,1\n");
  for (const std::string& other : {std::string("--from 0,0"), std::string("--image x.png"),
                                   std::string("--html x.html"), std::string("--clearance"), trajectory}) {
    const Answers both = ask("{}", other);
    EXPECT_EQ(both.status, 2);
    EXPECT_NE(both.err.find("--lines"), std::string::npos) << both.err;
  }
  EXPECT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 1,0 --interpolation cubic").status, 2);
}

}  // namespace

}  // namespace lines_test
