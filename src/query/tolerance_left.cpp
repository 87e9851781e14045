// SPDX-License-Identifier: BSD-3-Clause
//
// How many times all tolerances may be as large, by queries that multiply them (doc/NUMERICS.md, "A factor on all
// tolerances"). The search begins with the tolerances as they are set.
#include "fcl_artic/tolerance_left.h"

#include <algorithm>
#include <cmath>

#include "fcl_artic/manager.h"
#include "numerics/assertion.h"
#include "numerics/constants.h"
#include "query/bracket_search.h"
#include "query/manager_impl.h"
#include "query/query_context.h"

namespace fcl_artic {
namespace {

template <class Queries>
class ToleranceSearch : BracketSearch<Queries, ToleranceLeftRequest, ToleranceLeft> {
  using Base = BracketSearch<Queries, ToleranceLeftRequest, ToleranceLeft>;
  using Base::found_, Base::request_, Base::result_, Base::queries_, Base::left_out_;
  using typename Base::Verdict;

 public:
  ToleranceSearch(const ToleranceLeftRequest& request, Queries queries)
      : Base(request, std::move(queries), {request.accuracy_relative, request.accuracy_factor}) {
    Base::require(request.accuracy_relative >= 0 && request.accuracy_relative < 1, "accuracy_relative",
                  request.accuracy_relative, "a number from 0 to below 1");
    Base::require(std::isfinite(request.accuracy_factor) && request.accuracy_factor > 0, "accuracy_factor",
                  request.accuracy_factor, "a positive number");
    Base::require(request.most > 0 && request.most <= 1e6, "most", request.most, "a number above 0 and at most 1e6");
    (void)makeQuery(queryRequest());  // refuses in the caller's own numbers
  }

  ToleranceLeft run() {
    if (request_.ignore_initial_contact) Base::leaveOutInitialContacts(queryRequest());
    found_.within_accuracy = Base::search(std::min(1.0, request_.most));
    return found_;
  }

 private:
  CertifiedRequest queryRequest() const {
    CertifiedRequest request;
    static_cast<Tolerances&>(request) = request_;
    return request;
  }

  Verdict query(double factor) override {
    // Products of factor and tolerance are rounded: by no more than this.
    const double asked = factor == 1 ? 1 : factor * (1 + 2 * kUlp);
    typename Base::Context context;
    context.stray_factor = asked;
    context.left_out = &left_out_;
    if (!Base::ask(queries_.whole, queryRequest(), context)) return Verdict::open;
    if (result_.isFree()) {
      found_.lower = std::max(found_.lower, factor);
      return Verdict::free;
    }
    found_.upper = asked;
    FCL_ARTIC_ASSERT(result_.first());
    const CertifiedContact& contact = *result_.first();
    found_.certain = contact.certain;
    found_.time = contact.certain ? contact.t_upper : contact.t_lower;
    found_.body1 = contact.body1;
    found_.body2 = contact.body2;
    static_cast<ToleranceWitness&>(found_) = contact;
    return Verdict::contact;
  }
};

/// @throws std::logic_error where there is no tolerance.
void requireStrays(const Setup& setup) {
  if (setup.strays()) return;
  throw std::logic_error(
      "toleranceLeft() asks how many times the manager's tolerances are still free, and it has none: call "
      "setJointTolerances(), setBaseTolerance() or setObjectTolerance() with numbers above 0, then setup()");
}

}  // namespace

ToleranceLeft ArticulatedCollisionManager::toleranceLeft(const JointMotion& motion,
                                                         const ToleranceLeftRequest& request) const {
  impl_->requireReady();
  requireStrays(impl_->setup);
  return ToleranceSearch(request, queriesOf(motion)).run();
}

ToleranceLeft ArticulatedCollisionManager::toleranceLeft(const JointTrajectory& trajectory,
                                                         const ToleranceLeftRequest& request) const {
  impl_->requireReady();
  requireStrays(impl_->setup);
  return ToleranceSearch(request, queriesOf(trajectory)).run();
}

}  // namespace fcl_artic
