// SPDX-License-Identifier: BSD-3-Clause
//
// Rotations and rigid transforms whose error is known: what the lemmas take for granted of them is what these types'
// constructors establish (doc/NUMERICS.md, "Constant transforms").
#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "numerics/assertion.h"
#include "numerics/constants.h"
#include "numerics/unit_vector.h"

namespace fcl_artic {

inline bool isIdentity(const Eigen::Matrix3d& R) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (R(i, j) != (i == j ? 1 : 0)) return false;  // so it goes for NaN
    }
  }
  return true;
}
inline bool isIdentity(const Eigen::Isometry3d& M) {
  return M(0, 3) == 0 && M(1, 3) == 0 && M(2, 3) == 0 && isIdentity(Eigen::Matrix3d(M.linear()));
}

/// 1 - R^T R.
inline Eigen::Matrix3d orthonormalityDefect(const Eigen::Matrix3d& R) {
  return Eigen::Matrix3d::Identity() - R.transpose() * R;
}

/// A matrix within kUlps 2^-52 (Frobenius) of a proper rotation, in any rounding mode.
class Rotation {
 public:
  static constexpr double kUlps = 12;

  /// The identity.
  Rotation() = default;
  /// The proper rotation next to R; R itself where it is orthonormal to rounding already, as is each matrix that this
  /// function has returned in the same rounding mode.
  /// @param most  what each entry of 1 - R^T R may be off 0 by, 1e-4 at most.
  /// @return none where one is off by more, or is not a number, or R is a reflection.
  static std::optional<Rotation> within12Ulps(Eigen::Matrix3d R, double most) {
    Eigen::Matrix3d defect = orthonormalityDefect(R);
    if (!((defect.array().abs() <= most).all() && R.determinant() > 0)) return std::nullopt;
    for (int round = 0; !(defect.cwiseAbs().maxCoeff() <= 4e-16); ++round) {
      if (round == kRounds) return Rotation(firstOfCircle(R));
      R = step(R, defect);
      defect = orthonormalityDefect(R);
    }
    return Rotation(R);
  }
  /// A rotation whose z axis is `axis`; the identity where that is z.
  static Rotation withZ(const UnitVector& axis) {
    if (axis.vector() == Eigen::Vector3d::UnitZ()) return Rotation();
    const Eigen::Vector3d x = axis.vector().unitOrthogonal();
    Eigen::Matrix3d R;
    R.col(0) = x;
    R.col(1) = axis.vector().cross(x);
    R.col(2) = axis.vector();
    return Rotation(R);
  }

  const Eigen::Matrix3d& matrix() const { return R_; }
  operator const Eigen::Matrix3d&() const { return R_; }

 private:
  explicit Rotation(const Eigen::Matrix3d& R) : R_(R) {}

  /// Three rounds do, but for one matrix of 70,000. After that many the others are orthonormal to rounding, or go in
  /// circles of a few matrices.
  static constexpr int kRounds = 64;
  /// Newton's iteration: squares the defect.
  static Eigen::Matrix3d step(const Eigen::Matrix3d& R, const Eigen::Matrix3d& defect) { return R + 0.5 * R * defect; }
  /// The first matrix, in the order of numbers, of the circle that R is on. It is the same one for all matrices of the
  /// circle.
  static Eigen::Matrix3d firstOfCircle(const Eigen::Matrix3d& R);

  Eigen::Matrix3d R_ = Eigen::Matrix3d::Identity();
};

/// The error of one more factor in a product of rigid transforms: that of the stored rotation, and 9 for the product,
/// in 2^-52 and in any rounding mode.
constexpr double kTransformUlps = 24;

