// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/adversary.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace fcl_artic {
namespace visibility {
namespace {

using Eigen::Vector3d;

struct Maker {
  AdversaryRandom random;

  double coin() { return random.uniform(); }
  Vector3d direction() {
    for (;;) {
      const Vector3d d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (d.norm() > 0.1 && d.norm() < 1) return d.normalized();
    }
  }
  /// Often an axis: edge-on to views, or facing them.
  Vector3d someDirection() {
    if (coin() >= 0.35) return direction();
    const Vector3d d = Vector3d::Unit(random.below(3));
    return coin() < 0.5 ? d : Vector3d(-d);
  }
  Vector3d across(const Vector3d& d) {
    Vector3d n = d.cross(someDirection());
    while (n.norm() < 1e-3) n = d.cross(direction());
    return n.normalized();
  }
  double aspect() { return coin() < 0.4 ? random.logUniform(1e-7, 1e-2) : random.uniform(0.05, 1); }
  void triangle(const Vector3d& e, const Vector3d& f, double size, Vector3d* t) {
    const double thin = aspect();
    t[0].setZero();
    t[1] = e * size;
    t[2] = e * (size * coin()) + f * (size * thin);
  }
  Vector3d pointOf(const Vector3d* t) {
    const int kind = random.below(4);
    double a = coin(), b = coin();
    if (kind == 0) return t[random.below(3)];
    if (kind == 1) return a * t[0] + (1 - a) * t[1];
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    return (1 - a - b) * t[0] + a * t[1] + b * t[2];
  }
};

Volume addVolume(const Vector3d* points, int n, double radius, Batch& batch) {
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.count = n;
  volume.radius = radius;
  for (int i = 0; i < n; ++i) batch.points.insert(batch.points.end(), points[i].data(), points[i].data() + 3);
  return volume;
}

/// The box of what is swept, made larger by something, off the grid; or cut near the touching point.
/// @param cut_near  this point; null: it is not cut.
Window windowAround(const std::vector<Vector3d>& swept, double radius, const Vector3d* cut_near,
                    AdversaryRandom& random) {
  Window window;
  for (int k = 0; k < 3; ++k) {
    double lo = swept[0][k], hi = lo;
    for (const Vector3d& x : swept) {
      lo = std::min(lo, x[k]);
      hi = std::max(hi, x[k]);
    }
    lo -= radius;
    hi += radius;
    if (cut_near) {
      lo = std::max(lo, (*cut_near)[k] - random.logUniform(1e-4, 1));
      hi = std::min(hi, (*cut_near)[k] + random.logUniform(1e-4, 1));
    }
    const double part = random.uniform(), room = random.uniform() < 0.3 ? 1e-3 : std::max(1 - (hi - lo), 1e-6);
    window.lo[k] = lo - room * part - 1e-9;
    window.hi[k] = hi + room * (1 - part) + 1e-9;
  }
  return window;
}

}  // namespace

double AdversaryRandom::logUniform(double lo, double hi) {
  return std::exp(uniform(std::log(lo), std::log(hi)));
}

void addAdversary(std::uint64_t seed, std::uint64_t i, double gap, Batch& batch) {
  Maker make{AdversaryRandom(seed * 0x2545f4914f6cdd1du + i)};
  AdversaryRandom& random = make.random;
  const auto kind = gap > 0 ? AdversaryKind::tangent
                            : static_cast<AdversaryKind>(i % static_cast<std::uint64_t>(AdversaryKind::count));
  const double pixel = 1.0 / batch.resolution;  // of a window of side 1
  const double object_size = random.logUniform(1e-3 * pixel, 20), swept_size = random.logUniform(0.01 * pixel, 0.9);

  Vector3d object[8], swept[6], on_object, on_swept;
  int object_count = 3, swept_count = 3;
  double radius = 0;
  const Vector3d e = make.someDirection();
  make.triangle(e, make.across(e), object_size, object);
  on_object = make.pointOf(object);
  if (kind == AdversaryKind::triangles) {
    const Vector3d d = make.someDirection();
    make.triangle(d, make.across(d), swept_size, swept);
    on_swept = make.pointOf(swept);
  } else {
    // The hull of two segments or of two segments' ways, grown by a ball; and a point at most the radius from a point
    // of it.
    radius = swept_size * (random.uniform() < 0.3 ? random.logUniform(1e-4, 0.05) : random.uniform(0.05, 0.4));
    swept[0].setZero();
    swept[1] = make.someDirection() * (swept_size * random.uniform());
    for (int k = 2; k < 6; ++k) swept[k] = swept[k % 2] + make.direction() * (swept_size * random.uniform(0, 0.5));
    swept_count = kind == AdversaryKind::sweptHull ? (random.below(2) ? 6 : 4) : 2;
    double weights[6], sum = 0;
    for (int k = 0; k < swept_count; ++k) sum += weights[k] = random.uniform() < 0.3 ? 0 : random.uniform();
    Vector3d core = swept[0];
    if (sum > 0) {
      core.setZero();
      for (int k = 0; k < swept_count; ++k) core += swept[k] * (weights[k] / sum);
    }
    Vector3d n = make.someDirection();
    if (swept_count == 2 && random.uniform() < 0.7 && swept[1].norm() > 0) n = make.across(swept[1].normalized());
    if (kind == AdversaryKind::tangent) {
      const Vector3d f = make.across(n);
      make.triangle(f, n.cross(f), object_size, object);
      on_object = make.pointOf(object);
    }
    double depth = kind == AdversaryKind::deep ? random.uniform() : 1 - 1e-12;
    if (gap > 0) depth = 1 + gap * pixel / radius;
    if (kind == AdversaryKind::insideSolid) {
      // A box around the swept volume or around a part of it.
      const Eigen::Quaterniond turn =
          random.below(2) ? Eigen::Quaterniond::Identity()
                          : Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0, 6), make.direction()));
      const Vector3d half(random.logUniform(0.1, 20), random.logUniform(0.1, 20), random.logUniform(0.1, 20));
      object_count = 8;
      Vector3d inside;
      for (int k = 0; k < 3; ++k) inside[k] = half[k] * random.uniform(-1, 1);
      on_object = turn * inside;
      for (int c = 0; c < 8; ++c) {
        object[c] = turn * Vector3d(c & 1 ? half[0] : -half[0], c & 2 ? half[1] : -half[1], c & 4 ? half[2] : -half[2]);
      }
      depth = random.uniform();
    }
    on_swept = core + n * (radius * depth);
  }
  for (int k = 0; k < object_count; ++k) object[k] += on_swept - on_object;

  const bool cut = random.uniform() < 0.2 && gap == 0;
  const auto w = static_cast<std::int32_t>(batch.windows.size());
  batch.windows.push_back(
      windowAround(std::vector<Vector3d>(swept, swept + swept_count), radius, cut ? &on_swept : nullptr, random));
  batch.swept.push_back({addVolume(swept, swept_count, radius, batch), w});
  batch.objects.push_back({addVolume(object, object_count, 0, batch), w, batch.num_groups++});
}

std::uint64_t countWrongCulls(Executor& executor, Batch& batch, std::uint64_t seed, std::uint64_t begin,
                              std::uint64_t end, double gap, std::uint64_t* by_kind) {
  constexpr std::uint64_t kAtOnce = 256;
  std::uint64_t culled = 0;
  std::vector<std::uint8_t> may;
  for (std::uint64_t i = begin; i < end; i += kAtOnce) {
    batch.clear();
    for (std::uint64_t j = i; j < std::min(end, i + kAtOnce); ++j) addAdversary(seed, j, gap, batch);
    executor.run(batch, may);
    for (std::size_t j = 0; j < may.size(); ++j) {
      culled += !may[j];
      if (by_kind && !may[j]) ++by_kind[(i + j) % static_cast<std::uint64_t>(AdversaryKind::count)];
    }
  }
  return culled;
}

}  // namespace visibility
}  // namespace fcl_artic
