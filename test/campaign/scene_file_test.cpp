// SPDX-License-Identifier: BSD-3-Clause
#include "scene_file.h"

#include <cstdio>
#include <fstream>
#include <sstream>
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
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(path).rdbuf();
    return all.str();
  }
};

std::vector<Scene> someScenes() {
  std::vector<Scene> scenes;
  for (const std::string& family : families())
    for (const std::uint64_t seed : {20261126, 7, 39}) scenes.push_back(makeScene(family, seed));
  return scenes;
}

TEST(SceneFile, ScenesComeBackToTheLastBit) {
  const std::vector<Scene> scenes = someScenes();
  const Scratch first, second{first.path + "2"};
  writeScenes(scenes, first.path);
  const std::vector<Scene> again = readScenes(first.path);
  ASSERT_EQ(again.size(), scenes.size());
  int meshes = 0, solids = 0, allowed = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    EXPECT_EQ(describe(again[i]), describe(scenes[i]));
    EXPECT_EQ(again[i].max_contacts, scenes[i].max_contacts);
    EXPECT_EQ(again[i].allowed, scenes[i].allowed);
    allowed += !scenes[i].allowed.empty();
    ASSERT_EQ(again[i].bodies.size(), scenes[i].bodies.size());
    for (std::size_t b = 0; b < scenes[i].bodies.size(); ++b) {
      const Geometry &g = *scenes[i].bodies[b].geometry, &h = *again[i].bodies[b].geometry;
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
  writeScenes(again, second.path);
  EXPECT_TRUE(second.text() == first.text());
}

TEST(SceneFile, AFileCutShortIsRefused) {
  const Scratch whole, cut{whole.path + "cut"};
  writeScenes(someScenes(), whole.path);
  const std::string text = whole.text();
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
  EXPECT_THROW(writeScenes({}, testing::TempDir()), std::runtime_error);
}

}  // namespace
}  // namespace scene_file_test
}  // namespace campaign
