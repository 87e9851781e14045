// SPDX-License-Identifier: BSD-3-Clause
//
// The clearance of a motion, by queries with margins. A free query proves that nothing comes nearer than its margin. A
// pose proven in contact shows a pair and a time with no more than the margin between the two bodies. The margin is
// divided by kStep until a query is free; then each query halves the bracket (by ratio, as the tolerance is relative).
// Measured on a planner's motions: looking at single poses in between, for a tighter upper bound, costs as much as it
// saves.
#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "fcl_artic/clearance.h"
#include "fcl_artic/manager.h"
#include "numerics/assertion.h"
#include "numerics/shown.h"
#include "query/engine_query.h"
#include "query/query_context.h"

namespace fcl_artic {
namespace {

/// Factor between margins while no query is free.
constexpr double kStep = 4;
/// A query may leave open pairs that are nearer to its margin than this part of the tolerance. (The margin is at least
/// half the tolerance below `upper`, so a margin larger by this part is below `upper`, too.)
constexpr double kOpen = 1.0 / 8;

void require(bool good, const char* name, double value, const char* what) {
  if (!good) throw std::invalid_argument(std::string("request.") + name + " is " + shown(value) + ", not " + what);
}

using Pairs = std::vector<engine::PairId>;

/// The pairs that a query ignores.
/// @param context  of the query.
/// @param collide  asks it.
template <class Context, class Collide>
Pairs pairsIgnored(Context context, const Collide& collide) {
  typename Context::Details details;
  context.details = &details;
  collide(context);
  Pairs pairs;
  for (const engine::Ignored& pair : details.ignored) pairs.push_back(pair.pair);
  return pairs;
}

class Search {
 public:
  using Ask = std::function<void(const CertifiedRequest& request, const Pairs& left_out, CertifiedResult& result)>;
  using AskBegin = std::function<Pairs(const CertifiedRequest& request, CertifiedResult& result)>;
  /// @param duration  of the motion, in the unit that its times are in.
  /// @param ask  a query without the pairs' own margins.
  /// @param askBegin  a query, with the pairs' own margins, in which initial contacts are ignored. @return these pairs:
  ///   they are left out of the others.
  Search(const ClearanceRequest& request, double duration, Ask ask, AskBegin askBegin)
      : request_(request), duration_(duration), ask_(std::move(ask)), ask_begin_(std::move(askBegin)) {
    require(request.tolerance_relative >= 0 && request.tolerance_relative < 1, "tolerance_relative",
            request.tolerance_relative, "a number from 0 to below 1");
    require(std::isfinite(request.tolerance_distance) && request.tolerance_distance > 0, "tolerance_distance",
            request.tolerance_distance, "a positive number");
    require(std::isfinite(request.most) && request.most > 0, "most", request.most, "a positive number");
    require(std::isfinite(request.ignored_margin) && request.ignored_margin >= 0, "ignored_margin",
            request.ignored_margin, "a number >= 0");
  }

  Clearance run() {
    if (request_.ignore_initial_contact) ignoreInitialContacts();
    found_.within_tolerance = query(0) == Verdict::contact;
    double margin = request_.most;
    while (!found_.within_tolerance && decide(margin)) {
      found_.within_tolerance = found_.lower >= request_.most || found_.upper - found_.lower <= tolerance(found_.upper);
      margin = found_.lower > 0 ? std::sqrt(found_.lower * found_.upper) : found_.upper / kStep;
    }
    return found_;
  }

 private:
  enum class Verdict { free, contact, open };

  double tolerance(double distance) const {
    return std::max(request_.tolerance_relative * distance, request_.tolerance_distance);
  }

  /// Asks with this margin; if the answer is open, with a slightly larger one.
  bool decide(double margin) {
    return query(margin) != Verdict::open || query(margin + kOpen * tolerance(margin)) != Verdict::open;
  }

