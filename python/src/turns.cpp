// SPDX-License-Identifier: BSD-3-Clause
#include "turns.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "gil.h"
#include "watch.h"

namespace fcl_artic::python {
namespace {

/// State that all threads share. A child of a fork has one of its own.
struct Common {
  std::mutex mutex;
  std::condition_variable moved;
  int waiting = 0;       ///< threads at `moved`
  int within = 0;        ///< threads in the library
  bool forking = false;  ///< nobody enters
  unsigned process = 0;
  std::vector<const Turns*> asked_by_forker, changed_by_forker;
};

Common*& common() {
  static Common* one = new Common;  // outlives all threads
  return one;
}

using Lock = std::unique_lock<std::mutex>;

/// Handles Python's signals in a thread that waits. Without the mutex.
void askPython() {
  const GilHeld held;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (interpreterEnds()) throw std::runtime_error("Python ends, and with it whatever this waits for");
}

template <class Ready>
void waitUntil(Lock& lock, const Ready& ready) {
  Common& all = *common();
  while (!ready()) {
    ++all.waiting;
    const bool in_vain = all.moved.wait_for(lock, Watch::kPause) == std::cv_status::timeout;
    --all.waiting;
    if (!in_vain) continue;
    lock.unlock();
    try {
      askPython();
    } catch (...) {
      lock.lock();  // the caller leaves its place in the line
      throw;
    }
    lock.lock();
  }
}

void wakeWaiting() {
  if (common()->waiting > 0) common()->moved.notify_all();
}

void enter() {
  if (Doings::here().depth++ == 0) ++common()->within;
}
void leave() {
  if (--Doings::here().depth == 0) --common()->within;
}

bool has(const std::vector<const Turns*>& all, const Turns* one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace

Doings& Doings::here() {
  thread_local Doings doings;
  return doings;
}

PartOf::PartOf(const Doings& doings) {
  Doings::here() = doings;
  Doings::here().depth = 0;
  const Lock lock(common()->mutex);
  enter();
}
PartOf::~PartOf() {
  const Lock lock(common()->mutex);
  leave();
  Doings::here() = {};
  wakeWaiting();
}

InLibrary::InLibrary() {
  Lock lock(common()->mutex);
  if (Doings::here().depth == 0) waitUntil(lock, [] { return !common()->forking; });
  enter();
}
InLibrary::~InLibrary() {
  const Lock lock(common()->mutex);
  leave();
  wakeWaiting();
}

/// Forgets threads of the parent process, if this one is a fork.
void Turns::refresh() const {
  const Common& all = *common();
  if (process_ == all.process) return;
  process_ = all.process;
  line_.clear();
  askers_ = has(all.asked_by_forker, this) ? 1 : 0;
  changing_ = has(all.changed_by_forker, this);
}

bool Turns::hasChangeBefore(std::list<bool>::const_iterator place) const {
  return std::find(line_.cbegin(), place, true) != place;
}

Turn::Turn(Kind kind, const Turns& of, const Turns* also) : kind_(kind) {
  Doings& here = Doings::here();
  for (const Turns* one : {&of, also}) {
    if (!one || has(of_, one)) continue;
    if (has(here.changes, one)) throw std::runtime_error("a world can't be used from within its own change");
    if (!has(here.asks, one)) {
      of_.push_back(one);
    } else if (kind == changes) {
      throw std::runtime_error("a world can't be changed from within its own query");
    }
  }
  if (of_.empty()) return;
  const bool part_of_another = here.depth > 0;
  Lock lock(common()->mutex);
  struct Places {
    std::vector<std::pair<const Turns*, std::list<bool>::iterator>> all;
    ~Places() {
      for (const auto& [turns, place] : all) turns->line_.erase(place);
      wakeWaiting();  // who stands behind
    }
  };
  {
    Places places;
    for (const Turns* one : of_) {
      one->refresh();
      places.all.emplace_back(one, one->line_.insert(one->line_.end(), kind == changes));
    }
    waitUntil(lock, [&] {
      if (!part_of_another && common()->forking) return false;
      return std::all_of(places.all.begin(), places.all.end(), [&](const auto& at) {
        const auto& [turns, place] = at;
        if (turns->changing_ || (kind == changes && turns->askers_ > 0)) return false;
        if (part_of_another) return true;
        return kind == changes ? place == turns->line_.begin() : !turns->hasChangeBefore(place);
      });
    });
    enter();
    for (const Turns* one : of_) {
      if (kind == asks) ++one->askers_;
      if (kind == changes) one->changing_ = true;
      (kind == asks ? here.asks : here.changes).push_back(one);
    }
  }
}

Turn::~Turn() {
  if (of_.empty()) return;
  Doings& here = Doings::here();
  const Lock lock(common()->mutex);
  for (const Turns* one : of_) {
    one->refresh();
    if (kind_ == asks) --one->askers_;
    if (kind_ == changes) one->changing_ = false;
    (kind_ == asks ? here.asks : here.changes).pop_back();
  }
  leave();
  wakeWaiting();
}

void Turn::ask() {
  Doings& here = Doings::here();
  const Lock lock(common()->mutex);
  kind_ = asks;
  for (const Turns* one : of_) {
    one->refresh();
    one->changing_ = false;
    ++one->askers_;
    here.changes.pop_back();
    here.asks.push_back(one);
  }
  wakeWaiting();
}

namespace {
// Under the GIL, but for reading `ending`.
int calls = 0;
std::atomic<bool> ending{false};
std::thread::id last_thread;  // that ends the script
}  // namespace

Call::Call() {
  int& here = Doings::here().calls;
  if (here == 0 && shallStop()) {
    const GilReleased released;
    for (;;) ::pause();
  }
  ++here;
  ++calls;
}
Call::~Call() {
  --Doings::here().calls;
  --calls;
}
bool Call::shallStop() {
  return ending && std::this_thread::get_id() != last_thread;
}

void watchEnd() {
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    last_thread = std::this_thread::get_id();
    ending = true;
    // A call may be in a callback that does not come back. It holds the GIL there no more than any thread of Python's.
    constexpr std::chrono::seconds kMax{2};
    const auto begin = std::chrono::steady_clock::now();
    while (calls > 0 && std::chrono::steady_clock::now() - begin < kMax) {
      const GilReleased released;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }));
}

void watchForks() {
  // The mutex is held over the fork, so that the child sees all as it was between two steps of any thread.
  const auto before = [] {
    const GilReleased released;
    Lock lock(common()->mutex);
    Common& all = *common();
    if (Doings::here().depth == 0) {
      // No signals here: what Python's handlers raise before a fork is lost.
      ++all.waiting;
      all.moved.wait(lock, [&] { return !all.forking; });
      all.forking = true;
      all.moved.wait(lock, [&] { return all.within == 0; });
      --all.waiting;
    }
    lock.release();
  };
  const auto in_parent = [] {
    if (Doings::here().depth == 0) common()->forking = false;
    common()->mutex.unlock();
    common()->moved.notify_all();
  };
  const auto in_child = [] {
    const Doings& here = Doings::here();
    auto* const fresh = new Common;  // the other one's waiting threads are gone
    fresh->process = common()->process + 1;
    fresh->within = here.depth > 0 ? 1 : 0;
    fresh->asked_by_forker = here.asks;
    fresh->changed_by_forker = here.changes;
    common() = fresh;
    calls = here.calls;
  };
  py::module_::import("os").attr("register_at_fork")(py::arg("before") = py::cpp_function(before),
                                                     py::arg("after_in_parent") = py::cpp_function(in_parent),
                                                     py::arg("after_in_child") = py::cpp_function(in_child));
}

}  // namespace fcl_artic::python
