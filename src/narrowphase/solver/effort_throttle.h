// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "numerics/lanes.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Limits how often something is tried: always while about one of kGain tries succeeds, else once in kWait times.
class EffortThrottle {
 public:
  void begin() { credit_ = kFirst; }
  bool mayTry() { return credit_ >= 0 || ++credit_ == 0; }
  void count(bool success) {
    credit_ = success ? min(credit_ + kGain, kMaxCredit) : credit_ - 1;
    if (credit_ < 0) credit_ = -kWait;
  }

 private:
  static constexpr int kFirst = 16, kGain = 8, kMaxCredit = 64, kWait = 128;
  int credit_ = kFirst;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
