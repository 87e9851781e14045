// SPDX-License-Identifier: BSD-3-Clause
//
// Many motions over threads. Queries share nothing but the set-up, so this file only hands them out. If stage 2 takes
// part, it also draws for many motions at once (doc/VISIBILITY.md, "Batches").
#include <algorithm>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "fcl_artic/manager.h"
#include "query/claim_nothing.h"
#include "query/manager_impl.h"
#include "threads/parallel.h"
#include "visibility/drawing_pass.h"

namespace fcl_artic {
namespace {

using visibility::Choice;
using visibility::DrawingPass;
using visibility::ExecutorKind;
using visibility::ExecutorLoan;
using visibility::TrialPermit;

/// Most motions in a pass of drawing, and in a trial.
constexpr std::size_t kMaxMotions = 256, kMotionsOfTrial = 64;

/// Whether stage 2 takes part in such queries, and draws for many at once.
bool drawsTogether(const CertifiedRequest& request) {
  if (request.visibility == VisibilityMode::off || request.method != Method::standard || !request.check_scene) {
    return false;
  }
  return request.visibility == VisibilityMode::atOnce || request.work_budget == 0;
}

/// Adds the work of another solve of the same query.
void addSolve(const QueryStatistics& first, QueryStatistics& sum) {
  addWork(first, sum);
  sum.total_us += first.total_us;
}

}  // namespace

/// Motions that one thread answers, one after the other, or by passes of drawing.
class ArticulatedCollisionManager::BatchWithVisibility {
 public:
  /// @param request  without progress.
  BatchWithVisibility(const ArticulatedCollisionManager& manager, const JointMotion* motions,
                      const CertifiedRequest& request)
      : manager_(manager), motions_(motions), request_(request), alone_(request), stage2_(*manager.impl_->stage2) {
    alone_.visibility = VisibilityMode::off;
  }

  /// Answers n motions the way that the request asks for.
  void answer(std::size_t n, CertifiedResult* results) {
    const bool automatic = request_.visibility == VisibilityMode::automatic;
    for (std::size_t done = 0; done < n;) {
      const std::size_t left = n - done;
      if (automatic) {
        done += answerAutomatically(done, left, results + done);
      } else {
        done += answerTogether(ExecutorKind::own, done, left, results + done);
      }
    }
  }

 private:
  /// @param results  of the motions from `begin` on; so below.
  /// @return how many of them were answered.
  std::size_t answerAutomatically(std::size_t begin, std::size_t left, CertifiedResult* results) {
    Choice& choice = stage2_.batches;
    const bool made = ExecutorLoan::isMade(*stage2_.culler);
    std::size_t n = std::min(left, kMotionsOfTrial);
    const TrialPermit trial = choice.mayTry(made, static_cast<double>(n));
    ExecutorKind kind = choice.best();
    if (kind == ExecutorKind::own && !made)
      kind = ExecutorKind::none;  // a second OpenGL context saves no time: contexts take turns
    if (trial.given()) {
      answerBothWays(trial, kind, begin, n, results);
      return n;
    }
    const double start = visibility::steadyMicroseconds();
    if (kind == ExecutorKind::none) {
      n = std::min(left, kMaxMotions);
      answerAlone(begin, n, results);
    } else {
      n = answerTogether(kind, begin, left, results);
    }
    choice.addQueries(visibility::steadyMicroseconds() - start, static_cast<double>(n), 1);
    return n;
  }

  /// The answers are those without stage 2.
  void answerBothWays(const TrialPermit& trial, ExecutorKind chosen, std::size_t begin, std::size_t n,
                      CertifiedResult* results) {
    const double start = visibility::steadyMicroseconds();
    std::size_t done = 0, telling = 0;
    double stage_us = 0;
    making_us_ = 0;
    std::vector<CertifiedResult> other(n);
    while (done < n) done += answerTogether(trial.kind, begin + done, n - done, other.data() + done);
    const double middle = visibility::steadyMicroseconds();
    answerAlone(begin, n, results);
    const double without_us = visibility::steadyMicroseconds() - middle, with_us = middle - start - making_us_;
    for (std::size_t i = 0; i < n; ++i) {
      const VisibilityStatistics& s = other[i].statistics.visibility;
      stage_us += s.us;
      telling += s.pairs > 0;
      results[i].statistics.visibility = s;
      results[i].statistics.visibility.trials = 1;
    }
    const auto queries = static_cast<double>(n);
    const double own_us = chosen == ExecutorKind::none ? without_us : with_us;
    stage2_.batches.addQueries(own_us, queries, 1);
    stage2_.batches.addTrial(
        trial, {with_us, without_us, stage_us, with_us + making_us_ + without_us - own_us, telling > 0}, queries);
  }

  void answerAlone(std::size_t begin, std::size_t n, CertifiedResult* results) {
    for (std::size_t i = 0; i < n; ++i) manager_.collideMotion(motions_[begin + i], alone_, results[i]);
  }

