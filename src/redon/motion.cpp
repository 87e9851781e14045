// SPDX-License-Identifier: BSD-3-Clause
#include "redon/motion.h"

namespace fcl_artic {
namespace redon {

IntervalTransform relate(const IntervalTransform& inverse_a, const IntervalTransform& pose,
                         const IntervalTransform& placement_b) {
  return inverse_a * (pose * placement_b);
}

IntervalTransform relateRate(const IntervalTransform& inverse_a, const IntervalTransform& rate,
                             const IntervalTransform& placement_b) {
  const IntervalMat3 turned = inverse_a.R * rate.R;
  return {turned * placement_b.R, turned * placement_b.t + inverse_a.R * rate.t};
}

void SweepChains::begin(const engine::Problem& problem, const engine::Query& query, Enclosure enclosure,
                        bool only_paths, Counts& counts) {
  problem_ = &problem;
  query_ = &query;
  counts_ = &counts;
  enclosure_ = enclosure;
  only_paths_ = only_paths;
  const auto n = static_cast<std::size_t>(problem.num_sweeps);
  sweeps_.resize(n);
  paths_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    sweeps_[i].set = sweeps_[i].ready = false;
    paths_[i].resize(static_cast<std::size_t>(problem.sweeps[i].num_steps));
    for (Chain& chain : paths_[i]) chain.set = chain.ready = false;
  }
}

void SweepChains::setInterval(double begin, double end, Derivatives derivatives) {
  begin_ = begin;
  end_ = end;
  derivatives_ = derivatives;
  for (Chain& chain : sweeps_) chain.ready = false;
  if (!only_paths_) return;
  for (std::vector<Chain>& steps : paths_) {
    for (Chain& chain : steps) chain.ready = false;
  }
}

const FrameBounds& SweepChains::frame(int sweep, int step) {
  static const FrameBounds still = [] {
    FrameBounds b;
    b.pose = IntervalTransform::identity();
    for (Interval& x : b.rate.R.m) x = Interval(0.0);
    b.rate.t = IntervalVec3(Interval(0.0), Interval(0.0), Interval(0.0));
    b.second = b.rate;
    return b;
  }();
  if (step < 0) return still;
  const auto s = static_cast<std::size_t>(sweep), i = static_cast<std::size_t>(step);
  Chain& chain = only_paths_ ? paths_[s][i] : sweeps_[s];
  if (!chain.set) {
    // Parents come first: the path to a step, and what branches off it, are the steps up to it.
    engine::SweepView view = problem_->sweeps[sweep];
    if (only_paths_) view.num_steps = step + 1;
    chain.bounds.reset(view, *query_);
    chain.frames.resize(static_cast<std::size_t>(view.num_steps));
    chain.set = true;
  }
  if (!chain.ready) {
    chain.bounds.enclose(begin_, end_, enclosure_, derivatives_, chain.frames.data());
    counts_->steps_bounded += chain.frames.size();
    chain.ready = true;
  }
  return chain.frames[i];
}

}  // namespace redon
}  // namespace fcl_artic
