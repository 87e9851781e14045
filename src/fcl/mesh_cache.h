// SPDX-License-Identifier: BSD-3-Clause
//
// Trees of meshes met before, for queries that have no place of their own to keep them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <unordered_map>

#include "geometry/shape_tree.h"

namespace fcl_artic {

/// All that a mesh's tree is made from, where the caller keeps it.
struct MeshBytes {
  const void* mesh = nullptr;  ///< its address, to look it up by
  const void* vertices = nullptr;
  const void* triangles = nullptr;
  std::size_t vertex_bytes = 0, triangle_bytes = 0;
  std::size_t scalar_bytes = 0;  ///< of a coordinate
  bool solid = false;            ///< SolidMesh
};

/// A tree is found when vertices and triangles are, byte for byte, those that it was built from. So the answer of a
/// query never depends on what was asked before, whether a mesh was changed in place or its address given to another
/// one. For threads: all may use one cache at once.
class MeshCache {
 public:
  /// @param most_bytes  of the trees and the copies kept beside them; those used longest ago go first.
  explicit MeshCache(std::size_t most_bytes) : most_bytes_(most_bytes) {}
  /// The tree of just these bytes; null when it is not here.
  std::shared_ptr<const ShapeTree> find(const MeshBytes& mesh) const;
  /// Keeps the tree instead of what was kept for that address; not when it is too large for the cache.
  void keep(const MeshBytes& mesh, std::shared_ptr<const ShapeTree> tree);

  std::size_t bytes() const;

 private:
  struct Entry;
  void makeRoom();
  const std::size_t most_bytes_;
  mutable std::shared_mutex mutex_;
  mutable std::atomic<std::uint64_t> clock_{0};
  std::unordered_map<const void*, std::shared_ptr<const Entry>> entries_;
  std::size_t bytes_ = 0;
};

}  // namespace fcl_artic
