// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/drawing_pass.h"

#include <exception>

#include "visibility/stage.h"

namespace fcl_artic {
namespace visibility {

void DrawingPass::begin(std::size_t n) {
  beginBatch(culler_, loan_->batch);
  if (queries_.size() < n) queries_.resize(n);
  num_queries_ = n;
  drawing_us_ = 0;
  for (std::size_t i = 0; i < n; ++i) queries_[i].asked = queries_[i].asked_again = queries_[i].drawn = false;
}

engine::Advisor DrawingPass::assume(std::size_t i, double tolerance_distance) {
  PassQuery& one = queries_[i];
  one.owner = this;
  one.tolerance_distance = tolerance_distance;
  engine::Advisor advisor;
  advisor.self = &one;
  advisor.clear = &DrawingPass::take;
  return advisor;
}

void DrawingPass::take(void* self, const engine::Problem& problem, const engine::SweptLink* links,
                       engine::CullCandidate* pairs, std::int32_t num_pairs) {
  PassQuery& one = *static_cast<PassQuery*>(self);
  const double begin = steadyMicroseconds();
  one.asked_again = one.asked;
  if (!one.asked) {
    one.asked = true;
    one.candidates.assign(pairs, pairs + num_pairs);
    one.volumes.add(problem, links, pairs, num_pairs, one.tolerance_distance,
                    one.owner->culler_.options().every_link_pair, one.owner->loan_->batch);
  }
  if (!one.asked_again) {
    for (std::int32_t i = 0; i < num_pairs; ++i) {
      if (one.volumes.looksAt(i)) pairs[i].lanes = 0;
    }
  }
  one.collecting_us = steadyMicroseconds() - begin;
}

bool DrawingPass::isFull() const {
  const auto side = static_cast<std::size_t>(loan_->batch.resolution);
  return numObjects() >= kManyObjects || kViews * side * side * loan_->batch.windows.size() >= kManyPixels;
}

void DrawingPass::draw() {
  Batch& batch = loan_->batch;
  const double begin = steadyMicroseconds();
  try {
    loan_->executor->run(batch, loan_->may);
  } catch (const std::exception& e) {
    loan_.giveUp(e.what());
    return;  // nothing is drawn
  }
  for (std::size_t i = 0; i < num_queries_; ++i) {
    PassQuery& one = queries_[i];
    if (!one.asked) continue;
    one.volumes.conclude(batch, loan_->may);
    one.volumes.apply(one.candidates.data());
    one.drawn = true;
  }
  drawing_us_ = steadyMicroseconds() - begin;
}

double DrawingPass::drawingMicroseconds(std::size_t i) const {
  const PassQuery& one = queries_[i];
  if (!one.drawn || numObjects() == 0) return 0;
  return drawing_us_ * static_cast<double>(one.volumes.work().pieces) / static_cast<double>(numObjects());
}

engine::Advisor DrawingPass::advise(std::size_t i) {
  engine::Advisor advisor;
  advisor.self = &queries_[i];
  advisor.clear = &DrawingPass::repeat;
  return advisor;
}

/// A proof about a pair holds for the query's whole motion.
void DrawingPass::repeat(void* self, const engine::Problem& /*problem*/, const engine::SweptLink* /*links*/,
                         engine::CullCandidate* pairs, std::int32_t num_pairs) {
  const PassQuery& one = *static_cast<const PassQuery*>(self);
  if (!one.drawn) return;
  std::size_t next = 0;  // they come in the same order
  for (std::int32_t i = 0; i < num_pairs; ++i) {
    while (next < one.candidates.size() && one.candidates[next].pair != pairs[i].pair) ++next;
    if (next == one.candidates.size()) return;
    if (one.candidates[next].lanes == 0) pairs[i].lanes = 0;
    pairs[i].free_nodes = one.candidates[next].free_nodes;
  }
}

}  // namespace visibility
}  // namespace fcl_artic
