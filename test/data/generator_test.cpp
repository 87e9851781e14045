// SPDX-License-Identifier: BSD-3-Clause
#include "generator.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

namespace fcl_artic::generator {
namespace generator_test {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A folder that goes with the test.
class Scratch {
 public:
  Scratch() : path_(fs::path(::testing::TempDir()) / fs::path(test())) { fs::create_directories(path_); }
  ~Scratch() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  static std::string test() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    return std::string("fcl_artic_") + info->test_suite_name() + "_" + info->name();
  }
  fs::path path_;
};

/// Every edge is run through once each way, no triangle is degenerate, and the outside is outside.
void expectClosed(const Mesh& mesh, const std::string& what) {
  std::map<std::pair<int, int>, int> times;
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.vertices.at(static_cast<std::size_t>(t[0])),
               &b = mesh.vertices.at(static_cast<std::size_t>(t[1])),
               &c = mesh.vertices.at(static_cast<std::size_t>(t[2]));
    EXPECT_GT((b - a).cross(c - a).norm(), 0) << what;
    volume += a.dot(b.cross(c)) / 6;
    for (int k = 0; k < 3; ++k) ++times[{t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>((k + 1) % 3)]}];
  }
  int open = 0;
  for (const auto& [edge, n] : times) {
    const auto back = times.find({edge.second, edge.first});
    if (n != 1 || back == times.end() || back->second != 1) ++open;
  }
  EXPECT_EQ(open, 0) << what;
  EXPECT_GT(volume, 0) << what;
}

TEST(BundledData, PumaIsWhatTheGeneratorWrites) {
  const Scratch scratch;
  const fs::path bundled = fs::path(FCL_ARTIC_BUNDLED_DATA) / "puma560";
  writePuma560(scratch.path().string());
  int files = 0, bundled_files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(scratch.path())) {
    if (!entry.is_regular_file()) continue;
    const fs::path name = fs::relative(entry.path(), scratch.path());
    EXPECT_EQ(contents(entry.path()), contents(bundled / name)) << name << ": generate it again and check it in";
    ++files;
  }
  for (const auto& entry : fs::recursive_directory_iterator(bundled)) bundled_files += entry.is_regular_file();
  EXPECT_EQ(files, 8);  // URDF and seven links
  EXPECT_EQ(bundled_files, files);
}

TEST(BundledData, PipesAreWhatTheGeneratorWrites) {
  const Scratch scratch;
  const fs::path made = scratch.path() / "pipes.obj";
  writePipes(10000, 2, made.string());
  EXPECT_EQ(contents(made), contents(fs::path(FCL_ARTIC_BUNDLED_DATA) / "pipes.obj"));
}

TEST(Puma560, LinksAreClosedAndOfModestSize) {
  for (const NamedMesh& m : puma560Meshes()) {
    expectClosed(m.mesh, m.link);
    EXPECT_GE(m.mesh.triangles.size(), 200u) << m.link;
    EXPECT_LE(m.mesh.triangles.size(), 2000u) << m.link;
  }
}

TEST(Pipes, SizeIsMetWithinOnePercent) {
  for (const std::size_t wanted : {1000u, 1700u, 3000u, 10000u, 29999u, 100000u, 300000u, 1000000u}) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const double made = static_cast<double>(pipes(wanted, seed).triangles.size());
      EXPECT_NEAR(made / static_cast<double>(wanted), 1, 0.01) << "seed " << seed;
    }
  }
}

TEST(Pipes, AreClosedAndLeaveTheMiddleFree) {
  for (const std::size_t wanted : {1000u, 10000u, 100000u}) {
    const Mesh mesh = pipes(wanted, 7);
    expectClosed(mesh, std::to_string(wanted));
    Eigen::AlignedBox3d box;
    double nearest = 1e9;
    for (const auto& v : mesh.vertices) {
      box.extend(v);
      nearest = std::min(nearest, v.head<2>().norm());
    }
    EXPECT_GT(nearest, 0.5);
    EXPECT_TRUE(Eigen::AlignedBox3d(Eigen::Vector3d(-1.2, -1.2, 0), Eigen::Vector3d(1.2, 1.2, 1.6)).contains(box));
  }
}

TEST(Pipes, SeparatePipesAreClosedAndMakeUpTheScene) {
  const Mesh all = pipes(10000, 2);
  const std::vector<Mesh> separate = separatePipes(10000, 2);
  EXPECT_GT(separate.size(), 5u);
  std::size_t vertex = 0, triangle = 0;
  for (const Mesh& pipe : separate) {
    expectClosed(pipe, "a pipe");
    ASSERT_LE(vertex + pipe.vertices.size(), all.vertices.size());
    ASSERT_LE(triangle + pipe.triangles.size(), all.triangles.size());
    const int first = static_cast<int>(vertex);
    for (const auto& v : pipe.vertices) EXPECT_EQ(v, all.vertices[vertex++]);
    for (const auto& t : pipe.triangles) {
      EXPECT_EQ((std::array<int, 3>{first + t[0], first + t[1], first + t[2]}), all.triangles[triangle++]);
    }
  }
  EXPECT_EQ(vertex, all.vertices.size());
  EXPECT_EQ(triangle, all.triangles.size());
}

TEST(Pipes, SameSeedSameSceneOtherSeedAnotherScene) {
  const Mesh a = pipes(2000, 5), b = pipes(2000, 5), c = pipes(2000, 6);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_NE(a.vertices, c.vertices);
}

TEST(Pipes, FileHoldsTheDoublesOfTheMesh) {
  const Scratch scratch;
  const std::string path = (scratch.path() / "pipes.obj").string();
  writePipes(1000, 3, path);
  const Mesh mesh = pipes(1000, 3);
  std::ifstream file(path);
  std::vector<Eigen::Vector3d> vertices;
  std::size_t faces = 0;
  for (std::string line; std::getline(file, line);) {
    Eigen::Vector3d v;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &v[0], &v[1], &v[2]) == 3) vertices.push_back(v);
    faces += line.rfind("f ", 0) == 0;
  }
  EXPECT_EQ(vertices, mesh.vertices);
  EXPECT_EQ(faces, mesh.triangles.size());
}

TEST(Pipes, SizesOutOfRangeAreRefusedByName) {
  for (const std::size_t size : {std::size_t{0}, kMinPipeTriangles - 1, kMaxPipeTriangles + 1}) {
    try {
      pipes(size, 1);
      ADD_FAILURE() << size << " was accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(std::to_string(size)), std::string::npos) << e.what();
    }
  }
}

TEST(Generator, UnwritablePlacesAreNamed) {
  const Scratch scratch;
  const std::string file = (scratch.path() / "file").string();
  std::ofstream(file) << "not a folder";
  for (const bool puma : {false, true}) {
    try {
      if (puma) {
        writePuma560(file);
      } else {
        writePipes(1000, 1, file + "/pipes.obj");
      }
      ADD_FAILURE() << "nothing thrown, puma = " << puma;
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace generator_test
}  // namespace fcl_artic::generator