  /// One pass of drawing. @return how many of the motions it took.
  std::size_t answerTogether(ExecutorKind kind, std::size_t begin, std::size_t left, CertifiedResult* results) {
    const double start = visibility::steadyMicroseconds();
    DrawingPass pass(*stage2_.culler, kind);
    if (pass.made()) making_us_ += visibility::steadyMicroseconds() - start;
    const std::size_t most = std::min(left, kMaxMotions);
    if (conditional_.size() < most) conditional_.resize(most);
    if (details_.size() < most) details_.resize(most);
    pass.begin(most);
    std::size_t n = 0;
    for (; n < most && (n == 0 || !pass.isFull()); ++n) {
      const engine::Advisor advisor = pass.assume(n, request_.tolerance_distance);
      solve(begin + n, advisor, details_[n], conditional_[n]);
    }
    pass.draw();
    for (std::size_t i = 0; i < n; ++i) settle(pass, i, begin + i, results[i]);
    return n;
  }

  void solve(std::size_t motion, const engine::Advisor& advisor, QueryContext::Details& details,
             CertifiedResult& result) {
    QueryContext context;
    context.stage2 = &advisor;
    if (request_.certificate) context.details = &details;
    manager_.collideMotion(motions_[motion], alone_, context, result);
  }

  /// Answers motion i of the pass: with the answer that was found on a condition if the condition holds, else with
  /// another one.
  void settle(DrawingPass& pass, std::size_t i, std::size_t motion, CertifiedResult& result) {
    CertifiedResult& conditional = conditional_[i];
    const bool at_once = request_.visibility == VisibilityMode::atOnce;
    const bool plainly_free = conditional.isFree() && conditional.ignored_initial_contacts.empty();
    const visibility::QueryVolumes* const volumes = pass.volumes(i);
    const bool holds = pass.allFree(i) && (at_once || plainly_free || !volumes);
    if (holds) {
      std::swap(result, conditional);
    } else if (at_once) {
      solve(motion, pass.advise(i), details_[i], result);
      addSolve(conditional.statistics, result.statistics);
    } else {
      QueryContext context;
      if (request_.certificate) context.details = &details_[i];
      manager_.collideMotion(motions_[motion], alone_, context, result);
      addSolve(conditional.statistics, result.statistics);
    }
    manager_.impl_->finishAnswer(motions_[motion], alone_, details_[i], result);
    if (!volumes) return;
    VisibilityStatistics& s = result.statistics.visibility;
    s = volumes->work();
    if (!at_once) s.nodes = 0;
    s.repeated = !holds && !at_once;
    s.us = pass.microseconds(i);
    result.statistics.visibility_executor = pass.executor();
    result.statistics.visibility_fallback = stage2_.culler->fallbackReason();
    if (request_.measure_times) result.statistics.total_us += pass.drawingMicroseconds(i);
  }

  const ArticulatedCollisionManager& manager_;
  const JointMotion* motions_;
  const CertifiedRequest& request_;
  CertifiedRequest alone_;  ///< the same without stage 2
  Stage2& stage2_;
  double making_us_ = 0;  ///< of executors
  // One entry for each motion of a pass. An entry of `conditional_` is no answer before settle() has looked at it.
  std::vector<CertifiedResult> conditional_;
  std::vector<QueryContext::Details> details_;
};

void ArticulatedCollisionManager::continuousCollide(const std::vector<JointMotion>& motions,
                                                    const CertifiedRequest& request,
                                                    std::vector<CertifiedResult>& results, int threads) const {
  const auto reset = [&] {
    for (CertifiedResult& result : results) claimNothing(result);
  };
  for (CertifiedResult& result : results) withdrawClaims(result, 0, 1);
  resetUnlessAnswered(reset, [&] {
    if (threads < 0) {
      throw std::invalid_argument("continuousCollide: the number of threads is " + std::to_string(threads));
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!motions[i].isOf(tree())) motions[i].requireOf(tree(), ("motion " + std::to_string(i)).c_str());
    }
    CertifiedRequest alike = request;
    alike.progress = nullptr;
    results.resize(motions.size());
    if (!drawsTogether(alike) || motions.size() < 2) {
      parallelFor(motions.size(), threads, [&](std::size_t i) { collideMotion(motions[i], alike, results[i]); });
      return;
    }
    const std::size_t each =
        std::clamp((motions.size() + threadsFor(threads) - 1) / threadsFor(threads), std::size_t{1}, kMaxMotions);
    parallelFor((motions.size() + each - 1) / each, threads, [&](std::size_t k) {
      const std::size_t begin = k * each;
      BatchWithVisibility(*this, motions.data() + begin, alike)
          .answer(std::min(each, motions.size() - begin), results.data() + begin);
    });
  });
}

}  // namespace fcl_artic
