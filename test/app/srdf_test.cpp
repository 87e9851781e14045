// SPDX-License-Identifier: BSD-3-Clause
// The verb srdf, and what check says of allowed pairs.
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace srdf_test {

namespace {

using Json = nlohmann::json;

/// Two arms on hinges about z, 0.8 m apart: they touch only where both turn to each other.
class SrdfVerbTest : public ProgramTest {
 protected:
  std::string twoArms() const {
    const auto arm = [](const std::string& name, const std::string& x) {
      return "<link name='" + name +
             R"('><collision><origin xyz='0.25 0 0'/><geometry><box size='0.5 0.1 0.1'/></geometry>
</collision></link><joint name=')" +
             name + "_hinge' type='revolute'><parent link='base'/><child link='" + name + "'/><origin xyz='" + x +
             R"( 0 0'/><axis xyz='0 0 1'/><limit lower='-3.1' upper='3.1' effort='1' velocity='1'/></joint>)";
    };
    return write("arms.urdf",
                 "<robot name='arms'><link name='base'/>" + arm("left", "0") + arm("right", "0.8") +
                     R"(<link name='lamp'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>
<joint name='pole' type='prismatic'><parent link='base'/><child link='lamp'/><origin xyz='0 0 2'/><axis xyz='0 0 1'/>
<limit lower='0' upper='1' effort='1' velocity='1'/></joint></robot>)");
  }
  std::string srdf(const std::string& name, const std::string& a, const std::string& b) const {
    return write(name, "<robot name='arms'><disable_collisions link1='" + a + "' link2='" + b + "'/></robot>");
  }
};

TEST_F(SrdfVerbTest, TellsWhatPairsDo) {
  const Outcome run = this->run("srdf --json " + twoArms());
  ASSERT_EQ(run.status, 0) << run.err;
  std::map<std::string, Json> pairs;
  const Json answer = Json::parse(run.out);
  for (const Json& pair : answer.at("pairs")) {
    pairs[pair.at("link1").get<std::string>() + " " + pair.at("link2").get<std::string>()] = pair;
  }
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs.at("left lamp").at("kind"), "never");
  EXPECT_EQ(pairs.at("left lamp").at("proven"), true);
  const Json& arms = pairs.at("left right");
  EXPECT_EQ(arms.at("kind"), "sometimes");
  EXPECT_GT(arms.at("touching"), 0);
  EXPECT_LT(arms.at("touching"), arms.at("tried"));
  // They reach each other across 0.8 m only where each points at the other, about.
  EXPECT_LT(std::abs(arms.at("configuration").at("left_hinge").get<double>()), 1.1);
  EXPECT_GT(std::abs(arms.at("configuration").at("right_hinge").get<double>()), 2);
}

TEST_F(SrdfVerbTest, ChecksAnSrdf) {
  const std::string robot = twoArms();
  const Outcome right = run("srdf " + robot + " --check " + srdf("right.srdf", "left", "lamp"));
  EXPECT_EQ(right.status, 0) << right.err << right.out;
  EXPECT_NE(right.out.find("1 never"), std::string::npos) << right.out;
  const Outcome wrong = run("srdf " + robot + " --check " + srdf("wrong.srdf", "left", "right"));
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.out.find("left and right: in "), std::string::npos) << wrong.out;
  // A body that a planar joint carries has no limits.
  const std::string cart = write("cart.urdf", R"(<robot name='cart'><link name='base'/>
<link name='left'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>
<link name='lamp'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>
<joint name='stand' type='fixed'><parent link='base'/><child link='left'/></joint>
<joint name='drive' type='planar'><parent link='base'/><child link='lamp'/><origin xyz='0 0 1'/><axis xyz='0 0 1'/></joint>
</robot>)");
  const Outcome unknown = run("srdf " + cart + " --check " + srdf("w.srdf", "left", "lamp"));
  EXPECT_EQ(unknown.status, 3) << unknown.out;
  EXPECT_NE(unknown.out.find("a joint between them has no bounds"), std::string::npos) << unknown.out;
}

TEST_F(SrdfVerbTest, WhatItWritesIsRight) {
  const std::string robot = twoArms(), file = path("made.srdf");
  ASSERT_EQ(run("srdf " + robot + " --write " + file).status, 0);
  EXPECT_NE(read(file).find("reason=\"Never\""), std::string::npos) << read(file);
  EXPECT_EQ(read(file).find("link2=\"right\" reason"), std::string::npos) << "left and right touch: " << read(file);
  EXPECT_EQ(run("srdf " + robot + " --check " + file).status, 0);
}

