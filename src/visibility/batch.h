// SPDX-License-Identifier: BSD-3-Clause
//
// The task and the answer of a visibility executor (doc/VISIBILITY.md): plain data, the same for all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
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
  Growth growth;
  std::vector<double> points;
  /// A window must hold every point that one of its swept volumes has in common with one of its objects.
  std::vector<Window> windows;
  std::vector<SweptVolume> swept;
  std::vector<Object> objects;  ///< those of a group lie together and share a window; groups are numbered from 0
  std::int32_t num_groups = 0;

  const Window& windowOf(std::int32_t window) const { return windows[static_cast<std::size_t>(window)]; }
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

/// Tells which groups of objects may overlap the swept volumes of their windows.
class Executor {
 public:
  virtual ~Executor() = default;
  /// @param[out] may  one entry per group: 0 is a proof that none of its objects overlaps a swept volume of its window.
  /// @throws std::runtime_error if the executor fails: then nothing is known.
  virtual void run(const Batch& batch, std::vector<std::uint8_t>& may) = 0;
};

/// Has a culler's executor run a batch; the executor cpu, if there is none or if it fails.
/// @return the name of the executor that did.
std::string runBy(const VisibilityCuller& culler, const Batch& batch, std::vector<std::uint8_t>& may);

}  // namespace visibility
}  // namespace fcl_artic
