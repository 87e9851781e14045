// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <map>

#include "fcl_artic/urdf/urdf.h"
#include "temp_folder.h"

namespace fcl_artic {
namespace scene_test {
namespace {

class SceneTest : public TempFolderTest {
 protected:
  Scene load(const std::string& name, const std::string& content) { return loadScene(write(name, content)); }
  std::string errorOf(const std::string& name, const std::string& content) {
    return messageOf([&] { load(name, content); });
  }
};

template <class Geometry>
const Geometry& geometryOf(const Scene::Obstacle& obstacle) {
  const auto* geometry = dynamic_cast<const Geometry*>(obstacle.object->collisionGeometry().get());
  if (!geometry) throw std::runtime_error(obstacle.name + " is of another type");
  return *geometry;
}

void expectAt(const Scene::Obstacle& obstacle, const Eigen::Vector3d& position) {
  EXPECT_LT((obstacle.object->getTranslation() - position).norm(), 1e-12)
      << obstacle.name << " at " << obstacle.object->getTranslation().transpose();
}

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST_F(SceneTest, MeshIsOneObstacleNamedAfterItsFile) {
  const Scene scene = load("floor.obj", kTriangle);
  ASSERT_EQ(scene.obstacles.size(), 1u);
  EXPECT_EQ(scene.obstacles[0].name, "floor");
  EXPECT_EQ(geometryOf<fcl::BVHModel<fcl::OBBRSSd>>(scene.obstacles[0]).num_tris, 1);
}

TEST_F(SceneTest, PackagesOfAUrdfAreWhereTheOptionsSay) {
  write("elsewhere/post.obj", kTriangle);
  const std::string urdf = write("shop.urdf", R"(<robot name="shop"><link name="post"><collision><geometry>
<mesh filename="package://shop_meshes/post.obj"/></geometry></collision></link></robot>)");
  EXPECT_THROW(loadScene(urdf), std::runtime_error);
  SceneOptions options;
  options.packages["shop_meshes"] = path("elsewhere");
  EXPECT_EQ(loadScene(urdf, options).obstacles.size(), 1u);
}

TEST_F(SceneTest, UrdfLinksStandAtTheirZeroPose) {
  const Scene scene = load("shop.urdf", R"(<robot name="shop"><link name="floor"/>
<link name="table"><collision><origin xyz="0 0 0.5"/><geometry><box size="1 1 1"/></geometry></collision>
<collision><origin xyz="0 0 2"/><geometry><sphere radius="0.25"/></geometry></collision></link>
<joint name="j" type="prismatic"><parent link="floor"/><child link="table"/><origin xyz="3 0 0"/>
<limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>)");
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].name, "table");
  EXPECT_EQ(scene.obstacles[1].name, "table#2");
  expectAt(scene.obstacles[0], {3, 0, 0.5});
  expectAt(scene.obstacles[1], {3, 0, 2});
}

TEST_F(SceneTest, UrdfQuaternionsStandAtNoRotation) {
  const Scene scene = load("buoy.urdf", R"(<robot name="buoy"><link name="sea"/>
<link name="buoy"><collision><geometry><sphere radius="0.25"/></geometry></collision></link>
<joint name="swim" type="floating"><parent link="sea"/><child link="buoy"/><origin xyz="3 0 0"/></joint></robot>)");
  ASSERT_EQ(scene.obstacles.size(), 1u);
  expectAt(scene.obstacles[0], {3, 0, 0});
}

std::vector<std::string> namesOf(const Scene& scene) {
  std::vector<std::string> names;
  for (const Scene::Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  return names;
}

// ---- point clouds

std::string shortest(double value) {
  char text[40];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

using Points = std::vector<Eigen::Vector3d>;

/// Bytes of numbers, as a file has them.
template <class T>
void append(std::string& out, T value, bool swap = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (swap) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}
/// LZF: what came before is copied where it repeats, all else stands as it is.
std::string compress(const std::string& in) {
  std::string out;
  std::size_t literal = 0;
  const auto flush = [&](std::size_t end) {
    while (literal < end) {
      const std::size_t n = std::min<std::size_t>(32, end - literal);
      out += static_cast<char>(n - 1);
      out += in.substr(literal, n);
      literal += n;
    }
  };
  for (std::size_t i = 0; i < in.size();) {
    std::size_t best = 0, back = 0;
    for (std::size_t b = 1; b <= std::min<std::size_t>(i, 8192); ++b) {
      std::size_t n = 0;
      while (i + n < in.size() && n < 264 && in[i + n] == in[i + n - b]) ++n;
      if (n > best) best = n, back = b;
    }
    if (best < 4) {
      ++i;
      continue;
    }
    flush(i);
    const std::size_t length = best - 2, offset = back - 1;
    out += static_cast<char>((length < 7 ? length : 7) << 5 | offset >> 8);
    if (length >= 7) out += static_cast<char>(length - 7);
    out += static_cast<char>(offset & 255);
    literal = i += best;
  }
  flush(in.size());
  return out;
}

/// Files of the same three points, all with other numbers between the coordinates.
std::map<std::string, std::string> filesOf(const Points& points) {
  std::string pcd =
      "# .PCD\nVERSION 0.7\nFIELDS rgb x y normal z\nSIZE 4 4 8 4 4\nTYPE U F F F F\nCOUNT 1 1 1 3 1\nWIDTH " +
      std::to_string(points.size()) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points.size()) +
      "\nDATA ";
  std::string ascii, rows, columns, xyz = "# scan\n\n", little, big, ply_ascii;
  for (const Eigen::Vector3d& p : points) {
    const std::string x = shortest(p[0]), y = shortest(p[1]), z = shortest(p[2]);
    ascii += "255 " + x + " " + y + " 0 0 1 " + z + "\n";
    xyz += x + ", " + y + "," + z + " ,\t17\r\n";
    ply_ascii += x + " " + y + " 9 " + z + "\n";
    append(rows, std::uint32_t{255}), append(rows, static_cast<float>(p[0])), append(rows, p[1]);
    for (int k = 0; k < 3; ++k) append(rows, 1.0f);
    append(rows, static_cast<float>(p[2]));
    for (const bool swap : {false, true}) {
      std::string& out = swap ? big : little;
      append(out, p[0], swap), append(out, p[1], swap), append(out, std::uint8_t{9}),
          append(out, static_cast<float>(p[2]), swap);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) append(columns, std::uint32_t{255});
  for (const auto& p : points) append(columns, static_cast<float>(p[0]));
  for (const auto& p : points) append(columns, p[1]);
  for (std::size_t i = 0; i < 3 * points.size(); ++i) append(columns, 1.0f);
  for (const auto& p : points) append(columns, static_cast<float>(p[2]));
  std::string packed = compress(columns), sizes;
  append(sizes, static_cast<std::uint32_t>(packed.size())), append(sizes, static_cast<std::uint32_t>(columns.size()));
  const auto ply = [&](const std::string& format, const std::string& body) {
    return "ply\nformat " + format + " 1.0\ncomment a scan\nelement vertex " + std::to_string(points.size()) +
           "\nproperty double x\nproperty double y\nproperty uchar red\nproperty float z\nend_header\n" + body;
  };
  return {{"ascii.pcd", pcd + "ascii\n" + ascii},
          {"binary.pcd", pcd + "binary\n" + rows},
          {"compressed.pcd", pcd + "binary_compressed\n" + sizes + packed},
          {"lines.xyz", xyz},
          {"ascii.ply", ply("ascii", ply_ascii)},
          {"little.ply", ply("binary_little_endian", little)},
          {"big.ply", ply("binary_big_endian", big)}};
}

TEST_F(SceneTest, PointsAreReadFromEveryKindOfFile) {
  const Points points{{0.5, -1.25, 2}, {0.5, 0.0625, -3}, {1e-3f, 100, 0.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}};
  for (const auto& [name, content] : filesOf(points)) {
    SceneOptions options;
    options.point_radius = 0.01;
    const Scene scene = loadScene(write(name, content), options);
    ASSERT_EQ(scene.obstacles.size(), 1u) << name;
    const auto& cloud = geometryOf<PointCloud>(scene.obstacles[0]);
    ASSERT_EQ(cloud.points().size(), points.size()) << name;
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(cloud.points()[i], points[i]) << name << " " << i;
    EXPECT_EQ(cloud.radii(), std::vector<double>{0.01});
    const bool more = std::filesystem::path(name).extension() == ".xyz";  // numbers after the third
    EXPECT_EQ(scene.notes.size(), more) << name;
    options.scale = 0.5;
    const Scene half = loadScene(write(name, content), options);
    EXPECT_EQ(geometryOf<PointCloud>(half.obstacles[0]).points()[1], 0.5 * points[1]) << name;
    EXPECT_EQ(geometryOf<PointCloud>(half.obstacles[0]).radius(0), 0.01);
    expectContains(errorOf(name, content), "--point-radius");
  }
}

/// Wherever a file ends too early it is refused, or has no more points than it shows; nothing crashes.
TEST_F(SceneTest, PointFilesThatAreCutShortAreRefused) {
  const Points points{{0.5, -1.25, 2}, {0.5, 0.0625, -3}, {1, 100, 0.5}};
  int refused = 0, read = 0;
  for (const auto& [name, content] : filesOf(points)) {
    for (std::size_t n = 0; n < content.size(); ++n) {
      try {
        const auto cloud = loadPointCloud(write(name, content.substr(0, n)), 0.01);
        // Lines of numbers may end anywhere; elsewhere only the last digits of the last number can be missing.
        if (name != "lines.xyz") {
          EXPECT_EQ(cloud->points().size(), points.size()) << name << " " << n;
        }
        ++read;
      } catch (const std::runtime_error& e) {
        expectContains(e.what(), name);
        ++refused;
      }
    }
  }
  EXPECT_GE(refused, 1000);
  EXPECT_LE(read, 200);
}

TEST_F(SceneTest, PointsThatWereNotMeasuredAreLeftOutWithANote) {
  std::vector<std::string> notes;
  const auto cloud = loadPointCloud(write("scan.xyz", "1 2 3\nnan nan nan\n4 5 inf\n7 8 9\n"), 0.1, &notes);
  EXPECT_EQ(cloud->points().size(), 2u);
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "2 of 4 points are not finite");
  expectContains(messageOf([&] { loadPointCloud(write("none.xyz", "nan nan nan\n"), 0.1); }), "has no point");
  expectContains(messageOf([&] { loadPointCloud(write("bad.xyz", "1 2 3\n1 2 x\n"), 0.1); }), "line 2");
  expectContains(messageOf([&] { loadPointCloud(write("far.xyz", "1 2 3e12\n"), 0.1); }), "point 0");
  const std::string head = "VERSION .7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2\n";
  expectContains(messageOf([&] { loadPointCloud(write("flat.pcd", head), 0.1); }), "no field z");
  expectContains(messageOf([&] {
                   loadPointCloud(
                       write("huge.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 999999999999\nDATA binary\nabc"),
                       0.1);
                 }),
                 "999999999999");
}

TEST_F(SceneTest, APlyFileWithFacesIsAMesh) {
  SceneOptions options;
  options.point_radius = 0.01;
  const Scene scene = loadScene(write("mesh.ply",
                                      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                      "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                                options);
  EXPECT_EQ(geometryOf<fcl::BVHModel<fcl::OBBRSSd>>(scene.obstacles[0]).num_tris, 1);
}

TEST_F(SceneTest, NothingFollowsTheEndOfAScene) {
  const std::string scene = "s\n* a\n1\nsphere\n0.5\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n";
  EXPECT_EQ(load("one.scene", scene + " \n\n").obstacles.size(), 1u);
  expectContains(errorOf("two.scene", scene + scene), "two.scene': goes on after the '.' that closes a scene: 's'");
  // Two numbers without a blank between them would shift all that follows.
  expectContains(errorOf("a.scene", "s\n* a\n1\nsphere\n0.5.3\n0 0\n0 0 0 1\n0 0 0 0\n.\n"), "not a number");
}

TEST_F(SceneTest, NamesAreUtf8) {
  const std::string box = "\n1\nbox\n1 1 1\n0 0 0\n0 0 0 1\n0 0 0 0\n";
  EXPECT_EQ(loadScene(write("s.scene", "s\n* caf\xC3\xA9" + box + ".\n")).obstacles.at(0).name, "caf\xC3\xA9");
  const auto errorOf = [](const std::string& path) {
    try {
      loadScene(path);
      return std::string("is read");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
  };
  expectContains(errorOf(write("s.scene", "s\n* a" + box + "* caf\xE9" + box + ".\n")),
                 "line 9: the object's name 'caf\xE9' has bytes that are no UTF-8; save the file as UTF-8");
  expectContains(errorOf(write("caf\xE9.xyz", "0 0 0\n")), "no UTF-8; rename the file");
}

TEST_F(SceneTest, PointsThatAreTooNearAreNoted) {
  std::vector<std::string> notes;
  loadPointCloud(write("zed.xyz", "1 2 3\n-inf -inf -inf\nnan nan nan\n"), 0.1, &notes);
  ASSERT_EQ(notes.size(), 2u);
  expectContains(notes[1], "1 of these are -inf, by which some cameras mean that something is too near");
}

TEST_F(SceneTest, NamesAreGivenOnce) {
  const std::string ball = "sphere\n0.5\n0 0 0\n0 0 0 1\n0 0 0 0\n";
  const Scene scene = load("balls.scene", "s\n* a#2\n1\n" + ball + "* a\n3\n" + ball + ball + ball + ".\n");
  EXPECT_EQ(namesOf(scene), (std::vector<std::string>{"a#2", "a", "a#3", "a#4"}));
  KinematicTree tree("arm");
  tree.addLink("a");
  const Scene both = combineScenes({scene, load("floor.obj", kTriangle), load("a.obj", kTriangle)}, tree);
  EXPECT_EQ(namesOf(both), (std::vector<std::string>{"a#2", "a#3", "a#3#2", "a#4", "floor", "a#5"}));
  ASSERT_EQ(both.notes.size(), 3u);
  expectContains(both.notes[0], "obstacle 'a' is called 'a#3' here");
  // An object's name stands for all of its shapes, and not for another object that is called as one of them.
  EXPECT_EQ(scene.namesOf("a"), (std::vector<std::string>{"a", "a#3", "a#4"}));
  EXPECT_EQ(scene.namesOf("a#2"), std::vector<std::string>{"a#2"});
  EXPECT_EQ(scene.namesOf("a#4"), std::vector<std::string>{"a#4"});
  EXPECT_EQ(both.namesOf("a#3"), (std::vector<std::string>{"a#3", "a#3#2", "a#4"}));
  EXPECT_EQ(both.namesOf("a#5"), std::vector<std::string>{"a#5"});
}

TEST_F(SceneTest, IsAddedAsAWholeOrNotAtAll) {
  Scene scene = load("floor.obj", kTriangle);
  scene.obstacles.push_back({"base", load("wall.obj", kTriangle).obstacles[0].object});
  auto tree = std::make_shared<KinematicTree>("arm");
  tree->addLink("base");
  ArticulatedCollisionManager manager(tree);
  expectContains(messageOf<std::invalid_argument>([&] { scene.addTo(manager); }), "'base'");
  EXPECT_TRUE(manager.empty());
  combineScenes({scene}, *tree).addTo(manager);
  EXPECT_EQ(manager.size(), 2u);
}

TEST_F(SceneTest, MoveItTextWithoutObjectPoses) {
  const Scene scene = load("old.scene",
                           "(noname)+\n* my box\n1\nbox\n1 2 3\n0.5 0 -1\n0 0 0 1\n0 0 0 0\n"
                           "* rest\n3\nsphere\n0.5\n1 0 0\n0 0 0 1\n0 0 0 0\n"
                           "cylinder\n0.25 2\n2 0 0\n0 0 0.707107 0.707107\n1 0 0 1\n"
                           "cone\n0.125 3\n3 0 0\n0 0 0 1\n0 0 0 0\n"
                           "* mesh\n1\nmesh\n4 2\n0 0 0\n1 0 0\n0 1 0\n0 0 2\n0 1 2\n0 1 3\n0 0 0\n0 0 0 1\n0 0 0 0\n"
                           ".\n");
  ASSERT_EQ(scene.obstacles.size(), 5u);
  const auto& o = scene.obstacles;
  EXPECT_EQ(o[0].name, "my box");
  EXPECT_EQ(geometryOf<fcl::Boxd>(o[0]).side, fcl::Vector3d(1, 2, 3));
  expectAt(o[0], {0.5, 0, -1});
  EXPECT_EQ(o[1].name, "rest");
  EXPECT_EQ(geometryOf<fcl::Sphered>(o[1]).radius, 0.5);
  EXPECT_EQ(o[2].name, "rest#2");
  EXPECT_EQ(geometryOf<fcl::Cylinderd>(o[2]).radius, 0.25);
  EXPECT_EQ(geometryOf<fcl::Cylinderd>(o[2]).lz, 2);
  // The file's quaternion is a rounded one: a pose is a rotation all the same.
  const fcl::Matrix3d R = o[2].object->getRotation();
  EXPECT_LT((R.transpose() * R - fcl::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((R.col(0) - fcl::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_EQ(geometryOf<fcl::Coned>(o[3]).radius, 0.125);
  EXPECT_EQ(geometryOf<fcl::Coned>(o[3]).lz, 3);
  EXPECT_EQ(geometryOf<fcl::BVHModel<fcl::OBBRSSd>>(o[4]).num_tris, 2);
}

TEST_F(SceneTest, MoveItTextWithObjectPosesAndSubframes) {
  // The object stands at (1, 2, 3) turned by 90° about z, the shape 1 m on along the object's x.
  const Scene scene = load("new.scene",
                           "shop\n* post\n1 2 3\n0 0 0.70710678118654757 0.70710678118654757\n1\nbox\n1 1 1\n1 0 0\n"
                           "0 0 0 1\n0 0 0 0\n1\ntop\n0 0 0.5\n0 0 0 1\n"
                           "* ball\n0 0 0\n0 0 0 1\n1\nsphere\n0.5\n4 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n");
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].name, "post");
  expectAt(scene.obstacles[0], {1, 3, 3});
  expectAt(scene.obstacles[1], {4, 0, 0});
}

TEST_F(SceneTest, MoveItErrorsNameFileObjectAndReason) {
  const std::string pose = "0 0 0\n0 0 0 1\n0 0 0 0\n";
  const auto error = [&](const std::string& body) {
    const std::string message = errorOf("bad.scene", "s\n" + body);
    expectContains(message, "bad.scene'");
    return message;
  };
  expectContains(error("* a\n1\nbox\n1 1 1\n" + pose), "ends before the '.'");
  expectContains(error("* a\n2\nbox\n1 1 1\n" + pose + ".\n"), "object 'a': has a shape '.'");
  expectContains(error("* a\n1\nbox\n1 1 x\n" + pose + ".\n"), "object 'a': its box's size");
  expectContains(error("* a\n1\nbox\n1 nan 1\n" + pose + ".\n"), "object 'a': its box's size");
  expectContains(error("* a\n1\nbox\n1 0 1\n" + pose + ".\n"), "object 'a': box size 0");
  expectContains(error("* a\n1\nsphere\n-1\n" + pose + ".\n"), "object 'a': sphere radius -1");
  expectContains(error("* a\n1\noctree\n0 0 1 0\n" + pose + ".\n"), "object 'a': has a shape 'octree'");
  expectContains(error("* a\n1\nbox\n1 1 1\n0 0 0\n0 0 0 0\n0 0 0 0\n.\n"), "object 'a': has a zero quaternion");
  expectContains(error("* a\n1\nbox\n1 1 1\n0 0 0\n0 0 0 1e200\n0 0 0 0\n.\n"), "object 'a': has a quaternion that");
  expectContains(error("* a\n-1\n.\n"), "object 'a': its number of shapes");
  expectContains(error("* a\n1\nmesh\n3 1\n0 0 0\n1 0 0\n0 1 0\n0 1 3\n" + pose + ".\n"), "vertex 3 of 3");
  expectContains(error("* a\n1\nmesh\n4000000000 1\n0 0 0\n"), "object 'a': its vertex is cut short");
  expectContains(error("+ a\n"), "has '+' where an object");
  expectContains(error(""), "ends before the '.'");
  EXPECT_TRUE(load("none.scene", "s\n.\n").obstacles.empty());
}

/// An OctoMap file of 16 levels, whose root is a cube of edge 2 at the origin.
std::string octomap(const std::string& title, int nodes, const std::string& data) {
  return "# " + title + "\nid OcTree\nsize " + std::to_string(nodes) + "\nres 0.000030517578125\ndata\n" + data;
}

// Octant 0 of the root is free; 1 (x > 0, y < 0, z < 0) and 7 (all > 0) are occupied. An octant has two bits, from the
// lowest: 1 then 0 for free, 0 then 1 for occupied.
const std::string kBinary = octomap("Octomap OcTree binary file", 4, "\x09\x80");

TEST_F(SceneTest, OctoMapBinaryCellsAreBoxes) {
  const Scene scene = load("cells.bt", kBinary);
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].name, "cells");
  EXPECT_EQ(scene.obstacles[1].name, "cells#2");
  for (const auto& obstacle : scene.obstacles) {
    EXPECT_EQ(geometryOf<fcl::Boxd>(obstacle).side, fcl::Vector3d(1, 1, 1));
  }
  expectAt(scene.obstacles[0], {0.5, -0.5, -0.5});
  expectAt(scene.obstacles[1], {0.5, 0.5, 0.5});
}

/// A node of a full tree: its log-odds as a float, and which children follow.
std::string node(float log_odds, unsigned char children) {
  std::string bytes(reinterpret_cast<const char*>(&log_odds), sizeof log_odds);
  return bytes + static_cast<char>(children);
}

TEST_F(SceneTest, OctoMapFullTreeHasItsOccupiedCells) {
  const std::string data = node(1, 0x81) + node(-1, 0) + node(2, 0);  // octant 0 free, 7 occupied
  const Scene scene = load("full.ot", octomap("Octomap OcTree file", 3, data));
  ASSERT_EQ(scene.obstacles.size(), 1u);
  expectAt(scene.obstacles[0], {0.5, 0.5, 0.5});
}

TEST_F(SceneTest, OctoMapErrorsNameTheFile) {
  expectContains(errorOf("text.bt", "hello\n"), "text.bt': ");
  expectContains(errorOf("text.ot", "hello\n"), "text.ot': ");
  expectContains(errorOf("empty.bt", ""), "empty.bt': ");
  expectContains(errorOf("cut.bt", kBinary.substr(0, kBinary.size() - 1)), "cut.bt': ");
  expectContains(errorOf("header.bt", kBinary.substr(0, 40)), "header.bt': ");
  expectContains(errorOf("wrong.ot", kBinary), "wrong.ot': ");
  expectContains(errorOf("cut.ot", octomap("Octomap OcTree file", 3, node(1, 0x81) + node(-1, 0))), "cut.ot': ");
  expectContains(errorOf("deep.ot", octomap("Octomap OcTree file", 1, node(1, 0xff))), "deep.ot': ");
  expectContains(errorOf("size.bt", octomap("Octomap OcTree binary file", 5, "\x09\x80")), "4 nodes, its head says 5");
  std::string other = kBinary;
  other.replace(other.find("id OcTree"), 9, "id Other");
  expectContains(errorOf("other.bt", other), "other.bt': holds a tree of type 'Other'");
}

TEST_F(SceneTest, OctoMapHasSixteenLevels) {
  const auto chain = [](int levels) {  // each node with one child, the last a leaf
    std::string data;
    for (int k = 1; k < levels; ++k) data += std::string("\x03\0", 2);
    return octomap("Octomap OcTree binary file", levels + 1, data + std::string("\x02\0", 2));
  };
  EXPECT_EQ(load("levels.bt", chain(16)).obstacles.size(), 1u);
  expectContains(errorOf("deep.bt", chain(17)), "deep.bt': has a node below the 16 levels of an OctoMap");
  expectContains(errorOf("deeper.bt", chain(300000)), "below the 16 levels");
  std::string full;
  for (int k = 0; k < 17; ++k) full += node(1, 1);
  expectContains(errorOf("deep.ot", octomap("Octomap OcTree file", 18, full + node(1, 0))), "below the 16 levels");
}

// A file that says that it is empty, though bytes follow, would pass as free.
TEST_F(SceneTest, OctoMapHoldsWhatItsHeadSays) {
  expectContains(errorOf("none.bt", octomap("Octomap OcTree binary file", 0, "\x09\x80")),
                 "goes on after its last node");
  expectContains(errorOf("more.ot", octomap("Octomap OcTree file", 1, node(1, 0) + node(1, 0))), "goes on after");
  EXPECT_TRUE(load("none.bt", octomap("Octomap OcTree binary file", 0, "")).obstacles.empty());
}

TEST_F(SceneTest, OctoMapHeadsAreReadAsAWhole) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kBinary;
    return text.replace(text.find(from), from.size(), to);
  };
  expectContains(errorOf("mm.bt", with("125\n", "125mm\n")),
                 "a line 'res 0.000030517578125mm' in its head that OctoMap");
  expectContains(errorOf("two.bt", with("data\n", "res 2\ndata\n")), "two lines 'res' in its head");
  expectContains(errorOf("scale.bt", with("data\n", "scale 2\ndata\n")), "a line 'scale 2' in its head");
  EXPECT_EQ(load("comment.bt", with("data\n", "# scale 2\n\ndata\n")).obstacles.size(), 2u);
}

// Such a node of a binary tree says that something is known of its cells, and not what.
TEST_F(SceneTest, OctoMapNodesHaveChildrenOrAState) {
  const std::string empty = octomap("Octomap OcTree binary file", 2, std::string("\x03\0\0\0", 4));
  expectContains(errorOf("empty.bt", empty), "neither children nor a word on whether it is occupied");
  expectContains(errorOf("root.bt", octomap("Octomap OcTree binary file", 1, std::string(2, '\0'))),
                 "neither children");
}

TEST_F(SceneTest, MoveItTextWithoutObjectsIsNoted) {
  const Scene scene = load("none.scene", "(name)\n.\n");
  EXPECT_TRUE(scene.obstacles.empty());
  ASSERT_EQ(scene.notes.size(), 1u);
  expectContains(scene.notes[0], "has no object with a shape");
}

TEST_F(SceneTest, UnitsOfACommentAreNoted) {
  const Scene scene = load("cm.obj", "# File units = centimeters\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(scene.notes.size(), 1u);
  expectContains(scene.notes[0], "cm.obj': says '# File units = centimeters': lengths are taken for metres");
}

/// Whatever is missing at the end of a file is missed, at whatever byte it ends.
TEST_F(SceneTest, FilesCutShortAnywhereAreRefused) {
  const std::string v = "0 0 0\n1 0 0\n0 1 0\n", facet =
                                                     "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                                     "vertex 0 1 0\nendloop\nendfacet\n";
  const float corners[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string binary_stl(80, ' '), binary_ply;
  for (int i = 0; i < 2; ++i) {
    if (i == 0) binary_stl += std::string("\2\0\0\0", 4);
    binary_stl += std::string(reinterpret_cast<const char*>(corners), sizeof corners) + std::string(2, '\0');
  }
  const auto plyHead = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  };
  binary_ply = plyHead("binary_little_endian") +
               std::string(reinterpret_cast<const char*>(corners + 3), 9 * sizeof(float)) +
               std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  const std::string solid = "solid s\n" + facet + facet + "endsolid";
  std::string solid_binary = binary_stl;
  solid_binary.replace(0, 5, "solid");
  const struct {
    const char* name;
    std::string content;
  } files[] = {
      {"a.stl", solid},
      {"b.stl", binary_stl},
      {"c.stl", solid_binary},
      {"a.ply", plyHead("ascii") + v + "3 0 1 2"},
      {"b.ply", binary_ply},
      {"a.off", "OFF\n3 1 0\n" + v + "3 0 1 2"},
      {"a.bt", kBinary},
      {"a.ot", octomap("Octomap OcTree file", 3, node(1, 0x81) + node(-1, 0) + node(2, 0))},
      {"a.scene", "s\n* a\n1\nbox\n1 1 1\n0 0 0\n0 0 0 1\n0 0 0 0\n."},
      {"a.urdf",
       "<robot name='r'><link name='a'><collision><geometry><sphere "
       "radius='1'/></geometry></collision></link></robot>"},
  };
  for (const auto& file : files) {
    SCOPED_TRACE(file.name);
    EXPECT_FALSE(load(file.name, file.content).obstacles.empty());
    for (std::size_t size = 0; size < file.content.size(); ++size) {
      expectContains(errorOf(file.name, file.content.substr(0, size)), file.name);
    }
  }
}

/// The boxes around all obstacles, in the order of the file.
std::vector<fcl::AABBd> boxesOf(const Scene& scene) {
  std::vector<fcl::AABBd> boxes;
  for (const auto& obstacle : scene.obstacles) boxes.push_back(obstacle.object->getAABB());
  return boxes;
}

TEST_F(SceneTest, ScaleIsOfAllLengths) {
  const std::string text = write("s.scene",
                                 "(s)\n* a\n6\nbox\n1 2 3\n400 0 0\n0 0 0.6 0.8\n0 0 0 0\nsphere\n5\n1 2 3\n0 0 0 1\n"
                                 "0 0 0 0\ncylinder\n5 7\n1 2 3\n0 0 0 1\n0 0 0 0\ncone\n5 7\n1 2 3\n0 0 0 1\n0 0 0 0\n"
                                 "plane\n0 0 1 -4\n0 0 0\n0 0 0 1\n0 0 0 0\n"
                                 "mesh\n3 1\n0 0 0\n1 0 0\n0 2 0\n0 1 2\n1 2 3\n0 0 0 1\n0 0 0 0\n.\n");
  const std::string mesh = write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  const std::string robot = write("r.urdf", R"(<robot name="r"><link name="a"/><link name="b"><collision>
    <origin xyz="1 0 0"/><geometry><box size="1 2 3"/></geometry></collision></link>
    <joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 5 0"/></joint></robot>)");
  SceneOptions options;
  options.scale = 0.001;
  int compared = 0;
  for (const std::string& file : {text, mesh, robot}) {
    const Scene metres = loadScene(file), scaled = loadScene(file, options);
    const auto big = boxesOf(metres), small = boxesOf(scaled);
    ASSERT_EQ(big.size(), small.size());
    for (std::size_t i = 0; i < big.size(); ++i) {
      const auto* plane = dynamic_cast<const fcl::Planed*>(scaled.obstacles[i].object->collisionGeometry().get());
      if (plane) {
        EXPECT_NEAR(plane->d, 0.004, 1e-15);
        continue;
      }
      EXPECT_LT((0.001 * big[i].min_ - small[i].min_).norm(), 1e-9) << file << i;
      EXPECT_LT((0.001 * big[i].max_ - small[i].max_).norm(), 1e-9) << file << i;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 7);
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    options.scale = none;
    EXPECT_THROW(loadScene(mesh, options), std::invalid_argument);
  }
}

TEST_F(SceneTest, UnitsThatAreNoMetresAreNoted) {
  // Reaches 1 + 0.5 + sqrt(0.5^2 + 2 0.05^2) m.
  const Robot robot = loadUrdf(write("arm.urdf", R"(<robot name="arm"><link name="a"/><link name="b"><collision>
    <origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry></collision></link>
    <joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 1 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)"));
  const auto notesOf = [&](const std::string& size, const std::string& at) {
    return unitNotes(
        robot, loadScene(write("s.scene", "(s)\n* crate\n1\nbox\n" + size + "\n" + at + "\n0 0 0 1\n0 0 0 0\n.\n")));
  };
  EXPECT_TRUE(notesOf("1 1 1", "2.4 0 0").empty());
  EXPECT_TRUE(notesOf("100 100 0.1", "0 0 0").empty()) << "a floor";
  auto notes = notesOf("1 1 1", "2.6 0 0");
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "no obstacle can be reached: 'crate', the nearest, is 2.1 m or more");
  EXPECT_EQ(notes[0].find("scale"), std::string::npos) << notes[0];
  notes = notesOf("50 50 50", "400 0 0");
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "is 375 m or more from the robot's root, the robot reaches 2.0");
  expectContains(notes[0], "scale 0.001");
  notes = notesOf("500 500 500", "400 0 0");
  ASSERT_EQ(notes.size(), 2u);
  expectContains(notes[1], "obstacle 'crate' is 500 m long, the robot reaches 2.0");
  EXPECT_TRUE(unitNotes(robot, Scene()).empty());
}

TEST_F(SceneTest, MissingAndUnknownFilesAreNamed) {
  for (const char* name : {"none.obj", "none.urdf", "none.scene", "none.bt", "none.ot", "none"}) {
    expectContains(messageOf([&] { loadScene(path(name)); }), name);
  }
  expectContains(errorOf("scene.json", "{}"), "scene.json");
}

}  // namespace
}  // namespace scene_test
}  // namespace fcl_artic
