// SPDX-License-Identifier: BSD-3-Clause
#include "progress.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include <unistd.h>

#include <fmt/format.h>

namespace fcl_artic::app {
namespace {
constexpr int kBarWidth = 40;
constexpr auto kPatience = std::chrono::seconds(1);
constexpr auto kRefresh = std::chrono::milliseconds(100);
}  // namespace

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + kPatience) {}

ProgressBar::~ProgressBar() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::show(double t_lower) {
  if (!terminal_ || Clock::now() < next_) return;
  next_ = Clock::now() + kRefresh;
  shown_ = true;
  const int full = std::clamp(static_cast<int>(t_lower * kBarWidth), 0, kBarWidth);
  fmt::print(stderr, "\r[{}{}] free up to t = {:.4f}", std::string(static_cast<std::size_t>(full), '#'),
             std::string(static_cast<std::size_t>(kBarWidth - full), '.'), t_lower);
  std::fflush(stderr);
}

}  // namespace fcl_artic::app
