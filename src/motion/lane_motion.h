// SPDX-License-Identifier: BSD-3-Clause
//
// Motion of frames and of pairs over eight time intervals at once, as a quadratic with an a-priori remainder.
//
// Symbols: interval of lane i: [tm_i - d, tm_i + d], the same d in all lanes; tau = (t - tm) / d in [-1, 1].
//   X(t) = X0 + tau X1 + tau^2 X2 + e,   |e| <= D3 d^3 / 6   (X a rotation or a position; X1 = d X', X2 = d^2/2 X'')
//   Rates (a, b, c): bounds on the first three derivatives of the angles of the factors passed, summed, over the
//   intervals;
//     |R^(n)| <= B_n = a, a^2 + b, a^3 + 3ab + c (doc/NUMERICS.md, Lemma 1)
//   D1, D2, D3: |o^(n)| <= Dn for the frame's origin o, over the intervals (Lemma 2)
//   b_k: Bernstein points X0 - X1 + X2, X0 - X2, X0 + X1 + X2: X0 + tau X1 + tau^2 X2 lies in their hull
#pragma once

#include "model/query.h"
#include "numerics/buffer.h"
#include "numerics/lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Placement;
using engine::StepKind;
using engine::SweepStep;
using engine::SweepView;

/// 2^-52: bounds the relative error of one operation in any rounding mode.
constexpr double kUlp = 2.220446049250313e-16;
/// Roundings of one step of a chain; of certificate and swept boxes on top of a chain, twice what they come to; of a
/// difference point at a pose (doc/NUMERICS.md, "Pads").
constexpr double kStepUlps = 24, kCertificateUlps = 160, kPoseUlps = 40;
/// Of a rotation by a vector; of a motion that its author gives with rotations proper to 1e-12.
constexpr double kTurnUlps = 512, kBoundedUlps = 8192;
/// No claim is made about lengths below this, in m. It stands far above whatever underflow, gradual or flushed, can do.
constexpr double kLeastLength = 1e-40;

/// Pose and scaled derivatives of a step's frame (o + R c for a point c fixed in it): R1 = [w] R0,
/// R2 = ([al] + [w][w]) R0 / 2, o1 = v, o2 = a.
struct FrameLanes {
  Lanes R[9], o[3], w[3], al[3], v[3], a[3];
};

/// Bounds on first, second and third derivatives of angles, summed over the factors of a rotation, and what they come
/// to for the rotation's own derivatives (doc/NUMERICS.md, Lemma 1).
struct Rates {
  double a = 0, b = 0, c = 0;
  double first() const { return a; }
  double second() const { return a * a + b; }
  double third() const { return (a * a + 3 * b) * a + c; }
};

/// A step of one query: its variables as polynomials of t, and bounds over the present intervals.
struct StepBounds {
  double q[3][engine::kMaxDegree + 1];  ///< one row; three for slide and turn
  std::int32_t degree;
  Rates rates, rates_parent;  ///< up to and with this step; without its own factor when that is revolute
  double D1, D2, D3;          ///< of the origin
  double length;              ///< |o(t)| and all numbers it is made of, summed
  double ulps;                ///< error of the rotation in kUlp, of the origin in kUlp * length
  double rounding_rate;       ///< what the rounding of derivatives scales with: a + sqrt(b), of absolute terms
  const double* orientation;  ///< a turn's R0, null: none
};

/// Upper bounds over the intervals of what a step's variables do.
struct VariableBounds {
  double m[4];      ///< of |q| and its first three derivatives (Euclidean norms of three rows)
  double size;      ///< of the numbers that q is computed from, summed
  double terms[2];  ///< of those that its first two derivatives are computed from
};

