// SPDX-License-Identifier: BSD-3-Clause
//
// A number that remembers how it was computed. The kernel's own headers are compiled with this in the place of double
// (`#define double`). So a run of the kernel leaves the formulas that it went through, operation by operation and in
// its order. Nobody copies them by hand, and they cannot drift.
//
// Sums, differences, products, quotients, roots and fused products are recorded; -a, |a|, min and max are exact and go
// the way that the present values lead. Products with 0 and 1 and sums with the constant 0 are exact too, and left out.
// A value computed from constants alone stays a constant, as the compiler would have it.
#pragma once

#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

namespace recording {

using Real = double;

enum class Operation { input, negative, sum, difference, product, quotient, root, product_plus };

/// One operation; its operands are nodes, or constants where the node is 0.
struct Operand {
  int node;
  Real value;
};
struct Entry {
  Operation operation;
  Operand of[3];
};

/// All operations so far; entry 0 stands for constants.
std::vector<Entry>& tape();
/// Comparisons a > b of lanes, and a >= b of numbers, so far.
struct Recorded;
std::vector<std::pair<Recorded, Recorded>>& comparisons();

struct Recorded {
  Real value;
  int node;  ///< 0: a constant

  Recorded() = default;
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  constexpr Recorded(Number x) : value(static_cast<Real>(x)), node(0) {}  // NOLINT: as numbers convert
  constexpr Recorded(Real x, int n) : value(x), node(n) {}
  explicit constexpr operator float() const { return static_cast<float>(value); }
  explicit constexpr operator int() const { return static_cast<int>(value); }
  explicit constexpr operator Real() const { return value; }

  constexpr bool constant() const { return node == 0; }
  constexpr bool is(Real x) const { return node == 0 && value == x; }
};

int record(Operation operation, Recorded a, Recorded b = 0.0, Recorded c = 0.0);

/// A number that comes from elsewhere.
inline Recorded given(Real x) {
  return {x, record(Operation::input, 0.0)};
}

constexpr Recorded operator-(Recorded a) {
  if (a.constant()) return -a.value;
  return {-a.value, record(Operation::negative, a)};
}
constexpr Recorded operator+(Recorded a, Recorded b) {
  if (a.constant() && b.constant()) return a.value + b.value;
  if (a.is(0)) return b;
  if (b.is(0)) return a;
  return {a.value + b.value, record(Operation::sum, a, b)};
}
constexpr Recorded operator-(Recorded a, Recorded b) {
  if (a.constant() && b.constant()) return a.value - b.value;
  if (b.is(0)) return a;
  if (a.is(0)) return -b;
  return {a.value - b.value, record(Operation::difference, a, b)};
}
constexpr Recorded operator*(Recorded a, Recorded b) {
  if (a.constant() && b.constant()) return a.value * b.value;
  if (a.is(0) || b.is(0)) return 0.0;
  if (a.is(1)) return b;
  if (b.is(1)) return a;
  return {a.value * b.value, record(Operation::product, a, b)};
}
constexpr Recorded operator/(Recorded a, Recorded b) {
  if (a.constant() && b.constant()) return a.value / b.value;
  if (a.is(0)) return 0.0;
  if (b.is(1)) return a;
  return {a.value / b.value, record(Operation::quotient, a, b)};
}
constexpr Recorded& operator+=(Recorded& a, Recorded b) {
  return a = a + b;
}
constexpr Recorded& operator-=(Recorded& a, Recorded b) {
  return a = a - b;
}
constexpr Recorded& operator*=(Recorded& a, Recorded b) {
  return a = a * b;
}
constexpr bool operator<(Recorded a, Recorded b) {
  return a.value < b.value;
}
constexpr bool operator>(Recorded a, Recorded b) {
  return a.value > b.value;
}
constexpr bool operator<=(Recorded a, Recorded b) {
  return a.value <= b.value;
}
inline bool operator>=(Recorded a, Recorded b) {
  comparisons().emplace_back(a, b);
  return a.value >= b.value;
}
constexpr bool operator==(Recorded a, Recorded b) {
  return a.value == b.value;
}
constexpr bool operator!=(Recorded a, Recorded b) {
  return a.value != b.value;
}
inline Recorded absolute(Recorded a) {
  return a.value < 0 ? -a : a;
}
inline Recorded rootOf(Recorded a) {
  if (a.constant()) return std::sqrt(a.value);
  return {std::sqrt(a.value), record(Operation::root, a)};
}
/// With one rounding or two.
inline Recorded productPlus(Recorded a, Recorded b, Recorded c) {
  if ((a.constant() && b.constant()) || a.is(0) || b.is(0) || a.is(1) || b.is(1) || c.is(0)) return a * b + c;
  return {a.value * b.value + c.value, record(Operation::product_plus, a, b, c)};
}

/// The same as reinterpret_cast, and between a register and a vector of the compiler's too.
template <class To, class From>
inline To as(const From& x) {
  if constexpr (std::is_pointer_v<To>) {
    return (To)(x);  // NOLINT: it is that cast
  } else {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    __builtin_memcpy(static_cast<void*>(&to), static_cast<const void*>(&x), sizeof to);
    return to;
  }
}

/// Lanes take literals where they take lanes; a literal would have to be converted twice here.
template <class Lanes>
inline Lanes mulAdd(const Lanes& a, const Lanes& b, Real c) {
  return mulAdd(a, b, Lanes(Recorded(c)));
}
template <class Lanes>
inline Lanes mulAdd(const Lanes& a, Real b, Real c) {
  return mulAdd(a, Lanes(Recorded(b)), Lanes(Recorded(c)));
}

}  // namespace recording
