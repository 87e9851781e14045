// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "../urdf/temp_folder.h"

/// The output and status that the program left.
struct Outcome {
  int status = -1;  ///< exit status; -1 when it did not exit by itself
  std::string out, err;
};

/// An arm of one link that turns about z, and a ball in its way; runs the program on them.
class ProgramTest : public TempFolderTest {
 protected:
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  }

  /// @param arguments  as typed in a shell.
  Outcome run(const std::string& arguments) const {
    const std::string command = std::string("\"") + FCL_ARTIC_PROGRAM + "\" " + arguments + " >\"" + path("out") +
                                "\" 2>\"" + path("err") + "\"";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("out")), read(path("err"))};
  }

  /// Links of 1 m by 0.1 m by 0.1 m along x: `arm` on a hinge about z through the origin; far above it, joined by
  /// nothing to it but the base, `slide` on a rail along x. The ball has radius 0.1 m, 0.6 m from the hinge at 60°.
  std::string arm() const {
    return write("arm.urdf", R"(<robot name="arm">
  <link name="base"/>
  <link name="arm"><collision><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
  <link name="slide"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="rail" type="prismatic">
    <parent link="base"/><child link="slide"/><origin xyz="0 0 2"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>)");
  }
  std::string ball() const {
    return write("ball.urdf", R"(<robot name="ball">
  <link name="ball"><collision><origin xyz="0.3 0.519615242270663 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
</robot>)");
  }
  std::string armAndBall() const { return "--robot " + arm() + " --scene " + ball(); }
};
