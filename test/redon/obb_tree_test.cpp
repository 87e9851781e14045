// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "fcl/fcl_geometry.h"
#include "generator.h"
#include "geometry/obb_tree.h"
#include "geometry/shape_tree.h"
#include "meshes.h"

namespace obb_tree_test {

namespace {

using Eigen::Vector3d;
using fcl_artic::ObbNode;
using fcl_artic::ObbTree;
using fcl_artic::ObbTriangle;

/// As slabs and as a sum along the stored axes, which are orthonormal to single precision only.
bool holds(const ObbNode& node, const Vector3d& x) {
  Eigen::Matrix3d e;
  for (int k = 0; k < 3; ++k) e.row(k) = Vector3d(node.axis[k][0], node.axis[k][1], node.axis[k][2]);
  const Vector3d d = x - Vector3d(node.center[0], node.center[1], node.center[2]);
  const Vector3d h(node.half[0], node.half[1], node.half[2]);
  const Vector3d slabs = (e * d).cwiseAbs(), sum = e.transpose().inverse() * d;
  return (slabs.array() <= h.array()).all() && (sum.cwiseAbs().array() <= h.array()).all();
}

TEST(ObbTree, EveryNodeHoldsItsTrianglesAndEveryLeafIsReachedOnce) {
  std::size_t checked = 0;
  for (const campaign::GeometryPtr& geometry : campaign::MeshLibrary::instance().all()) {
    const auto shape = fcl_artic::readGeometry(*geometry->fclGeometry());
    const ObbTree* tree = shape->obbTree();
    ASSERT_NE(tree, nullptr);
    ASSERT_EQ(tree, shape->obbTree()) << "made twice";
    std::multiset<int> reached;
    // Nodes come before their children: the triangles below each.
    std::vector<std::vector<int>> below(tree->nodes().size());
    for (std::size_t i = tree->nodes().size(); i-- > 0;) {
      const ObbNode& node = tree->nodes()[i];
      if (node.isLeaf()) {
        below[i] = {node.triangle()};
        reached.insert(node.triangle());
      } else {
        for (const int child : {node.child, node.child + 1}) {
          ASSERT_GT(static_cast<std::size_t>(child), i);
          const auto& more = below[static_cast<std::size_t>(child)];
          below[i].insert(below[i].end(), more.begin(), more.end());
        }
      }
      for (const int t : below[i]) {
        for (const int v : tree->triangles()[static_cast<std::size_t>(t)].vertex) {
          ASSERT_TRUE(holds(node, Vector3d::Map(tree->vertex(v))));
          ++checked;
        }
      }
    }
    EXPECT_EQ(reached.size(), tree->triangles().size());
    EXPECT_EQ(std::set<int>(reached.begin(), reached.end()).size(), reached.size());
  }
  EXPECT_GT(checked, 10000u);
}

/// The axes as stored: what the test of two boxes takes for granted.
double defect(const ObbNode& node) {
  Eigen::Matrix3d e;
  for (int k = 0; k < 3; ++k) e.row(k) = Vector3d(node.axis[k][0], node.axis[k][1], node.axis[k][2]);
  return (e * e.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

/// Triangles whose corners are in a line but for rounding, of all sizes: their normals are residues, which may lie
/// along the longest edge or vanish.
TEST(ObbTree, AxesOfSliversAreOrthonormal) {
  const Vector3d known[3] = {{0.42, 0.42, 2.5113867187499998e-20},
                             {0.099999999999999895, 0.1, 5.9794921875000005e-21},
                             {0.57999999999999996, 0.57999999999999996, 3.4681054687499995e-20}};
  std::mt19937_64 random(7);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    Vector3d v[3];
    const double size = n % 4 ? 1 : std::pow(10, uniform(-320, 8));
    const Vector3d along(uniform(-1, 1), n % 3 ? 1 : uniform(-1, 1), n % 5 ? 0 : 6.123e-17);
    for (int k = 0; k < 3; ++k) {
      v[k] = n == 0 ? known[k] : Vector3d(size * std::round(100 * uniform(-1, 1)) / 100 * along);
      if (n > 0 && n % 2) v[k][2] += size * 1e-21 * std::round(uniform(-2, 2));
    }
    const auto shape = fcl_artic::readGeometry(*redon_test::triangle(v[0], v[1], v[2]));
    for (const ObbNode& node : shape->obbTree()->nodes()) {
      worst = std::max(worst, defect(node));
      for (const Vector3d& x : v) ASSERT_TRUE(holds(node, x)) << n;
    }
  }
  EXPECT_LE(worst, 0x1p-21);
}

TEST(ObbTree, EveryFeatureHasOneOwner) {
  const auto shape = fcl_artic::readGeometry(*redon_test::boxMesh(1, 2, 3));
  const ObbTree& tree = *shape->obbTree();
  EXPECT_EQ(tree.numVertices(), 8);
  EXPECT_EQ(tree.edges().size(), 18u);  // 12 and a diagonal per side
  std::map<int, int> vertex_owners, edge_owners;
  for (const ObbTriangle& t : tree.triangles()) {
    for (int k = 0; k < 3; ++k) {
      vertex_owners[t.vertex[k]] += t.owns_vertex >> k & 1;
      edge_owners[t.edge[k]] += t.owns_edge >> k & 1;
    }
  }
  EXPECT_EQ(vertex_owners.size(), 8u);
  for (const auto& [v, owners] : vertex_owners) EXPECT_EQ(owners, 1) << "vertex " << v;
  EXPECT_EQ(edge_owners.size(), 18u);
  for (const auto& [e, owners] : edge_owners) EXPECT_EQ(owners, 1) << "edge " << e;
}

TEST(ObbTree, BoxesAreTwelveTrianglesAndCurvedShapesHaveNone) {
  const auto box = fcl_artic::readGeometry(fcl::Boxd(0.2, 0.4, 0.6));
  ASSERT_NE(box->obbTree(), nullptr);
  EXPECT_EQ(box->obbTree()->triangles().size(), 12u);
  EXPECT_EQ(box->obbTree()->numVertices(), 8);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(Vector3d::Map(box->obbTree()->vertex(i)).cwiseAbs(), Vector3d(0.1, 0.2, 0.3));
  }
  EXPECT_EQ(fcl_artic::readGeometry(fcl::Sphered(1))->obbTree(), nullptr);
  EXPECT_EQ(fcl_artic::readGeometry(fcl::Cylinderd(1, 2))->obbTree(), nullptr);
  EXPECT_EQ(fcl_artic::readGeometry(fcl::Planed(Vector3d::UnitZ(), 0))->obbTree(), nullptr);
}

TEST(ObbTree, ZeroLengthEdgesAreLeftOut) {
  const Vector3d a(0, 0, 0), b(1, 0, 0);
  const auto segment = fcl_artic::readGeometry(*redon_test::triangle(a, b, b));
  ASSERT_NE(segment->obbTree(), nullptr);
  EXPECT_EQ(segment->obbTree()->numVertices(), 2);
  EXPECT_EQ(segment->obbTree()->edges().size(), 1u);
}

}  // namespace

}  // namespace obb_tree_test
