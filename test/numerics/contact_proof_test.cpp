// SPDX-License-Identifier: BSD-3-Clause
//
// A proof of contact is never given for pieces that are apart, however near.
#include <cmath>

#include <gtest/gtest.h>

#include "cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace {

using engine::PieceKind;

/// A pose of B, in doubles, with the wanted gap along n up to rounding.
struct NearPose {
  TouchInput in;
  RealRigid M_ab;  ///< exactly the stored numbers
  Eigen::Vector3d n;

  NearPose(Random& random, const OwnedPiece& a, const OwnedPiece& b, bool aligned, double gap, double shift) {
    Eigen::Matrix3d R = aligned ? Eigen::Matrix3d::Identity() : random.rotation();
    n = aligned || random.chance(0.1) ? Eigen::Vector3d(Eigen::Vector3d::Unit(random.below(3))) : random.direction();
    if (random.chance(0.5)) n = -n;
    for (std::size_t j = 0; j < 3; ++j) M_ab.R[j] = exactly(R.col(static_cast<int>(j)));
    // Centre to centre; sideways of the contact direction faces and edges slide over each other.
    Eigen::Vector3d c = shift * random.direction();
    c += Eigen::Vector3d::Map(a.piece.center) - R * Eigen::Vector3d::Map(b.piece.center);
    M_ab.t = exactly(c);
    const double now = gapAlong(a, b, M_ab, exactly(n)).toDouble();
    c += (gap - now) * n;
    M_ab.t = exactly(c);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) in.R[3 * i + j] = R(i, j);
      in.c[i] = c[i];
      in.guess[i] = n[i];
    }
    in.a = a.view();
    in.b = b.view();
    // As relateBodies() does for a pose, of bodies that stand still.
    in.eps = 0x1p-52 * 40 * (c.norm() + a.extent() + b.extent()) + 1e-40;
  }
};

TEST(ContactProof, NeverForPiecesThatAreApart) {
  Random random(seedOf("ContactProof"));
  const std::vector<const Subject*> tested = subjects();
  const int rounds = scaled(15000) / (kPieceKinds * kPieceKinds);
  int apart = 0, deep = 0, proven = 0;
  for (int i = 0; i < rounds; ++i) {
    for (int kinds = 0; kinds < kPieceKinds * kPieceKinds; ++kinds) {
      const bool aligned = random.chance(0.4);
      const double size = random.size(1e-3, 10);
      const OwnedPiece a(random, static_cast<PieceKind>(kinds / kPieceKinds), size, random.chance(0.7));
      const OwnedPiece b(random, static_cast<PieceKind>(kinds % kPieceKinds), size, random.chance(0.7));
      NearPose pose(random, a, b, aligned, random.size(1e-16, 1e-9) * size, aligned ? 0.1 * size : 0);
      if (!(gapAlong(a, b, pose.M_ab, exactly(pose.n)) > Real(0.0))) continue;
      ++apart;
      const int mode = kRoundingModes[random.below(4)];
      const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
      bool touching;
      {
        const ScopedRounding scope(mode);
        touching = subject.certainlyTouching(pose.in);
      }
      ASSERT_FALSE(touching) << "round " << i << " kinds " << kinds << " " << subject.name << " mode " << mode
                             << (aligned ? " aligned" : "");
      // Symmetric pieces head on, a millionth of their size deep: a proof is due.
      const auto symmetric = [](const OwnedPiece& p) {
        return p.piece.kind != PieceKind::vertices && p.piece.kind != PieceKind::hull &&
               p.piece.kind != PieceKind::cone;
      };
      if (symmetric(a) && symmetric(b)) {
        NearPose overlapping(random, a, b, true, -1e-6 * size, 0);
        ++deep;
        proven += subject.certainlyTouching(overlapping.in);
      }
    }
  }
  std::printf("%d poses apart; %d of %d overlapping ones proven\n", apart, proven, deep);
  EXPECT_GT(apart, rounds * kPieceKinds * kPieceKinds / 3);
  EXPECT_GT(proven, 0.99 * deep);
}

/// Far from the origin support points are off by more than the gap: the proof must know.
TEST(ContactProof, NeverForPiecesThatAreApartFarAway) {
  Random random(seedOf("ContactProofFar"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(10000);
  int apart = 0, trusting_broken = 0;
  for (int i = 0; i < cases; ++i) {
    OwnedPiece a(random, static_cast<PieceKind>(2 + random.below(kPieceKinds - 2)), 1e-3, true);
    OwnedPiece b(random, static_cast<PieceKind>(2 + random.below(kPieceKinds - 2)), 1e-3, true);
    const Eigen::Vector3d far = 1000 * random.direction();
    for (int k = 0; k < 3; ++k) {
      a.piece.center[k] = far[k];
      b.piece.center[k] = -far[k];
    }
    a.piece.reach = b.piece.reach = 1001;
    NearPose pose(random, a, b, random.chance(0.5), random.size(1e-14, 1e-12), 1e-4);
    if (!(gapAlong(a, b, pose.M_ab, exactly(pose.n)) > Real(0.0))) continue;
    ++apart;
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    const ScopedRounding scope(kRoundingModes[random.below(4)]);
    TouchInput trusting = pose.in;
    trusting.eps *= 1e-4;
    trusting_broken += subject.certainlyTouching(trusting);
    ASSERT_FALSE(subject.certainlyTouching(pose.in)) << "case " << i << " " << subject.name;
  }
  std::printf("%d poses apart; mutant: eps / 1e4 %d broken\n", apart, trusting_broken);
  EXPECT_GT(apart, cases / 3);
  EXPECT_GT(trusting_broken, 0);
}

}  // namespace
}  // namespace numerics_test
}  // namespace fcl_artic
