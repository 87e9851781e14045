// SPDX-License-Identifier: BSD-3-Clause
//
// A trajectory is asked piece by piece. Three things are carried over:
//
// Time. Piece k stands for T = [T_k, T_k+1] at s = (t - T_k) / h, h = T_k+1 - T_k. Each of the three steps of T_k + s h
// is rounded outward, in whatever mode, but not out of the piece: t_lower stays a proof, however large |T| is. A step
// moves by no more than 2 ulp, so an end by no more than 2 ulp of the larger |T| and 4 of h.
//
// Obstacles that move. Their motions' [0, 1] is the trajectory's time; piece k gets the part [s_k, s_k+1] of it, with
// s_k = (T_k - T_0) / (T_n - T_0) as rounded: the same number ends one piece and begins the next.
//
// Initial contacts that may separate. Pairs that touch at the very beginning are ignored. A pair has separated within a
// piece if it was free over 1/512 of the piece, the measure of one query. A pair that has not may be ignored at the
// beginning of the next piece too (Query::may_ignore); all others are watched. A pair that has separated is never
// ignored again.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "fcl_artic/manager.h"
#include "fcl_artic/trajectory.h"
#include "model/bracket.h"
#include "model/trajectory_time.h"
#include "query/claim_nothing.h"
#include "query/engine_query.h"
#include "query/manager_impl.h"
#include "query/query_context.h"

