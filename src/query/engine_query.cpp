// SPDX-License-Identifier: BSD-3-Clause
#include "query/engine_query.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "fcl/fcl_geometry.h"
#include "model/add_fields.h"
#include "narrowphase/engine.h"
#include "numerics/require.h"
#include "numerics/shown.h"
#include "redon/options.h"

namespace fcl_artic {
WorkspaceLoan::WorkspaceLoan() {
  thread_local QueryWorkspace own;
  if (own.busy_) other_ = std::make_unique<QueryWorkspace>();
  workspace_ = other_ ? other_.get() : &own;
  workspace_->busy_ = true;
}

engine::Margins marginsOf(const Tolerances& request) {
  requireNotNegative(request.margin, "request.margin");
  requireNotNegative(request.added_margin, "request.added_margin");
  requireNotNegative(request.margin + request.added_margin, "request.margin + added_margin");
  return engine::Margins(request.margin, request.added_margin);
}

engine::Query makeQuery(const CertifiedPairRequest& request) {
  requirePositive(request.tolerance_time, "request.tolerance_time");
  requirePositive(request.tolerance_distance, "request.tolerance_distance");
  const engine::Margins margins = marginsOf(request);
  const int level = request.redon.refinement_level;
  if (level < -1 || level > 6) {
    throw std::invalid_argument("request.redon.refinement_level is " + std::to_string(level) + ", not in [-1, 6]");
  }
  engine::Query query;
  query.tolerance_time = request.tolerance_time;
  query.tolerance_distance = request.tolerance_distance;
  query.margins = margins;
  query.every_pair = request.mode == ContactMode::firstOfEveryPair;
  // The paper's method looks for the first contact, so the pairs that it leaves to the standard one are asked for
  // theirs, too.
  query.any = request.mode == ContactMode::any && request.method == Method::standard;
  query.ignore_initial = request.ignore_initial_contact;
  query.measure_times = request.measure_times;
  // A link may have several geometries. So if more than one contact is asked for, all are found, and
  // keepFirstOfEachPair() chooses.
  query.max_contacts = request.max_contacts <= 1 ? static_cast<std::int32_t>(request.max_contacts) : 1 << 20;
  query.work_budget = request.work_budget;
  if (request.progress) {
    query.progress = [](void* context, double t_lower) {
      return static_cast<const CertifiedPairRequest*>(context)->progress(t_lower);
    };
    query.progress_context = const_cast<CertifiedPairRequest*>(&request);
  }
  return query;
}

QueryStatistics statisticsOf(const engine::Statistics& s) {
  QueryStatistics out;
  static_cast<StandardStatistics&>(out) = s;
  out.pairs = s.pairs;
  out.pairs_after_culling = s.pairs_after_culling;
  return out;
}

void addWork(const QueryStatistics& s, QueryStatistics& sum) {
  engine::addFields<StandardStatistics>(s, sum);
  engine::addFields(s.visibility, sum.visibility);
  if (!s.visibility_executor.empty()) sum.visibility_executor = s.visibility_executor;
  if (!s.visibility_fallback.empty()) sum.visibility_fallback = s.visibility_fallback;
  engine::addFields(s.redon, sum.redon);
  sum.report_us += s.report_us;
}

std::uint64_t countedWork(const QueryStatistics& s) {
  return s.node_tests + s.leaf_tests + redon::workOf(s.redon);
}

void keepFirstOfEachPair(bool certain, std::vector<CertifiedContact>& contacts) {
  if (contacts.size() < 2) return;
  std::stable_sort(contacts.begin(), contacts.end(), [](const CertifiedContact& x, const CertifiedContact& y) {
    return std::make_tuple(x.t_lower, !x.certain, x.t_upper) < std::make_tuple(y.t_lower, !y.certain, y.t_upper);
  });
  if (certain) {
    // The contact that proves the answer comes first. Another contact, which is not proven or is proven later, may
    // begin a little earlier. The bracket of the first one then begins with that one's. This stays true: a pair that is
    // free before a time is free before any earlier time.
    const auto proof = std::min_element(contacts.begin(), contacts.end(), [](const auto& x, const auto& y) {
      return std::make_tuple(!x.certain, x.t_upper) < std::make_tuple(!y.certain, y.t_upper);
    });
    if (proof->certain) {
      proof->t_lower = contacts.front().t_lower;
      std::rotate(contacts.begin(), proof, proof + 1);
    }
  }
  std::set<std::pair<std::string, std::string>> seen;
  const auto again = [&](const CertifiedContact& contact) {
    return !seen.insert(std::minmax(contact.body1.name, contact.body2.name)).second;
  };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), again), contacts.end());
}

}  // namespace fcl_artic
