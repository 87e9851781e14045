// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs that touch by construction, made so that a rule that loses anything loses one of them:
// - slivers to an aspect of 1e-7,
// - sizes from a thousandth of a pixel to twenty windows,
// - triangles edge-on to a view,
// - grazing to 1e-12,
// - windows off the grid and cut close, or with the touching point at a corner of pixels,
// - swept volumes inside solids.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "pairs/random.h"
#include "visibility/executor.h"

namespace fcl_artic {
namespace test {

using Eigen::Vector3d;

/// Kinds of pair: what is swept, and how it is touched.
enum class AdversaryKind { triangles, graze, deep, sweptHull, tangent, insideSolid, count };

class Adversary {
 public:
  Adversary(std::uint64_t seed, std::uint64_t i) : random_(seed * 0x2545f4914f6cdd1du + i) {}

  /// A swept volume and a piece that share a point; or, with `gap` > 0, a tangent pair that is that many pixels apart.
  /// @param[out] drawing  its resolution counts.
  void draw(AdversaryKind kind, double gap, visibility::Drawing& drawing) {
    drawing.clear();
    if (gap > 0) kind = AdversaryKind::tangent;
    const double pixel = 1.0 / drawing.resolution;  // of a window of side 1
    const double object_size = random_.logUniform(1e-3 * pixel, 20), swept_size = random_.logUniform(0.01 * pixel, 0.9);
    const Vector3d e = someDirection();
    std::vector<Vector3d> object = triangle(e, across(e), object_size), swept;
    Vector3d on_object = pointOf(object), on_swept;
    double radius = 0;
    if (kind == AdversaryKind::triangles) {
      const Vector3d d = someDirection();
      swept = triangle(d, across(d), swept_size);
      on_swept = pointOf(swept);
    } else {
      // The hull of two segments or of two segments' ways, grown by a ball; and a point at most the radius from a point
      // of it.
      radius = swept_size * (random_.chance(0.3) ? random_.logUniform(1e-4, 0.05) : random_.uniform(0.05, 0.4));
      swept = {Vector3d::Zero(), someDirection() * (swept_size * random_.unit())};
      const std::size_t count = kind == AdversaryKind::sweptHull ? (random_.below(2) ? 6 : 4) : 2;
      while (swept.size() < count) {
        swept.push_back(swept[swept.size() % 2] + random_.direction() * (swept_size * random_.uniform(0, 0.5)));
      }
      std::vector<double> weights;
      double sum = 0;
      for (std::size_t k = 0; k < count; ++k) sum += weights.emplace_back(random_.chance(0.3) ? 0 : random_.unit());
      Vector3d core = sum > 0 ? Vector3d::Zero().eval() : swept[0];
      for (std::size_t k = 0; k < count && sum > 0; ++k) core += swept[k] * (weights[k] / sum);
      Vector3d n = someDirection();
      if (count == 2 && random_.chance(0.7) && swept[1].norm() > 0) n = across(swept[1].normalized());
      double depth = 1 - 1e-12;
      if (kind == AdversaryKind::tangent) {
        const Vector3d f = across(n);
        object = triangle(f, n.cross(f), object_size);
        on_object = pointOf(object);
      }
      if (kind == AdversaryKind::insideSolid) object = boxAround(on_object);
      if (kind == AdversaryKind::insideSolid || kind == AdversaryKind::deep) depth = random_.unit();
      if (gap > 0) depth = 1 + gap * pixel / radius;
      on_swept = core + n * (radius * depth);
    }
    for (Vector3d& corner : object) corner += on_swept - on_object;
    const bool cut = random_.chance(0.2) && gap == 0;
    setWindow(swept, radius, cut ? &on_swept : nullptr, drawing);
    if (gap == 0 && random_.chance(0.3)) moveToCorner(on_swept, drawing);
    drawing.swept.push_back(addVolume(swept, radius, drawing));
    drawing.pieces.push_back({addVolume(object, 0, drawing), drawing.num_groups++});
  }

  static visibility::Volume addVolume(const std::vector<Vector3d>& points, double radius,
                                      visibility::Drawing& drawing) {
    return drawing.addVolume(points[0].data(), static_cast<std::int32_t>(points.size()), radius);
  }

