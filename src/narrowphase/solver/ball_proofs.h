// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs of contact by balls inside closed meshes, at one pose, where any contact will do. Where what two closed
// surfaces enclose meets, and neither surface lies within what the other encloses, the surfaces meet (doc/NUMERICS.md,
// "Inner balls").
#pragma once

#include "convex/piece_kinds.h"
#include "narrowphase/solver/contact_list.h"
#include "narrowphase/solver/swept_box.h"
#include "narrowphase/solver/swept_frames.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::ClosedPart;
using engine::InnerBalls;

/// A link's tree frame in another frame at one time. A point p of the link, |p| <= extent, is at R p + c up to
/// kUlp (ulps + kPoseUlps) sizes.
struct PlacedLink {
  double R[9], c[3];
  double ulps, sizes;

  PlacedLink(const Placement& P, double extent) : ulps(P.ulps), sizes(P.length + extent) {
    for (int i = 0; i < 9; ++i) R[i] = P.R[i];
    for (int k = 0; k < 3; ++k) c[k] = P.t[k];
  }
  template <class T>
  FCL_ARTIC_INLINE void place(const T* p, T* x) const {
    for (int k = 0; k < 3; ++k) x[k] = dot(p, R + 3 * k) + T(c[k]);
  }
  template <class T>
  FCL_ARTIC_INLINE void turnBack(const T* d, T* p) const {
    for (int k = 0; k < 3; ++k) p[k] = mulAdd(d[2], T(R[6 + k]), mulAdd(d[1], T(R[3 + k]), d[0] * T(R[k])));
  }
  template <class T>
  FCL_ARTIC_INLINE void opposite(const T* x, T* p) const {
    const T d[3] = {x[0] - T(c[0]), x[1] - T(c[1]), x[2] - T(c[2])};
    turnBack(d, p);
  }
  double error() const { return kUlp * (ulps + kPoseUlps) * sizes + kLeastLength; }
};

/// The same behind one more placement.
inline PlacedLink seenFrom(const Placement& P, const PlacedLink& link) {
  PlacedLink seen = {P, 0};
  for (int k = 0; k < 3; ++k) {
    const double* row = P.R + 3 * k;
    for (int j = 0; j < 3; ++j)
      seen.R[3 * k + j] = row[0] * link.R[j] + row[1] * link.R[3 + j] + row[2] * link.R[6 + j];
    seen.c[k] += dot(row, link.c);
  }
  seen.ulps += link.ulps;
  seen.sizes += link.sizes;
  return seen;
}

/// Bound on the error of two such places' difference; seen from either link it is three times that.
inline double differenceError(const PlacedLink& a, const PlacedLink& b) {
  return kUlp * (a.ulps + b.ulps + kPoseUlps) * (a.sizes + b.sizes) + kLeastLength;
}

FCL_ARTIC_INLINE const Lanes& lanesAt(const double* x) {
  return *reinterpret_cast<const Lanes*>(x);
}

/// One of eight points, in a part's tree frame and off by `error` at most, certainly lies outside the part's box.
inline bool certainlyOutside(const ClosedPart& part, const Lanes* points, double error) {
  unsigned out = 0;
  for (int k = 0; k < 3; ++k) {
    out |= greater(points[k], Lanes(part.hi[k] + error)) | greater(Lanes(part.lo[k] - error), points[k]);
  }
  return out != 0;
}

/// A link's part certainly reaches out of another link's part.
inline bool certainlyReachesOut(const ClosedPart& part, const PlacedLink& link, const ClosedPart& other_part,
                                const PlacedLink& other, double error) {
  const Lanes p[3] = {lanesAt(part.points[0]), lanesAt(part.points[1]), lanesAt(part.points[2])};
  Lanes x[3], seen[3];
  link.place(p, x);
  other.opposite(x, seen);
  return certainlyOutside(other_part, seen, error);
}

/// Proofs at the middle of a lane of the present batch. What is proven is recorded, and true is returned.
class BallProofs : PartOfSolver {
 public:
  BallProofs(Task& task, SweptFrames& frames, ContactList& contacts)
      : PartOfSolver(task), frames_(frames), contacts_(contacts) {}

  double reach(int pair) const;
  bool inLinks(int pair, int lane);
  bool inSolid(int pair, int lane);

 private:
  PlacedLink placedLink(int index, int lane);

  SweptFrames& frames_;
  ContactList& contacts_;
};

/// A mover's tree frame in the world at a lane's middle.
inline PlacedLink BallProofs::placedLink(int index, int lane) {
  const Body& mover = body(problem().movers[index]);
  if (mover.step < 0) return {mover.placement, mover.tree->extent};
  const FrameLanes& frame = frames_.of(0)[mover.step];
  const StepBounds& b = frames_.bounds(0, mover.step);
  Placement step;
  for (int i = 0; i < 9; ++i) step.R[i] = frame.R[i][lane];
  for (int k = 0; k < 3; ++k) step.t[k] = frame.o[k][lane];
  step.ulps = b.ulps;
  step.length = b.length + b.D1 * frames_.batch().d;
  return seenFrom(step, {mover.placement, mover.tree->extent});
}

/// Distance of two links' line swept spheres' segments below which balls inside them may meet; 0: none can.
inline double BallProofs::reach(int pair) const {
  const PairParts bodies = problem().parts(pair);
  const InnerBalls *a = body(bodies.a).balls, *b = body(bodies.b).balls;
  return a && b ? a->reach + b->reach : 0;
}

