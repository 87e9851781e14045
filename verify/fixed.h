// SPDX-License-Identifier: BSD-3-Clause
// Numbers of the verifier: integers that count units of 2^-64. Nothing here can wrap: a number that would leave [-2^40,
// 2^40] is refused, and a refusal is never a proof.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace verify {

/// A file that is not what doc/CERTIFICATES.md describes.
struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A claim that could not be proven again.
struct NotProven : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Numbers are too large here; over a shorter interval of time they may not be.
struct OutOfRange : NotProven {
  using NotProven::NotProven;
};

__extension__ typedef __int128 Int;
__extension__ typedef unsigned __int128 Uint;

/// The number v 2^-64, |v| <= 2^104. One unit of v is called an ulp.
struct Fix {
  Int v = 0;
};

constexpr Int kOne = static_cast<Int>(1) << 64;
constexpr Int kMost = static_cast<Int>(1) << 104;

inline Fix checked(Int v) {
  if (v > kMost || v < -kMost) throw OutOfRange("a number is beyond the verifier's range of 2^40");
  return Fix{v};
}
inline Fix ulps(int n) {
  return Fix{n};
}
inline Fix integer(std::int64_t n) {
  return checked(static_cast<Int>(n) * kOne);
}

// Sums are exact: two numbers of at most 2^104 add up to at most 2^105, which the 127 bits hold.
inline Fix operator+(Fix a, Fix b) {
  return checked(a.v + b.v);
}
inline Fix operator-(Fix a, Fix b) {
  return checked(a.v - b.v);
}
inline Fix operator-(Fix a) {
  return Fix{-a.v};
}
inline Fix& operator+=(Fix& a, Fix b) {
  return a = a + b;
}
inline bool operator<(Fix a, Fix b) {
  return a.v < b.v;
}
inline bool operator>(Fix a, Fix b) {
  return a.v > b.v;
}
inline bool operator<=(Fix a, Fix b) {
  return a.v <= b.v;
}
inline Fix abs(Fix a) {
  return Fix{a.v < 0 ? -a.v : a.v};
}
/// a 2^-k rounded down: less than one ulp too small. (Right shifts of negative numbers round down with every compiler
/// that has __int128.)
inline Fix shifted(Fix a, int k) {
  return Fix{a.v >> k};
}

/// The product rounded down: exact - 1 ulp < result <= exact.
/// With a = a1 2^64 + a0 and b likewise, 0 <= a0, b0 < 2^64: a b 2^-64 = a1 b1 2^64 + a1 b0 + a0 b1 + a0 b0 2^-64, and
/// only the last term is no integer. |a1 b1| <= 2^80; where it is above 2^42 the product is out of range and refused;
/// else the sum stays below 2^106 + 2 * 2^104 + 2^64 < 2^127.
inline Fix operator*(Fix a, Fix b) {
  const Int a1 = a.v >> 64, b1 = b.v >> 64;
  const Uint a0 = static_cast<std::uint64_t>(a.v), b0 = static_cast<std::uint64_t>(b.v);
  const Int high = a1 * b1;
  constexpr Int kHigh = static_cast<Int>(1) << 42;
  if (high > kHigh || high < -kHigh) throw OutOfRange("a product is beyond the verifier's range of 2^40");
  return checked(high * kOne + a1 * static_cast<Int>(b0) + static_cast<Int>(a0) * b1 +
                 static_cast<Int>((a0 * b0) >> 64));
}
/// An upper bound of the product.
inline Fix mulUp(Fix a, Fix b) {
  return a * b + ulps(1);
}

/// A number of the statement and how far its Fix may be from it: 0 or 1 ulp.
struct Enclosed {
  Fix x;
  Fix error;
};
/// @throws BadInput: beyond 2^40, or no number.
Enclosed enclose(double value);
/// A double that is certainly not below, or not above, the number.
Fix encloseUp(double value);
Fix encloseDown(double value);
/// For people only: never decides anything.
inline double toDouble(Fix a) {
  return std::ldexp(static_cast<double>(a.v), -64);
}

/// An upper bound of the square root of a >= 0; at most 2 ulp above it.
Fix sqrtUp(Fix a);
/// Sine and cosine of the very number `angle`, each within 2 ulp.
void sineCosine(Fix angle, Fix& sine, Fix& cosine);
/// The unit vector along (x, y, z), each entry within 2 ulp. @throws BadInput for the zero vector.
void unitVector(const double axis[3], Fix unit[3]);

}  // namespace verify
