// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/fcl_motion.h"

#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <typeinfo>

#include <cxxabi.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>

#include "fcl/recorded_motion.h"
#include "numerics/constants.h"
#include "numerics/rotation.h"
#include "numerics/shown.h"

namespace fcl_artic {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string typeName(const std::type_info& type) {
  const std::unique_ptr<char, void (*)(void*)> name(abi::__cxa_demangle(type.name(), nullptr, nullptr, nullptr),
                                                    std::free);
  return name ? name.get() : type.name();
}

// The members of FCL's motions are protected. A derived class may name them, and so give pointers to them.
template <class S>
struct PeekInterp : fcl::InterpMotion<S> {
  using Motion = fcl::InterpMotion<S>;
  static const fcl::Transform3<S>& begin(const Motion& m) { return m.*(&PeekInterp::tf1); }
  static const fcl::Transform3<S>& end(const Motion& m) { return m.*(&PeekInterp::tf2); }
};
template <class S>
struct PeekScrew : fcl::ScrewMotion<S> {
  using Motion = fcl::ScrewMotion<S>;
  static const fcl::Transform3<S>& begin(const Motion& m) { return m.*(&PeekScrew::tf1); }
  static const fcl::Transform3<S>& end(const Motion& m) { return m.*(&PeekScrew::tf2); }
};
template <class S>
struct PeekSpline : fcl::SplineMotion<S> {
  using Motion = fcl::SplineMotion<S>;
  using Points = fcl::Vector3<S>[4];
  static const Points& positions(const Motion& m) { return m.*(&PeekSpline::Td); }
  static const Points& rotations(const Motion& m) { return m.*(&PeekSpline::Rd); }
  static S firstSquare(const Motion& m) { return m.*(&PeekSpline::Rd0Rd0); }
  static S lastSquare(const Motion& m) { return m.*(&PeekSpline::Rd3Rd3); }
  static const fcl::Transform3<S>& current(const Motion& m) { return m.*(&PeekSpline::tf); }
};

/// The motion whose data are read. Its name is spelled out only for an error: that takes longer than reading the data.
struct Name {
  const std::type_info& type;
  const char* part = "";
};
std::string spelled(const Name& name) {
  return "motion of type " + typeName(name.type) + name.part;
}
std::string spelled(std::string name) {
  return name;
}

template <class N>
void require(bool condition, const N& name, const char* what) {
  if (!condition) throw std::invalid_argument(spelled(name) + " " + what);
}

template <class N>
void requireLength(const Vector3d& v, const N& name, const char* what) {
  const double largest = v.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  if (largest <= kFarthest) return;
  throw std::invalid_argument(spelled(name) + " has a " + what +
                              (v.allFinite() ? " of more than 1e9 m" : " that is not finite"));
}

/// Does the work of readTransform().
template <class S, class N>
RigidTransform readRigid(const fcl::Transform3<S>& M, const N& name) {
  constexpr double kMax = std::is_same<S, float>::value ? 1e-4 : 1e-6;
  return requireRigid(Isometry3d(M.template cast<double>()), kMax, [&] { return spelled(name); });
}

MotionElement& addSlide(BodyMotion& motion, const Vector3d& from, const Vector3d& velocity) {
  MotionElement& element = motion.elements.emplace_back();
  element.kind = MotionElement::Kind::slide;
  element.coefficients.col(0) = from;
  element.coefficients.col(1) = velocity;
  return element;
}

void addTurn(BodyMotion& motion, const UnitVector& axis, double angle) {
  MotionElement& element = motion.elements.emplace_back();
  element.kind = MotionElement::Kind::revolute;
  element.axis = axis;
  element.coefficients(0, 1) = angle;
}

/// The frame turns about `axis`, while its point o goes along a straight line from where it is at first.
BodyMotion lineWithTurn(const RigidTransform& begin, const Vector3d& o, const Vector3d& velocity,
                        const UnitVector& axis, double angle) {
  BodyMotion motion;
  if (angle == 0) {
    addSlide(motion, begin.translation(), velocity);
    motion.after = begin.at(Vector3d::Zero());
  } else {
    addSlide(motion, begin * o, velocity);
    addTurn(motion, axis, angle);
    motion.after = begin.at(begin.linear() * -o);
  }
  return motion;
}
/// The frame's origin goes along a straight line, nothing turns.
BodyMotion line(const RigidTransform& begin, const Vector3d& velocity) {
  return lineWithTurn(begin, Vector3d::Zero(), velocity, UnitVector(), 0);
}

/// A turn by `angle` in (0, pi] about `axis`, with a slide along it, that takes the frame's origin by the vector o.
///
/// With o_ the part of o across the axis, the origin stands at w from the nearest point of the screw's axis, where
///
///   w = -(o_ + cot(angle / 2) axis x o) / 2,   |w| = |o_| / (2 sin(angle / 2)).
///
/// Small angles put that point far away, where it costs digits. The origin's path is, w being normal to the axis,
///
///   u(t) = t (axis . o) axis + sin(angle t) b - (1 - cos(angle t)) w,   b = axis x w,
///
/// which in powers of t needs only angle w and angle b, both of the size of o. Cut off after t^5 it is in error by at
/// most (angle^7 / 5040) |b| + (angle^6 / 720) |w| < angle^5 |o_| / 700, which for angle <= 1e-3 is 1.5e-18 |o_|.
BodyMotion screw(const RigidTransform& begin, const Vector3d& o, const UnitVector& direction, double angle) {
  constexpr double kSmallAngle = 1e-3;
  constexpr double kNoAngle = 1e-150;  // half of such an angle may be 0, and its square is
  const Vector3d& axis = direction;
  const Vector3d along = axis.dot(o) * axis, across = o - along, normal = axis.cross(o);
  const double half_cot = angle > kNoAngle ? angle / 2 / std::tan(angle / 2) : 1;  // times angle / 2
  const Vector3d angle_w = -(0.5 * angle * across + half_cot * normal);
  BodyMotion motion;
  if (angle <= kSmallAngle) {
    const Vector3d angle_b = half_cot * across - 0.5 * angle * normal;
    MotionElement& path = addSlide(motion, begin.translation(), along + angle_b);
    path.coefficients.col(2) = -angle / 2 * angle_w;
    path.coefficients.col(3) = -angle * angle / 6 * angle_b;
    path.coefficients.col(4) = angle * angle * angle / 24 * angle_w;
    path.coefficients.col(5) = angle * angle * angle * angle / 120 * angle_b;
    addTurn(motion, direction, angle);
    motion.after = begin.at(Vector3d::Zero());
  } else {
    const Vector3d w = angle_w / angle;
    addSlide(motion, begin.translation() - w, along);
    addTurn(motion, direction, angle);
    motion.after = begin.at(w);
  }
  return motion;
}

template <class S>
BodyMotion readTranslation(const fcl::TranslationMotion<S>& motion, const Name& name) {
  // All its data are private, and integrate() const moves it.
  const fcl::TranslationMotion<S> copy(motion);  // NOLINT(performance-unnecessary-copy-initialization)
  copy.integrate(0);
  fcl::Transform3<S> M;
  copy.getCurrentTransform(M);
  const RigidTransform begin = readRigid<S>(M, name);
  const Vector3d velocity = copy.getVelocity().template cast<double>();
  requireLength(velocity, name, "displacement");
  return line(begin, velocity);
}

/// The axis of a rotation by an angle in [0, pi], as FCL has it.
template <class S>
UnitVector requireRotation(const fcl::Vector3<S>& axis, S angle, const Name& name) {
  const Vector3d a = axis.template cast<double>();
  require(std::isfinite(angle) && a.allFinite(), name, "has a rotation that is not finite");
  require(angle >= 0 && angle < 3.1416 && (angle == 0 || std::abs(a.norm() - 1) < 1e-5), name,
          "has a rotation that FCL's constructors don't make; was it built without one?");
  return angle == 0 ? UnitVector() : UnitVector::within3Ulps(a).value();
}

template <class S>
BodyMotion readInterp(const fcl::InterpMotion<S>& motion, const Name& name) {
  const RigidTransform begin = readRigid<S>(PeekInterp<S>::begin(motion), Name{name.type, " (begin)"});
  const RigidTransform end = readRigid<S>(PeekInterp<S>::end(motion), Name{name.type, " (end)"});
  const Vector3d o = motion.getReferencePoint().template cast<double>();
  if (!(o.allFinite() && o.cwiseAbs().maxCoeff() <= kFarthest)) {
    throw std::invalid_argument(spelled(name) +
                                " has a reference point that is not finite or more than 1e9 m away: FCL's constructors "
                                "without a reference point leave it uninitialised; use (R1, T1, R2, T2, O)");
  }
  const Vector3d velocity = motion.getLinearVelocity().template cast<double>();
  const double angle = motion.getAngularVelocity();
  const UnitVector axis = requireRotation<S>(motion.getAngularAxis(), motion.getAngularVelocity(), name);
  requireLength(velocity, name, "velocity");
  BodyMotion body = lineWithTurn(begin, o, velocity, axis, angle);

  // The motion must end at FCL's end pose, but for the rounding in it. If velocities were never set, it doesn't.
  const double close = std::is_same<S, float>::value ? 1e-3 : 1e-5;
  const Isometry3d reached = body.pose(1);
  const double size = begin.translation().norm() + end.translation().norm() + o.norm();
  if (!((reached.linear() - end.linear()).cwiseAbs().maxCoeff() <= close &&
        (reached.translation() - end.translation()).norm() <= close * size)) {
    throw std::invalid_argument(spelled(name) +
                                " does not reach its end pose: FCL's constructors () and (tf1, tf2, O) never set the "
                                "velocities; use (R1, T1, R2, T2, O)");
  }
  return body;
}

template <class S>
BodyMotion readScrew(const fcl::ScrewMotion<S>& motion, const Name& name) {
  const RigidTransform begin = readRigid<S>(PeekScrew<S>::begin(motion), Name{name.type, " (begin)"});
  const double angle = motion.getAngularVelocity();
  if (angle == 0) {  // not unit: the displacement between the end poses
    const Vector3d velocity =
        motion.getAxis().template cast<double>() * static_cast<double>(motion.getLinearVelocity());
    requireLength(velocity, name, "displacement");
    return line(begin, velocity);
  }
  const UnitVector axis = requireRotation<S>(motion.getAxis(), motion.getAngularVelocity(), name);
  const RigidTransform end = readRigid<S>(PeekScrew<S>::end(motion), Name{name.type, " (end)"});
  return screw(begin, end.translation() - begin.translation(), axis, angle);
}

/// FCL's uniform cubic B-spline in powers of t.
template <class S>
void setSpline(const fcl::Vector3<S> (&points)[4], MotionElement& element) {
  Vector3d p[4];
  for (int i = 0; i < 4; ++i) p[i] = points[i].template cast<double>();
  element.coefficients.col(0) = (p[0] + 4 * p[1] + p[2]) / 6;
  element.coefficients.col(1) = (p[2] - p[0]) / 2;
  element.coefficients.col(2) = (p[0] - 2 * p[1] + p[2]) / 2;
  element.coefficients.col(3) = (p[3] - p[0] + 3 * (p[1] - p[2])) / 6;
}

template <class S>
BodyMotion readSpline(const fcl::SplineMotion<S>& motion, const Name& name) {
  using Peek = PeekSpline<S>;
  const auto& positions = Peek::positions(motion);
  const auto& rotations = Peek::rotations(motion);
  for (int i = 0; i < 4; ++i) {
    requireLength(positions[i].template cast<double>(), name, "control point");
    require(rotations[i].allFinite() && rotations[i].cwiseAbs().maxCoeff() <= 1e5, name,
            "has a control point of rotation that is not finite or of more than 1e5 rad");
  }
  // The values that the constructor derives from the control points must be there, and the present pose must have a
  // rotation.
  const auto isSquareOf = [](S square, const fcl::Vector3<S>& v) {
    return std::abs(square - v.squaredNorm()) <= S(1e-5) * v.squaredNorm();
  };
  const fcl::Matrix3<S> R = Peek::current(motion).linear();
  require(isSquareOf(Peek::firstSquare(motion), rotations[0]) && isSquareOf(Peek::lastSquare(motion), rotations[3]) &&
              (R * R.transpose() - fcl::Matrix3<S>::Identity()).cwiseAbs().maxCoeff() < 1e-3,
          name,
          "has no control points: FCL's constructors by two poses are empty; use the one by eight control points");

  BodyMotion body;
  body.elements.resize(2);
  body.elements[0].kind = MotionElement::Kind::slide;
  setSpline<S>(positions, body.elements[0]);
  body.elements[1].kind = MotionElement::Kind::turn;
  setSpline<S>(rotations, body.elements[1]);
  return body;
}

/// Believes the author, after a check that three poses are rigid and within the bounds.
BodyMotion readBounded(const BoundedMotion& motion, const Name& name) {
  const BoundedMotion::Bounds bounds = motion.bounds(0, 1);
  const bool derivatives = motion.hasDerivatives();
  const auto requireBound = [&](double bound, const char* what) {
    if (std::isfinite(bound) && bound >= 0) return;
    throw std::invalid_argument(spelled(name) + " has a bound of " + what + " that is not finite or below 0");
  };
  requireBound(bounds.speed, "speed");
  requireBound(bounds.angular_speed, "angular speed");
  requireBound(bounds.acceleration, "acceleration");
  requireBound(bounds.jerk, "jerk");
  requireBound(bounds.angular_acceleration, "angular acceleration");
  requireBound(bounds.angular_jerk, "angular jerk");
  Vector3d last = Vector3d::Zero();
  for (const double t : {0.0, 0.5, 1.0}) {
    const BoundedMotion::State state = motion.state(t);
    const std::string at = spelled(name) + " at t = " + shown(t);
    const Matrix3d R = state.pose.linear();
    require(state.pose.matrix().allFinite(), at, "has a pose that is not finite");
    require((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-12 && R.determinant() > 0, at,
            "has a rotation that is not proper to 1e-12");
    requireLength(state.pose.translation(), at, "position");
    const auto requireWithin = [&](const Vector3d& v, double bound, const char* what) {
      if (v.norm() <= bound * (1 + 1e-9) + 1e-12) return;
      throw std::invalid_argument(at + " exceeds its own bound of " + what);
    };
    if (derivatives) {
      requireWithin(state.velocity, bounds.speed, "speed");
      requireWithin(state.acceleration, bounds.acceleration, "acceleration");
      requireWithin(state.angular_velocity, bounds.angular_speed, "angular speed");
      requireWithin(state.angular_acceleration, bounds.angular_acceleration, "angular acceleration");
    }
    if (t > 0) {
      const double rounding = 1e-12 * (last.norm() + state.pose.translation().norm());
      require((state.pose.translation() - last).norm() <= 0.5 * bounds.speed * (1 + 1e-9) + rounding, at,
              "is farther away than its own bound of speed allows");
    }
    last = state.pose.translation();
  }
  BodyMotion body;
  body.elements.resize(1);
  body.elements[0].kind = MotionElement::Kind::bounded;
  body.elements[0].bounded = &motion;
  return body;
}

}  // namespace

template <class S>
BodyMotion readMotion(const fcl::MotionBase<S>& motion) {
  const std::type_info& type = typeid(motion);
  const Name name{type};
  // By typeid, not by dynamic_cast: that would also take a class which overrides integrate().
  if (type == typeid(fcl::TranslationMotion<S>)) {
    return readTranslation(static_cast<const fcl::TranslationMotion<S>&>(motion), name);
  }
  if (type == typeid(fcl::InterpMotion<S>)) return readInterp(static_cast<const fcl::InterpMotion<S>&>(motion), name);
  if (type == typeid(fcl::ScrewMotion<S>)) return readScrew(static_cast<const fcl::ScrewMotion<S>&>(motion), name);
  if (type == typeid(fcl::SplineMotion<S>)) return readSpline(static_cast<const fcl::SplineMotion<S>&>(motion), name);
  if constexpr (std::is_same<S, double>::value) {
    if (type == typeid(FclLinkMotion)) return bodyMotion(static_cast<const FclLinkMotion&>(motion));
    if (type == typeid(RecordedMotion)) return static_cast<const RecordedMotion&>(motion).motion();
  }
  if (const auto* bounded = dynamic_cast<const BoundedMotion*>(&motion)) return readBounded(*bounded, name);
  throw std::invalid_argument(spelled(name) +
                              " can't be certified, as nothing bounds it between its poses: derive the class from "
                              "fcl_artic::BoundedMotion too (fcl_artic/bounded_motion.h)");
}

template BodyMotion readMotion(const fcl::MotionBase<float>& motion);
template BodyMotion readMotion(const fcl::MotionBase<double>& motion);

BodyMotion motionBetween(const RigidTransform& begin, const RigidTransform& end, fcl::CCDMotionType type) {
  if (type == fcl::CCDM_SPLINE) {
    throw std::invalid_argument(
        "CCDM_SPLINE: two poses don't make a spline (FCL's SplineMotion(tf1, tf2) is empty); use "
        "CCDM_LINEAR or CCDM_SCREW, or pass a SplineMotion with its eight control points");
  }
  if (type != fcl::CCDM_TRANS && type != fcl::CCDM_LINEAR && type != fcl::CCDM_SCREW) {
    throw std::invalid_argument("motion type " + std::to_string(static_cast<int>(type)) + " is none of FCL's");
  }
  const Vector3d o = end.translation() - begin.translation();
  if (type == fcl::CCDM_TRANS || begin.linear() == end.linear()) return line(begin, o);
  // By way of the quaternion, which is as accurate at half a turn as anywhere, and takes the shorter way.
  const Eigen::Quaterniond turn(Matrix3d(end.linear() * begin.linear().transpose()));
  const Vector3d sine = turn.w() < 0 ? Vector3d(-turn.vec()) : Vector3d(turn.vec());
  const std::optional<UnitVector> axis = UnitVector::within3Ulps(sine);
  if (!axis) return line(begin, o);
  const double angle = 2 * std::atan2(lengthAlong(*axis, sine), std::abs(turn.w()));
  if (type == fcl::CCDM_LINEAR) return lineWithTurn(begin, Vector3d::Zero(), o, *axis, angle);
  return screw(begin, o, *axis, angle);
}

BodyMotion motionBetween(const Isometry3d& begin, const Isometry3d& end, fcl::CCDMotionType type) {
  return motionBetween(readTransform<double>(begin, "begin of the motion"),
                       readTransform<double>(end, "end of the motion"), type);
}

template <class S>
RigidTransform readTransform(const fcl::Transform3<S>& M, const char* what) {
  return readRigid<S>(M, what);
}

template RigidTransform readTransform<float>(const fcl::Transform3<float>& M, const char* what);
template RigidTransform readTransform<double>(const fcl::Transform3<double>& M, const char* what);

}  // namespace fcl_artic
