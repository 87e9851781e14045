// SPDX-License-Identifier: BSD-3-Clause
//
// The task and the answer of a visibility executor, and volumes as views show them (doc/VISIBILITY.md, "The rule"):
// plain data, the same for all executors.
//
// Symbols: view along axis k; pixel (i, j) is the square [i, i+1] x [j, j+1] of the tile, its centre at +1/2;
//   (X, Y) a point in pixels, Z its depth, 0 to 1 over the window; eta: kEta.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/visibility.h"

namespace fcl_artic {
class OffscreenContext;
namespace visibility {

constexpr int kViews = 3, kLargestResolution = 128;

/// A convex solid: the hull of `count` points (Drawing::points, from point `first` on) grown by a ball. A triangle is
/// one, and so is a link's line swept sphere over one part of its motion.
struct Volume {
  std::int32_t first = 0, count = 0;
  double radius = 0;  ///< m
};

/// The volumes that one link sweeps, and the pieces of other bodies that it may touch, in one frame.
struct Drawing {
  struct Piece {
    Volume volume;
    std::int32_t group;
  };
  int resolution = 32;  ///< pixels along a side of each view
  /// Only with it executors prove anything. Tests go without it, to show that they notice wrong executors.
  bool grow_footprints = true;
  double lo[3] = {}, hi[3] = {};  ///< The window: it holds every point that a swept volume and a piece share.
  std::vector<double> points;     ///< xyz, m
  std::vector<Volume> swept;
  std::vector<Piece> pieces;
  std::int32_t num_groups = 0;

  /// @param xyz  the points, one after another, m.
  Volume addVolume(const double* xyz, std::int32_t count, double radius) {
    const auto first = static_cast<std::int32_t>(points.size() / 3);
    points.insert(points.end(), xyz, xyz + 3 * static_cast<std::ptrdiff_t>(count));
    return {first, count, radius};
  }
  void clear() {
    points.clear();
    swept.clear();
    pieces.clear();
    num_groups = 0;
  }
};

/// Growth beyond half a pixel, in pixels. It covers the rounding of executors: less than 10^-4.
constexpr double kEta = 1.0 / 64;

/// a x + b y <= c, with (a, b) of length 1 or so.
struct Side {
  float a, b, c, unused;
};

/// A convex volume as one view shows it: a convex region, and two depths. The region holds the centre of every
/// pixel whose square the volume meets, at a distance of at least eta from its border. Computed in double and rounded
/// outward. Shaders read it as it lies in memory (`gl_executor.cpp`).
struct Footprint {
  static constexpr int kMaxSides = 20;
  std::int32_t x0, y0, x1, y1;  ///< pixels, ends included; at least one
  std::int32_t view, resolution, num_sides, unused;
  float nearest, farthest;  ///< bounds on the volume's depths
  float unused_depths[2];
  Side sides[kMaxSides];
};

/// Finds the footprint of a volume.
/// @param view  axis along which is looked, 0 to 2.
/// @return false: the volume covers no pixel.
FCL_ARTIC_EXPORT bool project(const Drawing& drawing, const Volume& volume, int view, Footprint& footprint);

/// Tells which groups of pieces may overlap the swept volumes.
class Executor {
 public:
  virtual ~Executor() = default;
  /// @param[out] may  one entry per group: 0 is a proof that none of its pieces overlaps a swept volume.
  /// @throws std::runtime_error if the executor fails: then nothing is known.
  FCL_ARTIC_EXPORT void draw(const Drawing& drawing, std::vector<std::uint8_t>& may);

 private:
  /// @param[in,out] may  of no group yet; the drawing has pieces, and its numbers are usable.
  virtual void findThatMayOverlap(const Drawing& drawing, std::vector<std::uint8_t>& may) = 0;
};

/// Scan conversion of the footprints: no OpenGL, the same bits each time, and no more drawn than the answer needs.
FCL_ARTIC_EXPORT std::unique_ptr<Executor> makeCpuExecutor();
/// The rule in OpenGL 4.3 (component `visibility`): the views side by side, one draw of what is swept, one of the
/// pieces, one read.
/// @throws std::runtime_error when a shader or buffer can't be had.
std::unique_ptr<Executor> makeOpenGlExecutor(std::unique_ptr<OffscreenContext> context);

/// Has a culler's executor draw; the executor cpu, if there is none or if it fails.
/// @return the name of the executor that did.
std::string drawBy(const VisibilityCuller& culler, const Drawing& drawing, std::vector<std::uint8_t>& may);

}  // namespace visibility
}  // namespace fcl_artic
