// SPDX-License-Identifier: BSD-3-Clause
// The built program, run on small inputs: exit statuses, what it prints, what it refuses.
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace program_test {

namespace {

using Json = nlohmann::json;

// The arm's upper face is 0.05 m from its axis, the ball's centre 0.6 m from the hinge at 60°: they touch at an angle
// a with 0.6 sin(60° - a) = 0.05 + 0.1.
const double kContactAngle = M_PI / 3 - std::asin(0.15 / 0.6);

TEST_F(ProgramTest, FreeIsZero) {
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 40deg,0");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.rfind("FREE: proven", 0), 0u) << run.out;
}

TEST_F(ProgramTest, ContactIsOneAndTellsWhatAndWhere) {
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0");
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_EQ(run.out.rfind("CONTACT: first contact at t = 0.5058", 0), 0u) << run.out;
  for (const char* part : {"link 'arm'", "obstacle 'ball'", "proven", "hinge = 0.7945", "point", "normal", "pairs"}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part << " in\n" << run.out;
  }
}

TEST_F(ProgramTest, ThePapersMethodIsAskedForByName) {
  const Outcome run = this->run("check --json --method redon2004 " + armAndBall() + " --from 0,0 --to 90deg,0");
  ASSERT_EQ(run.status, 1) << run.err;
  const Json answer = Json::parse(run.out);
  EXPECT_NEAR(answer.at("t_lower").get<double>(), kContactAngle / (M_PI / 2), 2e-6);
  EXPECT_EQ(answer.at("statistics").at("redon2004").at("pairs_by_standard"),
            2);  // of two links: a ball has no triangles
  EXPECT_EQ(this->run("check --method redon2003 " + armAndBall() + " --from 0,0 --to 90deg,0").status, 2);
}

TEST_F(ProgramTest, JsonHasItsKeysAndAllDigits) {
  const Outcome run = this->run("check --json " + armAndBall() + " --state rail=0 --from hinge=0 --to hinge=90deg");
  ASSERT_EQ(run.status, 1) << run.err;
  const Json answer = Json::parse(run.out);
  EXPECT_EQ(answer.at("status"), "contact");
  EXPECT_EQ(answer.at("certain"), true);
  const double wanted = kContactAngle / (M_PI / 2);
  const double t_lower = answer.at("t_lower"), t_upper = answer.at("t_upper");
  EXPECT_LE(t_lower, wanted);
  EXPECT_GE(t_upper, wanted);
  EXPECT_LE(t_upper - t_lower, 2e-6);
  EXPECT_EQ(answer.at("q_at_t_lower").at("hinge"), t_lower * (90 * (M_PI / 180)));

  const Json& contact = answer.at("contacts").at(0);
  EXPECT_EQ(answer.at("contacts").size(), 1u);
  EXPECT_EQ(contact.at("body1").at("name"), "arm");
  EXPECT_EQ(contact.at("body1").at("kind"), "link");
  EXPECT_EQ(contact.at("body2").at("name"), "ball");
  EXPECT_EQ(contact.at("body2").at("kind"), "obstacle");
  EXPECT_TRUE(contact.at("body1").at("triangle").is_null());
  EXPECT_EQ(contact.at("feature"), "volume");
  // The normal is the arm's, turned; the point lies on the ball towards the arm.
  const double normal[3] = {-std::sin(kContactAngle), std::cos(kContactAngle), 0};
  const double center[3] = {0.3, 0.519615242270663, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(contact.at("normal").at(i), normal[i], 1e-2);  // shapes overlap by no more than the time's tolerance
    EXPECT_NEAR(contact.at("point").at(i), center[i] - 0.1 * normal[i], 1e-3);
  }
  EXPECT_EQ(answer.at("poses").size(), 3u);
  const Json& pose = answer.at("poses").at("arm");
  EXPECT_NEAR(pose.at("quaternion_xyzw").at(2), std::sin(kContactAngle / 2), 2e-6);
  EXPECT_EQ(pose.at("position").size(), 3u);
  EXPECT_GE(answer.at("statistics").at("pairs"), 1);
  for (const char* key : {"robot", "q_from", "q_to", "ignored_initial_contacts", "request", "notes"}) {
    EXPECT_TRUE(answer.contains(key)) << key;
  }
}

TEST_F(ProgramTest, MarginComesEarlier) {
  const Outcome run = this->run("check --json " + armAndBall() + " --from 0,0 --to 90deg,0 --margin 0.05");
  ASSERT_EQ(run.status, 1) << run.err;
  const double wanted = (M_PI / 3 - std::asin(0.2 / 0.6)) / (M_PI / 2);
  const Json answer = Json::parse(run.out);
  EXPECT_LE(answer.at("t_lower"), wanted);
  EXPECT_NEAR(answer.at("t_lower"), wanted, 2e-5);
}

// At 40 degrees the ball's centre is 0.6 sin(20 deg) - 0.05 from the arm's face.
TEST_F(ProgramTest, ClearanceOfAFreeMotion) {
  const Outcome run = this->run("check --json --clearance " + armAndBall() + " --from 0,0 --to 40deg,0");
  ASSERT_EQ(run.status, 0) << run.err;
  const Json clearance = Json::parse(run.out).at("clearance");
  const double wanted = 0.6 * std::sin(M_PI / 9) - 0.05 - 0.1;
  EXPECT_LE(clearance.at("lower"), wanted + 1e-9);
  EXPECT_GE(clearance.at("upper"), wanted - 1e-9);
  EXPECT_LE(clearance.at("upper").get<double>() - clearance.at("lower").get<double>(), 1e-3);
  EXPECT_NEAR(clearance.at("t"), 1, 2e-2);
  EXPECT_EQ(clearance.at("body2").at("name"), "ball");
  EXPECT_EQ(clearance.at("within_tolerance"), true);

  const Outcome far =
      this->run("check --json --clearance --clearance-most 0.01 " + armAndBall() + " --from 0,0 --to 40deg,0");
  EXPECT_EQ(Json::parse(far.out).at("clearance").at("lower"), 0.01);
  EXPECT_TRUE(Json::parse(far.out).at("clearance").at("upper").is_null());
  const Outcome text = this->run("check --clearance " + armAndBall() + " --from 0,0 --to 90deg,0");
  EXPECT_EQ(text.status, 1);
  EXPECT_NE(text.out.find("clearance none; link 'arm' and obstacle 'ball'"), std::string::npos) << text.out;
  EXPECT_EQ(this->run("check --clearance-most 1 " + armAndBall() + " --from 0,0 --to 90deg,0").status, 2);
}

// The arm turns to 40 degrees; at 60 degrees less the ball's half width it touches.
TEST_F(ProgramTest, ToleranceLeftOfAFreeMotion) {
  const std::string motion = " --from 0,0 --to 40deg,0 --clearance ";
  EXPECT_TRUE(Json::parse(this->run("check --json" + motion + armAndBall()).out).at("tolerance_left").is_null());
  const std::string check = "check" + motion + armAndBall() + " --joint-tolerance 0.5deg ";
  const Json left = Json::parse(this->run(check + "--json").out).at("tolerance_left");
  const double touches = (M_PI / 3 - std::asin(0.15 / 0.6)) - 40 * M_PI / 180, tolerance = 0.5 * M_PI / 180;
  EXPECT_GT(left.at("lower"), 1);
  EXPECT_LE(left.at("lower"), touches / tolerance * (1 + 1e-9));
  EXPECT_LE(left.at("upper"), touches / tolerance * 1.02);
  EXPECT_EQ(left.at("within_accuracy"), true);
  EXPECT_EQ(left.at("body1").at("name"), "arm");
  EXPECT_EQ(left.at("body2").at("name"), "ball");
  EXPECT_EQ(left.at("q_witness").is_null(), !left.at("certain").get<bool>());
  const std::string text = this->run(check).out;
  EXPECT_NE(text.find("left      tolerances times"), std::string::npos) << text;
  EXPECT_NE(text.find("are still free; limited by link 'arm' and obstacle 'ball' at t"), std::string::npos) << text;
  const std::string hit =
      this->run("check --clearance " + armAndBall() + " --from 0,0 --to 90deg,0 --joint-tolerance 1mm").out;
  EXPECT_NE(hit.find("left      none: link 'arm' and obstacle 'ball' touch"), std::string::npos) << hit;
}

TEST_F(ProgramTest, ExhaustedBudgetIsThree) {
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0 --budget 1");
  EXPECT_EQ(run.status, 3) << run.out << run.err;
  EXPECT_EQ(run.out.rfind("UNDECIDED", 0), 0u) << run.out;
}

TEST_F(ProgramTest, NoSceneLeavesTheBallOut) {
  EXPECT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0 --no-scene").status, 0);
}

TEST_F(ProgramTest, EveryPairReportsEachPair) {
  const std::string second = write("second.urdf", R"(<robot name="second"><link name="ball"><collision>
    <origin xyz="0.3 0.7 0"/><geometry><sphere radius="0.1"/></geometry></collision></link></robot>)");
  const Outcome run =
      this->run("check --json --every-pair " + armAndBall() + " --scene " + second + " --from 0,0 --to 90deg,0");
  ASSERT_EQ(run.status, 1) << run.err;
  const Json answer = Json::parse(run.out);
  ASSERT_EQ(answer.at("contacts").size(), 2u);
  // Two obstacles of one name: the second one gets a number, and a note says so.
  EXPECT_EQ(answer.at("contacts").at(0).at("body2").at("name"), "ball");
  EXPECT_EQ(answer.at("contacts").at(1).at("body2").at("name"), "ball#2");
  EXPECT_NE(answer.at("notes").dump().find("ball#2"), std::string::npos);
}

TEST_F(ProgramTest, InitialContactMayBeIgnored) {
  const std::string motion = " --from " + std::to_string(kContactAngle + 0.01) + ",0 --to 0,0";
  const Outcome strict = this->run("check --json " + armAndBall() + motion);
  EXPECT_EQ(strict.status, 1);
  EXPECT_EQ(Json::parse(strict.out).at("t_lower"), 0.0);
  const Outcome lenient = this->run("check --json --ignore-initial-contact " + armAndBall() + motion);
  EXPECT_EQ(lenient.status, 0) << lenient.out;
  const Json ignored = Json::parse(lenient.out).at("ignored_initial_contacts");
  ASSERT_EQ(ignored.size(), 1u);
  EXPECT_EQ((std::set<std::string>{ignored[0].at(0), ignored[0].at(1)}), (std::set<std::string>{"arm", "ball"}));
}

TEST_F(ProgramTest, NoShortAnswerLeavesOutWhatFreeDoesNotSpeakOf) {
  // The arm begins in the ball: once it goes deeper and never comes apart, once it leaves.
  const double in = kContactAngle + 0.01;
  const std::string deeper = std::to_string(in + 0.01), begin = std::to_string(in);
  const std::string arguments = armAndBall() + " --ignore-initial-contact ";
  const std::string questions = write("q.jsonl", "{\"from\": [" + begin + ", 0], \"to\": [" + deeper +
                                                     ", 0]}\n{\"from\": [" + begin + ", 0], \"to\": [0, 0]}\n");
  std::istringstream lines(this->run("check " + arguments + "--lines " + questions).out);
  const std::string plans = write("p.jsonl", "{\"waypoints\": [[" + begin + ", 0], [" + deeper +
                                                 ", 0]]}\n{\"waypoints\": [[" + begin + ", 0], [0, 0]]}\n");
  const Outcome certified = this->run("certify " + plans + " " + arguments + "--json --csv " + path("p.csv"));
  ASSERT_EQ(certified.status, 0) << certified.err;
  std::istringstream rows(read(path("p.csv")));
  std::string line, row;
  std::getline(rows, row);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(std::getline(lines, line) && std::getline(rows, row));
    for (const Json& answer : {Json::parse(line), Json::parse(certified.out).at("plans").at(i)}) {
      EXPECT_EQ(answer.at("status"), "free");
      EXPECT_EQ(answer.at("never_apart_pairs"), i == 0 ? 1 : 0) << answer;
      EXPECT_EQ(answer.at("ignored_initial_contacts").size(), 1u) << answer;
      EXPECT_EQ(answer.at("unproven_allowed_pairs"), 0) << answer;
    }
    EXPECT_NE(row.find(i == 0 ? ",1,1,0,,\"\"" : ",1,0,0,,\"\""), std::string::npos) << row;
  }
}

TEST_F(ProgramTest, LimitsAreNoted) {
  const Outcome run = this->run("check --robot " + arm() + " --from 0,0 --to 0,1.5");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("--to: "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("'rail'"), std::string::npos) << run.out;
}

TEST_F(ProgramTest, GeneratedPairsAreWrittenAndReadBack) {
  // Two links on one base that always overlap.
  const std::string robot = write("twins.urdf", R"(<robot name="twins">
  <link name="base"/>
  <link name="a"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <link name="b"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <joint name="ja" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="jb" type="revolute"><parent link="base"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>)");
  const std::string far = write("far.scene", "s\n* far\n1\nsphere\n0.1\n9 9 9\n0 0 0 1\n0 0 0 0\n.\n");
  const std::string motion = " --robot " + robot + " --scene " + far + " --from 0,0 --to 0.5,0 ";
  EXPECT_EQ(this->run("check" + motion).status, 1);
  const Outcome automatic = this->run("check" + motion + "--auto-srdf " + path("twins.srdf"));
  EXPECT_EQ(automatic.status, 0) << automatic.out << automatic.err;
  EXPECT_NE(read(path("twins.srdf")).find("disable_collisions"), std::string::npos);
  EXPECT_EQ(this->run("check" + motion + "--srdf " + path("twins.srdf")).status, 0);
  EXPECT_EQ(this->run("check" + motion + "--no-self").status, 0);
}

// The arm stands within a box of 8 m: free of its surface, in contact at once where meshes are solids.
TEST_F(ProgramTest, SolidMeshes) {
  const std::string corners = "v -4 -4 -4\nv 4 -4 -4\nv 4 4 -4\nv -4 4 -4\nv -4 -4 4\nv 4 -4 4\nv 4 4 4\nv -4 4 4\n";
  const std::string sides = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\n";
  const std::string closed = write("closed.obj", corners + sides + "f 4 1 5 8\n"),
                    open = write("open.obj", corners + sides);
  const std::string motion = " --from 0,0 --to 10deg,0 ", check = "check --json --robot " + arm() + motion + "--scene ";
  EXPECT_EQ(this->run(check + closed).status, 0);
  const Outcome inside = this->run(check + closed + " --solid-meshes");
  ASSERT_EQ(inside.status, 1) << inside.err;
  const Json answer = Json::parse(inside.out);
  EXPECT_EQ(answer.at("t_lower"), 0);
  EXPECT_EQ(answer.at("t_upper"), 0);
  EXPECT_EQ(answer.at("certain"), true);
  EXPECT_EQ(answer.at("contacts").at(0).at("body2").at("name"), "closed");
  EXPECT_EQ(this->run(check + closed + " --solid-meshes --ignore-initial-contact").status, 0);
  EXPECT_EQ(this->run(check + open).status, 0);
  const Outcome refused = this->run(check + open + " --solid-meshes");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("open.obj"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("not closed: 4 edges"), std::string::npos) << refused.err;
  // One of them only.
  const std::string both = check + open + " --scene " + closed;
  EXPECT_EQ(this->run(both).status, 0);
  EXPECT_EQ(this->run(both + " --solid closed").status, 1);
  const Outcome open_one = this->run(both + " --solid open");
  EXPECT_EQ(open_one.status, 2);
  EXPECT_NE(open_one.err.find("--solid open: "), std::string::npos) << open_one.err;
  for (const char* name : {"arm", "nobody"}) {  // a box; none
    const Outcome none = this->run(both + " --solid " + name);
    EXPECT_EQ(none.status, 2);
    EXPECT_NE(none.err.find(std::string("--solid ") + name + ": no link or obstacle of that name has a mesh"),
              std::string::npos)
        << none.err;
  }
}

TEST_F(ProgramTest, PackagesAreFoundWhereTheyAreNamed) {
  const std::string robot = write("meshed.urdf", R"(<robot name="meshed"><link name="base"><collision><geometry>
    <mesh filename="package://parts/tetra.obj"/></geometry></collision></link></robot>)");
  write("elsewhere/tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string query = "check --robot " + robot + " --from '' --to ''";
  const Outcome lost = this->run(query);
  EXPECT_EQ(lost.status, 2);
  EXPECT_NE(lost.err.find("parts"), std::string::npos) << lost.err;
  const Outcome found = this->run(query + " --package parts=" + path("elsewhere"));
  EXPECT_EQ(found.status, 3) << "one link, and nothing else: " << found.err;
}

TEST_F(ProgramTest, ScenesInMillimetresAreNotedAndScaled) {
  const std::string scene = write("ball.urdf", R"(<robot name="ball">
  <link name="ball"><collision><origin xyz="300 519.615242270663 0"/><geometry><sphere radius="100"/></geometry></collision></link>
</robot>)");
  const std::string query = "check --robot " + arm() + " --scene " + scene + " --from 0,0 --to 90deg,0";
  const Outcome metres = this->run(query);
  EXPECT_EQ(metres.status, 0);
  std::string text = metres.out;
  for (std::size_t at; (at = text.find("\n            ")) != std::string::npos;) text.replace(at, 13, " ");
  EXPECT_NE(text.find("no obstacle can be reached: 'ball'"), std::string::npos) << text;
  EXPECT_NE(text.find("is the scene in millimetres?"), std::string::npos) << text;
  const Outcome scaled = this->run(query + " --scale 0.001");
  EXPECT_EQ(scaled.status, 1) << scaled.out;
  EXPECT_EQ(scaled.out.find("millimetres"), std::string::npos) << scaled.out;
}

TEST_F(ProgramTest, NothingCheckedIsSaid) {
  const std::string query = "check " + armAndBall() + " --from 0,0 --to 1,0 --no-self --no-scene";
  const Outcome run = this->run(query);
  EXPECT_EQ(run.status, 3) << "nothing is known";
  EXPECT_EQ(run.out.rfind("NOTHING CHECKED", 0), 0u) << run.out;
  EXPECT_EQ(run.out.find("FREE"), std::string::npos) << run.out;
  EXPECT_EQ(Json::parse(this->run(query + " --json").out).at("nothing_checked"), true);
  EXPECT_EQ(Json::parse(this->run("check --json " + armAndBall() + " --from 0,0 --to 0,0").out).at("nothing_checked"),
            false);
}

TEST_F(ProgramTest, WhatIsNotAskedAboutIsSaid) {
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 0.1,0 --no-self");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("links with links are not checked (--no-self)"), std::string::npos) << run.out;
  EXPECT_EQ(this->run("check " + armAndBall() + " --from 0,0 --to 0.1,0").out.find("scope"), std::string::npos);
}

/// An arm that turns through the post of its own base: the two are neighbours.
TEST_F(ProgramTest, NeighboursAreChecked) {
  const auto robot = [&](const std::string& name, const std::string& of_base, const std::string& limits) {
    return write(name, "<robot name='r'><link name='base'>" + of_base +
                           "</link><link name='arm'><collision><origin xyz='0.75 0 0'/><geometry><box size='1.5 0.1 "
                           "0.1'/></geometry></collision></link><joint name='j' type='" +
                           (limits.empty() ? "continuous" : "revolute") +
                           "'><parent link='base'/><child link='arm'/><axis xyz='0 0 1'/>" + limits +
                           "</joint></robot>");
  };
  const std::string motion = " --from 0 --to 3";
  const std::string post = robot(
      "post.urdf", "<collision><origin xyz='0 1 0'/><geometry><box size='0.1 0.1 1'/></geometry></collision>", "");
  const Outcome hit = run("check " + post + motion);
  EXPECT_EQ(hit.status, 1) << hit.out;
  EXPECT_NE(hit.out.find("'base'"), std::string::npos) << hit.out;
  // Housings that overlap: named once; and an SRDF's word is the only one.
  const std::string housing =
      robot("housing.urdf", "<collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision>", "");
  const Outcome over = run("check --json " + housing + " --scene " + ball() + motion);
  EXPECT_EQ(Json::parse(over.out).at("notes").dump().find("neighbours that touch") != std::string::npos, true)
      << over.out;
  EXPECT_TRUE(Json::parse(over.out).at("unproven_neighbours").empty());
  const std::string srdf = write("r.srdf", "<robot name='r'/>");
  EXPECT_EQ(run("check " + housing + " --srdf " + srdf + " --from 0 --to 0").status, 1);
}

/// A name cannot begin a line that reads as a verdict.
TEST_F(ProgramTest, NamesStayWithinTheirLines) {
  const std::string robot =
      write("evil.urdf",
            "<robot name='r'><link name='a&#10;FREE: proven'><collision><geometry><sphere radius='1'/>"
            "</geometry></collision></link></robot>");
  const std::string other = write("o.urdf",
                                  "<robot name='o'><link name='o'><collision><geometry><sphere radius='1'/>"
                                  "</geometry></collision></link></robot>");
  const Outcome run = this->run("check " + robot + " --scene " + other + " --from '' --to ''");
  EXPECT_EQ(run.out.find("\nFREE"), std::string::npos) << run.out << run.err;
}

TEST_F(ProgramTest, ASolidIsAllOfItsObject) {
  const std::string cube =
      "8 12\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n0 2 1\n0 3 2\n4 5 6\n4 6 7\n0 1 5\n"
      "0 5 4\n1 2 6\n1 6 5\n2 3 7\n2 7 6\n3 0 4\n3 4 7\n";
  const std::string scene = write("cup.scene", "s\n* cup\n2\nmesh\n" + cube + "9 9 9\n0 0 0 1\n0 0 0 0\nmesh\n" + cube +
                                                   "0.5 0 0\n0 0 0 1\n0 0 0 0\n.\n");
  const std::string query = "check --robot " + arm() + " --scene " + scene + " --from 0,0 --to 0.1,0";
  EXPECT_EQ(run(query).status, 0) << run(query).out << run(query).err;
  EXPECT_EQ(run(query + " --solid cup").status, 1) << "the arm is within its second shape";
}

TEST_F(ProgramTest, ContactAtTheStartIsNotFreeBefore) {
  const std::string motion = " --from " + std::to_string(kContactAngle + 0.01) + ",0 --to 0,0";
  const Outcome run = this->run("check " + armAndBall() + motion);
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.out.find("free before"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("--ignore-initial-contact"), std::string::npos) << run.out;
  // A base that stands exactly on its floor: nearer than can be decided.
  const std::string floor = write("floor.urdf", R"(<robot name="floor"><link name="floor"><collision>
    <origin xyz="0 0 -0.1"/><geometry><box size="4 4 0.1"/></geometry></collision></link></robot>)");
  const Outcome stands = this->run("check --robot " + arm() + " --scene " + floor + " --from 0,0 --to 1,0");
  EXPECT_EQ(stands.status, 1);
  EXPECT_EQ(stands.out.find("free before"), std::string::npos) << stands.out;
  EXPECT_NE(stands.out.find("--ignore-initial-contact"), std::string::npos) << stands.out;
}

TEST_F(ProgramTest, ErrorsHaveOneStyleAndTellWhatWasMeant) {
  const std::string motion = " --from 0,0 --to 1,0", query = "check " + armAndBall() + motion;
  const std::string robot = arm();
  const struct {
    std::string arguments, said;
  } cases[] = {
      {"chek", "'chek' is neither a verb nor an option of fcl_artic; did you mean 'check'?"},
      {"bench robto", "'robto' is neither a verb nor an option of 'bench'; did you mean 'robot'?"},
      {"check --rboot " + robot + motion, "'--rboot' is no option of 'check'; did you mean '--robot'?"},
      {query + " --every-pairs=1", "'--every-pairs' is no option of 'check'; did you mean '--every-pair'?"},
      {query + " --zzzzzz", "'--zzzzzz' is no option of 'check'\n"},
      {"check more " + armAndBall() + motion, "--robot: 'more': no such file\n"},
      {"check --robot " + robot.substr(0, robot.size() - 5) + ".udrf" + motion, "did you mean '" + robot + "'?"},
      {query + " --margin 5cm", "--margin: '5cm' is not a number of at least 0, without a unit\n"},
      {query + " --scale 0", "--scale: '0' is not a number above 0, without a unit\n"},
      {query + " --image a.jpg", "--image: 'a.jpg': pictures are written as PNG; call it 'a.png'\n"},
      {"check --robot " + robot + " --from 0,0", "--to is required\n"},
  };
  for (const auto& c : cases) {
    const Outcome run = this->run(c.arguments);
    EXPECT_EQ(run.status, 2) << c.arguments;
    EXPECT_EQ(run.err.rfind("fcl_artic: error: ", 0), 0u) << run.err;
    EXPECT_NE(run.err.find(c.said), std::string::npos) << run.err;
    EXPECT_LT(run.err.size(), 300u) << run.err;
  }
}

/// Each refusal exits with 2, prints nothing but an error, and the error names what is wrong.
TEST_F(ProgramTest, ErrorsAreTwoAndNameTheThing) {
  const std::string robot = "--robot " + arm(), motion = " --from 0,0 --to 1,0";
  const std::string broken = write("broken.urdf", "<robot name=\"x\"><link");
  const std::string srdf =
      write("bad.srdf", R"(<robot name="arm"><disable_collisions link1="foot" link2="leg"/></robot>)");
  const std::string empty = write("empty.obj", "v 0 0 0\n");
  const struct {
    std::string arguments, named;
  } cases[] = {
      {"check --robot /nowhere/x.urdf" + motion, "/nowhere/x.urdf"},
      {"check --robot " + broken + motion, "broken.urdf"},
      {"check " + robot + " --from 0 --to 1,0", "hinge, rail"},
      {"check " + robot + " --from 0,0 --to 1,nan", "'rail'"},
      {"check " + robot + " --from 0,0 --to elbow=1", "'elbow'"},
      {"check " + robot + " --from 0,0 --to rail=1deg", "'rail'"},
      {"check " + robot + motion + " --scene /nowhere/s.stl", "/nowhere/s.stl"},
      {"check " + robot + motion + " --scene " + empty, "empty.obj"},
      {"check " + robot + motion + " --srdf " + srdf, "leg"},
      {"check " + robot + motion + " --srdf " + srdf + " --auto-srdf x.srdf", "--auto-srdf"},
      {"check " + robot + motion + " --margin -1", "--margin"},
      {"check " + robot + motion + " --margin nan", "margin"},
      {"check " + robot + motion + " --package nodir", "NAME=DIR"},
      {"check " + robot + motion + " --camera 0,0", "--image"},
      {"check " + robot + motion + " --image x.png --size 10", "--size"},
      {"check " + robot + motion + " --image x.png --camera up", "--camera"},
      {"check " + robot + motion + " --frobnicate", "--frobnicate"},
      {"check --from 0 --to 0", "--robot"},
      {"generate", "subcommand"},
      {"", "subcommand"},
  };
  for (const auto& c : cases) {
    const Outcome run = this->run(c.arguments);
    EXPECT_EQ(run.status, 2) << c.arguments << "\n" << run.out;
    EXPECT_EQ(run.out, "") << c.arguments;
    EXPECT_NE(run.err.find(c.named), std::string::npos) << c.arguments << "\n" << run.err;
  }
}

TEST_F(ProgramTest, ErrorsAreJsonToo) {
  const Outcome run = this->run("check --json --robot " + arm() + " --from 0,0 --to 0");
  EXPECT_EQ(run.status, 2);
  const Json answer = Json::parse(run.out);
  EXPECT_EQ(answer.at("status"), "error");
  EXPECT_NE(answer.at("error").get<std::string>().find("hinge, rail"), std::string::npos);
}

TEST_F(ProgramTest, HelpOfEveryVerbSaysItsExitStatuses) {
  for (const char* verb : {"check", "certify", "srdf", "info", "generate", "bench robot"}) {
    const Outcome help = run(std::string(verb) + " --help");
    EXPECT_EQ(help.status, 0);
    expectContains(help.out, "Exit status: ");
  }
}

TEST_F(ProgramTest, HelpAndVersionAreNoErrors) {
  const Outcome version = this->run("--version");
  EXPECT_EQ(version.status, 0);
  const std::string head = std::string("fcl_artic ") + FCL_ARTIC_VERSION + "\ninstruction set: ";
  const std::set<std::string> sets = {"avx512\n", "avx2\n", "sse2\n", "neon\n", "portable\n"};
  ASSERT_EQ(version.out.rfind(head, 0), 0u) << version.out;
  EXPECT_EQ(sets.count(version.out.substr(head.size())), 1u) << version.out;
  int baselines = 0;  // each build has one engine that all processors of its kind run
  for (const char* set : {"sse2", "neon", "portable"}) {
    ASSERT_EQ(setenv("FCL_ARTIC_ISA", set, 1), 0);
    baselines += this->run("--version").out == head + set + "\n";
  }
  EXPECT_EQ(baselines, 1);
  unsetenv("FCL_ARTIC_ISA");
  const Outcome help = this->run("check --help");
  EXPECT_EQ(help.status, 0);
  for (const char* option : {"--robot",
                             "--srdf",
                             "--auto-srdf",
                             "--scene",
                             "--package",
                             "--from",
                             "--to",
                             "--shortest",
                             "--margin",
                             "--tolerance-time",
                             "--tolerance-distance",
                             "--budget",
                             "--max-contacts",
                             "--every-pair",
                             "--ignore-initial-contact",
                             "--no-self",
                             "--no-scene",
                             "--json",
                             "--image",
                             "--html",
                             "--size",
                             "--camera",
                             "--trajectory",
                             "--clearance",
                             "--unknown-cells",
                             "--visibility",
                             "--executor"}) {
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  }
  const Outcome unknown = this->run("chek --robot " + arm());
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("'chek' is neither a verb"), std::string::npos) << unknown.err;
}

TEST_F(ProgramTest, GeneratedDataIsReadBack) {
  const std::string robot = path("puma"), pipes = path("pipes.obj");
  ASSERT_EQ(this->run("generate puma560 " + robot).status, 0);
  ASSERT_EQ(this->run("generate pipes --triangles 1000 --seed 7 " + pipes).status, 0);
  ASSERT_EQ(this->run("generate pipes --triangles 1000 --seed 7 " + path("again.obj")).status, 0);
  EXPECT_EQ(read(pipes), read(path("again.obj")));
  const Outcome run =
      this->run("check --json --robot " + robot + "/puma560.urdf --scene " + pipes +
                " --state joint2=0,joint3=0,joint4=0,joint5=0,joint6=0 --from joint1=0 --to joint1=1deg");
  EXPECT_TRUE(run.status == 0 || run.status == 1) << run.err;
  EXPECT_TRUE(Json::parse(run.out).at("poses").contains("flange"));
}

#ifndef FCL_ARTIC_HAS_PICTURES
TEST_F(ProgramTest, WithoutTheComponentPicturesAreRefused) {
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 1,0 --image " + path("x.png"));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("without the component visibility"), std::string::npos) << run.err;
}
#endif

TEST_F(ProgramTest, PandaOfTheDataFolder) {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  if (!data) GTEST_SKIP() << "PandaOfTheDataFolder: FCL_ARTIC_DATA is not set";
  const std::string panda = std::string(data) + "/robots/panda/panda";
  const Outcome run =
      this->run("check --json --robot " + panda + ".urdf --srdf " + panda +
                ".srdf --from 0,-0.785,0,-2.356,0,1.571,0.785,0 --to 0.2,-0.785,0,-2.356,0,1.571,0.785,0");
  EXPECT_EQ(run.status, 0) << run.out << run.err;
}

}  // namespace

}  // namespace program_test
