// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <mutex>
#include <shared_mutex>
#include <utility>
#include <vector>

#include "errors.h"

namespace fcl_artic::python {

/// A manager that Python's threads share: it sets itself up when it is asked after a change, changes wait for queries
/// and queries for changes. No thread waits while it holds the GIL.
template <class Manager>
class Guarded {
  struct Nothing {
    void operator()() const {}
  };

 public:
  template <class... Arguments>
  explicit Guarded(Arguments&&... arguments) : manager_(std::forward<Arguments>(arguments)...) {}

  /// Changes the manager when no query runs. With the GIL held; `change` runs without it.
  /// @param commit  writes down beside the manager what has changed: with the GIL, and before any other thread changes
  ///   or asks the manager, so that what is written down is what the manager has.
  /// @throws std::runtime_error in a callback of a query of this very manager, which would wait for itself.
  template <class Change, class Commit = Nothing>
  void change(const Change& change, const Commit& commit = {}) {
    changeAtOnce(
        [&](Manager& manager) {
          changed_ = true;
          change(manager);
        },
        commit);
  }
  /// The same for a change that takes effect by itself, or throws and changes nothing: no setup() follows.
  template <class Change, class Commit = Nothing>
  void changeAtOnce(const Change& change, const Commit& commit = {}) {
    if (isAskedByThisThread()) throw std::runtime_error("a world can't be changed from within its own query");
    const py::gil_scoped_release release;
    const std::unique_lock<std::shared_mutex> lock(mutex_);
    change(manager_);
    const py::gil_scoped_acquire acquire;  // who holds it waits for no lock of ours
    commit();
  }

  /// Asks the manager, set up, while other threads may ask too. With the GIL held; `ask` runs without it.
  template <class Ask>
  auto ask(const Ask& ask) const {
    const py::gil_scoped_release release;
    return askFreely(ask);
  }
  /// The same, without the GIL.
  template <class Ask>
  auto askFreely(const Ask& ask) const {
    const Reading reading(*this);
    return ask(static_cast<const Manager&>(manager_));
  }
  /// The same, but looks at the manager as it is, set up or not.
  template <class Look>
  auto look(const Look& look) const {
    const py::gil_scoped_release release;
    if (isAskedByThisThread()) return look(static_cast<const Manager&>(manager_));
    const std::shared_lock<std::shared_mutex> lock(mutex_);
    return look(static_cast<const Manager&>(manager_));
  }

 private:
  /// Holds the manager unchanged and set up. A thread that asks from within its own query, in a callback, holds it
  /// already.
  class Reading {
   public:
    explicit Reading(const Guarded& guarded) : guarded_(guarded), outermost_(!guarded.isAskedByThisThread()) {
      if (!outermost_) return;
      guarded_.mutex_.lock_shared();
      while (guarded_.changed_) {
        guarded_.mutex_.unlock_shared();
        guarded_.setUp();
        guarded_.mutex_.lock_shared();
      }
      askedByThisThread().push_back(&guarded_);
    }
    ~Reading() {
      if (!outermost_) return;
      askedByThisThread().pop_back();
      guarded_.mutex_.unlock_shared();
    }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    const Guarded& guarded_;
    const bool outermost_;
  };

  void setUp() const {
    const std::unique_lock<std::shared_mutex> lock(mutex_);
    if (changed_) manager_.setup();
    changed_ = false;
  }
  static std::vector<const Guarded*>& askedByThisThread() {
    thread_local std::vector<const Guarded*> asked;
    return asked;
  }
  bool isAskedByThisThread() const {
    const auto& asked = askedByThisThread();
    return std::find(asked.begin(), asked.end(), this) != asked.end();
  }

  mutable std::shared_mutex mutex_;
  mutable Manager manager_;  ///< const members write it in setup() only, under the unique lock
  mutable bool changed_ = true;
};

}  // namespace fcl_artic::python
