// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "pairs/path.h"

namespace pairs {

/// One question: do two moving bodies touch, and when first?
struct PairQuery {
  std::string family;      ///< "mesh-mesh", "shape-shape" or "mesh-shape" and how they move
  std::uint64_t seed = 0;  ///< makes the same query again
  BodyPtr body1, body2;
  PathPtr path1, path2;

  PairQuery swapped() const { return {family, seed, body2, body1, path2, path1}; }
};
std::string describe(const PairQuery& query);

/// How two bodies stand to each other at one time.
struct Nearness {
  double gap = 0;    ///< lower bound on their distance, from a direction that parts them; not positive when they touch
  double upper = 0;  ///< distance of two points of theirs
  bool clear = false;             ///< they are in each other by more than kClear, as far as long doubles tell
  int piece1 = 0, piece2 = 0;     ///< nearest pieces; a first guess for the next call
  Vec3 direction = Vec3::Zero();  ///< unit, from 1 to 2
};

/// A contact is clear if a ball of this radius, in m, fits into the bodies' Minkowski difference about the origin.
/// Poses of bodies of a metre within some metres carry errors of 1e-15 m in doubles.
constexpr double kClear = 1e-12;

/// @param wanted  share of the distance to which the bounds are wanted
Nearness nearness(const Body& a, const Pose& M_a, const Body& b, const Pose& M_b, double wanted,
                  const Nearness& hint = {});
/// Distance of a point from the body, 0 inside a solid. @param piece  only this one; -1: all
double distanceTo(const Body& body, int piece, const Pose& M, const Vec3& point);
/// Gap along the unit direction n: least n.x over a piece of b less the largest over a piece of a. Bounded bodies.
double gapAlong(const Body& a, int piece_a, const Pose& M_a, const Body& b, int piece_b, const Pose& M_b,
                const Vec3& n);

/// The findings of sampling.
struct Truth {
  /// A sampled time has a clear contact; `time` is the first one found, bisected down to neighbouring doubles or
  /// nearly. The true first contact lies at or before it.
  bool hit = false;
  double time = 1;
  double gap = 0;  ///< least sampled gap; 0 for a hit
  double gap_time = 0;
  Vec3 direction = Vec3::Zero();  ///< there, unit, from 1 to 2
};

/// Samples a query as often as distance and speed ask for: at least 32 times and, near contact, up to 2,048 times.
/// Closes in on every minimum of the distance that may hide a contact. Contacts are found, never proven absent: an
/// oracle in one direction. It shares nothing with the library but FCL's types.
class Judge {
 public:
  using Look = std::function<Nearness(const Pose& M_1, const Pose& M_2, double wanted, const Nearness& hint)>;
  /// @param look  another way to measure, such as with exact predicates.
  explicit Judge(const PairQuery& query, Look look = {});

  Nearness at(double t, double wanted, const Nearness& hint = {}) const;
  Truth firstContact(double begin = 0, double end = 1) const;
  /// A least gap to a relative 1e-3 or 1e-11 m, and no other one seen is less than 0.7 of it; the first contact if any.
  Truth leastGap() const;
  /// No point of one body moves faster against the other.
  double speed() const { return speed_; }

 private:
  template <bool kLeast>
  Truth march(double begin, double end) const;
  const PairQuery& query_;
  Look look_;
  double speed_;
};

}  // namespace pairs
