// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace fcl_artic::app {

using Clock = std::chrono::steady_clock;

inline double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace fcl_artic::app