 private:
  /// Often an axis: edge-on to views, or facing them.
  Vector3d someDirection() {
    if (random_.unit() >= 0.35) return random_.direction();
    return (random_.below(2) ? 1 : -1) * Vector3d::Unit(random_.below(3));
  }
  Vector3d across(const Vector3d& d) {
    Vector3d n = d.cross(someDirection());
    while (n.norm() < 1e-3) n = d.cross(random_.direction());
    return n.normalized();
  }
  std::vector<Vector3d> triangle(const Vector3d& e, const Vector3d& f, double size) {
    const double thin = random_.chance(0.4) ? random_.logUniform(1e-7, 1e-2) : random_.uniform(0.05, 1);
    return {Vector3d::Zero(), e * size, e * (size * random_.unit()) + f * (size * thin)};
  }
  Vector3d pointOf(const std::vector<Vector3d>& t) {
    const int kind = random_.below(4);
    if (kind == 0) return t[static_cast<std::size_t>(random_.below(3))];
    double a = random_.unit(), b = kind == 1 ? 1 - a : random_.unit();
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    return (1 - a - b) * t[0] + a * t[1] + b * t[2];
  }
  /// A box around the swept volume or around a part of it.
  std::vector<Vector3d> boxAround(Vector3d& inside) {
    const Eigen::Matrix3d turn = random_.below(2) ? Eigen::Matrix3d::Identity().eval() : random_.rotation();
    Vector3d half;
    for (double& side : half) side = random_.logUniform(0.1, 20);
    for (int k = 0; k < 3; ++k) inside[k] = half[k] * random_.uniform(-1, 1);
    inside = (turn * inside).eval();
    std::vector<Vector3d> corners;
    for (int c = 0; c < 8; ++c) {
      corners.emplace_back(turn * half.cwiseProduct(Vector3d(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1)));
    }
    return corners;
  }
  /// The box of what is swept, made larger by something, off the grid; or cut near the touching point.
  /// @param cut_near  this point; null: it is not cut.
  void setWindow(const std::vector<Vector3d>& swept, double radius, const Vector3d* cut_near,
                 visibility::Drawing& drawing) {
    for (int k = 0; k < 3; ++k) {
      double lo = swept[0][k], hi = lo;
      for (const Vector3d& x : swept) {
        lo = std::min(lo, x[k]);
        hi = std::max(hi, x[k]);
      }
      lo -= radius;
      hi += radius;
      if (cut_near) {
        lo = std::max(lo, (*cut_near)[k] - random_.logUniform(1e-4, 1));
        hi = std::min(hi, (*cut_near)[k] + random_.logUniform(1e-4, 1));
      }
      const double part = random_.unit(), room = random_.chance(0.3) ? 1e-3 : std::max(1 - (hi - lo), 1e-6);
      drawing.lo[k] = lo - room * part - 1e-9;
      drawing.hi[k] = hi + room * (1 - part) + 1e-9;
    }
  }
  /// Moves the window by less than a pixel: the touching point comes to where pixels meet, and rounding counts.
  void moveToCorner(const Vector3d& point, visibility::Drawing& drawing) {
    for (int k = 0; k < 3; ++k) {
      const double pixel = (drawing.hi[k] - drawing.lo[k]) / drawing.resolution,
                   at = (point[k] - drawing.lo[k]) / pixel;
      const double off = (random_.below(2) ? 1 : -1) * random_.logUniform(1e-9, 1e-5);
      const double by = (at - std::clamp(std::round(at), 1.0, drawing.resolution - 1.0) + off) * pixel;
      drawing.lo[k] += by;
      drawing.hi[k] += by;
    }
  }

  pairs::Random random_;
};

/// Culls among pairs [begin, end) of this seed: wrong ones, if they touch. Pair i is of kind i mod count.
/// @param drawing  its resolution and growth count.
inline std::uint64_t countCulls(visibility::Executor& executor, visibility::Drawing drawing, std::uint64_t seed,
                                std::uint64_t begin, std::uint64_t end, double gap = 0) {
  constexpr std::uint64_t kKinds = static_cast<std::uint64_t>(AdversaryKind::count);
  std::uint64_t culled = 0;
  std::vector<std::uint8_t> may;
  for (std::uint64_t i = begin; i < end; ++i) {
    Adversary(seed, i).draw(static_cast<AdversaryKind>(i % kKinds), gap, drawing);
    executor.draw(drawing, may);
    culled += !may.at(0);
  }
  return culled;
}

}  // namespace test
}  // namespace fcl_artic
