// SPDX-License-Identifier: BSD-3-Clause
//
// Leaf pairs and hulls that are left, one by one: t_lower by certificates up to their first root, t_upper by proofs of
// contact.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Follows a leaf pair from its t_lower towards `stop`: certificates over eight lanes with one direction, up to the
/// first root of the gap's bound; there a new direction, and lanes as wide as the gap will last at the speed seen so
/// far. Two directions tell how they turn: from then on the certificate's turns likewise, and the steps are a secant
/// method's.
/// @param patient  goes on to the last; else the search ends where contact is to be expected within the tolerance.
/// @param first_lanes  not 0: begin with the first batch's lanes, of which all but these are free.
/// @return false where it ended before `stop` (and before the earliest proven contact), or, where any contact will do,
/// has proven one (f.certain).
inline bool Solver::advance(Final& f, double stop, bool patient, unsigned first_lanes) {
  const double expected = query_->tolerance_time / 16;
  double span = stop - f.t_lower, accuracy = patient ? 1e-7 : kFollowingAccuracy;
  double seen = f.t_lower, turn[3] = {0, 0, 0};  // when f.normal was found; how it turns, per unit of time
  bool turns = false;
  f.stuck = false;
  for (int round = 0; round < (patient ? 48 : 24); ++round) {
    const double t = f.t_lower;
    stop = min(stop, limit_);
    if (t >= stop) return true;
    const bool first = round == 0 && first_lanes;
    const double from = first ? 0 : t;
    span = first ? 1 : min(span, stop - t);
    const double w = span / kLanes, d = 0.5 * w + kLaneSlack;
    double tm[kLanes];
    for (int k = 0; k < kLanes; ++k) tm[k] = from + (k + 0.5) * w;
    evaluateAt(tm, d);
    setupPair(f.entry.pair);
    f.speed = amplitude_ / d;
    ++statistics_.leaf_tests;
    const Piece *piece_a, *piece_b;
    piecesOf(f, piece_a, piece_b);
    const Piece &a = *piece_a, &b = *piece_b;
    const double radii = a.radius + b.radius + margin_;
    // A witness at some time of the present lanes; false: the gap is gone there, or so it seems.
    const auto look = [&](int lane, double tau) {
      const DifferenceBody body = differenceAt(a, b, lane, tau);
      GjkResult g;
      gjk(body, f.have_normal ? f.normal : body.pose.c, accuracy, radii, 64, g, &f.simplex);
      ++statistics_.gjk;
      f.simplex = g.simplex;
      if (g.overlap) return false;
      for (int k = 0; k < 3; ++k) f.normal[k] = witness_[k] = g.n[k];
      f.gap = g.lower - radii;
      f.apart = g.distance - radii;
      return f.have_normal = have_witness_ = true;
    };
    if (!f.have_normal && !look(first ? __builtin_ctz(first_lanes) : 0, -1)) break;

    // One bound along a direction that turns, or two along one that does not, in either frame.
    Lanes G[2][3];
    const int bounds = turns ? 1 : 2;
    if (turns) {
      TurningDirection n;
      const Lanes begin = tm_ - Lanes(seen + d);
      for (int k = 0; k < 3; ++k) {
        n.begin[k] = mulAdd(begin, turn[k], f.normal[k]);
        n.end[k] = n.begin[k] + Lanes(2 * d * turn[k]);
      }
      gapBound(side(0), a, b, n, margin_, pad_, G[0]);
    } else {
      const DifferenceBody here = differenceAt(a, b, 0);
      double n[3];
      here.opposite(f.normal, n);
      gapBound(side(0), a, b, f.normal, margin_, pad_, G[0]);
      gapBound(side(1), b, a, n, margin_, pad_, G[1]);
    }
    statistics_.certificates += static_cast<std::uint64_t>(bounds);
    unsigned separated = first ? kAllLanes & ~first_lanes : 0;
    for (int i = 0; i < bounds; ++i) separated |= greater(min(min(G[i][0], G[i][1]), G[i][2]), Lanes(0.0));
    if (separated == kAllLanes) {
      f.t_lower = min(stop, from + span);
      span *= 4;
      continue;
    }
    if (query_->any && round > 0 && proveAhead(f, kLanes - 1)) return false;
    const int lane = __builtin_ctz(~separated);
    double x = 0;
    for (int i = 0; i < bounds; ++i) {
      const double coefficients[3] = {G[i][0][lane], G[i][1][lane], G[i][2][lane]};
      x = max(x, positivePrefix(coefficients));
    }
    // Lanes before it are free, and it is [tm - d, tm + d].
    const double root = (x >= 1 ? tm[lane] + d : (tm[lane] - d) + 2 * d * x) - 4 * kUlp;
    f.t_lower = max(t, min(stop, max(root, lane ? tm[lane] - 0.5 * w : t)));
    const double progress = f.t_lower - seen, gap = f.gap, before[3] = {f.normal[0], f.normal[1], f.normal[2]};
    if (!look(lane, (f.t_lower - tm[lane]) / d)) break;
    turns = progress > 0 && dot(before, f.normal) > 0.5 && !unbounded(a) && !unbounded(b);
    for (int k = 0; k < 3; ++k) turn[k] = turns ? (f.normal[k] - before[k]) / progress : 0;
    seen = f.t_lower;
    if (seen > t && gap > 0) {
      const double left = max(0.0, f.gap) * (progress / gap);  // time until the gap is closed, at the speed seen
      if (!patient && left < expected) break;
      span = min(4 * span, max(2 * left, kNarrowestLane));
    } else {
      // Not even a beginning: a better witness, narrower lanes.
      if (w < 64 * kUlp) break;
      accuracy = 1e-7;
      span *= 0.125;
    }
  }
  f.stuck = f.t_lower < min(stop, limit_);
  return !f.stuck;
}

