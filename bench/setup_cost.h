// SPDX-License-Identifier: BSD-3-Clause
//
// Time and memory that something takes once, and ranks of times.
#pragma once

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <vector>

namespace fcl_artic::bench {

using Clock = std::chrono::steady_clock;

inline double microsecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

/// Held of the heap by the whole process.
inline double megabytes() {
  return static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd) / 1e6;
}

/// Resident memory of the process (/proc/self/statm), all that is free given back first; 0 where the system does not
/// say.
inline double residentMegabytes() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  return statm >> size >> resident ? resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6 : 0;
}

/// The value that this part of them is below; 0 of none.
inline double rank(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

}  // namespace fcl_artic::bench
