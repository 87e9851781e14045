// SPDX-License-Identifier: BSD-3-Clause
//
// Line swept spheres over time intervals: boxes that hold them, and certificates between them and with boxes that stand
// still. Bodies are placed so that they touch at a random time of a random lane, to the last few digits.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "cases.h"

namespace fcl_artic {
namespace numerics_test {
namespace lss_test {
namespace {

double tauOf(Random& random) {
  return random.chance(0.3) ? (random.chance(0.5) ? 1 : -1) : random.in(-1, 1);
}

/// A line swept sphere on the link that a case moves, and a point of its segment at one time.
struct Carried {
  Eigen::Vector3d end[2];  ///< on the link
  LssInput input;
  int lane;
  Real t;
  Real3 x;  ///< of the segment, in the world, at t

  Carried(Random& random, const PairCase& c) {
    input.step = c.carrier.step;
    for (int i = 0; i < 2; ++i) {
      end[i] = pointWithin(random, c.extent_b);
      if (i && random.chance(0.1)) end[1] = end[0];
      const Eigen::Vector3d p = c.carrier.offset * end[i];
      for (int k = 0; k < 3; ++k) input.lss[3 * i + k] = p[k];
    }
    lane = random.below(8);
    t = Real(c.in.tm[lane]) + Real(tauOf(random)) * Real(c.in.d);
    const double s = random.chance(0.5) ? random.unit() : random.below(2);
    const RealRigid M = c.pose(c.link_b, t);
    x = Real(1 - s) * (M * exactly(end[0])) + Real(s) * (M * exactly(end[1]));
  }
  /// The radius as a manager gives it: with the error of the ends in it.
  void setRadius(const PairCase& c, double radius) {
    const double reach = std::max(end[0].norm(), end[1].norm()) + c.carrier.length;
    input.lss[6] = radius + 0x1p-52 * (c.carrier.ulps + 16) * (radius + reach);
  }
};

/// Draws a link that its joints carry, and its line swept sphere, for f(subject, mode, c, body); a case without is left
/// out.
template <class F>
void drawCarried(Random& random, const F& f) {
  static const std::vector<const Subject*> tested = subjects();
  const int mode = kRoundingModes[random.below(4)];
  PairCase c(random, mode);
  if (c.link_a >= 0 || c.carrier.step < 0) return;
  const Subject& subject = *tested[static_cast<std::size_t>(random.below(static_cast<int>(tested.size())))];
  Carried body(random, c);
  f(subject, mode, c, body);
}

Eigen::Vector3d rounded(const Real3& x) {
  return {x[0].toDouble(), x[1].toDouble(), x[2].toDouble()};
}

/// Counts of a campaign of touching pairs.
struct Touching {
  int checks = 0, wrong = 0, wrong_mutant = 0, told_apart = 0;
  /// @param gap  how far the body's segment is from the other body without its radius.
  /// @param size  that errors scale with.
  /// @param setRadius  of the other body.
  /// @param ask  the lanes in which they are told apart.
  template <class SetRadius, class Ask>
  void check(double gap, double size, int mode, PairCase& c, Carried& body, const SetRadius& setRadius,
             const Ask& ask) {
    // A clearance is made up of both radii and a margin.
    const auto claims = [&](double clearance) {
      setRadius(0.25 * clearance);
      c.in.margin = 0.25 * clearance;
      body.setRadius(c, 0.5 * clearance);
      const ScopedRounding scope(mode);
      return (ask() >> body.lane & 1) != 0;
    };
    ++checks;
    wrong += claims(gap + 8e-15 * size);
    wrong_mutant += claims(gap * (1 - 1e-7) - 1e-12 * size);
    told_apart += claims(0.5 * gap);
  }
  void report() const {
    std::printf("%d touching pairs: %d told apart; 1e-7 nearer %d; at half their distance %d\n", checks, wrong,
                wrong_mutant, told_apart);
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(wrong_mutant, checks / 100) << "an error of 1e-7 would not be seen: the test tells little";
    EXPECT_GT(told_apart, checks / 10) << "hardly a pair is told apart: the certificate does nothing";
  }
};

TEST(LineSweptSphere, CertificateWithBoxIsNeverWrong) {
  Random random(seedOf("LssBox"));
  Touching touching;
  const auto check = [&](const Subject& subject, int mode, PairCase& c, Carried& body) {
    // A point of the box's surface, and a direction outwards there.
    StillBox box;
    Eigen::Vector3d y, out(0, 0, 0);
    const int face = random.below(3);
    for (int k = 0; k < 3; ++k) {
      const double middle = random.in(-1, 1) * c.extent_b,
                   half = random.chance(0.1) ? 0 : random.size(1e-3, 3) * c.extent_b;
      box.lo[k] = middle - half;
      box.hi[k] = middle + half;
      const int side = k == face || random.chance(0.4) ? random.below(2) : 2;
      y[k] = side == 2 ? random.in(box.lo[k], box.hi[k]) : side ? box.hi[k] : box.lo[k];
      if (side < 2) out[k] = (side ? 1 : -1) * (k == face ? 1.0 : random.unit());
    }
    out.normalize();
    const double gap = random.size(1e-3, 1) * c.extent_b;
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() = random.rotation();
    M.translation() = rounded(body.x) - M.linear() * (y + gap * out);
    box.inverse = makePlacement(stored(M).inverse());
    box.from_its_frame = touching.checks % 2 == 1;
    const double size = rounded(body.x).norm() + M.translation().norm() + y.norm() + gap + c.extent_b;
    const auto setRadius = [&](double radius) { box.radius = radius; };
    touching.check(gap, size, mode, c, body, setRadius, [&] { return subject.apartFromBox(c.in, body.input, box); });
  };
  while (touching.checks < scaled(20000)) drawCarried(random, check);
  touching.report();
}

TEST(LineSweptSphere, CertificateWithAnotherIsNeverWrong) {
  Random random(seedOf("LssLss"));
  Touching touching;
  const auto check = [&](const Subject& subject, int mode, PairCase& c, Carried& body) {
    // The other one stands still or is carried by a link above; its segment comes from a point near the first one's.
    LinkId link = c.link_b;
    for (int up = random.below(4); up > 0 && link >= 0; --up) link = c.tree.parentLink(link);
    const Carrier carrier = link >= 0 ? c.sweep->carrier(link) : Carrier();
    const RealRigid M = link >= 0 ? c.pose(link, body.t) : RealRigid();
    const double gap = random.size(1e-3, 1) * c.extent_b;
    const Real3 near = body.x + exactly(gap * random.direction());
    const Eigen::Vector3d on_link = rounded(M.inverse() * near);
    const Eigen::Vector3d along = random.direction() * random.size(1e-3, 2) * c.extent_b;
    const double part = random.chance(0.5) ? random.unit() : random.below(2);
    const Eigen::Vector3d end[2] = {on_link - part * along, on_link + (1 - part) * along};
    LssInput other;
    other.step = carrier.step;
    double reach = carrier.length;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d p = carrier.offset * end[i];
      for (int k = 0; k < 3; ++k) other.lss[3 * i + k] = p[k];
      reach += end[i].norm();
    }
    const Real3 y = Real(1 - part) * (M * exactly(end[0])) + Real(part) * (M * exactly(end[1]));
    const double distance = norm(body.x - y).toDouble();
    const double size = rounded(body.x).norm() + reach + gap;
    c.in.sweep = c.sweep->view();
    const auto setRadius = [&](double radius) { other.lss[6] = radius + 0x1p-52 * (carrier.ulps + 16) * reach; };
    touching.check(distance, size, mode, c, body, setRadius,
                   [&] { return subject.apartFromLss(c.in, body.input, other); });
  };
  while (touching.checks < scaled(20000)) drawCarried(random, check);
  touching.report();
}

TEST(LineSweptSphere, BoxesHoldIt) {
  Random random(seedOf("LssBoxes"));
  const int cases = scaled(10000) / 8;
  int i = 0, checks = 0;
  double least = 1;
  const auto check = [&](const Subject& subject, int mode, const PairCase& c, Carried& body) {
    const double radius = random.size(1e-3, 1);
    body.setRadius(c, radius);
    BoxOutput box;
    {
      const ScopedRounding scope(mode);
      subject.boundLss(c.in, body.input, box);
    }
    for (int lane = 0; lane < 8; ++lane) {
      const RealRigid M = c.pose(c.link_b, Real(c.in.tm[lane]) + Real(tauOf(random)) * Real(c.in.d));
      for (const Eigen::Vector3d& end : body.end) {
        const Real3 x = M * exactly(end);
        for (std::size_t k = 0; k < 3; ++k) {
          const Real below = x[k] - Real(radius) - Real(box.lo[lane][k]),
                     above = Real(box.hi[lane][k]) - x[k] - Real(radius);
          ASSERT_GE(below.toDouble(), 0) << "case " << i << " lane " << lane << " " << subject.name << " mode " << mode;
          ASSERT_GE(above.toDouble(), 0) << "case " << i << " lane " << lane << " " << subject.name << " mode " << mode;
          least = std::min({least, below.toDouble() / radius, above.toDouble() / radius});
        }
        ++checks;
      }
    }
  };
  for (; i < cases && !testing::Test::HasFatalFailure(); ++i) drawCarried(random, check);
  std::printf("%d checks; nearest a ball came to a wall: %.2g of its radius\n", checks, least);
  EXPECT_GT(checks, cases);
  EXPECT_LT(least, 1e-9) << "the boxes are never filled: the test tells little";
}

}  // namespace
}  // namespace lss_test
}  // namespace numerics_test
}  // namespace fcl_artic
