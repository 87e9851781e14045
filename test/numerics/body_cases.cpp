// SPDX-License-Identifier: BSD-3-Clause
#include "body_cases.h"

#include <algorithm>
#include <cmath>

namespace fcl_artic {
namespace numerics_test {

using Kind = MotionElement::Kind;

Sway::Sway(Random& random, double scale)
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

RealRigid Sway::pose(const Real& t) const {
  RealRigid own;
  for (int j = 0; j < 3; ++j) own.R[static_cast<std::size_t>(j)] = exactly(R.col(j));
  own = properly(Eigen::Isometry3d(R));
  RealRigid moved = rotation(unit(exactly(axis)), Real(turn) * sin(Real(m) * t)) * own;
  moved.t = exactly(c) + sin(Real(k) * t) * exactly(s);
  return moved;
}

void Sway::state(const void* self, double t, double* out) {
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

void Sway::bounds(const void* self, double, double, double* out) {
  const Sway& o = *static_cast<const Sway*>(self);
  const double s = o.s.norm() * (1 + 1e-15);
  for (int n = 0; n < 3; ++n) {
    out[n] = s * std::pow(o.k, n + 1) * (1 + 1e-14);
    out[3 + n] = o.turn * std::pow(o.m, n + 1) * (1 + 1e-14);
    if (n > 0 && !o.derivatives) out[n] = out[3 + n] = 0;
  }
}

namespace {

Real polynomial(const MotionElement& element, int row, const Real& t) {
  Real value = 0.0;
  for (int k = kMaxDegree; k >= 0; --k) value = value * t + Real(element.coefficients(row, k));
  return value;
}

}  // namespace

RealRigid Body::pose(const Real& t) const {
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

namespace {

RigidTransform transform(Random& random, double length) {
  const Rotation R = Rotation::within12Ulps(random.rotation(), 1e-12).value();
  return {R, length * random.unit() * random.direction()};
}

}  // namespace

BodyCase::BodyCase(Random& random, int rounding) {
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

void BodyCase::makeMotion(Random& random, double scale, Body& b) {
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
    e.axis =
        random.chance(0.4) ? UnitVector::along(random.below(3)) : UnitVector::within3Ulps(random.direction()).value();
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

void BodyCase::cross() {
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

}  // namespace numerics_test
}  // namespace fcl_artic
