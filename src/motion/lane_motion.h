// SPDX-License-Identifier: BSD-3-Clause
//
// Motion of frames and of pairs over eight time intervals at once, as a quadratic with an a-priori remainder.
//
// Symbols: interval of lane i: [tm_i - d, tm_i + d], the same d in all lanes; tau = (t - tm) / d in [-1, 1].
//   X(t) = X0 + tau X1 + tau^2 X2 + e,   |e| <= D3 d^3 / 6   (X a rotation or a position; X1 = d X', X2 = d^2/2 X'')
//   s: sum of the rates of the revolute joints passed; |R^(n)| <= s^n (doc/NUMERICS.md, Lemma 1)
//   D1, D2, D3: constants of the motion with |o^(n)| <= Dn for the frame's origin o, over all of [0, 1] (Lemma 2)
//   b_k: Bernstein points X0 - X1 + X2, X0 - X2, X0 + X1 + X2: X0 + tau X1 + tau^2 X2 lies in their hull
#pragma once

#include "narrowphase/buffer.h"
#include "narrowphase/problem.h"
#include "numerics/lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Placement;
using engine::SweepStep;
using engine::SweepView;

/// 2^-52: bounds the relative error of one operation in any rounding mode.
constexpr double kUlp = 2.220446049250313e-16;
/// Roundings of one step of a chain; of certificate and swept boxes on top of a chain, twice what they come to; of a
/// difference point at a pose (doc/NUMERICS.md, "Pads").
constexpr double kStepUlps = 24, kCertificateUlps = 160, kPoseUlps = 40;
/// No claim is made about lengths below this, in m. It stands far above whatever underflow, gradual or flushed, can do.
constexpr double kLeastLength = 1e-40;

/// Pose and scaled derivatives of a step's frame (o + R c for a point c fixed in it): R1 = [w] R0,
/// R2 = ([al] + [w][w]) R0 / 2, o1 = v, o2 = a.
struct FrameLanes {
  Lanes R[9], o[3], w[3], al[3], v[3], a[3];
};

/// Constants of a step for one query.
struct StepBounds {
  double q0, dq;
  double s, s_parent;  ///< rotation rate up to and with this step; without its last revolute joint
  double D1, D2, D3;   ///< of the origin
  double length;       ///< |o(t)| and all numbers it is made of, summed
  double ulps;         ///< error of the rotation in kUlp, of the origin in kUlp * length
};

/// All bounds of a sweep under one motion. Derivation: doc/NUMERICS.md, "Chains of revolute and prismatic joints".
inline void boundSteps(const SweepView& sweep, const double* q0, const double* dq, StepBounds* out) {
  for (int i = 0; i < sweep.num_steps; ++i) {
    const SweepStep& step = sweep.steps[i];
    StepBounds b;
    const StepBounds* p = step.parent >= 0 ? &out[step.parent] : nullptr;
    b.q0 = step.multiplier * q0[step.variable] + step.offset;
    b.dq = step.multiplier * dq[step.variable];
    // Of the numbers that q comes from, not of q: multiple and offset of a mimic joint may cancel.
    const double rate = __builtin_fabs(b.dq), size = __builtin_fabs(step.multiplier * q0[step.variable]) +
                                                     __builtin_fabs(step.offset) + rate;
    const double sp = p ? p->s : 0, spp = p ? p->s_parent : 0;
    b.D1 = p ? p->D1 : 0;
    b.D2 = p ? p->D2 : 0;
    b.D3 = p ? p->D3 : 0;
    b.length = (p ? p->length : 0) + step.length;
    // The offset p turns with the parent's frame: across its last axis at rate s, along it at the rate before.
    b.D1 += sp * step.perp + spp * step.axial;
    b.D2 += sp * sp * step.perp + spp * spp * step.axial;
    b.D3 += sp * sp * sp * step.perp + spp * spp * spp * step.axial;
    // The constant transform, the step's own arithmetic, and q: off by 3 ulp of its size.
    b.ulps = (p ? p->ulps : 0) + step.ulps + kStepUlps;
    if (step.revolute) {
      b.s = sp + rate;
      b.s_parent = sp;
      b.ulps += 3 * size;
    } else {
      b.s = b.s_parent = sp;  // the axial split needs a revolute parent (FrameSweep sees to it)
      // l(t) = p + q(t) z: |q| <= size and |q'| = rate.
      b.D1 += sp * size + rate;
      b.D2 += sp * sp * size + 2 * sp * rate;
      b.D3 += sp * sp * sp * size + 3 * sp * sp * rate;
      b.length += size;
    }
    out[i] = b;
  }
}

