// SPDX-License-Identifier: BSD-3-Clause
//
// A chain of factors over eight time intervals: bounds on all its frames, and their poses and derivatives in the
// intervals' middles (doc/NUMERICS.md, "Chains"). Symbols: motion/remainder.h.
#pragma once

#include "motion/factors.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::SweepView;

/// A step under one query: bounds on its frame over the present intervals, and its variables.
struct StepBounds : MotionBounds {
  Rates rates_parent;  ///< without its own factor when that is revolute
  double slide_rate;   ///< of the first derivatives of all slides up to here, summed
  FactorVariables variables;
  const double* orientation;  ///< a turn's R0, null: none
};

inline FactorBounds boundFactor(const SweepStep& step, const engine::Query& query, double begin, double end,
                                FactorVariables& variables) {
  variables.degree = 0;
  if (step.kind == StepKind::bounded) return boundBounded(step, begin, end);
  VariableBounds q;
  boundVariables(step, query, begin, end, variables, q);
  if (step.kind == StepKind::revolute) return boundRevolute(q, query.degree);
  if (step.kind == StepKind::turn) return boundTurn(q, query.degree, step.orientation >= 0);
  return boundSlide(q, query.degree);
}

/// All bounds of a sweep under one motion, for t in [begin, end]. Derivation: doc/NUMERICS.md, "Chains".
inline void boundSteps(const SweepView& sweep, const engine::Query& query, double begin, double end, StepBounds* out) {
  for (int i = 0; i < sweep.num_steps; ++i) {
    const SweepStep& step = sweep.steps[i];
    StepBounds& b = out[i];
    static const StepBounds kBase = {};
    const StepBounds& p = step.parent >= 0 ? out[step.parent] : kBase;
    b.orientation = step.orientation >= 0 ? query.orientations + 9 * step.orientation : nullptr;
    const FactorBounds factor = boundFactor(step, query, begin, end, b.variables);

    const Rates r = p.rates, s = p.rates_parent;
    b.rates = {r.a + factor.turn[0], r.b + factor.turn[1], r.c + factor.turn[2]};
    b.rates_parent = step.kind == StepKind::revolute ? r : b.rates;
    // The offset p turns with the parent's frame: across its last axis at rate r, along it at the rate before.
    b.D1 = p.D1 + r.first() * step.perp + s.first() * step.axial;
    b.D2 = p.D2 + r.second() * step.perp + s.second() * step.axial;
    b.D3 = p.D3 + r.third() * step.perp + s.third() * step.axial;
    b.slide_rate = p.slide_rate;
    if (!turns(step.kind)) {  // Leibniz for the slide, in that frame, too
      const double* m = factor.slide;
      b.slide_rate += m[1];
      b.D1 += r.first() * m[0] + m[1];
      b.D2 += r.second() * m[0] + 2 * r.first() * m[1] + m[2];
      b.D3 += r.third() * m[0] + 3 * r.second() * m[1] + 3 * r.first() * m[2] + m[3];
    }
    b.length = p.length + step.length + factor.length;
    // The constant transform, and the step's own arithmetic.
    b.ulps = p.ulps + step.ulps + kStepUlps + factor.ulps;
    b.rounding_rate = p.rounding_rate + factor.rounding_rate;
  }
}

/// The frame of one step over a batch of intervals; its parent's is in `out` already.
FCL_ARTIC_INLINE void evaluateStep(const SweepView& sweep, int index, const StepBounds* bounds, const Lanes& tm,
                                   double d, FrameLanes* out) {
  const Vec3Lanes zero = spread(Vec3(0, 0, 0));
  const SweepStep& step = sweep.steps[index];
  const FactorVariables& variables = bounds[index].variables;
  const FrameLanes* g = step.parent >= 0 ? &out[step.parent] : nullptr;
  FrameLanes& f = out[index];
  // The frame in which the factor acts: its axes, and r from the parent's origin to the factor's.
  Mat3Lanes axes = g ? g->R * Mat3(step.C) : spread(Mat3(step.C));
  Vec3Lanes r = g ? g->R * Vec3(step.p) : spread(Vec3(step.p));
  f.w = g ? g->w : zero;
  f.al = g ? g->al : zero;

  SlideLanes slide;
  bool slides = true;
  switch (step.kind) {
    case StepKind::revolute:
      turnAboutZ(evaluateOnly(variables, tm, d), variables.degree > 1, g, axes, f);
      slides = false;
      break;
    case StepKind::prismatic:
      slide = slideAlongZ(evaluateOnly(variables, tm, d), axes);
      f.R = axes;
      break;
    case StepKind::slide: {
      const ThreeVariables x(variables, tm, d);
      slide = slideBy(x.q, x.q1, x.q2, axes);
      f.R = axes;
      break;
    }
    case StepKind::turn: {
      const double* R0 = bounds[index].orientation;
      TurnLanes turn;
      turnByVector(ThreeVariables(variables, tm, d), turn);
      if (R0 && step.inverse) axes = axes * transposed(Mat3(R0));
      turnFrame(turn, g, axes, f);
      if (R0 && !step.inverse) f.R = f.R * Mat3(R0);
      slides = false;
      break;
    }
    case StepKind::bounded: {
      TurnLanes turn;
      evaluateBounded(step, tm, d, turn, slide);
      slide = slideBy(slide.r, slide.r1, slide.r2, axes);
      turnFrame(turn, g, axes, f);
      break;
    }
  }

  // The origin: o = o_g + r, with r fixed in the parent's frame but for the slide.
  if (slides) r = r + slide.r;
  if (g) {
    const Vec3Lanes wr = cross(g->w, r);
    f.o = g->o + r;
    f.v = g->v + wr;
    f.a = g->a + (cross(g->al, r) + cross(g->w, wr)) * Lanes(0.5);
  } else {
    f.o = r;
    f.v = f.a = zero;
  }
  if (slides) {
    if (g) f.a = f.a + cross(g->w, slide.r1);  // 2 w x r' of the Coriolis term, halved
    f.v = f.v + slide.r1;
    f.a = mulAdd(slide.r2, Lanes(0.5), f.a);
  }
  // Where some derivative isn't known the remainder is all of the motion (remainderOf). A child sees none either.
  if (sweep.first_order) f.w = f.al = f.v = f.a = zero;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