/// By Taylor's formula about the middle c, |q^(n)(t)| <= sum_j |q^(n+j)(c)| h^j / j!, a sum that ends with the degree.
/// A computed derivative is off by less than 16 kUlp of the sum of its absolute terms (Horner: two roundings a power,
/// and the factors); |t| <= 1 + 8 kUlp on all intervals.
inline void boundPolynomials(const StepBounds& b, int rows, double begin, double end, VariableBounds& out) {
  const double c = 0.5 * (begin + end), h = 0.5 * (end - begin);
  double at[engine::kMaxDegree + 1];
  out.size = out.terms[0] = out.terms[1] = 0;
  for (int n = 0; n <= b.degree; ++n) {
    double square = 0, terms = 0;
    for (int r = 0; r < rows; ++r) {
      double value = 0;
      for (int k = b.degree; k >= n; --k) {
        double factor = 1;
        for (int j = 0; j < n; ++j) factor *= k - j;
        value = value * c + factor * b.q[r][k];
        terms += factor * abs(b.q[r][k]);
      }
      square += value * value;
    }
    at[n] = sqrt(square) + 64 * kUlp * terms;
    if (n == 0) out.size = terms;
    if (n == 1 || n == 2) out.terms[n - 1] = terms;
  }
  for (int n = 0; n < 4; ++n) {
    double sum = 0, power = 1;
    for (int j = 0; n + j <= b.degree; ++j) {
      sum += at[n + j] * power;
      power *= h / (j + 1);
    }
    out.m[n] = sum * (1 + 64 * kUlp);
  }
}

/// All bounds of a sweep under one motion, for t in [begin, end]. Derivation: doc/NUMERICS.md, "Chains".
inline void boundSteps(const SweepView& sweep, const engine::Query& query, double begin, double end, StepBounds* out) {
  for (int i = 0; i < sweep.num_steps; ++i) {
    const SweepStep& step = sweep.steps[i];
    StepBounds& b = out[i];
    const StepBounds* p = step.parent >= 0 ? &out[step.parent] : nullptr;
    VariableBounds v = {};
    b.orientation = step.orientation >= 0 ? query.orientations + 9 * step.orientation : nullptr;
    if (step.kind == StepKind::bounded) {
      b.degree = 0;
    } else {
      const int rows = step.kind == StepKind::slide || step.kind == StepKind::turn ? 3 : 1;
      b.degree = query.degree;
      for (int r = 0; r < rows; ++r) {
        for (int k = 0; k <= query.degree; ++k) {
          b.q[r][k] = step.multiplier * query.coefficients[k * query.num_variables + step.variable + r];
        }
      }
      if (rows == 1 && query.degree == 1) {
        // Of the numbers that q comes from, not of q: multiple and offset of a mimic joint may cancel.
        v.m[1] = v.terms[0] = abs(b.q[0][1]);
        v.m[0] = v.size = abs(b.q[0][0]) + abs(step.offset) + v.m[1];
        v.m[2] = v.m[3] = v.terms[1] = 0;
        b.q[0][0] += step.offset;
      } else {
        boundPolynomials(b, rows, begin, end, v);
        v.m[0] += abs(step.offset);
        v.size += abs(step.offset);
        b.q[0][0] += step.offset;
      }
    }

    const Rates r = p ? p->rates : Rates(), s = p ? p->rates_parent : Rates();
    // The offset p turns with the parent's frame: across its last axis at rate r, along it at the rate before.
    b.D1 = (p ? p->D1 : 0) + r.first() * step.perp + s.first() * step.axial;
    b.D2 = (p ? p->D2 : 0) + r.second() * step.perp + s.second() * step.axial;
    b.D3 = (p ? p->D3 : 0) + r.third() * step.perp + s.third() * step.axial;
    b.length = (p ? p->length : 0) + step.length;
    // The constant transform, and the step's own arithmetic.
    b.ulps = (p ? p->ulps : 0) + step.ulps + kStepUlps;
    b.rounding_rate = p ? p->rounding_rate : 0;
    b.rates = b.rates_parent = r;
    const auto turnBy = [&](double m1, double m2, double m3) {
      b.rates.a += m1;
      b.rates.b += m2;
      b.rates.c += m3;
    };
    const auto slideBy = [&](double m0, double m1, double m2, double m3) {
      b.D1 += r.first() * m0 + m1;
      b.D2 += r.second() * m0 + 2 * r.first() * m1 + m2;
      b.D3 += r.third() * m0 + 3 * r.second() * m1 + 3 * r.first() * m2 + m3;
    };
    switch (step.kind) {
      case StepKind::revolute:
        turnBy(v.m[1], v.m[2], v.m[3]);
        b.rounding_rate += v.terms[1] > 0 ? v.terms[0] + sqrt(v.terms[1]) : v.terms[0];
        b.ulps += 3 * b.degree * v.size;  // q is off by that many kUlp
        break;
      case StepKind::turn:
        turnBy(v.m[1], v.m[2], v.m[3]);
        b.rates_parent = b.rates;
        b.rounding_rate += v.terms[1] > 0 ? v.terms[0] + sqrt(v.terms[1]) : v.terms[0];
        b.ulps += kTurnUlps + (6 * b.degree + 16) * v.size;
        if (b.orientation) b.ulps += kStepUlps;  // one more stored rotation and product
        break;
      case StepKind::prismatic:
      case StepKind::slide:
        slideBy(v.m[0], v.m[1], v.m[2], v.m[3]);
        b.length += b.degree * v.size;  // q is off by 3 degree kUlp of its size, less than ulps give it
        break;
      case StepKind::bounded: {
        double state[24], m[6];
        const engine::BoundedSource& source = *step.source;
        const double middle = 0.5 * (begin + end);
        source.state(source.self, middle, state);
        source.bounds(source.self, begin, end, m);
        const double size = norm(state + 9) + 0.5 * (end - begin) * m[0];
        turnBy(m[3], m[4], m[5]);
        if (step.inverse) {  // the origin is -R^T c
          const Rates own = {m[3], m[4], m[5]};
          slideBy(size, own.first() * size + m[0], own.second() * size + 2 * own.first() * m[0] + m[1],
                  own.third() * size + 3 * own.second() * m[0] + 3 * own.first() * m[1] + m[2]);
        } else {
          slideBy(size, m[0], m[1], m[2]);
        }
        b.rates_parent = b.rates;
        b.length += size;
        b.ulps += kBoundedUlps;
        b.rounding_rate += m[3] + sqrt(m[4]);
        break;
      }
    }
  }
}

