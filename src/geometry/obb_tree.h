// SPDX-License-Identifier: BSD-3-Clause
//
// A body's triangles under a tree of oriented boxes (Redon 2004, Section 5.1; Gottschalk, Lin, Manocha 1996): built
// once per geometry, constant, shared by threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "model/tree_view.h"

namespace fcl_artic {

/// An oriented box: the points x with |e_k . (x - c)| <= h_k for its three axes e_k. The axes are stored in single
/// precision, orthonormal but for its rounding: e_j . e_k is within 2^-21 of 0 or 1. The parallelepiped c + sum y_k e_k
/// with |y_k| <= h_k holds the triangles too. One cache line.
struct alignas(64) ObbNode {
  float axis[3][3];    ///< e_k
  float center[3];     ///< c
  float half[3];       ///< h
  std::int32_t child;  ///< left child, the right one follows it; a leaf has ~triangle, which is < 0
  bool isLeaf() const { return child < 0; }
  int triangle() const { return ~child; }
  float size() const { return std::max({half[0], half[1], half[2]}); }
};

/// A triangle by its features. A vertex or edge that triangles share is owned by one of them: whatever touches it
/// touches its owner too, so that each pair of features is looked at once.
struct ObbTriangle {
  std::int32_t vertex[3];
  std::int32_t edge[3];  ///< edge k runs from vertex k to vertex k + 1; -1: it has no length, or is there already
  std::int32_t piece;    ///< of the body's ShapeTree
  std::uint8_t owns_vertex = 0, owns_edge = 0;  ///< bit k: the k-th is this triangle's
};

struct ObbEdge {
  std::int32_t from, to;  ///< vertices
};

/// Unbounded and curved pieces have no triangles: such a body has no tree.
class ObbTree {
 public:
  /// Whether all pieces are triangles, segments or points (as degenerate triangles), or boxes, which are taken as
  /// twelve triangles each.
  static bool covers(const engine::TreeView& body);
  explicit ObbTree(const engine::TreeView& body);

  const std::vector<ObbNode>& nodes() const { return nodes_; }
  const std::vector<ObbTriangle>& triangles() const { return triangles_; }
  const std::vector<ObbEdge>& edges() const { return edges_; }
  const double* vertex(int i) const { return &vertices_[3 * static_cast<std::size_t>(i)]; }
  int numVertices() const { return static_cast<int>(vertices_.size() / 3); }

 private:
  void readFeatures(const engine::TreeView& body);
  void buildNodes();

  std::vector<ObbNode> nodes_;  ///< node 0 is the root
  std::vector<ObbTriangle> triangles_;
  std::vector<ObbEdge> edges_;
  std::vector<double> vertices_;  ///< xyz, each point once
};

}  // namespace fcl_artic