namespace fcl_artic {
namespace {

/// A piece's answer in the trajectory's time. If the piece is free, the bracket ends at the trajectory's end. If its
/// contact is not proven, the contact may begin as late as that.
Bracket inTrajectoryTime(const Bracket& part, const PieceTime& clock, double end) {
  if (part.isFree()) return {Status::free, end, end, false};
  const double proven_by = engine::provenBy(part);
  return {part.status, clock.lower(part.t_lower), proven_by <= 1 ? clock.upper(proven_by) : end, part.certain};
}

/// The time from the trajectory's begin to the k-th of its times, rounded up: a certificate states it.
double elapsedAt(const JointTrajectory& trajectory, std::size_t k) {
  const double begin = trajectory.beginTime(), time = trajectory.times()[k], elapsed = time - begin;
  if (k == 0) return 0;
  // The error of the difference is a double: that of the rounded one from both numbers.
  const double taken = time - elapsed, error = (time - (elapsed + taken)) + (taken - begin);
  return error > 0 ? std::nextafter(elapsed, HUGE_VAL) : elapsed;
}

void add(QueryStatistics& sum, const QueryStatistics& s) {
  sum.pairs += s.pairs;
  sum.pairs_after_culling += s.pairs_after_culling;
  addWork(s, sum);
  sum.total_us += s.total_us;
}

}  // namespace

void ArticulatedCollisionManager::continuousCollide(const JointTrajectory& trajectory, const CertifiedRequest& request,
                                                    CertifiedResult& result) const {
  const bool none = trajectory.numPieces() == 0;  // moved from, refused below
  const double begin = none ? 0 : trajectory.beginTime(), end = none ? 1 : trajectory.endTime();
  answerOrClaimNothing(result, begin, end, [&] { collideTrajectory(trajectory, request, QueryContext(), result); });
}

CertifiedResult ArticulatedCollisionManager::continuousCollide(const JointTrajectory& trajectory,
                                                               const CertifiedRequest& request) const {
  CertifiedResult result;
  continuousCollide(trajectory, request, result);
  return result;
}

void ArticulatedCollisionManager::collideTrajectory(const JointTrajectory& trajectory, const CertifiedRequest& request,
                                                    const QueryContext& common, CertifiedResult& result) const {
  (void)makeQuery(request);  // refuses in the caller's own numbers
  trajectory.requireOf(tree());
  const bool every_pair = request.mode == ContactMode::firstOfEveryPair;
  CertifiedResult sum;
  sum.t_upper = trajectory.endTime();
  certificate::Claim claim;
  std::vector<engine::PairId> in_contact;  // pairs of which the initial contact has not ended yet
  bool contact_found = false;
  CertifiedResult part;
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k) {
    const PieceTime clock(trajectory.times()[k], trajectory.times()[k + 1]);
    CertifiedRequest own = request;
    own.tolerance_time = std::min(1.0, std::max(request.tolerance_time / clock.duration(), 0x1p-1000));
    own.ignore_initial_contact = k == 0 ? request.ignore_initial_contact : !in_contact.empty();
    // If every pair is asked for, pieces after the first contact are searched too: they do not raise the time until
    // which all is proven free.
    const auto provenUntil = [&](double t) { return contact_found ? sum.t_lower : t; };
    if (request.progress) own.progress = [&](double s) { return request.progress(provenUntil(clock.lower(s))); };
    const std::uint64_t used = countedWork(sum.statistics);
    // A piece may be free without a single test. So the budget is checked and the caller is asked between pieces, too.
    const bool spent = request.work_budget && used >= request.work_budget;
    if (spent || (k > 0 && request.progress && !request.progress(provenUntil(clock.begin())))) {
      sum.status = Status::undecided;
      sum.certain = false;
      if (contact_found) break;  // not of every pair
      sum.t_lower = clock.begin();
      if (request.max_contacts > 0) tree().forwardKinematics(trajectory.piece(k).configuration(0), sum.M_0_at_lower);
      break;
    }
    if (request.work_budget) own.work_budget = request.work_budget - used;
    std::vector<engine::PairId> still_in_contact;
    QueryContext context = common;
    context.setPiece(trajectory, k);
    context.may_ignore = k == 0 ? nullptr : &in_contact;
    context.never_apart = &still_in_contact;
    QueryContext::Details details;
    if (request.certificate) context.details = &details;
    collideMotion(trajectory.piece(k), own, context, part);
    if (request.certificate && !contact_found) {
      impl_->appendClaim(trajectory.piece(k), context.time, own, part, details, claim);
      claim.pieces.back().clock_begin = elapsedAt(trajectory, k);
      claim.pieces.back().clock_end = elapsedAt(trajectory, k + 1);
    }
    add(sum.statistics, part.statistics);
    sum.never_apart_pairs = part.never_apart_pairs;  // so far
    if (k == 0) sum.ignored_initial_contacts = part.ignored_initial_contacts;
    in_contact = std::move(still_in_contact);

    engine::joinNextPiece(sum, inTrajectoryTime(part, clock, trajectory.endTime()), contact_found);
    if (part.isFree()) continue;
    if (!contact_found) sum.M_0_at_lower = part.M_0_at_lower;
    for (CertifiedContact& contact : part.contacts) {
      contact.t_lower = clock.lower(contact.t_lower);
      contact.t_upper = contact.certain ? clock.upper(contact.t_upper) : trajectory.endTime();
      contact.approach_speed /= clock.duration();
      sum.contacts.push_back(std::move(contact));
    }
    keepFirstOfEachPair(sum.certain, sum.contacts);
    contact_found = contact_found || part.status == Status::contact;
    if (!every_pair || part.status == Status::undecided || sum.contacts.size() >= request.max_contacts) {
      break;
    }
  }
  if (sum.contacts.size() > request.max_contacts) sum.contacts.resize(request.max_contacts);
  // A pair counts once, whichever piece leaves the range of its proof.
  std::vector<const JointMotion*> pieces;
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k) pieces.push_back(&trajectory.piece(k));
  impl_->countUnchecked(pieces.data(), pieces.size(), request, common.own_margins, sum);
  if (request.certificate && !claim.pieces.empty()) {
    claim.duration = trajectory.endTime() - trajectory.beginTime();
    sum.certificate = std::make_shared<const Certificate>(certificate::makeCertificate(*impl_->world(), claim));
  }
  result = std::move(sum);
}

}  // namespace fcl_artic
