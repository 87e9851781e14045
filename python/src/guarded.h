// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>

#include "gil.h"
#include "turns.h"

namespace fcl_artic::python {

/// A manager that Python's threads share: it sets itself up when it is asked after a change, changes and queries come
/// in turn. No thread waits while it holds the GIL, and Ctrl-C ends each wait.
template <class Manager>
class Guarded {
  struct Nothing {
    void operator()() const {}
  };

 public:
  template <class... Arguments>
  explicit Guarded(Arguments&&... arguments) : manager_(std::forward<Arguments>(arguments)...) {}

  /// Changes the manager when no query runs. With the GIL held; `change` runs without it.
  /// @param commit  writes down beside the manager what has changed. It runs with the GIL, and before any other thread
  ///   changes or asks the manager: so what is written down is what the manager has.
  /// @throws as Turn.
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
    const GilReleased released;
    const Turn turn(Turn::changes, turns_);
    change(manager_);
    const GilHeld held;  // who holds it waits for no turn
    commit();
  }

  /// Asks the manager, set up, while other threads may ask too. With the GIL held; `ask` runs without it.
  /// @throws as Turn.
  template <class Ask>
  auto ask(const Ask& ask) const {
    const GilReleased released;
    std::optional<Turn> turn(std::in_place, Turn::asks, turns_);
    if (changed_) {
      turn.reset();
      turn.emplace(Turn::changes, turns_);
      setUp();
      turn->ask();
    }
    return ask(static_cast<const Manager&>(manager_));
  }
  /// Asks this manager and another one.
  template <class Ask>
  auto askWith(const Guarded& other, const Ask& ask) const {
    const GilReleased released;
    for (;;) {
      {
        const Turn turn(Turn::asks, turns_, &other.turns_);
        if (!changed_ && !other.changed_) {
          return ask(static_cast<const Manager&>(manager_), static_cast<const Manager&>(other.manager_));
        }
      }
      for (const Guarded* one : {this, &other}) {
        std::optional<Turn> turn(std::in_place, Turn::asks, one->turns_);
        if (!one->changed_) continue;
        turn.reset();
        turn.emplace(Turn::changes, one->turns_);
        one->setUp();
      }
    }
  }
  /// As ask(), but looks at the manager as it is, set up or not.
  template <class Look>
  auto look(const Look& look) const {
    const GilReleased released;
    const Turn turn(Turn::asks, turns_);
    return look(static_cast<const Manager&>(manager_));
  }

 private:
  /// In a turn to change it.
  void setUp() const {
    if (changed_) manager_.setup();
    changed_ = false;
  }

  Turns turns_;
  mutable Manager manager_;  ///< const members write it in setUp() only
  mutable bool changed_ = true;
};

}  // namespace fcl_artic::python
