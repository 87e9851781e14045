// SPDX-License-Identifier: BSD-3-Clause
// Whom a proof is about: the obstacles of the scene's files, all of them and no others.
#include "files.h"

namespace verify::test {
namespace scene_test {

class VerifyScene : public VerifyFiles {
 protected:
  /// "same", the first difference, or why they are not compared.
  std::string said(const std::string& world, const std::vector<std::string>& paths, const Solids& solids = {},
                   double scale = 1) {
    const World read = readWorld(world);
    try {
      const Comparison c = compareWithScenes(read, paths, {}, solids, scale);
      return c.differences.empty() ? "same" : c.differences[0];
    } catch (const BadInput& error) {
      return error.what();
    }
  }
};

const std::string kStl =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2.5 0\nendloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 7\nendloop\nendfacet\nendsolid s\n";
const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 2.5 0\nv 0 0 7\nf 1 2 3\nf 1 2 4\n";

std::string mesh(double s = 1) {
  return meshText({{0, 0, 0}, {s * 1, 0, 0}, {0, s * 2.5, 0}, {0, 0, s * 7}}, {{0, 1, 2}, {0, 1, 3}}, false);
}
std::string body(const std::string& role, const std::string& name, int frame, int geometry, const M& pose = {}) {
  return "body " + role + " " + name + " " + std::to_string(frame) + " " + std::to_string(geometry) + " " + hex(pose) +
         "\n";
}
/// A ball on a slide, and what stands in its way.
std::string world(const std::string& obstacles, const std::string& geometries) {
  return kHead + "variable j\nframe a 0 " + hex(M{}) + "\nslide " + hex(V{1, 0, 0}) + " 0 " + hex(1) + " " + hex(0) +
         "\nframe still 0 " + hex(M{}) + "\ngeometry sphere " + hex(0.1) + "\n" + geometries + body("link", "a", 1, 0) +
         obstacles;
}

TEST_F(VerifyScene, MeshesAreObstaclesOfTheirFilesName) {
  const std::string stl = write("post.stl", kStl), obj = write("Rack.OBJ", kObj);
  const std::string good = world(body("obstacle", "post", 0, 1) + body("obstacle", "Rack", 0, 1), mesh());
  EXPECT_EQ(said(good, {stl, obj}), "same");
  EXPECT_EQ(said(good, {obj, stl}), "same");
  EXPECT_NE(said(good, {stl}).find("'Rack' (body 2) is in no scene"), std::string::npos) << said(good, {stl});
  EXPECT_NE(said(good, {stl, obj, stl}).find("no obstacle of the world is 'post'"), std::string::npos);
  EXPECT_NE(said(good, {stl, write("post.ply", "")}).find("neither URDF, STL nor OBJ"), std::string::npos);
  // Another name, another place by an ulp, another frame, another role, another triangle.
  EXPECT_NE(said(world(body("obstacle", "pole", 0, 1), mesh()), {stl}), "same");
  EXPECT_NE(said(world(body("obstacle", "post", 0, 1, at(0, 1e-300, 0)), mesh()), {stl}), "same");
  EXPECT_NE(said(world(body("obstacle", "post", 2, 1), mesh()), {stl}), "same");
  EXPECT_NE(said(world(body("obstacle", "post", 1, 1), mesh()), {stl}), "same");
  EXPECT_NE(said(world(body("carried", "post", 0, 1), mesh()), {stl}), "same");
  EXPECT_NE(said(world(body("obstacle", "post", 0, 1), mesh(1 + 1e-7)), {stl}), "same");
  EXPECT_NE(said(world(body("obstacle", "post", 0, 1), "geometry sphere " + hex(1) + "\n"), {stl}), "same");
}

TEST_F(VerifyScene, ANameThatIsTakenGetsANumber) {
  const std::string one = write("1/post.stl", kStl), two = write("2/post.stl", replaced(kStl, "0 0 7", "0 0 8"));
  const std::string geometries =
      mesh() + meshText({{0, 0, 0}, {1, 0, 0}, {0, 2.5, 0}, {0, 0, 8}}, {{0, 1, 2}, {0, 1, 3}}, false);
  const auto named = [&](const std::string& first, const std::string& second) {
    return world(body("obstacle", first, 0, 1) + body("obstacle", second, 0, 2), geometries);
  };
  EXPECT_EQ(said(named("post", "post#2"), {one, two}), "same");
  EXPECT_EQ(said(named("post#2", "post#3"), {one, two}), "same");  // a link is called post
  EXPECT_EQ(said(named("post", "post#2#3"), {one, two}), "same");  // post#2 of a file, where another one is called so
  EXPECT_NE(said(named("post", "post#"), {one, two}), "same");
  const std::string numbered = write("3/post#2.stl", kStl);
  EXPECT_EQ(said(world(body("obstacle", "post#2", 0, 1), mesh()), {numbered}), "same");
  EXPECT_NE(said(world(body("obstacle", "post", 0, 1), mesh()), {numbered}), "same");
  EXPECT_NE(said(named("post", "post2"), {one, two}), "same");
  EXPECT_NE(said(named("post", "post#2x"), {one, two}), "same");
  EXPECT_NE(said(named("post", "post#2"), {one, one}), "same");
}

TEST_F(VerifyScene, AUrdfsLinksStandWithTheirJointsAtZero) {
  const std::string urdf = write("cell.urdf", R"(<robot name="cell">
<link name="floor"><collision><origin xyz="0 0 -0.05"/><geometry><box size="3 2 0.1"/></geometry></collision></link>
<link name="post"><collision><origin xyz="0.1 0 0.3" rpy="0.5 0 0"/><geometry><cylinder radius="0.1" length="1"/>
</geometry></collision></link>
<link name="lid"/>
<joint name="f" type="fixed"><parent link="floor"/><child link="post"/><origin xyz="0.7 0.2 0" rpy="0 0 0.3"/></joint>
<joint name="h" type="revolute"><parent link="post"/><child link="lid"/>
<axis xyz="0 0 1"/></joint></robot>)");
  const auto cell = [](const M& floor, const M& post) {
    return world(body("obstacle", "post", 0, 2, post) + body("obstacle", "floor", 0, 1, floor),
                 "geometry box " + hex(V{3, 2, 0.1}) + "\ngeometry cylinder " + hex(0.1) + " " + hex(1) + "\n");
  };
  M joint = rotationAbout({0, 0, 1}, 0.3), inside = rotationAbout({1, 0, 0}, 0.5);
  joint.t = {0.7, 0.2, 0};
  inside.t = {0.1, 0, 0.3};
  const M floor = at(0, 0, -0.05), post = joint * inside;
  EXPECT_EQ(said(cell(floor, post), {urdf}), "same");
  const auto moved = [](M m, double by) {
    m.t[0] += by;
    return m;
  };
  EXPECT_NE(said(cell(at(0, 0, std::nextafter(-0.05, 0.0)), post), {urdf}), "same");  // of one pose: to the bit
  EXPECT_EQ(said(cell(floor, moved(post, 1e-16)), {urdf}), "same");                   // of two: 2^-48 of 1.3 m, 4.6e-15
  EXPECT_NE(said(cell(floor, moved(post, 6e-15)), {urdf}), "same");
  EXPECT_NE(said(cell(floor, joint), {urdf}), "same");
  M turned = post;
  turned.R = (rotationAbout({0, 0, 1}, 4e-15) * post).R;
  EXPECT_NE(said(cell(floor, turned), {urdf}), "same");
  // A link that another joint moves, where that joint stands at 0; and loops.
  const std::string hinge = R"(<joint name="h" type="revolute"><parent link="post"/><child link="lid"/>
<axis xyz="0 0 1"/></joint>)",
                    mimic = R"(<joint name="h" type="revolute"><mimic joint="g" offset="0.1"/><parent link="post"/>
<child link="lid"/></joint><link name="end"/>
<joint name="g" type="revolute"><parent link="lid"/><child link="end"/></joint>)";
  const std::string follows = write("m.urdf", replaced(readFile(urdf), hinge, mimic));
  EXPECT_NE(said(cell(floor, post), {follows}).find("mimics another one with an offset"), std::string::npos);
  const std::string loop = replaced(readFile(urdf), R"(parent link="floor")", R"(parent link="lid")");
  EXPECT_NE(said(cell(floor, post), {write("l.urdf", loop)}).find("hangs on itself"), std::string::npos);
}

