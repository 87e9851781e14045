// SPDX-License-Identifier: BSD-3-Clause
// SOLID: at one time no surface lies in the other body.
#include <set>

#include "places.h"
#include "proof.h"

namespace verify {
namespace {

/// The winding number of a closed mesh around x: its crossings with the half-line from x along coordinate axis k, each
/// counted by the side that it is crossed from. In the plane of the two other coordinates, relative to x, a triangle
/// (a, b, c) is crossed where the areas [a b], [b c], [c a] have one sign, at the height
/// ([b c] a_k + [c a] b_k + [a b] c_k) / ([a b] + [b c] + [c a]). @return false where a sign is not certain.
bool windingNumber(const Geometry& mesh, const Vec& x, std::size_t k, bool backwards, Budget& budget,
                   std::int64_t& number) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  Fix low[3], high[3];
  for (std::size_t c = 0; c < 3; ++c) {
    low[c] = down(x[c]) - ulps(2);
    high[c] = up(x[c]) + ulps(2);
  }
  number = 0;
  budget.spend(mesh.triangles.size());
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    const Fix* const p[3] = {mesh.points[mesh.triangles[t]].x, mesh.points[mesh.triangles[t + 1]].x,
                             mesh.points[mesh.triangles[t + 2]].x};
    const auto beside = [&](std::size_t c) {  // certainly apart from x's line in coordinate c
      return (p[0][c] > high[c] && p[1][c] > high[c] && p[2][c] > high[c]) ||
             (p[0][c] < low[c] && p[1][c] < low[c] && p[2][c] < low[c]);
    };
    if (beside(i) || beside(j)) continue;
    budget.spend(50);
    Vec q[3];
    for (std::size_t c = 0; c < 3; ++c) q[c] = corner(mesh, mesh.triangles[t + c]) - x;
    Tm area[3];
    int plus = 0, minus = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec &a = q[c], &b = q[(c + 1) % 3];
      area[c] = a[i] * b[j] - a[j] * b[i];
      plus += sign(area[c]) > 0;
      minus += sign(area[c]) < 0;
    }
    if (plus > 0 && minus > 0) continue;
    if (plus < 3 && minus < 3) return false;
    const int height = sign(area[1] * q[0][k] + area[2] * q[1][k] + area[0] * q[2][k]) * (plus == 3 ? 1 : -1);
    if (height == 0) return false;
    if ((height > 0) != backwards) number += plus == 3 ? 1 : -1;
  }
  return true;
}

/// Whether each part of A's surface, or each piece of another geometry, has a point outside of the solid B: the next
/// one of `points`, which is moved on.
void checkOutside(const World& world, Poses& poses, int a, int b, const Span& span,
                  std::vector<OutsidePoint>::const_iterator& next, std::vector<OutsidePoint>::const_iterator end,
                  Budget& budget) {
  const Geometry &A = geometryOf(world, a), &B = geometryOf(world, b);
  // What is without bounds is not inside of what has them. (B's surface is closed: readWorld() has seen to it.)
  if (!B.solid || A.unbounded()) return;
  const Relative toB(world, poses, span, a, b);
  const bool mesh = A.kind == Geometry::mesh;
  budget.spend(A.pieces());
  std::set<std::uint32_t> shown;  // parts of a mesh
  for (std::uint32_t k = 0; k < A.pieces(); ++k) {
    if (mesh && shown.count(A.part[k]) > 0) continue;
    const auto fail = [&](const std::string& why) {
      throw NotProven("SOLID " + why + ": " + world.describe(a) + " and " + world.describe(b));
    };
    if (next == end) fail("names too few points");
    const OutsidePoint& point = *next++;
    if (point.piece >= A.pieces() || (mesh ? A.part[point.piece] != A.part[k] : point.piece != k))
      fail("names a point of another part");
    Vec p{};
    if (mesh) {  // (5 c0 + 7 c1 + 4 c2) / 16
      const std::uint32_t* const t = &A.triangles[3 * static_cast<std::size_t>(point.piece)];
      const Vec c[3] = {corner(A, t[0]), corner(A, t[1]), corner(A, t[2])};
      for (std::size_t i = 0; i < 3; ++i)
        p[i] = divided(c[0][i] * constant(integer(5)) + c[1][i] * constant(integer(7)) + c[2][i] * constant(integer(4)),
                       16);
      shown.insert(A.part[k]);
    }
    if (A.kind == Geometry::boxes) p = pointOf(&A.cells[6 * static_cast<std::size_t>(k)]);
    if (A.kind == Geometry::hull) p = corner(A, 0);
    std::int64_t number = 0;
    if (!windingNumber(B, toB(p), point.side % 3u, point.side > 2, budget, number))
      fail("names a point that is not certainly outside");
    if (number != 0) throw NotProven("a part of " + world.describe(a) + " is inside of " + world.describe(b));
  }
}

}  // namespace

void checkSolid(const World& world, Poses& poses, int a, int b, Fix t, const std::vector<OutsidePoint>& points,
                Budget& budget) {
  auto next = points.begin();
  checkOutside(world, poses, a, b, {t, t}, next, points.end(), budget);
  checkOutside(world, poses, b, a, {t, t}, next, points.end(), budget);
  if (next != points.end()) throw NotProven("SOLID names too many points");
}

}  // namespace verify
