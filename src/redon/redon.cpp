// SPDX-License-Identifier: BSD-3-Clause
#include "redon/redon.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "model/bracket.h"
#include "narrowphase/engine_workspace.h"
#include "numerics/assertion.h"
#include "redon/solver.h"
#include "redon/swept_volumes.h"

namespace fcl_artic {
namespace redon {
namespace {

using engine::Answer;
using engine::FirstContact;
using engine::indexOf;
using engine::LeafContact;
using engine::PairId;
using engine::Problem;
using engine::Query;
using Clock = std::chrono::steady_clock;

/// Their equations and elements take some 100 MB at most.
constexpr std::size_t kMaxLeaves = 1 << 15;

/// Without a work budget, the paper's method gives up a query after this much work, in units of workOf(), and the
/// engine answers it. Bodies that slide on each other are divided down to the narrowest intervals all along their way.
/// A unit takes 0.1 to 1 us.
constexpr std::uint64_t kMaxWork = 1 << 17;

/// Adds up the time of stages, where it is asked for.
class StageClock {
 public:
  explicit StageClock(bool runs) : runs_(runs), last_(runs ? Clock::now() : Clock::time_point()) {}
  /// Time since the last call goes to the stage.
  void lap(double& stage_us) {
    if (!runs_) return;
    const Clock::time_point now = Clock::now();
    stage_us += std::chrono::duration<double, std::micro>(now - last_).count();
    last_ = now;
  }

 private:
  bool runs_;
  Clock::time_point last_;
};

}  // namespace

struct Workspace::Impl {
  Culling culling;
  SweptVolumes volumes;
  RootSolver solver;
  std::vector<BodyPair> pairs, one;  ///< that may touch; the one of them that is looked at
  std::vector<LeafPair> leaves;
  EquationSet equations;
  std::vector<LeafContact> contacts;

  std::vector<std::uint8_t> by_engine;  ///< by pair of the problem
  std::vector<std::uint8_t> left;       ///< by pair of the problem: culling has left it
  std::vector<double> free_until;       ///< by pair of the problem: proven free before
  std::vector<std::uint8_t> scene_allowed, link_allowed;
  std::vector<double> still;  ///< coefficients of a motion that rests at t = 0
  // The engine's part of the problem, and its query: both stay for its pairMotion().
  Problem rest;
  Query first;       ///< the query, for the first contact
  Query rest_query;  ///< the same; its progress is no later than the time up to which all pairs are known to be free
};

Workspace::Workspace() : impl_(std::make_unique<Impl>()) {}
Workspace::~Workspace() = default;

namespace {

/// Passes progress on, but no later than the proven time of the pairs that the solver at work does not have.
struct Progress {
  bool (*tell)(void* context, double t_lower);
  void* context;
  double others = 0;
  static bool update(void* self, double t_lower) {
    const auto& progress = *static_cast<const Progress*>(self);
    return progress.tell(progress.context, std::min(progress.others, t_lower));
  }
};

/// One query on its way. Each pair asked for has the time up to which it is proven free: 0 at first, and raised by
/// proofs only (provenFree). The answer is free if that is 1 for all of them, and its t_lower is the least. So a pair
/// that no stage has come to, for whatever reason, counts as not free.
class PendingQuery {
 public:
  PendingQuery(Workspace::Impl& w, engine::EngineWorkspace& engine, const Problem& problem, const Query& query,
               const Options& options, const std::function<const ObbTree*(std::int32_t)>& treeOf, Counts& counts)
      : w_(w), engine_(engine), problem_(problem), query_(query), options_(options), treeOf_(treeOf), counts_(counts) {}

  void solve(Answer& answer);

 private:
  std::size_t numPairs() const { return static_cast<std::size_t>(problem_.numPairs()); }
  bool asked(PairId pair) const;
  bool ours(PairId pair) const;
  bool choosePairs();
  bool touchesAtStart(Answer& answer);
  void leaveAll(Answer& answer);
  void solveRest(const Query& query, Answer& answer);
  void findPairs();
  SearchOutcome search(const std::vector<BodyPair>& pairs, double limit);
  SearchOutcome searchBoxesFirst(const std::vector<BodyPair>& pairs, double limit);
  SearchOutcome solveLeaves(const std::vector<BodyPair>& pairs, double begin, double end, double limit);
  void keepFirst(std::size_t begin, double bracket);
  void provenFree(PairId pair, double until) {
    FCL_ARTIC_ASSERT(indexOf(pair) < numPairs() && until >= 0 && until <= 1);
    double& known = w_.free_until[indexOf(pair)];
    known = std::max(known, until);
  }

