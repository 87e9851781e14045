// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/visibility.h"
#include "visibility/batch.h"

namespace fcl_artic {
namespace visibility {

/// An executor and the memory of a query that uses it. Nothing in it reaches the next answer.
struct Slot {
  std::unique_ptr<Executor> executor;
  std::string name = "cpu";
  Batch batch;
  std::vector<std::uint8_t> may;
};

/// A culler's slot for one query. Making one may make an executor; none can be made: the executor cpu.
class ExecutorLoan {
 public:
  explicit ExecutorLoan(const VisibilityCuller& culler);
  ~ExecutorLoan();
  ExecutorLoan(const ExecutorLoan&) = delete;
  ExecutorLoan& operator=(const ExecutorLoan&) = delete;
  Slot& operator*() const { return *slot_; }
  Slot* operator->() const { return slot_.get(); }
  /// The executor failed in the midst of its work: the slot is not used again, and cpu takes over.
  void giveUp(const std::string& reason);
  /// What a first use may take, us: a query, or else a new context with its self-test.
  static double firstUse(const VisibilityCuller& culler);

 private:
  VisibilityCuller::Impl& culler_;
  std::unique_ptr<Slot> slot_;
};

}  // namespace visibility
}  // namespace fcl_artic
