// SPDX-License-Identifier: BSD-3-Clause
//
// The variables of a factor under one query: polynomials of t, or angles whose half has such a tangent; their bounds
// over intervals, their values in eight lanes.
#pragma once

#include "model/query.h"
#include "motion/remainder.h"
#include "numerics/arc_tangent.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::StepKind;
using engine::SweepStep;

/// A step's variables as polynomials of t, by their coefficients. With half_angle the first row is a polynomial s, and
/// the variable is q[1][0] 2 atan(s) + q[1][1].
struct FactorVariables {
  double q[3][engine::kMaxDegree + 1];  ///< one row; three for slide and turn
  std::int32_t degree;
  bool half_angle;
};

/// Upper bounds over the intervals of what a step's variables do.
struct VariableBounds {
  double m[4];      ///< of |q| and its first three derivatives (Euclidean norms of three rows)
  double size;      ///< of the numbers that q is computed from, summed
  double terms[2];  ///< of those that its first two derivatives are computed from
  /// The number that rounding of q's derivatives scales with.
  double roundingRate() const { return terms[1] > 0 ? terms[0] + sqrt(terms[1]) : terms[0]; }
};

/// By Taylor's formula about the middle c, |q^(n)(t)| <= sum_j |q^(n+j)(c)| h^j / j!, a sum that ends with the degree.
/// A computed derivative is off by less than 16 kUlp of the sum of its absolute terms (Horner: two roundings a power,
/// and the factors); |t| <= 1 + 8 kUlp on all intervals.
inline void boundPolynomials(const FactorVariables& variables, int rows, double begin, double end,
                             VariableBounds& out) {
  const double c = 0.5 * (begin + end), h = 0.5 * (end - begin);
  double at[engine::kMaxDegree + 1];
  out.size = out.terms[0] = out.terms[1] = 0;
  for (int n = 0; n <= variables.degree; ++n) {
    double square = 0, terms = 0;
    for (int r = 0; r < rows; ++r) {
      double value = 0;
      for (int k = variables.degree; k >= n; --k) {
        double factor = 1;
        for (int j = 0; j < n; ++j) factor *= k - j;
        value = value * c + factor * variables.q[r][k];
        terms += factor * abs(variables.q[r][k]);
      }
      square += value * value;
    }
    at[n] = sqrt(square) + 64 * kUlp * terms;
    if (n == 0) out.size = terms;
    if (n == 1 || n == 2) out.terms[n - 1] = terms;
  }
  for (int n = 0; n < 4; ++n) {
    double sum = 0, power = 1;
    for (int j = 0; n + j <= variables.degree; ++j) {
      sum += at[n + j] * power;
      power *= h / (j + 1);
    }
    out.m[n] = sum * (1 + 64 * kUlp);
  }
}

/// Largest values of g(s) = 2 / (1 + s^2) and of its first two derivatives' absolutes, -4 s / (1 + s^2)^2 and
/// (12 s^2 - 4) / (1 + s^2)^3, where |s| is from `least` to `most`: each is monotone between s^2 = 0, 1/3, 1 and
/// infinity (doc/NUMERICS.md, "Half angles").
struct HalfAngleRates {
  double g[3];
  HalfAngleRates(double least, double most) {
    constexpr double kRoom = 1 + 64 * kUlp;
    const double x = least * least, y = most * most;
    const double p = 1 / (1 + x), q = 1 / (1 + y);
    g[0] = 2 * p * kRoom;
    g[1] = 1.299038106;  // 3 sqrt(3) / 4 at s^2 = 1/3, rounded up
    if (3 * y < 1) g[1] = 4 * most * q * q * kRoom;
    if (3 * x > 1) g[1] = 4 * least * p * p * kRoom;
    g[2] = max(abs(12 * x - 4) * p * p * p, abs(12 * y - 4) * q * q * q);
    if (x <= 1 && y >= 1) g[2] = max(g[2], 1.0);
    g[2] = g[2] * kRoom + 64 * kUlp;
  }
};

/// Reads and bounds a variable q = m (reference + 2 atan(s)) + o, s a polynomial, for t in [begin, end]:
/// q' = m g s', q'' = m (g s'' + g_1 s'^2), q''' = m (g s''' + 3 g_1 s' s'' + g_2 s'^3), g, g_1 and g_2 as in
/// HalfAngleRates. Derivation, and what size and terms stand for: doc/NUMERICS.md, "Half angles".
[[gnu::noinline]] inline void boundHalfAngle(const SweepStep& step, const engine::Query& query, double begin,
                                             double end, FactorVariables& variables, VariableBounds& bounds) {
  FCL_ARTIC_ASSERT(query.degree >= 2);
  variables.half_angle = true;
  variables.degree = query.degree;
  const double c = 0.5 * (begin + end);
  double s = 0;
  for (int k = query.degree; k >= 0; --k) {
    variables.q[0][k] = query.coefficients[k * query.num_variables + step.variable];
    s = s * c + variables.q[0][k];
  }
  boundPolynomials(variables, 1, begin, end, bounds);
  const double S0 = bounds.m[0], S1 = bounds.m[1], S2 = bounds.m[2], S3 = bounds.m[3];
  const double T0 = bounds.size, T1 = bounds.terms[0], T2 = bounds.terms[1];
  // S0 is |s| at the middle and the way from there, rounded up: |s| is nowhere less than the one without the other.
  const HalfAngleRates rates(max(2 * abs(s) - S0, 0.0), S0);
  const double* g = rates.g;

  const double m = abs(step.multiplier), reference = query.half_angles.reference[step.variable];
  const double still = m * abs(reference) + abs(step.offset);
  bounds.m[0] = m * min(2 * S0, 3.15) + still;
  bounds.m[1] = m * (g[0] * S1);
  bounds.m[2] = m * (g[0] * S2 + g[1] * (S1 * S1));
  bounds.m[3] = m * (g[0] * S3 + 3 * g[1] * (S1 * S2) + g[2] * (S1 * S1 * S1));
  for (double& x : bounds.m) x *= 1 + 64 * kUlp;
  bounds.size = m * (g[0] * T0 + 4) + still;
  bounds.terms[0] = m * (g[0] * T1 + g[1] * (T0 * S1));
  bounds.terms[1] = m * (g[0] * T2 + g[1] * (T0 * S2 + 2 * S1 * T1) + g[2] * (T0 * S1 * S1));
  if (step.kind == StepKind::prismatic) bounds.size += bounds.terms[0] + bounds.terms[1];
  variables.q[1][0] = step.multiplier;
  variables.q[1][1] = step.multiplier * reference + step.offset;
}

