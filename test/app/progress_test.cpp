// SPDX-License-Identifier: BSD-3-Clause
#include "progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>

namespace {

using fcl_artic::app::ProgressBar;

/// What `draw` writes to standard error when that is `file`; read from `from` afterwards.
std::string written(int file, int from, const std::function<void()>& draw) {
  const int saved = dup(STDERR_FILENO);
  dup2(file, STDERR_FILENO);
  draw();
  dup2(saved, STDERR_FILENO);
  close(saved);
  fcntl(from, F_SETFL, O_NONBLOCK);
  std::string text(1000, ' ');
  const ssize_t length = read(from, text.data(), text.size());
  text.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
  return text;
}

void shortThenLong() {
  ProgressBar bar;
  bar.show(0.25);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  bar.show(0.5);
  bar.show(0.75);  // too soon after the last one
}

TEST(ProgressBar, ShowsOnATerminalAfterASecond) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || grantpt(terminal) || unlockpt(terminal))
    GTEST_SKIP() << "ProgressBar: no terminal to be had here";
  const int side = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  ASSERT_GE(side, 0);
  const std::string text = written(side, terminal, shortThenLong);
  EXPECT_EQ(text.find("0.25"), std::string::npos) << text;
  EXPECT_NE(text.find("[####################....................] free up to t = 0.5000"), std::string::npos) << text;
  EXPECT_EQ(text.find("0.75"), std::string::npos) << text;
  EXPECT_EQ(text.substr(text.size() - 4), "\r\x1b[K") << "the bar is wiped";
  close(side);
  close(terminal);
}

TEST(ProgressBar, IsSilentElsewhere) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_EQ(written(ends[1], ends[0], shortThenLong), "");
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
