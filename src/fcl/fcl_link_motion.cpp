// SPDX-License-Identifier: BSD-3-Clause
//
// Bounds. Along the chain of the link, a point fixed in the geometry is
//
//   x_0(t) = sum over segments k of R_k(t) s_k(t).
//
// Segment k leads from one joint's origin to the next (the last one to x itself). Its vector in the frame to which it
// is attached is s_k. The rotation of that frame is R_k. It is a product of constant rotations and of rotations about
// fixed axes at constant rates r_j (the rate of a mimic joint is its master's times the multiplier). Let W_k be the sum
// of |r_j| over the revolute joints before segment k. Then
//
//   |R_k' s| <= W_k |s|,   |R_k'' s| <= W_k^2 |s|.
//
// s_k is constant, or runs on a straight line at the constant rate p_k of a prismatic joint. Hence
//
//   |x'|  <= D1 = sum W_k m_k + |p_k|,
//   |x''| <= D2 = sum W_k^2 m_k + 2 W_k |p_k|,     m_k = max |s_k|, at an end of the motion (a norm is convex).
//
// D1 is 'sum of joint rates times lever arms', summed by segments instead of by joints. From time t on, the
// displacement along the unit vector n during a further s <= 1 - t obeys
//
//   n . (x(t + s) - x(t)) <= s (n . x'(t) + D2 (1 - t) / 2) and <= s D1.
//
// So the smaller factor bounds the whole rest of the step. Conservative advancement needs this: it does not ask again
// before it has advanced. The rate n . x'(t) is affine in x, so it is largest at a corner of a triangle or rectangle. A
// sphere of radius r around these adds r |angular velocity x n|.
//
// FCL gets n from a difference of nearest points at distance d; rounding turns it by about 1e-16 / d. The directed
// bound therefore carries kDirectionSlack * D1: down to d = 1e-10 D1 this covers the turn by far, and below that every
// step is at most d / (1e-5 D1) <= 1e-5, where FCL stops and reports contact. It also keeps the bound positive when the
// points coincide and n is arbitrary or zero.
//
// The bounds are not rounded outward: FCL's advancement proves nothing in floating point anyway.

#include "fcl_artic/fcl_link_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/tbv_motion_bound_visitor.h>
#include <fcl/math/motion/triangle_motion_bound_visitor.h>

#include "fcl/fcl_motion.h"
#include "motion/link_motion.h"