/// Reads a step's variables from the query, and bounds them for t in [begin, end].
inline void boundVariables(const SweepStep& step, const engine::Query& query, double begin, double end,
                           FactorVariables& variables, VariableBounds& bounds) {
  const int rows = step.kind == StepKind::slide || step.kind == StepKind::turn ? 3 : 1;
  if (rows == 1 && query.half_angles.has(step.variable)) {
    boundHalfAngle(step, query, begin, end, variables, bounds);
    return;
  }
  variables.half_angle = false;
  auto& q = variables.q;
  variables.degree = query.degree;
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k <= query.degree; ++k) {
      q[r][k] = step.multiplier * query.coefficients[k * query.num_variables + step.variable + r];
    }
  }
  if (rows == 1 && query.degree == 1) {
    // Bounds of the numbers that q comes from, not of q: multiple and offset of a mimic joint may cancel.
    bounds.m[1] = bounds.terms[0] = abs(q[0][1]);
    bounds.m[0] = bounds.size = abs(q[0][0]) + abs(step.offset) + bounds.m[1];
    bounds.m[2] = bounds.m[3] = bounds.terms[1] = 0;
  } else {
    boundPolynomials(variables, rows, begin, end, bounds);
    bounds.m[0] += abs(step.offset);
    bounds.size += abs(step.offset);
  }
  q[0][0] += step.offset;
}

/// A variable in the middle of the intervals: q, d q', d^2 q''.
struct VariableLanes {
  Lanes q, q1, q2;
};
FCL_ARTIC_INLINE VariableLanes evaluateVariable(const FactorVariables& variables, int row, const Lanes& tm, double d) {
  const double* c = variables.q[row];
  if (variables.degree == 1) return {mulAdd(tm, Lanes(c[1]), c[0]), Lanes(c[1] * d), Lanes(0.0)};
  Lanes q(c[variables.degree]), q1(0.0), q2(0.0);
  for (int k = variables.degree - 1; k >= 0; --k) {  // Horner's scheme for a polynomial and its derivatives
    q2 = mulAdd(q2, tm, q1);
    q1 = mulAdd(q1, tm, q);
    q = mulAdd(q, tm, Lanes(c[k]));
  }
  return {q, q1 * Lanes(d), q2 * Lanes(2 * d * d)};
}

/// atan(s), off by less than 4 kUlp for |s| <= 1e100, in any rounding mode: arcTangent(double) in lanes.
FCL_ARTIC_INLINE Lanes arcTangent(Lanes s) {
  const Lanes a = abs(s), steep(kSteepTangent), flat(kFlatTangent), one(1.0);
  const Lanes over = whereGreater(a, steep, Lanes(-1.0), whereGreater(a, flat, a - one, a));
  const Lanes under = whereGreater(a, steep, a, whereGreater(a, flat, a + one, one));
  const Lanes base = whereGreater(a, steep, Lanes(kQuarterTurn), whereGreater(a, flat, Lanes(kEighthTurn), Lanes(0.0)));
  const Lanes x = over / under, z = x * x;
  Lanes p(kArcTangent[kArcTangentTerms - 1]);
  for (int k = kArcTangentTerms - 1; k-- > 0;) p = mulAdd(z, p, Lanes(kArcTangent[k]));
  const Lanes y = base + (x - x * z * p);
  return whereGreater(Lanes(0.0), s, -y, y);
}

/// The angle whose half has the tangent s (with its derivatives by tau), times a multiple, and an offset.
[[gnu::noinline]] inline void turnIntoAngle(const FactorVariables& variables, VariableLanes& s) {
  const Lanes m(variables.q[1][0]), g = Lanes(2.0) / mulAdd(s.q, s.q, Lanes(1.0));
  const Lanes rate = g * s.q1;
  s.q2 = m * (g * s.q2 - s.q * rate * rate);
  s.q1 = m * rate;
  s.q = mulAdd(m, Lanes(2.0) * arcTangent(s.q), Lanes(variables.q[1][1]));
}

/// The variable of a turn about an axis, or of a slide along one.
FCL_ARTIC_INLINE VariableLanes evaluateOnly(const FactorVariables& variables, const Lanes& tm, double d) {
  VariableLanes x = evaluateVariable(variables, 0, tm, d);
  if (variables.half_angle) turnIntoAngle(variables, x);
  return x;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
