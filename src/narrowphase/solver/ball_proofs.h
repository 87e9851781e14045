// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs of contact by balls inside closed meshes, at one pose, for queries that any contact answers. If the spaces
// that two closed surfaces enclose meet, and neither surface lies within the space that the other encloses, the
// surfaces meet (doc/NUMERICS.md, "Inner balls").
#pragma once

#include "convex/piece_kinds.h"
#include "narrowphase/solver/search_state.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::ClosedPart;
using engine::InnerBalls;

/// A link's tree frame in another frame at one time. A point p of the link, |p| <= extent, is at R p + c up to
/// kUlp (ulps + kPoseUlps) sizes.
struct PlacedLink {
  Mat3 R;
  Vec3 c;
  double ulps, sizes;

  PlacedLink(const Placement& P, double extent) : R(P.R), c(P.t), ulps(P.ulps), sizes(P.length + extent) {}

  FCL_ARTIC_INLINE Vec3 place(const Vec3& p) const { return R * p + c; }
  FCL_ARTIC_INLINE Vec3Lanes place(const Vec3Lanes& p) const { return R * p + spread(c); }
  FCL_ARTIC_INLINE Vec3Lanes seenFromLink(const Vec3Lanes& x) const { return transposedTimes(R, x - spread(c)); }
  double error() const { return kUlp * (ulps + kPoseUlps) * sizes + kLeastLength; }
};

/// The same, seen through one more placement.
inline PlacedLink seenFrom(const Placement& P, const PlacedLink& link) {
  PlacedLink seen = {P, 0};
  seen.c = seen.place(link.c);
  seen.R = seen.R * link.R;
  seen.ulps += link.ulps;
  seen.sizes += link.sizes;
  return seen;
}

/// Bound on the error of the difference of two points, one placed by `a` and one by `b`. Three times that bounds the
/// error of the difference as seen from either link.
inline double differenceError(const PlacedLink& a, const PlacedLink& b) {
  return kUlp * (a.ulps + b.ulps + kPoseUlps) * (a.sizes + b.sizes) + kLeastLength;
}

FCL_ARTIC_INLINE const Lanes& lanesAt(const double* x) {
  return *reinterpret_cast<const Lanes*>(x);
}
/// Eight points, of which the coordinates lie in three rows.
FCL_ARTIC_INLINE Vec3Lanes pointsAt(const double* x, const double* y, const double* z) {
  return {lanesAt(x), lanesAt(y), lanesAt(z)};
}

/// Whether at least one of eight points certainly lies outside a part's box. The points are in the part's tree frame,
/// off by `error` at most.
inline bool certainlyOutside(const ClosedPart& part, const Vec3Lanes& points, double error) {
  unsigned out = 0;
  for (int k = 0; k < 3; ++k) {
    out |= greater(points[k], Lanes(part.hi[k] + error)) | greater(Lanes(part.lo[k] - error), points[k]);
  }
  return out != 0;
}

/// Whether a link's part certainly reaches out of another link's part.
inline bool certainlyReachesOut(const ClosedPart& part, const PlacedLink& link, const ClosedPart& other_part,
                                const PlacedLink& other, double error) {
  const Vec3Lanes x = link.place(pointsAt(part.points[0], part.points[1], part.points[2]));
  return certainlyOutside(other_part, other.seenFromLink(x), error);
}

/// Proofs at the middle of a lane of the batch that SweptFrames has. If a contact is proven and counts, it is recorded,
/// and true is returned.
class BallProofs : PartOfSolver {
 public:
  explicit BallProofs(SearchState& state)
      : PartOfSolver(state.task), frames_(state.frames), contacts_(state.contacts) {}

  double ballReach(PairId pair) const;
  bool inLinks(PairId pair, int lane);
  bool inSolid(PairId pair, int lane);

 private:
  PlacedLink placedLink(int index, int lane);

  SweptFrames& frames_;
  ContactList& contacts_;
};

/// A mover's tree frame in the world at a lane's middle.
inline PlacedLink BallProofs::placedLink(int index, int lane) {
  const Body& mover = body(problem().movers[index]);
  if (mover.step < 0) return {mover.placement, mover.tree->extent};
  const FrameLanes& frame = frames_.of(0, mover.step);
  const StepBounds& b = frames_.bounds(0, mover.step);
  Placement step;
  laneOf(frame.R, lane).store(step.R);
  laneOf(frame.o, lane).store(step.t);
  step.ulps = b.ulps;
  step.length = b.length + b.D1 * frames_.batch().d;
  return seenFrom(step, {mover.placement, mover.tree->extent});
}

/// Balls inside two links may meet only if the segments of the links' line swept spheres are nearer than this; 0: no
/// balls can meet.
inline double BallProofs::ballReach(PairId pair) const {
  const PairParts bodies = problem().parts(pair);
  const InnerBalls *a = body(bodies.a).balls, *b = body(bodies.b).balls;
  return a && b ? a->reach + b->reach : 0;
}

