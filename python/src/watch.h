// SPDX-License-Identifier: BSD-3-Clause
//
// Python's interruptions of a query that runs without the GIL: Ctrl-C and other signals, and the caller's `progress`.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "gil.h"
#include "turns.h"

namespace fcl_artic::python {

/// Asks Python now and then whether to go on. Made and ended with the GIL held, asked without it.
class Watch {
 public:
  /// @param progress  None, or called with the part that is done, in [0, 1]. It ends the query by returning False, or
  ///   by raising an exception; None, and anything else that is true, goes on.
  explicit Watch(py::object progress = py::none()) : progress_(std::move(progress)) {
    if (!progress_.is_none() && !PyCallable_Check(progress_.ptr())) {
      typeError("progress is no callable but " + typeName(progress_));
    }
  }

  /// Whether to go on. Takes the GIL only if the last time is long enough ago. From one thread at a time, without the
  /// GIL.
  bool goOn(double fraction) {
    const auto now = Clock::now();
    if (now < next_) return true;
    const GilHeld held;
    const bool good = ask(fraction);
    next_ = Clock::now() + kPause;
    return good;
  }

  /// Throws what Python raised meanwhile; else tells `progress` that all is done, unless it ended the query.
  void finish() {
    if (error_) std::rethrow_exception(error_);
    if (stopped_ || progress_.is_none()) return;
    ask(1);
    if (error_) std::rethrow_exception(error_);
  }

  /// Whether the query was told to end.
  bool stopped() const { return stopped_; }

  static constexpr std::chrono::milliseconds kPause{40};

 private:
  using Clock = std::chrono::steady_clock;

  bool ask(double fraction) {
    if (stopped_ || Call::shallStop()) stopped_ = true;
    if (stopped_) return false;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!progress_.is_none()) {
        const py::object answer = progress_(fraction);
        stopped_ = !answer.is_none() && !py::cast<bool>(py::bool_(answer));
      }
    } catch (...) {
      error_ = std::current_exception();
      stopped_ = true;
    }
    return !stopped_;
  }

  py::object progress_;
  Clock::time_point next_ = Clock::now() + kPause;
  std::exception_ptr error_;
  bool stopped_ = false;
};

/// Runs work that tells of its progress from any thread, in a thread of its own; this one asks Python meanwhile, since
/// only Python's main thread hears of signals. To be called in the library, without the GIL.
/// @param work  gets a function that takes the part that is done and returns whether to go on.
template <class Work>
void runWatched(Watch& watch, const Work& work) {
  std::mutex mutex;
  std::condition_variable done;
  bool ended = false;
  std::exception_ptr error;
  std::atomic<double> fraction{0};
  std::atomic<bool> stop{false};
  std::thread worker([&, doings = Doings::here()] {
    const PartOf part(doings);
    try {
      work([&](double part) {
        fraction = part;
        return !stop;
      });
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    ended = true;
    done.notify_one();
  });
  std::unique_lock<std::mutex> lock(mutex);
  while (!done.wait_for(lock, Watch::kPause, [&] { return ended; })) {
    lock.unlock();
    if (!watch.goOn(fraction)) stop = true;
    lock.lock();
  }
  lock.unlock();
  worker.join();
  if (error && !watch.stopped()) std::rethrow_exception(error);
}

}  // namespace fcl_artic::python
