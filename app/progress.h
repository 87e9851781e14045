// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace fcl_artic::app {

/// A progress bar on standard error. It shows only on a terminal, and only once the query has run for a second.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();  ///< wipes the bar
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param t_lower  time in [0, 1] up to which the motion is proven free.
  void show(double t_lower);

 private:
  using Clock = std::chrono::steady_clock;
  const bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;  ///< not drawn before
};

}  // namespace fcl_artic::app
