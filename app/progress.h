// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include <fmt/format.h>

namespace fcl_artic::app {

/// A progress bar on standard error. It shows only on a terminal, and only once the work has taken a second.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();  ///< wipes the bar
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// @param share  of the work that is done, in [0, 1].
  void show(double share) {
    show(share, [share] { return fmt::format("{:.0f} %", 100 * share); });
  }
  /// @param share  of the motion that is proven free.
  /// @param t_lower  the same in the motion's own time.
  void showFree(double share, double t_lower) {
    show(share, [t_lower] { return fmt::format("free up to t = {:.4f}", t_lower); });
  }

 private:
  template <class Text>
  void show(double share, const Text& text) {
    if (isDue()) draw(share, text());
  }
  bool isDue();
  void draw(double share, const std::string& text);

  using Clock = std::chrono::steady_clock;
  const bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;  ///< not drawn before
};

/// "drawing a.png, 3 s" on standard error, for work whose end is not known. Shows where and when the bar does.
class WaitingNote {
 public:
  explicit WaitingNote(std::string what);
  ~WaitingNote();  ///< wipes it
  WaitingNote(const WaitingNote&) = delete;
  WaitingNote& operator=(const WaitingNote&) = delete;

 private:
  void run(const std::string& what);
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace fcl_artic::app
