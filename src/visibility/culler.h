// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/visibility.h"
#include "visibility/batch.h"
#include "visibility/choice.h"

namespace fcl_artic {
namespace visibility {

/// An executor and the memory of a query that uses it. Nothing in it reaches the next answer.
struct Slot {
  std::unique_ptr<Executor> executor;
  std::string name = "cpu";
  bool own = false;  ///< the culler's own executor, not the cpu that every culler has
  Batch batch;
  std::vector<std::uint8_t> may;
};

/// A culler's slot for one query or pass of drawing. Making one may make an executor; none can be made: the executor
/// cpu.
class ExecutorLoan {
 public:
  /// @param kind  cpu: that executor whatever the culler's own one is.
  explicit ExecutorLoan(const VisibilityCuller& culler, ExecutorKind kind = ExecutorKind::own);
  ~ExecutorLoan();
  ExecutorLoan(const ExecutorLoan&) = delete;
  ExecutorLoan& operator=(const ExecutorLoan&) = delete;
  Slot& operator*() const { return *slot_; }
  Slot* operator->() const { return slot_.get(); }
  /// The executor failed in the midst of its work: the slot is not used again, and cpu takes over.
  void giveUp(const std::string& reason);
  /// Whether the executor was made for this loan.
  bool made() const { return made_; }
  /// The time that making the culler's own executor may take, us; below 0: it has none but cpu, from the beginning or
  /// by now.
  static double makingCost(const VisibilityCuller& culler);
  /// Whether an executor of the culler's own is ready to be lent.
  static bool isMade(const VisibilityCuller& culler);

 private:
  std::unique_ptr<Slot> takeIdle(bool own);
  VisibilityCuller::Impl& culler_;
  std::unique_ptr<Slot> slot_;
  bool made_ = false;
};

}  // namespace visibility
}  // namespace fcl_artic
