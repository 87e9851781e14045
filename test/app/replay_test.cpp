// SPDX-License-Identifier: BSD-3-Clause
// check --dump and --replay.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace replay_test {

namespace {

using Json = nlohmann::json;

class ReplayTest : public ProgramTest {
 protected:
  /// The answer without what differs from run to run, and without the notes of files.
  static Json answerOf(const Outcome& run) {
    Json answer = Json::parse(run.out);
    answer.erase("notes");
    forget(answer);
    return answer;
  }
  static void forget(Json& json) {
    if (!json.is_structured()) return;
    for (auto it = json.begin(); it != json.end();) {
      const bool time = json.is_object() &&
                        (it.key().rfind("us") == it.key().size() - 2 || it.key().find("_ms") != std::string::npos);
      if (time) {
        it = json.erase(it);
      } else {
        forget(*it++);
      }
    }
  }
  /// Asks with --dump, then with --replay, and expects the same answer.
  Json expectSame(const std::string& arguments, int status) {
    const std::string file = path("q.json");
    const Outcome asked = run("check " + arguments + " --json --dump " + file);
    EXPECT_EQ(asked.status, status) << asked.err;
    const Outcome again = run("check --json --replay " + file);
    EXPECT_EQ(again.status, status) << again.err;
    const Json answer = answerOf(asked);
    EXPECT_EQ(answer, answerOf(again));
    return answer;
  }
};

TEST_F(ReplayTest, AnswersAreTheSameToTheBit) {
  const Json contact = expectSame(armAndBall() + " --from 0,0 --to 1.5,0 --every-pair --margin 0.001", 1);
  EXPECT_EQ(contact.at("contacts").size(), 1u);
  EXPECT_GT(contact.at("t_lower").get<double>(), 0.1);
  (void)expectSame(armAndBall() + " --from 0,0 --to 0.1,0.5", 0);
  (void)expectSame(armAndBall() + " --from 0,0 --to 1.5,0 --method redon2004 --budget 3", 3);
  const std::string plan = write("plan.csv", "time,hinge,rail\n0,0,0\n2,0.1,0\n3,1.2,0.5\n");
  const Json trajectory = expectSame(armAndBall() + " --trajectory " + plan, 1);
  EXPECT_GT(trajectory.at("t_lower").get<double>(), 2);
}

TEST_F(ReplayTest, ReadsAloudWhatItReplays) {
  const std::string file = path("q.json");
  ASSERT_EQ(run("check " + armAndBall() + " --from 0,0 --to 1.5,0 --dump " + file).status, 1);
  const Outcome text = run("check --replay " + file);
  EXPECT_EQ(text.status, 1);
  EXPECT_NE(text.out.find("arm"), std::string::npos);
  EXPECT_EQ(text.out.find("bits may differ"), std::string::npos);
  Json query = Json::parse(read(file));
  query["library"] = "0.9.0";
  const Outcome older = run("check --json --replay " + write("older.json", query.dump()));
  EXPECT_NE(older.out.find("written by fcl_artic 0.9.0"), std::string::npos) << older.out;
}

TEST_F(ReplayTest, WithoutADumpTheAnswerIsPrintedAllTheSame) {
  const Outcome unwritten =
      run("check " + armAndBall() + " --from 0,0 --to 1.5,0 --dump " + path("nowhere") + "/q.json");
  EXPECT_EQ(unwritten.status, 2);
  EXPECT_EQ(unwritten.out.rfind("CONTACT", 0), 0u) << unwritten.out;
  EXPECT_NE(unwritten.err.find("nowhere/q.json"), std::string::npos) << unwritten.err;
}

TEST_F(ReplayTest, WhatIsNoQueryIsRefusedWithItsFile) {
  for (const std::string content : {"", "{}", "[1]", "{\"fcl_artic_query\": 1}"}) {
    const std::string file = write("bad.json", content);
    const Outcome refused = run("check --replay " + file);
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("'" + file + "': query: "), std::string::npos) << refused.err;
  }
  EXPECT_NE(run("check --replay nowhere.json").err.find("'nowhere.json': no such file"), std::string::npos);
}

TEST_F(ReplayTest, OtherOptionsDoNotGoWithAReplay) {
  const std::string file = write("q.json", "{}");
  for (const std::string& other : {"--robot " + arm(), std::string("--from 0,0"), std::string("--margin 1"),
                                   std::string("--no-self"), std::string("--dump other.json"), arm()}) {
    const Outcome refused = run("check --replay " + file + " " + other);
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("--replay excludes"), std::string::npos) << refused.err;
  }
  EXPECT_NE(run("check --from 0 --to 1").err.find("--robot is required"), std::string::npos);
}

}  // namespace

}  // namespace replay_test
