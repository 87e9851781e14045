// SPDX-License-Identifier: BSD-3-Clause
// A world against its files: equal ones are, and each change of a number, name or pair is seen.
#include "../meshes.h"
#include "files.h"

namespace verify::test {
namespace readers_test {

using VerifyReaders = VerifyFiles;

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
         meshText({{0, 0, 0}, {s * 1, 0, 0}, {0, s * 2.5, 0}, {0, 0, s * 7}}, {{1, 2, 0}, {0, 1, 3}}, false) +
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
  ASSERT_EQ(good.notes.size(), 4u);
  EXPECT_EQ(good.notes[0], "root link 'base' stands still in the world");
  EXPECT_EQ(good.notes[1], "the file has 5 links, 4 joints and 5 collision geometries, as the world has");
  EXPECT_NE(good.notes[2].find("1 triangle without area"), std::string::npos) << good.notes[2];
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
           {"<link name=\"empty\"/>",
            "<link name=\"empty\"/><link name=\"more\"/><joint name=\"j5\" type=\"fixed\"><parent "
            "link=\"empty\"/><child "
            "link=\"more\"/></joint>"},
           {"<collision><geometry><sphere radius=\"0.05\"/></geometry></collision>", ""},
           {"name=\"j2\"", "name=\"j9\""},
           {"<parent link=\"hand\"/><child link=\"finger\"/>", "<parent link=\"arm\"/><child link=\"finger\"/>"}})
    EXPECT_NE(said(goodWorld(), replaced(kUrdf, what, by)), "same") << what << " -> " << by;
  // A sphere of radius 0 is no body.
  EXPECT_EQ(said(goodWorld(), replaced(kUrdf, "<link name=\"empty\"/>",
                                       "<link name=\"empty\"><collision><geometry><sphere "
                                       "radius=\"0\"/></geometry></collision></link>")),
            "same");
  // The world without a body, with a moved one, with a triangle less or more.
  const std::string g = goodWorld();
  for (const std::string& world :
       {replaced(g, "body link finger 4 4 ", "body link other 4 4 "),
        replaced(g, "body link finger 4", "body carried finger 4"),
        replaced(g, "body link finger 4", "body link finger 3"),
        replaced(g, "triangles 2\n1 2 0\n0 1 3\n", "triangles 2\n1 2 0\n0 2 3\n"),
        replaced(g, "triangles 2\n1 2 0\n0 1 3\n", "triangles 3\n1 2 0\n0 1 3\n1 2 3\n"),
        replaced(g, "frame empty 3", "frame finger 3"),
        replaced(g, "body link base 1 0", "body link base 1 4") + "body link base 1 0 " + hex(M{}) + "\n"})
    EXPECT_FALSE(compare(world, kUrdf).differences.empty());
  EXPECT_THROW(compare(g, "<robot"), BadInput);
  EXPECT_THROW(compare(g, replaced(kUrdf, "package://elsewhere", "package://nowhere")), BadInput);
  EXPECT_THROW(compare(g, replaced(kUrdf, "0 0 0.333", "0 0 x")), BadInput);
}

