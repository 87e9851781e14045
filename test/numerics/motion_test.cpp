// SPDX-License-Identifier: BSD-3-Clause
//
// Exact points of random robots against quadratics, remainders, pads and swept boxes.
#include <cmath>

#include <gtest/gtest.h>

#include "cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace motion_test {
namespace {

double tauOf(Random& random) {
  const int kind = random.below(8);
  return kind == 0 ? -1 : kind == 1 ? 1 : kind == 2 ? 0 : random.in(-1, 1);
}

/// How often a bound broke, and how nearly it was attained.
struct Tally {
  int checks = 0, broken = 0;
  double attained = 0;
  void add(double error, double bound) {
    ++checks;
    broken += !(error <= bound);
    attained = std::max(attained, error / bound);
  }
};

TEST(Motion, ExactPointsLieInTheQuadratic) {
  Random random(seedOf("Motion"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(45000) / 16;
  Tally all, remainder, pad, no_remainder, small_pad;
  for (int i = 0; i < cases; ++i) {
    const int mode = kRoundingModes[random.below(4)];
    const PairCase c(random, mode);
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    PairOutput m;
    {
      const ScopedRounding scope(mode);
      subject.relate(c.in, m);
    }
    for (int lane = 0; lane < 8; ++lane) {
      const double tau = tauOf(random);
      const RealRigid M_ab = c.relative(Real(c.in.tm[lane]) + Real(tau) * Real(c.in.d)), M_ba = M_ab.inverse();
      for (int side = 0; side < kSides; ++side) {
        const Eigen::Vector3d p = pointWithin(random, side ? c.extent_a : c.extent_b);
        const Real3 x = (side ? M_ba : M_ab) * exactly(p);
        const double error = norm(quadraticAt(m, side, lane, p, tau) - x).toDouble();
        const double rem = m.rem_c[side] + m.rem_R[side] * p.norm();
        all.add(error, rem + m.pad);
        if (rem > 1e3 * m.pad) remainder.add(error, rem);
        if (rem < 1e-3 * m.pad) pad.add(error, m.pad);
        no_remainder.add(error, m.pad);
        small_pad.add(error, rem + 1e-4 * m.pad);
        ASSERT_LE(error, rem + m.pad) << "case " << i << " lane " << lane << " side " << side << " " << subject.name
                                      << " mode " << mode << " rem " << rem << " pad " << m.pad << " tau " << tau;
      }
    }
  }
  std::printf("%d checks; most of the remainder attained %.4f (%d), of the pad %.4f (%d)\n", all.checks,
              remainder.attained, remainder.checks, pad.attained, pad.checks);
  std::printf("mutants: without remainder %d broken, pad / 1e4 %d broken\n", no_remainder.broken, small_pad.broken);
  EXPECT_GT(remainder.attained, 0.5) << "no motion comes near its bound: the test tells little";
  EXPECT_GT(no_remainder.broken, 0);
  EXPECT_GT(small_pad.broken, 0);
}

/// Third derivative of a point on a circle: |x'''| = s^3 r exactly, so that the bound is attained in the limit.
TEST(Motion, RemainderOfOneRevoluteJointIsAttained) {
  KinematicTree tree;
  tree.addLink("base");
  tree.addLink("arm");
  Joint joint;
  joint.name = "turn";
  joint.type = JointType::revolute;
  joint.parent = "base";
  joint.child = "arm";
  joint.axis = Eigen::Vector3d::UnitZ();
  tree.addJoint(joint);
  FrameSweep sweep = FrameSweep::fromWorld(tree);
  const double q0 = 0.3, dq = 0.5;
  PairInput in;
  in.sweep = sweep.view();
  in.step_b = sweep.carrier(1).step;
  in.extents = 1;
  const double coefficients[2] = {q0, dq};
  in.query.coefficients = coefficients;
  in.query.num_variables = 1;
  in.d = 1.0 / 64;
  for (double& tm : in.tm) tm = 0.5;
  for (const Subject* subject : subjects()) {
    PairOutput m;
    subject->relate(in, m);
    const Eigen::Vector3d p(1, 0, 0);
    const Real q = Real(q0) + Real(dq) * (Real(0.5) + Real(in.d));
    const Real3 x = rotation({0.0, 0.0, 1.0}, q) * exactly(p);
    const double error = norm(quadraticAt(m, 0, 0, p, 1) - x).toDouble(), bound = m.rem_R[0] + m.rem_c[0] + m.pad;
    EXPECT_LE(error, bound) << subject->name;
    EXPECT_GT(error, 0.9999 * bound) << subject->name;
  }
}

TEST(Motion, SweptNodesHoldExactPoints) {
  Random random(seedOf("SweptNodes"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(12000) / 8;
  int checks = 0;
  double least = 1;  // distance to the box's wall as a part of its width
  for (int i = 0; i < cases; ++i) {
    const int mode = kRoundingModes[random.below(4)];
    const PairCase c(random, mode);
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    const int side = random.below(2);
    const double extent = side ? c.extent_a : c.extent_b;
    engine::Node node;
    for (int k = 0; k < 3; ++k) {
      const double middle = random.in(-0.4, 0.4) * extent, half = random.unit() * 0.15 * extent;
      node.lo[k] = static_cast<float>(middle - half);
      node.hi[k] = static_cast<float>(middle + half);
    }
    BoxOutput box;
    {
      const ScopedRounding scope(mode);
      subject.sweepNode(c.in, side, node, box);
    }
    for (int lane = 0; lane < 8; ++lane) {
      const double tau = tauOf(random);
      const RealRigid M_ab = c.relative(Real(c.in.tm[lane]) + Real(tau) * Real(c.in.d));
      const RealRigid M = side ? M_ab.inverse() : M_ab;
      for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d p;
        for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) ? node.hi[k] : node.lo[k];
        const Real3 x = M * exactly(p);
        for (std::size_t k = 0; k < 3; ++k) {
          const Real below = x[k] - Real(box.lo[lane][k]), above = Real(box.hi[lane][k]) - x[k];
          ASSERT_GE(below.toDouble(), 0) << "case " << i << " lane " << lane << " " << subject.name << " mode " << mode;
          ASSERT_GE(above.toDouble(), 0) << "case " << i << " lane " << lane << " " << subject.name << " mode " << mode;
          least = std::min({least, (below / (below + above)).toDouble(), (above / (below + above)).toDouble()});
        }
        ++checks;
      }
    }
  }
  std::printf("%d checks; nearest a point came to a wall: %.2g of the width\n", checks, least);
  EXPECT_LT(least, 1e-4) << "the boxes are never nearly filled: the test tells little";
}

}  // namespace
}  // namespace motion_test
}  // namespace numerics_test
}  // namespace fcl_artic
