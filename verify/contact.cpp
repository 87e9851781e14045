// SPDX-License-Identifier: BSD-3-Clause
// Witnesses: that bodies do meet at one time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "places.h"
#include "proof.h"

namespace verify {
namespace {

bool atMost(const Tm& a, const Tm& b) {
  return up(a) <= down(b);
}
Tm square(const Tm& a) {
  return a * a;
}
/// Whether x is certainly in the tetrahedron of four vertices of a hull: with each of them replaced by x, its volume
/// keeps its sign.
bool insideTetrahedron(const Vec corners[4], const Vec& x) {
  const auto volume = [](const Vec& a, const Vec& b, const Vec& c, const Vec& d) {
    return sign(determinant(b - a, c - a, d - a));
  };
  const Vec &a = corners[0], &b = corners[1], &c = corners[2], &d = corners[3];
  const int s = volume(a, b, c, d);
  return s != 0 && volume(x, b, c, d) == s && volume(a, x, c, d) == s && volume(a, b, x, d) == s &&
         volume(a, b, c, x) == s;
}
/// 2^k, k >= 0, the factor for each of `lengths` lengths that brings their product near 1, from below. Inequalities
/// between powers of lengths are computed in the unit 2^-k m: in metres, those of small shapes are lost below 2^-64.
Tm unitFor(double product, int lengths) {
  int k = 0;
  while (k < 30 && std::ldexp(product, lengths * (k + 1)) <= 1) ++k;
  return constant(integer(std::int64_t{1} << k));
}
Vec operator*(const Tm& unit, const Vec& x) {
  return {unit * x[0], unit * x[1], unit * x[2]};
}
/// Whether x, in g's coordinates, is certainly in that piece.
bool inside(const Geometry& g, std::uint32_t piece, const Vec& x) {
  const std::vector<double>& n = g.numbers;
  const auto half = [&](std::size_t k) { return exactly(n[k] / 2); };
  const auto within = [&](const Tm& value, const Tm& size) { return atMost(value, size) && atMost(-value, size); };
  const auto withinRadius = [&](const Vec& v) {  // |v| <= the first number
    const Tm unit = unitFor(n[0], 1);
    const Vec y = unit * v;
    return atMost(dot(y, y), square(unit * exactly(n[0])));
  };
  switch (g.kind) {
    case Geometry::box:
      return within(x[0], half(0)) && within(x[1], half(1)) && within(x[2], half(2));
    case Geometry::boxes: {
      const double* c = &g.cells[6 * static_cast<std::size_t>(piece)];
      for (std::size_t k = 0; k < 3; ++k)
        if (!within(x[k] - exactly(c[k]), exactly(c[3 + k]))) return false;
      return true;
    }
    case Geometry::sphere:
      return withinRadius(x);
    case Geometry::ellipsoid: {  // sum (x_k / a_k)^2 <= 1, times the square of a b c
      if (!(n[0] > 0 && n[1] > 0 && n[2] > 0)) return false;
      const Tm unit = unitFor(n[0] * n[1] * n[2], 3);
      const Vec y = unit * x;
      const Tm a = unit * exactly(n[0]), b = unit * exactly(n[1]), c = unit * exactly(n[2]);
      return atMost(square(y[0] * b * c) + square(a * y[1] * c) + square(a * b * y[2]), square(a * b * c));
    }
    case Geometry::capsule: {  // any point of the segment serves; the nearest is best
      const Fix end = encloseDown(n[1] / 2);
      const Tm nearest = constant(std::max(-end, std::min(end, x[2].c0)));
      return -end <= end && withinRadius({x[0], x[1], x[2] - nearest});
    }
    case Geometry::cylinder:
      return within(x[2], half(1)) && withinRadius({x[0], x[1], Tm{}});
    case Geometry::cone: {  // sqrt(x^2 + y^2) l <= r (l/2 - z), which says nothing where l is 0
      if (!(n[1] > 0 && within(x[2], half(1)))) return false;
      const Tm unit = unitFor(n[0] * n[1], 2);
      const Vec y = unit * x;
      const Tm r = unit * exactly(n[0]), l = unit * exactly(n[1]);
      return atMost((square(y[0]) + square(y[1])) * square(l), square(r * (unit * half(1) - y[2])));
    }
    case Geometry::halfspace:
      return atMost(dot(pointOf(n.data()), x), exactly(n[3]));
    default:
      return false;
  }
}

Vec readPoint(const Geometry& g, Bytes& bytes) {
  const std::uint32_t piece = bytes.varint();
  if (piece >= g.pieces()) throw BadInput("a witness names a piece that is not there");
  Vec x{};
  if (g.kind != Geometry::mesh && g.kind != Geometry::hull) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t bits = bytes.little(8);
      double value = 0;
      std::memcpy(&value, &bits, sizeof value);
      x[k] = exactly(value);
    }
    if (!inside(g, piece, x)) throw NotProven("a witness' point is not certainly in its piece");
    return x;
  }
  // sum w_k v_k / sum w_k, with integers w_k >= 0: in the hull of the v_k.
  const std::uint32_t count = bytes.varint();
  if (count == 0 || count > 16) throw BadInput("a witness' point has 1 to 16 weights");
  std::uint64_t sum = 0;
  for (std::uint32_t n = 0; n < count; ++n) {
    std::uint32_t vertex = bytes.varint();
    const auto weight = static_cast<std::int64_t>(bytes.little(4));
    if (vertex >= (g.kind == Geometry::mesh ? 3 : g.vertices.size() / 3))
      throw BadInput("a witness names a vertex that is not there");
    if (g.kind == Geometry::mesh) vertex = g.triangles[3 * static_cast<std::size_t>(piece) + vertex];
    const Vec v = corner(g, vertex);
    for (std::size_t k = 0; k < 3; ++k) {
      // w 2^-37 keeps the sum small; weights are 32 bits wide, so it is exact
      x[k] = x[k] + constant(Fix{static_cast<Int>(weight) * (kOne >> 37)}) * v[k];
    }
    sum += static_cast<std::uint64_t>(weight);
  }
  if (sum == 0) throw BadInput("a witness' weights are all 0");
  // Divided by W = sum 2^-37: X / W, by the integer quotient; errors grow by 1/W and one ulp more.
  const Int W = static_cast<Int>(sum) * (kOne >> 37);
  for (Tm& c : x) {
    const Int limit = (static_cast<Int>(1) << 126) / (static_cast<Int>(1) << 37);
    if (c.c0.v > limit || c.c0.v < -limit || c.r.v > limit) throw NotProven("a witness' point is out of range");
    const Int scale = W >> 27;  // sum, exactly: W = sum 2^27
    c.c0 = checked(c.c0.v * (static_cast<Int>(1) << 37) / scale);
    c.r = checked(c.r.v * (static_cast<Int>(1) << 37) / scale + 2);
  }
  return x;
}

}  // namespace

