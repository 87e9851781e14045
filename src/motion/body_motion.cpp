// SPDX-License-Identifier: BSD-3-Clause
//
// Swept boxes. Between two times a and b, h apart, a point x of the body stays near the chord of its path: along any
// unit vector, hence altogether,
//
//   |x(t) - chord(t)| <= D2 h^2 / 8   (linear interpolation),   and   <= D1 h / 2   (the nearer end),
//
// where |x'| <= D1 and |x''| <= D2 over [0, 1]. A chord lies in the box of its ends. So the boxes at the ends of K
// equal pieces, grown by the smaller bound, hold the path: no derivative is evaluated, only poses.
//
// D1 and D2 sum up along the elements. R is the product of the rotations passed so far. The numbers a and b sum the
// bounds on the first and second derivatives of their angles or rotation vectors. The vector l is the next piece of the
// way to the point:
//
//   |R'| <= a,   |R''| <= a^2 + b   (doc/NUMERICS.md, Lemma 1),
//   |(R l)'| <= a |l| + |l'|,   |(R l)''| <= (a^2 + b) |l| + 2 a |l'| + |l''|.

#include "motion/body_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/constants.h"
#include "numerics/rotation.h"
#include "numerics/sine_cosine.h"

namespace fcl_artic {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Coefficients = Eigen::Matrix<double, 3, kMaxDegree + 1>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Sine and cosine of a and b, each off by at most 2.5 * 2^-52, and by 2 * 2^-52 of itself as far as pi / 4
/// (doc/NUMERICS.md, section 7). NaN beyond kLargestAngle, where nothing is claimed: motions are refused before.
struct SineCosine {
  double sine_a, cosine_a, sine_b, cosine_b;
};
SineCosine sineCosineOf(double a, double b) {
  if (!(std::abs(a) <= kLargestAngle && std::abs(b) <= kLargestAngle)) return {kNaN, kNaN, kNaN, kNaN};
  Pair sine, cosine;
  sineCosine(pairOf(a, b), sine, cosine);
  return {pairLow(sine), pairLow(cosine), pairHigh(sine), pairHigh(cosine)};
}

/// c + (1 - c) z z^T + s [z].
Matrix3d rotationAbout(const UnitVector& axis, double angle) {
  const Vector3d& z = axis;
  const SineCosine of = sineCosineOf(angle, 0);
  const double s = of.sine_a, c = of.cosine_a;
  Matrix3d R = (1 - c) * z * z.transpose();
  R.diagonal().array() += c;
  R(1, 0) += s * z[2], R(0, 1) -= s * z[2];
  R(0, 2) += s * z[1], R(2, 0) -= s * z[1];
  R(2, 1) += s * z[0], R(1, 2) -= s * z[0];
  return R;
}

/// exp([w]) = 1 + a [w] + b [w]^2, a = sin(theta) / theta, b = (1 - cos(theta)) / theta^2 = 2 (sin(theta/2) / theta)^2:
/// nothing cancels, however small the angle is. A theta that underflows to 0 leaves 1 + [w] + [w]^2 / 2.
Matrix3d rotationBy(const Vector3d& w) {
  const double theta = w.norm();
  const SineCosine of = sineCosineOf(theta, theta / 2);
  const double a = theta > 0 ? of.sine_a / theta : 1;
  const double half = theta > 0 ? of.sine_b / theta : 0.5;
  const double b = 2 * half * half;
  Matrix3d W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return Matrix3d::Identity() + a * W + b * W * W;
}

Vector3d valueAt(const Coefficients& q, int degree, double t) {
  Vector3d value = q.col(degree);
  for (int k = degree - 1; k >= 0; --k) value = value * t + q.col(k);
  return value;
}

bool isScalar(MotionElement::Kind kind) {
  return kind == MotionElement::Kind::revolute || kind == MotionElement::Kind::prismatic;
}

/// Bounds on |q|, |q'| and |q''| over [0, 1], and on the sum of the terms that q is computed from.
struct VariableBounds {
  double size, first, second, terms;
};

/// In tau = 2 t - 1, q = sum_k a_k tau^k with a_k = sum_(j >= k) binomial(j, k) c_j / 2^j, and |tau| <= 1.
VariableBounds boundVariable(const MotionElement& element) {
  Coefficients c = element.coefficients;
  if (isScalar(element.kind)) c.bottomRows<2>().setZero();
  VariableBounds bounds = {0, 0, 0, 0};
  for (int k = 0; k <= kMaxDegree; ++k) {
    Vector3d a = Vector3d::Zero();
    double factor = std::ldexp(1, -k), terms = 0;  // binomial(j, k) / 2^j
    for (int j = k; j <= kMaxDegree; ++j) {
      a += factor * c.col(j);
      terms += factor * c.col(j).norm();
      factor *= 0.5 * (j + 1) / (j + 1 - k);
    }
    // A term passes through at most six factors' roundings, its product and six sums; terms may cancel.
    const double most = a.norm() + 0x1p-47 * terms;
    bounds.size += most;
    bounds.first += 2 * k * most;
    bounds.second += 4 * k * (k - 1) * most;
    bounds.terms += c.col(k).norm();
  }
  return bounds;
}

// Rounding, in units of 2^-52, in any rounding mode. A constant factor of a product has its own cost. For a rotation
// about an axis or by a vector: sine and cosine, the products that make its entries, and the axis's own rounding cost
// less than 40. Its product with the rotations before it costs 9. Its angle is off by less than 3 * degree + 3 = 18
// times the sum of its terms (Horner's scheme, and the norm of the vector).
constexpr double kRotationUlps = 64, kAngleUlps = 18;
// For the box at a pose: twice the cost of the products and sums that lead to its ends, and of those of D1 and D2.
constexpr double kBoxUlps = 64;

}  // namespace