TEST_F(VerifyScene, LengthsAreMultipliedAndSolidsAreSolids) {
  const std::string stl = write("post.stl", kStl),
                    urdf = write("cell.urdf",
                                 "<robot name='r'><link name='b'><collision><origin xyz='300 0 0'/>"
                                 "<geometry><box size='30 20 10'/></geometry></collision></link></robot>");
  const double s = 0.001;
  const std::string small = world(body("obstacle", "post", 0, 1) + body("obstacle", "b", 0, 2, at(300 * s, 0, 0)),
                                  mesh(s) + "geometry box " + hex(V{30 * s, 20 * s, 10 * s}) + "\n");
  EXPECT_EQ(said(small, {stl, urdf}, {}, s), "same");
  EXPECT_NE(said(small, {stl, urdf}), "same");
  Solids solids;
  solids.names = {"b"};  // has no mesh
  EXPECT_EQ(said(small, {stl, urdf}, solids, s), "same");
  solids.names = {"post"};
  EXPECT_NE(said(small, {stl, urdf}, solids, s).find(", as a solid"), std::string::npos);
}

// As fcl_artic finds it: by the name that a package.xml gives, at or above the URDF, and where ROS looks.
TEST_F(VerifyScene, PackagesAreFoundAsCheckFindsThem) {
  write("ws/folder/package.xml", "<package><name> cell_description </name></package>");
  const std::string urdf =
      "<robot name='r'><link name='post'><collision><geometry><mesh "
      "filename='package://cell_description/meshes/post.stl'/></geometry></collision></link></robot>";
  const std::string path = write("ws/folder/urdf/deep/cell.urdf", urdf), away = write("away/cell.urdf", urdf);
  write("ws/folder/meshes/post.stl", kStl);
  const std::string good = world(body("obstacle", "post", 0, 1), mesh());
  EXPECT_EQ(said(good, {path}), "same");
  EXPECT_NE(said(good, {away}).find("--package cell_description=FOLDER"), std::string::npos) << said(good, {away});
  setenv("ROS_PACKAGE_PATH", ("/nowhere:" + folder_ + "/ws").c_str(), 1);
  EXPECT_EQ(said(good, {away}), "same");
  write("ws/folder/COLCON_IGNORE", "");  // within a package: it is one
  EXPECT_EQ(said(good, {away}), "same");
  write("ws/COLCON_IGNORE", "");
  EXPECT_NE(said(good, {away}), "same");
  unsetenv("ROS_PACKAGE_PATH");
  write("prefix/share/cell_description/meshes/post.stl", kStl);
  setenv("AMENT_PREFIX_PATH", (folder_ + "/prefix").c_str(), 1);
  EXPECT_EQ(said(good, {away}), "same");
  unsetenv("AMENT_PREFIX_PATH");
  const Comparison given = compareWithScenes(readWorld(good), {away}, {{"cell_description", folder_ + "/ws/folder"}});
  EXPECT_TRUE(given.differences.empty());
}

