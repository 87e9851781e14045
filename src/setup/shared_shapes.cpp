// SPDX-License-Identifier: BSD-3-Clause
#include "setup/shared_shapes.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <mutex>
#include <unordered_map>

namespace fcl_artic {

namespace {

struct Held {
  std::weak_ptr<const ShapeTree> shape;
  std::weak_ptr<const GeometryContent> content;
};

/// All shapes that are held, by a hash of their meshes. (No proof rests on the hash.)
struct AllHeld {
  std::mutex mutex;
  std::unordered_multimap<std::uint64_t, Held> by_key;
  std::size_t swept = 16;  ///< entries left after the last removal of those that nobody holds, at least

  /// (An entry whose mesh nobody holds would stay for ever if no equal mesh is asked for again.)
  void add(std::uint64_t key, const Held& one) {
    if (by_key.size() >= 2 * swept) {
      for (auto at = by_key.begin(); at != by_key.end();) {
        at = at->second.shape.expired() || at->second.content.expired() ? by_key.erase(at) : std::next(at);
      }
      swept = std::max<std::size_t>(16, by_key.size());
    }
    by_key.emplace(key, one);
  }
};

std::uint64_t keyOf(const fcl::CollisionGeometryd& geometry) {
  const fcl::Vector3d size = geometry.aabb_local.max_ - geometry.aabb_local.min_;
  std::uint64_t key = static_cast<std::uint64_t>(geometry.getNodeType());
  for (const double x : {size[0], size[1], size[2], geometry.aabb_center[0]}) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    key = (key ^ bits) * 0x9e3779b97f4a7c15u;
  }
  return key;
}

}  // namespace

SharedShape readShared(const fcl::CollisionGeometryd& geometry) {
  const auto read = [&]() -> SharedShape {
    std::shared_ptr<const ShapeTree> shape = readGeometry(geometry);
    return {shape, std::make_shared<const GeometryContent>(geometry, shape)};
  };
  if (geometry.getObjectType() != fcl::OT_BVH) return read();
  static AllHeld& held = *new AllHeld;  // never destroyed: somebody's static manager may outlive it
  const std::uint64_t key = keyOf(geometry);
  {
    const std::lock_guard<std::mutex> lock(held.mutex);
    const auto [begin, end] = held.by_key.equal_range(key);
    for (auto at = begin; at != end;) {
      SharedShape known = {at->second.shape.lock(), at->second.content.lock()};
      if (!known.shape || !known.content) {
        at = held.by_key.erase(at);
        continue;
      }
      if (known.content->sameAs(geometry)) return known;
      ++at;
    }
  }
  SharedShape made = read();
  const std::lock_guard<std::mutex> lock(held.mutex);
  held.add(key, {made.shape, made.content});
  return made;
}

}  // namespace fcl_artic