PathBounds boundPath(const BodyMotion& motion, double reach) {
  using Kind = MotionElement::Kind;
  PathBounds path;
  double a = 0, b = 0;
  bool second_order = true;
  const auto addSegment = [&](double size, double first, double second) {
    path.speed += a * size + first;
    path.acceleration += (a * a + b) * size + 2 * a * first + second;
    path.extent += a > 0 ? 2 * size : first;
  };
  path.ulps = motion.after.ulps() + kBoxUlps;
  for (const MotionElement& element : motion.elements) {
    const RigidTransform& before = element.before;
    addSegment(before.translation().norm() + 0x1p-52 * before.ulps() * before.length(), 0, 0);
    path.terms += before.length();
    path.ulps += before.ulps();
    if (element.kind == Kind::bounded) {
      const BoundedMotion::Bounds bounds = element.bounded->bounds(0, 1);
      const double size = element.bounded->state(0).pose.translation().norm() + bounds.speed;
      addSegment(size, bounds.speed, bounds.acceleration);
      a += bounds.angular_speed;
      b += bounds.angular_acceleration;
      second_order = element.bounded->hasDerivatives();
      path.terms += size;
      path.ulps += kBoundedUlps;
      continue;
    }
    const VariableBounds q = boundVariable(element);
    path.ulps += kRotationUlps;
    if (element.kind == Kind::revolute || element.kind == Kind::turn) {
      a += q.first;
      b += q.second;
      path.ulps += kAngleUlps * q.terms;
    } else {
      addSegment(q.size, q.first, q.second);
      path.terms += q.terms;
    }
  }
  addSegment(reach, 0, 0);
  path.terms += reach;
  // The rounding of D1 and D2 themselves is less than this part of them.
  const double slack = 1 + 0x1p-40;
  path.speed *= slack;
  path.angular_speed = a * slack;
  path.acceleration = second_order ? path.acceleration * slack : kInfinity;
  return path;
}

int MotionElement::degree() const {
  int degree = kMaxDegree;
  const auto isZero = [&](int k) {
    return isScalar(kind) ? coefficients(0, k) == 0 : (coefficients.col(k).array() == 0).all();
  };
  while (degree > 0 && isZero(degree)) --degree;
  return degree;
}

Isometry3d BodyMotion::pose(double t) const {
  // Products with the identity are left out: they change nothing, and most constant transforms are the identity.
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
  bool turned = false;
  const auto slideBy = [&](const Vector3d& v) { p += turned ? Vector3d(R * v) : v; };
  const auto turnBy = [&](const Matrix3d& Q) {
    R = turned ? Matrix3d(R * Q) : Q;
    turned = true;
  };
  const auto moveBy = [&](const Isometry3d& M) {
    slideBy(M.translation());
    if (!isIdentity(Matrix3d(M.linear()))) turnBy(M.linear());
  };
  for (const MotionElement& element : elements) {
    moveBy(element.before);
    const Vector3d q = element.bounded ? Vector3d::Zero() : valueAt(element.coefficients, element.degree(), t);
    switch (element.kind) {
      case MotionElement::Kind::revolute:
        turnBy(rotationAbout(element.axis, q[0]));
        break;
      case MotionElement::Kind::prismatic:
        slideBy(q[0] * element.axis.vector());
        break;
      case MotionElement::Kind::slide:
        slideBy(q);
        break;
      case MotionElement::Kind::turn:
        turnBy(rotationBy(q));
        break;
      case MotionElement::Kind::bounded:
        moveBy(element.bounded->state(t).pose);  // NOLINT(clang-analyzer-core.CallAndMessage): the kind has one
        break;
    }
  }
  moveBy(after);
  Isometry3d M;
  M.linear() = R;
  M.translation() = p;
  M.makeAffine();
  return M;
}

RigidTransform BodyMotion::poseWithError(double t) const {
  const PathBounds path = boundPath(*this, after.length());
  return RigidTransform::product(pose(t), path.ulps, path.terms);
}

