// SPDX-License-Identifier: BSD-3-Clause
#include "scene_file.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "generator.h"

namespace campaign {
namespace scene_file_test {
namespace {

/// A file of the test's own, which goes with it.
struct Scratch {
  std::string path =
      testing::TempDir() + "scenes_" + testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt";
  ~Scratch() { std::remove(path.c_str()); }
};

std::vector<Scene> someScenes() {
  std::vector<Scene> scenes;
  for (const std::string& family : families())
    for (const std::uint64_t seed : {20261126, 7, 39}) scenes.push_back(makeScene(family, seed));
  return scenes;
}

bool same(const Pose& a, const Pose& b) {
  return a.R == b.R && a.p == b.p;
}

bool same(const Link& a, const Link& b) {
  return a.parent == b.parent && a.joint == b.joint && same(a.origin, b.origin) && a.axis == b.axis &&
         a.master == b.master && a.multiplier == b.multiplier && a.offset == b.offset;
}

/// But for the bodies.
bool same(const Scene& a, const Scene& b) {
  return a.family == b.family && a.seed == b.seed && a.q0 == b.q0 && a.q1 == b.q1 && a.allowed == b.allowed &&
         a.tolerance_time == b.tolerance_time && a.tolerance_distance == b.tolerance_distance && a.margin == b.margin &&
         a.check_scene == b.check_scene && a.check_self == b.check_self && a.every_pair == b.every_pair &&
         a.shortest == b.shortest && a.max_contacts == b.max_contacts &&
         std::equal(a.links.begin(), a.links.end(), b.links.begin(), b.links.end(),
                    [](const Link& x, const Link& y) { return same(x, y); });
}

TEST(SceneFile, ScenesComeBackToTheLastBit) {
  const std::vector<Scene> scenes = someScenes();
  const Scratch first;
  writeFile(toText(scenes) + "# remarks\n", first.path);
  const std::vector<Scene> again = readScenes(first.path);
  ASSERT_EQ(again.size(), scenes.size());
  int meshes = 0, solids = 0, allowed = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    EXPECT_TRUE(same(again[i], scenes[i])) << i;
    allowed += !scenes[i].allowed.empty();
    ASSERT_EQ(again[i].bodies.size(), scenes[i].bodies.size());
    for (std::size_t b = 0; b < scenes[i].bodies.size(); ++b) {
      const Geometry &g = *scenes[i].bodies[b].geometry, &h = *again[i].bodies[b].geometry;
      EXPECT_EQ(again[i].bodies[b].link, scenes[i].bodies[b].link);
      EXPECT_TRUE(same(again[i].bodies[b].pose, scenes[i].bodies[b].pose));
      EXPECT_EQ(h.kind(), g.kind());
      EXPECT_EQ(h.half(), g.half());
      EXPECT_EQ(h.volume(), g.volume());
      EXPECT_EQ(h.vertices(), g.vertices());
      EXPECT_EQ(h.triangles(), g.triangles());
      EXPECT_EQ(h.fclGeometry()->getNodeType(), g.fclGeometry()->getNodeType());
      (g.isMesh() ? meshes : solids) += 1;
    }
  }
  EXPECT_GT(meshes, 10);
  EXPECT_GT(solids, 10);
  EXPECT_GT(allowed, 0);
  EXPECT_TRUE(toText(again) == toText(scenes));
}

TEST(SceneFile, AFileCutShortIsRefused) {
  const Scratch cut;
  const std::string text = toText(someScenes());
  int refused = 0, tried = 0;
  for (const double part : {0.0, 0.0001, 0.01, 0.2, 0.5, 0.9}) {
    std::ofstream(cut.path) << text.substr(0, static_cast<std::size_t>(part * static_cast<double>(text.size())));
    ++tried;
    try {
      readScenes(cut.path);
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_EQ(refused, tried);
  EXPECT_THROW(readScenes(cut.path + ".not"), std::runtime_error);
  EXPECT_THROW(writeFile(text, testing::TempDir()), std::runtime_error);
}

}  // namespace
}  // namespace scene_file_test
}  // namespace campaign
