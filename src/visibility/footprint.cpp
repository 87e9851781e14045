// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// A bound on a handful of roundings in double, in any rounding mode.
constexpr double kDouble = 0x1p-48;
/// Volumes farther away than this, in sides of the window, are not drawn; nor are windows so large or small, in m:
/// products of three such numbers are finite.
constexpr double kFarthest = 1e20;
/// Up to this number of points, all pairs are tried as edges of the hull.
constexpr int kFewPoints = 8;

/// A volume in the pixels of a view, and the footprint that is made of it.
struct Projection {
  const double *x, *y;
  int count;
  double radius[3];  ///< of the ball, in the units of X, Y, Z
  double sums[3];    ///< of |X|, |Y|, |Z|: rounding scales with them
  double half;
  Footprint& f;

  /// Support of the volume, the pixel's square and the margin along (a, b).
  void addSide(double a, double b) const {
    if (f.num_sides == Footprint::kMaxSides) return;  // a side less: a larger footprint
    double c = a * x[0] + b * y[0];
    for (int i = 1; i < count; ++i) c = std::max(c, a * x[i] + b * y[i]);
    const double ra = a * radius[0], rb = b * radius[1];
    c += half * (std::abs(a) + std::abs(b)) + std::sqrt(ra * ra + rb * rb);
    c += kDouble * (sums[0] + sums[1] + radius[0] + radius[1] + 1);
    f.sides[f.num_sides++] = {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), 0};
  }

  /// Adds the diagonals' sides, and those along the edges of the points' hull. (The sum of convex polygons has the
  /// sides of each; the corners of the round part stick out, up to the box and the diagonals.)
  void addHull() const {
    for (const double a : {M_SQRT1_2, -M_SQRT1_2}) {
      for (const double b : {M_SQRT1_2, -M_SQRT1_2}) {
        if (count != 3) addSide(a, b);
      }
    }
    if (count > kFewPoints) return;
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < i; ++j) {
        const double dx = x[i] - x[j], dy = y[i] - y[j], length = std::sqrt(dx * dx + dy * dy);
        if (!(length > 1e-9)) continue;
        const double a = dy / length, b = -dx / length, c = a * x[i] + b * y[i];
        double before = 0, behind = 0;
        for (int k = 0; k < count; ++k) {
          before = std::min(before, a * x[k] + b * y[k] - c);
          behind = std::max(behind, a * x[k] + b * y[k] - c);
        }
        if (behind < 1e-9) addSide(a, b);
        if (before > -1e-9) addSide(-a, -b);
      }
    }
  }
};

/// Whether the window has a volume, and all numbers of a volume are finite and of some size.
bool isUsable(const Drawing& drawing, const Volume& volume) {
  bool usable = volume.count > 0 && volume.radius >= 0;
  const double* points = drawing.points.data() + 3 * static_cast<std::ptrdiff_t>(volume.first);
  for (int k = 0; k < 3; ++k) {
    const double side = drawing.hi[k] - drawing.lo[k], farthest = kFarthest * side;
    usable = usable && side > 1 / kFarthest && side < kFarthest && volume.radius < farthest;
    for (int i = 0; i < volume.count; ++i) usable = usable && std::abs(points[3 * i + k] - drawing.lo[k]) < farthest;
  }
  return usable;
}

}  // namespace

bool project(const Drawing& drawing, const Volume& volume, int view, Footprint& f) {
  thread_local std::vector<double> coordinates;
  const int axes[3] = {(view + 1) % 3, (view + 2) % 3, view}, resolution = drawing.resolution;
  const auto count = static_cast<std::ptrdiff_t>(volume.count);
  coordinates.resize(std::max(coordinates.size(), static_cast<std::size_t>(3 * count)));
  double* const to = coordinates.data();
  Projection p = {to, to + count, volume.count, {}, {}, drawing.grow_footprints ? 0.5 + kEta : 0, f};
  f.view = view;
  f.resolution = resolution;
  f.num_sides = 0;
  const double* points = drawing.points.data() + 3 * static_cast<std::ptrdiff_t>(volume.first);
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[k];
    const double scale = (k < 2 ? resolution : 1) / (drawing.hi[axis] - drawing.lo[axis]);
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const double x = to[k * count + i] = (points[3 * i + axis] - drawing.lo[axis]) * scale;
      lo = std::min(lo, x);
      hi = std::max(hi, x);
      p.sums[k] += std::abs(x);
    }
    p.radius[k] = volume.radius * scale * (1 + kDouble);
    const double pad = p.radius[k] + kDouble * (p.sums[k] + p.radius[k] + 1);
    if (k == 2) {
      f.nearest = std::nextafter(static_cast<float>(lo - pad), -std::numeric_limits<float>::infinity());
      f.farthest = std::nextafter(static_cast<float>(hi + pad), std::numeric_limits<float>::infinity());
      break;
    }
    // The first pixel whose centre is at the lower end or after it, and the last one at the upper end or before it.
    const double grow = p.half + pad;
    (k ? f.y0 : f.x0) = static_cast<int>(std::ceil(std::clamp(lo - grow - 0.5, 0.0, resolution + 0.0)));
    (k ? f.y1 : f.x1) = static_cast<int>(std::floor(std::clamp(hi + grow - 0.5, -1.0, resolution - 1.0)));
  }
  if (f.x0 > f.x1 || f.y0 > f.y1) return false;
  p.addHull();
  return true;
}

void Executor::draw(const Drawing& drawing, std::vector<std::uint8_t>& may) {
  bool usable = true;
  for (const Volume& volume : drawing.swept) usable = usable && isUsable(drawing, volume);
  for (const Drawing::Piece& piece : drawing.pieces) usable = usable && isUsable(drawing, piece.volume);
  may.assign(static_cast<std::size_t>(drawing.num_groups), !usable);
  if (usable && !drawing.pieces.empty()) findThatMayOverlap(drawing, may);
}

}  // namespace visibility
}  // namespace fcl_artic