/// From the body out to the world. A turn by a rotation vector q takes a unit vector v no farther than |q x v|: it is
/// exp([q]) v - v = integral of exp(s [q]) (q x v) over s in [0, 1]. So let v be where it stands at t = 0, c_k the
/// coefficients of q, and t <= 1. A turn about an axis takes v from there by at most the sum of |c_k x v|, k >= 1: the
/// turn by which the axis begins at t = 0 commutes with the rest. A turn by a vector may have another axis at t = 0,
/// and takes it there and back: by 2 |c_0 x v| more, unless it stands still. Rotations farther out change no length.
Heading headingOf(const BodyMotion& motion, const UnitVector& own) {
  using Kind = MotionElement::Kind;
  Heading heading{motion.after.linear() * own.vector(), 0};
  Vector3d& v = heading.direction;
  for (auto it = motion.elements.rbegin(); it != motion.elements.rend(); ++it) {
    const MotionElement& element = *it;
    if (element.kind == Kind::bounded) {
      heading.deviation += element.bounded->bounds(0, 1).angular_speed;
      heading.author += kBoundedUlps * std::numeric_limits<double>::epsilon();
      heading.analytic = false;
      v = element.bounded->state(0).pose.linear() * v;
    } else if (element.kind == Kind::revolute || element.kind == Kind::turn) {
      const bool about_axis = element.kind == Kind::revolute;
      const Coefficients& c = element.coefficients;
      double turned = 0;
      for (int k = 1; k <= kMaxDegree; ++k) {
        turned += about_axis ? std::abs(c(0, k)) * element.axis.vector().cross(v).norm() : c.col(k).cross(v).norm();
      }
      if (!about_axis && element.degree() > 0) turned += 2 * c.col(0).cross(v).norm();
      heading.deviation += turned;
      v = (about_axis ? rotationAbout(element.axis, c(0, 0)) : rotationBy(c.col(0))) * v;
    }
    v = element.before.linear() * v;
  }
  return heading;
}

double reachOf(const BodyMotion& motion, const Vector3d& lower, const Vector3d& upper) {
  if (!lower.allFinite() || !upper.allFinite()) return kInfinity;
  double reach = 0;  // a norm is largest at a corner
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d x(corner & 1 ? upper[0] : lower[0], corner & 2 ? upper[1] : lower[1],
                     corner & 4 ? upper[2] : lower[2]);
    reach = std::max(reach, (motion.after * x).norm());
  }
  return reach + 0x1p-52 * (motion.after.ulps() + 40) * (motion.after.length() + lower.norm() + upper.norm());
}

void enclosePath(const BodyMotion& motion, const Vector3d& lower, const Vector3d& upper, Vector3d& path_lower,
                 Vector3d& path_upper) {
  path_lower.setConstant(-kInfinity);
  path_upper.setConstant(kInfinity);
  if (!lower.allFinite() || !upper.allFinite()) return;

  const PathBounds path = boundPath(motion, reachOf(motion, lower, upper));

  // The number of pieces with which the boxes grow by 1/500 of the path's size, 256 at most. Infinity and NaN choose
  // 256.
  constexpr int kMaxPieces = 256;
  const double growth = 2e-3 * (std::min(path.speed, path.extent) + (upper - lower).norm());
  const double wanted =
      path.acceleration == 0 ? 1 : std::min(std::sqrt(path.acceleration / (8 * growth)), path.speed / (2 * growth));
  const int pieces = wanted < kMaxPieces ? std::max(1, static_cast<int>(std::ceil(wanted))) : kMaxPieces;
  const double h = (1 + 0x1p-40) / pieces;  // the times are rounded
  const double remainder = std::min(path.acceleration * h * h / 8, path.speed * h / 2);
  const double numbers = path.terms + motion.after.length() + lower.norm() + upper.norm();
  const double slack = remainder + 0x1p-52 * path.ulps * (numbers + remainder);

  const Vector3d center = 0.5 * lower + 0.5 * upper, half = 0.5 * upper - 0.5 * lower;
  Vector3d lo = Vector3d::Constant(kInfinity), hi = -lo;
  for (int k = 0; k <= pieces; ++k) {
    const Isometry3d M = motion.pose(static_cast<double>(k) / pieces);
    if (!M.matrix().allFinite()) return;
    const Vector3d c = M * center, e = M.linear().cwiseAbs() * half.cwiseAbs();
    lo = lo.cwiseMin(c - e);
    hi = hi.cwiseMax(c + e);
  }
  lo.array() -= slack;
  hi.array() += slack;
  for (int i = 0; i < 3; ++i) {
    if (lo[i] <= hi[i] && std::isfinite(slack)) {  // else overflow somewhere: no claim
      path_lower[i] = lo[i];
      path_upper[i] = hi[i];
    }
  }
}

}  // namespace fcl_artic
