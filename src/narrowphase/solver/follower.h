// SPDX-License-Identifier: BSD-3-Clause
//
// Follows a leaf pair, or the hulls around two bodies, by itself. Certificates move t_lower up to the first root of the
// gap's bound; where the pair was never seen apart, t_lower stays. Proofs of contact give t_upper.
#pragma once

#include "narrowphase/solver/entry.h"
#include "narrowphase/solver/node_shape.h"
#include "narrowphase/solver/search_state.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// GJK's accuracy where two directions are to show how the direction turns. Measured: 0.1 takes 20 % more rounds, 0.001
/// a few per cent fewer at more expense.
constexpr double kFollowingAccuracy = 0.02;

/// The upper bound of a gap of which nothing is known; with a minus, the lower bound. (A negative gap is a depth.)
constexpr double kUnknownGap = 1e300;

/// The rest of one pair that is not decided yet: one leaf pair, or the hulls around both bodies, or parts of both
/// trees. The first two are followed; parts of trees are traversed.
struct Candidate {
  enum class Target { leafPair, hulls, subtrees };

  Entry entry;
  Target target;
  Piece hull_a;                   ///< of hulls: body A's, or a patch's (NodeHull)
  std::int32_t piece_a, piece_b;  ///< of a leaf pair
  std::int32_t first, count;      ///< of a lane of the first batch: its entries on PairSearch's stack
  double t_lower;                 ///< before it the pair is proven free, or is not watched
  Vec3 normal;                    ///< GJK's witness at t_lower
  double gap_lower;               ///< lower bound of the gap, along `normal`; far below the gap where GJK ends early
  double gap_upper;               ///< upper bound of the gap, from points of both
  double pad;                     ///< bound on rounding, of the batch looked at last
  double speed;                   ///< about that of the one body as seen from the other
  bool have_normal;
  Simplex simplex;  ///< GJK's last
  bool gap_closed;  ///< not followed beyond t_lower: the gap seems closed there, or contact is proven
  bool certain;
  double t_upper;  ///< of a proven contact
  Vec3 point;      ///< likewise

  bool isHulls() const { return target == Target::hulls; }
  bool isLeafPair() const { return target == Target::leafPair; }
};

/// Returns the piece of a body at GJK's witness. The witness is a weighted mean of vertices of the hull. The piece is
/// the one whose vertices among these have the largest sum of weights; its box holds the heaviest of them. None: -1,
/// for instance if the hull's vertices are not the body's own.
/// @param below  the node to begin at.
inline int pieceAtWitness(const TreeView& tree, const Simplex& simplex, bool in_a, int below = 0) {
  if (const int piece = leafPieceOf(tree, below); piece >= 0) return piece;
  if (tree.pieces[0].kind != PieceKind::vertices || simplex.n == 0) return -1;
  const auto point = [&](int k) { return in_a ? simplex.v[k].a : simplex.v[k].b; };
  int heaviest = 0;
  for (int k = 1; k < simplex.n; ++k) {
    if (simplex.weight[k] > simplex.weight[heaviest]) heaviest = k;
  }
  const Vec3 x = point(heaviest);
  int best = -1, count = 1;
  double most = 0;
  constexpr int kDeepest = 64;
  std::int32_t waiting[kDeepest] = {below};
  while (count) {
    const Node& node = tree.nodes[waiting[--count]];
    bool holds = true;
    for (int k = 0; k < 3; ++k) holds &= x[k] >= node.lo[k] && x[k] <= node.hi[k];
    if (!holds) continue;
    if (!node.isLeaf()) {
      if (count + 2 > kDeepest) return best;
      waiting[count++] = node.right();
      waiting[count++] = node.left();
      continue;
    }
    const Piece& piece = tree.pieces[node.piece()];
    const double* v = tree.vertices + 3 * static_cast<std::ptrdiff_t>(piece.first_vertex);
    double weight = 0;
    for (int j = 0; j < piece.num_vertices; ++j, v += 3) {
      for (int k = 0; k < simplex.n; ++k) {
        const Vec3 y = point(k);
        if (y[0] == v[0] && y[1] == v[1] && y[2] == v[2]) weight += simplex.weight[k];
      }
    }
    if (weight <= most) continue;
    most = weight;
    best = node.piece();
  }
  return best;
}

