// SPDX-License-Identifier: BSD-3-Clause
// Points of bodies at one time, and signs that are certain.
#pragma once

#include "motion.h"

namespace verify {

inline Fix up(const Tm& a) {
  return a.c0 + abs(a.c1) + abs(a.c2) + a.r;
}
inline Fix down(const Tm& a) {
  return a.c0 - abs(a.c1) - abs(a.c2) - a.r;
}
/// 1 or -1 where certain, else 0.
inline int sign(const Tm& a) {
  return down(a) > Fix{0} ? 1 : up(a) < Fix{0} ? -1 : 0;
}
inline Vec pointOf(const double* x) {
  return {exactly(x[0]), exactly(x[1]), exactly(x[2])};
}

/// det(a, b, c)
inline Tm determinant(const Vec& a, const Vec& b, const Vec& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Takes points of body A to coordinates of body B's geometry: row k is the functional "coordinate k there" in A's.
class Relative {
 public:
  Relative(const World& world, Poses& poses, const Span& span, int a, int b) {
    for (std::size_t k = 0; k < 3; ++k) {
      Functional::Value f;
      f.v[k] = constant(integer(1));
      const Functional::Value in_frame = toParent(f, world.bodies[b].pose);
      rows_[k] = Functional(world, poses, span, world.bodies[b].frame, in_frame.v, in_frame.d).inBody(a);
    }
  }
  Vec operator()(const Vec& x) const {
    Vec y;
    for (std::size_t k = 0; k < 3; ++k) y[k] = dot(rows_[k].v, x) + rows_[k].d;
    return y;
  }

 private:
  Functional::Value rows_[3];
};

inline const Geometry& geometryOf(const World& world, int body) {
  return world.geometries[world.bodies[body].geometry];
}

inline Vec corner(const Geometry& g, std::uint32_t vertex) {
  return pointOf(&g.vertices[3 * static_cast<std::size_t>(vertex)]);
}

}  // namespace verify
