// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "random.h"
#include "scene.h"

namespace campaign {

/// The meshes that all scenes draw from: 12 to 2,000 triangles, 0.1 to 0.7 m; the same on every run.
class MeshLibrary {
 public:
  static const MeshLibrary& instance();
  const GeometryPtr& any(Random& random) const;
  /// A bar along z, centred, of about this length.
  const GeometryPtr& bar(Random& random, double length) const;
  const std::vector<GeometryPtr>& all() const { return meshes_; }

 private:
  MeshLibrary();
  std::vector<GeometryPtr> meshes_, bars_;
};

/// A box as a mesh, each side cut n x n, its corners moved by up to `noise` (m).
GeometryPtr boxMesh(const Vec3& sides, int n, double noise, Random& random);

/// Names of the classes: "<bodies>/<placing>" with bodies mesh_mesh, mesh_shape, shape_shape (one link, one obstacle),
/// chain or tree (arms of 1 to 9 joints among 1 to 5 obstacles, self collision on), and placing random, between (both
/// ends free, a hit between) or graze (least gap or depth of 1e-3 to 1e-8 m).
const std::vector<std::string>& families();

/// The scene of this seed; the same one for the same family and seed.
/// @throws std::invalid_argument for an unknown family
Scene makeScene(const std::string& family, std::uint64_t seed);

/// Family of query `index` of a campaign: the families take turns in fixed shares.
const std::string& familyOf(std::uint64_t campaign_seed, std::uint64_t index);

}  // namespace campaign