  Workspace::Impl& w_;
  engine::EngineWorkspace& engine_;
  const Problem& problem_;
  const Query& query_;
  const Options& options_;
  const std::function<const ObbTree*(std::int32_t)>& treeOf_;
  Counts& counts_;
};

bool PendingQuery::asked(PairId pair) const {
  return (problem_.isScenePair(pair) ? query_.check_scene : query_.check_self) && !problem_.isAllowed(pair);
}

/// Triangles on both sides, no margin, and a motion by joints. Nor has the pair a margin of its own, as neighbours have
/// that are checked for touching. The paper checks no neighbours: its boxes are apart at no time where a joint holds
/// two links together.
bool PendingQuery::ours(PairId pair) const {
  const engine::PairParts parts = problem_.parts(pair);
  if (query_.margins.of(pair) > 0 || query_.margins.isOwn(pair)) return false;
  if (parts.step_b >= 0 && problem_.sweeps[parts.sweep].local_bounds) return false;
  return treeOf_(parts.a) && treeOf_(parts.b);
}

/// @return whether any pair is the paper's.
bool PendingQuery::choosePairs() {
  w_.by_engine.assign(numPairs(), 0);
  w_.free_until.assign(numPairs(), 1);  // of pairs that nobody asks for
  bool any = false;
  for (const PairId p : problem_.pairs()) {
    if (!asked(p)) continue;
    w_.free_until[indexOf(p)] = 0;
    const bool own = ours(p);
    w_.by_engine[indexOf(p)] = !own;
    any = any || own;
  }
  return any;
}

/// The paper starts without contact. The certificate, with all bodies at rest at t = 0, decides whether that is so;
/// contact is surfaces that cross, and solids that hold others. If a pair can't be proven apart, it goes to the engine.
/// @return true if all pairs go to the engine: the first contact is asked for and is at t = 0, or it is not known which
///   pairs touch.
bool PendingQuery::touchesAtStart(Answer& answer) {
  const auto n = static_cast<std::size_t>(query_.num_variables);
  const std::int32_t degree = query_.half_angles.count > 0 ? 2 : 1;
  w_.still.assign((static_cast<std::size_t>(degree) + 1) * n, 0);
  if (n) std::copy(query_.coefficients, query_.coefficients + n, w_.still.begin());
  Query still = query_;
  still.coefficients = w_.still.data();
  still.degree = degree;
  still.max_contacts = 1;
  still.progress = nullptr;
  still.describe_contacts = false;
  still.num_advisors = 0;  // they know of the motion itself
  // The pairs not proven apart at t = 0 are those that the engine would ignore; its list of them is never cut. At rest
  // there is no time at which they part, and no finer time than all of it.
  still.every_pair = false;
  still.ignore_initial = query_.every_pair || query_.ignore_initial;
  if (still.ignore_initial) still.tolerance_time = 1;
  engine_.solve(problem_, still, answer);
  if (!answer.isFree()) return true;
  for (int i = 0; i < answer.num_ignored; ++i) w_.by_engine[indexOf(answer.ignored[i].pair)] = 1;
  return false;
}

/// All pairs are the engine's.
void PendingQuery::leaveAll(Answer& answer) {
  counts_.pairs_by_standard = 0;
  for (const PairId p : problem_.pairs()) counts_.pairs_by_standard += asked(p);
  engine_.solve(problem_, query_, answer);
}

/// The engine's pairs.
void PendingQuery::solveRest(const Query& query, Answer& answer) {
  w_.scene_allowed.assign(static_cast<std::size_t>(problem_.num_scene_pairs), 1);
  w_.link_allowed.assign(static_cast<std::size_t>(problem_.num_link_pairs), 1);
  std::uint64_t left = 0;
  for (const PairId p : problem_.pairs()) {
    if (!w_.by_engine[indexOf(p)]) continue;
    *problem_.in(w_.scene_allowed.data(), w_.link_allowed.data(), p) = 0;
    ++left;
  }
  counts_.pairs_by_standard = left;
  w_.rest = problem_;
  w_.rest.scene_allowed = w_.scene_allowed.data();
  w_.rest.link_allowed = w_.link_allowed.data();
  engine_.solve(w_.rest, query, answer);
  const double until = answer.isFree() ? 1 : answer.t_lower;
  for (const PairId p : problem_.pairs()) {
    if (w_.by_engine[indexOf(p)]) provenFree(p, until);
  }
}

/// Finds the paper's pairs that dynamic BVH culling (Section 4) and then culling by visibility leave.
void PendingQuery::findPairs() {
  StageClock clock(query_.measure_times);
  const auto wanted = [this](PairId p) { return asked(p) && !w_.by_engine[indexOf(p)]; };
  w_.culling.begin(problem_, w_.rest_query, options_, counts_);
  w_.culling.bodyPairs(wanted, treeOf_, w_.pairs);
  clock.lap(counts_.culling_us);
  if (query_.num_advisors) {
    w_.volumes.refine(problem_, query_, options_, w_.pairs, counts_);
    clock.lap(counts_.visibility_us);
  }
  w_.left.assign(numPairs(), 0);
  for (const BodyPair& pair : w_.pairs) w_.left[indexOf(pair.index)] = 1;
  for (const PairId p : problem_.pairs()) {
    if (wanted(p) && !w_.left[indexOf(p)]) provenFree(p, 1);
  }
}

/// First contact in [begin, end] of the leaf pairs at hand. All equations are solved at once, but for at most
/// kMaxLeaves pairs, so memory is bounded.
SearchOutcome PendingQuery::solveLeaves(const std::vector<BodyPair>& pairs, double begin, double end, double limit) {
  SearchOutcome all;
  all.free_until = end;
  for (std::size_t first = 0; first < w_.leaves.size(); first += kMaxLeaves) {
    const std::size_t last = std::min(first + kMaxLeaves, w_.leaves.size());
    w_.equations.clear();
    w_.equations.add(pairs, w_.leaves.data() + first, w_.leaves.data() + last);
    const bool more = last < w_.leaves.size();
    const SearchOutcome found =
        w_.solver.solve(pairs, w_.equations, begin, end, limit, more ? begin : all.free_until, w_.contacts);
    all.contact = all.contact || found.contact;
    all.t_upper = std::min(all.t_upper, found.t_upper);
    all.free_until = std::min(all.free_until, found.free_until);
    all.out_of_budget = found.out_of_budget;
    if (found.out_of_budget) {
      if (more) all.free_until = begin;
      return all;
    }
    if (found.contact) limit = std::min(limit, latestBegin(found, query_.tolerance_time));
  }
  return all;
}

/// First contact of these pairs: boxes, then the equations of the triangles whose boxes meet, one sub-interval after
/// the other, from the first to that which holds `limit`.
SearchOutcome PendingQuery::search(const std::vector<BodyPair>& pairs, double limit) {
  if (!options_.in_time_order) return searchBoxesFirst(pairs, limit);
  StageClock clock(query_.measure_times);
  SearchOutcome found;
  w_.culling.start(pairs);
  w_.leaves.clear();
  for (int slot = 0; slot < w_.culling.numSlots(); ++slot) {
    const double begin = w_.culling.slotBegin(slot), end = w_.culling.slotBegin(slot + 1);
    if (begin > limit) return found;
    found.out_of_budget = !w_.culling.leafPairs(pairs, slot, w_.leaves);
    clock.lap(counts_.boxes_us);
    if (found.out_of_budget) return found;
    if (!w_.leaves.empty()) {
      found = solveLeaves(pairs, begin, end, limit);
      clock.lap(counts_.equations_us);
      if (found.contact || found.free_until < end) return found;
      w_.leaves.erase(
          std::remove_if(w_.leaves.begin(), w_.leaves.end(), [&](const LeafPair& l) { return l.until <= end; }),
          w_.leaves.end());
    }
    found.free_until = end;
  }
  return found;
}

/// As search(), in the paper's order: all triangles whose boxes meet at any time, then all their equations at once.
/// Boxes are left out only in sub-intervals that begin after `limit`; for the rest all equations are solved.
SearchOutcome PendingQuery::searchBoxesFirst(const std::vector<BodyPair>& pairs, double limit) {
  StageClock clock(query_.measure_times);
  SearchOutcome found;
  w_.culling.start(pairs);
  w_.leaves.clear();
  double end = 0;
  for (int slot = 0; slot < w_.culling.numSlots() && w_.culling.slotBegin(slot) <= limit; ++slot) {
    found.out_of_budget = !w_.culling.leafPairs(pairs, slot, w_.leaves);
    if (found.out_of_budget) break;
    end = w_.culling.slotBegin(slot + 1);
  }
  clock.lap(counts_.boxes_us);
  if (found.out_of_budget) return found;
  found = solveLeaves(pairs, 0, end, limit);
  clock.lap(counts_.equations_us);
  return found;
}

/// Keeps, of the contacts from `begin` on that lie within the bracket, the first one of each pair, as many as are asked
/// for.
void PendingQuery::keepFirst(std::size_t begin, double bracket) {
  std::vector<LeafContact>& all = w_.contacts;
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
  all.erase(std::remove_if(first, all.end(), [&](const LeafContact& c) { return c.t_lower > bracket; }), all.end());
  std::stable_sort(first, all.end(), [](const LeafContact& x, const LeafContact& y) {
    return x.pair != y.pair ? x.pair < y.pair : engine::comesBefore(x, y);
  });
  const auto samePair = [](const LeafContact& x, const LeafContact& y) { return x.pair == y.pair; };
  // It begins with the earliest of its pair: before that none of the pair's pieces touch.
  for (auto group = first; group != all.end();) {
    const auto next = std::find_if(group, all.end(), [&](const LeafContact& c) { return c.pair != group->pair; });
    double t_lower = w_.free_until[indexOf(group->pair)];
    for (auto c = group; c != next; ++c) t_lower = std::min(t_lower, c->t_lower);
    group->t_lower = t_lower;
    group = next;
  }
  all.erase(std::unique(first, all.end(), samePair), all.end());
  std::stable_sort(first, all.end(), engine::comesBefore);
  all.resize(std::min(all.size(), begin + static_cast<std::size_t>(query_.max_contacts)));
}

void PendingQuery::solve(Answer& answer) {
  counts_ = Counts();
  w_.contacts.clear();
  if (!choosePairs() || touchesAtStart(answer)) return leaveAll(answer);
  // Nothing is known of the paper's pairs while the engine looks at its own.
  Progress progress{query_.progress, query_.progress_context};
  Query& query = w_.rest_query;
  query = query_;
  if (query.progress) {
    query.progress = &Progress::update;
    query.progress_context = &progress;
  }
  solveRest(query, answer);
  bool contact = answer.status == Status::contact, out_of_budget = answer.status == Status::undecided;
  double t_upper = engine::provenBy(answer);
  for (int i = 0; i < answer.num_contacts; ++i) w_.contacts.push_back(answer.contacts[i]);

  std::optional<RoundUpward> upward(std::in_place);
  if (query.work_budget == 0) query.work_budget = kMaxWork;
  w_.solver.begin(problem_, query, options_, counts_);
  const auto take = [&](const std::vector<BodyPair>& pairs, const SearchOutcome& found) {
    for (const BodyPair& pair : pairs) provenFree(pair.index, found.free_until);
    t_upper = std::min(t_upper, found.t_upper);
    contact = contact || found.contact;
    out_of_budget = out_of_budget || found.out_of_budget;
  };
  findPairs();
  if (!query_.every_pair) {
    progress.others = answer.isFree() ? 1 : answer.t_lower;
    take(w_.pairs, search(w_.pairs, contact ? (answer.certain ? answer.t_upper : answer.t_lower) : engine::kNever));
  } else {
    std::sort(w_.pairs.begin(), w_.pairs.end(), [](const BodyPair& x, const BodyPair& y) { return x.index < y.index; });
    for (std::size_t i = 0; i < w_.pairs.size() && !out_of_budget; ++i) {
      const std::size_t before = w_.contacts.size();
      w_.one.assign(1, w_.pairs[i]);
      const SearchOutcome found = search(w_.one, engine::kNever);
      take(w_.one, found);
      keepFirst(before, latestBegin(found, query_.tolerance_time));
    }
  }
  if (out_of_budget && query_.work_budget == 0 && workOf(counts_) > kMaxWork) {
    upward.reset();
    w_.contacts.clear();
    return leaveAll(answer);
  }
  const double t_lower = w_.free_until.empty() ? 1 : *std::min_element(w_.free_until.begin(), w_.free_until.end());
  const bool undecided = out_of_budget || (!contact && t_lower < 1);
  const FirstContact first = contact || undecided ? FirstContact{t_lower, t_upper} : FirstContact();
  static_cast<Bracket&>(answer) =
      undecided ? engine::undecidedBracket(t_lower, first) : engine::bracketOf(first, query_.tolerance_time, false);
  // Nothing is dropped before t_lower and t_upper are known.
  if (!query_.every_pair) keepFirst(0, answer.certain ? answer.t_upper : t_lower + query_.tolerance_time);
  if (answer.status != Status::contact) w_.contacts.clear();
  for (LeafContact& own : w_.contacts) {
    if (!w_.by_engine[indexOf(own.pair)]) engine_.addWitness(problem_, query_, own);
  }
  answer.contacts = w_.contacts.data();
  answer.num_contacts = static_cast<std::int32_t>(w_.contacts.size());
}

}  // namespace

void solve(Workspace& workspace, engine::EngineWorkspace& engine, const Problem& problem, const Query& query,
           const Options& options, const std::function<const ObbTree*(std::int32_t body)>& treeOf, Answer& answer,
           Counts& counts) {
  Query& first = workspace.impl().first;
  first = query;
  first.any = false;  // if any contact would do, the first one is looked for
  PendingQuery(workspace.impl(), engine, problem, first, options, treeOf, counts).solve(answer);
}

}  // namespace redon
}  // namespace fcl_artic
