// SPDX-License-Identifier: BSD-3-Clause
// Margins of bodies and pairs, allowed pairs: an arm on a base that stands on its floor.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace pair_options_test {

using Json = nlohmann::json;

class PairOptionsTest : public ProgramTest {
 protected:
  /// A base of 0.1 m height on a floor `gap` below it; an arm of 1 m, 0.4 m above the base, and a post that its tip
  /// passes 0.1 m above.
  std::string cell(const std::string& gap) const {
    return "--robot " + write("arm.urdf", R"(<robot name="arm">
  <link name="base"><collision><origin xyz="0 0 0.05"/><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0.5 0 0.55"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="1" velocity="1"/>
  </joint></robot>)") +
           " --scene " +
           write("floor.urdf", R"(<robot name="cell"><link name="floor"><collision><origin xyz="0 0 -)" + gap +
                                   R"("/><geometry><box size="4 4 0.1"/></geometry></collision></link>
  <link name="post"><collision><origin xyz="0.5 0.5 0.2"/><geometry><box size="0.1 0.1 0.4"/></geometry></collision></link>
  <joint name="stand" type="fixed"><parent link="floor"/><child link="post"/></joint></robot>)");
  }
  /// The base and its floor are checked, though no motion moves them, unless they are allowed.
  Outcome check(const std::string& gap, const std::string& more) const {
    const bool allowed = more.find("--allow base,floor") != std::string::npos;
    return run("check " + cell(gap) + (allowed ? " " : kChecked) + "--from 0 --to 1.5 " + more);
  }
  static constexpr const char* kChecked = " --disallow base,floor ";
};

constexpr const char* kOnIt = "0.05";    ///< the floor's middle: it touches the base
constexpr const char* kBelow = "0.052";  ///< 2 mm below
const std::string kMargin = "--margin 0.005 ";

TEST_F(PairOptionsTest, TheFirstHintOfAContactAtTheStartNamesPairAndOption) {
  const Outcome near = check(kBelow, kMargin);
  EXPECT_EQ(near.status, 1);
  EXPECT_NE(near.out.find("'base' and 'floor' begin 0.002 m apart"), std::string::npos) << near.out;
  EXPECT_EQ(Json::parse(check(kBelow, kMargin + "--json").out).at("notes").at(0).get<std::string>().find("'base'"), 0u);
  EXPECT_NE(near.out.find("--margin-pair"), std::string::npos) << near.out;
  const Outcome on = check(kOnIt, "");
  EXPECT_EQ(on.status, 1);
  EXPECT_NE(on.out.find("base,floor leaves them out"), std::string::npos) << on.out;
  const std::string plan = write("plan.csv", "hinge\n0\n1.5\n");
  const Outcome certified = run("certify " + plan + " " + cell(kBelow) + kChecked + kMargin + "--json");
  EXPECT_EQ(certified.status, 1);
  EXPECT_NE(Json::parse(certified.out)
                .at("plans")
                .at(0)
                .at("notes")
                .at(0)
                .get<std::string>()
                .find("--margin-pair base,floor=0"),
            std::string::npos)
      << certified.out;
}

TEST_F(PairOptionsTest, BodiesAndPairsHaveMarginsOfTheirOwn) {
  const std::string file = write("margins.txt", "# a base and its floor\n\n floor , base = 0 \n"),
                    plan = write("plan.csv", "hinge\n0\n1.5\n");
  for (const std::string& own :
       {std::string("--margin-pair base,floor=0"), std::string("--margin-pair floor,base=0.001"),
        std::string("--margin-of base=0"), std::string("--margin-of=floor=1e-3"), "--margins " + file}) {
    EXPECT_EQ(check(kBelow, kMargin + own).status, 0) << own;
    EXPECT_EQ(run("certify " + plan + " " + cell(kBelow) + kChecked + kMargin + own).status, 0) << own;
  }
  // All else keeps the margin: the arm passes the post at 0.1 m.
  EXPECT_EQ(check(kBelow, "--margin 0.11 --margin-pair base,floor=0 --margin-pair base,post=0").status, 1);
  EXPECT_EQ(check(kBelow, "--margin-of post=0.11").status, 1);
  EXPECT_EQ(check(kBelow, "--margin-of post=0.09").status, 0);
}

