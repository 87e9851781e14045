// SPDX-License-Identifier: BSD-3-Clause
//
// The factors that a motion is made of (model/sweep.h, StepKind): each with its bounds and its evaluation over eight
// time intervals, side by side.
#pragma once

#include "motion/factor_variables.h"
#include "numerics/vec3.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// The terms that a factor adds to the bounds of the chain before it.
struct FactorBounds {
  double turn[3] = {};   ///< of the first three derivatives of its angles
  double slide[4] = {};  ///< of the slide's length and its first three derivatives
  double length = 0;     ///< numbers that the slide is made of, and its error in kUlp
  double ulps = 0;       ///< error of its rotation, in kUlp
  double rounding_rate = 0;
};

/// Poses of a step's frame and their scaled derivatives, seen from the base frame (o + R c for a point c fixed in it):
/// R1 = [w] R0, R2 = ([al] + [w][w]) R0 / 2, o1 = v, o2 = a.
struct FrameLanes {
  Mat3Lanes R;
  Vec3Lanes o, w, al, v, a;
};

/// A slide seen from the base frame, with its first two derivatives by tau.
struct SlideLanes {
  Vec3Lanes r, r1, r2;
};

/// Values and derivatives by tau of three variables in a row.
struct ThreeVariables {
  Vec3Lanes q, q1, q2;
  FCL_ARTIC_INLINE ThreeVariables(const FactorVariables& variables, const Lanes& tm, double d) {
    for (int row = 0; row < 3; ++row) {
      const VariableLanes x = evaluateVariable(variables, row, tm, d);
      q[row] = x.q;
      q1[row] = x.q1;
      q2[row] = x.q2;
    }
  }
};

// --- revolute: a turn about z by q.

inline FactorBounds boundRevolute(const VariableBounds& q, int degree) {
  FactorBounds bounds;
  for (int n = 0; n < 3; ++n) bounds.turn[n] = q.m[n + 1];
  bounds.rounding_rate = q.roundingRate();
  bounds.ulps = 3 * degree * q.size;  // q is off by that many kUlp
  return bounds;
}

/// @param g  the frame before; null: the base frame.
/// @param axes  the frame in which the factor acts, seen from the base frame.
/// @param[in,out] f  w and al: in, those of the frame before.
FCL_ARTIC_INLINE void turnAboutZ(const VariableLanes& q, bool accelerates, const FrameLanes* g, const Mat3Lanes& axes,
                                 FrameLanes& f) {
  const Vec3Lanes x = axes.column(0), y = axes.column(1), z = axes.column(2);
  Lanes s, c;
  sineCosine(q.q, s, c);
  f.R = columns(mulAdd(x, c, y * s), y * c - x * s, z);
  if (g) f.al = mulAdd(cross(g->w, z), q.q1, f.al);
  f.w = mulAdd(z, q.q1, f.w);
  if (accelerates) f.al = mulAdd(z, q.q2, f.al);
}

// --- prismatic: a slide along z by q; slide: by a vector q.

inline FactorBounds boundSlide(const VariableBounds& q, int degree) {
  FactorBounds bounds;
  for (int n = 0; n < 4; ++n) bounds.slide[n] = q.m[n];
  bounds.length = degree * q.size;  // q is off by 3 degree kUlp of its size, less than ulps give it
  return bounds;
}
FCL_ARTIC_INLINE SlideLanes slideAlongZ(const VariableLanes& q, const Mat3Lanes& axes) {
  const Vec3Lanes z = axes.column(2);
  return {z * q.q, z * q.q1, z * q.q2};
}
FCL_ARTIC_INLINE SlideLanes slideBy(const Vec3Lanes& q, const Vec3Lanes& q1, const Vec3Lanes& q2,
                                    const Mat3Lanes& axes) {
  return {axes * q, axes * q1, axes * q2};
}

// --- turn: exp([q]) R0, or of -q the inverse.

inline FactorBounds boundTurn(const VariableBounds& q, int degree, bool orientation) {
  FactorBounds bounds;
  for (int n = 0; n < 3; ++n) bounds.turn[n] = q.m[n + 1];
  bounds.rounding_rate = q.roundingRate();
  bounds.ulps = kTurnUlps + (6 * degree + 16) * q.size;
  if (orientation) bounds.ulps += kStepUlps;  // one more stored rotation and product
  return bounds;
}

/// A rotation with its angular velocity and acceleration by tau, seen from the frame before it.
struct TurnLanes {
  Mat3Lanes J;
  Vec3Lanes w, al;
};

