// SPDX-License-Identifier: BSD-3-Clause
//
// Searches, by queries, for the largest number with which they are free: a margin (clearance.cpp), or a factor on all
// tolerances (tolerance_left.cpp). The number is multiplied or divided by kStep until one query is free and another is
// not. Then each query halves the bracket (by ratio, as the accuracy is relative).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "model/pair_id.h"
#include "numerics/shown.h"
#include "query/engine_query.h"

namespace fcl_artic {

/// @param Queries  ArticulatedCollisionManager::MotionQueries.
/// @param Request, Found  ClearanceRequest and Clearance, or others with the members of these that are used here.
template <class Queries, class Request, class Found>
class BracketSearch {
 public:
  /// Factor between numbers while the bracket is open on one side.
  static constexpr double kStep = 4;
  virtual ~BracketSearch() = default;

 protected:
  using Context = typename Queries::Context;
  enum class Verdict { free, contact, open };
  /// Wanted of the bracket: its width is the larger one of relative * upper and absolute, or less.
  struct Accuracy {
    double relative, absolute;
    double at(double number) const { return std::max(relative * number, absolute); }
  };

  BracketSearch(const Request& request, Queries queries, const Accuracy& accuracy)
      : request_(request), accuracy_(accuracy), queries_(std::move(queries)) {}

  static void require(bool good, const char* name, double value, const char* what) {
    if (!good) throw std::invalid_argument(std::string("request.") + name + " is " + shown(value) + ", not " + what);
  }

  /// Asks with this number, and moves an end of the bracket there. `contact` is an upper end.
  virtual Verdict query(double number) = 0;
  /// The same until an end has moved. @return false: none has, and the search ends.
  virtual bool decide(double number) { return query(number) != Verdict::open; }

  /// Asks with 0, with `number`, and on from there.
  /// @return whether the bracket is as narrow as is wanted.
  bool search(double number) {
    if (query(0) == Verdict::contact) return true;
    while (decide(number)) {
      const double lower = found_.lower, end = std::min(found_.upper, least_open_);
      if (lower >= request_.most) return true;
      if (std::isfinite(end) && end - lower <= accuracy_.at(end)) return found_.upper <= end;
      number = !std::isfinite(end) ? std::min(kStep * lower, request_.most)
               : lower > 0         ? std::sqrt(lower * end)
                                   : end / kStep;
    }
    return false;
  }

  /// A number for which nothing is proven: the search goes on below it.
  /// @return whether it goes on at all.
  bool leaveOpen(double number) {
    least_open_ = std::min(least_open_, number);
    return !spent_;
  }

  /// Asks with the rest of the budget. If nothing is left of it, does not ask.
  /// @return whether there is an answer, which is in result_ then.
  bool ask(const typename Queries::Ask& query, CertifiedRequest request, const Context& context) {
    static_cast<Scope&>(request) = request_;
    if (request_.progress) request.progress = [this](double) { return request_.progress(found_.lower, found_.upper); };
    if (request_.work_budget) {
      const std::uint64_t used = countedWork(found_.statistics);
      spent_ = spent_ || used >= request_.work_budget;
      request.work_budget = request_.work_budget - used;
    }
    if (spent_) return false;
    query(request, context, result_);
    found_.statistics.pairs = result_.statistics.pairs;
    found_.statistics.pairs_after_culling += result_.statistics.pairs_after_culling;
    addWork(result_.statistics, found_.statistics);
    spent_ = result_.status == Status::undecided;
    return !spent_;
  }

  /// Finds the pairs whose initial contacts are ignored, before the search begins: they are left out of its queries. A
  /// contact does not end this query too soon: with ContactMode::first all pairs are looked at at their begin.
  /// @param request  says the margins by which it goes.
  void leaveOutInitialContacts(CertifiedRequest request) {
    request.ignore_initial_contact = true;
    request.max_contacts = 0;
    typename Context::Details details;
    Context context;
    context.details = &details;
    (void)ask(queries_.beginning, request, context);  // those that are known are named, even if it has ended early
    for (const engine::Ignored& pair : details.ignored) left_out_.push_back(pair.pair);
    found_.ignored_initial_contacts = result_.ignored_initial_contacts;
  }

  const Request request_;
  const Accuracy accuracy_;
  const Queries queries_;
  std::vector<engine::PairId> left_out_;
  CertifiedResult result_;  ///< of the last query
  Found found_;

 private:
  bool spent_ = false;  ///< the budget, or the caller's patience
  double least_open_ = std::numeric_limits<double>::infinity();
};

}  // namespace fcl_artic