/// How far the hull around what is below a node reaches beyond the body: not at all for a leaf's own piece.
inline double loosenessOf(const TreeView& tree, int node, const Piece& hull) {
  return leafPieceOf(tree, node) >= 0 ? 0 : hull.radius;
}

/// The pieces of a candidate.
inline PiecePair piecesOf(const Candidate& f, Seen seen) {
  if (f.isHulls()) return {f.hull_a, *seen->b().outer};
  return {seen->a(), f.piece_a, seen->b(), f.piece_b};
}

/// Lower bounds of the gap of two pieces over eight lanes: one along a direction that turns, or two along one that does
/// not, in either frame.
struct GapBounds {
  Lanes G[2][3];  ///< Bernstein coefficients
  int count;

  /// Lanes in which one of them is positive.
  unsigned positive() const {
    unsigned lanes = 0;
    for (int i = 0; i < count; ++i) lanes |= greater(min(min(G[i][0], G[i][1]), G[i][2]), Lanes(0.0));
    return lanes;
  }
  /// The part of a lane, from its begin on, on which one of them is certainly positive.
  double positivePartOf(int lane) const {
    double x = 0;
    for (int i = 0; i < count; ++i) {
      const double coefficients[3] = {G[i][0][lane], G[i][1][lane], G[i][2][lane]};
      x = max(x, positivePrefix(coefficients));
    }
    return x;
  }
};

class Follower : PartOfSolver {
 public:
  explicit Follower(SearchState& state)
      : PartOfSolver(state.task), motions_(state.motions), horizon_(state.horizon), contacts_(state.contacts) {}

  bool followToRoot(Candidate& f, double stop, bool patient, unsigned first_lanes = 0);
  bool decide(Candidate& f, double stop);
  void proveBelowHulls(Candidate& f);

 private:
  /// How Candidate::normal turns.
  struct Turning {
    double at;  ///< when it was found
    Vec3 rate = Vec3(0, 0, 0);
    bool turns = false;
  };
  bool findGap(Candidate& f, Seen seen, int lane, double tau, double accuracy);
  GapBounds boundGap(const Candidate& f, Seen seen, const Turning& turning);
  bool proveAhead(Candidate& f, Seen seen, int lane);
  bool prove(Candidate& f);

  RelativeMotions& motions_;
  Horizon& horizon_;
  ContactList& contacts_;
};

/// Stores GJK's witness, and bounds of the gap, in f.
/// @param tau  the time, from -1 to 1 across the lane.
/// @return false if GJK claims overlap: then only the simplex and `gap_upper` are set.
inline bool Follower::findGap(Candidate& f, Seen seen, int lane, double tau, double accuracy) {
  const PiecePair pieces = piecesOf(f, seen);
  const double radii = pieces.a.radius + pieces.b.radius + seen->margin();
  const DifferenceBody body = seen->differenceAt(pieces.a, pieces.b, lane, tau);
  GjkResult g;
  gjk(body, f.have_normal ? f.normal : body.pose.c, {accuracy, radii, 64}, g, &f.simplex);
  ++statistics().gjk;
  f.simplex = g.simplex;
  if (g.overlap) {
    Simplex nearest = g.simplex;
    if (!pieces.areBounded()) {
      f.gap_upper = g.lower - radii;  // there is one direction
    } else {
      f.gap_upper = originWeights(nearest) ? norm(combined(nearest)) - radii : kUnknownGap;
    }
    return false;
  }
  f.normal = g.n;
  seen->setWitness(g.n);
  const double reached = pieces.a.radius + pieces.b.radius + seen->touchMargin(pieces.a, pieces.b, g.n, lane);
  f.gap_lower = g.lower - reached;
  f.gap_upper = g.distance - reached;
  return f.have_normal = true;
}

/// Lower bounds of the gap along f.normal, which may turn, over the lanes of `seen`.
inline GapBounds Follower::boundGap(const Candidate& f, Seen seen, const Turning& turning) {
  const PiecePair pieces = piecesOf(f, seen);
  GapBounds bounds;
  bounds.count = turning.turns ? 1 : 2;
  if (turning.turns) {
    const TimeBatch& batch = seen->batch();
    TurningDirection n;
    n.begin = mulAdd(spread(turning.rate), batch.tm - Lanes(turning.at + batch.d), spread(f.normal));
    n.end = n.begin + spread(turning.rate * (2 * batch.d));
    gapBound(seen->side(0), pieces.a, pieces.b, n, bounds.G[0]);
  } else {
    const Vec3 n = seen->differenceAt(pieces.a, pieces.b, 0).opposite(f.normal);
    gapBound(seen->side(0), pieces.a, pieces.b, f.normal, bounds.G[0]);
    gapBound(seen->side(1), pieces.b, pieces.a, n, bounds.G[1]);
  }
  statistics().certificates += static_cast<std::uint64_t>(bounds.count);
  return bounds;
}