TEST_F(VerifyScene, TheRobotsRootStandsWhereTheBaseSays) {
  const std::string urdf = write("r.urdf",
                                 "<robot name='r'><link name='a'><collision><geometry><sphere radius='0.5'/>"
                                 "</geometry></collision></link></robot>");
  const auto base = [&](const M& above, const M& root, const std::string& text) {
    const World read = readWorld(kHead + "frame world 0 " + hex(above) + "\nframe a 1 " + hex(root) +
                                 "\ngeometry sphere " + hex(0.5) + "\n" + body("link", "a", 2, 0));
    std::vector<double> six;
    if (!text.empty()) six = readBase(text);
    const Comparison c = compareWithUrdf(read, urdf, {}, {}, six);
    return c.differences.empty() ? "same" : c.differences[0];
  };
  M turned = rotationAbout({0, 0, 1}, 2 * std::atan(1.0));
  turned.t = {0.1, 0.2, 0.3};
  EXPECT_EQ(base({}, {}, "0,0,0"), "same");
  EXPECT_EQ(base({}, turned, "0.1,0.2,0.3,0,0,90deg"), "same");
  EXPECT_EQ(base({}, turned, ""), "same");  // and a note says where it stands
  EXPECT_NE(base({}, turned, "0,0,0"), "same");
  EXPECT_NE(base({}, turned, "0.1,0.2,0.3"), "same");
  EXPECT_NE(base(turned, {}, "0,0,0"), "same");
  EXPECT_NE(base({}, {}, "0.1,0.2,0.3"), "same");
  EXPECT_THROW(readBase("1,2"), BadInput);
  EXPECT_THROW(readBase("1,2deg,3"), BadInput);
}

}  // namespace scene_test
}  // namespace verify::test