/// A step's variables in the middle of the intervals: q, d q', d^2 q''.
struct VariableLanes {
  Lanes q, q1, q2;
};
FCL_ARTIC_INLINE VariableLanes evaluateVariable(const StepBounds& b, int row, const Lanes& tm, double d) {
  const double* c = b.q[row];
  if (b.degree == 1) return {mulAdd(tm, Lanes(c[1]), c[0]), Lanes(c[1] * d), Lanes(0.0)};
  Lanes q(c[b.degree]), q1(0.0), q2(0.0);
  for (int k = b.degree - 1; k >= 0; --k) {  // Horner's scheme for a polynomial and its derivatives
    q2 = mulAdd(q2, tm, q1);
    q1 = mulAdd(q1, tm, q);
    q = mulAdd(q, tm, Lanes(c[k]));
  }
  return {q, q1 * Lanes(d), q2 * Lanes(2 * d * d)};
}

/// A factor's own motion: rotation J, and of the origin and the angles the derivatives by tau.
struct FactorLanes {
  Lanes J[9], o[3], v[3], a[3], w[3], al[3];
};

/// exp([q]) with its angular velocity and acceleration, from q and its derivatives. With g = |q|^2:
/// R = cos + a [q] + b q q^T, w = q' + b q x q' + c q x (q x q'), a = sin/theta, b = (1 - cos)/g, c = (1 - a)/g.
inline void turnFactor(const VariableLanes* x, FactorLanes& f) {
  const Lanes q[3] = {x[0].q, x[1].q, x[2].q}, q1[3] = {x[0].q1, x[1].q1, x[2].q1}, q2[3] = {x[0].q2, x[1].q2, x[2].q2};
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
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) f.J[3 * i + j] = b * q[i] * q[j];
    f.J[3 * i + i] = f.J[3 * i + i] + cosine;
  }
  const Lanes e[3] = {a * q[0], a * q[1], a * q[2]};
  f.J[1] = f.J[1] - e[2];
  f.J[2] = f.J[2] + e[1];
  f.J[3] = f.J[3] + e[2];
  f.J[5] = f.J[5] - e[0];
  f.J[6] = f.J[6] - e[1];
  f.J[7] = f.J[7] + e[0];
  const Lanes g1 = Lanes(2.0) * dot(q, q1);
  Lanes u[3], uu[3], s[3], t[3], tt[3];
  cross(q, q1, u);
  cross(q, u, uu);
  cross(q, q2, s);
  cross(q1, u, t);
  cross(q, s, tt);
  for (int k = 0; k < 3; ++k) {
    f.w[k] = q1[k] + b * u[k] + c * uu[k];
    f.al[k] = q2[k] + bg * g1 * u[k] + b * s[k] + cg * g1 * uu[k] + c * (t[k] + tt[k]);
  }
}

