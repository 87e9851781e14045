// SPDX-License-Identifier: BSD-3-Clause
//
// Exact points of pairs of moving bodies against quadratics, remainders and pads: joints, slides and turns by
// polynomials of time up to the fifth degree, and motions that only their author knows.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "cases.h"
#include "motion/body_motion.h"

namespace fcl_artic {
namespace numerics_test {
namespace {

using Kind = MotionElement::Kind;

/// The origin swings, c + s sin(k t), while the body turns about `axis` by the angle turn sin(m t) from R on. What it
/// tells of itself is off by 1e-12 of each number's size, as an author's word may be; or it knows speeds only, and all
/// derivatives it gives are wrong.
struct Sway {
  Eigen::Matrix3d R;
  Eigen::Vector3d c, s, axis;
  double k, turn, m;
  bool derivatives;
  double noise[24];

  Sway(Random& random, double scale)
      : R(random.rotation()),
        c(scale * random.unit() * random.direction()),
        s(scale * random.unit() * random.direction()),
        axis(random.direction()),
        k(random.in(0, 6)),
        turn(random.in(0, 3)),
        m(random.in(0, 4)),
        derivatives(random.chance(0.6)) {
    for (double& x : noise) x = random.in(-1, 1);
  }

  RealRigid pose(const Real& t) const {
    RealRigid own;
    for (int j = 0; j < 3; ++j) own.R[static_cast<std::size_t>(j)] = exactly(R.col(j));
    own = properly(Eigen::Isometry3d(R));
    RealRigid moved = rotation(unit(exactly(axis)), Real(turn) * sin(Real(m) * t)) * own;
    moved.t = exactly(c) + sin(Real(k) * t) * exactly(s);
    return moved;
  }

  static void state(const void* self, double t, double* out) {
    const Sway& o = *static_cast<const Sway*>(self);
    const double sk = std::sin(o.k * t), ck = std::cos(o.k * t), sm = std::sin(o.m * t), cm = std::cos(o.m * t);
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(out, 3, 3) = Eigen::AngleAxisd(o.turn * sm, o.axis).toRotationMatrix() * o.R;
    Eigen::Vector3d::Map(out + 9) = o.c + sk * o.s;
    Eigen::Vector3d::Map(out + 12) = o.k * ck * o.s;
    Eigen::Vector3d::Map(out + 15) = -o.k * o.k * sk * o.s;
    Eigen::Vector3d::Map(out + 18) = o.turn * o.m * cm * o.axis;
    Eigen::Vector3d::Map(out + 21) = -o.turn * o.m * o.m * sm * o.axis;
    for (int i = 0; i < 24; ++i) {
      if (i >= 12 && !o.derivatives) {
        out[i] = 1e3 * o.noise[i];
      } else {  // rotations: 3e-13 in each entry keeps R^T R within 1e-12 of 1
        out[i] += i < 9 ? 3e-13 * o.noise[i] : 5e-13 * o.noise[i] * Eigen::Vector3d::Map(out + i / 3 * 3).norm();
      }
    }
  }
  static void bounds(const void* self, double, double, double* out) {
    const Sway& o = *static_cast<const Sway*>(self);
    const double s = o.s.norm() * (1 + 1e-15);
    for (int n = 0; n < 3; ++n) {
      out[n] = s * std::pow(o.k, n + 1) * (1 + 1e-14);
      out[3 + n] = o.turn * std::pow(o.m, n + 1) * (1 + 1e-14);
      if (n > 0 && !o.derivatives) out[n] = out[3 + n] = 0;
    }
  }
};

Real polynomial(const MotionElement& element, int row, const Real& t) {
  Real value = 0.0;
  for (int k = kMaxDegree; k >= 0; --k) value = value * t + Real(element.coefficients(row, k));
  return value;
}

/// A body's motion, and the motions that its author knows.
struct Body {
  BodyMotion motion;
  std::vector<Sway> sways;  ///< one for a bounded element, which has no BoundedMotion then
  std::vector<Eigen::Isometry3d> behind;  ///< a constant rotation behind each element, for some of the turns

  RealRigid pose(const Real& t) const {
    RealRigid M;
    for (std::size_t i = 0; i < motion.elements.size(); ++i) {
      const MotionElement& element = motion.elements[i];
      M = M * properly(element.before);
      const Real3 q = {polynomial(element, 0, t), polynomial(element, 1, t), polynomial(element, 2, t)};
      const Real3 axis = unit(exactly(element.axis));
      const Real angle = norm(q);
      RealRigid E;
      switch (element.kind) {
        case Kind::revolute:
          E = rotation(axis, q[0]);
          break;
        case Kind::prismatic:
          E.t = q[0] * axis;
          break;
        case Kind::slide:
          E.t = q;
          break;
        case Kind::turn:
          if (angle > Real(0.0)) E = rotation(Real(1.0) / angle * q, angle);
          break;
        case Kind::bounded:
          E = sways.front().pose(t);
          break;
      }
      M = M * E;
      if (i < behind.size() && !behind[i].isApprox(Eigen::Isometry3d::Identity(), 0)) M = M * properly(behind[i]);
    }
    return M * properly(motion.after);
  }
};

Eigen::Isometry3d transform(Random& random, double length) {
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.linear() = random.rotation();
  M.translation() = length * random.unit() * random.direction();
  return M;
}

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