Meeting checkContact(const World& world, const Motion& motion, Bytes& bytes, Budget& budget) {
  bytes.byte();
  const std::uint32_t piece = bytes.varint(), first = bytes.varint(), second = bytes.varint();
  const std::uint64_t bits = bytes.little(8);
  double t = 0;
  std::memcpy(&t, &bits, sizeof t);
  if (piece >= motion.pieces.size()) throw BadInput("the contact is in a piece that is not there");
  if (first >= world.bodies.size() || second >= world.bodies.size()) throw BadInput("the contact's body is not there");
  if (!(t >= 0 && t <= 1)) throw BadInput("the contact's time is not in [0, 1]");
  const Enclosed at = enclose(t);
  const std::vector<Opponent> list = opponents(world, motion, piece, static_cast<int>(std::max(first, second)));
  const auto pair = std::find_if(
      list.begin(), list.end(), [&](const Opponent& o) { return o.body == static_cast<int>(std::min(first, second)); });
  if (first == second || pair == list.end()) throw NotProven("the contact is between bodies that are not checked");
  const auto& ignored = motion.pieces[piece].ignored;
  const auto until = ignored.find(std::minmax(static_cast<int>(first), static_cast<int>(second)));
  if (until != ignored.end() && t <= until->second)
    throw NotProven("the contact is at a time at which its pair is ignored");

  const Span span{at.x, at.x + at.error};
  Poses poses(world, motion.pieces[piece], budget);
  const std::uint8_t kind = bytes.byte();
  if (kind > 4) throw BadInput("there is no witness of kind " + std::to_string(kind));
  // `a` is the body that has the edge or the point. All is computed in the coordinates of the other one.
  const int a = static_cast<int>(kind == 1 || kind == 3 ? second : first);
  const int b = static_cast<int>(kind == 1 || kind == 3 ? first : second);
  const Geometry &A = geometryOf(world, a), &B = geometryOf(world, b);
  const Relative toB(world, poses, span, a, b);
  bool shown = false;
  if (kind <= 1) {
    const std::uint32_t triangle = bytes.varint(), edge = bytes.varint(), crossed = bytes.varint();
    if (A.kind != Geometry::mesh || B.kind != Geometry::mesh || triangle >= A.pieces() || crossed >= B.pieces() ||
        edge > 2)
      throw BadInput("CROSS names a triangle or edge that is not there");
    const Vec p = toB(corner(A, A.triangles[3 * triangle + edge])),
              q = toB(corner(A, A.triangles[3 * triangle + (edge + 1) % 3]));
    Vec c[3];
    for (std::size_t k = 0; k < 3; ++k) c[k] = corner(B, B.triangles[3 * crossed + k]) - p;
    const Vec e = q - p;
    // p and q are on different sides of the plane; the line pq passes all edges on one side.
    const int side_p = sign(determinant(c[0], c[1], c[2]));
    const int side_q = sign(determinant(c[0] - e, c[1] - e, c[2] - e));
    const int s0 = sign(determinant(e, c[0], c[1])), s1 = sign(determinant(e, c[1], c[2])),
              s2 = sign(determinant(e, c[2], c[0]));
    shown = side_p * side_q == -1 && s0 != 0 && s0 == s1 && s1 == s2;
  } else if (kind <= 3) {
    const Vec x = toB(readPoint(A, bytes));
    const std::uint32_t container = bytes.varint();
    if (container >= B.pieces()) throw BadInput("a witness names a piece that is not there");
    if (B.kind == Geometry::hull) {
      Vec corners[4];
      for (Vec& c : corners) {
        const std::uint32_t vertex = bytes.varint();
        if (vertex >= B.vertices.size() / 3) throw BadInput("a witness names a vertex that is not there");
        c = corner(B, vertex);
      }
      shown = insideTetrahedron(corners, x);
    } else {
      shown = inside(B, container, x);
    }
  } else {
    const Vec x = toB(readPoint(A, bytes)), y = readPoint(B, bytes), d = x - y;
    const Tm margin = constant(encloseDown(world.margin(a, b, motion.margin)) + encloseDown(motion.added));
    shown = margin.c0 > Fix{0} && atMost(dot(d, d), square(margin));
  }
  if (!shown)
    throw NotProven("the witness does not show that " + world.describe(a) + " and " + world.describe(b) + " meet");
  char text[64];
  std::snprintf(text, sizeof text, " at t = %.17g of piece %u", t, piece);
  return {kind == 4, world.describe(a) + " and " + world.describe(b) + text};
}

}  // namespace verify
