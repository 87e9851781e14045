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
    bounds_ready_.resize(sweeps);
    evaluated_.resize(sweeps);
    int steps = 0;
    for (int i = 0; i < sweeps; ++i) {
      first_step_[i] = steps;
      steps += problem().sweeps[i].num_steps;
      bounds_ready_[i] = 0;
      evaluated_[i] = -1;
    }
    frames_.resize(max(frames_.size(), steps));
    bounds_.resize(max(bounds_.size(), steps));
    batch_.d = -1;
    if (number_ > 1 << 30) number_ = 0;
  }

  /// Frames are those of this batch from now on.
  void set(const TimeBatch& batch) {
    if (batch == batch_) return;
    batch_ = batch;
    ++number_;
  }
  const TimeBatch& batch() const { return batch_; }
  /// Another batch has another number.
  std::int32_t number() const { return number_; }

  /// Frames of a sweep's steps, seen from its base.
  const FrameLanes* of(int sweep) {
    const engine::SweepView& view = problem().sweeps[sweep];
    const int first = first_step_[sweep];
    if (evaluated_[sweep] != number_) {
      const bool local = query().degree > 1 || view.local_bounds;
      if (local || !bounds_ready_[sweep]) {
        boundSteps(view, query(), local ? batch_.begin() : 0, local ? batch_.finish() : 1, bounds_.data() + first);
        bounds_ready_[sweep] = 1;
      }
      evaluateSweep(view, bounds_.data() + first, batch_.tm, batch_.d, frames_.data() + first);
      evaluated_[sweep] = number_;
      ++statistics().motion_evaluations;
    }
    return frames_.data() + first;
  }
  /// Bounds of a step of a sweep whose frames have been asked for; step -1: what stands still.
  const StepBounds& bounds(int sweep, int step) const {
    static const StepBounds kStill = {};
    return step >= 0 ? bounds_[first_step_[sweep] + step] : kStill;
  }

 private:
  TimeBatch batch_;
  std::int32_t number_ = 0;
  Buffer<FrameLanes> frames_;        ///< of all sweeps, one after the other
  Buffer<StepBounds> bounds_;        ///< likewise
  Buffer<std::int32_t> first_step_;  ///< per sweep, into both
  Buffer<std::int32_t> evaluated_;   ///< per sweep: the batch's number
  Buffer<std::int32_t> bounds_ready_;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
