// SPDX-License-Identifier: BSD-3-Clause
//
// The batch of box_batch.h over a type Intervals, which the including file brings in the namespace FCL_ARTIC_ISA, with
// FCL_ARTIC_ISA_BATCH the table's name.
#include "redon/box_batch.h"

#define FCL_ARTIC_STRING2(x) #x
#define FCL_ARTIC_STRING(x) FCL_ARTIC_STRING2(x)

namespace fcl_artic {
namespace FCL_ARTIC_ISA {
namespace {

constexpr int kWidth = Intervals::kLanes;
constexpr int kFewest = kWidth > 4 ? 4 : kWidth > 2 ? 3 : kWidth;  // fewer: one by one is faster

/// The same matrix in every lane, times a number each.
struct Transform {
  Vec3<Intervals> row[3], t;
  explicit FCL_ARTIC_INLINE Transform(const IntervalTransform& M) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) row[i][j] = Intervals(M.R(i, j));
      t[i] = Intervals(M.t[i]);
    }
  }
};
template <typename T>
FCL_ARTIC_INLINE Intervals along(const Vec3<Intervals>& x, const T* v) {
  return (x[0] * v[0] + x[1] * v[1]) + x[2] * v[2];
}

/// One box per lane; lanes after the last box repeat it.
struct Boxes {
  Ends axis[3][3], center[3], half[3];

  FCL_ARTIC_INLINE Boxes(const ObbNode* const* boxes, int n) {
    alignas(64) float numbers[15][kWidth];
    for (int lane = 0; lane < kWidth; ++lane) {
      const ObbNode& box = *boxes[lane < n ? lane : n - 1];
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) numbers[3 * i + k][lane] = box.axis[i][k];
        numbers[9 + i][lane] = box.center[i];
        numbers[12 + i][lane] = box.half[i];
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) axis[i][k] = load(numbers[3 * i + k]);
      center[i] = load(numbers[9 + i]);
      half[i] = load(numbers[12 + i]);
    }
  }
};

/// Upper bound of a x + b y.
FCL_ARTIC_INLINE Ends sumOfProducts(Ends a, Ends x, Ends b, Ends y) {
  return addUp(mulUp(a, x), mulUp(b, y));
}

/// redon/overlap.h, line by line; the next axes are looked at while any pair may touch. A value that is not finite is
/// above nothing: such a pair may touch.
FCL_ARTIC_INLINE unsigned apart(const Transform& M, const ObbNode* const* first, const ObbNode* const* second, int n) {
  const unsigned all = (1u << n) - 1;
  const Boxes A(first, n), B(second, n);
  const Ends *a = A.half, *b = B.half;
  Vec3<Intervals> T, G[3];
  Ends g[3][3];
  {
    Vec3<Intervals> d, axis[3];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) axis[j][i] = along(M.row[i], B.axis[j]);
      d[i] = (along(M.row[i], B.center) + M.t[i]) - eachNumber(A.center[i]);
    }
    for (int i = 0; i < 3; ++i) {
      T[i] = along(d, A.axis[i]);
      for (int j = 0; j < 3; ++j) {
        G[i][j] = along(axis[j], A.axis[i]);
        g[i][j] = magnitude(G[i][j]);
      }
    }
  }
  unsigned out = 0;
  for (int i = 0; i < 3; ++i) {
    const Ends radius = addUp(addUp(sumOfProducts(b[0], g[i][0], b[1], g[i][1]), mulUp(b[2], g[i][2])), a[i]);
    out |= above(mignitude(T[i]), radius);
  }
  if ((out & all) == all) return all;
  const Ends slack = mulUp(spread(0x1p-18), addUp(addUp(b[0], b[1]), b[2]));
  for (int j = 0; j < 3; ++j) {
    const Intervals column[3] = {G[0][j], G[1][j], G[2][j]};
    const Ends radius =
        addUp(addUp(sumOfProducts(a[0], g[0][j], a[1], g[1][j]), mulUp(a[2], g[2][j])), addUp(b[j], slack));
    out |= above(mignitude(along(T, column)), radius);
  }
  for (int i = 0; i < 3; ++i) {
    if ((out & all) == all) return all;
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int m = (j + 1) % 3, o = (j + 2) % 3;
      const Ends radius =
          addUp(addUp(sumOfProducts(a[k], g[l][j], a[l], g[k][j]), sumOfProducts(b[m], g[i][o], b[o], g[i][m])), slack);
      out |= above(mignitude(T[k] * G[l][j] - T[l] * G[k][j]), radius);
    }
  }
  return out & all;
}

unsigned boxesApart(const IntervalTransform& M, const ObbNode* const* a, const ObbNode* const* b, int n) {
  const Scope scope;
  const Transform lanes(M);
  unsigned out = 0;
  for (int i = 0; i < n; i += kWidth) out |= apart(lanes, a + i, b + i, n - i < kWidth ? n - i : kWidth) << i;
  return out;
}

}  // namespace
}  // namespace FCL_ARTIC_ISA

const redon::BoxBatch redon::FCL_ARTIC_ISA_BATCH = {FCL_ARTIC_STRING(FCL_ARTIC_ISA), FCL_ARTIC_ISA::kFewest,
                                                    &FCL_ARTIC_ISA::boxesApart};

}  // namespace fcl_artic