/// Follows a leaf pair or two hulls from f.t_lower towards `stop`. A certificate with one direction holds over eight
/// lanes, up to the first root of the gap's bound. There GJK finds a new direction, and the next lanes go about as far
/// as the gap will last at the speed seen so far. Two directions show how the direction turns. From then on the
/// certificate's direction turns likewise, and the steps are those of a secant method.
/// @param patient  true: goes on until no step gets farther, for 48 rounds at most. false: ends after 24 rounds at
/// most, and where contact is expected within a sixteenth of the time tolerance.
/// @param first_lanes  not 0: begins with the first batch, of which all lanes but these are free.
/// @return true: free until `stop`, or until Horizon::end() if that is earlier. false: it ended before these
/// (f.gap_closed); if any contact will do, it may have proven one (f.certain).
inline bool Follower::followToRoot(Candidate& f, double stop, bool patient, unsigned first_lanes) {
  const double expected = query().tolerance_time / 16;
  double span = stop - f.t_lower, accuracy = patient ? 1e-7 : kFollowingAccuracy;
  Turning turning = {f.t_lower};
  f.gap_closed = false;
  for (int round = 0; round < (patient ? 48 : 24); ++round) {
    const double t = f.t_lower;
    stop = min(stop, horizon_.end());
    if (t >= stop) return true;
    const bool first = round == 0 && first_lanes;
    const double from = first ? 0 : t;
    span = first ? 1 : min(span, stop - t);
    const TimeBatch batch = TimeBatch::partsOf(from, span);
    const double w = span / kLanes, d = batch.d;
    const double* tm = batch.at;
    const Seen seen = motions_.of(f.entry.pair, batch);
    f.speed = seen->amplitude() / d;
    f.pad = seen->pad();
    ++statistics().leaf_tests;
    if (!f.have_normal && !findGap(f, seen, first ? __builtin_ctz(first_lanes) : 0, -1, accuracy)) break;

    const GapBounds bounds = boundGap(f, seen, turning);
    const unsigned separated = (first ? kAllLanes & ~first_lanes : 0) | bounds.positive();
    if (separated == kAllLanes) {
      f.t_lower = min(stop, from + span);
      span *= 4;
      continue;
    }
    if (query().any && round > 0 && proveAhead(f, seen, kLanes - 1)) return false;
    const int lane = __builtin_ctz(~separated);
    const double x = bounds.positivePartOf(lane);
    // Lanes before it are free, and it is [tm - d, tm + d].
    const double root = (x >= 1 ? tm[lane] + d : (tm[lane] - d) + 2 * d * x) - 4 * kUlp;
    f.t_lower = max(t, min(stop, max(root, lane ? tm[lane] - 0.5 * w : t)));
    const double progress = f.t_lower - turning.at, gap_before = f.gap_lower;
    const Vec3 before = f.normal;
    if (!findGap(f, seen, lane, (f.t_lower - tm[lane]) / d, accuracy)) break;
    turning.turns = progress > 0 && dot(before, f.normal) > 0.5 && piecesOf(f, seen).areBounded();
    turning.rate = turning.turns ? (f.normal - before) / progress : Vec3(0, 0, 0);
    turning.at = f.t_lower;
    if (turning.at > t && gap_before > 0) {
      const double left =
          max(0.0, f.gap_lower) * (progress / gap_before);  // time until the gap is closed, at the speed seen
      if (!patient && left < expected) break;
      span = min(4 * span, max(2 * left, kNarrowestLane));
    } else {
      // Not even a beginning: a better witness, narrower lanes.
      if (w < 64 * kUlp) break;
      accuracy = 1e-7;
      span *= 0.125;
    }
  }
  f.gap_closed = f.t_lower < min(stop, horizon_.end());
  return !f.gap_closed;
}