/// A stored rigid transform or a product of such, with the error that it has: no matrix of unknown error gets into a
/// chain of motions.
class RigidTransform {
 public:
  /// The identity.
  RigidTransform() = default;
  /// A stored transform.
  RigidTransform(const Rotation& R, const Eigen::Vector3d& t) : M_(Eigen::Isometry3d::Identity()) {
    M_.linear() = R.matrix();
    place(t);
  }
  /// A stored transform.
  /// @param most  as Rotation::within12Ulps() has it.
  /// @return none where the rotation is refused, or the translation is not finite or has an entry beyond 1e9 m:
  ///   whyNotRigid() says what it is.
  static std::optional<RigidTransform> within12Ulps(const Eigen::Isometry3d& M, double most) {
    if (!((M.translation().array().abs() <= kFarthest).all())) return std::nullopt;
    const std::optional<Rotation> R = Rotation::within12Ulps(M.linear(), most);
    if (!R) return std::nullopt;
    return RigidTransform(*R, M.translation());
  }
  /// A product that somebody has multiplied himself.
  /// @param ulps, length  as ulps() and length() return them: M must be no farther from a rigid transform, nor reach
  ///   farther.
  static RigidTransform product(const Eigen::Isometry3d& M, double ulps, double length) {
    RigidTransform product;
    product.M_ = M;
    product.length_ = length;
    product.ulps_ = std::max(ulps, kTransformUlps);
    FCL_ARTIC_ASSERT(product.isAsGoodAsItSays());
    return product;
  }

  /// The product, with the errors of both.
  RigidTransform operator*(const RigidTransform& other) const {
    if (isStored() && isIdentity(M_)) return other;
    if (other.isStored() && isIdentity(other.M_)) return *this;
    return product(M_ * other.M_, ulps_ + other.ulps_, length_ + other.length_);
  }
  /// The inverse. -R^T t is off by the errors of both R and t: twice as much, for a product; a stored t is exact.
  RigidTransform inverse() const {
    RigidTransform inverse = *this;
    inverse.M_ = M_.inverse();
    if (isStored()) {
      inverse.place(inverse.M_.translation());
    } else {
      inverse.ulps_ *= 2;
    }
    return inverse;
  }
  /// The same rotation elsewhere.
  RigidTransform at(const Eigen::Vector3d& t) const {
    RigidTransform moved = *this;
    moved.place(t);
    return moved;
  }

  /// How much it adds to the error of a product's rotation, in 2^-52; the place is off by as much, times length().
  double ulps() const { return ulps_; }
  /// Upper bound of the sum of all translations in it, m.
  double length() const { return length_; }

  operator const Eigen::Isometry3d&() const { return M_; }
  const Eigen::Isometry3d& isometry() const { return M_; }
  auto linear() const { return M_.linear(); }
  auto translation() const { return M_.translation(); }
  const Eigen::Matrix4d& matrix() const { return M_.matrix(); }
  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return M_ * x; }
  friend Eigen::Isometry3d operator*(const Eigen::Isometry3d& a, const RigidTransform& b) { return a * b.M_; }

 private:
  /// Not a product.
  bool isStored() const { return ulps_ == kTransformUlps; }
  /// R is off by e = ulps 2^-52 at most, so R^T R by 2 e + e^2, and by 9 2^-52 more as computed.
  bool isAsGoodAsItSays() const {
    const double e = 0x1p-52 * ulps_, slack = 0x1p-48 + 4 * e;
    return orthonormalityDefect(M_.linear()).norm() <= 2 * e + e * e + 0x1p-48 &&
           M_.translation().norm() <= length_ * (1 + slack) && std::isfinite(length_);
  }
  void place(const Eigen::Vector3d& t) {
    FCL_ARTIC_ASSERT(t.allFinite());
    M_.translation() = t;
    length_ = t.norm() * (1 + 1e-15);
  }

  Eigen::Isometry3d M_ = Eigen::Isometry3d::Identity();
  double length_ = 0, ulps_ = kTransformUlps;
};

/// Why RigidTransform::within12Ulps() takes no M, as the end of a sentence: "has a transform that is not finite", "is
/// more than 1e9 m away" and so on.
std::string whyNotRigid(const Eigen::Isometry3d& M, double most);

/// The transform that RigidTransform::within12Ulps() makes of M.
/// @param nameOf  what M belongs to, for the message: called where there is one, as spelling takes longer than reading.
/// @throws std::invalid_argument beginning with that name where it makes nothing.
template <class NameOf>
RigidTransform requireRigid(const Eigen::Isometry3d& M, double most, const NameOf& nameOf) {
  if (const std::optional<RigidTransform> rigid = RigidTransform::within12Ulps(M, most)) return *rigid;
  throw std::invalid_argument(nameOf() + " " + whyNotRigid(M, most));
}

}  // namespace fcl_artic