/// Frames of the steps over a batch of intervals.
inline void evaluateSweep(const SweepView& sweep, const StepBounds* bounds, const Lanes& tm, double d,
                          FrameLanes* out) {
  for (int i = 0; i < sweep.num_steps; ++i) {
    const SweepStep& step = sweep.steps[i];
    FrameLanes& f = out[i];
    const Lanes q = mulAdd(tm, Lanes(bounds[i].dq), bounds[i].q0);
    const Lanes dqd(bounds[i].dq * d);
    Lanes s(0.0), c(1.0);
    if (step.revolute) sineCosine(q, s, c);
    const double *C = step.C, *p = step.p;
    if (step.parent < 0) {
      for (int k = 0; k < 3; ++k) {
        const Lanes x(C[3 * k]), y(C[3 * k + 1]), z(C[3 * k + 2]);
        f.al[k] = f.a[k] = Lanes(0.0);
        if (step.revolute) {
          f.R[3 * k] = mulAdd(x, c, y * s);
          f.R[3 * k + 1] = y * c - x * s;
          f.R[3 * k + 2] = z;
          f.o[k] = Lanes(p[k]);
          f.w[k] = z * dqd;
          f.v[k] = Lanes(0.0);
        } else {
          f.R[3 * k] = x;
          f.R[3 * k + 1] = y;
          f.R[3 * k + 2] = z;
          f.o[k] = mulAdd(z, q, p[k]);
          f.w[k] = Lanes(0.0);
          f.v[k] = z * dqd;
        }
      }
      continue;
    }
    const FrameLanes& g = out[step.parent];
    Lanes r[3], x[3], y[3], z[3], t[3], u[3], e[3];
    for (int k = 0; k < 3; ++k) {
      const Lanes *R = g.R + 3 * k;
      r[k] = mulAdd(R[0], p[0], mulAdd(R[1], p[1], R[2] * Lanes(p[2])));
      x[k] = mulAdd(R[0], C[0], mulAdd(R[1], C[3], R[2] * Lanes(C[6])));
      y[k] = mulAdd(R[0], C[1], mulAdd(R[1], C[4], R[2] * Lanes(C[7])));
      z[k] = mulAdd(R[0], C[2], mulAdd(R[1], C[5], R[2] * Lanes(C[8])));
    }
    if (!step.revolute) {
      for (int k = 0; k < 3; ++k) r[k] = mulAdd(z[k], q, r[k]);
    }
    cross(g.w, r, t);
    cross(g.w, t, u);
    cross(g.al, r, e);
    for (int k = 0; k < 3; ++k) {
      f.o[k] = g.o[k] + r[k];
      f.v[k] = g.v[k] + t[k];
      f.a[k] = g.a[k] + Lanes(0.5) * (e[k] + u[k]);
    }
    cross(g.w, z, t);
    for (int k = 0; k < 3; ++k) {
      if (step.revolute) {
        f.R[3 * k] = mulAdd(x[k], c, y[k] * s);
        f.R[3 * k + 1] = y[k] * c - x[k] * s;
        f.w[k] = mulAdd(z[k], dqd, g.w[k]);
        f.al[k] = mulAdd(t[k], dqd, g.al[k]);
      } else {
        f.R[3 * k] = x[k];
        f.R[3 * k + 1] = y[k];
        f.w[k] = g.w[k];
        f.al[k] = g.al[k];
        f.v[k] = mulAdd(z[k], dqd, f.v[k]);
        f.a[k] = mulAdd(t[k], dqd, f.a[k]);  // 2 w x z q' of the Coriolis term, halved
      }
      f.R[3 * k + 2] = z[k];
    }
  }
}

/// Motion of a body's tree frame in another's: quadratic and Bernstein points. Entry [k][...]: order k, or point k.
struct RigidLanes {
  Lanes R[3][9], c[3][3];    ///< X0, X1, X2
  Lanes Rb[3][9], cb[3][3];  ///< Bernstein points
  Lanes spread[9];           ///< largest |Rb| of the three, entry by entry
  double rem_c = 0, rem_R = 0;  ///< |error| of a point p: rem_c + rem_R |p|