// A mesh is that of its package, however many slashes there are, and that beside the file that is read: ".." after a
// link leads where the disk says.
TEST_F(VerifyReaders, MeshesAreWhereTheFileSays) {
  writeMeshes([&](const std::string& name, const std::string& text) { return write(name, text); });
  const std::string tri = "robot_pkg/meshes/tri.stl";
  EXPECT_EQ(said(goodWorld(), replaced(kUrdf, tri, "robot_pkg//meshes/tri.stl")), "same");
  EXPECT_THROW(compare(goodWorld(), replaced(kUrdf, tri, "robot_pkg/" + folder_ + "/" + tri)), BadInput);
  EXPECT_THROW(compare(goodWorld(), replaced(kUrdf, tri, "robot_pkg///")), BadInput);
  const std::string here = replaced(kUrdf, "package://elsewhere/quad.obj", "quad.obj");
  write("real/robot.urdf", here);
  write("real/quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1.5 0\nv 0 1 0\nf 1 2 3 4\n");
  write("real/inside/none", "");
  write("links/quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  std::filesystem::create_symlink("../real/inside", folder_ + "/links/inside");
  EXPECT_TRUE(compareWithUrdf(readWorld(goodWorld()), folder_ + "/links/inside/../robot.urdf",
                              {{"robot_pkg", folder_ + "/robot_pkg"}})
                  .differences.empty());
}

TEST_F(VerifyReaders, VariablesOfTheWorldAreThoseOfTheJoints) {
  const std::string ball = "<collision><geometry><sphere radius='0.5'/></geometry></collision>";
  const auto urdf = [&](const std::string& type) {
    return "<robot name='r'><link name='a'>" + ball + "</link><link name='b'>" + ball +
           "</link><joint name='j' type='" + type +
           "'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";
  };
  const auto world = [&](const std::string& elements) {
    std::string variables;
    for (const char* v : {"x", "y", "theta", "trans_x", "trans_y", "trans_z", "rot_x", "rot_y", "rot_z", "rot_w"})
      variables += std::string("variable j/") + v + "\n";
    return kHead + variables + "frame a 0 " + hex(M{}) + "\nframe b 1 " + hex(M{}) + "\n" + elements +
           "geometry sphere " + hex(0.5) + "\nbody link a 1 0 " + hex(M{}) + "\nbody link b 2 0 " + hex(M{}) + "\n";
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
  EXPECT_FALSE(compare(planar(1, 0, 2, 1, 0), urdf("planar")).differences.empty());
  const auto floating = [&](int r) {
    return world(element("slide", X, 3) + element("slide", Y, 4) + element("slide", Z, 5) + "rotate " +
                 std::to_string(r) + "\n");
  };
  EXPECT_TRUE(compare(floating(6), urdf("floating")).differences.empty());
  EXPECT_FALSE(compare(floating(5), urdf("floating")).differences.empty());
  writeMeshes([&](const std::string& name, const std::string& text) { return write(name, text); });
  EXPECT_FALSE(compare(replaced(goodWorld(), "variable j2", "variable j1"), kUrdf).differences.empty());
}

using Numbers = std::vector<double>;
using Indices = std::vector<std::uint32_t>;
std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
}

TEST_F(VerifyReaders, TextStl) {
  const std::string spaces(150, ' ');  // once a vertex was cut after 120 characters
  const MeshFile mesh =
      readMesh(write("u.stl", "solid a vertex 9 9 9\n" + facet("0 0 0", "1 0 0", "0 1" + spaces + "35") +
                                  "endsolid\nSOLID\n" + facet("0.1 0 0", "1e-3 +2. .5", "-0 0 1") + "EndSolid a\n"));
  EXPECT_EQ(mesh.points, (Numbers{0, 0, 0, 1, 0, 0, 0, 1, 35, 0.1, 0, 0, 1e-3, 2, 0.5, 0, 0, 1}));
  EXPECT_EQ(mesh.ends, (std::vector<std::size_t>{3, 6}));
  const std::string good = facet("0 0 0", "1 0 0", "0 1 0");
  EXPECT_NO_THROW(readMesh(write("g.stl", "solid\n" + good + "endsolid\n")));
  for (const std::string& text :
       {"solid\n" + good, good + "endsolid\n", "solid\n" + good + "vertex 1 2 3\nendsolid\n",
        "solid\n" + facet("0 0 0", "1 0 0", "0,5 1 0") + "endsolid\n",
        "solid\n" + facet("0 0 0", "1 0 0", "0x1 1 0") + "endsolid\n",
        "solid\n" + facet("0 0 0", "1 0 0", "nan 1 0") + "endsolid\n",
        "solid\n" + facet("0 0 0", "1 0 0", "1e999 1 0") + "endsolid\n",
        "solid\n" + facet("0 0 0", "1 0 0", "1 0") + "endsolid\n",
        "solid\n" + facet("0 0 0", "1 0 0", "1 0 0\nvertex 2 0 0") + "endsolid\n", std::string("solid\nendsolid\n"),
        "solid\n" + good + "endsolid\n" + good, "solid\n" + good + "endsolid a solid b\n" + good + "endsolid\n",
        "solid a " + good + good + "endsolid\n", "solid\nsolid\n" + good + "endsolid\n"})
    EXPECT_THROW(readMesh(write("b.stl", text)), BadInput) << text;
}

TEST_F(VerifyReaders, AnStlThatIsBothIsRefused) {
  // Its first line goes on over the count of a binary file, and blanks at its end make it as long as that says.
  const auto file = [](std::uint32_t count, std::size_t longer) {
    std::string text =
        "solid" + std::string(75, ' ') + little(count, 4) + "\n" + facet("0 0 0", "1 0 0", "0 1 0") + "endsolid\n";
    EXPECT_LT(text.size(), 84 + 50 * count);
    text.resize(84 + 50 * count + longer, ' ');
    return text;
  };
  EXPECT_THROW(readMesh(write("both.stl", file(4, 0))), BadInput);
  EXPECT_EQ(readMesh(write("text.stl", file(4, 1))).ends.size(), 1u);
  const std::string binary = "solid" + std::string(75, ' ') + little(1, 4) + std::string(50, '\0');
  EXPECT_EQ(readMesh(write("binary.stl", binary)).ends.size(), 1u);  // only its head says text
  EXPECT_THROW(readMesh(write("longer.stl", binary + "x")), BadInput);
  EXPECT_THROW(readMesh(write("shorter.stl", binary.substr(0, 133))), BadInput);
}

TEST_F(VerifyReaders, SurfacesAreNoSolids) {
  writeMeshes([&](const std::string& name, const std::string& text) { return write(name, text); });
  const std::string urdf = write("robot.urdf", kUrdf);
  const std::map<std::string, std::string> packages{{"elsewhere", folder_ + "/deep"}};
  const World world = readWorld(goodWorld());  // its meshes are surfaces
  Solids solids;
  EXPECT_TRUE(compareWithUrdf(world, urdf, packages, solids).differences.empty());
  solids.names = {"base",
                  "nobody"};  // the one has no mesh, the other is not there: the caller is told that none was met
  EXPECT_TRUE(compareWithUrdf(world, urdf, packages, solids).differences.empty());
  EXPECT_TRUE(compareWithUrdf(world, urdf, packages, solids).solids.empty());
  solids.names = {"hand"};
  EXPECT_FALSE(compareWithUrdf(world, urdf, packages, solids).differences.empty());
  EXPECT_EQ(compareWithUrdf(world, urdf, packages, solids).solids.size(), 1u);
  solids.names.clear();
  solids.all = true;
  EXPECT_FALSE(compareWithUrdf(world, urdf, packages, solids).differences.empty());
}

TEST_F(VerifyReaders, Obj) {
  const auto read = [&](const std::string& text) { return readMesh(write("m.obj", text)); };
  MeshFile mesh = read("v\t0 0 0\n  v 1 0 0 # one\nv 0 1 0\nf\t1 2 3\n f 3/1 -2/7/1 1//4\nl 1 2\nf 1 2\n");
  EXPECT_EQ(mesh.points, (Numbers{0, 0, 0, 1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2, 2, 1, 0}));
  // Vertices after faces, lines that go on, weights and colours, old line ends.
  mesh = read("f 1 2 3\nv 0 0 0\nv 1 \\\n 0 \\\r\n 0 1\nv 0 1 0 0.5 0.5 0.5\n");
  EXPECT_EQ(mesh.points, (Numbers{0, 0, 0, 1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(mesh.corners, (Indices{0, 1, 2}));
  EXPECT_EQ(read("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").corners, (Indices{0, 1, 2}));
  EXPECT_EQ(read("v 0 0 0\rv 1 0 0\nv 0 1 0\r\nf 1 2 3\n").corners, (Indices{0, 1, 2}));
  EXPECT_EQ(read("v 0 0 0\nv 1 0 0\nv 0 1 0\n# C:\\\nf 1 2 3 3 # \\\n").corners, (Indices{0, 1, 2, 2}));
  EXPECT_EQ(read("v 0 0 0\t#\nv 1 0 0 #\n#v\nv 0 1 0\ng a#b\nf 1 2 3 # 3\n").corners, (Indices{0, 1, 2}));
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", f = "f 1 2 3\n";
  EXPECT_NO_THROW(read(v + f));
  for (const std::string& text : {v + "f 1 2 4\n",
                                  v + "f 1 2 -4\n",
                                  v + "f 1 2 0\n",
                                  v + "f 1 2 x\n",
                                  v + "f 1 2 3x\n",
                                  v + "f\n" + f,
                                  v,
                                  v + f + "surf 0 1 0 1 1 2 3\n",
                                  v + f + "cstype bezier\n",
                                  v + f + "call other.obj\n",
                                  "v 0,5 0 0\n" + v + f,
                                  "v 0 0 1e400\n" + v + f,
                                  "v 0 0\n" + v + f,
                                  "v 0 0 0 0\n" + v + f,
                                  "v 0 0 0 2\n" + v + f,
                                  "v 0 0 0 v 1\n" + v + f,
                                  "v 0 0 0 0.1 0.1 0.1 1\n" + v + f,
                                  "v 0 0 0x1\n" + v + f,
                                  "v 0 0 1.#INF\n" + v + f,
                                  "v 0 0 -1.#IND\n" + v + f,
                                  v + "f 1 2 3#\n"})
    EXPECT_THROW(read(text), BadInput) << text;
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
  const Numbers read = readMesh(write("a.STL", bytes)).points;
  ASSERT_EQ(read.size(), 18u);
  EXPECT_EQ(read[7], static_cast<double>(0.1f));
  EXPECT_EQ(read[17], -3);
  std::string nan = std::string(80, 'x') + little(1, 4) + std::string(12, '\0') + little(0x7fc00000, 4);
  EXPECT_THROW(readMesh(write("nan.stl", nan + std::string(34, '\0'))), BadInput);
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
  EXPECT_EQ(compare(goodWorld(), ""), 2u) << "allowed, and neighbours: both are the SRDF's to name";
  EXPECT_EQ(compare(goodWorld(),
                    "<disable_collisions link1='hand' link2='base'/><disable_collisions link1='arm' link2='base'/>"),
            0u);
  const std::string g = replaced(goodWorld(), "unchecked neighbours base arm\n", "");
  EXPECT_EQ(compare(g, ""), 1u);
  EXPECT_EQ(compare(g, "<disable_collisions link1=\"hand\" link2=\"base\" reason=\"Never\"/>"), 0u);
  EXPECT_EQ(compare(g, "<disable_collisions link1=\"hand\" link2=\"arm\"/>"), 1u);
  EXPECT_EQ(compare(g, "<disable_default_collisions link=\"hand\"/>"), 0u);
  EXPECT_EQ(compare(g, "<disable_default_collisions link=\"hand\"/><enable_collisions link1=\"hand\" link2=\"base\"/>"),
            1u);
  EXPECT_THROW(compare(g + "unchecked allowed base nobody\n", ""), BadInput);
  EXPECT_THROW(compareWithSrdf(readWorld(g), write("b.srdf", "<robot")), BadInput);
}

}  // namespace readers_test
}  // namespace verify::test
