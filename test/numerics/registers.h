// SPDX-License-Identifier: BSD-3-Clause
//
// The functions of numerics/register_*.h, and what numerics/lanes.h makes of them, behind plain arrays of eight lanes:
// compiled once per instruction set (registers_*.cpp).
#pragma once

#include <vector>

namespace fcl_artic {
namespace numerics_test {

enum class Operation { plus, minus, times, over, negated, min, max, abs, sqrt, mulAdd, whereGreater };

struct RegisterFile {
  const char* name;
  /// Applies it to a and b; mulAdd is a b + x, and whereGreater takes x and y too.
  void (*apply)(Operation operation, const double* a, const double* b, const double* x, const double* y, double* out);
  void (*set)(double x, double* out);
  unsigned (*greater)(const double* a, const double* b);
  double (*maxLane)(const double* a);
  /// regBits(regPlus(regTruncate(a), k), bits)
  void (*integers)(const double* a, int k, int bits, double* out);
  void (*numbered)(const double* a, int first, double* out);
  void (*narrow)(const double* a, float* out);
  void (*spread)(float x, float* out);
  /// a > b or c > d
  unsigned (*above)(const float* a, const float* b, const float* c, const float* d);
};

extern const RegisterFile kRegistersPortable, kRegistersSse2, kRegistersAvx2, kRegistersAvx512, kRegistersNeon;

/// The registers that this processor has.
std::vector<const RegisterFile*> registerFiles();

}  // namespace numerics_test
}  // namespace fcl_artic