/// Where any contact will do: the lanes of a followed pair reach beyond the contact that is expected. The pieces that
/// the last witness lies on are tried there; where they touch, f becomes their contact.
inline bool Solver::proveAhead(Final& f, int lane) {
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  const int piece_a = f.hulls ? pieceAtWitness(A, f.simplex, true) : f.piece_a;
  const int piece_b = f.hulls ? pieceAtWitness(B, f.simplex, false) : f.piece_b;
  if (piece_a < 0 || piece_b < 0) return false;
  ++statistics_.contact_proofs;
  const DifferenceBody body = differenceAt(A.pieces[piece_a], B.pieces[piece_b], lane);
  if (!certainlyTouching(body, margin_, pose_error_, f.normal, f.point)) return false;
  if (!takeProof(f.entry.pair, tm_at_[lane])) return false;
  f.hulls = false;
  f.piece_a = piece_a;
  f.piece_b = piece_b;
  f.certain = f.stuck = true;
  f.t_upper = tm_at_[lane];
  return true;
}

inline void Solver::piecesOf(const Final& f, const Piece*& a, const Piece*& b) const {
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  a = f.hulls ? A.outer : &A.pieces[f.piece_a];
  b = f.hulls ? B.outer : &B.pieces[f.piece_b];
}

/// What an entry stands for, to be followed from `start`: two leaves, or more than that.
inline Solver::Final Solver::leafPair(const Entry& e, double start) const {
  const PairParts pair = parts(e.pair);
  Final f = {};
  f.entry = e;
  f.t_lower = max(start, watchFrom(e.pair));
  f.piece_a = problem_->bodies[pair.a].tree->nodes[e.a].piece();
  f.piece_b = problem_->bodies[pair.b].tree->nodes[e.b].piece();
  return f;
}

/// Decides a leaf pair that is stuck, as far as can be: true when it is free after all; else f.certain tells.
inline bool Solver::settle(Final& f, double stop) {
  if (prove(f)) return false;
  if (advance(f, stop, true)) return true;
  if (!f.certain) prove(f);
  return false;
}

/// Proof of contact within the tolerance behind t_lower.
inline bool Solver::prove(Final& f) {
  // Not quite 1: the sum rounds, and the bracket is to be no wider than the tolerance.
  static const double kOffsets[kLanes] = {0.25, 0.5, 0.999, 0x1p-4, 0x1p-6, 0x1p-9, 0x1p-14, 0};
  double tm[kLanes];
  for (int k = 0; k < kLanes; ++k) tm[k] = min(1.0, f.t_lower + kOffsets[k] * query_->tolerance_time);
  evaluateAt(tm, 0);
  setupPair(f.entry.pair);
  const Piece &a = side_[0].still->pieces[f.piece_a], &b = side_[0].moving->pieces[f.piece_b];
  const int head = f.have_normal ? 0 : kLanes - 1;  // never seen apart: in contact at t_lower itself
  for (int i = 0; i < kLanes; ++i) {
    const int k = (head + i) % kLanes;
    const DifferenceBody body = differenceAt(a, b, k);
    ++statistics_.contact_proofs;
    if (certainlyTouching(body, margin_, pose_error_, f.have_normal ? f.normal : body.pose.c, f.point, &f.simplex) &&
        takeProof(f.entry.pair, tm[k])) {
      f.certain = true;
      f.t_upper = tm[k];
      return true;
    }
  }
  return false;
}