/// exp([q]) with its angular velocity and acceleration, from q and its derivatives. With g = |q|^2:
/// R = cos + a [q] + b q q^T, w = q' + b q x q' + c q x (q x q'), a = sin/theta, b = (1 - cos)/g, c = (1 - a)/g.
inline void turnByVector(const ThreeVariables& x, TurnLanes& out) {
  const Vec3Lanes &q = x.q, &q1 = x.q1, &q2 = x.q2;
  const Lanes g = dot(q, q), theta = sqrt(g);
  Lanes sine, cosine, a, b, c, bg, cg;  // bg, cg: derivatives by g
  sineCosine(theta, sine, cosine);
  for (int i = 0; i < kLanes; ++i) {
    const double y = g[i];
    double A = 0, B = 0, C = 0, Bg = 0, Cg = 0;
    if (y < 0.5) {      // the series; 10 terms leave less than 1e-22
      double term = 1;  // (-y)^k / (2k + 1)!
      for (int k = 0; k < 10; ++k) {
        A += term;
        B += term / (2 * k + 2);
        C += term / ((2 * k + 2) * (2 * k + 3));
        // d/dy (-y)^(k+1) = -(k+1) (-y)^k, over (2k + 4)! and (2k + 5)!
        const double next = -(k + 1) * term / ((2 * k + 2) * (2 * k + 3));
        Bg += next / (2 * k + 4);
        Cg += next / ((2 * k + 4) * (2 * k + 5));
        term *= -y / ((2 * k + 2) * (2 * k + 3));
      }
    } else {
      A = sine[i] / theta[i];
      B = (1 - cosine[i]) / y;
      C = (1 - A) / y;
      const double Ag = (cosine[i] - A) / (2 * y);
      Bg = (A - 2 * B) / (2 * y);
      Cg = (-Ag - C) / y;
    }
    a.set(i, A);
    b.set(i, B);
    c.set(i, C);
    bg.set(i, Bg);
    cg.set(i, Cg);
  }
  const Vec3Lanes bq = q * b, e = q * a;
  out.J = {{bq[0] * q[0] + cosine, bq[0] * q[1] - e[2], bq[0] * q[2] + e[1]},
           {bq[1] * q[0] + e[2], bq[1] * q[1] + cosine, bq[1] * q[2] - e[0]},
           {bq[2] * q[0] - e[1], bq[2] * q[1] + e[0], bq[2] * q[2] + cosine}};
  const Lanes g1 = Lanes(2.0) * dot(q, q1);
  const Vec3Lanes u = cross(q, q1), uu = cross(q, u), s = cross(q, q2), t = cross(q1, u), tt = cross(q, s);
  out.w = q1 + u * b + uu * c;
  out.al = q2 + u * (bg * g1) + s * b + uu * (cg * g1) + (t + tt) * c;
}

/// Turns the axes; f as for turnAboutZ().
inline void turnFrame(const TurnLanes& turn, const FrameLanes* g, const Mat3Lanes& axes, FrameLanes& f) {
  f.R = axes * turn.J;
  const Vec3Lanes w = axes * turn.w;
  if (g) f.al = f.al + cross(g->w, w);
  f.w = f.w + w;
  f.al = f.al + axes * turn.al;
}

// --- bounded: what the author of a motion says of it, or its inverse.

inline FactorBounds boundBounded(const SweepStep& step, double begin, double end) {
  double state[24], m[6];
  const engine::BoundedSource& source = *step.source;
  source.state(source.self, 0.5 * (begin + end), state);
  source.bounds(source.self, begin, end, m);
  const double size = norm(Vec3(state + 9)) + 0.5 * (end - begin) * m[0];
  FactorBounds bounds;
  for (int n = 0; n < 3; ++n) bounds.turn[n] = m[n + 3];
  bounds.slide[0] = size;
  if (step.inverse) {  // the origin is -R^T c
    const Rates own = {m[3], m[4], m[5]};
    bounds.slide[1] = own.first() * size + m[0];
    bounds.slide[2] = own.second() * size + 2 * own.first() * m[0] + m[1];
    bounds.slide[3] = own.third() * size + 3 * own.second() * m[0] + 3 * own.first() * m[1] + m[2];
  } else {
    for (int n = 0; n < 3; ++n) bounds.slide[n + 1] = m[n];
  }
  bounds.length = size;
  bounds.ulps = kBoundedUlps;
  bounds.rounding_rate = m[3] + sqrt(m[4]);
  return bounds;
}

/// Pose of a motion at one time: rotation, origin, its velocity and acceleration, angular velocity and acceleration.
struct BoundedState {
  Mat3 R;
  Vec3 c, v, a, w, al;
  BoundedState(const engine::BoundedSource& source, double t) {
    double x[24];
    source.state(source.self, t, x);
    R = Mat3(x);
    c = Vec3(x + 9);
    v = Vec3(x + 12);
    a = Vec3(x + 15);
    w = Vec3(x + 18);
    al = Vec3(x + 21);
  }
  /// R^T, -R^T c, with the angular velocity and acceleration -R^T w and -R^T al, and the origin's derivatives
  /// R^T (w x c - c') and R^T (al x c - w x (w x c) + 2 w x c' - c'').
  void invert() {
    const Mat3 back = transposed(R);
    const Vec3 wc = cross(w, c);
    a = back * (cross(al, c) - cross(w, wc) + cross(w, v) * 2 - a);
    v = back * (wc - v);
    c = back * -c;
    w = -(back * w);
    al = -(back * al);
    R = back;
  }
};
inline void evaluateBounded(const SweepStep& step, const Lanes& tm, double d, TurnLanes& turn, SlideLanes& slide) {
  for (int i = 0; i < kLanes; ++i) {
    BoundedState x(*step.source, tm[i]);
    if (step.inverse) x.invert();
    setLane(turn.J, i, x.R);
    setLane(turn.w, i, x.w * d);
    setLane(turn.al, i, x.al * d * d);
    setLane(slide.r, i, x.c);
    setLane(slide.r1, i, x.v * d);
    setLane(slide.r2, i, x.a * d * d);
  }
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
