// SPDX-License-Identifier: BSD-3-Clause
//
// Random pairs of moving bodies and their exact poses: joints, slides and turns by polynomials of time up to the fifth
// degree, and motions that only their author knows.
#pragma once

#include "cases.h"
#include "motion/body_motion.h"

namespace fcl_artic {
namespace numerics_test {

/// The origin swings, c + s sin(k t), while the body turns about `axis` by the angle turn sin(m t) from R on. Its own
/// statements are off by 1e-12 of each number's size, as an author's word may be. Or it knows speeds only, and all
/// derivatives that it gives are wrong.
struct Sway {
  Eigen::Matrix3d R;
  Eigen::Vector3d c, s, axis;
  double k, turn, m;
  bool derivatives;
  double noise[24];

  Sway(Random& random, double scale);
  RealRigid pose(const Real& t) const;
  static void state(const void* self, double t, double* out);
  static void bounds(const void* self, double begin, double end, double* out);
};

/// A body's motion, and the motions that its author knows.
struct Body {
  BodyMotion motion;
  std::vector<Sway> sways;                ///< one for a bounded element, which has no BoundedMotion then
  std::vector<Eigen::Isometry3d> behind;  ///< a constant rotation behind each element, for some of the turns

  RealRigid pose(const Real& t) const;
};

/// Two moving bodies over eight intervals.
struct BodyCase {
  Body body[2];
  double extent_a, extent_b;
  int degree = 1;
  bool with_orientation = false;
  FrameSweep sweep;
  std::vector<engine::BoundedSource> sources;
  std::vector<double> coefficients, orientations;
  PairInput in;

  /// @param rounding  mode in which the sweep is set up.
  BodyCase(Random& random, int rounding);
  RealRigid relative(const Real& t) const { return body[0].pose(t).inverse() * body[1].pose(t); }

 private:
  void makeMotion(Random& random, double scale, Body& b);
  /// From body 0 up to the world, down to body 1, as the pair query goes.
  void cross();
};

}  // namespace numerics_test
}  // namespace fcl_artic
