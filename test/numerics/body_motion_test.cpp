// SPDX-License-Identifier: BSD-3-Clause
//
// Exact points of pairs of moving bodies against quadratics, remainders and pads. There are joints, slides and turns by
// polynomials of time up to the fifth degree, and motions that only their author knows.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "body_cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace body_motion_test {
namespace {

using Kind = MotionElement::Kind;

double tauOf(Random& random) {
  const int kind = random.below(8);
  return kind == 0 ? -1 : kind == 1 ? 1 : kind == 2 ? 0 : random.in(-1, 1);
}

TEST(BodyMotionBounds, ExactPointsLieInTheQuadratic) {
  Random random(seedOf("BodyMotionBounds"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(45000) / 16;
  struct {
    int checks = 0, no_remainder = 0, small_pad = 0, turned = 0;
    double remainder = 0, pad = 0;
  } tally[2];  // of motions with derivatives; of some without
  for (int i = 0; i < cases; ++i) {
    const int mode = kRoundingModes[random.below(4)];
    const BodyCase c(random, mode);
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    PairOutput m;
    {
      const ScopedRounding scope(mode);
      subject.relate(c.in, m);
    }
    auto& counts = tally[c.in.sweep.first_order];
    for (int lane = 0; lane < 8; ++lane) {
      const double tau = tauOf(random);
      const RealRigid M_ab = c.relative(Real(c.in.tm[lane]) + Real(tau) * Real(c.in.d)), M_ba = M_ab.inverse();
      for (int side = 0; side < kSides; ++side) {
        const Eigen::Vector3d p = pointWithin(random, side ? c.extent_a : c.extent_b);
        const Real3 x = (side ? M_ba : M_ab) * exactly(p);
        const double error = norm(quadraticAt(m, side, lane, p, tau) - x).toDouble();
        const double rem = m.rem_c[side] + m.rem_R[side] * p.norm();
        ASSERT_LE(error, rem + m.pad) << "case " << i << " lane " << lane << " side " << side << " " << subject.name
                                      << " mode " << mode << " rem " << rem << " pad " << m.pad << " tau " << tau
                                      << " d " << c.in.d << " steps " << c.in.sweep.num_steps << " degree " << c.degree
                                      << " first order " << c.in.sweep.first_order;
        ++counts.checks;
        counts.turned += c.with_orientation;
        counts.no_remainder += error > m.pad;
        counts.small_pad += error > rem + 1e-4 * m.pad;
        if (rem > 1e3 * m.pad) counts.remainder = std::max(counts.remainder, error / rem);
        if (rem < 1e-3 * m.pad) counts.pad = std::max(counts.pad, error / m.pad);
      }
    }
  }
  for (const auto& t : tally) {
    std::printf(
        "%d checks; most of the remainder attained %.4f, of the pad %.4f; mutants: without remainder %d broken, pad "
        "/ 1e4 %d broken\n",
        t.checks, t.remainder, t.pad, t.no_remainder, t.small_pad);
    EXPECT_GT(t.checks, cases) << "too few cases of the kind";
    EXPECT_GT(t.remainder, 0.5) << "no motion comes near its bound: the test tells little";
    EXPECT_GT(t.no_remainder, 0);
    EXPECT_GT(t.turned, t.checks / 50) << "too few turns from an orientation";
  }
  EXPECT_GT(tally[0].small_pad, 0);
}

/// Motions whose third derivative has the same length throughout: the bound is attained in the limit.
TEST(BodyMotionBounds, RemaindersOfOneFactorAreAttained) {
  const double d = 1.0 / 64;
  const Eigen::Vector3d p(1, 0, 0);
  for (const Kind kind : {Kind::slide, Kind::turn}) {
    MotionElement e;
    e.kind = kind;
    if (kind == Kind::slide) {
      e.coefficients.col(3) = Eigen::Vector3d(0.3, -0.2, 0.1);
    } else {
      e.coefficients.col(0) = Eigen::Vector3d(0, 0, 0.3);
      e.coefficients.col(1) = Eigen::Vector3d(0, 0, 0.5);
    }
    FrameSweep sweep;
    const Carrier at = sweep.cross(Carrier(), e, 0, nullptr, true);
    std::vector<double> coefficients(e.coefficients.data(), e.coefficients.data() + e.coefficients.size());
    PairInput in;
    in.sweep = sweep.view();
    in.step_b = at.step;
    in.placement_b = makePlacement(at, RigidTransform());
    in.extents = 1;
    in.query.coefficients = coefficients.data();
    in.query.num_variables = 3;
    in.query.degree = kMaxDegree;
    in.d = d;
    for (double& tm : in.tm) tm = 0.5;
    Body body;
    body.motion.elements = {e};
    const Real3 x = body.pose(Real(0.5 + d)) * exactly(p);
    for (const Subject* subject : subjects()) {
      PairOutput m;
      subject->relate(in, m);
      const double error = norm(quadraticAt(m, 0, 0, p, 1) - x).toDouble();
      const double bound = m.rem_R[0] + m.rem_c[0] + m.pad;
      EXPECT_LE(error, bound) << subject->name;
      EXPECT_GT(error, 0.9999 * bound) << subject->name << " kind " << static_cast<int>(kind);
    }
  }
}

}  // namespace
}  // namespace body_motion_test
}  // namespace numerics_test
}  // namespace fcl_artic