/// For queries that any contact answers: the lanes of a followed pair reach beyond the contact that is expected. The
/// pieces that hold the last witness are tried there. If they certainly touch, f becomes the candidate of these pieces,
/// with the proof.
/// @return whether contact is proven.
inline bool Follower::proveAhead(Candidate& f, Seen seen, int lane) {
  const TreeView &A = seen->a(), &B = seen->b();
  const int piece_a = f.isHulls() ? pieceAtWitness(A, f.simplex, true, f.entry.a) : f.piece_a;
  const int piece_b = f.isHulls() ? pieceAtWitness(B, f.simplex, false, f.entry.b) : f.piece_b;
  if (piece_a < 0 || piece_b < 0) return false;
  ++statistics().contact_proofs;
  const PiecePair pieces(A, piece_a, B, piece_b);
  const DifferenceBody body = seen->differenceAt(pieces.a, pieces.b, lane);
  const double within = seen->touchMargin(*body.a, *body.b, f.normal, lane);
  if (!certainlyTouching(body, within, seen->poseError(), f.normal, f.point)) return false;
  const double t = seen->batch().at[lane];
  if (!contacts_.takeProof(f.entry.pair, t)) return false;
  f.target = Candidate::Target::leafPair;
  f.piece_a = piece_a;
  f.piece_b = piece_b;
  f.certain = f.gap_closed = true;
  f.t_upper = t;
  return true;
}

/// Decides a leaf pair whose gap is closed, if a proof is found.
/// @return true: it is free until `stop` after all. false: f.certain says whether contact is proven.
inline bool Follower::decide(Candidate& f, double stop) {
  if (prove(f)) return false;
  const double before = f.t_lower;
  const bool had_normal = f.have_normal;
  if (followToRoot(f, stop, true)) return true;
  const bool news = f.t_lower > before || f.have_normal != had_normal;  // without, the same poses would fail again
  if (news && !f.certain) prove(f);
  return false;
}

/// Tries to prove contact within the tolerance after t_lower.
/// @return whether it is proven.
inline bool Follower::prove(Candidate& f) {
  // Not quite 1: the sum rounds, and the bracket is to be no wider than the tolerance.
  static const double kOffsets[kLanes] = {0.25, 0.5, 0.999, 0x1p-4, 0x1p-6, 0x1p-9, 0x1p-14, 0};
  TimeBatch poses = {};
  for (int k = 0; k < kLanes; ++k) poses.setPose(k, min(1.0, f.t_lower + kOffsets[k] * query().tolerance_time));
  const Seen seen = motions_.of(f.entry.pair, poses);
  f.pad = seen->pad();
  const PiecePair pieces(seen->a(), f.piece_a, seen->b(), f.piece_b);
  const Piece &a = pieces.a, &b = pieces.b;
  const int head = f.have_normal ? 0 : kLanes - 1;  // never seen apart: in contact at t_lower itself
  for (int i = 0; i < kLanes; ++i) {
    const int k = (head + i) % kLanes;
    const DifferenceBody body = seen->differenceAt(a, b, k);
    ++statistics().contact_proofs;
    const double within = f.have_normal ? seen->touchMargin(a, b, f.normal, k) : seen->margin();
    if (certainlyTouching(body, within, seen->poseError(), f.have_normal ? f.normal : body.pose.c, f.point,
                          &f.simplex) &&
        contacts_.takeProof(f.entry.pair, poses.at[k])) {
      f.certain = true;
      f.t_upper = poses.at[k];
      return true;
    }
  }
  return false;
}

/// For hulls that meet, and whose vertices are their bodies' own. If the bodies are convex, their pieces there meet at
/// the same time. If contact of the two pieces is proven, f is re-targeted to them.
inline void Follower::proveBelowHulls(Candidate& f) {
  if (!f.have_normal) return;
  const TreeView &A = *body(problem().parts(f.entry.pair).a).tree, &B = *body(problem().parts(f.entry.pair).b).tree;
  const double loose = loosenessOf(A, f.entry.a, f.hull_a) + loosenessOf(B, f.entry.b, *B.outer);
  if (loose > f.speed * query().tolerance_time) return;
  Candidate below = f;
  below.target = Candidate::Target::leafPair;
  below.piece_a = pieceAtWitness(A, f.simplex, true, f.entry.a);
  below.piece_b = pieceAtWitness(B, f.simplex, false, f.entry.b);
  below.simplex.n = 0;  // its points are the hulls', not the pieces'
  if (below.piece_a >= 0 && below.piece_b >= 0 && prove(below)) f = below;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
