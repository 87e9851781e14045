// SPDX-License-Identifier: BSD-3-Clause
//
// What the engine is given and what it answers: plain data, no FCL, no containers, so that it can be compiled once per
// instruction set. The owners are ShapeTree, FrameSweep and the manager.
#pragma once

#include <cstdint>

namespace fcl_artic {

class SolidSpace;
class SurfacePoints;

namespace engine {

/// Kinds of convex piece. Every piece is a core, given by its support function, grown by a ball of radius `radius`
///.
/// `vertices` and `hull` are both hulls of points; a hull's coordinates lie x, then y, then z, each a multiple of eight
/// (lanes go over them), in TreeView::hulls.
/// `halfspace` {n.x <= offset} and `plane` {n.x = offset} are unbounded: a direction each, no search along any other.
enum class PieceKind : std::int32_t {
  vertices, hull, point, segment, box, cylinder, cone, ellipsoid, halfspace, plane
};
/// Half size of an unbounded piece's box, far beyond all coordinates allowed (1e9 m).
constexpr float kUnbounded = 1e30f;

/// One convex leaf, in its tree's frame; its axes are the frame's.
struct Piece {
  PieceKind kind = PieceKind::vertices;
  std::int32_t first_vertex = 0, num_vertices = 0;  ///< `vertices`; `hull`: index of its first x, multiple of eight
  std::int32_t primitive = -1;                      ///< FCL's id: triangle index, -1 for a shape
  /// box, ellipsoid: half sizes; cylinder, cone: radius, -, half length; segment: -, -, half length.
  /// Triangle: its unit normal (0 when degenerate), a direction worth trying. halfspace, plane: the unit normal n.
  double size[3] = {0, 0, 0};
  double center[3] = {0, 0, 0};  ///< added to the core; 0 for `vertices`; halfspace, plane: offset, 0, 0
  double radius = 0;             ///< rounding radius
  double reach = 0;  ///< upper bound of |p| over the core, from the frame's origin; halfspace, plane: of |offset|
};

/// Bounding volume: an axis-aligned box in the tree's frame that holds the pieces below it, radii included. Single
/// precision, rounded outward: eight lanes then compare in one instruction, and what it loses the leaves win back.
/// Half a cache line, and siblings lie side by side: a traversal that descends reads one line.
struct alignas(32) Node {
  float lo[3], hi[3];
  float radius;        ///< half the box's diagonal, a size only
  std::int32_t child;  ///< left child, the right one follows it; a leaf has ~piece, which is < 0
  bool isLeaf() const { return child < 0; }
  int left() const { return child; }
  int right() const { return child + 1; }
  int piece() const { return ~child; }
};

/// A body's geometry: constant, shared by threads. Node 0 is the root, node 1 is not used.
struct TreeView {
  const Node* nodes = nullptr;
  const Piece* pieces = nullptr;
  const double* vertices = nullptr;  ///< xyz, packed
  const double* hulls = nullptr;     ///< see PieceKind; 64-byte aligned
  const Piece* outer = nullptr;      ///< one convex piece that holds the whole body; null: none worth having
  const Piece* parts = nullptr;      ///< convex pieces that hold what is below a node each
  const std::int16_t* part_of_node = nullptr;  ///< index into `parts`, -1: none; null: no node has one
  std::int32_t num_nodes = 0, num_pieces = 0;
  double extent = 0;  ///< largest |p|, radii included: the size that pads scale with
};

/// A box in a body's tree frame, grown by a ball, that holds the body: exact for boxes, balls and capsules.
struct CoreBox {
  double lo[3], hi[3], radius;
};

/// A closed part of a mesh's surface: its box, and points of it that lie far out, one per lane.
struct ClosedPart {
  double lo[3], hi[3];
  alignas(64) double points[3][8];
};
/// Balls inside closed parts of a mesh (doc/NUMERICS.md, "Inner balls"), in its tree's frame. Lanes go over balls; those
/// that fill the last eight up have a radius far below 0.
struct InnerBalls {
  static constexpr std::int32_t kMost = 16;
  alignas(64) double center[3][kMost];
  alignas(64) double radius[kMost];
  std::int32_t part[kMost];  ///< that the ball lies in
  std::int32_t count = 0;    ///< without what fills up
  double reach = 0;          ///< they lie within this of the segment of the mesh's line swept sphere, about
  const ClosedPart* parts = nullptr;
};

/// A rigid transform that stands still.
struct Placement {
  double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
  double t[3] = {0, 0, 0};
  double length = 0;      ///< upper bound of |t| and of the sum of the translations it was multiplied from
  double ulps = 0;        ///< R is this many 2^-52 from the model's rotation, t this many 2^-52 of `length`
  bool identity = true;
};

/// What moves between a step's frame and the one before it.
enum class StepKind : std::int32_t {
  revolute,   ///< a turn about z by q
  prismatic,  ///< a slide along z by q
  slide,      ///< a translation by the vector q
  turn,       ///< exp([q]) R0, q a rotation vector, R0 a rotation that the query gives (none: 1)
  bounded,    ///< BoundedSource, or its inverse
};

/// A motion that only its author knows: plain functions, so that the engine can ask.
struct BoundedSource {
  const void* self = nullptr;
  /// Rotation (row-major), origin, its velocity and acceleration, angular velocity and acceleration: 9 + 5 * 3 numbers.
  void (*state)(const void* self, double t, double* out) = nullptr;
  /// Upper bounds over [begin, end]: origin's first to third derivative, angular velocity and its two derivatives.
  void (*bounds)(const void* self, double begin, double end, double* out) = nullptr;
  bool derivatives = true;  ///< false: only pose, speed and angular speed are meaningful
};

/// Highest power of t in a variable.
constexpr std::int32_t kMaxDegree = 5;

/// One moving factor on the way from a base frame: X = X_parent * C * J(t).
struct SweepStep {
  std::int32_t parent = -1;  ///< step before this one, -1: the base frame
  StepKind kind = StepKind::revolute;
  double C[9], p[3];         ///< constant transform from the parent step's frame
  double perp = 0, axial = 0;  ///< |p| across and along the axis of a revolute parent (axial 0, perp |p| behind others)
  double length = 0, ulps = 0;  ///< of C and p, as in Placement
  std::int32_t variable = -1;   ///< revolute, prismatic: the variable; slide, turn: the first of three
  double multiplier = 1, offset = 0;  ///< q = multiplier * q_variable + offset; slide, turn: offset 0
  std::int32_t orientation = -1;  ///< turn: number of its R0 among Query::orientations; -1: none
  const BoundedSource* source = nullptr;  ///< bounded
  bool inverse = false;  ///< bounded: J is the inverse of the source's pose; turn: of exp([-q]) R0, that is R0^T exp([q])
};

/// Steps from one base frame, parents first.
struct SweepView {
  const SweepStep* steps = nullptr;
  std::int32_t num_steps = 0;
  /// Bounds hold for one batch of intervals only (a bounded motion), not for all of [0, 1].
  bool local_bounds = false;
  bool first_order = false;  ///< a bounded motion without derivatives is among the steps
};

/// A rigid body of the query.
struct Body {
  const TreeView* tree = nullptr;
  Placement placement;     ///< tree frame in the frame of its step (or in the world when step < 0)
  Placement inverse;       ///< of an obstacle: the world in its tree frame
  std::int32_t step = -1;  ///< in the world's sweep; -1: stands still
  std::int32_t mover = -1;  ///< index among Problem::movers; -1: an obstacle
  double lss[7] = {};      ///< line swept sphere p0, p1, r in the step's frame: holds the body
  const InnerBalls* balls = nullptr;  ///< of a link; null: none known
  const SolidSpace* space = nullptr;      ///< of a mesh that is a solid; null: any other body
  const SurfacePoints* points = nullptr;  ///< of any body, where a mesh is a solid
  /// Still bodies: axis-aligned box in the world.
  double lo[3] = {}, hi[3] = {};
};

/// What stage 1 asks of an obstacle that stands still, in three cache lines: in a large scene most of its time went into
/// fetching these numbers one behind the other.
struct alignas(64) StillBounds {
  Placement inverse;  ///< Body::inverse
  CoreBox box;
  const TreeView* tree;
  bool solid;  ///< one bounded piece that is no triangle: a point within its surface is within it
};

/// Two links to check. The motion is B's, seen from A. (A link and an obstacle need no such record: A is the obstacle,
/// sweep 0, and the placements are the bodies' own.)
struct LinkPair {
  std::int32_t a = -1, b = -1;
  std::int32_t sweep = 0;   ///< sweep whose base frame A's placement refers to
  std::int32_t step_b = -1;  ///< step of that sweep that carries B; -1: fixed to the base frame
  Placement inverse_a;      ///< base frame in A's tree frame
  Placement placement_b;    ///< B's tree frame in its step's frame
};

/// Pose of B's tree frame in A's at one time: a point p of B is at R p + c up to `error`, one of A seen from B likewise.
struct PairPose {
  double R[9], c[3];
  double error;
};
/// Whether a part of one body's surface lies within the other body, a mesh that is a solid.
struct Containment {
  static constexpr std::int32_t kNone = 0, kPossible = 1, kCertain = 2;
  std::int32_t verdict;
  double point[3];   ///< of that part, in A's tree frame
  double normal[3];  ///< in A's tree frame, from A to B: the shortest way out, about
};

/// Everything that stays the same from query to query.
struct Problem {
  const Body* bodies = nullptr;
  std::int32_t num_bodies = 0;
  const std::int32_t* movers = nullptr;  ///< bodies bound to links, distal first, then moving obstacles
  std::int32_t num_movers = 0;
  std::int32_t num_scene_movers = 0;  ///< the first so many are checked against the obstacles that stand still
  const SweepView* sweeps = nullptr;  ///< sweep 0 starts at the world
  std::int32_t num_sweeps = 0;
  /// Pair m * num_obstacles + o is mover m and obstacle o; pair num_scene_pairs + i is link pair i.
  const LinkPair* link_pairs = nullptr;
  std::int32_t num_link_pairs = 0;
  const std::uint8_t* link_allowed = nullptr;  ///< per link pair: 1 = may touch; null: none may
  std::int32_t num_scene_pairs = 0;
  const std::uint8_t* scene_allowed = nullptr;  ///< per scene pair: 1 = may touch; null: none may
  const std::int32_t* obstacles = nullptr;  ///< body of obstacle o
  const StillBounds* still_bounds = nullptr;  ///< of obstacle o
  std::int32_t num_obstacles = 0;
  const Node* obstacle_tree = nullptr;  ///< boxes in the world; leaf piece = obstacle index; null when there is none
  /// Where a mesh is a solid: asked of each pair with one, at a pose. Null: all meshes are surfaces.
  void (*contained)(const Body& a, const Body& b, const PairPose& pose, Containment& found) = nullptr;
};

/// The margins of a query's pairs, m, and all that any part of the library knows of them. A pair's margin is its own,
/// else the one requested, and to either is added what the query adds. These parts can't be had one by one, so that
/// nobody can leave one out. (Sums are as rounded. Inlined always: each instruction set has the code for itself.)
class Margins {
 public:
  /// All pairs have the margin requested.
  [[gnu::always_inline]] explicit Margins(double requested = 0, double added = 0)
      : requested_(requested + added), added_(added), largest_(requested_) {}

