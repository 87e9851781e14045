// SPDX-License-Identifier: BSD-3-Clause
//
// Interval's operations behind arrays, compiled once per instruction set (arithmetic_*.cpp): alone and in lanes.
#pragma once

#include <vector>

#include "interval/interval.h"

namespace fcl_artic {
namespace numerics_test {

enum class Operation { add, subtract, multiply, scale, negate, divide, square, squareRoot, absolute, maximum, minimum };
constexpr Operation kOperations[] = {Operation::add,     Operation::subtract,   Operation::multiply,
                                     Operation::scale,   Operation::negate,     Operation::divide,
                                     Operation::square,  Operation::squareRoot, Operation::absolute,
                                     Operation::maximum, Operation::minimum};
/// The operations that lanes have.
constexpr int kLaneOperations = 4;

struct Arithmetic {
  const char* name;
  bool directed;  ///< false: intervals that hold what the others give
  /// @param b  of scale: its lower end counts.
  void (*apply)(Operation operation, const Interval* a, const Interval* b, int n, Interval* out);
  void (*applyLanes)(Operation operation, const Interval* a, const Interval* b, int n, Interval* out);
  void (*sineCosine)(const Interval* x, int n, Interval* sine, Interval* cosine);
};

extern const Arithmetic kArithmeticPortable, kArithmeticSse2, kArithmeticAvx2, kArithmeticAvx512, kArithmeticNeon;

/// The arithmetics that this processor runs.
std::vector<const Arithmetic*> arithmetics();

}  // namespace numerics_test
}  // namespace fcl_artic
