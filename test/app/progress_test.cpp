// SPDX-License-Identifier: BSD-3-Clause
#include "progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>

namespace progress_test {

namespace {

using fcl_artic::app::ProgressBar;
using fcl_artic::app::WaitingNote;

/// The text that `draw` writes to standard error when that is `file`; read from `from` afterwards.
std::string written(int file, int from, const std::function<void()>& draw) {
  const int saved = dup(STDERR_FILENO);
  dup2(file, STDERR_FILENO);
  draw();
  dup2(saved, STDERR_FILENO);
  close(saved);
  fcntl(from, F_SETFL, O_NONBLOCK);
  // A terminal hands on what was written a little later.
  std::string text;
  pollfd more{from, POLLIN, 0};
  char part[1000];
  while (poll(&more, 1, 300) == 1) {
    const ssize_t length = read(from, part, sizeof part);
    if (length <= 0) break;
    text.append(part, static_cast<std::size_t>(length));
  }
  return text;
}

void shortThenLong() {
  ProgressBar bar;
  bar.showFree(0.25, 2.5);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  bar.showFree(0.5, 5);
  bar.show(0.75);  // too soon after the last one
}

/// The text that `draw` writes to a terminal; none if no terminal can be had.
std::optional<std::string> onATerminal(const std::function<void()>& draw) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || grantpt(terminal) || unlockpt(terminal)) return std::nullopt;
  const int side = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  if (side < 0) return std::nullopt;
  const std::string text = written(side, terminal, draw);
  close(side);
  close(terminal);
  return text;
}

TEST(ProgressBar, ShowsOnATerminalAfterASecond) {
  const auto written = onATerminal(shortThenLong);
  if (!written) GTEST_SKIP() << "ProgressBar: no terminal to be had here";
  const std::string& text = *written;
  EXPECT_EQ(text.find("2.5"), std::string::npos) << text;
  EXPECT_NE(text.find("[####################....................] free up to t = 5.0000"), std::string::npos) << text;
  EXPECT_EQ(text.find("75 %"), std::string::npos) << text;
  EXPECT_EQ(text.substr(text.size() - 4), "\r\x1b[K") << "the bar is wiped";
}

TEST(ProgressBar, SaysPercentWhereThereIsNoTime) {
  const auto text = onATerminal([] {
    ProgressBar bar;
    std::this_thread::sleep_for(std::chrono::milliseconds(1050));
    bar.show(0.5);
  });
  if (!text) GTEST_SKIP() << "ProgressBar: no terminal to be had here";
  EXPECT_NE(text->find("....] 50 %"), std::string::npos) << *text;
  EXPECT_EQ(text->find("t ="), std::string::npos) << *text;
}

TEST(WaitingNote, CountsSecondsOnATerminal) {
  const auto text = onATerminal([] {
    const WaitingNote note("drawing a.png");
    std::this_thread::sleep_for(std::chrono::milliseconds(1300));
  });
  if (!text) GTEST_SKIP() << "WaitingNote: no terminal to be had here";
  EXPECT_NE(text->find("drawing a.png, 1 s"), std::string::npos) << *text;
  EXPECT_EQ(text->substr(text->size() - 4), "\r\x1b[K") << "it is wiped";
  const auto soon = onATerminal([] { const WaitingNote note("drawing a.png"); });
  EXPECT_EQ(soon.value_or(""), "");
}

TEST(ProgressBar, IsSilentElsewhere) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_EQ(written(ends[1], ends[0], shortThenLong), "");
  close(ends[0]);
  close(ends[1]);
}

}  // namespace

}  // namespace progress_test
