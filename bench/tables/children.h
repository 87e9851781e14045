// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace fcl_artic::app {

/// The fate of one task that ran in a child process. Copied as bytes.
struct TaskResult {
  enum class End { answered, refused, crashed, timed_out };
  End end = End::crashed;
  bool contact = false;
  double time = 1;   ///< of contact, as answered
  double upper = 1;  ///< the bracket's end, for answers that have one
  bool certain = false;
  double elapsed_us = 0;
};

/// Runs tasks 0 .. count - 1 in child processes, in order. A child goes on to the next task until one kills it; the
/// next child goes on from there. A task that throws is `refused`; children print nothing.
/// @param limit_s  time that one task may take.
/// @param done     called with the number of tasks finished, now and then.
/// @throws std::runtime_error when no child can be made.
std::vector<TaskResult> runInChildren(std::size_t count, double limit_s,
                                      const std::function<TaskResult(std::size_t)>& task,
                                      const std::function<void(std::size_t)>& done = {});

}  // namespace fcl_artic::app
