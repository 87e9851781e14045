// SPDX-License-Identifier: BSD-3-Clause
//
// The certificate's lower bounds of gaps, and the prefixes it proves, against exact gaps.
#include <cmath>

#include <gtest/gtest.h>

#include "cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace certificate_test {
namespace {

/// Quadratic with Bernstein coefficients G, exact.
Real bernstein(const double* G, double z) {
  const Real a = Real(1.0) - Real(z), b = z;
  return a * a * Real(G[0]) + Real(2.0) * a * b * Real(G[1]) + b * b * Real(G[2]);
}

TEST(Certificate, LowerBoundsAreBelowTheExactGap) {
  Random random(seedOf("Certificate"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(30000) / 16;
  int checks = 0, separated_lanes = 0, prefixes = 0, no_remainder = 0, small_pad = 0, no_middle = 0;
  int turning_prefixes = 0, still_direction = 0;
  double used = -1;  // part of the pad that rounding took
  for (int i = 0; i < cases; ++i) {
    const int mode = kRoundingModes[random.below(4)];
    PairCase c(random, mode);
    const OwnedPiece a(random, static_cast<engine::PieceKind>(random.below(kPieceKinds)), c.extent_a);
    const OwnedPiece b(random, static_cast<engine::PieceKind>(random.below(kPieceKinds)), c.extent_b);
    CertificateInput in;
    c.in.extents = a.extent() + b.extent();
    c.in.margin = random.chance(0.5) ? 0 : random.size(1e-6, random.chance(0.1) ? 1e3 : 0.1);
    in.motion = c.in;
    in.a = a.view();
    in.b = b.view();
    in.side = random.below(2);
    // Mostly the direction between the bodies somewhere in the intervals, so that many gaps are positive.
    const RealRigid M_mid = c.relative(Real(c.in.tm[random.below(8)]));
    const Real3 between = in.side ? M_mid.inverse().t : M_mid.t;
    Eigen::Vector3d n(between[0].toDouble(), between[1].toDouble(), between[2].toDouble());
    n = random.chance(0.7) && n.norm() > 0 ? n.normalized() : random.direction();
    if (random.chance(0.1)) n = Eigen::Vector3d::Unit(random.below(3));
    for (int k = 0; k < 3; ++k) in.n[k] = n[k];
    const bool unbounded_piece = std::max(a.piece.kind, b.piece.kind) >= engine::PieceKind::halfspace;
    const Eigen::Vector3d turn = random.size(1e-9, 1) * random.direction();
    for (int k = 0; k < 3; ++k) in.turn[k] = turn[k];
    const Real3 exact_n = unit(exactly(n));
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    CertificateOutput out;
    PairOutput m;
    {
      const ScopedRounding scope(mode);
      subject.certify(in, out, m);
    }
    ASSERT_EQ(out.separated_few, out.separated) << "case " << i << " " << subject.name << " mode " << mode;
    const OwnedPiece &still = in.side ? b : a, &moving = in.side ? a : b;
    const double rem = m.rem_c[in.side] + m.rem_R[in.side] * moving.piece.reach;
    for (int lane = 0; lane < 8; ++lane) {
      const auto gapAt = [&](double tau, const Real3& direction) {
        const RealRigid M_ab = c.relative(Real(c.in.tm[lane]) + Real(tau) * Real(c.in.d));
        return gapAlong(still, moving, in.side ? M_ab.inverse() : M_ab, direction) - Real(c.in.margin);
      };
      const double z = random.chance(0.2) ? 0 : random.chance(0.2) ? 1 : random.below(1025) * 0x1p-10, tau = 2 * z - 1;
      const Real gap = gapAt(tau, exact_n), bound = bernstein(out.G[lane], z);
      ++checks;
      const auto where = [&] {
        return "case " + std::to_string(i) + " lane " + std::to_string(lane) + " " + subject.name + " mode " +
               std::to_string(mode) + " kinds " + std::to_string(static_cast<int>(still.piece.kind)) + " " +
               std::to_string(static_cast<int>(moving.piece.kind));
      };
      ASSERT_LE(bound, gap) << where() << " by " << (bound - gap).toDouble() << " pad " << m.pad;
      used = std::max(used, 1 - (gap - bound).toDouble() / m.pad);
      no_remainder += bound + Real(rem) > gap;
      small_pad += bound + Real(m.pad * (1 - 1e-4)) > gap;
      const double dropped[3] = {out.G[lane][0], std::max(out.G[lane][0], out.G[lane][2]), out.G[lane][2]};
      no_middle += bernstein(dropped, z) > gap;
      if (out.separated >> lane & 1) {
        ++separated_lanes;
        ++checks;
        ASSERT_GT(max(gapAt(tau, exact_n), gapAt(tau, Real(-1.0) * exact_n)), Real(0.0)) << where();
      }
      if (in.side == 0 && !unbounded_piece) {
        // The direction at this time, as long as it is; the bound is of what it tells, times its length.
        const auto turned = [&](double at) {
          Real3 d;
          for (int k = 0; k < 3; ++k) {
            const Real begin(in.n[k] - in.turn[k]), end(in.n[k] + in.turn[k]);
            d[k] = begin + Real(at) * (end - begin);
          }
          return d;
        };
        const auto gapTurned = [&](double at) {
          const Real3 d = turned(at);
          const Real length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
          return length * gapAt(2 * at - 1, unit(d));
        };
        const Real turning = bernstein(out.turning_G[lane], z);
        ++checks;
        ASSERT_LE(turning, gapTurned(z)) << where();
        still_direction += turning > Real(gap);
        if (out.turning_prefix[lane] > 0) {
          ++turning_prefixes;
          ++checks;
          const double at = out.turning_prefix[lane] * (random.chance(0.5) ? 1 : random.unit());
          ASSERT_GT(gapTurned(at), Real(0.0)) << where() << " prefix " << out.turning_prefix[lane];
        }
      }
      if (out.prefix[lane] > 0) {
        ++prefixes;
        ++checks;
        const double at = out.prefix[lane] * (random.chance(0.5) ? 1 : random.unit());
        ASSERT_GT(gapAt(2 * at - 1, exact_n), Real(0.0)) << where() << " prefix " << out.prefix[lane];
      }
    }
  }
  std::printf("%d checks, %d separated lanes, %d prefixes; most of the pad used %.4f\n", checks, separated_lanes,
              prefixes, used);
  std::printf("mutants: without remainder %d broken, pad / 1e4 %d broken, one Bernstein point less %d broken\n",
              no_remainder, small_pad, no_middle);
  std::printf("turning: %d prefixes; taken for a direction that stands still %d broken\n", turning_prefixes,
              still_direction);
  EXPECT_GT(turning_prefixes, cases / 4);
  EXPECT_GT(still_direction, 0);
  EXPECT_GT(separated_lanes, cases / 2);
  EXPECT_GT(prefixes, cases / 2);
  EXPECT_GT(no_remainder, 0);
  EXPECT_GT(small_pad, 0);
  EXPECT_GT(no_middle, 0);
}

/// GJK's results for whole lanes (narrowphase/swept_difference.h). Its support points are those of the certificate. A
/// direction that it says separates does so, and if it finds none there is none.
TEST(Certificate, DirectionsForWholeLanesAreFoundWhereThereIsOne) {
  Random random(seedOf("WholeLanes"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(100000) / 64;
  int told = 0, middle = 0, none = 0, found_elsewhere = 0;
  for (int i = 0; i < cases; ++i) {
    PairCase c(random, kRoundingModes[0]);
    const OwnedPiece a(random, static_cast<engine::PieceKind>(random.below(kPieceKinds)), c.extent_a);
    const OwnedPiece b(random, static_cast<engine::PieceKind>(random.below(kPieceKinds)), c.extent_b);
    if (std::max(a.piece.kind, b.piece.kind) >= engine::PieceKind::halfspace) continue;
    CertificateInput in;
    c.in.extents = a.extent() + b.extent();
    c.in.margin = random.chance(0.5) ? 0 : random.size(1e-6, 0.1);
    // Long parts of the motion, and near each other: so that there is something to look for.
    for (int k = 0; k < 8; ++k) c.in.tm[k] = (k + 0.5) / 8;
    c.in.d = 0.0625;
    const Real3 t = c.relative(Real(c.in.tm[random.below(8)])).t;
    const Eigen::Vector3d from(t[0].toDouble(), t[1].toDouble(), t[2].toDouble());
    const Eigen::Vector3d nearby = random.in(0.2, 2) * c.in.extents * random.direction();
    c.offset_a = c.offset_a * Eigen::Translation3d(from - nearby);
    c.in.inverse_a = makePlacement(stored(c.offset_a).inverse());
    in.motion = c.in;
    in.a = a.view();
    in.b = b.view();
    in.side = random.below(2);
    const auto towards = [&](const Eigen::Vector3d& n) {
      for (int k = 0; k < 3; ++k) in.n[k] = n[k];
    };
    towards(random.direction());
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    CertificateOutput along;
    PairOutput m;
    WholeLanesOutput out;
    subject.certify(in, along, m);
    subject.searchWholeLanes(in, out);
    const double size = c.in.extents + m.rem_c[in.side] + 1e3 * m.pad;
    for (int lane = 0; lane < 8; ++lane) {
      const double* G = along.G[lane];
      const double expected = std::min({G[0], G[1], G[2]}) + out.slack;
      ASSERT_NEAR(out.least[lane], expected, 1e-11 * (size + std::abs(expected) + out.slack)) << "case " << i;
    }
    ASSERT_EQ(out.certified, out.told) << "case " << i << " " << subject.name;
    unsigned elsewhere = out.middle;
    for (int other = 0; other < 32; ++other) {
      towards(random.direction());
      subject.certify(in, along, m);
      elsewhere |= along.separated;
    }
    told += __builtin_popcount(out.told);
    middle += __builtin_popcount(out.middle);
    none += 8 - __builtin_popcount(out.told);
    found_elsewhere += __builtin_popcount(elsewhere & ~out.told);
  }
  std::printf("%d lanes with a direction that separates, the middle's witness does in %d; %d without\n", told, middle,
              none);
  EXPECT_EQ(found_elsewhere, 0);
  EXPECT_GT(told, middle);
  EXPECT_GT(middle, cases);
  EXPECT_GT(none, cases);
}

/// The pad is shown to be needed where bodies are small and far away.
TEST(Certificate, PadScalesWithAbsoluteCoordinates) {
  Random random(seedOf("CertificateFar"));
  const int cases = scaled(2000);
  int broken = 0;
  for (int i = 0; i < cases; ++i) {
    const int mode = kRoundingModes[random.below(4)];
    PairCase c(random, mode);
    // Two spheres of 1 mm, 1000 m from the base frame.
    c.link_b = c.tree.numLinks() - 1;
    c.offset_a = Eigen::Isometry3d(Eigen::Translation3d(1000 * random.direction()));
    const OwnedPiece a(random, engine::PieceKind::point, 1e-3, true), b(random, engine::PieceKind::point, 1e-3, true);
    CertificateInput in;
    c.in.inverse_a = makePlacement(stored(c.offset_a).inverse());
    c.in.extents = a.extent() + b.extent();
    c.carrier = c.sweep->carrier(c.link_b);
    c.in.sweep = c.sweep->view();
    c.in.step_b = c.carrier.step;
    c.in.placement_b = makePlacement(c.carrier, stored(c.offset_b));
    in.motion = c.in;
    in.a = a.view();
    in.b = b.view();
    const Eigen::Vector3d n = random.direction();
    for (int k = 0; k < 3; ++k) in.n[k] = n[k];
    CertificateOutput out;
    PairOutput m;
    {
      const ScopedRounding scope(mode);
      subjects().back()->certify(in, out, m);
    }
    const Real gap = gapAlong(a, b, c.relative(Real(c.in.tm[0]) - Real(c.in.d)), unit(exactly(n)));
    ASSERT_LE(Real(out.G[0][0]), gap);
    broken += Real(out.G[0][0]) + Real(m.rem_c[0]) + Real(m.pad * (1 - 1e-4)) > gap;
  }
  std::printf("mutant: pad / 1e4 %d of %d broken\n", broken, cases);
  EXPECT_GT(broken, 0);
}

/// The prefix is [0, z] with G > 0: whatever the coefficients, cancelling ones above all.
TEST(Certificate, PrefixEndsBeforeTheFirstRoot) {
  Random random(seedOf("Prefix"));
  const int cases = scaled(20000);
  const auto value = [&] {
    const double x = random.chance(0.5) ? random.size(1e-17, 1) : random.in(0, 1);
    return random.chance(0.5) ? x : -x;
  };
  int whole = 0, part = 0, naive_broken = 0;
  double shortest = 1;  // how much of the way to the root is taken
  for (int i = 0; i < cases; ++i) {
    double G[3] = {std::abs(value()), value(), value()};
    if (random.chance(0.2)) {  // near-double root
      const double r = random.unit(), e = random.size(1e-17, 1e-3) * (random.chance(0.5) ? 1 : -1);
      G[0] = r * r + e;
      G[1] = r * (r - 1) + e;
      G[2] = (1 - r) * (1 - r) + e;
    }
    const int mode = kRoundingModes[random.below(4)];
    double z;
    {
      const ScopedRounding scope(mode);
      z = subjects()[static_cast<std::size_t>(random.below(static_cast<int>(subjects().size())))]->positivePrefix(G);
    }
    ASSERT_GE(z, 0);
    ASSERT_LE(z, 1);
    if (z == 0) continue;
    (z == 1 ? whole : part) += 1;
    // Exact coefficients of the part [0, z]: the least value is at an end or at the vertex.
    const Real a = Real(G[0]) - Real(2.0) * Real(G[1]) + Real(G[2]), b = Real(G[1]) - Real(G[0]);
    ASSERT_GT(bernstein(G, z), Real(0.0)) << G[0] << " " << G[1] << " " << G[2] << " z " << z << " mode " << mode;
    if (a > Real(0.0)) {
      const Real vertex = -b / a;
      if (vertex > Real(0.0) && vertex < Real(z)) {
        ASSERT_GT(Real(G[0]) - b * b / a, Real(0.0)) << G[0] << " " << G[1] << " " << G[2] << " z " << z;
      }
    }
    const Real disc = b * b - a * Real(G[0]);
    if (z < 1 && disc > Real(0.0)) {
      const Real root = Real(G[0]) / (sqrt(disc) - b);
      if (root > Real(0.0) && root <= Real(1.0) && G[0] > 1e-10) {
        shortest = std::min(shortest, (Real(z) / root).toDouble());
      }
      // The textbook's stable form for b < 0 cancels for b > 0.
      const double ad = G[0] - 2 * G[1] + G[2], bd = G[1] - G[0], q = -bd + std::sqrt(bd * bd - ad * G[0]);
      const double naive = q > 0 && G[0] / q < 1 ? G[0] / q * (1 - 1e-12) : 1;
      naive_broken += !(bernstein(G, naive) > Real(-8 * 0x1p-52));
    }
  }
  std::printf("%d whole, %d in part; shortest part of the way to a root that is not at the very start %.6f\n", whole,
              part, shortest);
  std::printf("mutant: cancelling root %d broken\n", naive_broken);
  EXPECT_GT(whole, cases / 20);
  EXPECT_GT(part, cases / 10);
  EXPECT_GT(naive_broken, 0);
  EXPECT_GT(shortest, 0.99);
}

}  // namespace
}  // namespace certificate_test
}  // namespace numerics_test
}  // namespace fcl_artic
