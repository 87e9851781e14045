// SPDX-License-Identifier: BSD-3-Clause
#include "redon/redon.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "redon/solver.h"
#include "redon/swept_volumes.h"

namespace fcl_artic {
namespace redon {
namespace {

using engine::Answer;
using engine::LeafContact;
using engine::Problem;
using engine::Query;
using engine::Verdict;
using Clock = std::chrono::steady_clock;

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
  Solver solver;
  std::vector<BodyPair> pairs, one;  ///< that may touch; the one of them that is looked at
  std::vector<LeafPair> leaves;
  EquationSet equations;
  std::vector<LeafContact> contacts;

  std::vector<std::uint8_t> by_engine;  ///< by pair of the problem
  std::vector<std::uint8_t> scene_allowed, link_allowed;
  std::vector<double> still;  ///< coefficients of a motion that rests at t = 0
  Problem rest;               ///< the engine's part of the problem; stays for its pairMotion()
  std::vector<engine::Ignored> ignored;
};

Workspace::Workspace() : impl_(std::make_unique<Impl>()) {}
Workspace::~Workspace() = default;

namespace {

/// One query on its way.
class Run {
 public:
  Run(Workspace::Impl& w, void* engine_workspace, const Problem& problem, const Query& query, const Options& options,
      const std::function<const ObbTree*(std::int32_t)>& treeOf, Counts& counts)
      : w_(w),
        engine_(engine_workspace),
        problem_(problem),
        query_(query),
        options_(options),
        treeOf_(treeOf),
        counts_(counts) {}

  void solve(Answer& answer);

 private:
  int numPairs() const { return problem_.num_scene_pairs + problem_.num_link_pairs; }
  bool asked(std::int32_t pair) const;
  bool ours(std::int32_t pair) const;
  bool choosePairs();
  bool touchesAtStart(Answer& answer);
  void solveRest(Answer& answer);
  void findPairs();
  Found search(const std::vector<BodyPair>& pairs, double limit);
  void keepFirst(std::size_t begin, double bracket);

