// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh's tree is found again for the same bytes, and for no others: what was asked before never shows in an answer.
#include "fcl/mesh_cache.h"

#include <cstring>
#include <new>
#include <random>
#include <thread>

#include <fcl/geometry/bvh/BVH_model.h>
#include <gtest/gtest.h>

#include "fcl/fcl_geometry.h"

namespace mesh_cache_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

template <class S>
using Model = fcl::BVHModel<fcl::OBBRSS<S>>;

template <class S>
void fill(Model<S>& model, unsigned seed, std::size_t n = 12) {
  std::mt19937 random(seed);
  std::vector<fcl::Vector3<S>> vertices;
  for (std::size_t i = 0; i < n; ++i) {
    vertices.emplace_back(S(random() % 1000) / 1000, S(random() % 1000) / 1000, S(random() % 1000) / 1000);
  }
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i + 2 < n; ++i) triangles.emplace_back(i, i + 1, i + 2);
  model.beginModel();
  model.addSubModel(vertices, triangles);
  model.endModel();
}

/// Whether the tree's triangles are the model's.
template <class S>
bool shows(const ShapeTree& tree, const Model<S>& model) {
  if (tree.view().num_pieces != model.num_tris) return false;
  for (int i = 0; i < model.num_tris; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double* v = tree.view().vertices + 3 * (tree.view().pieces[i].first_vertex + k);
      if (Vector3d::Map(v) != model.vertices[model.tri_indices[i][k]].template cast<double>()) return false;
    }
  }
  return true;
}

struct Blob {
  std::vector<double> vertices;
  std::vector<std::size_t> triangles;
  MeshBytes bytes() const {
    return {this, vertices.data(), triangles.data(), vertices.size() * 8, triangles.size() * 8, 8};
  }
};

}  // namespace

TEST(MeshCache, SameMeshSameTree) {
  Model<double> model;
  fill(model, 1);
  const auto tree = cachedGeometry(model);
  EXPECT_TRUE(shows(*tree, model));
  EXPECT_EQ(cachedGeometry(model), tree);
  EXPECT_NE(readGeometry(model), tree);
}

// A solid and a surface of the same bytes, one after the other in the same place, are two.
TEST(MeshCache, SolidsAreNoSurfaces) {
  Blob blob;
  blob.vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  blob.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  MeshCache cache(1 << 20);
  MeshBytes bytes = blob.bytes();
  const auto tree = ShapeTree::fromTriangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                             {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, true);
  bytes.solid = true;
  cache.keep(bytes, tree);
  EXPECT_EQ(cache.find(bytes), tree);
  bytes.solid = false;
  EXPECT_EQ(cache.find(bytes), nullptr);
}

TEST(MeshCache, SeesWhatChangesInPlace) {
  Model<double> model;
  fill(model, 2);
  auto last = cachedGeometry(model);
  for (int i = 0; i < model.num_vertices; ++i) {  // one bit of one coordinate
    double& x = model.vertices[i][i % 3];
    x = std::nextafter(x, 2);
    const auto tree = cachedGeometry(model);
    EXPECT_NE(tree, last);
    EXPECT_TRUE(shows(*tree, model));
    last = tree;
  }
  for (int i = 0; i < model.num_tris; ++i) {
    std::swap(model.tri_indices[i][0], model.tri_indices[i][2]);
    const auto tree = cachedGeometry(model);
    EXPECT_NE(tree, last);
    EXPECT_TRUE(shows(*tree, model));
    last = tree;
  }
  --model.num_tris;  // less of the same
  EXPECT_TRUE(shows(*cachedGeometry(model), model));
  ++model.num_tris;
  EXPECT_TRUE(shows(*cachedGeometry(model), model));
  // Bad from now on, whatever was good before.
  model.vertices[0][0] = NAN;
  EXPECT_THROW(cachedGeometry(model), std::invalid_argument);
}

TEST(MeshCache, SeesARecycledAddress) {
  alignas(64) unsigned char place[sizeof(Model<double>) + sizeof(Model<float>)];
  std::shared_ptr<const ShapeTree> last;
  for (unsigned seed = 0; seed < 20; ++seed) {
    auto* model = new (place) Model<double>;
    fill(*model, seed % 3);
    const auto tree = cachedGeometry(*model);
    EXPECT_TRUE(shows(*tree, *model));
    model->~Model<double>();
    auto* in_float = new (place) Model<float>;
    fill(*in_float, seed);
    EXPECT_TRUE(shows(*cachedGeometry(*in_float), *in_float));
    in_float->~Model<float>();
  }
}

// The same bytes mean other numbers in float.
TEST(MeshCache, TellsFloatFromDouble) {
  MeshCache cache(1 << 20);
  const Blob blob{std::vector<double>(36, 0.5), std::vector<std::size_t>(9, 1)};
  cache.keep(blob.bytes(), ShapeTree::fromPieces({}));
  EXPECT_NE(cache.find(blob.bytes()), nullptr);
  MeshBytes in_float = blob.bytes();
  in_float.scalar_bytes = 4;
  EXPECT_EQ(cache.find(in_float), nullptr);
}

TEST(MeshCache, KeepsWhatIsUsedWithinItsBounds) {
  constexpr std::size_t kMost = 1 << 20;
  MeshCache cache(kMost);
  std::vector<Blob> blobs(200);
  for (std::size_t i = 0; i < blobs.size(); ++i) {
    blobs[i] = {std::vector<double>(1000, static_cast<double>(i)), std::vector<std::size_t>(300, i)};
    cache.keep(blobs[i].bytes(), ShapeTree::fromPieces({}));
    EXPECT_LE(cache.bytes(), kMost);
    EXPECT_NE(cache.find(blobs[i].bytes()), nullptr);
    EXPECT_NE(cache.find(blobs[0].bytes()), nullptr) << "asked for all the time, dropped after " << i;
  }
  EXPECT_EQ(cache.find(blobs[1].bytes()), nullptr);
  std::size_t kept = 0;
  for (const Blob& blob : blobs) kept += cache.find(blob.bytes()) != nullptr;
  EXPECT_GT(kept, kMost / 2 / 12000);
  // Again in the same place: counted once.
  const std::size_t bytes = cache.bytes();
  for (int i = 0; i < 1000; ++i) cache.keep(blobs[199].bytes(), ShapeTree::fromPieces({}));
  EXPECT_EQ(cache.bytes(), bytes);
  // Larger than all of it: not kept, and nothing is dropped for it.
  const Blob large{std::vector<double>(kMost, 1.0), std::vector<std::size_t>(3, 0)};
  cache.keep(large.bytes(), ShapeTree::fromPieces({}));
  EXPECT_EQ(cache.find(large.bytes()), nullptr);
  EXPECT_EQ(cache.bytes(), bytes);
}

TEST(MeshCache, EightThreads) {
  std::vector<std::unique_ptr<Model<double>>> shared;
  for (unsigned i = 0; i < 6; ++i) {
    shared.push_back(std::make_unique<Model<double>>());
    fill(*shared.back(), i, 20 + i);
  }
  std::vector<int> wrong(8, 0);
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      std::mt19937 random(t);
      Model<double> own;
      fill(own, t);
      for (int i = 0; i < 500; ++i) {
        const Model<double>& model = *shared[random() % shared.size()];
        wrong[t] += !shows(*cachedGeometry(model), model);
        own.vertices[random() % 12][random() % 3] = 1e-3 * static_cast<double>(random() % 3);
        wrong[t] += !shows(*cachedGeometry(own), own);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int n : wrong) EXPECT_EQ(n, 0);
}

}  // namespace mesh_cache_test
