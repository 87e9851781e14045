// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2 of many queries, drawn in one pass (doc/VISIBILITY.md, "Batches").
//
// Each query is solved twice at most. First with assume()'s advisor: it clears all candidates that stage 2 looks at,
// without a proof, and keeps their volumes. So the first answer holds only if all of these are free. When all queries
// have been solved so, draw() draws the volumes in one pass. If it proves all of a query's candidates free, the first
// answer stands. If not, the query is solved again: with advise()'s advisor, which clears what is proven, or without
// any.
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
  /// A pass with so many objects, or so many pixels in the views of its windows, is full. An executor keeps some ten
  /// bytes of each, so both take some tens of megabytes.
  static constexpr std::size_t kManyObjects = 200000, kManyPixels = std::size_t{1} << 23;

  /// Borrows an executor for as long as this lives.
  DrawingPass(const VisibilityCuller& culler, ExecutorKind kind) : culler_(culler), loan_(culler, kind) {}

  /// Begins a new pass of queries 0 to n - 1.
  void begin(std::size_t n);
  /// The advisor of query i's first solve. It clears without a proof all candidates that stage 2 looks at: the answer
  /// counts only if allFree(i) after draw().
  /// @param tolerance_distance  of the query, m.
  engine::Advisor assume(std::size_t i, double tolerance_distance);
  /// Draws the volumes of all queries so far, and reads back which are free. If the executor fails, nothing is proven
  /// free.
  void draw();
  /// Number of objects that draw() has to draw.
  std::size_t numObjects() const { return loan_->batch.objects.size(); }
  /// Whether the pass must be drawn before another query is asked.
  bool isFull() const;

  // After draw():
  /// Whether all that query i's first advisor cleared is proven free: then the first answer stands.
  bool allFree(std::size_t i) const { return queries_[i].free(); }
  /// The advisor of query i's second solve: it clears what is proven free.
  engine::Advisor advise(std::size_t i);
  /// The volumes of query i in the pass; null: stage 2 looked at none of its pairs.
  const QueryVolumes* volumes(std::size_t i) const {
    const PassQuery& one = queries_[i];
    return one.asked && one.volumes.work().pairs > 0 ? &one.volumes : nullptr;
  }
  /// us: the time of collecting query i's volumes and of its share of the drawing. drawingMicroseconds() is that share
  /// alone, by the query's share of the objects.
  double microseconds(std::size_t i) const { return queries_[i].collecting_us + drawingMicroseconds(i); }
  double drawingMicroseconds(std::size_t i) const;
  const std::string& executor() const { return loan_->name; }
  /// Whether the executor was made for this pass.
  bool made() const { return loan_.made(); }

 private:
  /// One of the queries.
  struct PassQuery {
    DrawingPass* owner = nullptr;
    double tolerance_distance = 0, collecting_us = 0;
    bool asked = false, asked_again = false, drawn = false;
    std::vector<engine::CullCandidate> candidates;  ///< as the solver gave them; after draw() with what is proven
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
