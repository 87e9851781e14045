// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2 of many queries, drawn in one pass (doc/VISIBILITY.md, "Batches").
//
// Each query is solved twice at most, with one of two advisors. The first takes out all that it is asked about, and
// keeps the volumes: the answer holds on condition that all of this is free. When all queries have been asked so, one
// pass of drawing decides. Where the condition holds, the first answer stands. Where it does not, the second advisor
// repeats what was proven.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/query.h"
#include "visibility/culler.h"
#include "visibility/query_volumes.h"

namespace fcl_artic {
namespace visibility {

class DrawingPass {
 public:
  /// Maximum number of objects of a pass, and of pixels in the views of its windows. An executor keeps some ten bytes
  /// of each, so that both take some tens of megabytes.
  static constexpr std::size_t kManyObjects = 200000, kManyPixels = std::size_t{1} << 23;

  /// Borrows an executor for as long as this lives.
  DrawingPass(const VisibilityCuller& culler, ExecutorKind kind) : culler_(culler), loan_(culler, kind) {}

  /// Begins a new pass of queries 0 to n - 1.
  void begin(std::size_t n);
  /// Advises query i in a way that is no proof before draw(): all candidates are cleared.
  /// @param tolerance_distance  of the query, m.
  engine::Advisor assume(std::size_t i, double tolerance_distance);
  /// Draws the volumes of all queries so far, and reads back what is free. If the executor fails nothing is.
  void draw();
  /// Number of objects that draw() has to draw.
  std::size_t numObjects() const { return loan_->batch.objects.size(); }
  /// Whether the pass has so much that it is to be drawn before another query is asked.
  bool isFull() const;

  // After draw():
  /// Whether all that query i's first advisor was asked about is free: its answer stands.
  bool allFree(std::size_t i) const { return queries_[i].free(); }
  /// Advises query i with what is proven.
  engine::Advisor advise(std::size_t i);
  /// The volumes of query i in the pass; null: nothing was looked at.
  const QueryVolumes* volumes(std::size_t i) const {
    const PassQuery& one = queries_[i];
    return one.asked && one.volumes.work().pairs > 0 ? &one.volumes : nullptr;
  }
  /// Time of query i's volumes and of its part of the drawing, us; and the latter alone, which is by number of pieces.
  double microseconds(std::size_t i) const { return queries_[i].collecting_us + drawingMicroseconds(i); }
  double drawingMicroseconds(std::size_t i) const;
  const std::string& executor() const { return loan_->name; }
  /// Whether the executor was made for this.
  bool made() const { return loan_.made(); }

 private:
  /// One of the queries.
  struct PassQuery {
    DrawingPass* owner = nullptr;
    double tolerance_distance = 0, collecting_us = 0;
    bool asked = false, asked_again = false, drawn = false;
    std::vector<engine::CullCandidate> candidates;  ///< as they were given, then with what is proven
    QueryVolumes volumes;
    bool free() const { return !asked || (drawn && !asked_again && volumes.work().culled == volumes.work().pairs); }
  };
  static void take(void* one, const engine::Problem& problem, const engine::SweptLink* links,
                   engine::CullCandidate* pairs, std::int32_t num_pairs);
  static void repeat(void* one, const engine::Problem& problem, const engine::SweptLink* links,
                     engine::CullCandidate* pairs, std::int32_t num_pairs);

  const VisibilityCuller& culler_;
  ExecutorLoan loan_;
  std::size_t num_queries_ = 0;
  double drawing_us_ = 0;
  std::vector<PassQuery> queries_;  ///< the first num_queries_ of them; the others keep their memory
};

}  // namespace visibility
}  // namespace fcl_artic