/// Two links at a lane's middle: a ball inside the one and a ball inside the other meet, and both parts reach out of
/// each other.
inline bool BallProofs::inLinks(int pair, int lane) {
  const PairParts bodies = problem().parts(pair);
  const Body &A = body(bodies.a), &B = body(bodies.b);
  const InnerBalls &of_a = *A.balls, &of_b = *B.balls;
  const PlacedLink a = placedLink(A.mover, lane), b = placedLink(B.mover, lane);
  const double error = 4 * differenceError(a, b);
  Lanes centers[InnerBalls::kMost / kLanes][3];
  for (int i = 0; i < of_a.count; i += kLanes) {
    Lanes c[3];
    for (int k = 0; k < 3; ++k) c[k] = lanesAt(of_a.center[k] + i);
    a.place(c, centers[i / kLanes]);
  }
  int nested_a = -1, nested_b = -1;  // parts of which the one may lie within the other
  for (int j = 0; j < of_b.count; ++j) {
    const double c[3] = {of_b.center[0][j], of_b.center[1][j], of_b.center[2][j]};
    double center[3];
    b.place(c, center);
    for (int first = 0; first < of_a.count; first += kLanes) {
      const Lanes* x = centers[first / kLanes];
      const Lanes d[3] = {x[0] - Lanes(center[0]), x[1] - Lanes(center[1]), x[2] - Lanes(center[2])};
      const Lanes radii = lanesAt(of_a.radius + first) + Lanes(of_b.radius[j] - error);
      for (unsigned meet = greater(radii, Lanes(0.0)) & greater(radii * radii, dot(d, d)); meet; meet &= meet - 1) {
        const int i = first + __builtin_ctz(meet);
        if (of_a.part[i] == nested_a && of_b.part[j] == nested_b) continue;
        const ClosedPart &part_a = of_a.parts[of_a.part[i]], &part_b = of_b.parts[of_b.part[j]];
        ++statistics().contact_proofs;
        if (!certainlyReachesOut(part_a, a, part_b, b, error) || !certainlyReachesOut(part_b, b, part_a, a, error)) {
          nested_a = of_a.part[i];
          nested_b = of_b.part[j];
          continue;
        }
        LeafContact* const recorded = contacts_.record(pair, -1, -1, frames_.batch().at[lane]);
        if (!recorded) return false;
        LeafContact& contact = *recorded;
        contact.feature = engine::kVolume;
        // From A's centre towards B's, in the middle of what both balls have in common.
        const double seen[3] = {-d[0][i - first], -d[1][i - first], -d[2][i - first]};
        a.turnBack(seen, contact.normal);
        const double distance = norm(contact.normal);
        const double along = 0.5 * (max(distance - of_b.radius[j], 0.0) + min(of_a.radius[i], distance));
        for (int k = 0; k < 3; ++k) {
          contact.normal[k] = distance > 0 ? contact.normal[k] / distance : (k == 2);
          contact.point[k] = of_a.center[k][i] + along * contact.normal[k];
        }
        return true;
      }
    }
  }
  return false;
}

/// Points of a solid, farthest along eight directions, in its tree frame.
inline void farPoints(const TreeView& solid, Lanes* points) {
  static const double kDirections[8][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0},
                                           {0, 0, 1}, {0, 0, -1}, {1, 1, 1}, {-1, -1, -1}};
  for (int i = 0; i < 8; ++i) {
    double x[3];
    supportPoint(solid, solid.pieces[0], kDirections[i], x);
    const double radius = i < 6 ? solid.pieces[0].radius : 0;
    for (int k = 0; k < 3; ++k) points[k].set(i, x[k] + radius * kDirections[i][k]);
  }
}

/// A link and a solid at a lane's middle: a ball inside the link's mesh meets the solid, and that, being of one piece,
/// reaches out of the mesh's part.
inline bool BallProofs::inSolid(int pair, int lane) {
  const PairParts bodies = problem().parts(pair);
  const Body &solid = body(bodies.a), &link = body(bodies.b);
  if (!link.balls) return false;
  const InnerBalls& balls = *link.balls;
  PlacedLink place = seenFrom(solid.inverse, placedLink(link.mover, lane));
  place.sizes += solid.tree->extent;
  const double error = 4 * place.error();
  for (int first = 0; first < balls.count; first += kLanes) {
    Lanes c[3], x[3];
    for (int k = 0; k < 3; ++k) c[k] = lanesAt(balls.center[k] + first);
    place.place(c, x);
    const Lanes depth = lanesAt(balls.radius + first) - (distanceFrom(solid.tree->pieces[0], x) + Lanes(error));
    const double deepest = maxLane(depth);
    if (!(deepest > 0)) continue;
    const int i = __builtin_ctz(kAllLanes & ~greater(Lanes(deepest), depth));
    ++statistics().contact_proofs;
    Lanes far[3], seen[3];
    farPoints(*solid.tree, far);
    place.opposite(far, seen);
    if (!certainlyOutside(balls.parts[balls.part[first + i]], seen, error)) continue;
    LeafContact* const recorded = contacts_.record(pair, 0, -1, frames_.batch().at[lane]);
    if (!recorded) return false;
    LeafContact& contact = *recorded;
    contact.feature = engine::kVolume;
    // From the solid's point next to the ball's centre towards that; away from the solid's middle where it is within.
    const double center[3] = {x[0][i], x[1][i], x[2][i]};
    nearestPoint(solid.tree->pieces[0], center, contact.point);
    double middle[3];
    middleOf(solid.tree->nodes[0], middle);
    const bool within = distanceFrom(solid.tree->pieces[0], x)[i] <= 0;
    for (int k = 0; k < 3; ++k) contact.normal[k] = center[k] - (within ? middle : contact.point)[k];
    const double length = norm(contact.normal);
    for (int k = 0; k < 3; ++k) contact.normal[k] = length > 0 ? contact.normal[k] / length : (k == 2);
    return true;
  }
  return false;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
