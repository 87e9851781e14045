// SPDX-License-Identifier: BSD-3-Clause
//
// The task and the answer of a visibility executor (doc/VISIBILITY.md): plain data, the same for all of them.
#pragma once

#include <cstdint>
#include <vector>

#include "fcl_artic/visibility.h"

namespace fcl_artic {
namespace visibility {

/// A convex solid: the hull of `count` points (xyz in Batch::points, from point `first` on) grown by a ball. A triangle
/// is one, and so is a link's line swept sphere over one part of its motion.
struct Volume {
  std::int32_t first = 0, count = 0;
  double radius = 0;  ///< m
};

/// A box in the frame of its volumes. Its views along x, y and z are one tile each.
struct Window {
  double lo[3], hi[3];
};

/// How footprints and depth bounds are grown. Only with the defaults do executors prove anything. Tests use other
/// values, to show that they notice wrong executors.
struct Growth {
  bool footprint = true, depth = true;
  /// Growth beyond half a pixel, in pixels: for snapping and rounding. Below 0: as much as the executor needs.
  double eta = -1;
  Growth orOwn(double needed) const { return {footprint, depth, eta < 0 ? needed : eta}; }
};

/// Swept volumes and the objects that may touch them, by windows.
struct Batch {
  struct SweptVolume {
    Volume volume;
    std::int32_t window;
  };
  struct Object {
    Volume volume;
    std::int32_t window, group;
  };

  int resolution = 32;  ///< pixels along a tile's side
  VisibilityRule rule = VisibilityRule::intervals;
  /// The caller asks only whether a group survives: if one of its objects does, the executor may report all of them so.
  bool groups_only = false;
  Growth growth;
  std::vector<double> points;
  /// A window must hold every point that one of its swept volumes has in common with one of its objects.
  std::vector<Window> windows;
  std::vector<SweptVolume> swept;
  std::vector<Object> objects;  ///< those of a group lie together and share a window; groups are numbered from 0
  std::int32_t num_groups = 0;

  void clear() {
    points.clear();
    windows.clear();
    swept.clear();
    objects.clear();
    num_groups = 0;
  }
};

constexpr int kViews = 3;
constexpr int kLargestResolution = 128;

/// Tells which objects may overlap the swept volumes of their windows.
class Executor {
 public:
  virtual ~Executor() = default;
  /// @param[out] may  one entry per object: 0 is a proof that it overlaps none of the swept volumes of its window.
  /// @throws std::runtime_error if the executor fails: then nothing is known.
  virtual void run(const Batch& batch, std::vector<std::uint8_t>& may) = 0;
};

}  // namespace visibility
}  // namespace fcl_artic