/// The piece of a body that holds most, by their weights, of the points of its hull that are nearest to the other body,
/// the heaviest of them among these; -1: there is none, as where the hull's vertices are not the body's own.
inline int Solver::pieceAtWitness(const TreeView& tree, const Simplex& simplex, bool of_a) {
  if (tree.num_pieces == 1) return 0;
  if (tree.pieces[0].kind != PieceKind::vertices || simplex.n == 0) return -1;
  const auto point = [&](int k) { return of_a ? simplex.v[k].a : simplex.v[k].b; };
  int heaviest = 0;
  for (int k = 1; k < simplex.n; ++k) {
    if (simplex.weight[k] > simplex.weight[heaviest]) heaviest = k;
  }
  const double* x = point(heaviest);
  int best = -1, count = 1;
  double most = 0;
  constexpr int kDeepest = 64;
  std::int32_t waiting[kDeepest] = {0};
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
        const double* y = point(k);
        if (y[0] == v[0] && y[1] == v[1] && y[2] == v[2]) weight += simplex.weight[k];
      }
    }
    if (weight <= most) continue;
    most = weight;
    best = node.piece();
  }
  return best;
}

/// Hulls that meet, whose vertices are their bodies' own: of convex bodies the pieces there meet at the same time.
/// Where that is proven, f becomes these two pieces' contact, and is no hulls' any more.
inline void Solver::proveBelowHulls(Final& f) {
  if (!f.have_normal || query_->max_contacts > 1) return;
  setupPair(f.entry.pair);
  const TreeView &A = *side_[0].still, &B = *side_[0].moving;
  if (A.outer->radius + B.outer->radius > f.speed * query_->tolerance_time) return;
  Final below = f;
  below.hulls = false;
  below.piece_a = pieceAtWitness(A, f.simplex, true);
  below.piece_b = pieceAtWitness(B, f.simplex, false);
  below.simplex.n = 0;  // its points are the hulls', not the pieces'
  if (below.piece_a >= 0 && below.piece_b >= 0 && prove(below)) f = below;
}

/// A pair that was never seen apart, as it touches where its window begins: looks back, ever farther, to where it was.
inline void Solver::lookBack(Final& f) {
  double tm[kLanes], step = query_->tolerance_time;
  for (double& t : tm) {
    t = max(0.0, f.t_lower - step);
    step *= 4;
  }
  evaluateAt(tm, 0);
  setupPair(f.entry.pair);
  const Piece *a, *b;
  piecesOf(f, a, b);
  for (int k = 0; k < kLanes && !f.have_normal; ++k) {
    const DifferenceBody body = differenceAt(*a, *b, k);
    GjkResult g;
    gjk(body, body.pose.c, 1e-7, a->radius + b->radius + margin_, 64, g);
    ++statistics_.gjk;
    if (g.overlap) continue;
    for (int j = 0; j < 3; ++j) f.normal[j] = g.n[j];
    f.have_normal = true;
  }
}

/// Point and normal of a pair that is stuck.
inline void Solver::describe(Final& f, LeafContact& contact) {
  if (!f.have_normal && f.t_lower > 0) lookBack(f);
  if (!(f.certain && f.have_normal)) {  // what is missing is seen at t_lower
    const double tm[kLanes] = {f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower, f.t_lower};
    evaluateAt(tm, 0);
  }
  setupPair(f.entry.pair);
  const PairParts bodies = parts(f.entry.pair);
  contact = {};
  contact.pair = f.entry.pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = f.piece_a;
  contact.piece_b = f.piece_b;
  contact.t_lower = f.t_lower;
  contact.certain = f.certain;
  contact.t_upper = f.certain ? f.t_upper : 1;
  contact.t = f.certain ? f.t_upper : f.t_lower;
  const Piece &a = side_[0].still->pieces[contact.piece_a], &b = side_[0].moving->pieces[contact.piece_b];
  const DifferenceBody body = differenceAt(a, b, 0);
  for (int k = 0; k < 3; ++k) contact.point[k] = f.point[k];
  if (!f.certain) {
    GjkResult g;
    gjk(body, f.have_normal ? f.normal : body.pose.c, 1e-7, 0, 64, g);
    originWeights(g.simplex);
    if (!f.have_normal && !g.overlap) {
      for (int k = 0; k < 3; ++k) f.normal[k] = g.n[k];
      f.have_normal = true;
    }
    // Midway between the surfaces: the cores' nearest points, each moved out by its radius.
    const double out = f.have_normal ? 0.5 * (a.radius - b.radius) : 0;
    double x[3], y[3];
    combine(body, g.simplex, x, y);
    for (int k = 0; k < 3; ++k) contact.point[k] = out * f.normal[k] + 0.5 * (x[k] + y[k]);
  }
  if (!f.have_normal) {
    // In contact from the start: an unbounded piece's own direction, or the one between the pieces' middles.
    double x[3], y[3], m[3], size = 0;
    middleOf(side_[0].still->nodes[f.entry.a], x);
    middleOf(side_[0].moving->nodes[f.entry.b], y);
    for (int k = 0; k < 3; ++k) {
      m[k] = dot(body.pose.R + 3 * k, y) + body.pose.c[k] - x[k];
      if (unbounded(a)) m[k] = a.size[k];
      if (unbounded(b)) m[k] = -dot(body.pose.R + 3 * k, b.size);
      size += m[k] * m[k];
    }
    for (int k = 0; k < 3; ++k) f.normal[k] = size > 0 ? m[k] / sqrt(size) : (k == 2);
  }
  for (int k = 0; k < 3; ++k) contact.normal[k] = f.normal[k];
}