// At rest left reaches from 0 to 0.5 m and right from 0.8 m on; turned to each other they touch.
TEST_F(SrdfVerbTest, AllowsWhatTouchesInAConfigurationAndSaysThatItIsUnproven) {
  const std::string robot = twoArms(), file = path("made.srdf"), write = "srdf " + robot + " --write " + file;
  const Outcome rest = run(write + " --allow-at rest");
  ASSERT_EQ(rest.status, 0) << rest.err;
  EXPECT_NE(rest.out.find("and, unproven, 0 pairs that touch at rest written to"), std::string::npos) << rest.out;
  EXPECT_EQ(read(file).find("Unproven"), std::string::npos);
  for (const char* at : {"right_hinge=3", "0,3,0"}) {
    const Outcome turned = run(write + " --allow-at " + at);
    ASSERT_EQ(turned.status, 0) << turned.err;
    EXPECT_NE(turned.out.find("1 pair that touches at right_hinge=3: left and right written to"), std::string::npos)
        << turned.out;
    EXPECT_NE(read(file).find("link1=\"left\" link2=\"right\" reason=\"Unproven\""), std::string::npos) << read(file);
  }
  EXPECT_NE(read(file).find("reason=\"Never\""), std::string::npos);
  // It is allowed, and no answer is silent about it.
  const Outcome check = run("check " + robot + " --srdf " + file + " --from 0,3,0 --to 0,3.05,0");
  EXPECT_EQ(check.out.rfind("NOTHING CHECKED but for 1 allowed pair not proven apart", 0), 0u) << check.out;
  const Outcome wrong = run(write + " --allow-at elbow=3");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("--allow-at"), std::string::npos) << wrong.err;
  EXPECT_EQ(run("srdf " + robot + " --allow-at rest").status, 2) << "nothing is written";
}

TEST_F(SrdfVerbTest, AnswersSayWhatTheyRestOn) {
  const std::string motion = " --from 0,0,0 --to 0,0.5,0";
  const std::string right = srdf("right.srdf", "left", "lamp"), wrong = srdf("wrong.srdf", "left", "right");
  const Outcome proven = run("check " + twoArms() + " --srdf " + right + motion);
  EXPECT_EQ(proven.out.rfind("FREE: proven", 0), 0u) << proven.out;
  const Outcome excused = run("check " + twoArms() + " --srdf " + wrong + " --from 0,3,0 --to 0,3.05,0");
  EXPECT_EQ(excused.status, 0);
  EXPECT_EQ(excused.out.rfind("FREE but for 1 allowed pair not proven apart: proven", 0), 0u) << excused.out;
  EXPECT_NE(excused.out.find("1 allowed pair can touch, and is not checked: left and right"), std::string::npos)
      << excused.out;
  const Outcome json = run("check --json " + twoArms() + " --srdf " + wrong + motion);
  EXPECT_EQ(Json::parse(json.out).at("unproven_allowed_pairs"), 1);
  // Found by itself: the pair that touches stays checked.
  const Outcome found = run("check " + twoArms() + " --auto-srdf " + path("auto.srdf") + " --from 0,3,0 --to 0,3.05,0");
  EXPECT_EQ(found.status, 1) << found.out;
}

// Left and lamp are never nearer than 1.85 m.
TEST_F(SrdfVerbTest, ProofsAreMadeForTheMarginThatIsAskedFor) {
  const std::string robot = twoArms(), allowed = " --srdf " + srdf("a.srdf", "left", "lamp"),
                    motion = " --from 0,0,0 --to 0,0.5,0";
  const auto check = [&](const std::string& more) { return run("check " + robot + allowed + motion + more); };
  for (const char* margin : {"0", "0.005", "0.1"}) {
    const Outcome proven = check(std::string(" --margin ") + margin);
    EXPECT_EQ(proven.status, 0);
    EXPECT_EQ(proven.out.rfind("FREE: proven", 0), 0u) << margin << proven.out;
  }
  const Outcome near = check(" --margin 1.95 --no-scene");
  EXPECT_NE(near.out.find("1 allowed pair can come within the margin of 1.95 m, and is not checked: left and lamp"),
            std::string::npos)
      << near.out;
  // All pairs, found by themselves; what only comes near stays checked.
  const Outcome found = run("check " + robot + " --auto-srdf " + path("auto.srdf") + motion + " --margin 0.1 --json");
  EXPECT_EQ(found.status, 0) << found.err;
  const Json answer = Json::parse(found.out);
  EXPECT_EQ(answer.at("unproven_allowed_pairs"), 0);
  EXPECT_EQ(answer.at("statistics").at("pairs"), 3);
}

TEST_F(SrdfVerbTest, FilesOfEarlierRunsAreNotLeft) {
  const std::string broken = write("broken.urdf", "<robot name='x'><link name=''/>"),
                    old = write("old.srdf", "<robot/>");
  EXPECT_EQ(run("srdf " + broken + " --write " + old).status, 2);
  EXPECT_EQ(read(old), "");
  // An output is no input.
  const std::string robot = twoArms(), given = srdf("given.srdf", "left", "lamp");
  const Outcome same = run("srdf " + robot + " --check " + given + " --write " + given);
  EXPECT_EQ(same.status, 2);
  EXPECT_NE(same.err.find("--write '" + given + "' is a file that this run reads"), std::string::npos) << same.err;
  EXPECT_NE(read(given), "");
  // Tables of measurements, likewise.
  const std::string table = write("old.csv", "old");
  EXPECT_EQ(run("bench robot " + broken + " --csv " + table).status, 2);
  EXPECT_EQ(read(table), "");
}

#ifdef FCL_ARTIC_HAS_PICTURES
TEST_F(SrdfVerbTest, DrawsWhatTouches) {
  ASSERT_EQ(std::system(("mkdir -p '" + path("pictures") + "'").c_str()), 0);
  write("pictures/left-lamp.png", "an earlier run's");
  const Outcome drawn = run("srdf " + twoArms() + " --images " + path("pictures"));
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_EQ(read(path("pictures") + "/left-right.png").rfind("\x89PNG", 0), 0u);
  EXPECT_TRUE(read(path("pictures") + "/left-lamp.png").empty()) << "never touch";
}
#endif

}  // namespace

}  // namespace srdf_test
