// SPDX-License-Identifier: BSD-3-Clause
//
// A proof of contact is never given for pieces that are apart, however near.
#include <cmath>

#include <gtest/gtest.h>

#include "cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace contact_proof_test {
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

/// Bodies that the short proofs know, far from the origin in half of the cases.
void moveAway(Random& random, OwnedPiece& a, OwnedPiece& b) {
  if (random.chance(0.5)) return;
  const Eigen::Vector3d far = 1000 * random.direction();
  for (OwnedPiece* piece : {&a, &b}) {
    const double sign = piece == &a ? 1 : -1;
    for (int k = 0; k < 3; ++k) {
      piece->piece.center[k] += piece->vertices.empty() ? sign * far[k] : 0;
      for (std::size_t i = static_cast<std::size_t>(k); i < piece->vertices.size(); i += 3)
        piece->vertices[i] += sign * far[k];
    }
    piece->piece.reach += 1001;
  }
}

/// A vertex within a solid, by the solid's own inequalities: never outside, always where it is deep enough.
TEST(ContactProof, VertexWithinASolidOnlyWhereItIs) {
  Random random(seedOf("VertexWithin"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(20000);
  int outside = 0, trusting_broken = 0, deep = 0, proven = 0;
  for (int i = 0; i < cases; ++i) {
    constexpr PieceKind kKnown[] = {PieceKind::box, PieceKind::cylinder, PieceKind::segment, PieceKind::point};
    const double size = random.size(1e-3, 10);
    OwnedPiece solid(random, kKnown[random.below(4)], size), vertex(random, PieceKind::point, size);
    vertex.piece.radius = 0;
    moveAway(random, solid, vertex);
    const bool aligned = random.chance(0.5);
    const double eps = 0x1p-52 * 40 * 4000;  // about the largest below
    NearPose near(random, solid, vertex, aligned, random.size(1e-16, 1e-9), 0);
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    const ScopedRounding scope(kRoundingModes[random.below(4)]);
    if (gapAlong(solid, vertex, near.M_ab, exactly(near.n)) > Real(0.0)) {
      ++outside;
      ASSERT_FALSE(subject.certainlyWithin(near.in)) << "case " << i << " " << subject.name;
      TouchInput trusting = near.in;
      trusting.eps *= 1e-4;
      trusting_broken += subject.certainlyWithin(trusting);
    }
    // Head on, deeper than twice the error.
    const NearPose inside(random, solid, vertex, true, -3 * eps - 1e-9 * size, 0);
    if (3 * eps > 0.02 * size) continue;
    ++deep;
    proven += subject.certainlyWithin(inside.in);
  }
  std::printf("%d vertices outside; %d of %d inside proven; mutant: eps / 1e4 %d broken\n", outside, proven, deep,
              trusting_broken);
  EXPECT_GT(outside, cases / 3);
  EXPECT_GT(trusting_broken, 0);
  EXPECT_GT(deep, cases / 3);
  EXPECT_EQ(proven, deep);
}

/// A chord of a solid through a triangle: never where they are apart, always through the middle of one.
TEST(ContactProof, ChordPiercesOnlyWhatItMeets) {
  Random random(seedOf("ChordPierces"));
  const std::vector<const Subject*> tested = subjects();
  const int cases = scaled(20000);
  int apart = 0, trusting_broken = 0, through = 0, proven = 0;
  for (int i = 0; i < cases; ++i) {
    constexpr PieceKind kKnown[] = {PieceKind::segment, PieceKind::cone, PieceKind::cylinder, PieceKind::box};
    const double size = random.size(1e-3, 10);
    OwnedPiece solid(random, kKnown[random.below(4)], size), triangle(random, PieceKind::vertices, size);
    triangle.vertices.resize(9);
    triangle.piece.num_vertices = 3;
    if (solid.piece.kind == PieceKind::segment) solid.piece.radius = 0;  // the chord is all of it
    moveAway(random, solid, triangle);
    const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
    const ScopedRounding scope(kRoundingModes[random.below(4)]);
    const auto neverWhereApart = [&](const TouchInput& in, const RealRigid& M_ab, const Eigen::Vector3d& n) {
      if (!(gapAlong(solid, triangle, M_ab, exactly(n)) > Real(0.0))) return;
      ++apart;
      ASSERT_FALSE(subject.certainlyPierces(in)) << "case " << i << " " << subject.name;
      TouchInput trusting = in;
      trusting.eps *= 1e-4;
      trusting_broken += subject.certainlyPierces(trusting);
    };
    NearPose near(random, solid, triangle, random.chance(0.3), random.size(1e-16, 1e-9) * size, 0);
    neverWhereApart(near.in, near.M_ab, near.n);
    // The same with an end before the triangle's middle, then with half of an axis behind it.
    const auto corner = [&](int k) { return Eigen::Vector3d::Map(triangle.vertices.data() + 3 * k); };
    const Eigen::Matrix3d R = Eigen::Matrix3d::Map(near.in.R).transpose();
    const Eigen::Vector3d middle = R * (corner(0) + corner(1) + corner(2)) / 3;
    const Eigen::Vector3d normal = R * (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const bool box = solid.piece.kind == PieceKind::box;
    int along = 2;
    for (int k = 0; k < 3 && box; ++k) along = solid.piece.size[k] > solid.piece.size[along] ? k : along;
    Eigen::Vector3d on_axis = Eigen::Vector3d::Map(solid.piece.center);
    on_axis[along] += solid.piece.size[along];
    const Eigen::Vector3d n = (normal[along] < 0 ? -1 : 1) * normal.normalized();
    TouchInput before = near.in;
    RealRigid M_before = near.M_ab;
    const Eigen::Vector3d c = on_axis - middle + random.size(1e-16, 1e-9) * n;
    Eigen::Vector3d::Map(before.c) = c;
    M_before.t = exactly(c);
    neverWhereApart(before, M_before, n);
    on_axis[along] -= 0.5 * solid.piece.size[along];
    // A triangle that is neither narrow nor edge-on.
    if (std::abs(normal[along]) < 0.1 * size * size || triangle.extent() > 100 * size) continue;
    TouchInput pierced = near.in;
    for (int k = 0; k < 3; ++k) pierced.c[k] = on_axis[k] - middle[k];
    ++through;
    proven += subject.certainlyPierces(pierced);
  }
  std::printf("%d chords apart; %d of %d through a triangle proven; mutant: eps / 1e4 %d broken\n", apart, proven,
              through, trusting_broken);
  EXPECT_GT(apart, cases / 3);
  EXPECT_GT(trusting_broken, 0);
  EXPECT_GT(through, cases / 50);
  EXPECT_EQ(proven, through);
}

}  // namespace
}  // namespace contact_proof_test
}  // namespace numerics_test
}  // namespace fcl_artic