/// Records what is stuck.
inline void Solver::record(Final& f) {
  FCL_ARTIC_ASSERT(f.t_lower >= 0 && f.t_lower <= 1);
  describe(f, contacts_.grow());
  engine::joinLower(found_, f.t_lower);
}

/// Of contacts_[begin, ...) those that begin within the bracket, the first contact first, as many as are asked for.
inline void Solver::orderContacts(int begin, double bracket) {
  int kept = begin;
  for (int i = begin; i < contacts_.size(); ++i) {
    if (contacts_[i].t_lower <= bracket) contacts_[kept++] = contacts_[i];
  }
  const int end = min(kept, begin + query_->max_contacts);
  for (int i = begin; i < end; ++i) {  // a few: selection sort by certainty, then time
    int best = i;
    for (int j = i + 1; j < kept; ++j) {
      if (engine::comesBefore(contacts_[j], contacts_[best])) best = j;
    }
    const LeafContact swap = contacts_[i];
    contacts_[i] = contacts_[best];
    contacts_[best] = swap;
  }
  contacts_.truncate(end);
}

/// The leaf pairs that a lane leaves undecided, one by one: how far is each free, and is there contact?
/// @param[out] refine  the lane is to be split: it is wider than the tolerance, or the pairs are farther apart than the
///   distance tolerance, and nothing is proven.
inline Solver::Step Solver::finishLane(double start, double width, int begin, int end, int lane, bool* refine) {
  const bool last = last_;
  const double stop = start + width;
  finals_.clear();
  for (int i = begin; i < end; ++i) {
    const Entry& e = entries_[i];
    if (!(e.mask >> lane & 1)) continue;
    finals_.push(leafPair(e, start));
  }
  *refine = false;
  for (int i = 0; i < finals_.size(); ++i) {
    Final& f = finals_[i];
    if (!advance(f, stop, false) && !f.certain) settle(f, stop);
    if (outOfBudget()) return Step::done;
    // It touches from the beginning on: nothing can be earlier, and of many such pairs some are enough.
    const bool enough = f.certain && f.t_lower <= start && i >= max(64, query_->max_contacts);
    if (enough || finished()) finals_.truncate(i + 1);
  }
  const bool narrow = width <= kNarrowestLane;
  // (Where any contact will do and one is proven, it is recorded whatever is still open.)
  for (int i = 0; i < finals_.size() && !finished(); ++i) {
    const Final& f = finals_[i];
    if (!f.stuck || f.certain || f.t_lower >= limit_) continue;
    // Near are those of which points are: a direction along which little is proven says nothing. Where there is none,
    // GJK claimed overlap, and is believed as far as to kOverlapAccuracy of the smaller body.
    const PairParts pair = parts(f.entry.pair);
    const double size = min(problem_->bodies[pair.a].tree->extent, problem_->bodies[pair.b].tree->extent);
    const double apart = f.have_normal ? f.apart : kOverlapAccuracy * size;
    const bool near = apart <= 0.5 * query_->tolerance_distance;
    if (!narrow && (!last || !near)) {
      *refine = true;
      return Step::free;
    }
    limit_ = min(limit_, f.t_lower + query_->tolerance_time);
  }
  const int before = contacts_.size();
  for (int i = 0; i < finals_.size(); ++i) {
    if (finals_[i].stuck && finals_[i].t_lower <= limit_) record(finals_[i]);
  }
  return contacts_.size() > before ? Step::done : Step::free;
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
