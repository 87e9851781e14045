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
/// ([b c] a_k + [c a] b_k + [a b] c_k) / ([a b] + [b c] + [c a]). @throws NotProven where a sign is not certain.
std::int64_t windingNumber(const Geometry& mesh, const Vec& x, std::size_t k, bool backwards, Poses& poses) {
  std::int64_t number = 0;
  poses.spend(mesh.triangles.size());
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    const auto beside = [&](std::size_t c) {  // certainly apart from x's line in coordinate c
      const Fix low = down(x[c]) - ulps(2), high = up(x[c]) + ulps(2);
      const Fix p0 = mesh.points[mesh.triangles[t]][c], p1 = mesh.points[mesh.triangles[t + 1]][c],
                p2 = mesh.points[mesh.triangles[t + 2]][c];
      return (p0 > high && p1 > high && p2 > high) || (p0 < low && p1 < low && p2 < low);
    };
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    if (beside(i) || beside(j)) continue;
    poses.spend(50);
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
    const int height = sign(area[1] * q[0][k] + area[2] * q[1][k] + area[0] * q[2][k]) * (plus == 3 ? 1 : -1);
    if ((plus < 3 && minus < 3) || height == 0) throw NotProven("SOLID names a point that is not certainly outside");
    if ((height > 0) != backwards) number += plus == 3 ? 1 : -1;
  }
  return number;
}

/// Whether each part of A's surface, or each piece of another geometry, has a point outside of the solid B: the next
/// one of `points`, which is moved on.
void checkOutside(const World& world, Poses& poses, int a, int b, Fix t, const OutsidePoint*& next,
                  const OutsidePoint* end) {
  const Geometry &A = geometryOf(world, a), &B = geometryOf(world, b);
  // An unbounded body is not inside of a bounded one. (B's surface is closed: readWorld() has seen to it.)
  if (!B.solid || A.unbounded()) return;
  const Relative toB(world, poses, {t, t}, a, b);
  const bool mesh = A.kind == Geometry::mesh;
  poses.spend(A.pieces());
  std::set<std::uint32_t> shown;  // parts of a mesh
  for (std::uint32_t k = 0; k < A.pieces(); ++k) {
    if (mesh && shown.count(A.part[k]) > 0) continue;
    if (next == end) throw NotProven("SOLID names too few points");
    const OutsidePoint& point = *next++;
    if (point.piece >= A.pieces() || (mesh ? A.part[point.piece] != A.part[k] : point.piece != k))
      throw NotProven("SOLID names a point of another part");
    Vec p{};
    if (mesh) {  // (5 c0 + 7 c1 + 4 c2) / 16
      const std::uint32_t* const vertex = &A.triangles[3 * static_cast<std::size_t>(point.piece)];
      const Vec c0 = corner(A, vertex[0]), c1 = corner(A, vertex[1]), c2 = corner(A, vertex[2]);
      for (std::size_t i = 0; i < 3; ++i)
        p[i] = divided(c0[i] * exactly(5) + c1[i] * exactly(7) + c2[i] * exactly(4), 16);
      shown.insert(A.part[k]);
    }
    if (A.kind == Geometry::boxes) p = pointOf(&A.cells[6 * static_cast<std::size_t>(k)]);
    if (A.kind == Geometry::hull) p = corner(A, 0);
    if (windingNumber(B, toB(p), point.side % 3u, point.side > 2, poses) != 0)
      throw NotProven("a part of " + world.describe(a) + " is inside of " + world.describe(b));
  }
}

}  // namespace

void checkSolid(const World& world, Poses& poses, int a, int b, Fix t, const std::vector<OutsidePoint>& points) {
  const OutsidePoint *next = points.data(), *const end = next + points.size();
  checkOutside(world, poses, a, b, t, next, end);
  checkOutside(world, poses, b, a, t, next, end);
  if (next != end) throw NotProven("SOLID names too many points");
}

}  // namespace verify
