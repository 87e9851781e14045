// SPDX-License-Identifier: BSD-3-Clause
// A world against its files: equal ones are, and each change of a number, name or pair is seen.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "../readers.h"
#include "worlds.h"

namespace verify::test {
namespace {

class VerifyReaders : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (std::filesystem::temp_directory_path() / "fcl_artic_verify_XXXXXX").string();
    ASSERT_NE(mkdtemp(folder_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& content) {
    std::filesystem::create_directories(std::filesystem::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name, std::ios::binary) << content;
    return folder_ + "/" + name;
  }
  Comparison compare(const std::string& world, const std::string& urdf) {
    const World read = readWorld(world);
    return compareWithUrdf(read, write("robot.urdf", urdf), {{"elsewhere", folder_ + "/deep"}});
  }
  std::string folder_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

const std::string kUrdf = R"(<robot name="r">
<link name="base"><collision><geometry><box size="1 0.5 0.25"/></geometry></collision></link>
<link name="arm"><collision><origin xyz="0.1 0 0" rpy="0.3 -0.2 1"/><geometry><cylinder radius="0.1" length="0.7"/></geometry></collision>
  <collision><geometry><mesh filename="package://robot_pkg/meshes/tri.stl" scale="0.001 0.001 0.001"/></geometry></collision></link>
<link name="hand"><collision><geometry><mesh filename="package://elsewhere/quad.obj"/></geometry></collision></link>
<link name="finger"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="empty"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.333" rpy="-1.57079632679 0 0"/><axis xyz="0 1 1"/></joint>
<joint name="j2" type="prismatic"><parent link="arm"/><child link="hand"/><axis xyz="0 0 2"/></joint>
<joint name="j3" type="continuous"><parent link="hand"/><child link="finger"/><mimic joint="j1" multiplier="-0.5" offset="0.1"/></joint>
<joint name="j4" type="fixed"><parent link="hand"/><child link="empty"/></joint>
</robot>)";

/// As a writer rounds angles: in doubles.
M fromRpy(double r, double p, double y, const V& t) {
  M m = rotationAbout({0, 0, 1}, y) * rotationAbout({0, 1, 0}, p) * rotationAbout({1, 0, 0}, r);
  m.t = t;
  return m;
}
std::string goodWorld() {
  const double s = 0.001;
  return kHead + "variable j1\nvariable j2\nframe base 0 " + hex(M{}) + "\nframe arm 1 " +
         hex(fromRpy(-1.57079632679, 0, 0, {0, 0, 0.333})) + "\nturn " + hex(V{0, std::sqrt(0.5), std::sqrt(0.5)}) +
         " 0 " + hex(1) + " " + hex(0) + "\nframe hand 2 " + hex(M{}) + "\nslide " + hex(V{0, 0, 1}) + " 1 " + hex(1) +
         " " + hex(0) + "\nframe finger 3 " + hex(M{}) + "\nturn " + hex(V{1, 0, 0}) + " 0 " + hex(-0.5) + " " +
         hex(0.1) + "\nframe empty 3 " + hex(M{}) + "\ngeometry box " + hex(V{1, 0.5, 0.25}) + "\ngeometry cylinder " +
         hex(0.1) + " " + hex(0.7) + "\n" +
         meshText({{0, 0, 0}, {s * 1, 0, 0}, {0, s * 2.5, 0}, {0, 0, s * 7}}, {{1, 2, 0}, {0, 3, 1}}, false) +
         meshText({{0, 0, 0}, {1, 0, 0}, {1, 1.5, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, false) + "geometry sphere " +
         hex(0.05) + "\nbody link base 1 0 " + hex(M{}) + "\nbody link arm 2 2 " + hex(M{}) + "\nbody link arm 2 1 " +
         hex(fromRpy(0.3, -0.2, 1, {0.1, 0, 0})) + "\nbody link hand 3 3 " + hex(M{}) + "\nbody link finger 4 4 " +
         hex(M{}) + "\nunchecked allowed base hand\nunchecked neighbours base arm\n";
}
void writeMeshes(const std::function<std::string(const std::string&, const std::string&)>& write) {
  write("robot_pkg/meshes/tri.stl",
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2.5 0\nendloop\nendfacet\nfacet "
        "normal 0 0 1\nouter "
        "loop\nvertex 0 0 0\nvertex 1e0 0 0\nvertex 0 0 7\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 "
        "0 0\nvertex 1 0 "
        "0\nvertex 1 0 0\nendloop\nendfacet\nendsolid s\n");
  write("deep/quad.obj", "# a square\nv 0 0 0\nv 1 0 0\r\nv 1 1.5 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 -2//1 4//1\n");
}

TEST_F(VerifyReaders, AWorldIsItsUrdf) {
  writeMeshes([&](const std::string& name, const std::string& text) { return write(name, text); });
  const Comparison good = compare(goodWorld(), kUrdf);
  for (const std::string& what : good.differences) ADD_FAILURE() << what;
  EXPECT_EQ(good.notes.size(), 3u);  // the root, counts, a triangle without area
  for (const auto& [what, by] : std::vector<std::pair<std::string, std::string>>{
           {"1 0.5 0.25", "1 0.5 0.2500000001"},
           {"radius=\"0.1\"", "radius=\"0.10000000000000002\""},
           {"length=\"0.7\"", "length=\"0.8\""},
           {"0 0 0.333", "0 0 0.334"},
           {"-1.57079632679", "-1.5707963267"},
           {"rpy=\"0.3 -0.2 1\"", "rpy=\"0.3 -0.2 1.00000000000001\""},
           {"0 1 1", "0 1 1.00000000000001"},
           {"0 1 1", "0 -1 -1"},
           {"0 0 2", "0 2 0"},
           {"revolute", "prismatic"},
           {"revolute", "fixed"},
           {"revolute", "floating"},
           {"revolute", "planar"},
           {"-0.5", "0.5"},
           {"offset=\"0.1\"", "offset=\"0\""},
           {"mimic joint=\"j1\"", "mimic joint=\"j2\""},
           {"scale=\"0.001 ", "scale=\"0.002 "},
           {"<sphere radius=\"0.05\"/>", "<box size=\"1 1 1\"/>"},
           {"<link name=\"empty\"/>",
            "<link name=\"empty\"><collision><geometry><sphere radius=\"1\"/></geometry></collision></link>"},
           {"<link name=\"empty\"/>", "<link name=\"empty\"/><link name=\"more\"/>"},
           {"<collision><geometry><sphere radius=\"0.05\"/></geometry></collision>", ""},
           {"name=\"j1\"", "name=\"j9\""},
           {"<parent link=\"hand\"/><child link=\"finger\"/>", "<parent link=\"arm\"/><child link=\"finger\"/>"}})
    EXPECT_FALSE(compare(goodWorld(), replaced(kUrdf, what, by)).differences.empty()) << what << " -> " << by;
  // The world without a body, with a moved one, with a triangle less or more.
  const std::string g = goodWorld();
  for (const std::string& world :
       {replaced(g, "body link finger 4 4 ", "body link other 4 4 "),
        replaced(g, "body link finger 4", "body carried finger 4"),
        replaced(g, "body link finger 4", "body link finger 3"),
        replaced(g, "triangles 2\n1 2 0\n0 3 1\n", "triangles 1\n1 2 0\n"),
        replaced(g, "triangles 2\n1 2 0\n0 3 1\n", "triangles 3\n1 2 0\n0 3 1\n1 2 3\n"),
        replaced(g, "frame empty 3", "frame finger 3"),
        replaced(g, "body link base 1 0", "body link base 1 4") + "body link base 1 0 " + hex(M{}) + "\n"})
    EXPECT_FALSE(compare(world, kUrdf).differences.empty());
  EXPECT_THROW(compare(g, "<robot"), BadInput);
  EXPECT_THROW(compare(g, replaced(kUrdf, "package://elsewhere", "package://nowhere")), BadInput);
  EXPECT_THROW(compare(g, replaced(kUrdf, "0 0 0.333", "0 0 x")), BadInput);
}

TEST_F(VerifyReaders, VariablesOfTheWorldAreThoseOfTheJoints) {
  const std::string ball = "<collision><geometry><sphere radius='0.5'/></geometry></collision>";
  const auto urdf = [&](const std::string& type) {
    return "<robot name='r'><link name='a'>" + ball + "</link><link name='b'>" + ball +
           "</link><joint name='j' type='" + type +
           "'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";
  };
  const auto world = [&](const std::string& elements) {
    return kHead + "variable x\nvariable y\nvariable z\nvariable u\nvariable v\nvariable w\nframe a 0 " + hex(M{}) +
           "\nframe b 1 " + hex(M{}) + "\n" + elements + "geometry sphere " + hex(0.5) + "\nbody link a 1 0 " +
           hex(M{}) + "\nbody link b 2 0 " + hex(M{}) + "\n";
  };
  const auto element = [](const std::string& kind, const V& axis, int variable, double m = 1, double c = 0) {
    return kind + " " + hex(axis) + " " + std::to_string(variable) + " " + hex(m) + " " + hex(c) + "\n";
  };
  const V X{1, 0, 0}, Y{0, 1, 0}, Z{0, 0, 1};
  const auto planar = [&](int x, int y, int t, double m, double c) {
    return world(element("slide", X, x) + element("slide", Y, y, m) + element("turn", Z, t, 1, c));
  };
  EXPECT_TRUE(compare(planar(0, 1, 2, 1, 0), urdf("planar")).differences.empty());
  EXPECT_FALSE(compare(planar(0, 0, 2, 1, 0), urdf("planar")).differences.empty());
  EXPECT_FALSE(compare(planar(0, 1, 2, 0, 0), urdf("planar")).differences.empty());
  EXPECT_FALSE(compare(planar(0, 1, 2, 1, 1), urdf("planar")).differences.empty());
  const auto floating = [&](int r) {
    return world(element("slide", X, 0) + element("slide", Y, 1) + element("slide", Z, 2) + "rotate " +
                 std::to_string(r) + "\n");
  };
  EXPECT_TRUE(compare(floating(3), urdf("floating")).differences.empty());
  EXPECT_FALSE(compare(floating(2), urdf("floating")).differences.empty());
  writeMeshes([&](const std::string& name, const std::string& text) { return write(name, text); });
  EXPECT_FALSE(compare(replaced(goodWorld(), "variable j2", "variable j1"), kUrdf).differences.empty());
}

TEST_F(VerifyReaders, WhatOtherReadersSeeIsNotPassedOver) {
  EXPECT_EQ(readMesh(write("t.obj", "v\t0 0 0\n  v 1 0 0\nv 0 1 0\nf\t1 2 3\n f 3 2 1\n")).size(), 18u);
  EXPECT_THROW(readMesh(write("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3\n")), BadInput);
  EXPECT_EQ(readMesh(write("u.stl", "SOLID\nVERTEX 0 0 0\nvertex 1 0 0\nVertex 0 1 0\n")).size(), 9u);
  std::string bytes(80, 'x');
  bytes += little(1, 4) + std::string(12, '\0') + little(0x7fc00000, 4) + std::string(34, '\0');
  EXPECT_THROW(readMesh(write("nan.stl", bytes)), BadInput);
}

TEST_F(VerifyReaders, AnObstacleOfALinksNameIsNoLink) {
  const std::string srdf = write("n.srdf", "<robot name='r'><disable_collisions link1='base' link2='hand'/></robot>");
  const std::string good = replaced(goodWorld(), "unchecked neighbours base arm\n", "");
  EXPECT_TRUE(compareWithSrdf(readWorld(good), srdf).differences.empty());
  EXPECT_FALSE(
      compareWithSrdf(readWorld(good + "body obstacle base 0 4 " + hex(M{}) + "\n"), srdf).differences.empty());
}

TEST_F(VerifyReaders, BinaryStl) {
  std::string bytes(80, 'x');
  bytes += little(2, 4);
  const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 0, 0.1f, 0}, {0, 0, 0, 1, 0, 0, 0, 0, -3}};
  for (const auto& c : corners) {
    bytes += std::string(12, '\0');
    for (const float x : c) {
      std::uint32_t bits;
      std::memcpy(&bits, &x, sizeof bits);
      bytes += little(bits, 4);
    }
    bytes += std::string(2, '\0');
  }
  const std::vector<double> read = readMesh(write("a.STL", bytes));
  ASSERT_EQ(read.size(), 18u);
  EXPECT_EQ(read[7], static_cast<double>(0.1f));
  EXPECT_EQ(read[17], -3);
  EXPECT_THROW(readMesh(write("cut.stl", bytes.substr(0, 150))), BadInput);
  EXPECT_THROW(readMesh(write("huge.stl", std::string(80, 'x') + "\xff\xff\xff\xff")), BadInput);
  EXPECT_THROW(readMesh(write("a.dae", "")), BadInput);
  EXPECT_THROW(readMesh(write("a.obj", "v 0 0 0\nf 1 2 3\n")), BadInput);
  EXPECT_THROW(readMesh(write("b.obj", "v 0 0\n")), BadInput);
  EXPECT_THROW(readMesh(folder_), BadInput);
}

TEST_F(VerifyReaders, AllowedPairsAreInTheSrdf) {
  const auto compare = [&](const std::string& world, const std::string& srdf) {
    return compareWithSrdf(readWorld(world), write("robot.srdf", "<robot name=\"r\">" + srdf + "</robot>"))
        .differences.size();
  };
  const std::string g = goodWorld();
  EXPECT_EQ(compare(g, ""), 1u);
  EXPECT_EQ(compare(g, "<disable_collisions link1=\"hand\" link2=\"base\" reason=\"Never\"/>"), 0u);
  EXPECT_EQ(compare(g, "<disable_collisions link1=\"hand\" link2=\"arm\"/>"), 1u);
  EXPECT_EQ(compare(g, "<disable_default_collisions link=\"hand\"/>"), 0u);
  EXPECT_EQ(compare(g, "<disable_default_collisions link=\"hand\"/><enable_collisions link1=\"hand\" link2=\"base\"/>"),
            1u);
  EXPECT_THROW(compare(g + "unchecked allowed base nobody\n", ""), BadInput);
  EXPECT_THROW(compareWithSrdf(readWorld(g), write("b.srdf", "<robot")), BadInput);
}

}  // namespace
}  // namespace verify::test