  /// Margins of the pairs' own: per scene pair and per link pair, below 0: none; null: no pair of that kind has one.
  /// @param largest  of all of them.
  [[gnu::always_inline]] void setOwn(const double* scene, std::int32_t num_scene_pairs, const double* link,
                                     double largest) {
    scene_ = scene;
    link_ = link;
    num_scene_pairs_ = num_scene_pairs;
    largest_ = largest + added_ > requested_ ? largest + added_ : requested_;
  }
  /// For a problem whose link pairs begin so many later.
  [[gnu::always_inline]] void skipLinkPairs(std::int32_t n) {
    if (link_) link_ += n;
  }

  /// Of a pair by its number in the problem.
  [[gnu::always_inline]] double of(std::int32_t pair) const {
    const std::int32_t link_pair = pair - num_scene_pairs_;
    const double* own = link_pair < 0 ? scene_ : link_;
    const double margin = own ? own[link_pair < 0 ? pair : link_pair] : -1;
    return margin >= 0 ? margin + added_ : requested_;
  }
  /// No pair has a larger one.
  [[gnu::always_inline]] double largest() const { return largest_; }

 private:
  const double *scene_ = nullptr, *link_ = nullptr;
  std::int32_t num_scene_pairs_ = 0;
  double requested_, added_, largest_;  ///< the first and the last with what is added
};

/// A link's line swept sphere over one of the eight parts [k/8, (k+1)/8] of the motion: within the hull of these points, in
/// the world, grown by a ball.
struct SweptLink {
  double points[6][3];
  double radius;
};
/// A pair of a link and a still obstacle that stage 1 left.
struct CullCandidate {
  std::int32_t pair, mover, obstacle;  ///< mover: among Problem::movers; obstacle: a body
  std::uint32_t lanes;                 ///< parts of the motion in which their bounds meet
  double margin;                       ///< of the pair
  /// Nodes of the obstacle's tree, a bit each, that are proven free of the mover over the whole motion; null: none. There
  /// until the solver returns.
  const std::uint64_t* free_nodes = nullptr;
};

/// A pair that is worth a look in the middle of the part [k/8, (k+1)/8] of a motion.
struct LikelyContact {
  std::int32_t link_pair, part;
};

struct Query {
  /// Variable v at time t: sum over k of coefficients[k * num_variables + v] t^k, for k = 0..degree (at least 1).
  const double* coefficients = nullptr;
  std::int32_t num_variables = 0, degree = 1;
  const double* orientations = nullptr;  ///< rotations R0 of turns, row-major, nine numbers each
  double tolerance_time = 1e-6, tolerance_distance = 1e-6;
  Margins margins;
  bool check_scene = true, check_self = true, every_pair = false, ignore_initial = false, measure_times = false;
  bool any = false;  ///< stop at the first contact that is proven, wherever on the way it is
  std::int32_t max_contacts = 1;  ///< with every_pair: of each pair
  const std::int32_t* may_ignore = nullptr;  ///< with ignore_initial: the only pairs whose initial contact may be ignored
  std::int32_t num_may_ignore = -1;          ///< -1: that of all pairs may
  std::uint64_t work_budget = 0;
  void (*progress)(void* context, double t_lower) = nullptr;
  void* progress_context = nullptr;
  /// Per link pair, bit k: it is proven free over the part [k/8, (k+1)/8] of this motion. Asked for when the pairs are
  /// come to, which contact with an obstacle may spare. Null: nothing is known.
  const std::uint8_t* (*link_free)(const void* context) = nullptr;
  const void* link_free_context = nullptr;
  /// With `any`: where balls inside links are likely to meet.
  const LikelyContact* likely = nullptr;
  std::int32_t num_likely = 0;
  /// A stage between stage 1 and the first batch: may clear lanes in which a pair is proven free and set free_nodes,
  /// nothing else. The pairs of a mover lie together; links[8 * mover + k] is set for movers that have pairs.
  void (*refine)(void* context, const Problem& problem, const SweptLink* links, CullCandidate* pairs,
                 std::int32_t num_pairs) = nullptr;
  void* refine_context = nullptr;
};

struct Statistics {
  std::uint64_t pairs = 0, pairs_after_culling = 0, batches = 0, motion_evaluations = 0, node_tests = 0, leaf_tests = 0,
                certificates = 0, gjk = 0, contact_proofs = 0;
  double culling_us = 0, narrowphase_us = 0;
};

/// Values of FeatureKind for the engine's code, which is compiled for several instruction sets and includes no Eigen.
constexpr std::int32_t kEdgeFace = 6, kFaceEdge = 7, kVolume = 9;

/// Two leaves that meet, or come too near to be told apart.
struct LeafContact {
  std::int32_t pair, body_a, body_b;
  std::int32_t piece_a, piece_b;  ///< -1: proven of what a mesh encloses, of no triangle
  bool certain;
  double t_lower, t_upper;  ///< this leaf pair's own bracket
  double normal[3];         ///< in A's tree frame, from A to B
  double point[3];          ///< in A's tree frame at time `t`
  double t;                 ///< t_upper when certain, else t_lower
  std::int32_t feature = -1;  ///< FeatureKind, where the solver knows it: then the contact is reported as it is
};

/// A pair in contact at t = 0 and the time from which it is watched again; 2: never.
struct Ignored {
  std::int32_t pair, body_a, body_b;
  double watch_from;
};

enum class Verdict : std::int32_t { free, contact, undecided };
struct Answer {
  Verdict verdict = Verdict::undecided;
  bool certain = false;
  double t_lower = 0, t_upper = 1;
  const LeafContact* contacts = nullptr;  ///< owned by the workspace, valid until its next query
  std::int32_t num_contacts = 0;
  const Ignored* ignored = nullptr;  ///< the same
  std::int32_t num_ignored = 0;
  Statistics statistics;
};

/// Motion of B's tree frame in A's over [tm - d, tm + d]: X(t) = X[0] + tau X[1] + tau^2 X[2] + e, tau = (t - tm) / d, for
/// the rotation R (row-major) and the position c; a point p of B is at R p + c, up to |e| <= rem_c + rem_R |p| + pad.
struct PairMotion {
  double R[3][9], c[3][3];
  double rem_c, rem_R;  ///< what the quadratic leaves out: shrinks like d^3
  double pad;           ///< rounding: does not shrink
};

/// The engine as compiled for one instruction set.
struct Engine {
  const char* name;
  void* (*createWorkspace)();
  void (*destroyWorkspace)(void* workspace);
  /// One workspace serves one thread at a time; nothing in it reaches the next answer.
  void (*solve)(void* workspace, const Problem& problem, const Query& query, Answer& answer);
  /// Motion of a pair of the problem that this workspace solved last.
  void (*pairMotion)(void* workspace, int pair, double tm, double d, PairMotion& motion);
};

/// The widest engine that this processor runs; FCL_ARTIC_ISA=sse2|avx2|avx512 in the environment asks for less.
const Engine& engine();
/// The engine named "sse2", "avx2" or "avx512"; null where the processor lacks it.
const Engine* engineNamed(const char* name);

extern const Engine kEngineSse2, kEngineAvx2, kEngineAvx512;

}  // namespace engine
}  // namespace fcl_artic
