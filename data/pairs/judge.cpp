// SPDX-License-Identifier: BSD-3-Clause
#include "pairs/judge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pairs/constants.h"

namespace pairs {
namespace {

double relativeSpeed(const PairQuery& q) {
  // If a body is unbounded, only its part near the other body counts.
  const double between = q.path1->extent() + q.path2->extent();
  const double reach1 = q.body1->unbounded() ? between + q.body2->reach : q.body1->reach;
  const double reach2 = q.body2->unbounded() ? between + q.body1->reach : q.body2->reach;
  return q.path1->speed(reach1) + q.path2->speed(reach2) + 1e-9;
}

}  // namespace

std::string describe(const PairQuery& q) {
  const auto body = [](const Body& b, const Path& p) {
    const std::string size = b.kind == Kind::mesh ? " of " + std::to_string(b.numPieces()) + " triangles" : "";
    return kindName(b.kind) + size + " by " + p.name();
  };
  return q.family + " " + std::to_string(q.seed) + ": " + body(*q.body1, *q.path1) + ", " + body(*q.body2, *q.path2);
}

Judge::Judge(const PairQuery& query, Look look) : query_(query), look_(std::move(look)), speed_(relativeSpeed(query)) {
  if (look_) return;
  look_ = [this](const Pose& M_1, const Pose& M_2, double wanted, const Nearness& hint) {
    return nearness(*query_.body1, M_1, *query_.body2, M_2, wanted, hint);
  };
}

Nearness Judge::at(double t, double wanted, const Nearness& hint) const {
  return look_(query_.path1->pose(t), query_.path2->pose(t), wanted, hint);
}

template <bool kLeast>
Truth Judge::march(double begin, double end) const {
  struct Sample {
    double t = 0;
    Nearness p;
  };
  constexpr double kCoarse = 0.2;
  // Half a millimetre of motion, where that is a sensible share of the motion.
  const double least_step = std::clamp(5e-4 / speed_, 1.0 / 2048, 1.0 / 32);
  Truth truth;
  truth.gap = kInfinity;
  // A gap below the goal is looked for: contact, or whatever is nearer than so far.
  const auto goal = [&] { return kLeast ? std::max(0.7 * truth.gap, 0.0) : 0.0; };
  const auto note = [&](const Sample& s) {
    // A least gap is one that was seen; to judge by, it is a lower bound of what was seen.
    const double gap = kLeast ? s.p.upper : s.p.gap;
    if (gap < truth.gap) truth.gap = gap, truth.gap_time = s.t, truth.direction = s.p.direction;
    return s.p.clear;
  };
  const auto look = [&](double t, double wanted, const Nearness& hint) { return Sample{t, at(t, wanted, hint)}; };
  const auto sample = [&](double t, const Nearness& hint) {
    Sample s = look(t, kCoarse, hint);
    // Where a minimum may matter the distance is wanted more closely.
    if (!s.p.clear && !(s.p.gap - goal() >= 2 * speed_ * least_step)) s = look(t, kLeast ? 1e-3 : 1e-2, s.p);
    return s;
  };
  // Bisects between a time without and a time with a clear contact.
  const auto close = [&](double free, Sample hit) {
    while (hit.t - free > 1e-15 + 2e-15 * hit.t) {
      const Sample middle = look(free + (hit.t - free) / 2, kCoarse, hit.p);
      if (middle.p.clear) {
        hit = middle;
      } else {
        free = middle.t;
      }
    }
    truth.hit = true;
    truth.time = truth.gap_time = hit.t;
    truth.gap = 0;
    truth.direction = hit.p.direction;
    return truth;
  };

  Sample current = sample(begin, {});
  double before = begin;  // time of the sample before `current`
  bool falling = true;    // the gap fell towards `current`
  if (note(current)) return close(begin, current);
  while (current.t < end) {
    const double step = std::clamp((current.p.gap - goal()) / speed_, least_step, 1.0 / 32);
    const Sample next = sample(std::min(current.t + step, end), current.p);
    if (note(next)) return close(current.t, next);
    // A minimum about `current`: between the samples on both sides of it the gap can be less than seen.
    const bool rising = next.p.gap >= current.p.gap;
    if ((falling && rising) || next.t >= end) {
      double lo = falling && rising ? before : current.t, hi = next.t;
      if (std::min(current.p.gap, next.p.gap) - speed_ * (hi - lo) / 2 < (kLeast ? truth.gap : 0)) {
        // Golden section; the gap need not be unimodal, so whatever is met on the way counts.
        constexpr double kGolden = 0.6180339887498949, kFine = 1e-5;
        Sample x = look(hi - kGolden * (hi - lo), kFine, current.p),
               y = look(lo + kGolden * (hi - lo), kFine, current.p);
        for (int i = 0; i < 60; ++i) {
          if (note(x)) return close(lo, x);
          if (note(y)) return close(x.t, y);
          const double best = std::min(x.p.gap, y.p.gap);
          if (speed_ * (hi - lo) < (kLeast ? std::max(1e-3 * best, 1e-11) : best) || hi - lo < 1e-11) break;
          if (x.p.gap <= y.p.gap) {
            hi = y.t;
            y = x;
            x = look(hi - kGolden * (hi - lo), kFine, y.p);
          } else {
            lo = x.t;
            x = y;
            y = look(lo + kGolden * (hi - lo), kFine, x.p);
          }
        }
      }
    }
    falling = !rising;
    before = current.t;
    current = next;
  }
  return truth;
}

Truth Judge::firstContact(double begin, double end) const {
  return march<false>(begin, end);
}
Truth Judge::leastGap() const {
  return march<true>(0, 1);
}

}  // namespace pairs