  /// Asks with the rest of the budget. If nothing is left of it, sets spent_ and does not ask.
  template <class AskQuery>
  void answer(CertifiedRequest& request, const AskQuery& ask) {
    static_cast<Scope&>(request) = request_;
    if (request_.progress) request.progress = [this](double) { return request_.progress(found_.lower, found_.upper); };
    if (request_.work_budget) {
      const std::uint64_t used = countedWork(found_.statistics);
      spent_ = used >= request_.work_budget;
      if (spent_) return;
      request.work_budget = request_.work_budget - used;
    }
    ask();
    found_.statistics.pairs = result_.statistics.pairs;
    found_.statistics.pairs_after_culling += result_.statistics.pairs_after_culling;
    addWork(result_.statistics, found_.statistics);
    spent_ = result_.status == Status::undecided;
  }

  /// Finds the pairs whose initial contacts are ignored, before the search begins. A contact does not end this query
  /// too soon: with ContactMode::first all pairs are looked at at their begin.
  void ignoreInitialContacts() {
    CertifiedRequest request;
    request.margin = request_.ignored_margin;
    request.ignore_initial_contact = true;
    request.max_contacts = 0;
    answer(request, [&] { left_out_ = ask_begin_(request, result_); });
    found_.ignored_initial_contacts = result_.ignored_initial_contacts;
  }

  Verdict query(double margin) {
    if (spent_) return Verdict::open;
    CertifiedRequest request;
    request.margin = margin;
    request.tolerance_time *= duration_;
    request.mode = ContactMode::any;
    request.tolerance_distance = margin > 0 ? kOpen * tolerance(margin) : request.tolerance_distance;
    answer(request, [&] { ask_(request, left_out_, result_); });
    if (spent_) return Verdict::open;
    if (result_.isFree()) {
      found_.lower = std::max(found_.lower, margin);
      return Verdict::free;
    }
    const auto proven = std::find_if(result_.contacts.begin(), result_.contacts.end(),
                                     [](const CertifiedContact& contact) { return contact.certain; });
    if (proven == result_.contacts.end()) return Verdict::open;
    FCL_ARTIC_ASSERT(found_.lower <= margin);
    found_.upper = margin;
    found_.time = proven->t_upper;
    found_.body1 = proven->body1;
    found_.body2 = proven->body2;
    return Verdict::contact;
  }

  ClearanceRequest request_;
  double duration_;
  Ask ask_;
  AskBegin ask_begin_;
  Pairs left_out_;
  CertifiedResult result_;
  Clearance found_;
  bool spent_ = false;
};

}  // namespace

Clearance ArticulatedCollisionManager::clearance(const JointMotion& motion, const ClearanceRequest& request) const {
  const auto ask = [&](const CertifiedRequest& asked, const Pairs& left_out, CertifiedResult& result) {
    collideMotion(motion, asked, QueryContext::ofClearance(left_out), result);
  };
  const auto ask_begin = [&](const CertifiedRequest& asked, CertifiedResult& result) {
    return pairsIgnored(QueryContext(),
                        [&](const QueryContext& context) { collideMotion(motion, asked, context, result); });
  };
  return Search(request, 1, ask, ask_begin).run();
}

Clearance ArticulatedCollisionManager::clearance(const JointTrajectory& trajectory,
                                                 const ClearanceRequest& request) const {
  trajectory.requireOf(tree());
  const auto ask = [&](const CertifiedRequest& asked, const Pairs& left_out, CertifiedResult& result) {
    collideTrajectory(trajectory, asked, QueryContext::ofClearance(left_out), result);
  };
  const auto ask_begin = [&](const CertifiedRequest& asked, CertifiedResult& result) {
    QueryContext first;
    first.setPiece(trajectory, 0);
    return pairsIgnored(
        first, [&](const QueryContext& context) { collideMotion(trajectory.piece(0), asked, context, result); });
  };
  return Search(request, trajectory.endTime() - trajectory.beginTime(), ask, ask_begin).run();
}

}  // namespace fcl_artic
