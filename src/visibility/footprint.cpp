// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fcl_artic {
namespace visibility {
namespace {

/// Bounds on a handful of roundings in double, in any rounding mode, and on five in float.
constexpr double kDouble = 0x1p-48, kFloat = 0x1p-20;
/// Nothing is computed with numbers above this: products of three such numbers are still finite.
constexpr double kLargest = 1e24;
/// Steeper bounds, in windows per pixel, bound nothing.
constexpr double kSteepest = 4;
/// Up to this number of points, all pairs are tried as edges of the hull.
constexpr int kFewPoints = 8;

int pixelAtOrAfter(double x, int resolution) {  // the first pixel whose centre is at x or after it
  return static_cast<int>(std::ceil(std::min(std::max(x - 0.5, 0.0), static_cast<double>(resolution))));
}
int pixelAtOrBefore(double x, int resolution) {
  return static_cast<int>(std::floor(std::min(std::max(x - 0.5, -1.0), resolution - 1.0)));
}

float down(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

/// Support of the volume, the pixel's square and the margin along (a, b).
void Projector::addSide(double a, double b, Footprint& f) const {
  if (f.num_sides == Footprint::kMaxSides) return;  // a side less: a larger footprint
  double c = a * x_[0] + b * y_[0];
  for (int i = 1; i < count_; ++i) c = std::max(c, a * x_[i] + b * y_[i]);
  const double ra = a * radius_[0], rb = b * radius_[1];
  c += half_ * (std::abs(a) + std::abs(b)) + std::sqrt(ra * ra + rb * rb);
  f.sides[f.num_sides++] = {a, b, c + kDouble * (sums_[0] + sums_[1] + radius_[0] + radius_[1] + 1)};
}

/// For any slopes: over the pixel's square, X = x + dx with |dx| <= 1/2, Z - a x - b y = (Z - a X - b Y) + a dx + b dy.
void Projector::addBounds(double a, double b, Footprint& f) const {
  a = static_cast<float>(a);
  b = static_cast<float>(b);
  if (f.num_bounds == Footprint::kMaxBounds || !(std::abs(a) <= kSteepest && std::abs(b) <= kSteepest)) return;
  double lower = z_[0] - a * x_[0] - b * y_[0], upper = lower;
  for (int i = 1; i < count_; ++i) {
    const double t = z_[i] - a * x_[i] - b * y_[i];
    lower = std::min(lower, t);
    upper = std::max(upper, t);
  }
  const double ra = a * radius_[0], rb = b * radius_[1], rz = radius_[2];
  const double ball = std::sqrt(rz * rz + ra * ra + rb * rb), slope = std::abs(a) + std::abs(b);
  const double rounding = kDouble * (sums_[2] + std::abs(a) * sums_[0] + std::abs(b) * sums_[1] + ball + 1);
  const double grow = ball + slope * depth_half_ + rounding;
  lower -= grow;
  upper += grow;
  const double evaluation = kFloat * (slope * resolution_ + 1e-9);
  f.bounds[f.num_bounds++] = {static_cast<float>(a), static_cast<float>(b),
                              down(lower - evaluation - kFloat * std::abs(lower)),
                              up(upper + evaluation + kFloat * std::abs(upper))};
}

/// Adds the slopes that are worth trying: those of the plane through three far points and, for round volumes, those
/// along the longest edge and tilted about it.
void Projector::addSlopes(Footprint& f) const {
  addBounds(0, 0, f);
  if (count_ < 2) return;
  int p = 0, q = 1, r = -1;
  double longest = -1;
  const int n = std::min(count_, kFewPoints);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      const double dx = x_[i] - x_[j], dy = y_[i] - y_[j], length = dx * dx + dy * dy;
      if (length > longest) {
        longest = length;
        p = j;
        q = i;
      }
    }
  }
  if (!(longest > 1e-6)) return;
  const double ux = x_[q] - x_[p], uy = y_[q] - y_[p], uz = z_[q] - z_[p];
  double widest = 1e-9 * longest;
  for (int i = 0; i < n; ++i) {
    const double area = std::abs(ux * (y_[i] - y_[p]) - uy * (x_[i] - x_[p]));
    if (area > widest) {
      widest = area;
      r = i;
    }
  }
  if (r >= 0) {
    const double vx = x_[r] - x_[p], vy = y_[r] - y_[p], vz = z_[r] - z_[p], det = ux * vy - uy * vx;
    addBounds((uz * vy - uy * vz) / det, (ux * vz - uz * vx) / det, f);
  }
  if (count_ == 3 && radius_[2] < 1e-6) return;
  const double a = uz * ux / longest, b = uz * uy / longest, length = std::sqrt(longest);
  addBounds(a, b, f);
  // Tilts of 45 and 72 degrees in space: radius_ holds the scales.
  if (!(radius_[0] > 0)) return;
  const double px = -uy / length, py = ux / length;
  const double unit = radius_[2] / std::sqrt(px * px * radius_[0] * radius_[0] + py * py * radius_[1] * radius_[1]);
  for (const double tilt : {unit, -unit, 3 * unit, -3 * unit}) addBounds(a + px * tilt, b + py * tilt, f);
}

Projector::Outcome Projector::project(const Batch& batch, const Volume& volume, const Window& window, int view,
                                      Footprint& f) {
  const int axes[3] = {(view + 1) % 3, (view + 2) % 3, view};
  count_ = volume.count;
  resolution_ = batch.resolution;
  const double* points = batch.points.data() + 3 * static_cast<std::ptrdiff_t>(volume.first);
  std::vector<double>* coordinates[3] = {&x_, &y_, &z_};
  double lo[3], hi[3];
  bool usable = count_ > 0 && volume.radius >= 0;
  for (int k = 0; k < 3 && usable; ++k) {
    const int axis = axes[k];
    const double scale = (k < 2 ? resolution_ : 1) / (window.hi[axis] - window.lo[axis]);
    std::vector<double>& to = *coordinates[k];
    if (to.size() < static_cast<std::size_t>(count_)) to.resize(static_cast<std::size_t>(count_));
    radius_[k] = volume.radius * scale * (1 + kDouble);
    lo[k] = std::numeric_limits<double>::infinity();
    hi[k] = -lo[k];
    sums_[k] = 0;
    for (int i = 0; i < count_; ++i) {
      const double x = (points[3 * i + axis] - window.lo[axis]) * scale;
      to[static_cast<std::size_t>(i)] = x;
      lo[k] = std::min(lo[k], x);
      hi[k] = std::max(hi[k], x);
      sums_[k] += std::abs(x);  // not a number, where one of them isn't
    }
    usable = scale > 1 / kLargest && scale < kLargest && sums_[k] < kLargest && radius_[k] < kLargest;
  }
  if (!usable) return Outcome::unusable;

  for (int k = 0; k < 2; ++k) {
    const double grow = half_ + radius_[k] + kDouble * (sums_[k] + radius_[k] + 1);
    (k ? f.y0 : f.x0) = pixelAtOrAfter(lo[k] - grow, resolution_);
    (k ? f.y1 : f.x1) = pixelAtOrBefore(hi[k] + grow, resolution_);
  }
  if (f.x0 > f.x1 || f.y0 > f.y1) return Outcome::misses;

  f.num_sides = f.num_bounds = 0;
  if (count_ != 3) {
    for (const double a : {M_SQRT1_2, -M_SQRT1_2}) {
      for (const double b : {M_SQRT1_2, -M_SQRT1_2}) addSide(a, b, f);
    }
  }
  // Sides along the edges of the points' hull. (The sum of convex polygons has the sides of each; the corners of the
  // round part stick out, up to the box and the diagonals.)
  if (count_ <= kFewPoints) {
    for (int i = 0; i < count_; ++i) {
      for (int j = 0; j < i; ++j) {
        const double dx = x_[i] - x_[j], dy = y_[i] - y_[j], length = std::sqrt(dx * dx + dy * dy);
        if (!(length > 1e-9)) continue;
        const double a = dy / length, b = -dx / length, c = a * x_[i] + b * y_[i];
        double before = 0, behind = 0;
        for (int k = 0; k < count_; ++k) {
          const double s = a * x_[k] + b * y_[k] - c;
          before = std::min(before, s);
          behind = std::max(behind, s);
        }
        if (behind < 1e-9) addSide(a, b, f);
        if (before > -1e-9) addSide(-a, -b, f);
      }
    }
  }
  addSlopes(f);
  return Outcome::mayCover;
}

}  // namespace visibility
}  // namespace fcl_artic
