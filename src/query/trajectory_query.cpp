// SPDX-License-Identifier: BSD-3-Clause
//
// A trajectory is asked piece by piece. What has to be carried over:
//
// Time. Piece k stands for T = [T_k, T_k+1] at s = (t - T_k) / h, h = T_k+1 - T_k. A computed T_k + s h is off by less than
// 4 ulp of the larger |T|: the difference, the product and the sum round by half an ulp each of numbers up to twice that.
// Ends are moved outward by as much, but not out of the piece.
//
// Obstacles that move. Their motions' [0, 1] is the trajectory's time; piece k gets the part [s_k, s_k+1] of it, with
// s_k = (T_k - T_0) / (T_n - T_0) as rounded: the same number ends one piece and begins the next.
//
// Initial contacts that may separate. Pairs that touch at the very beginning are ignored; those that did not separate
// within a piece (by the measure of one query: free over 1/512 of the piece) are ignored at the beginning of the next one
// too, all others are watched: a query ignores whatever touches at its t = 0, so that what it ignores beyond the pairs
// carried over is asked for once more without ignoring anything. A pair that has separated is never ignored again.

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "fcl_artic/manager.h"
#include "fcl_artic/trajectory.h"
#include "query/aspects.h"
#include "query/claim_nothing.h"
#include "query/engine_query.h"

