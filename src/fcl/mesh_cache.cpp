// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/mesh_cache.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <vector>

namespace fcl_artic {

struct MeshCache::Entry {
  std::size_t vertex_bytes, triangle_bytes, scalar_bytes;
  bool solid;
  std::unique_ptr<char[]> copy;  ///< vertices, then triangles
  std::shared_ptr<const ShapeTree> tree;
  std::size_t bytes;
  mutable std::atomic<std::uint64_t> used;

  bool sameAs(const MeshBytes& mesh) const {
    return vertex_bytes == mesh.vertex_bytes && triangle_bytes == mesh.triangle_bytes &&
           scalar_bytes == mesh.scalar_bytes && solid == mesh.solid &&
           std::memcmp(copy.get(), mesh.vertices, vertex_bytes) == 0 &&
           std::memcmp(copy.get() + vertex_bytes, mesh.triangles, triangle_bytes) == 0;
  }
};

std::shared_ptr<const ShapeTree> MeshCache::find(const MeshBytes& mesh) const {
  std::shared_ptr<const Entry> entry;
  {
    const std::shared_lock<std::shared_mutex> lock(mutex_);
    const auto found = entries_.find(mesh.mesh);
    if (found == entries_.end()) return nullptr;
    entry = found->second;  // held while it is compared, without the lock
  }
  if (!entry->sameAs(mesh)) return nullptr;
  entry->used.store(clock_.fetch_add(1, std::memory_order_relaxed), std::memory_order_relaxed);
  return entry->tree;
}

void MeshCache::keep(const MeshBytes& mesh, std::shared_ptr<const ShapeTree> tree) {
  const std::size_t bytes = tree->bytes() + mesh.vertex_bytes + mesh.triangle_bytes + sizeof(Entry);
  if (bytes > most_bytes_) return;
  const auto entry = std::make_shared<Entry>();
  entry->vertex_bytes = mesh.vertex_bytes;
  entry->triangle_bytes = mesh.triangle_bytes;
  entry->scalar_bytes = mesh.scalar_bytes;
  entry->solid = mesh.solid;
  entry->copy.reset(new char[mesh.vertex_bytes + mesh.triangle_bytes]);
  std::memcpy(entry->copy.get(), mesh.vertices, mesh.vertex_bytes);
  std::memcpy(entry->copy.get() + mesh.vertex_bytes, mesh.triangles, mesh.triangle_bytes);
  entry->tree = std::move(tree);
  entry->bytes = bytes;
  entry->used = clock_.fetch_add(1, std::memory_order_relaxed);
  const std::lock_guard<std::shared_mutex> lock(mutex_);
  std::shared_ptr<const Entry>& place = entries_[mesh.mesh];
  if (place) bytes_ -= place->bytes;
  place = entry;
  bytes_ += bytes;
  if (bytes_ > most_bytes_) makeRoom();
}

/// Drops the entries that were used longest ago until a quarter of the cache is free, so that this is rare.
void MeshCache::makeRoom() {
  std::vector<std::pair<std::uint64_t, const void*>> by_age;
  for (const auto& [mesh, entry] : entries_) by_age.emplace_back(entry->used.load(std::memory_order_relaxed), mesh);
  std::sort(by_age.begin(), by_age.end());
  for (std::size_t i = 0; i + 1 < by_age.size() && bytes_ > most_bytes_ / 4 * 3; ++i) {  // the newest one stays
    const auto oldest = entries_.find(by_age[i].second);
    bytes_ -= oldest->second->bytes;
    entries_.erase(oldest);
  }
}

std::size_t MeshCache::bytes() const {
  const std::shared_lock<std::shared_mutex> lock(mutex_);
  return bytes_;
}

}  // namespace fcl_artic