/// Two links at a lane's middle: a ball inside the one and a ball inside the other meet, and both parts reach out of
/// each other.
inline bool BallProofs::inLinks(PairId pair, int lane) {
  const PairParts bodies = problem().parts(pair);
  const Body &A = body(bodies.a), &B = body(bodies.b);
  if (!A.balls || !B.balls) return false;
  const InnerBalls &balls_a = *A.balls, &balls_b = *B.balls;
  const PlacedLink a = placedLink(A.mover, lane), b = placedLink(B.mover, lane);
  const double error = 4 * differenceError(a, b);
  Vec3Lanes centers[InnerBalls::kMax / kLanes];
  for (int i = 0; i < balls_a.count; i += kLanes) {
    centers[i / kLanes] = a.place(pointsAt(balls_a.center[0] + i, balls_a.center[1] + i, balls_a.center[2] + i));
  }
  int nested_a = -1, nested_b = -1;  // parts of which the one may lie within the other
  for (int j = 0; j < balls_b.count; ++j) {
    const Vec3 center = b.place(Vec3(balls_b.center[0][j], balls_b.center[1][j], balls_b.center[2][j]));
    for (int first = 0; first < balls_a.count; first += kLanes) {
      const Vec3Lanes d = centers[first / kLanes] - spread(center);
      const Lanes radii = lanesAt(balls_a.radius + first) + Lanes(balls_b.radius[j] - error);
      for (unsigned meet = greater(radii, Lanes(0.0)) & greater(radii * radii, dot(d, d)); meet; meet &= meet - 1) {
        const int i = first + __builtin_ctz(meet);
        if (balls_a.part[i] == nested_a && balls_b.part[j] == nested_b) continue;
        const ClosedPart &part_a = balls_a.parts[balls_a.part[i]], &part_b = balls_b.parts[balls_b.part[j]];
        ++statistics().contact_proofs;
        if (!certainlyReachesOut(part_a, a, part_b, b, error) || !certainlyReachesOut(part_b, b, part_a, a, error)) {
          nested_a = balls_a.part[i];
          nested_b = balls_b.part[j];
          continue;
        }
        LeafContact* const recorded = contacts_.record(pair, -1, -1, frames_.batch().at[lane]);
        if (!recorded) return false;
        LeafContact& contact = *recorded;
        contact.feature = engine::kVolume;
        // From A's centre towards B's, in the middle of what both balls have in common.
        const Vec3 towards = transposedTimes(a.R, -laneOf(d, i - first)), normal = unitOrZ(towards);
        const double distance = norm(towards);
        const double along = 0.5 * (max(distance - balls_b.radius[j], 0.0) + min(balls_a.radius[i], distance));
        normal.store(contact.normal);
        (Vec3(balls_a.center[0][i], balls_a.center[1][i], balls_a.center[2][i]) + normal * along).store(contact.point);
        return true;
      }
    }
  }
  return false;
}

/// Points of a solid, farthest along eight directions, in its tree frame.
inline Vec3Lanes farPoints(const TreeView& solid) {
  static const Vec3 kDirections[8] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0},
                                      {0, 0, 1}, {0, 0, -1}, {1, 1, 1}, {-1, -1, -1}};
  Vec3Lanes points;
  for (int i = 0; i < 8; ++i) {
    const double radius = i < 6 ? solid.pieces[0].radius : 0;
    setLane(points, i, supportPoint(solid, solid.pieces[0], kDirections[i]) + kDirections[i] * radius);
  }
  return points;
}

/// A link and a solid, which is one convex piece, at a lane's middle. A ball inside the link's mesh meets the solid,
/// and the solid reaches out of the closed part that holds the ball.
inline bool BallProofs::inSolid(PairId pair, int lane) {
  const PairParts bodies = problem().parts(pair);
  const Body &solid = body(bodies.a), &link = body(bodies.b);
  if (!link.balls) return false;
  const InnerBalls& balls = *link.balls;
  PlacedLink place = seenFrom(solid.inverse, placedLink(link.mover, lane));
  place.sizes += solid.tree->extent;
  const double error = 4 * place.error();
  for (int first = 0; first < balls.count; first += kLanes) {
    const Vec3Lanes x =
        place.place(pointsAt(balls.center[0] + first, balls.center[1] + first, balls.center[2] + first));
    const Lanes depth = lanesAt(balls.radius + first) - (distanceFrom(solid.tree->pieces[0], x) + Lanes(error));
    const double deepest = maxLane(depth);
    if (!(deepest > 0)) continue;
    const int i = __builtin_ctz(kAllLanes & ~greater(Lanes(deepest), depth));
    ++statistics().contact_proofs;
    const Vec3Lanes far = place.seenFromLink(farPoints(*solid.tree));
    if (!certainlyOutside(balls.parts[balls.part[first + i]], far, error)) continue;
    LeafContact* const recorded = contacts_.record(pair, 0, -1, frames_.batch().at[lane]);
    if (!recorded) return false;
    LeafContact& contact = *recorded;
    contact.feature = engine::kVolume;
    // From the solid's point next to the ball's centre towards that; away from the solid's middle where it is within.
    const Vec3 center = laneOf(x, i), point = nearestPoint(solid.tree->pieces[0], center);
    const bool within = distanceFrom(solid.tree->pieces[0], x)[i] <= 0;
    point.store(contact.point);
    unitOrZ(center - (within ? middleOf(solid.tree->nodes[0]) : point)).store(contact.normal);
    return true;
  }
  return false;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
