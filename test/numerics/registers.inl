// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/lanes.h"
#include "registers.h"

#define FCL_ARTIC_STRING2(x) #x
#define FCL_ARTIC_STRING(x) FCL_ARTIC_STRING2(x)

namespace fcl_artic {
namespace FCL_ARTIC_ISA {
namespace {

using numerics_test::Operation;
using numerics_test::RegisterFile;

Lanes load(const double* x) {
  Lanes a;
  for (int i = 0; i < kLanes; ++i) a.set(i, x[i]);
  return a;
}
void store(Lanes a, double* out) {
  for (int i = 0; i < kLanes; ++i) out[i] = a[i];
}
FloatLanes load(const float* x) {
  FloatLanes a;
  __builtin_memcpy(a.r, x, sizeof a.r);
  return a;
}
void store(const FloatLanes& a, float* out) {
  __builtin_memcpy(out, a.r, sizeof a.r);
}

Lanes result(Operation operation, Lanes a, Lanes b, Lanes x, Lanes y) {
  switch (operation) {
    case Operation::plus:
      return a + b;
    case Operation::minus:
      return a - b;
    case Operation::times:
      return a * b;
    case Operation::over:
      return a / b;
    case Operation::negated:
      return -a;
    case Operation::min:
      return min(a, b);
    case Operation::max:
      return max(a, b);
    case Operation::abs:
      return abs(a);
    case Operation::sqrt:
      return sqrt(a);
    case Operation::mulAdd:
      return mulAdd(a, b, x);
    case Operation::whereGreater:
      return whereGreater(a, b, x, y);
  }
  return a;
}

void apply(Operation operation, const double* a, const double* b, const double* x, const double* y, double* out) {
  store(result(operation, load(a), load(b), load(x), load(y)), out);
}

void set(double x, double* out) {
  store(Lanes(x), out);
}

unsigned greaterOf(const double* a, const double* b) {
  return greater(load(a), load(b));
}

double maxLaneOf(const double* a) {
  return maxLane(load(a));
}

void integers(const double* a, int k, int bits, double* out) {
  Lanes of = load(a);
  for (Register& r : of.r) r = regBits(regPlus(regTruncate(r), k), bits);
  store(of, out);
}

void numberedOf(const double* a, int first, double* out) {
  store(numbered(load(a), first), out);
}

void narrowOf(const double* a, float* out) {
  store(narrow(load(a)), out);
}

void spreadOf(float x, float* out) {
  store(spread(x), out);
}

unsigned above(const float* a, const float* b, const float* c, const float* d) {
  return lanesOf(greater(load(a), load(b)) | greater(load(c), load(d)));
}

}  // namespace
}  // namespace FCL_ARTIC_ISA

namespace numerics_test {
const RegisterFile FCL_ARTIC_ISA_REGISTERS = {
    FCL_ARTIC_STRING(FCL_ARTIC_ISA), &FCL_ARTIC_ISA::apply,    &FCL_ARTIC_ISA::set,        &FCL_ARTIC_ISA::greaterOf,
    &FCL_ARTIC_ISA::maxLaneOf,       &FCL_ARTIC_ISA::integers, &FCL_ARTIC_ISA::numberedOf, &FCL_ARTIC_ISA::narrowOf,
    &FCL_ARTIC_ISA::spreadOf,        &FCL_ARTIC_ISA::above};
}  // namespace numerics_test
}  // namespace fcl_artic
