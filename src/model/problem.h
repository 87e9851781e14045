// SPDX-License-Identifier: BSD-3-Clause
//
// All that stays the same from query to query: bodies and pairs. Plain data; its owner is Setup.
#pragma once

#include <cstdint>

#include "model/eight_boxes.h"
#include "model/pair_id.h"
#include "model/sweep.h"
#include "model/tree_view.h"

namespace fcl_artic {

class SolidSpace;
class SurfacePoints;

namespace engine {

/// A rigid body of the query.
struct Body {
  const TreeView* tree = nullptr;
  Placement placement;                    ///< tree frame in the frame of its step (or in the world when step < 0)
  Placement inverse;                      ///< of an obstacle: the world in its tree frame
  std::int32_t step = -1;                 ///< in the world's sweep; -1: stands still
  std::int32_t mover = -1;                ///< index among Problem::movers; -1: an obstacle
  double lss[7] = {};                     ///< line swept sphere p0, p1, r in the step's frame: holds the body
  const double* tree_lss = nullptr;       ///< of a link: the same in its tree's frame; null: not known
  const InnerBalls* balls = nullptr;      ///< of a link; null: none known
  const SolidSpace* space = nullptr;      ///< of a mesh that is a solid; null: any other body
  const SurfacePoints* points = nullptr;  ///< of any body, where a mesh is a solid
  /// m: each of its points may be this far from where the body's pose puts it.
  double stray = 0;
  /// From the time `since` on (Clock) each of its points may move away from there at this speed, m per unit of time.
  double speed = 0, since = 0;
  /// Times TubeAsked::times: how far an obstacle may be from where its motion has it, by being early or late, m.
  double lag = 0;
  /// Still bodies: axis-aligned box in the world.
  double lo[3] = {}, hi[3] = {};
};

/// How far the robot's base may be from where the world's sweep begins: turned by an angle about a point of the world,
/// then moved by a length.
struct BaseStray {
  double length = 0, angle = 0;  ///< m, rad
  double pivot[3] = {};
  bool any() const { return length > 0 || angle > 0; }
};

/// The numbers that stage 1 asks of an obstacle that stands still, in three cache lines. In a large scene most of its
/// time went into fetching these numbers one after the other. They lie in the order of the tree over obstacles.
struct alignas(64) StillBounds {
  Placement inverse;  ///< Body::inverse
  CoreBox box;
  const TreeView* tree;
  bool solid;                 ///< one bounded piece that is no triangle: a point within its surface is within it
  bool entered;               ///< it has upper nodes: stage 1 goes into it
  std::int32_t obstacle = 0;  ///< its place in Problem::obstacles
};

/// Two links to check. The motion is B's, seen from A. (A link and an obstacle need no such record: A is the obstacle,
/// sweep 0, and the placements are the bodies' own.)
struct LinkPair {
  std::int32_t a = -1, b = -1;
  std::int32_t sweep = 0;    ///< sweep whose base frame A's placement refers to
  std::int32_t step_b = -1;  ///< step of that sweep that carries B; -1: fixed to the base frame
  Placement inverse_a;       ///< base frame in A's tree frame
  Placement placement_b;     ///< B's tree frame in its step's frame
  double stray = 0;          ///< m: their strays bring them nearer by no more, whatever the motion; infinity: not known
};

/// Two movers.
struct MoverPair {
  std::int32_t a = -1, b = -1;
};

/// Pose of B's tree frame in A's at one time: a point p of B is at R p + c up to `error`, one of A seen from B
/// likewise.
struct PairPose {
  double R[9], c[3];
  double error;
};
/// Whether a part of one body's surface lies within the other body, a mesh that is a solid.
struct ContainmentVerdict {
  static constexpr std::int32_t kNone = 0, kPossible = 1, kCertain = 2;
  std::int32_t verdict;
  double point[3];   ///< of that part, in A's tree frame
  double normal[3];  ///< in A's tree frame, from A to B: the shortest way out, about
};

/// The meaning of a pair's number: bodies and placements. B is carried by a step of the sweep, A stands in its base
/// frame.
struct PairParts {
  std::int32_t a, b, sweep, step_b;
  const Placement *inverse_a, *placement_b;
};

/// No body's stray, speed or lag is larger, and none may move earlier (Body).
struct LargestStrays {
  double stray = 0, speed = 0, earliest_since = 0, lag = 0;
};

/// Everything that stays the same from query to query. (PairNumbering is for the pairs' numbers.)
struct Problem : PairNumbering {
  const Body* bodies = nullptr;
  std::int32_t num_bodies = 0;
  const std::int32_t* movers = nullptr;  ///< bodies bound to links, distal first, then moving obstacles
  std::int32_t num_movers = 0;
  std::int32_t num_scene_movers = 0;  ///< that many of them, from the first on, are checked against still obstacles
  const SweepView* sweeps = nullptr;  ///< sweep 0 starts at the world
  std::int32_t num_sweeps = 0;
  const LinkPair* link_pairs = nullptr;
  const MoverPair* link_movers = nullptr;  ///< of each link pair
  std::int32_t num_link_pairs = 0;
  const MoverRow* mover_rows = nullptr;  ///< all link pairs again, by movers: most are done with once these are seen
  std::int32_t num_mover_rows = 0;
  std::int32_t first_in_rows = 0;               ///< what rows call link pair 0
  const std::uint8_t* link_allowed = nullptr;   ///< per link pair: 1 = may touch; null: none may
  const std::uint8_t* scene_allowed = nullptr;  ///< per scene pair: 1 = may touch; null: none may
  std::int32_t num_scene_allowed = 0;           ///< scene pairs that may touch
  const std::int32_t* obstacles = nullptr;      ///< body of obstacle o
  const StillBounds* still_bounds = nullptr;    ///< of each obstacle, in the order of obstacle_tree
  const WideNode* obstacle_tree = nullptr;  ///< boxes in the world; leaf ~i has still_bounds[i]; null if there is none
  bool strays = false;                      ///< a step, a body or the base strays
  BaseStray base;                           ///< against all that is no link
  LargestStrays largest;                    ///< of bodies
  /// Where a mesh is a solid: asked of each pair with one, at a pose. Null: all meshes are surfaces.
  void (*contained)(const Body& a, const Body& b, const PairPose& pose, ContainmentVerdict& found) = nullptr;

  [[gnu::always_inline]] std::int32_t numPairs() const { return num_scene_pairs + num_link_pairs; }
  /// All of them, in their order.
  [[gnu::always_inline]] PairRange pairs() const { return {numPairs()}; }
  /// The pair may touch: nobody asks for it.
  [[gnu::always_inline]] bool isAllowed(PairId pair) const {
    const std::uint8_t* allowed = in(scene_allowed, link_allowed, pair);
    return allowed && *allowed;
  }
  [[gnu::always_inline]] PairParts parts(PairId pair) const {
    if (!isScenePair(pair)) {
      const LinkPair& links = link_pairs[linkPairOf(pair)];
      return {links.a, links.b, links.sweep, links.step_b, &links.inverse_a, &links.placement_b};
    }
    const std::int32_t a = obstacles[obstacleOf(pair)], b = movers[moverOf(pair)];
    return {a, b, 0, bodies[b].step, &bodies[a].inverse, &bodies[b].placement};
  }
};

}  // namespace engine
}  // namespace fcl_artic