/// What the author of a motion says, or its inverse R^T, -R^T c, whose angular velocity and acceleration are -R^T w and
/// -R^T al, and whose origin has the derivatives R^T (w x c - c') and R^T (al x c - w x (w x c) + 2 w x c' - c'').
inline void boundedFactor(const SweepStep& step, const Lanes& tm, double d, FactorLanes& f) {
  for (int i = 0; i < kLanes; ++i) {
    double x[24];
    step.source->state(step.source->self, tm[i], x);
    const double *R = x, *c = x + 9;
    double *v = x + 12, *a = x + 15, *w = x + 18, *al = x + 21;
    double y[24];
    if (step.inverse) {
      double wc[3], wwc[3], wv[3], alc[3], o[3], v1[3], a1[3];
      cross(w, c, wc);
      cross(w, wc, wwc);
      cross(w, v, wv);
      cross(al, c, alc);
      for (int k = 0; k < 3; ++k) {
        o[k] = -c[k];
        v1[k] = wc[k] - v[k];
        a1[k] = alc[k] - wwc[k] + 2 * wv[k] - a[k];
      }
      for (int k = 0; k < 3; ++k) {
        const double column[3] = {R[k], R[3 + k], R[6 + k]};
        for (int j = 0; j < 3; ++j) y[3 * k + j] = R[3 * j + k];
        y[9 + k] = dot(column, o);
        y[12 + k] = dot(column, v1);
        y[15 + k] = dot(column, a1);
        y[18 + k] = -dot(column, w);
        y[21 + k] = -dot(column, al);
      }
    } else {
      for (int k = 0; k < 24; ++k) y[k] = x[k];
    }
    for (int k = 0; k < 9; ++k) f.J[k].set(i, y[k]);
    for (int k = 0; k < 3; ++k) {
      f.o[k].set(i, y[9 + k]);
      f.v[k].set(i, y[12 + k] * d);
      f.a[k].set(i, y[15 + k] * d * d);
      f.w[k].set(i, y[18 + k] * d);
      f.al[k].set(i, y[21 + k] * d * d);
    }
  }
}

/// The frame with the axes x, y, z is turned by the constant rotation R in its own axes: (x y z) <- (x y z) R, or R^T.
inline void turnAxes(const double* R, bool transposed, Lanes* x, Lanes* y, Lanes* z) {
  const int row = transposed ? 1 : 3, column = transposed ? 3 : 1;
  for (int k = 0; k < 3; ++k) {
    const Lanes a = x[k], b = y[k], c = z[k];
    Lanes* axes[3] = {x, y, z};
    for (int j = 0; j < 3; ++j) {
      const double* r = R + j * column;
      axes[j][k] = mulAdd(a, r[0], mulAdd(b, r[row], c * Lanes(r[2 * row])));
    }
  }
}

/// o = R x for a matrix given by its columns.
FCL_ARTIC_INLINE void combine(const Lanes* x, const Lanes* y, const Lanes* z, const Lanes* u, Lanes* o) {
  for (int k = 0; k < 3; ++k) o[k] = mulAdd(x[k], u[0], mulAdd(y[k], u[1], z[k] * u[2]));
}

