// SPDX-License-Identifier: BSD-3-Clause
// Tolerances of joints on the command line: an arm before a wall, on a hinge or on a rail.
#include <string>

#include <gtest/gtest.h>

#include "run_program.h"

namespace tolerance_options_test {

class ToleranceOptionsTest : public ProgramTest {
 protected:
  /// An arm of 1 m along x, 0.1 m thick; a wall begins at y = 0.1, that is 0.05 m beside it.
  Outcome check(const std::string& type, const std::string& more) const {
    const std::string robot = write("arm.urdf", R"(<robot name="arm"><link name="base"/>
  <link name="arm"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
  <joint name="joint" type=")" + type + R"("><parent link="base"/><child link="arm"/><axis xyz=")" +
                                                    (type == "prismatic" ? "0 1 0" : "0 0 1") + R"("/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)");
    const std::string scene = write("wall.urdf", R"(<robot name="cell"><link name="wall"><collision>
  <origin xyz="0 0.6 0"/><geometry><box size="4 1 1"/></geometry></collision></link></robot>)");
    return run("check --robot " + robot + " --scene " + scene + " --from 0 --to=-0.1 " + more);
  }
};

TEST_F(ToleranceOptionsTest, OneForAllJointsCounts) {
  EXPECT_EQ(check("revolute", "").status, 0);
  EXPECT_EQ(check("revolute", "--joint-tolerance 2deg").status, 0) << "35 mm at the arm's end";
  EXPECT_EQ(check("revolute", "--joint-tolerance 4deg").status, 1);
  EXPECT_EQ(check("revolute", "--joint-tolerance 0.07rad").status, 1);
  EXPECT_EQ(check("prismatic", "--joint-tolerance 49mm").status, 0);
  EXPECT_EQ(check("prismatic", "--joint-tolerance 5.1cm").status, 1);
  EXPECT_EQ(check("prismatic", "--joint-tolerance joint=51mm").status, 1);
}

TEST_F(ToleranceOptionsTest, OneForAllJointsThatFitsNoneIsRefusedWithTheCure) {
  const Outcome length = check("revolute", "--joint-tolerance 1mm");
  EXPECT_EQ(length.status, 2);
  EXPECT_NE(length.err.find("--joint-tolerance: a length for all joints fits none, as no joint of robot 'arm' slides: "
                            "write an angle, as 0.3deg"),
            std::string::npos)
      << length.err;
  const Outcome angle = check("prismatic", "--joint-tolerance 0.3deg,joint=1mm");
  EXPECT_EQ(angle.status, 2);
  EXPECT_NE(
      angle.err.find("an angle for all joints fits none, as no joint of robot 'arm' turns: write a length, as 1mm"),
      std::string::npos)
      << angle.err;
  for (const char* bad : {"1", "-1mm", "0.3deg,0.2deg", "joint=1mm", "=1mm", "henge=1deg"}) {
    const Outcome refused = check("revolute", std::string("--joint-tolerance=") + bad);
    EXPECT_EQ(refused.status, 2) << bad;
    EXPECT_NE(refused.err.find("--joint-tolerance"), std::string::npos) << bad << ": " << refused.err;
  }
}

}  // namespace tolerance_options_test
