// SPDX-License-Identifier: BSD-3-Clause
//
// The clearance of a motion, by queries with margins. A free query proves that nothing comes nearer than its margin. A
// pose proven in contact shows a pair and a time with no more than the margin between the two bodies. The search begins
// at the largest margin of interest. Measured on a planner's motions: looking at single poses in between, for a tighter
// upper bound, costs as much as it saves.
#include "fcl_artic/clearance.h"

#include <algorithm>
#include <cmath>

#include "fcl_artic/manager.h"
#include "numerics/assertion.h"
#include "query/bracket_search.h"
#include "query/query_context.h"

namespace fcl_artic {
namespace {

/// A query may leave open pairs that are nearer to its margin than this part of the tolerance. (The margin is at least
/// half the tolerance below `upper`, so a margin larger by this part is below `upper`, too.)
constexpr double kOpen = 1.0 / 8;

template <class Queries>
class ClearanceSearch : BracketSearch<Queries, ClearanceRequest, Clearance> {
  using Base = BracketSearch<Queries, ClearanceRequest, Clearance>;
  using Base::found_, Base::request_, Base::result_, Base::accuracy_, Base::queries_, Base::left_out_;
  using typename Base::Verdict;

 public:
  ClearanceSearch(const ClearanceRequest& request, Queries queries)
      : Base(request, std::move(queries), {request.tolerance_relative, request.tolerance_distance}) {
    Base::require(request.tolerance_relative >= 0 && request.tolerance_relative < 1, "tolerance_relative",
                  request.tolerance_relative, "a number from 0 to below 1");
    Base::require(std::isfinite(request.tolerance_distance) && request.tolerance_distance > 0, "tolerance_distance",
                  request.tolerance_distance, "a positive number");
    Base::require(std::isfinite(request.most) && request.most > 0, "most", request.most, "a positive number");
    Base::require(std::isfinite(request.ignored_margin) && request.ignored_margin >= 0, "ignored_margin",
                  request.ignored_margin, "a number >= 0");
  }

  Clearance run() {
    if (request_.ignore_initial_contact) {
      CertifiedRequest at_begin;
      at_begin.margin = request_.ignored_margin;
      Base::leaveOutInitialContacts(at_begin);
    }
    found_.within_tolerance = Base::search(request_.most);
    return found_;
  }

 private:
  /// Asks with this margin; if the answer is open, with a slightly larger one. (With tolerances it is mostly open near
  /// the largest margin that is free: the bound takes the worst of all joints at once.)
  bool decide(double margin) override {
    return query(margin) != Verdict::open || query(margin + kOpen * accuracy_.at(margin)) != Verdict::open ||
           Base::leaveOpen(margin);
  }

  Verdict query(double margin) override {
    CertifiedRequest request;
    request.margin = margin;
    request.tolerance_time *= queries_.duration;
    request.mode = ContactMode::any;
    request.tolerance_distance = margin > 0 ? kOpen * accuracy_.at(margin) : request.tolerance_distance;
    typename Base::Context context;
    context.own_margins = false;
    context.left_out = &left_out_;
    if (!Base::ask(queries_.whole, request, context)) return Verdict::open;
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
};

}  // namespace

ArticulatedCollisionManager::MotionQueries ArticulatedCollisionManager::queriesOf(const JointMotion& motion) const {
  const auto ask = [this, &motion](const CertifiedRequest& request, const QueryContext& context,
                                   CertifiedResult& result) { collideMotion(motion, request, context, result); };
  return {1, ask, ask};
}

ArticulatedCollisionManager::MotionQueries ArticulatedCollisionManager::queriesOf(
    const JointTrajectory& trajectory) const {
  trajectory.requireOf(tree());
  return {trajectory.endTime() - trajectory.beginTime(),
          [&, this](const CertifiedRequest& request, const QueryContext& context, CertifiedResult& result) {
            collideTrajectory(trajectory, request, context, result);
          },
          [&, this](const CertifiedRequest& request, QueryContext context, CertifiedResult& result) {
            context.setPiece(trajectory, 0);
            collideMotion(trajectory.piece(0), request, context, result);
          }};
}

Clearance ArticulatedCollisionManager::clearance(const JointMotion& motion, const ClearanceRequest& request) const {
  return ClearanceSearch(request, queriesOf(motion)).run();
}

Clearance ArticulatedCollisionManager::clearance(const JointTrajectory& trajectory,
                                                 const ClearanceRequest& request) const {
  return ClearanceSearch(request, queriesOf(trajectory)).run();
}

}  // namespace fcl_artic