/// Frames of the steps over a batch of intervals.
inline void evaluateSweep(const SweepView& sweep, const StepBounds* bounds, const Lanes& tm, double d,
                          FrameLanes* out) {
  for (int i = 0; i < sweep.num_steps; ++i) {
    const SweepStep& step = sweep.steps[i];
    const FrameLanes* g = step.parent >= 0 ? &out[step.parent] : nullptr;
    FrameLanes& f = out[i];
    const double *C = step.C, *p = step.p;
    // The frame in which the factor acts: axes x, y, z, and r from the parent's origin to the factor's.
    Lanes r[3], x[3], y[3], z[3], t[3];
    if (g) {
      for (int k = 0; k < 3; ++k) {
        const Lanes* R = g->R + 3 * k;
        r[k] = mulAdd(R[0], p[0], mulAdd(R[1], p[1], R[2] * Lanes(p[2])));
        x[k] = mulAdd(R[0], C[0], mulAdd(R[1], C[3], R[2] * Lanes(C[6])));
        y[k] = mulAdd(R[0], C[1], mulAdd(R[1], C[4], R[2] * Lanes(C[7])));
        z[k] = mulAdd(R[0], C[2], mulAdd(R[1], C[5], R[2] * Lanes(C[8])));
        f.w[k] = g->w[k];
        f.al[k] = g->al[k];
      }
    } else {
      for (int k = 0; k < 3; ++k) {
        r[k] = Lanes(p[k]);
        x[k] = Lanes(C[3 * k]);
        y[k] = Lanes(C[3 * k + 1]);
        z[k] = Lanes(C[3 * k + 2]);
        f.w[k] = f.al[k] = Lanes(0.0);
      }
    }

    // The factor: its slide by dr with derivatives v and a (2 X2), its rotation.
    bool slides = true;
    Lanes dr[3], v[3], a[3];
    for (int k = 0; k < 3; ++k) {
      dr[k] = v[k] = a[k] = Lanes(0.0);
      f.R[3 * k] = x[k];
      f.R[3 * k + 1] = y[k];
      f.R[3 * k + 2] = z[k];
    }
    switch (step.kind) {
      case StepKind::revolute: {
        slides = false;
        const VariableLanes q = evaluateVariable(bounds[i], 0, tm, d);
        Lanes s, c;
        sineCosine(q.q, s, c);
        for (int k = 0; k < 3; ++k) {
          f.R[3 * k] = mulAdd(x[k], c, y[k] * s);
          f.R[3 * k + 1] = y[k] * c - x[k] * s;
        }
        if (g) {
          cross(g->w, z, t);
          for (int k = 0; k < 3; ++k) f.al[k] = mulAdd(t[k], q.q1, f.al[k]);
        }
        for (int k = 0; k < 3; ++k) f.w[k] = mulAdd(z[k], q.q1, f.w[k]);
        if (bounds[i].degree > 1) {
          for (int k = 0; k < 3; ++k) f.al[k] = mulAdd(z[k], q.q2, f.al[k]);
        }
        break;
      }
      case StepKind::prismatic: {
        const VariableLanes q = evaluateVariable(bounds[i], 0, tm, d);
        for (int k = 0; k < 3; ++k) {
          dr[k] = z[k] * q.q;
          v[k] = z[k] * q.q1;
          a[k] = z[k] * q.q2;
        }
        break;
      }
      case StepKind::slide: {
        VariableLanes q[3];
        for (int j = 0; j < 3; ++j) q[j] = evaluateVariable(bounds[i], j, tm, d);
        const Lanes q0[3] = {q[0].q, q[1].q, q[2].q}, q1[3] = {q[0].q1, q[1].q1, q[2].q1},
                    q2[3] = {q[0].q2, q[1].q2, q[2].q2};
        combine(x, y, z, q0, dr);
        combine(x, y, z, q1, v);
        combine(x, y, z, q2, a);
        break;
      }
      case StepKind::turn:
      case StepKind::bounded: {
        FactorLanes factor;
        slides = step.kind == StepKind::bounded;
        if (slides) {
          boundedFactor(step, tm, d, factor);
          combine(x, y, z, factor.o, dr);
          combine(x, y, z, factor.v, v);
          combine(x, y, z, factor.a, a);
        } else {
          VariableLanes q[3];
          for (int j = 0; j < 3; ++j) q[j] = evaluateVariable(bounds[i], j, tm, d);
          turnFactor(q, factor);
          if (bounds[i].orientation && step.inverse) turnAxes(bounds[i].orientation, true, x, y, z);
        }
        Lanes J[3][3];
        for (int j = 0; j < 3; ++j) {
          const Lanes column[3] = {factor.J[j], factor.J[3 + j], factor.J[6 + j]};
          combine(x, y, z, column, J[j]);
        }
        if (bounds[i].orientation && !step.inverse) turnAxes(bounds[i].orientation, false, J[0], J[1], J[2]);
        for (int j = 0; j < 3; ++j) {
          for (int k = 0; k < 3; ++k) f.R[3 * k + j] = J[j][k];
        }
        combine(x, y, z, factor.w, t);
        if (g) {
          Lanes u[3];
          cross(g->w, t, u);
          for (int k = 0; k < 3; ++k) f.al[k] = f.al[k] + u[k];
        }
        for (int k = 0; k < 3; ++k) f.w[k] = f.w[k] + t[k];
        combine(x, y, z, factor.al, t);
        for (int k = 0; k < 3; ++k) f.al[k] = f.al[k] + t[k];
        break;
      }
    }

    // The origin: o = o_g + r, with r fixed in the parent's frame but for the slide.
    if (slides) {
      for (int k = 0; k < 3; ++k) r[k] = r[k] + dr[k];
    }
    if (g) {
      Lanes u[3], e[3];
      cross(g->w, r, t);
      cross(g->w, t, u);
      cross(g->al, r, e);
      for (int k = 0; k < 3; ++k) {
        f.o[k] = g->o[k] + r[k];
        f.v[k] = g->v[k] + t[k];
        f.a[k] = g->a[k] + Lanes(0.5) * (e[k] + u[k]);
      }
    } else {
      for (int k = 0; k < 3; ++k) {
        f.o[k] = r[k];
        f.v[k] = f.a[k] = Lanes(0.0);
      }
    }
    if (slides) {
      if (g) {
        cross(g->w, v, t);  // 2 w x v of the Coriolis term, halved
        for (int k = 0; k < 3; ++k) f.a[k] = f.a[k] + t[k];
      }
      for (int k = 0; k < 3; ++k) {
        f.v[k] = f.v[k] + v[k];
        f.a[k] = mulAdd(a[k], Lanes(0.5), f.a[k]);
      }
    }
  }
  if (sweep.first_order) {  // some derivative isn't known: the remainder is all of the motion (remainderOf)
    for (int i = 0; i < sweep.num_steps; ++i) {
      for (int k = 0; k < 3; ++k) out[i].w[k] = out[i].al[k] = out[i].v[k] = out[i].a[k] = Lanes(0.0);
    }
  }
}

