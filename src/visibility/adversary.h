// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs that touch by construction, made so that a rule that loses anything loses one of them:
// - slivers to an aspect of 1e-7,
// - sizes from a thousandth of a pixel to twenty windows,
// - triangles edge-on to a view,
// - grazing to 1e-12,
// - windows off the grid and cut close,
// - swept volumes inside solids.
#pragma once

#include <cstdint>

#include "visibility/batch.h"

namespace fcl_artic {
namespace visibility {

/// splitmix64 (Steele, Lea, Flood 2014): the same numbers everywhere.
class AdversaryRandom {
 public:
  explicit AdversaryRandom(std::uint64_t seed) : state_(seed) {}
  double uniform(double lo = 0, double hi = 1) {
    return lo + (hi - lo) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }
  double logUniform(double lo, double hi);
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }

 private:
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
  }
  std::uint64_t state_;
};

/// Kinds of pair: what is swept, and how it is touched.
enum class AdversaryKind { triangles, graze, deep, sweptHull, tangent, insideSolid, count };

/// Adds a window with one swept volume and one object that share a point, or, with `gap` > 0, a tangent pair that is
/// that many pixels apart. Pair i is of kind i mod count.
void addAdversary(std::uint64_t seed, std::uint64_t i, double gap, Batch& batch);

/// Wrong culls among touching pairs [begin, end) of this seed.
std::uint64_t countWrongCulls(Executor& executor, Batch& batch, std::uint64_t seed, std::uint64_t begin,
                              std::uint64_t end, double gap = 0, std::uint64_t* by_kind = nullptr);

}  // namespace visibility
}  // namespace fcl_artic