namespace fcl_artic {
namespace {

/// Two bodies. Geometries of one link share its name; names of obstacles are all different.
using Body = std::pair<const fcl::CollisionObjectd*, std::string>;
using Bodies = std::pair<Body, Body>;
Bodies bodiesOf(const BodyRef& a, const BodyRef& b) {
  const Body x(a.object, a.name), y(b.object, b.name);
  return x < y ? Bodies(x, y) : Bodies(y, x);
}

/// From the time of a piece to that of the trajectory.
struct Clock {
  double begin, end;
  double at(double s) const { return begin + s * (end - begin); }
  double error() const { return 4 * 0x1p-52 * std::max(std::abs(begin), std::abs(end)); }
  double lower(double s) const { return s <= 0 ? begin : s >= 1 ? end : std::min(end, std::max(begin, at(s) - error())); }
  double upper(double s) const { return s <= 0 ? begin : s >= 1 ? end : std::min(end, std::max(begin, at(s) + error())); }
};

/// Part of the whole trajectory's time that a piece takes.
TimePart partOfTime(const JointTrajectory& trajectory, std::size_t piece) {
  const double begin = trajectory.beginTime(), duration = trajectory.endTime() - begin;
  const auto at = [&](std::size_t k) {
    return k == trajectory.numPieces() ? 1 : std::min(1.0, (trajectory.times()[k] - begin) / duration);
  };
  return {at(piece), at(piece + 1)};
}

void add(QueryStatistics& sum, const QueryStatistics& s) {
  sum.pairs += s.pairs;
  sum.pairs_after_culling += s.pairs_after_culling;
  addWork(s, sum);
  sum.total_us += s.total_us;
}

/// Contacts of pairs that a query ignored though they may not be, found by a query that ignores nothing, belong to the
/// first one's answer.
/// @param tolerance_time  of the piece.
void addContacts(const CertifiedResult& all, const std::set<Bodies>& wrongly, const CertifiedRequest& request,
                 double tolerance_time, CertifiedResult& result) {
  if (all.status == Status::undecided) result.status = Status::undecided;
  double first = 2;
  for (const CertifiedContact& contact : all.contacts) {
    if (!wrongly.count(bodiesOf(contact.body1, contact.body2))) continue;
    first = std::min(first, contact.t_lower);
    result.contacts.push_back(contact);
  }
  std::stable_sort(result.contacts.begin(), result.contacts.end(),
                   [](const CertifiedContact& a, const CertifiedContact& b) { return a.t_lower < b.t_lower; });
  if (all.status == Status::undecided) {
    result.t_lower = std::min(result.t_lower, all.t_lower);
    result.certain = false;
    return;
  }
  if (first > 1 || result.status == Status::undecided) return;
  result.status = Status::contact;
  if (first < result.t_lower) {
    result.t_lower = first;
    result.M_0_at_lower = all.M_0_at_lower;
  }
  for (const CertifiedContact& contact : result.contacts) {
    if (contact.certain) result.t_upper = std::min(result.t_upper, contact.t_upper);
  }
  result.certain = result.t_upper - result.t_lower <= tolerance_time;
  if (request.mode != ContactMode::firstOfEveryPair) {
    const double end = result.certain ? result.t_upper : result.t_lower + tolerance_time;
    const auto later = [&](const CertifiedContact& contact) { return contact.t_lower > end; };
    result.contacts.erase(std::remove_if(result.contacts.begin(), result.contacts.end(), later), result.contacts.end());
  }
}

}  // namespace

void ArticulatedCollisionManager::continuousCollide(const JointTrajectory& trajectory, const CertifiedRequest& request,
                                                    CertifiedResult& result) const {
  const bool none = trajectory.numPieces() == 0;  // moved from, refused below
  const double begin = none ? 0 : trajectory.beginTime(), end = none ? 1 : trajectory.endTime();
  resetAndAnswer([&] { claimNothing(result, begin, end); },
                 [&] { collideTrajectory(trajectory, request, true, result); });
}

void ArticulatedCollisionManager::collideTrajectory(const JointTrajectory& trajectory, const CertifiedRequest& request,
                                                    bool own_margins, CertifiedResult& result) const {
  (void)makeQuery(request);  // refuses in the caller's own numbers
  trajectory.requireOf(tree());
  const bool every_pair = request.mode == ContactMode::firstOfEveryPair;
  CertifiedResult sum;
  sum.t_upper = trajectory.endTime();
  std::set<Bodies> carried, seen;
  bool contact_found = false;
  CertifiedResult part;
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k) {
    const Clock clock = {trajectory.times()[k], trajectory.times()[k + 1]};
    CertifiedRequest own = request;
    own.tolerance_time = std::min(1.0, std::max(request.tolerance_time / (clock.end - clock.begin), 0x1p-1000));
    own.ignore_initial_contact = k == 0 ? request.ignore_initial_contact : !carried.empty();
    if (request.progress) own.progress = [&](double s) { request.progress(clock.lower(s)); };
    const std::uint64_t used = sum.statistics.node_tests + sum.statistics.leaf_tests;
    if (request.work_budget) {
      if (used >= request.work_budget) {
        if (contact_found) break;
        sum.status = Status::undecided;
        sum.t_lower = clock.begin;
        tree().forwardKinematics(trajectory.piece(k).configuration(0), sum.M_0_at_lower);
        break;
      }
      own.work_budget = request.work_budget - used;
    }
    std::vector<bool> never_apart;
    Aspects aspects;
    aspects.time = partOfTime(trajectory, k);
    aspects.own_margins = own_margins;
    aspects.never_apart = &never_apart;
    collideMotion(trajectory.piece(k), own, aspects, part);
    add(sum.statistics, part.statistics);
    if (k == 0) sum.ignored_initial_contacts = part.ignored_initial_contacts;

    std::set<Bodies> still, wrongly;
    for (std::size_t i = 0; i < part.ignored_initial_contacts.size(); ++i) {
      const auto& [a, b] = part.ignored_initial_contacts[i];
      const Bodies pair = bodiesOf(a, b);
      if (k > 0 && !carried.count(pair)) {
        if (!seen.count(pair)) wrongly.insert(pair);
      } else if (never_apart[i]) {
        still.insert(pair);
      }
    }
    if (!wrongly.empty()) {
      CertifiedRequest again = own;
      again.ignore_initial_contact = false;
      again.mode = ContactMode::firstOfEveryPair;
      again.max_contacts = 1u << 20;
      CertifiedResult all;
      aspects.never_apart = nullptr;
      collideMotion(trajectory.piece(k), again, aspects, all);
      add(sum.statistics, all.statistics);
      addContacts(all, wrongly, request, own.tolerance_time, part);
    }
    carried = std::move(still);

    if (part.status == Status::free) {
      if (contact_found) continue;
      sum.status = Status::free;
      sum.t_lower = sum.t_upper = trajectory.endTime();
      sum.certain = part.certain;
      continue;
    }
    if (!contact_found) {
      sum.status = part.status;
      sum.t_lower = clock.lower(part.t_lower);
      // 1 may mean that nothing is proven.
      sum.t_upper = part.certain || part.t_upper < 1 ? clock.upper(part.t_upper) : trajectory.endTime();
      sum.certain = part.certain;
      sum.M_0_at_lower = part.M_0_at_lower;
    }
    for (CertifiedContact& contact : part.contacts) {
      if (sum.contacts.size() >= request.max_contacts) break;
      if (every_pair && seen.count(bodiesOf(contact.body1, contact.body2))) continue;
      contact.t_lower = clock.lower(contact.t_lower);
      contact.t_upper = contact.certain ? clock.upper(contact.t_upper) : trajectory.endTime();
      sum.contacts.push_back(contact);
    }
    for (const CertifiedContact& contact : sum.contacts) seen.insert(bodiesOf(contact.body1, contact.body2));
    contact_found = contact_found || part.status == Status::contact;
    if (!every_pair || part.status == Status::undecided || sum.contacts.size() >= request.max_contacts) break;
  }
  result = std::move(sum);
}

}  // namespace fcl_artic
