// SPDX-License-Identifier: BSD-3-Clause
//
// Things that wait for their turn in time: a binary heap, as any number of pairs may be near each other at once.
#pragma once

#include <cstdint>

#include "numerics/buffer.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// Numbers in the order of their times; of equal times, the lower number first.
class EarliestFirst {
 public:
  void clear() { waiting_.clear(); }
  bool empty() const { return waiting_.size() == 0; }

  void add(double t, std::int32_t number) {
    int at = waiting_.size();
    waiting_.push({t, number});
    for (; at > 0 && waiting_[at].isBefore(waiting_[(at - 1) / 2]); at = (at - 1) / 2) exchange(at, (at - 1) / 2);
  }

  /// Takes the first one out; there must be one.
  std::int32_t take() {
    const std::int32_t number = waiting_[0].number;
    const int size = waiting_.size() - 1;
    waiting_[0] = waiting_[size];
    waiting_.truncate(size);
    for (int at = 0;;) {
      int first = at;
      for (int below = 2 * at + 1; below <= 2 * at + 2 && below < size; ++below) {
        if (waiting_[below].isBefore(waiting_[first])) first = below;
      }
      if (first == at) return number;
      exchange(at, first);
      at = first;
    }
  }

 private:
  struct Waiting {
    double t;
    std::int32_t number;
    bool isBefore(const Waiting& other) const { return t < other.t || (t == other.t && number < other.number); }
  };

  void exchange(int i, int j) {
    const Waiting other = waiting_[i];
    waiting_[i] = waiting_[j];
    waiting_[j] = other;
  }

  Buffer<Waiting> waiting_;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