  void makeBernstein() {
    for (int i = 0; i < 9; ++i) {
      const Lanes e = R[0][i] + R[2][i];
      Rb[0][i] = e - R[1][i];
      Rb[1][i] = R[0][i] - R[2][i];
      Rb[2][i] = e + R[1][i];
      spread[i] = max(abs(e) + abs(R[1][i]), abs(Rb[1][i]));
    }
    for (int i = 0; i < 3; ++i) {
      const Lanes e = c[0][i] + c[2][i];
      cb[0][i] = e - c[1][i];
      cb[1][i] = c[0][i] - c[2][i];
      cb[2][i] = e + c[1][i];
    }
  }
};

/// Quadratic of the frame carried by `f` with the constant placement behind it; f null: stands still.
inline void placeBehind(const FrameLanes* f, const Placement& P, RigidLanes& m) {
  if (!f) {
    for (int i = 0; i < 9; ++i) {
      m.R[0][i] = Lanes(P.R[i]);
      m.R[1][i] = m.R[2][i] = Lanes(0.0);
    }
    for (int i = 0; i < 3; ++i) {
      m.c[0][i] = Lanes(P.t[i]);
      m.c[1][i] = m.c[2][i] = Lanes(0.0);
    }
    return;
  }
  const auto derivatives = [&](const Lanes* x, Lanes* x1, Lanes* x2) {
    Lanes u[3], e[3];
    cross(f->w, x, x1);
    cross(f->w, x1, u);
    cross(f->al, x, e);
    for (int k = 0; k < 3; ++k) x2[k] = Lanes(0.5) * (u[k] + e[k]);
  };
  for (int j = 0; j < 3; ++j) {
    Lanes x[3], x1[3], x2[3];
    for (int k = 0; k < 3; ++k) {
      const Lanes* R = f->R + 3 * k;
      x[k] = P.identity ? R[j] : mulAdd(R[0], P.R[j], mulAdd(R[1], P.R[3 + j], R[2] * Lanes(P.R[6 + j])));
    }
    derivatives(x, x1, x2);
    for (int k = 0; k < 3; ++k) {
      m.R[0][3 * k + j] = x[k];
      m.R[1][3 * k + j] = x1[k];
      m.R[2][3 * k + j] = x2[k];
    }
  }
  if (P.identity) {
    for (int k = 0; k < 3; ++k) {
      m.c[0][k] = f->o[k];
      m.c[1][k] = f->v[k];
      m.c[2][k] = f->a[k];
    }
    return;
  }
  Lanes x[3], x1[3], x2[3];
  for (int k = 0; k < 3; ++k) {
    const Lanes* R = f->R + 3 * k;
    x[k] = mulAdd(R[0], P.t[0], mulAdd(R[1], P.t[1], R[2] * Lanes(P.t[2])));
  }
  derivatives(x, x1, x2);
  for (int k = 0; k < 3; ++k) {
    m.c[0][k] = f->o[k] + x[k];
    m.c[1][k] = f->v[k] + x1[k];
    m.c[2][k] = f->a[k] + x2[k];
  }
}

/// The same motion seen from a frame that stands at P^-1 in front: M <- P M.
inline void placeInFront(const Placement& P, RigidLanes& m) {
  if (P.identity) return;
  for (int order = 0; order < 3; ++order) {
    for (int j = 0; j < 3; ++j) {
      const Lanes x = m.R[order][j], y = m.R[order][3 + j], z = m.R[order][6 + j];
      for (int k = 0; k < 3; ++k) {
        m.R[order][3 * k + j] = mulAdd(x, P.R[3 * k], mulAdd(y, P.R[3 * k + 1], z * Lanes(P.R[3 * k + 2])));
      }
    }
    const Lanes x = m.c[order][0], y = m.c[order][1], z = m.c[order][2];
    for (int k = 0; k < 3; ++k) {
      m.c[order][k] = mulAdd(x, P.R[3 * k], mulAdd(y, P.R[3 * k + 1], z * Lanes(P.R[3 * k + 2])));
      if (order == 0) m.c[0][k] = m.c[0][k] + Lanes(P.t[k]);
    }
  }
}

