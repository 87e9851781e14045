// SPDX-License-Identifier: BSD-3-Clause
//
// Frames of all sweeps over one batch, evaluated when first asked for.
#pragma once

#include "motion/chain.h"
#include "narrowphase/solver/task.h"
#include "narrowphase/solver/time_batch.h"
#include "numerics/buffer.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

class SweptFrames : PartOfSolver {
 public:
  explicit SweptFrames(Task& task) : PartOfSolver(task) {}

  /// A new query: nothing is known.
  void begin() {
    const int sweeps = problem().num_sweeps;
    first_step_.resize(sweeps);
    local_.resize(sweeps);
    int steps = 0;
    for (int i = 0; i < sweeps; ++i) {
      const engine::SweepView& view = problem().sweeps[i];
      first_step_[i] = steps;
      steps += view.num_steps;
      local_[i] = query().degree > 1 || view.local_bounds;
    }
    // Numbers of batches only grow. Long before they would overflow they begin anew, and all stamps are cleared.
    const bool anew = last_number_ > 1 << 30;
    if (anew) last_number_ = 0;
    query_began_ = ++last_number_;
    for (OfBatch& each : kept_) each.begin(sweeps, steps, anew);
    now_ = &kept_[0];
  }

  /// Sets the batch that of() and bounds() are about. The frames over whole() are kept while another batch is set.
  void set(const TimeBatch& batch) {
    if (now_->number && batch == now_->batch) return;
    now_ = &kept_[batch == whole() ? 0 : 1];
    if (now_->number && batch == now_->batch) return;
    now_->batch = batch;
    now_->number = ++last_number_;
  }
  const TimeBatch& batch() const { return now_->batch; }
  /// The batch's number: another batch has another one.
  std::int32_t number() const { return now_->number; }

  /// Frame of a step of a sweep, seen from the sweep's base.
  const FrameLanes& of(int sweep, int step) {
    const int at = first_step_[sweep] + step;
    if (now_->evaluated[at] != now_->number) evaluateUpTo(sweep, step);
    return now_->frames[at];
  }
  /// Bounds of a step. Its frame must have been asked for by of(). Step -1: a body that stands still.
  const StepBounds& bounds(int sweep, int step) const {
    static const StepBounds kStill = {};
    return step >= 0 ? boundsOf(sweep).bounds[first_step_[sweep] + step] : kStill;
  }

 private:
  /// The frames and bounds of one batch. Stamps are numbers of batches: older ones say that nothing is there.
  struct OfBatch {
    TimeBatch batch;
    std::int32_t number = 0;          ///< 0: no batch yet
    Buffer<FrameLanes> frames;        ///< of all sweeps, one after the other
    Buffer<StepBounds> bounds;        ///< likewise
    Buffer<std::int32_t> evaluated;   ///< likewise: the stamp of its frame
    Buffer<std::int32_t> bounded_at;  ///< per sweep: the stamp of its bounds

    void begin(int sweeps, int steps, bool anew) {
      number = 0;
      frames.resize(max(frames.size(), steps));
      bounds.resize(max(bounds.size(), steps));
      evaluated.resize(max(evaluated.size(), steps));
      bounded_at.resize(max(bounded_at.size(), sweeps));
      for (int i = 0; anew && i < evaluated.size(); ++i) evaluated[i] = 0;
      for (int i = 0; anew && i < bounded_at.size(); ++i) bounded_at[i] = 0;
    }
  };

  /// Where a sweep's bounds are kept: those over [0, 1] serve all batches.
  OfBatch& boundsOf(int sweep) { return local_[sweep] ? *now_ : kept_[0]; }
  const OfBatch& boundsOf(int sweep) const { return local_[sweep] ? *now_ : kept_[0]; }

  /// Evaluates a step's frame, and before it those on the way to it that are not there yet: a pair of links needs few.
  [[gnu::noinline]] void evaluateUpTo(int sweep, int step) {
    const engine::SweepView& view = problem().sweeps[sweep];
    const int first = first_step_[sweep];
    const bool local = local_[sweep];
    OfBatch& of_bounds = boundsOf(sweep);
    StepBounds* const bounds = of_bounds.bounds.data() + first;
    if (of_bounds.bounded_at[sweep] < (local ? now_->number : query_began_)) {
      const TimeBatch& batch = now_->batch;
      boundSteps(view, query(), local ? batch.begin() : 0, local ? batch.finish() : 1, bounds);
      of_bounds.bounded_at[sweep] = now_->number;
    }
    std::int32_t* const evaluated = now_->evaluated.data() + first;
    way_.clear();
    for (int i = step; i >= 0 && evaluated[i] != now_->number; i = view.steps[i].parent) way_.push(i);
    for (int i = way_.size() - 1; i >= 0; --i) {
      evaluateStep(view, way_[i], bounds, now_->batch.tm, now_->batch.d, now_->frames.data() + first);
      evaluated[way_[i]] = now_->number;
    }
    statistics().motion_evaluations += static_cast<std::uint64_t>(way_.size());
  }

  Buffer<std::int32_t> first_step_;  ///< per sweep
  Buffer<std::uint8_t> local_;       ///< per sweep: its bounds are of the batch, not of [0, 1]
  OfBatch kept_[2];                  ///< of whole(), and of the last other batch
  OfBatch* now_ = kept_;
  std::int32_t last_number_ = 0, query_began_ = 0;
  Buffer<std::int32_t> way_;  ///< steps to be evaluated, the last one first
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