// No motion moves a base on its floor: the note names them, once, and no answer has an exception for them.
TEST_F(PairOptionsTest, WhatStandsStillIsNoContactOfAMotion) {
  const std::string motion = " --from 0 --to 1.5 ";
  const Outcome on = run("check " + cell(kOnIt) + motion);
  EXPECT_EQ(on.status, 0) << on.out;
  EXPECT_EQ(on.out.rfind("FREE: proven", 0), 0u) << on.out;
  EXPECT_NE(on.out.find("touch, and stand still against each other"), std::string::npos) << on.out;
  EXPECT_NE(on.out.find(": 'base' and 'floor'\n"), std::string::npos) << on.out;
  const Outcome below = run("check " + cell(kBelow) + motion + kMargin);
  EXPECT_EQ(below.status, 0) << below.out;
  EXPECT_EQ(below.out.find("stand still"), std::string::npos) << below.out;
  const Outcome asked = run("check " + cell(kOnIt) + motion + kChecked);
  EXPECT_EQ(asked.status, 1);
  EXPECT_EQ(asked.out.find("stand still"), std::string::npos) << asked.out;
  EXPECT_EQ(run("check " + cell(kOnIt) + motion + "--disallow base,flor").status, 2);
  EXPECT_EQ(run("check " + cell(kOnIt) + motion + kChecked + "--allow base,floor").status, 2);
}

TEST_F(PairOptionsTest, AllowedPairsAreSaid) {
  const Outcome allowed = check(kOnIt, "--allow base,floor");
  EXPECT_EQ(allowed.status, 0);
  EXPECT_EQ(allowed.out.rfind("FREE but for 1 allowed pair not proven apart", 0), 0u) << allowed.out;
  EXPECT_EQ(check(kOnIt, "--allow base,floor --margin-of post=0.11").status, 1);
}

TEST_F(PairOptionsTest, TheClearanceIsOfWhatIsChecked) {
  const Json answer = Json::parse(check(kOnIt, "--ignore-initial-contact --clearance --json").out);
  const Json& clearance = answer.at("clearance");
  EXPECT_LE(clearance.at("lower"), 0.1);
  EXPECT_GE(clearance.at("lower"), 0.098);
  EXPECT_EQ(clearance.at("body2").at("name"), "post");
  EXPECT_EQ(clearance.at("ignored_initial_contacts"), Json::array({Json::array({"floor", "base"})}));
  const Outcome text = check(kOnIt, "--ignore-initial-contact --clearance");
  EXPECT_NE(text.out.find("the ignored pairs"), std::string::npos) << text.out;
  const Json within = Json::parse(check(kBelow, kMargin + "--ignore-initial-contact --clearance --json").out);
  EXPECT_GE(within.at("clearance").at("lower"), 0.098) << "the floor within its margin is ignored too";
  EXPECT_GE(Json::parse(check(kOnIt, "--allow base,floor --clearance --json").out).at("clearance").at("lower"), 0.098);
}

TEST_F(PairOptionsTest, WhatIsWrongIsNamed) {
  const std::pair<std::string, std::string> wrong[] = {
      {"--margin-of flor=0", "'flor' is no link of robot 'arm' and no obstacle; did you mean 'floor'"},
      {"--margin-pair base,flor=0", "did you mean 'floor'"},
      {"--allow base,flor", "did you mean 'floor'"},
      {"--margin-of base", "is not BODY=METRES"},
      {"--margin-of base,floor=0", "is not BODY=METRES"},
      {"--margin-pair base=0", "is not BODY,BODY=METRES"},
      {"--margin-pair base,floor,post=0", "is not BODY,BODY=METRES"},
      {"--margin-of base=5mm", "is not BODY=METRES"},
      {"--margin-of base=-1", "a margin is at least 0"},
      {"--allow base", "is not BODY,BODY"},
      {"--margin-of base=0 --margin-of base=1", "has a margin already"},
      {"--margins " + write("none.txt", "# nothing\n"), "has no line BODY=METRES"},
      {"--margins " + write("bad.txt", "base=0\nfloor\n"), "line 2"}};
  for (const auto& [options, message] : wrong) {
    const Outcome run = check(kBelow, options);
    EXPECT_EQ(run.status, 2) << options;
    EXPECT_NE(run.err.find(message), std::string::npos) << options << ": " << run.err;
  }
}

// Each scene has a --scene of its own, in every verb.
TEST_F(PairOptionsTest, ASceneWithoutItsOptionIsNoArgument) {
  const std::string other = write("other.urdf", "<robot name='other'><link name='other'/></robot>");
  const Outcome two = run("check " + cell(kBelow) + " " + other + " --from 0 --to 1");
  EXPECT_EQ(two.status, 2) << two.out;
  EXPECT_EQ(run("check " + cell(kBelow) + " --scene " + other + " --from 0 --to 0.1").status, 0);
}

}  // namespace pair_options_test
