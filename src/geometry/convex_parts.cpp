// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/convex_parts.h"

#include "geometry/outer_hull.h"
#include "model/tree_view.h"

namespace fcl_artic {
namespace {

using engine::Node;
using engine::PieceKind;

/// A node gets a hull, of at most kVertices vertices, if its depth is at most kDepth and its number of triangles
/// between kFewestTriangles and kMaxTriangles. Measured on the UR5's free motions: depth 4 takes 1.2 times as long, 32
/// vertices 1.7 times; larger numbers of triangles gain nothing and take twice as long to build.
constexpr int kDepth = 5;
constexpr int kFewestTriangles = 24, kMaxTriangles = 2048;
constexpr std::size_t kVertices = 64;

/// Adds the corners of all triangles below a node. @return their number.
int gather(const engine::TreeView& tree, int node, std::vector<Eigen::Vector3d>& points) {
  const Node& n = tree.nodes[node];
  if (!n.isLeaf()) return gather(tree, n.left(), points) + gather(tree, n.right(), points);
  const engine::Piece& triangle = tree.pieces[n.piece()];
  const double* v = tree.vertices + 3 * static_cast<std::ptrdiff_t>(triangle.first_vertex);
  for (int k = 0; k < triangle.num_vertices; ++k) points.push_back(Eigen::Vector3d::Map(v + 3 * k));
  return 1;
}

}  // namespace

ConvexParts::ConvexParts(const engine::TreeView& whole) : view_(whole) {
  if (!whole.outer || whole.outer->kind != PieceKind::hull || whole.pieces[0].kind != PieceKind::vertices) return;
  std::vector<Eigen::Vector3d> points;
  // The whole's hull comes first, as it does in `whole`.
  const int n = whole.outer->num_vertices;
  points.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) points.emplace_back(whole.hulls[i], whole.hulls[n + i], whole.hulls[2 * n + i]);
  hulls_.add(points, whole.outer->radius);
  part_of_node_.assign(static_cast<std::size_t>(whole.num_nodes), -1);
  std::vector<int> level = {0}, next;
  for (int depth = 1; depth <= kDepth; ++depth) {
    next.clear();
    for (const int parent : level) {
      if (whole.nodes[parent].isLeaf()) continue;
      for (const int node : {whole.nodes[parent].left(), whole.nodes[parent].right()}) {
        points.clear();
        const int triangles = gather(whole, node, points);
        if (triangles < kFewestTriangles) continue;
        next.push_back(node);
        if (triangles > kMaxTriangles) continue;
        const OuterHull hull = makeOuterHull(points, kVertices, kVertices);
        if (hull.vertices.empty()) continue;
        part_of_node_[static_cast<std::size_t>(node)] = static_cast<std::int16_t>(parts_.size());
        parts_.push_back(hulls_.add(hull.vertices, hull.radius));
      }
    }
    level.swap(next);
  }
  if (parts_.empty()) return;
  view_.parts = parts_.data();
  view_.part_of_node = part_of_node_.data();
  view_.hulls = hulls_.data();
}

}  // namespace fcl_artic