  BodyCase(Random& random, int rounding) {
    const int level = random.below(31);
    const double width = std::ldexp(1.0, -level);
    const double start = std::floor(random.unit() * std::ldexp(1.0, level)) * width * (1 - 7 * width > 0 ? 1 : 0);
    for (int i = 0; i < 8; ++i) in.tm[i] = std::fmod(start + i * width, 1.0) + 0.5 * width;
    in.d = 0.5 * width;
    const double scale = random.size(0.01, 10);
    for (Body& b : body) makeMotion(random, scale, b);
    extent_a = random.size(0.01, 3);
    extent_b = random.size(0.01, 3);
    in.extents = extent_a + extent_b;
    const ScopedRounding scope(rounding);
    cross();
  }

  RealRigid relative(const Real& t) const { return body[0].pose(t).inverse() * body[1].pose(t); }

 private:
  void makeMotion(Random& random, double scale, Body& b) {
    if (random.chance(0.7)) b.motion.after = transform(random, scale);
    if (random.chance(0.15)) {
      b.sways.emplace_back(random, scale);
      b.motion.elements.resize(1);
      b.motion.elements[0].kind = Kind::bounded;
      return;
    }
    for (int n = random.below(4); n > 0; --n) {
      MotionElement e;
      e.kind = static_cast<Kind>(random.below(4));
      e.axis = random.chance(0.4) ? Eigen::Vector3d(Eigen::Vector3d::Unit(random.below(3))) : random.direction();
      if (random.chance(0.6)) e.before = transform(random, random.chance(0.1) ? random.size(1, 1e3) : scale);
      const bool turns = e.kind == Kind::revolute || e.kind == Kind::turn;
      const double size = turns ? random.size(1e-6, random.chance(0.1) ? 60 : 3) : scale;
      for (int k = random.below(kMaxDegree + 1); k >= 0; --k) {
        e.coefficients.col(k) = size * random.unit() * random.direction();
      }
      if (e.kind == Kind::turn && random.chance(0.3)) {
        // Near no rotation at all, or near the angle where the series end, in the middle of the first interval.
        Eigen::Vector3d q = Eigen::Vector3d::Zero();
        for (int k = kMaxDegree; k >= 0; --k) q = q * in.tm[0] + e.coefficients.col(k);
        const double angle = random.chance(0.5) ? std::sqrt(0.5) * (1 + random.size(1e-16, 1e-6) * random.in(-1, 1))
                                                : random.size(1e-300, 1e-3) * random.below(2);
        e.coefficients.col(0) += angle * random.direction() - q;
      }
      b.motion.elements.push_back(e);
      b.behind.push_back(Eigen::Isometry3d::Identity());
      if (e.kind == Kind::turn && random.chance(0.6)) b.behind.back().linear() = random.rotation();
    }
  }

  /// From body 0 up to the world, down to body 1, as the pair query goes.
  void cross() {
    int variables = 0;
    std::size_t bounded = 0;
    for (const Body& b : body) {
      for (const MotionElement& e : b.motion.elements) {
        degree = std::max(degree, e.degree());
        variables += 3;
      }
      bounded += b.sways.size();
    }
    sources.reserve(bounded);
    coefficients.assign(static_cast<std::size_t>((degree + 1) * std::max(variables, 1)), 0);
    Carrier at;
    int variable = 0;
    const auto crossElement = [&](const Body& b, std::size_t i, bool down) {
      const MotionElement& e = b.motion.elements[i];
      const engine::BoundedSource* source = nullptr;
      if (e.kind == Kind::bounded) {
        sources.push_back({&b.sways.front(), &Sway::state, &Sway::bounds, b.sways.front().derivatives});
        source = &sources.back();
      }
      for (int k = 0; k <= degree; ++k) {
        for (int r = 0; r < 3; ++r) {
          coefficients[static_cast<std::size_t>(k * variables + variable + r)] = e.coefficients(r, k);
        }
      }
      int orientation = -1;
      if (i < b.behind.size() && !b.behind[i].isApprox(Eigen::Isometry3d::Identity(), 0)) {
        orientation = static_cast<int>(orientations.size() / 9);
        for (int r = 0; r < 9; ++r) orientations.push_back(b.behind[i].linear()(r / 3, r % 3));
        with_orientation = true;
      }
      at = sweep.cross(at, e, variable, source, down, orientation);
      variable += 3;
    };
    for (std::size_t i = body[0].motion.elements.size(); i-- > 0;) crossElement(body[0], i, false);
    for (std::size_t i = 0; i < body[1].motion.elements.size(); ++i) crossElement(body[1], i, true);
    in.sweep = sweep.view();
    in.step_b = at.step;
    in.inverse_a = makePlacement(body[0].motion.after.inverse());
    in.placement_b = makePlacement(at, body[1].motion.after);
    in.query.coefficients = coefficients.data();
    in.query.num_variables = variables;
    in.query.degree = degree;
    in.query.orientations = orientations.data();
  }
};

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
    in.placement_b = makePlacement(at, Eigen::Isometry3d::Identity());
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
}  // namespace numerics_test
}  // namespace fcl_artic
