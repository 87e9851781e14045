// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers of 256 bits (MPFR), so much finer than double that what they come to counts as exact. Not touched by the
// rounding mode of the processor.
#pragma once

#include <array>

#include <mpfr.h>

namespace fcl_artic {
namespace numerics_test {

class Real {
 public:
  Real() { init(); }
  Real(double x) {  // NOLINT: exact
    init();
    mpfr_set_d(x_, x, MPFR_RNDN);
  }
  Real(const Real& o) {
    init();
    mpfr_set(x_, o.x_, MPFR_RNDN);
  }
  Real& operator=(const Real& o) {  // NOLINT(bugprone-unhandled-self-assignment): MPFR takes it
    mpfr_set(x_, o.x_, MPFR_RNDN);
    return *this;
  }
  double toDouble() const { return mpfr_get_d(x_, MPFR_RNDN); }

  Real& operator+=(const Real& o) { return mpfr_add(x_, x_, o.x_, MPFR_RNDN), *this; }
  Real& operator-=(const Real& o) { return mpfr_sub(x_, x_, o.x_, MPFR_RNDN), *this; }
  Real& operator*=(const Real& o) { return mpfr_mul(x_, x_, o.x_, MPFR_RNDN), *this; }
  Real& operator/=(const Real& o) { return mpfr_div(x_, x_, o.x_, MPFR_RNDN), *this; }
  friend Real operator+(Real a, const Real& b) { return a += b; }
  friend Real operator-(Real a, const Real& b) { return a -= b; }
  friend Real operator*(Real a, const Real& b) { return a *= b; }
  friend Real operator/(Real a, const Real& b) { return a /= b; }
  friend Real operator-(const Real& a) {
    Real o;
    mpfr_neg(o.x_, a.x_, MPFR_RNDN);
    return o;
  }
  friend bool operator<(const Real& a, const Real& b) { return mpfr_less_p(a.x_, b.x_) != 0; }
  friend bool operator>(const Real& a, const Real& b) { return b < a; }
  friend bool operator<=(const Real& a, const Real& b) { return mpfr_lessequal_p(a.x_, b.x_) != 0; }
  friend bool operator>=(const Real& a, const Real& b) { return b <= a; }
  friend Real sqrt(const Real& a) { return map(mpfr_sqrt, a); }
  friend Real sin(const Real& a) { return map(mpfr_sin, a); }
  friend Real cos(const Real& a) { return map(mpfr_cos, a); }
  friend Real atan(const Real& a) { return map(mpfr_atan, a); }
  friend Real abs(const Real& a) { return a < Real(0.0) ? -a : a; }
  friend Real max(const Real& a, const Real& b) { return a < b ? b : a; }

 private:
  static constexpr mpfr_prec_t kBits = 256;
  void init() {
    mpfr_custom_init(limbs_, kBits);
    mpfr_custom_init_set(x_, MPFR_ZERO_KIND, 0, kBits, limbs_);
  }
  static Real map(int (*f)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t), const Real& a) {
    Real o;
    f(o.x_, a.x_, MPFR_RNDN);
    return o;
  }
  mpfr_t x_;
  mp_limb_t limbs_[kBits / 64];
};

using Real3 = std::array<Real, 3>;
inline Real dot(const Real3& a, const Real3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Real norm(const Real3& a) {
  return sqrt(dot(a, a));
}
inline Real3 operator+(const Real3& a, const Real3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Real3 operator-(const Real3& a, const Real3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Real3 operator*(const Real& s, const Real3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Real3 unit(const Real3& a) {
  return Real(1.0) / norm(a) * a;
}

/// A proper rigid motion, its rotation as three columns.
struct RealRigid {
  std::array<Real3, 3> R = {Real3{1.0, 0.0, 0.0}, Real3{0.0, 1.0, 0.0}, Real3{0.0, 0.0, 1.0}};
  Real3 t = {0.0, 0.0, 0.0};

  Real3 turn(const Real3& p) const { return p[0] * R[0] + p[1] * R[1] + p[2] * R[2]; }
  Real3 turnBack(const Real3& p) const { return {dot(R[0], p), dot(R[1], p), dot(R[2], p)}; }
  Real3 operator*(const Real3& p) const { return turn(p) + t; }
  RealRigid operator*(const RealRigid& o) const { return {{turn(o.R[0]), turn(o.R[1]), turn(o.R[2])}, turn(o.t) + t}; }
  RealRigid inverse() const {
    RealRigid o;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) o.R[i][j] = R[j][i];
    }
    o.t = Real(-1.0) * turnBack(t);
    return o;
  }
};

/// Rotation by q about a unit axis.
inline RealRigid rotation(const Real3& axis, const Real& q) {
  const Real s = sin(q), c = cos(q);
  RealRigid M;
  for (std::size_t j = 0; j < 3; ++j) {
    Real3 e = {0.0, 0.0, 0.0};
    e[j] = 1.0;
    M.R[j] = c * e + s * cross(axis, e) + (Real(1.0) - c) * axis[j] * axis;
  }
  return M;
}

}  // namespace numerics_test
}  // namespace fcl_artic
