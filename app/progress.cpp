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

bool ProgressBar::isDue() {
  return terminal_ && Clock::now() >= next_;
}

void ProgressBar::draw(double share, const std::string& text) {
  next_ = Clock::now() + kRefresh;
  shown_ = true;
  const int full = std::clamp(static_cast<int>(share * kBarWidth), 0, kBarWidth);
  fmt::print(stderr, "\r\x1b[K[{}{}] {}", std::string(static_cast<std::size_t>(full), '#'),
             std::string(static_cast<std::size_t>(kBarWidth - full), '.'), text);
  std::fflush(stderr);
}

WaitingNote::WaitingNote(std::string what) {
  if (isatty(STDERR_FILENO) == 1) thread_ = std::thread([this, what = std::move(what)] { run(what); });
}

WaitingNote::~WaitingNote() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  over_.notify_one();
  thread_.join();
}

void WaitingNote::run(const std::string& what) {
  std::unique_lock<std::mutex> lock(mutex_);
  int seconds = 0;
  while (!over_.wait_for(lock, kPatience, [this] { return is_over_; })) {
    fmt::print(stderr, "\r\x1b[K{}, {} s", what, ++seconds);
    std::fflush(stderr);
  }
  if (seconds) std::fputs("\r\x1b[K", stderr);
}

}  // namespace fcl_artic::app