/// A seen from B where `m` is B seen from A: R^T and -R^T c, by Cauchy products of the quadratics.
inline void invert(const RigidLanes& m, RigidLanes& inverse) {
  for (int order = 0; order < 3; ++order) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) inverse.R[order][3 * i + j] = m.R[order][3 * j + i];
      Lanes sum(0.0);
      for (int k = 0; k <= order; ++k) {
        const Lanes *R = m.R[k], *c = m.c[order - k];
        sum = sum + mulAdd(R[i], c[0], mulAdd(R[3 + i], c[1], R[6 + i] * c[2]));
      }
      inverse.c[order][i] = -sum;
    }
  }
}

/// Rounding of all that a certificate or swept box is made of, as a part of the sizes. The error of X0, X1 and X2 is at
/// most e, 2 e x and 2.25 e x^2 with e = kUlp * ulps and x = s d; inverting makes that 2 e, 6 e x and 9.5 e x^2.
inline double roundingPart(double ulps, double x) {
  return kUlp * (2 * ulps + kCertificateUlps) * ((1 + 2.5 * x) * (1 + 2.5 * x));
}
/// d^3 / 6, with room for the rounding of the constants it multiplies and of what it is added to.
inline double remainderFactor(double ulps, double d) {
  return d * d * d / 6 * (1 + kUlp * (2 * ulps + kCertificateUlps));
}

/// Bounds on rounding that go with a RigidLanes and its inverse.
struct PairPads {
  double pad;   ///< of a certificate or swept box, either way
  double pose;  ///< of a difference point at tm
};

/// B seen from A (`m`) and A seen from B, with remainders and pads.
/// @param frame  of the step that carries B, seen from the base frame; null where B stands still in it.
/// @param b  of that step; all zero where B stands still.
/// @param extents  largest distances of points of A and of B from their frames' origins, summed.
inline PairPads relateBodies(const FrameLanes* frame, const StepBounds& b, const Placement& inverse_a,
                             const Placement& placement_b, double extents, double margin, double d, RigidLanes& m,
                             RigidLanes& inverse) {
  placeBehind(frame, placement_b, m);
  placeInFront(inverse_a, m);
  invert(m, inverse);
  m.makeBernstein();
  inverse.makeBernstein();

  // Bounds of B's origin seen from A's frame: a point fixed at distance `l` in the step's frame adds s^n l.
  const double l = placement_b.length, s = b.s;
  const double D1 = b.D1 + s * l, D2 = b.D2 + s * s * l, D3 = b.D3 + s * s * s * l;
  const double length = b.length + l + inverse_a.length;  // >= |c(t)|
  const double ulps = b.ulps + placement_b.ulps + inverse_a.ulps;
  const double third = remainderFactor(ulps, d);
  m.rem_c = D3 * third;
  m.rem_R = inverse.rem_R = s * s * s * third;
  // -R^T c: Leibniz with |R^(n)| <= s^n, |c| <= length, |c^(n)| <= Dn.
  inverse.rem_c = (D3 + 3 * s * D2 + 3 * s * s * D1 + s * s * s * length) * third;
  const double sizes = length + D1 * d + extents;
  return {roundingPart(ulps, s * d) * (sizes + margin) + kLeastLength, kUlp * (ulps + kPoseUlps) * sizes + kLeastLength};
}

/// Box of a ball that is fixed in a step's frame, over the intervals.
/// @param radius  with the error of p in it.
inline void sweepBall(const FrameLanes& f, const StepBounds& b, const double* p, double radius, double d, Lanes* lo,
                      Lanes* hi) {
  const double reach = __builtin_sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) * (1 + 1e-15), s = b.s;
  const double sizes = b.length + b.D1 * d + reach + radius;
  const Lanes slack(radius + (b.D3 + s * s * s * reach) * remainderFactor(b.ulps, d) +
                    roundingPart(b.ulps, s * d) * sizes + kLeastLength);
  Lanes x[3], x1[3], u[3], e[3];
  for (int k = 0; k < 3; ++k) x[k] = dot(f.R + 3 * k, p);
  cross(f.w, x, x1);
  cross(f.w, x1, u);
  cross(f.al, x, e);
  for (int k = 0; k < 3; ++k) {
    const Lanes c0 = f.o[k] + x[k], c1 = f.v[k] + x1[k], c2 = f.a[k] + Lanes(0.5) * (u[k] + e[k]);
    const Lanes sum = c0 + c2, middle = c0 - c2, reach1 = abs(c1);
    lo[k] = min(sum - reach1, middle) - slack;
    hi[k] = max(sum + reach1, middle) + slack;
  }
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