/// Motion of a body's tree frame in another's: quadratic and Bernstein points. Entry [k][...]: order k, or point k.
struct RigidLanes {
  Lanes R[3][9], c[3][3];       ///< X0, X1, X2
  Lanes Rb[3][9], cb[3][3];     ///< Bernstein points
  Lanes spread[9];              ///< largest |Rb| of the three, entry by entry
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
/// most e, 2 e x and 2.25 e x^2 with e = kUlp * ulps and x = rounding_rate * d; inverting makes that 2 e, 6 e x, 9.5 e
/// x^2.
inline double roundingPart(double ulps, double x) {
  return kUlp * (2 * ulps + kCertificateUlps) * ((1 + 2.5 * x) * (1 + 2.5 * x));
}

/// What the quadratic leaves out of a motion with these bounds: |error| of a point p is at most c + R |p|. Where no
/// derivative is known (first_order) the quadratic is a constant.
struct Remainder {
  double R, c;
};
inline Remainder remainderOf(const Rates& rates, double D1, double D3, bool first_order, double ulps, double d) {
  // Room for the rounding of the constants and of what it is added to.
  const double room = 1 + kUlp * (2 * ulps + kCertificateUlps);
  if (first_order) return {rates.first() * d * room, D1 * d * room};
  const double third = d * d * d / 6 * room;
  return {rates.third() * third, D3 * third};
}

/// Bounds on rounding that go with a RigidLanes and its inverse.
struct PairPads {
  double pad;   ///< of a certificate or swept box, either way
  double pose;  ///< of a difference point at tm
};

/// B seen from A: quadratic, remainders and pads. Of the way back, A seen from B, the remainder only: invert() makes
/// the rest.
/// @param frame  of the step that carries B, seen from the base frame; null where B stands still in it.
/// @param b  of that step; all zero where B stands still.
/// @param extents  largest distances of points of A and of B from their frames' origins, summed.
inline PairPads relateBodies(const FrameLanes* frame, const StepBounds& b, bool first_order, const Placement& inverse_a,
                             const Placement& placement_b, double extents, double margin, double d, RigidLanes& m,
                             RigidLanes& inverse) {
  placeBehind(frame, placement_b, m);
  placeInFront(inverse_a, m);

  // Bounds of B's origin seen from A's frame: a point fixed at distance `l` in the step's frame adds B_n l.
  const Rates& r = b.rates;
  const double l = placement_b.length;
  const double D1 = b.D1 + r.first() * l, D2 = b.D2 + r.second() * l, D3 = b.D3 + r.third() * l;
  const double length = b.length + l + inverse_a.length;  // >= |c(t)|
  const double ulps = b.ulps + placement_b.ulps + inverse_a.ulps;
  const Remainder there = remainderOf(r, D1, D3, first_order, ulps, d);
  m.rem_c = there.c;
  m.rem_R = there.R;
  // -R^T c: Leibniz with |R^(n)| <= B_n, |c| <= length, |c^(n)| <= Dn.
  const Remainder back =
      remainderOf(r, D1 + r.first() * length, D3 + 3 * r.first() * D2 + 3 * r.second() * D1 + r.third() * length,
                  first_order, ulps, d);
  inverse.rem_c = back.c;
  inverse.rem_R = back.R;
  const double sizes = length + D1 * d + extents;
  return {roundingPart(ulps, b.rounding_rate * d) * (sizes + margin) + kLeastLength,
          kUlp * (ulps + kPoseUlps) * sizes + kLeastLength};
}

/// Centre of a ball that is fixed in a step's frame, over the intervals: c[0] + tau c[1] + tau^2 c[2].
/// @param radius  with the error of p in it.
/// @return a radius about this centre that holds the ball.
inline double sweepCenter(const FrameLanes& f, const StepBounds& b, bool first_order, const double* p, double radius,
                          double d, Lanes (*c)[3]) {
  const double reach = __builtin_sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) * (1 + 1e-15);
  const double sizes = b.length + b.D1 * d + reach + radius;
  const Remainder remainder = remainderOf(b.rates, b.D1, b.D3, first_order, b.ulps, d);
  Lanes x[3], x1[3], u[3], e[3];
  for (int k = 0; k < 3; ++k) x[k] = dot(f.R + 3 * k, p);
  cross(f.w, x, x1);
  cross(f.w, x1, u);
  cross(f.al, x, e);
  for (int k = 0; k < 3; ++k) {
    c[0][k] = f.o[k] + x[k];
    c[1][k] = f.v[k] + x1[k];
    c[2][k] = f.a[k] + Lanes(0.5) * (u[k] + e[k]);
  }
  return radius + remainder.c + remainder.R * reach + roundingPart(b.ulps, b.rounding_rate * d) * sizes + kLeastLength;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
