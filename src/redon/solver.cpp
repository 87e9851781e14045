// SPDX-License-Identifier: BSD-3-Clause
#include "redon/solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "model/answer.h"

namespace fcl_artic {
namespace redon {
namespace {

/// Time intervals are not divided below this.
constexpr double kNarrowest = 0x1p-46;
/// A gap counts as none when it is at most this many times the error of its own ends.
constexpr double kNoGap = 8;

}  // namespace

void RootSolver::begin(const engine::Problem& problem, const engine::Query& query, const Options& options,
                       Counts& counts) {
  problem_ = &problem;
  query_ = &query;
  options_ = &options;
  counts_ = &counts;
  const Enclosure enclosure = enclosureOf(options);
  over_.begin(problem, query, enclosure, !options.simultaneous, counts);
  middle_.begin(problem, query, enclosure, !options.simultaneous, counts);
}

void RootSolver::setInterval(double begin, double end) {
  begin_ = begin;
  end_ = end;
  mid_ = begin + 0.5 * (end - begin);
  if (!(mid_ < end)) mid_ = begin;
  over_.setInterval(begin, end, Derivatives::first);
  middle_.setInterval(mid_, mid_, Derivatives::none);
  ++stamp_;
}

/// Computed once per interval and pair, however many equations ask.
const PairBounds& RootSolver::motionOf(std::int32_t index) {
  const auto i = static_cast<std::size_t>(index);
  PairBounds& m = motions_[i];
  if (motion_stamps_[i] == stamp_) return m;
  motion_stamps_[i] = stamp_;
  const BodyPair& pair = (*pairs_)[i];
  const FrameBounds& over = over_.frame(pair.parts.sweep, pair.parts.step_b);
  m.over = relate(pair.inverse_a, over.pose, pair.placement_b);
  m.rate = relateRate(pair.inverse_a, over.rate, pair.placement_b);
  m.middle = relate(pair.inverse_a, middle_.frame(pair.parts.sweep, pair.parts.step_b).pose, pair.placement_b);
  return m;
}

void RootSolver::boundElements(const Equation& q) {
  std::vector<Element>& elements = set_->elements();
  for (const std::int32_t i : q.element) {
    if (i < 0) continue;
    Element& e = elements[static_cast<std::size_t>(i)];
    if (!e.moves || e.stamp == stamp_) continue;
    e.stamp = stamp_;
    bound(e, motionOf(q.pair));
  }
}

/// Narrows the part of the present interval in which the equation may have a root; false when there is none.
/// @param validity  asks for the features, too.
bool RootSolver::mayHaveRoot(Active& active, double begin, double end, bool validity) {
  const Equation& q = set_->equations()[static_cast<std::size_t>(active.equation)];
  active.lo = std::max(begin, q.from);
  active.hi = end;
  if (active.lo > active.hi) return false;
  ++counts_->evaluations;
  boundElements(q);
  const Element* elements = set_->elements().data();
  if (!value(q, elements, &Element::over).containsZero()) return false;
  const Interval h = Interval(begin, end) - Interval(mid_);
  double gap;
  if (validity && certainlyApart(q, elements, h, gap)) return false;
  if (!options_->newton) return true;
  const Interval slope = derivativeOver(q, elements);
  if (slope.containsZero()) return true;
  const Interval roots = Interval(mid_) - value(q, elements, &Element::middle) / slope;  // eq. (18)
  active.lo = std::max(active.lo, roots.lower());
  active.hi = std::min(active.hi, roots.upper());
  return active.lo <= active.hi;
}

SearchOutcome RootSolver::solve(const std::vector<BodyPair>& pairs, EquationSet& equations, double begin, double end,
                                double limit, double free_else, std::vector<engine::LeafContact>& contacts) {
  pairs_ = &pairs;
  set_ = &equations;
  free_else_ = options_->simultaneous ? free_else : 0;  // an equation solved by itself proves nothing about the others
  motions_.resize(pairs.size());
  motion_stamps_.assign(pairs.size(), -1);
  const std::size_t n = equations.equations().size();
  counts_->equations += n;
  active_.clear();
  if (options_->simultaneous) {
    for (std::size_t i = 0; i < n; ++i) active_.push_back({static_cast<std::int32_t>(i), begin, end});
    return search(0, begin, end, limit, contacts);
  }
  // The paper's baseline: each equation by itself, up to the first root found so far. Until all are solved, it is only
  // proven that the pairs enter without contact.
  SearchOutcome outcome;
  outcome.free_until = begin;
  double least = end;
  for (std::size_t i = 0; i < n; ++i) {
    const double from = std::max(begin, equations.equations()[i].from);
    if (from > std::min(end, limit)) {
      least = std::min(least, from);
      continue;
    }
    active_.assign(1, {static_cast<std::int32_t>(i), from, end});
    const SearchOutcome own = search(0, from, end, limit, contacts);
    outcome.out_of_budget = own.out_of_budget;
    if (own.out_of_budget) return outcome;
    least = std::min(least, own.free_until);
    if (!own.contact) continue;
    outcome.contact = true;
    outcome.t_upper = std::min(outcome.t_upper, own.t_upper);
    limit = std::min(limit, latestBegin(own, query_->tolerance_time));
  }
  outcome.free_until = least;
  return outcome;
}

/// Depth first, the earlier half first: whatever lies before the present interval is free of roots.
SearchOutcome RootSolver::search(std::size_t first, double begin, double end, double limit,
                                 std::vector<engine::LeafContact>& contacts) {
  SearchOutcome outcome;
  open_intervals_.assign(1, {begin, end, first, active_.size() - first});
  while (!open_intervals_.empty()) {
    const OpenInterval interval = open_intervals_.back();
    open_intervals_.pop_back();
    active_.resize(interval.first + interval.count);
    outcome.free_until = interval.begin;
    if (interval.begin > limit) return outcome;
    if (query_->work_budget && workOf(*counts_) > query_->work_budget) {
      outcome.out_of_budget = true;
      return outcome;
    }
    if (query_->progress && (counts_->intervals & 255) == 0) {
      const RoundToNearest usual;  // for the caller's code
      outcome.out_of_budget = !query_->progress(query_->progress_context, std::min(interval.begin, free_else_));
      if (outcome.out_of_budget) return outcome;
    }
    ++counts_->intervals;
    setInterval(interval.begin, interval.end);
    // Equations that stay active move up; the interval's own entries are spent by then.
    const bool validity = options_->early_validity;
    std::size_t kept = interval.first;
    double lo = interval.end, hi = interval.begin;
    for (std::size_t i = interval.first; i < interval.first + interval.count; ++i) {
      Active a = active_[i];
      if (!mayHaveRoot(a, interval.begin, interval.end, validity)) continue;
      lo = std::min(lo, a.lo);
      hi = std::max(hi, a.hi);
      active_[kept++] = a;
    }
    active_.resize(kept);
    if (kept == interval.first) continue;
    // All are reduced to [lo, hi] (Section 5.2.4).
    if (interval.end - interval.begin <= std::max(0.5 * query_->tolerance_time, kNarrowest)) {
      if (settle(interval, kept, outcome, contacts)) return outcome;
      kept = active_.size();  // those that may touch still
      if (kept == interval.first) continue;
    }
    const double middle = lo + 0.5 * (hi - lo);
    if (hi - lo <= 0.5 * (interval.end - interval.begin)) {  // no need to divide what is left
      open_intervals_.push_back({lo, hi, interval.first, kept - interval.first});
      continue;
    }
    // The later half below, to stay while the earlier one is worked on.
    const std::size_t later = kept;
    double later_lo = hi, earlier_hi = lo;
    for (std::size_t i = interval.first; i < kept; ++i) {
      const Active a = active_[i];
      if (a.hi >= middle) {
        active_.push_back(a);
        later_lo = std::min(later_lo, std::max(middle, a.lo));
      }
    }
    const std::size_t earlier = active_.size();
    for (std::size_t i = interval.first; i < kept; ++i) {
      const Active a = active_[i];
      if (a.lo <= middle) {
        active_.push_back(a);
        earlier_hi = std::max(earlier_hi, std::min(middle, a.hi));
      }
    }
    if (earlier > later) open_intervals_.push_back({later_lo, hi, later, earlier - later});
    if (active_.size() > earlier) open_intervals_.push_back({lo, earlier_hi, earlier, active_.size() - earlier});
  }
  outcome.free_until = end;
  return outcome;
}

Interval RootSolver::valueAt(const Equation& q, double t) {
  setInterval(t, t);
  boundElements(q);
  return value(q, set_->elements().data(), &Element::over);
}

/// Finds a window around [begin, end] in which the function changes its sign while its features meet.
bool RootSolver::certify(const Equation& q, double begin, double end, double& t_upper) {
  const double room = query_->tolerance_time - (end - begin);
  for (const double part : {0x1p-16, 0x1p-8, 0x1p-2, 0.0}) {
    const double from = std::max(0.0, begin - part * room), to = std::min(1.0, end + part * room);
    const Interval first = valueAt(q, from), last = valueAt(q, to);
    const bool changes = (first.certainlyNegative() && last.certainlyPositive()) ||
                         (first.certainlyPositive() && last.certainlyNegative());
    if (!changes) continue;
    setInterval(from, to);
    boundElements(q);
    if (!certainlyInside(q, set_->elements().data())) continue;
    t_upper = to;
    return true;
  }
  return false;
}

/// The last interval: are the roots of the interval's equations contacts? Roots whose features are apart are dropped.
/// @return true when contact is found; else what is left is to be divided on.
bool RootSolver::settle(const OpenInterval& interval, std::size_t end, SearchOutcome& outcome,
                        std::vector<engine::LeafContact>& contacts) {
  const bool narrowest = interval.end - interval.begin <= kNarrowest;
  struct Root {
    Active active;
    bool certain;
    double t_upper;
  };
  std::vector<Root> roots;
  std::size_t kept = interval.first;
  double first_lo = engine::kNever;
  for (std::size_t i = interval.first; i < end; ++i) {
    const Active active = active_[i];
    const Equation& q = set_->equations()[static_cast<std::size_t>(active.equation)];
    setInterval(interval.begin, interval.end);
    boundElements(q);
    double gap, known = 0;  // in the middle, and the error of positions there
    if (certainlyApart(q, set_->elements().data(), Interval(interval.begin, interval.end) - Interval(mid_), gap))
      continue;
    active_[kept++] = active;
    first_lo = std::min(first_lo, active.lo);
    for (const std::int32_t e : q.element) {
      if (e < 0 || set_->elements()[static_cast<std::size_t>(e)].direction) continue;
      for (const Interval& x : set_->elements()[static_cast<std::size_t>(e)].middle.v)
        known = std::max(known, x.width());
    }
    Root root{active, false, engine::kNever};
    root.certain = certify(q, active.lo, active.hi, root.t_upper);
    const bool near = gap <= kNoGap * known && gap <= query_->tolerance_distance;
    if (root.certain || near || narrowest) roots.push_back(root);
  }
  active_.resize(kept);
  if (roots.empty()) return false;
  outcome.contact = true;
  outcome.free_until = first_lo;  // roots that are no contact count, too: they are not decided
  for (const Root& root : roots) {
    if (root.certain) outcome.t_upper = std::min(outcome.t_upper, root.t_upper);
    report(set_->equations()[static_cast<std::size_t>(root.active.equation)], std::max(root.active.lo, first_lo),
           root.certain, root.t_upper, contacts);
  }
  return true;
}

void RootSolver::report(const Equation& q, double begin, bool certain, double t_upper,
                        std::vector<engine::LeafContact>& contacts) {
  const BodyPair& pair = (*pairs_)[static_cast<std::size_t>(q.pair)];
  engine::LeafContact contact = {};
  contact.pair = pair.index;
  contact.body_a = pair.parts.a;
  contact.body_b = pair.parts.b;
  contact.piece_a = pair.a->triangles()[static_cast<std::size_t>(q.triangle_a)].piece;
  contact.piece_b = pair.b->triangles()[static_cast<std::size_t>(q.triangle_b)].piece;
  contact.certain = certain;
  contact.t_lower = begin;
  contact.t_upper = certain ? t_upper : 1;
  contact.t = certain ? t_upper : begin;
  const FeatureKind features[] = {FeatureKind::faceVertex, FeatureKind::vertexFace, FeatureKind::edgeEdge};
  contact.feature = static_cast<std::int32_t>(features[static_cast<int>(q.kind)]);
  // The side that the features were on before: at the last time at which the function had a sign.
  double before = 0;
  for (double back = query_->tolerance_time; before == 0 && back < 1; back *= 8) {
    const Interval f = valueAt(q, std::max(0.0, begin - back));
    before = f.certainlyPositive() ? 1 : f.certainlyNegative() ? -1 : 0;
  }
  setInterval(contact.t, contact.t);
  boundElements(q);
  describe(q, set_->elements().data(), before, contact.point, contact.normal);
  contacts.push_back(contact);
}

}  // namespace redon
}  // namespace fcl_artic
