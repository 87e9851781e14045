// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "scene.h"

namespace campaign {

/// What sampling found out about one pair of bodies.
struct PairTruth {
  int a = -1, b = -1;
  /// Some sampled time has a contact that no rounding explains; `time` is the first one found, bisected down to
  /// neighbouring samples some 1e-14 apart. The true first contact lies at or before it.
  bool hit = false;
  double time = 1;
  /// Contact by the rounded corners only, at `time` (a graze at the level of rounding).
  bool doubtful = false;
  double gap = 0;                 ///< least sampled gap; 0 for a hit
  double gap_time = 0;            ///< where
  Vec3 direction = Vec3::Zero();  ///< there, unit, from a to b
};

struct Truth {
  bool hit = false, doubtful = false;
  double time = 1;
  int first = -1;  ///< index of the first pair that hits, or of the one that comes nearest
  std::vector<PairTruth> pairs;
};

/// The motion of one scene, sampled: each pair is looked at as often as its distance and the greatest speed ask for,
/// never more coarsely, down to a least step; every minimum of the sampled distance that may hide a contact is closed
/// in. Contacts are found, never proven absent below the least step: an oracle in one direction, for the first contact.
class Oracle {
 public:
  explicit Oracle(const Scene& scene);

  const Kinematics& kinematics() const { return kinematics_; }
  Proximity at(int a, int b, double t, double wanted, const Proximity& hint = {}) const;
  /// First contact of the pair in [begin, end].
  PairTruth firstContact(int a, int b, double end = 1, double begin = 0) const;
  /// A least gap of the pair over [begin, end] as far as it is below `beyond`: a minimum to a relative 1e-3 or 1e-11 m,
  /// and no other one seen is less than 0.7 of it. For placing things, not for judging.
  PairTruth leastGap(int a, int b, double beyond, double begin = 0, double end = 1) const;
  /// @param every  look for the first contact of every pair, not only for the first of all
  Truth judge(bool every) const;

 private:
  template <bool kLeast>
  PairTruth march(int a, int b, double begin, double end, double beyond) const;
  const Scene& scene_;
  Kinematics kinematics_;
};

}  // namespace campaign
