// SPDX-License-Identifier: BSD-3-Clause
// The verb `info`: what it finds in a robot's files.
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace info_test {

namespace {

using Json = nlohmann::json;

/// An open square of side 1, or a closed tetrahedron.
const char* const kOpen = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const char* const kClosed = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class InfoTest : public ProgramTest {
 protected:
  /// Three links with meshes and a box on a chain of 0.5 m each; the third is far away from the first.
  std::string robot(const std::string& scale = "1 1 1") const {
    write("open.obj", kOpen);
    write("closed.obj", kClosed);
    const auto mesh = [](const std::string& file, const std::string& factor) {
      return "<collision><geometry><mesh filename='" + file + "' scale='" + factor + "'/></geometry></collision>";
    };
    const auto joint = [](const std::string& name, const std::string& parent, const std::string& child,
                          const std::string& more) {
      return "<joint name='" + name + "' " + more + "<parent link='" + parent + "'/><child link='" + child +
             "'/><origin xyz='0.5 0 0'/><axis xyz='0 0 2'/></joint>";
    };
    return write("r.urdf",
                 "<robot name='r'><link name='a'>" + mesh("open.obj", "0.1 0.1 0.1") + "</link><link name='b'>" +
                     mesh("closed.obj", scale) +
                     "</link><link name='c'><collision><geometry><box size='0.1 0.2 0.3'/></geometry></collision>"
                     "</link><link name='d'/>" +
                     joint("ab", "a", "b", "type='revolute'><limit lower='-1' upper='2' effort='1' velocity='1'/>") +
                     joint("bc", "b", "c", "type='continuous'>") + joint("cd", "c", "d", "type='fixed'>") + "</robot>");
  }
};

TEST_F(InfoTest, ShowsWhatTheFilesHold) {
  const std::string srdf = write("r.srdf",
                                 "<robot name='r'><disable_collisions link1='c' link2='a' reason='Never'/>"
                                 "<disable_collisions link1='x' link2='a'/></robot>");
  const Outcome plain = this->run("info --json " + robot("0.2 0.2 0.2"));
  ASSERT_EQ(plain.status, 0) << plain.err;
  const Json all = Json::parse(plain.out);
  EXPECT_EQ(all.at("robot"), "r");
  EXPECT_EQ(all.at("values"), Json({"ab", "bc"}));
  EXPECT_EQ(all.at("joints").at(0).at("type"), "revolute");
  EXPECT_EQ(all.at("joints").at(0).at("upper"), 2);
  EXPECT_EQ(all.at("joints").at(0).at("axis"), Json({0, 0, 1}));
  EXPECT_TRUE(all.at("joints").at(1).at("upper").is_null());
  EXPECT_TRUE(all.at("joints").at(2).at("axis").is_null());
  EXPECT_EQ(all.at("joints_reach"), 1.5);
  EXPECT_EQ(all.at("links").size(), 4u);
  const Json &open = all.at("links").at(0).at("geometry").at(0), &closed = all.at("links").at(1).at("geometry").at(0),
             &box = all.at("links").at(2).at("geometry").at(0);
  EXPECT_EQ(open.at("kind"), "mesh");
  EXPECT_EQ(open.at("file"), "open.obj");
  EXPECT_EQ(open.at("triangles"), 2);
  EXPECT_EQ(open.at("closed"), false);
  EXPECT_NE(open.at("why_not_closed").get<std::string>().find("not closed: 4 edges"), std::string::npos);
  EXPECT_EQ(open.at("extents"), Json({0.1, 0.1, 0.0}));
  EXPECT_EQ(closed.at("closed"), true);
  EXPECT_EQ(box.at("kind"), "box");
  EXPECT_EQ(box.at("extents"), Json({0.1, 0.2, 0.3}));
  EXPECT_EQ(all.at("checked_pairs").dump(), "[[\"a\",\"b\"],[\"a\",\"c\"],[\"b\",\"c\"]]")
      << "neighbours that don't touch";
  EXPECT_TRUE(all.at("unchecked_pairs").empty());
  const Outcome puma = this->run("info --json " FCL_ARTIC_SOURCE "/data/puma560/puma560.urdf");
  EXPECT_EQ(Json::parse(puma.out).at("unchecked_pairs").at(0),
            Json({{"link1", "base"}, {"link2", "shoulder"}, {"reason", "neighbours that touch"}}))
      << puma.out;
  EXPECT_TRUE(all.at("warnings").empty()) << plain.out;

  const Outcome allowed = this->run("info --json " + robot("0.2 0.2 0.2") + " --srdf " + srdf);
  ASSERT_EQ(allowed.status, 0) << allowed.err;
  const Json less = Json::parse(allowed.out);
  EXPECT_EQ(less.at("checked_pairs").dump(), "[[\"a\",\"b\"],[\"b\",\"c\"]]") << "the file's word is the only one";
  EXPECT_EQ(less.at("unchecked_pairs").at(0), Json({{"link1", "a"}, {"link2", "c"}, {"reason", "SRDF: Never"}}));
  EXPECT_NE(less.at("notes").dump().find("1 of 2 entries name links"), std::string::npos);

  const Outcome text = this->run("info --robot " + robot("0.2 0.2 0.2") + " --srdf " + srdf);
  ASSERT_EQ(text.status, 0) << text.err;
  for (const char* part : {"robot 'r': 4 links, 3 joints, 2 values in a configuration", "-1 to 2 rad (-57 to 115 deg)",
                           "no limits", "b: mesh closed.obj, 4 triangles, 0.2 x 0.2 x 0.2 m, closed and oriented",
                           "a: mesh open.obj, 2 triangles", "c: box, 0.1 x 0.2 x 0.3 m", "d: no collision geometry",
                           "2 checked, 1 not", "not, SRDF: Never (1)\n    a - c"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part << " is not in\n" << text.out;
  }
}

TEST_F(InfoTest, WarnsOfOtherUnits) {
  const auto warnings = [&](const std::string& scale) {
    return Json::parse(this->run("info --json " + robot(scale)).out).at("warnings").dump();
  };
  EXPECT_EQ(warnings("0.2 0.2 0.2"), "[]");
  EXPECT_EQ(warnings("25 25 25"), "[]");
  EXPECT_NE(warnings("300 300 300")
                .find("1 of 2 meshes are far larger than the robot: its joints reach 1.5 m, mesh 'closed.obj' of link "
                      "'b' is 300 m"),
            std::string::npos);
  EXPECT_EQ(warnings("0.0001 0.0001 0.0001"), "[]") << "another link is of the robot's size";
  const std::string tiny = write("tiny.urdf", R"(<robot name='r'><link name='a'/><link name='b'><collision><geometry>
      <sphere radius='0.0005'/></geometry></collision></link><joint name='j' type='continuous'><parent link='a'/>
      <child link='b'/><origin xyz='1 0 0'/></joint></robot>)");
  const Outcome run = this->run("info " + tiny);
  EXPECT_NE(run.out.find("warning: the largest geometry is 0.001 m long, the robot's joints reach 1 m"),
            std::string::npos)
      << run.out;
}

TEST_F(InfoTest, ErrorsAreTwo) {
  EXPECT_EQ(this->run("info").status, 2);
  const Outcome none = this->run("info /nowhere/r.urdf");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("/nowhere/r.urdf"), std::string::npos) << none.err;
  EXPECT_EQ(this->run("info " + folder_.string()).status, 2);
}

}  // namespace

}  // namespace info_test