  Workspace::Impl& w_;
  void* engine_;
  const Problem& problem_;
  const Query& query_;
  const Options& options_;
  const std::function<const ObbTree*(std::int32_t)>& treeOf_;
  Counts& counts_;
};

bool Run::asked(std::int32_t pair) const {
  if (pair < problem_.num_scene_pairs) {
    return query_.check_scene && !(problem_.scene_allowed && problem_.scene_allowed[pair]);
  }
  return query_.check_self && !(problem_.link_allowed && problem_.link_allowed[pair - problem_.num_scene_pairs]);
}

/// Triangles on both sides, no margin, and a motion by joints.
bool Run::ours(std::int32_t pair) const {
  const PairParts parts = partsOf(problem_, pair);
  if (engine::marginOf(problem_, query_.margin, pair) > 0) return false;
  if (parts.step_b >= 0 && problem_.sweeps[parts.sweep].local_bounds) return false;
  return treeOf_(parts.a) && treeOf_(parts.b);
}

/// @return whether any pair is the paper's.
bool Run::choosePairs() {
  w_.by_engine.assign(static_cast<std::size_t>(numPairs()), 0);
  bool any = false;
  for (std::int32_t p = 0; p < numPairs(); ++p) {
    if (!asked(p)) continue;
    const bool own = ours(p);
    w_.by_engine[static_cast<std::size_t>(p)] = !own;
    any = any || own;
  }
  return any;
}

/// The paper starts without contact. Whether that is so, the certificate tells, at rest at t = 0: surfaces that cross,
/// and solids that hold others. A pair of which it can't be proven is the engine's.
/// @return true when the answer is contact at t = 0.
bool Run::touchesAtStart(Answer& answer) {
  const auto n = static_cast<std::size_t>(query_.num_variables);
  w_.still.assign(2 * n, 0);
  if (n) std::copy(query_.coefficients, query_.coefficients + n, w_.still.begin());
  Query still = query_;
  still.coefficients = w_.still.data();
  still.degree = 1;
  still.every_pair = query_.every_pair || query_.ignore_initial;
  still.ignore_initial = false;
  still.any = false;
  still.max_contacts = 1;
  still.progress = nullptr;
  still.refine = nullptr;
  engine::engine().solve(engine_, problem_, still, answer);
  if (answer.verdict == Verdict::free) return false;
  if (answer.verdict == Verdict::undecided || !still.every_pair) return true;
  for (int i = 0; i < answer.num_contacts; ++i) w_.by_engine[static_cast<std::size_t>(answer.contacts[i].pair)] = 1;
  return false;
}

/// The engine's pairs.
void Run::solveRest(Answer& answer) {
  w_.scene_allowed.assign(static_cast<std::size_t>(problem_.num_scene_pairs), 1);
  w_.link_allowed.assign(static_cast<std::size_t>(problem_.num_link_pairs), 1);
  std::uint64_t left = 0;
  for (std::int32_t p = 0; p < numPairs(); ++p) {
    if (!w_.by_engine[static_cast<std::size_t>(p)]) continue;
    (p < problem_.num_scene_pairs ? w_.scene_allowed[static_cast<std::size_t>(p)]
                                  : w_.link_allowed[static_cast<std::size_t>(p - problem_.num_scene_pairs)]) = 0;
    ++left;
  }
  counts_.pairs_by_standard = left;
  w_.rest = problem_;
  w_.rest.scene_allowed = w_.scene_allowed.data();
  w_.rest.link_allowed = w_.link_allowed.data();
  engine::engine().solve(engine_, w_.rest, query_, answer);
}

/// The paper's pairs that dynamic BVH culling (Section 4) leaves, and of these what culling by visibility leaves.
void Run::findPairs() {
  StageClock clock(query_.measure_times);
  w_.culling.begin(problem_, query_, options_, counts_);
  w_.culling.bodyPairs([this](std::int32_t p) { return asked(p) && !w_.by_engine[static_cast<std::size_t>(p)]; },
                       treeOf_, w_.pairs);
  clock.lap(counts_.culling_us);
  if (!query_.refine) return;
  w_.volumes.refine(problem_, query_, options_, w_.pairs, counts_);
  clock.lap(counts_.visibility_us);
}

/// All triangles of these pairs that may touch, and then all their equations on [0, 1]; or, in the order of time, one
/// sub-interval after the other.
Found Run::search(const std::vector<BodyPair>& pairs, double limit) {
  StageClock clock(query_.measure_times);
  Found found;
  w_.culling.start(pairs);
  w_.leaves.clear();
  for (int slot = 0; slot < w_.culling.numSlots(); ++slot) {
    const double begin = w_.culling.slotBegin(slot), end = w_.culling.slotBegin(slot + 1);
    if (begin > limit) break;
    const bool in_budget = w_.culling.leafPairs(pairs, slot, w_.leaves);
    clock.lap(counts_.boxes_us);
    if (!in_budget) {
      found.out_of_budget = true;
      found.t_lower = options_.in_time_order ? begin : 0;
      return found;
    }
    const bool last = slot + 1 == w_.culling.numSlots();
    if (w_.leaves.empty() || (!options_.in_time_order && !last)) continue;
    w_.equations.clear();
    w_.equations.add(pairs, w_.leaves);
    found = w_.solver.solve(pairs, w_.equations, options_.in_time_order ? begin : 0, end, limit, w_.contacts);
    clock.lap(counts_.equations_us);
    if (found.contact || found.out_of_budget || end > limit) return found;
    w_.leaves.erase(
        std::remove_if(w_.leaves.begin(), w_.leaves.end(), [&](const LeafPair& l) { return l.until <= end; }),
        w_.leaves.end());
  }
  return found;
}

/// Of the contacts from `begin` on those within the bracket, the first one first, as many as are asked for.
void Run::keepFirst(std::size_t begin, double bracket) {
  std::vector<LeafContact>& all = w_.contacts;
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
  all.erase(std::remove_if(first, all.end(), [&](const LeafContact& c) { return c.t_lower > bracket; }), all.end());
  std::stable_sort(first, all.end(), [](const LeafContact& x, const LeafContact& y) {
    if (x.certain != y.certain) return x.certain;
    return x.certain ? x.t_upper < y.t_upper : x.t_lower < y.t_lower;
  });
  all.resize(std::min(all.size(), begin + static_cast<std::size_t>(query_.max_contacts)));
}

void Run::solve(Answer& answer) {
  counts_ = Counts();
  w_.contacts.clear();
  if (!choosePairs() || touchesAtStart(answer)) {
    for (const std::uint8_t& p : w_.by_engine) counts_.pairs_by_standard += p;
    engine::engine().solve(engine_, problem_, query_, answer);
    return;
  }
  solveRest(answer);
  double limit =
      answer.verdict == Verdict::contact && !query_.every_pair ? (answer.certain ? answer.t_upper : answer.t_lower) : 2;
  double t_lower = answer.verdict == Verdict::free ? 2 : answer.t_lower;
  double t_upper = answer.verdict == Verdict::contact && answer.t_upper < 1 ? answer.t_upper : 2;
  if (answer.certain) t_upper = answer.t_upper;
  bool contact = answer.verdict == Verdict::contact, out_of_budget = answer.verdict == Verdict::undecided;
  for (int i = 0; i < answer.num_contacts; ++i) w_.contacts.push_back(answer.contacts[i]);

  const RoundUpward upward;
  w_.solver.begin(problem_, query_, options_, counts_);
  const auto take = [&](const Found& found) {
    if (found.contact || found.out_of_budget) t_lower = std::min(t_lower, found.t_lower);
    t_upper = std::min(t_upper, found.t_upper);
    contact = contact || found.contact;
    out_of_budget = out_of_budget || found.out_of_budget;
  };
  findPairs();
  if (!query_.every_pair) {
    take(search(w_.pairs, limit));
  } else {
    std::sort(w_.pairs.begin(), w_.pairs.end(), [](const BodyPair& x, const BodyPair& y) { return x.index < y.index; });
    for (std::size_t i = 0; i < w_.pairs.size() && !out_of_budget; ++i) {
      const std::size_t before = w_.contacts.size();
      w_.one.assign(1, w_.pairs[i]);
      const Found found = search(w_.one, 2);
      take(found);
      keepFirst(before, found.t_upper < 2 ? found.t_upper : found.t_lower + query_.tolerance_time);
    }
  }
  const bool certain = contact && t_upper - t_lower <= query_.tolerance_time * (1 + 1e-9);
  if (!query_.every_pair) keepFirst(0, certain ? t_upper : t_lower + query_.tolerance_time);
  answer.verdict = out_of_budget ? Verdict::undecided : contact ? Verdict::contact : Verdict::free;
  answer.certain = answer.verdict == Verdict::contact && certain;
  answer.t_lower = answer.verdict == Verdict::free ? 1 : std::min(1.0, t_lower);
  answer.t_upper = answer.verdict == Verdict::free ? 1 : std::min(1.0, t_upper);
  answer.contacts = w_.contacts.data();
  answer.num_contacts = answer.verdict == Verdict::contact ? static_cast<std::int32_t>(w_.contacts.size()) : 0;
}

}  // namespace

void solve(Workspace& workspace, void* engine_workspace, const Problem& problem, const Query& query,
           const Options& options, const std::function<const ObbTree*(std::int32_t body)>& treeOf, Answer& answer,
           Counts& counts) {
  Run(workspace.impl(), engine_workspace, problem, query, options, treeOf, counts).solve(answer);
}

}  // namespace redon
}  // namespace fcl_artic