namespace fcl_artic {
namespace {

constexpr double kDirectionSlack = 1e-5;  // derived above

using Eigen::Isometry3d;
using Eigen::Vector3d;

// FCL's visitors call back only into FCL's own five motions and answer 0 for any other, which advancement reads as
// "does not move". The members of a visitor are protected; a derived class may name them, and so give pointers to them.
template <class BV>
struct PeekVolume : fcl::TBVMotionBoundVisitor<BV> {
  using Visitor = fcl::TBVMotionBoundVisitor<BV>;
  static const BV& volume(const Visitor& v) { return v.*(&PeekVolume::bv); }
  static const Vector3d& direction(const Visitor& v) { return v.*(&PeekVolume::n); }
};

struct PeekTriangle : fcl::TriangleMotionBoundVisitor<double> {
  using Visitor = fcl::TriangleMotionBoundVisitor<double>;
  static std::array<Vector3d, 3> corners(const Visitor& v) {
    return {v.*(&PeekTriangle::a), v.*(&PeekTriangle::b), v.*(&PeekTriangle::c)};
  }
  static const Vector3d& direction(const Visitor& v) { return v.*(&PeekTriangle::n); }
};

std::array<Vector3d, 4> corners(const fcl::RSSd& rss) {
  const Vector3d u = rss.axis.col(0) * rss.l[0], v = rss.axis.col(1) * rss.l[1];
  return {rss.To, rss.To + u, rss.To + v, rss.To + u + v};
}

/// How far R^T R of an offset may be from the identity, in each entry; it is made orthonormal then.
constexpr double kOffsetDefect = 1e-9;

double startOf(const MotionElement& step) {
  return step.coefficients(0, 0);
}
double rateOf(const MotionElement& step) {
  return step.coefficients(0, 1);
}

}  // namespace

FclLinkMotion::FclLinkMotion(const KinematicTree& tree, const JointMotion& motion, LinkId link,
                             const Isometry3d& offset) {
  if (link < 0 || link >= tree.numLinks()) {
    throw std::out_of_range("FclLinkMotion: robot '" + tree.name() + "' has no link number " + std::to_string(link));
  }
  motion.requireOf(tree, "FclLinkMotion: the motion");
  const auto nameOf = [&] {
    return "FclLinkMotion: offset of the geometry on link '" + tree.linkName(link) + "' is not rigid: it";
  };
  const RigidTransform rigid = requireRigid(offset, kOffsetDefect, nameOf);
  motion.requirePolynomial("FclLinkMotion");
  if (motion.degree() > 1) {
    throw std::invalid_argument("FclLinkMotion: the motion has degree " + std::to_string(motion.degree()) +
                                ", FCL's bounds are made for joints at constant speed");
  }

  chain_ = std::make_shared<BodyMotion>(linkMotion(tree, motion, link, rigid));

  const auto addSegment = [this](double length, double rate) {
    speed_ += angle_ * length + rate;
    acceleration_ += angle_ * (angle_ * length + 2 * rate);
  };
  for (const MotionElement& step : chain_->elements) {
    const Vector3d s = step.before.translation();
    const double q0 = startOf(step), rate = rateOf(step);
    if (step.kind == MotionElement::Kind::prismatic) {
      const Vector3d a = step.before.linear() * step.axis.vector();
      addSegment(std::max((s + a * q0).norm(), (s + a * (q0 + rate)).norm()), std::abs(rate));
    } else {
      addSegment(s.norm(), 0);
      angle_ += std::abs(rate);
    }
  }
  addSegment(chain_->after.translation().norm(), 0);
  state_ = stateAt(0);
}

const BodyMotion& bodyMotion(const FclLinkMotion& motion) {
  return *motion.chain_;
}

FclLinkMotion::State FclLinkMotion::stateAt(double t) const {
  State state;
  state.t = t;
  Isometry3d& M = state.M_0g;
  for (const MotionElement& step : chain_->elements) {
    M = M * step.before;
    const Vector3d v = M.linear() * step.axis.vector() * rateOf(step);
    const double q = startOf(step) + t * rateOf(step);
    if (step.kind == MotionElement::Kind::prismatic) {
      state.velocity += v;
      M.translate(step.axis.vector() * q);
    } else {
      state.angular += v;
      state.velocity += M.translation().cross(v);
      M.rotate(Eigen::AngleAxisd(q, step.axis.vector()));
    }
  }
  M = M * chain_->after;
  return state;
}

Isometry3d FclLinkMotion::pose(double t) const {
  return stateAt(t).M_0g;
}

double FclLinkMotion::speedBound(double radius) const {
  return speed_ + angle_ * radius;
}

double FclLinkMotion::accelerationBound(double radius) const {
  return acceleration_ + angle_ * angle_ * radius;
}

bool FclLinkMotion::integrate(double t) const {
  state_ = stateAt(std::clamp(t, 0.0, 1.0));
  return true;
}

void FclLinkMotion::getCurrentTransform(fcl::Transform3d& M_0g) const {
  M_0g = state_.M_0g;
}

double FclLinkMotion::directedBound(const Vector3d* points_g, int count, double radius, const Vector3d& n) const {
  double reach = 0, approach = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    reach = std::max(reach, points_g[i].norm());
    const Vector3d x_0 = state_.M_0g * points_g[i];
    approach = std::max(approach, n.dot(state_.velocity + state_.angular.cross(x_0)));
  }
  reach += radius;
  approach += radius * state_.angular.cross(n).norm();
  const double anyway = speedBound(reach);
  const double directed = std::max(0.0, approach + accelerationBound(reach) * (1 - state_.t) / 2);
  return std::min(anyway, directed + kDirectionSlack * anyway);
}

double FclLinkMotion::computeMotionBound(const fcl::BVMotionBoundVisitor<double>& visitor) const {
  if (const auto* rss = dynamic_cast<const fcl::TBVMotionBoundVisitor<fcl::RSSd>*>(&visitor)) {
    const fcl::RSSd& volume = PeekVolume<fcl::RSSd>::volume(*rss);
    return directedBound(corners(volume).data(), 4, volume.r, PeekVolume<fcl::RSSd>::direction(*rss));
  }
  if (const auto* both = dynamic_cast<const fcl::TBVMotionBoundVisitor<fcl::OBBRSSd>*>(&visitor)) {
    const fcl::RSSd& volume = PeekVolume<fcl::OBBRSSd>::volume(*both).rss;
    return directedBound(corners(volume).data(), 4, volume.r, PeekVolume<fcl::OBBRSSd>::direction(*both));
  }
  throw std::invalid_argument("FclLinkMotion: motion bounds exist for RSS and OBBRSS bounding volumes only");
}

double FclLinkMotion::computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>& visitor) const {
  return directedBound(PeekTriangle::corners(visitor).data(), 3, 0, PeekTriangle::direction(visitor));
}

void FclLinkMotion::getTaylorModel(fcl::TMatrix3<double>& R, fcl::TVector3<double>& T) const {
  // Within half a unit of time from the middle a rotated unit vector moves by at most angle / 2, the origin by at most
  // speed / 2. The pad covers the rounding of the pose itself.
  const Isometry3d M = pose(0.5);
  constexpr double kPad = 1e-12;
  const double turn = std::min(2.0, angle_ / 2) + kPad;
  const double shift = speed_ / 2 + kPad * (1 + M.translation().norm());
  const auto& interval = getTimeInterval();
  const auto around = [&interval](double c, double e) {
    return fcl::TaylorModel<double>(c, 0, 0, 0, fcl::Interval<double>(-e, e), interval);
  };
  const auto row = [&](int i) {
    return fcl::TVector3<double>(around(M(i, 0), turn), around(M(i, 1), turn), around(M(i, 2), turn));
  };
  R = fcl::TMatrix3<double>(row(0), row(1), row(2));
  T = fcl::TVector3<double>(around(M(0, 3), shift), around(M(1, 3), shift), around(M(2, 3), shift));
}

}  // namespace fcl_artic
