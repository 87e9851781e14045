// SPDX-License-Identifier: BSD-3-Clause
#include "oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace campaign {
namespace {

/// Least step in t: half a millimetre of motion, where that is a sensible share of the motion.
double leastStep(double speed) {
  return std::clamp(5e-4 / speed, 1.0 / 2048, 1.0 / 32);
}

struct Sample {
  double t = 0;
  Proximity p;
};

}  // namespace

Oracle::Oracle(const Scene& scene) : scene_(scene), kinematics_(scene) {}

Proximity Oracle::at(int a, int b, double t, double wanted, const Proximity& hint) const {
  return proximity(*scene_.bodies[static_cast<std::size_t>(a)].geometry, kinematics_.bodyPose(a, t),
                   *scene_.bodies[static_cast<std::size_t>(b)].geometry, kinematics_.bodyPose(b, t), scene_.margin,
                   wanted, hint);
}

template <bool kLeast>
PairTruth Oracle::march(int a, int b, double begin, double end, double beyond) const {
  PairTruth r;
  r.a = a, r.b = b;
  r.gap = beyond;
  const double speed = kinematics_.relativeSpeed(a, b);
  const double least_step = leastStep(speed);
  constexpr double kCoarse = 0.2;
  // A gap below `goal` is looked for: contact, or whatever is nearer than so far.
  const auto goal = [&] { return kLeast ? std::max(0.7 * r.gap, 0.0) : 0.0; };
  const auto note = [&](const Sample& s) {
    if (s.p.gap < r.gap) r.gap = s.p.gap, r.gap_time = s.t, r.direction = s.p.direction;
    if (s.p.touching && !r.doubtful && !r.hit) r.doubtful = true, r.time = s.t;
    return s.p.clear;
  };
  // Bisects between a time without and a time with a clear contact.
  const auto close = [&](double free, Sample hit) {
    while (hit.t - free > 1e-15 + 2e-15 * hit.t) {
      const double m = free + (hit.t - free) / 2;
      if (m <= free || m >= hit.t) break;
      Sample s{m, at(a, b, m, kCoarse, hit.p)};
      if (s.p.clear)
        hit = s;
      else
        free = m;
    }
    r.hit = true;
    r.doubtful = false;
    r.time = hit.t;
    r.gap = 0, r.gap_time = hit.t;
    r.direction = hit.p.direction;
  };
  const auto sample = [&](double t, const Proximity& hint) {
    Sample s{t, at(a, b, t, kCoarse, hint)};
    // Where the minimum matters the distance is wanted to its last digits.
    if (!s.p.clear && s.p.gap - goal() < 2 * speed * least_step) s.p = at(a, b, t, kLeast ? 1e-3 : 1e-2, s.p);
    return s;
  };

  Sample current = sample(begin, {});
  double before = begin;  // time of the sample before `current`
  bool falling = true;    // the gap fell towards `current`
  if (note(current)) {
    r.hit = true, r.time = begin, r.gap = 0, r.doubtful = false;
    return r;
  }
  while (current.t < end) {
    const double step = std::max((current.p.gap - goal()) / speed, least_step);
    Sample next = sample(std::min(current.t + step, end), current.p);
    if (note(next)) {
      close(current.t, next);
      return r;
    }
    // A minimum about `current`: between the samples on both sides of it the gap can be less than seen.
    const bool rising = next.p.gap >= current.p.gap;
    if ((falling && rising) || next.t >= end) {
      double lo = falling && rising ? before : current.t, hi = next.t;
      const double reach = speed * (hi - lo) / 2;
      if (std::min(current.p.gap, next.p.gap) - reach < goal()) {
        // Golden section; the gap need not be unimodal, so whatever is met on the way counts.
        constexpr double kGolden = 0.6180339887498949;
        Sample x, y;
        const auto look = [&](double t) { return Sample{t, at(a, b, t, 1e-5, current.p)}; };
        x = look(hi - kGolden * (hi - lo));
        y = look(lo + kGolden * (hi - lo));
        for (int i = 0; i < 60; ++i) {
          if (note(x)) {
            close(lo, x);
            return r;
          }
          if (note(y)) {
            close(x.t, y);
            return r;
          }
          const double best = std::min(x.p.gap, y.p.gap);
          const double floor = kLeast ? std::max(1e-3 * best, 1e-11) : best;
          if (speed * (hi - lo) < floor || hi - lo < 1e-11) break;
          if (x.p.gap <= y.p.gap) {
            hi = y.t;
            y = x;
            x = look(hi - kGolden * (hi - lo));
          } else {
            lo = x.t;
            x = y;
            y = look(lo + kGolden * (hi - lo));
          }
        }
      }
    }
    falling = !rising;
    before = current.t;
    current = next;
  }
  return r;
}

PairTruth Oracle::firstContact(int a, int b, double end, double begin) const {
  return march<false>(a, b, begin, end, kInfinity);
}

PairTruth Oracle::leastGap(int a, int b, double beyond, double begin, double end) const {
  return march<true>(a, b, begin, end, beyond);
}

Truth Oracle::judge(bool every) const {
  Truth truth;
  double nearest = kInfinity;
  for (const auto& [a, b] : kinematics_.pairs()) {
    PairTruth p = firstContact(a, b, every ? 1.0 : truth.time);
    const int index = static_cast<int>(truth.pairs.size());
    if (p.hit && (!truth.hit || p.time < truth.time)) {
      truth.hit = true;
      truth.time = p.time;
      truth.first = index;
    } else if (!truth.hit && p.gap < nearest) {
      truth.first = index;
    }
    nearest = std::min(nearest, p.gap);
    truth.doubtful |= p.doubtful;
    truth.pairs.push_back(p);
  }
  return truth;
}

}  // namespace campaign
