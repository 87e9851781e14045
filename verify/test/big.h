// SPDX-License-Identifier: BSD-3-Clause
// Reference numbers: MPFR at 300 bits, rounded to nearest. Their own errors are below 2^-200 here, against 2^-64.
#pragma once

#include <gmp.h>
#include <mpfr.h>

#include <array>
#include <cstdint>

#include "../taylor.h"

namespace verify::test {

class Big {
 public:
  Big(double x = 0) { init(), mpfr_set_d(v_, x, MPFR_RNDN); }
  Big(Fix x) {
    init();
    mpfr_set_si(v_, static_cast<long>(x.v >> 64), MPFR_RNDN);
    Big low;
    mpfr_set_ui_2exp(low.v_, static_cast<std::uint64_t>(x.v), -64, MPFR_RNDN);
    mpfr_add(v_, v_, low.v_, MPFR_RNDN);
  }
  Big(const Big& o) { init(), mpfr_set(v_, o.v_, MPFR_RNDN); }
  Big& operator=(const Big& o) { return mpfr_set(v_, o.v_, MPFR_RNDN), *this; }
  ~Big() { mpfr_clear(v_); }

  friend Big operator+(const Big& a, const Big& b) { return apply(mpfr_add, a, b); }
  friend Big operator-(const Big& a, const Big& b) { return apply(mpfr_sub, a, b); }
  friend Big operator*(const Big& a, const Big& b) { return apply(mpfr_mul, a, b); }
  friend Big operator/(const Big& a, const Big& b) { return apply(mpfr_div, a, b); }
  friend Big operator-(const Big& a) { return Big() - a; }
  friend bool operator<(const Big& a, const Big& b) { return mpfr_cmp(a.v_, b.v_) < 0; }
  friend bool operator<=(const Big& a, const Big& b) { return mpfr_cmp(a.v_, b.v_) <= 0; }
  Big sin() const { return apply(mpfr_sin); }
  Big cos() const { return apply(mpfr_cos); }
  Big sqrt() const { return apply(mpfr_sqrt); }
  Big abs() const { return apply(mpfr_abs); }
  double toDouble() const { return mpfr_get_d(v_, MPFR_RNDN); }

 private:
  void init() { mpfr_init2(v_, 300); }
  template <typename F>
  static Big apply(F f, const Big& a, const Big& b) {
    Big r;
    f(r.v_, a.v_, b.v_, MPFR_RNDN);
    return r;
  }
  template <typename F>
  Big apply(F f) const {
    Big r;
    f(r.v_, v_, MPFR_RNDN);
    return r;
  }
  mpfr_t v_;
};

/// Whether the value x at s is one of the model's.
inline bool holds(const Tm& m, const Big& s, const Big& x) {
  const Big p = Big(m.c0) + s * (Big(m.c1) + s * Big(m.c2));
  return (x - p).abs() <= Big(m.r);
}
inline Fix ulp() {
  return Fix{1};
}

using BigVec = std::array<Big, 3>;
struct BigPose {
  std::array<Big, 9> R;
  BigVec t;
};
inline BigVec operator*(const BigPose& M, const BigVec& x) {
  BigVec y;
  for (std::size_t i = 0; i < 3; ++i) y[i] = M.R[3 * i] * x[0] + M.R[3 * i + 1] * x[1] + M.R[3 * i + 2] * x[2] + M.t[i];
  return y;
}
inline BigPose operator*(const BigPose& A, const BigPose& B) {
  BigPose C;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      C.R[3 * i + j] = A.R[3 * i] * B.R[j] + A.R[3 * i + 1] * B.R[3 + j] + A.R[3 * i + 2] * B.R[6 + j];
  C.t = A * B.t;
  return C;
}
inline BigPose identity() {
  BigPose M;
  for (std::size_t i = 0; i < 3; ++i) M.R[4 * i] = Big(1.0);
  return M;
}
/// The rotation about `axis`, of any length, by `angle`.
inline BigPose turned(const BigVec& axis, const Big& angle) {
  const Big length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
  BigPose M = identity();
  if (length <= Big(0.0)) return M;
  const BigVec k{axis[0] / length, axis[1] / length, axis[2] / length};
  const Big c = angle.cos(), s = angle.sin(), rest = Big(1.0) - c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) M.R[3 * i + j] = rest * k[i] * k[j] + (i == j ? c : Big());
  M.R[1] = M.R[1] - s * k[2];
  M.R[3] = M.R[3] + s * k[2];
  M.R[2] = M.R[2] + s * k[1];
  M.R[6] = M.R[6] - s * k[1];
  M.R[5] = M.R[5] - s * k[0];
  M.R[7] = M.R[7] + s * k[0];
  return M;
}

}  // namespace verify::test
