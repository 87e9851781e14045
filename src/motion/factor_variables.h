// SPDX-License-Identifier: BSD-3-Clause
//
// The variables of a factor under one query: polynomials of t, their bounds over intervals, their values in eight
// lanes.
#pragma once

#include "model/query.h"
#include "motion/remainder.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::StepKind;
using engine::SweepStep;

/// A step's variables as polynomials of t, by their coefficients.
struct FactorVariables {
  double q[3][engine::kMaxDegree + 1];  ///< one row; three for slide and turn
  std::int32_t degree;
};

/// Upper bounds over the intervals of what a step's variables do.
struct VariableBounds {
  double m[4];      ///< of |q| and its first three derivatives (Euclidean norms of three rows)
  double size;      ///< of the numbers that q is computed from, summed
  double terms[2];  ///< of those that its first two derivatives are computed from
  /// What rounding of q's derivatives scales with.
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

/// Reads a step's variables from the query, and bounds them for t in [begin, end].
inline void boundVariables(const SweepStep& step, const engine::Query& query, double begin, double end,
                           FactorVariables& variables, VariableBounds& bounds) {
  const int rows = step.kind == StepKind::slide || step.kind == StepKind::turn ? 3 : 1;
  auto& q = variables.q;
  variables.degree = query.degree;
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k <= query.degree; ++k) {
      q[r][k] = step.multiplier * query.coefficients[k * query.num_variables + step.variable + r];
    }
  }
  if (rows == 1 && query.degree == 1) {
    // Of the numbers that q comes from, not of q: multiple and offset of a mimic joint may cancel.
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

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
