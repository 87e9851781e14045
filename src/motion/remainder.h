// SPDX-License-Identifier: BSD-3-Clause
//
// A-priori bounds on what a motion's quadratic over eight time intervals leaves out, and on what rounding can do.
//
// Symbols: interval of lane i: [tm_i - d, tm_i + d], the same d in all lanes; tau = (t - tm) / d in [-1, 1].
//   X(t) = X0 + tau X1 + tau^2 X2 + e,   |e| <= D3 d^3 / 6   (X a rotation or a position; X1 = d X', X2 = d^2/2 X'')
#pragma once

#include "numerics/constants.h"
#include "numerics/lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Roundings (doc/NUMERICS.md, "Pads"), in this order:
/// - of one step of a chain;
/// - of certificate and swept boxes on top of a chain, twice what they come to;
/// - of a difference point at a pose.
constexpr double kStepUlps = 24, kCertificateUlps = 160, kPoseUlps = 40;
/// Roundings of a rotation by a vector.
constexpr double kTurnUlps = 512;
/// No claim is made about lengths below this, in m. It stands far above whatever underflow, gradual or flushed, can do.
constexpr double kLeastLength = 1e-40;

/// Bounds on the first three derivatives of angles, summed over the factors of a rotation, and what they come to for
/// the rotation's own: |R^(n)| <= B_n = a, a^2 + b, a^3 + 3ab + c (doc/NUMERICS.md, Lemma 1).
struct Rates {
  double a = 0, b = 0, c = 0;
  double first() const { return a; }
  double second() const { return a * a + b; }
  double third() const { return (a * a + 3 * b) * a + c; }
};

/// Bounds over the present intervals on all that leads up to a step's frame, or to a body's.
struct MotionBounds {
  Rates rates;
  double D1, D2, D3;     ///< of the first three derivatives of the origin o: |o^(n)| <= Dn (doc/NUMERICS.md, Lemma 2)
  double length;         ///< |o(t)| and all numbers it is made of, summed
  double ulps;           ///< error of the rotation in kUlp, of the origin in kUlp * length
  double rounding_rate;  ///< what the rounding of derivatives scales with: a + sqrt(b), of absolute terms
};

/// Rounding of all that a certificate or swept box is made of, as a part of the sizes. The error of X0, X1 and X2 is at
/// most e, 2 e x and 2.25 e x^2 with e = kUlp * ulps and x = rounding_rate * d; inverting makes that 2 e, 6 e x, 9.5 e
/// x^2.
inline double roundingPart(double ulps, double x) {
  return kUlp * (2 * ulps + kCertificateUlps) * ((1 + 2.5 * x) * (1 + 2.5 * x));
}

/// The part of a motion with these bounds that the quadratic leaves out: |error| of a point p is at most c + R |p|.
/// Where no derivative is known (first_order) the quadratic is a constant.
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

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
