// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// Bounds on a handful of roundings in double, in any rounding mode, and on five in float.
constexpr double kDouble = 0x1p-48, kFloat = 0x1p-20;
/// Volumes farther away than this, in sides of the window, are not drawn; nor are windows so large or small, in m:
/// products of three such numbers are finite.
constexpr double kFarthest = 1e20;
/// Steeper bounds, in windows per pixel, bound nothing.
constexpr double kSteepest = 4;
/// Up to this number of points, all pairs are tried as edges of the hull.
constexpr int kFewPoints = 8;

/// A volume in the pixels of a view, and the footprint that is made of it.
struct Projection {
  const double *x, *y, *z;
  int count;
  double radius[3];  ///< of the ball, in the units of X, Y, Z
  double sums[3];    ///< of |X|, |Y|, |Z|: rounding scales with them
  double half, depth_half;
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

  /// For any slopes: over the pixel's square, X = x + dx with |dx| <= 1/2, Z - a x - b y = (Z - a X - b Y) + a dx + b
  /// dy.
  void addBounds(double a, double b) const {
    a = static_cast<float>(a);
    b = static_cast<float>(b);
    if (f.num_bounds == Footprint::kMaxBounds || !(std::abs(a) <= kSteepest && std::abs(b) <= kSteepest)) return;
    double lower = z[0] - a * x[0] - b * y[0], upper = lower;
    for (int i = 1; i < count; ++i) {
      const double t = z[i] - a * x[i] - b * y[i];
      lower = std::min(lower, t);
      upper = std::max(upper, t);
    }
    const double ra = a * radius[0], rb = b * radius[1], rz = radius[2];
    const double ball = std::sqrt(rz * rz + ra * ra + rb * rb), slope = std::abs(a) + std::abs(b);
    const double rounding = kDouble * (sums[2] + std::abs(a) * sums[0] + std::abs(b) * sums[1] + ball + 1);
    const double grow = ball + slope * depth_half + rounding, evaluation = kFloat * (slope * f.resolution + 1e-9);
    lower -= grow;
    upper += grow;
    const float infinity = std::numeric_limits<float>::infinity();
    f.bounds[f.num_bounds++] = {
        static_cast<float>(a), static_cast<float>(b),
        std::nextafter(static_cast<float>(lower - evaluation - kFloat * std::abs(lower)), -infinity),
        std::nextafter(static_cast<float>(upper + evaluation + kFloat * std::abs(upper)), infinity)};
  }

  /// Adds the slopes that are worth trying: those of the plane through three far points and, for round volumes, those
  /// along the longest edge and tilted about it.
  void addSlopes() const {
    addBounds(0, 0);
    int p = 0, q = 0, r = -1;
    double longest = 1e-6;
    const int n = std::min(count, kFewPoints);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < i; ++j) {
        const double dx = x[i] - x[j], dy = y[i] - y[j], square = dx * dx + dy * dy;
        if (!(square > longest)) continue;
        longest = square;
        p = j;
        q = i;
      }
    }
    if (p == q) return;
    const double ux = x[q] - x[p], uy = y[q] - y[p], uz = z[q] - z[p];
    double widest = 1e-9 * longest;
    for (int i = 0; i < n; ++i) {
      const double area = std::abs(ux * (y[i] - y[p]) - uy * (x[i] - x[p]));
      if (!(area > widest)) continue;
      widest = area;
      r = i;
    }
    if (r >= 0) {
      const double vx = x[r] - x[p], vy = y[r] - y[p], vz = z[r] - z[p], det = ux * vy - uy * vx;
      addBounds((uz * vy - uy * vz) / det, (ux * vz - uz * vx) / det);
    }
    if (count == 3 && radius[2] < 1e-6) return;
    const double a = uz * ux / longest, b = uz * uy / longest, length = std::sqrt(longest);
    addBounds(a, b);
    // Tilts of 45 and 72 degrees in space: the radii hold the scales.
    if (!(radius[0] > 0)) return;
    const double px = -uy / length, py = ux / length;
    const double unit = radius[2] / std::sqrt(px * px * radius[0] * radius[0] + py * py * radius[1] * radius[1]);
    for (const double tilt : {unit, -unit, 3 * unit, -3 * unit}) addBounds(a + px * tilt, b + py * tilt);
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
  Projection p = {to,
                  to + count,
                  to + 2 * count,
                  volume.count,
                  {},
                  {},
                  drawing.grow_footprints ? 0.5 + kEta : 0,
                  drawing.grow_depths ? 0.5 + kEta : 0,
                  f};
  f.view = view;
  f.resolution = resolution;
  f.num_sides = f.num_bounds = 0;
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
    if (k == 2) break;
    // The first pixel whose centre is at the lower end or after it, and the last one at the upper end or before it.
    const double grow = p.half + p.radius[k] + kDouble * (p.sums[k] + p.radius[k] + 1);
    (k ? f.y0 : f.x0) = static_cast<int>(std::ceil(std::clamp(lo - grow - 0.5, 0.0, resolution + 0.0)));
    (k ? f.y1 : f.x1) = static_cast<int>(std::floor(std::clamp(hi + grow - 0.5, -1.0, resolution - 1.0)));
  }
  if (f.x0 > f.x1 || f.y0 > f.y1) return false;
  p.addHull();
  p.addSlopes();
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
