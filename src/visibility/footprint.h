// SPDX-License-Identifier: BSD-3-Clause
//
// A convex volume as one tile sees it: the pixels that it may cover, and how deep it may lie in each
// (doc/VISIBILITY.md, "The rule"). Everything is computed in double and rounded outward.
//
// Symbols: view along axis k; pixel (i, j) is the square [i, i+1] x [j, j+1] of the tile, its centre at +1/2;
//   (X, Y) a point in pixels, Z its depth, 0 to 1 over the window; eta: kEta.
#pragma once

#include <vector>

#include "fcl_artic/export.h"
#include "visibility/batch.h"

namespace fcl_artic {
namespace visibility {

/// Growth beyond half a pixel, in pixels. It covers the rounding of executors: less than 10^-4.
constexpr double kEta = 1.0 / 64;

/// a X + b Y <= c, with (a, b) of length 1 or so.
struct HalfPlane {
  double a, b, c;
};

/// In the pixel with the centre (x, y) the volume's depth lies in [a x + b y + lower, a x + b y + upper], evaluated in
/// float.
struct DepthBounds {
  float a, b, lower, upper;
};

/// A convex region. It holds the centre of every pixel whose square the volume meets in the view, at a distance of at
/// least eta from its border.
struct Footprint {
  static constexpr int kMaxSides = 20, kMaxBounds = 7;
  int x0, x1, y0, y1;  ///< pixels, ends included; at least one
  int num_sides, num_bounds;
  HalfPlane sides[kMaxSides];
  DepthBounds bounds[kMaxBounds];  ///< the first one has a = b = 0
};

/// Makes footprints. One serves one thread.
class FCL_ARTIC_EXPORT Projector {
 public:
  enum class Outcome {
    misses,    ///< the volume covers no pixel of the tile
    mayCover,  ///< the volume may cover pixels: the footprint says which
    unusable,  ///< a number is not finite, or the window has no volume: nothing is known
  };
  /// Growth of the footprints made from now on.
  void setGrowth(const Growth& growth) {
    half_ = growth.footprint ? 0.5 + kEta : 0;
    depth_half_ = growth.depth ? 0.5 + kEta : 0;
  }
  /// @param view  axis along which is looked, 0 to 2.
  Outcome project(const Batch& batch, const Volume& volume, const Window& window, int view, Footprint& footprint);

 private:
  void addSide(double a, double b, Footprint& f) const;
  void addBounds(double a, double b, Footprint& f) const;
  void addSlopes(Footprint& f) const;

  std::vector<double> x_, y_, z_;
  double radius_[3];  ///< of the ball, in the units of X, Y, Z
  double sums_[3];    ///< of |X|, |Y|, |Z|: rounding scales with them
  double half_ = 1, depth_half_ = 1;
  int resolution_, count_;
};

}  // namespace visibility
}  // namespace fcl_artic
