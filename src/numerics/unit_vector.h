// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Core>

namespace fcl_artic {

/// A vector whose norm is within kUlps 2^-52 of 1, in any rounding mode. There is no other way to get one than the
/// constructors below; what a lemma wants a unit vector for takes this type (doc/NUMERICS.md, "Constant transforms").
class UnitVector {
 public:
  static constexpr double kUlps = 3;

  /// z.
  UnitVector() = default;
  /// Along a coordinate axis: exact.
  static UnitVector along(int axis) { return UnitVector(Eigen::Vector3d::Unit(axis)); }
  /// Along v, however short or long v is; v itself where its norm is 1 to rounding already, as that of each vector is
  /// that this function has returned in the same rounding mode.
  /// @return none where v is zero or not finite.
  ///
  /// v is brought near 1 by a power of two first, so that no square vanishes that counts and none overflows. Then the
  /// square's sum is off by 3u, its root by 2.5u, and each quotient by u more. The errors of one rounding mode go in
  /// opposite directions, so that the norm is off by 2.5u, to nearest by 1.75u. Taken as it is, v has a computed
  /// square within 2.9u of 1, which is off by 3u: the norm is off by 2.95u. (Few vectors are divided twice: of 500,000
  /// one, to nearest.)
  static std::optional<UnitVector> within3Ulps(Eigen::Vector3d v) {
    const double largest = v.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    if (!(largest > 0 && largest < INFINITY)) return std::nullopt;
    if (largest < 0x1p-300) v *= 0x1p700;
    if (largest > 0x1p300) v *= 0x1p-700;
    for (int round = 0; round < 8 && std::abs(v.squaredNorm() - 1) > 6.4e-16; ++round) v /= v.norm();
    return UnitVector(v);
  }

  const Eigen::Vector3d& vector() const { return v_; }
  operator const Eigen::Vector3d&() const { return v_; }
  double operator[](int i) const { return v_[i]; }

 private:
  explicit UnitVector(const Eigen::Vector3d& v) : v_(v) {}

  Eigen::Vector3d v_ = Eigen::Vector3d::UnitZ();
};

/// The length of a vector along a direction that was made of it, within 4 2^-52 of itself also where its square
/// vanishes.
inline double lengthAlong(const UnitVector& direction, const Eigen::Vector3d& v) {
  const double length = v.norm();
  return length > 1e-100 ? length : direction.vector().dot(v);
}

}  // namespace fcl_artic
