// SPDX-License-Identifier: BSD-3-Clause
//
// The first root of all elementary equations at once (Redon 2004, Sections 5.2.2 to 5.2.4), or of each by itself. Runs
// under RoundUpward.
#pragma once

#include <vector>

#include "model/answer.h"
#include "model/bracket.h"
#include "redon/equations.h"

namespace fcl_artic {
namespace redon {

/// The proof of a search: nothing, until it says so.
struct SearchOutcome {
  bool contact = false, out_of_budget = false;
  double free_until = 0;            ///< no contact before; what was not looked at is not free
  double t_upper = engine::kNever;  ///< contact is proven to be no later; kNever: none is
};

/// A contact that begins later than this is not the first one, where this one is found.
inline double latestBegin(const SearchOutcome& outcome, double tolerance_time) {
  return outcome.t_upper < engine::kNever ? outcome.t_upper : outcome.free_until + tolerance_time;
}

class RootSolver {
 public:
  void begin(const engine::Problem& problem, const engine::Query& query, const Options& options, Counts& counts);
  /// First contact in [begin, end], which the pairs enter without contact.
  /// @param limit  what begins later does not matter, and is not looked at.
  /// @param free_else  no contact of what is not among these equations before this time.
  /// @param[out] contacts  all valid roots of the time interval in which the first was found are appended.
  SearchOutcome solve(const std::vector<BodyPair>& pairs, EquationSet& equations, double begin, double end,
                      double limit, double free_else, std::vector<engine::LeafContact>& contacts);

 private:
  /// An equation that may have a root in [lo, hi].
  struct Active {
    std::int32_t equation;
    double lo, hi;
  };
  /// Part of the active equations, waiting for their time.
  struct OpenInterval {
    double begin, end;
    std::size_t first, count;  ///< in active_
  };
  SearchOutcome search(std::size_t first, double begin, double end, double limit,
                       std::vector<engine::LeafContact>& contacts);
  void setInterval(double begin, double end);
  const PairBounds& motionOf(std::int32_t pair);
  void boundElements(const Equation& q);
  bool mayHaveRoot(Active& active, double begin, double end, bool validity);
  bool settle(const OpenInterval& interval, std::size_t end, SearchOutcome& outcome,
              std::vector<engine::LeafContact>& contacts);
  bool certify(const Equation& q, double begin, double end, double& t_upper);
  void report(const Equation& q, double begin, bool certain, double t_upper,
              std::vector<engine::LeafContact>& contacts);
  Interval valueAt(const Equation& q, double t);

  const engine::Problem* problem_ = nullptr;
  const engine::Query* query_ = nullptr;
  const Options* options_ = nullptr;
  Counts* counts_ = nullptr;
  const std::vector<BodyPair>* pairs_ = nullptr;
  EquationSet* set_ = nullptr;

  SweepChains over_, middle_;  ///< of the present interval T, and of the middle of it
  double begin_ = 0, end_ = 0, mid_ = 0;
  double free_else_ = 0;  ///< progress reports no later time
  std::int32_t stamp_ = 0;
  std::vector<PairBounds> motions_;
  std::vector<std::int32_t> motion_stamps_;
  std::vector<Active> active_;
  std::vector<OpenInterval> open_intervals_;
};

}  // namespace redon
}  // namespace fcl_artic
