// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's motions as read, against what copies of the objects perform.
#include "fcl/fcl_motion.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <thread>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "example_motions.h"
#include "random_robot.h"

namespace fcl_artic {
namespace fcl_motion_test {
namespace {

using bench::Random;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::randomDirection;
using test::randomPose;

// FCL's poses and ours are each a few dozen roundings of 1.1e-16 away from the exact ones, of the sizes of all numbers
// that they are summed from. The largest error seen is 12 % of this.
constexpr double kRounding = 1e-14;

/// Angles of all orders of magnitude, and the special ones.
double randomAngle(Random& random) {
  switch (random.index(6)) {
    case 0:
      return 0;
    case 1:
      return std::pow(10, random.uniform(-12, -3));
    case 2:
      return M_PI - std::pow(10, random.uniform(-16, -3));
    case 3:
      return M_PI;
    default:
      return random.uniform(0, M_PI);
  }
}

struct Poses {
  Isometry3d begin, end;
};

/// Two poses, a given angle apart.
Poses randomPoses(Random& random) {
  Poses poses;
  poses.begin = randomPose(random, std::pow(10, random.uniform(-2, 2)));
  poses.end = poses.begin;
  const double angle = randomAngle(random);
  const Vector3d axis = random.coin(0.2) ? Vector3d(Vector3d::Unit(random.index(3))) : randomDirection(random);
  if (angle > 0) poses.end.linear() = Eigen::AngleAxisd(angle, axis) * poses.begin.linear();
  poses.end.translation() += random.coin(0.1) ? Vector3d(Vector3d::Zero())
                                              : Vector3d(std::pow(10, random.uniform(-3, 1)) * randomDirection(random));
  return poses;
}

double distance(const Isometry3d& a, const Isometry3d& b) {
  return std::max((a.linear() - b.linear()).cwiseAbs().maxCoeff(), (a.translation() - b.translation()).norm());
}

template <class S>
Isometry3d current(const fcl::MotionBase<S>& motion) {
  fcl::Transform3<S> M;
  motion.getCurrentTransform(M);
  return Isometry3d(M.matrix().template cast<double>());
}

/// Largest distance of the motion as read from the object's own path, at 100 times; the object itself, left at
/// `t_left`, is only looked at.
template <class S, class Motion>
double farthestFromOwnPath(const Motion& motion) {
  const BodyMotion read = readMotion<S>(motion);
  // integrate() changes what const hides
  const Motion copy(motion);  // NOLINT(performance-unnecessary-copy-initialization)
  double farthest = 0;
  for (int i = 0; i <= 100; ++i) {
    const S t = static_cast<S>(i) / 100;
    copy.integrate(t);
    farthest = std::max(farthest, distance(read.pose(t), current<S>(copy)));
  }
  return farthest;
}

double sizes(const Poses& poses) {
  return 1 + poses.begin.translation().norm() + poses.end.translation().norm();
}

bool identical(const BodyMotion& a, const BodyMotion& b) {
  bool same = a.elements.size() == b.elements.size() && a.after.matrix() == b.after.matrix();
  for (std::size_t i = 0; same && i < a.elements.size(); ++i) {
    const MotionElement &x = a.elements[i], &y = b.elements[i];
    same = x.kind == y.kind && x.before.matrix() == y.before.matrix() && x.axis.vector() == y.axis.vector() &&
           x.coefficients == y.coefficients && x.bounded == y.bounded;
  }
  return same;
}

std::string message(const std::function<void()>& act) {
  try {
    act();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

#define EXPECT_REFUSED(statement, part) \
  EXPECT_NE(message([&] { statement; }).find(part), std::string::npos) << message([&] { statement; })

TEST(FclMotionTest, TranslationsAsPerformed) {
  Random random(1);
  for (int n = 0; n < 300; ++n) {
    const Poses p = randomPoses(random);
    const fcl::TranslationMotiond motion(p.begin, p.end);
    EXPECT_LE(farthestFromOwnPath<double>(motion), kRounding * sizes(p)) << "case " << n;
    const BodyMotion read = readMotion<double>(motion);
    EXPECT_LE((read.pose(1).linear() - p.begin.linear()).norm(), kRounding) << "the end's rotation is dropped";
  }
}

TEST(FclMotionTest, InterpMotionsAsPerformed) {
  Random random(2);
  double most = 0;
  for (int n = 0; n < 400; ++n) {
    const Poses p = randomPoses(random);
    const Vector3d o = random.coin(0.3) ? Vector3d(Vector3d::Zero())
                                        : Vector3d(std::pow(10, random.uniform(-2, 4)) * randomDirection(random));
    const fcl::InterpMotion<double> motion(p.begin.linear(), p.begin.translation(), p.end.linear(), p.end.translation(),
                                           o);
    const double error = farthestFromOwnPath<double>(motion), allowed = kRounding * (sizes(p) + 2 * o.norm());
    EXPECT_LE(error, allowed) << "case " << n;
    most = std::max(most, error / allowed);
    EXPECT_LE(distance(readMotion<double>(motion).pose(1), p.end), allowed) << "case " << n;
  }
  std::printf("largest error %.3f of what is allowed\n", most);
}

TEST(FclMotionTest, ScrewMotionsAsPerformed) {
  Random random(3);
  double most = 0;
  int far = 0;
  for (int n = 0; n < 600; ++n) {
    const Poses p = randomPoses(random);
    const fcl::ScrewMotion<double> motion(p.begin, p.end);
    // FCL sums its poses from a point of the axis, however far away that is.
    const double axis_point = motion.getAngularVelocity() == 0 ? 0 : motion.getAxisOrigin().norm();
    const double length = (p.end.translation() - p.begin.translation()).norm();
    far += axis_point > 1e6;
    const double error = farthestFromOwnPath<double>(motion);
    const double allowed = kRounding * (sizes(p) + axis_point + length * length);
    EXPECT_LE(error, allowed) << "case " << n << " angle " << motion.getAngularVelocity();
    most = std::max(most, error / allowed);
    if (motion.getAngularVelocity() > 0) {
      // Ours does better: the end pose is reached up to what the axis point costs at no less than 1e-3 rad.
      const double reach = std::min(axis_point, 1e3 * length);
      EXPECT_LE(distance(readMotion<double>(motion).pose(1), p.end), kRounding * (sizes(p) + reach)) << "case " << n;
    }
  }
  std::printf("largest error %.3f of what is allowed; %d axes farther than 1000 km\n", most, far);
  EXPECT_GT(far, 20);
}

TEST(FclMotionTest, ScrewWithoutRotationGoesWhereTheObjectGoes) {
  for (const double length : {0.5, 6.0}) {
    const fcl::ScrewMotion<double> motion(Matrix3d::Identity(), Vector3d::Zero(), Matrix3d::Identity(),
                                          Vector3d(length, 0, 0));
    EXPECT_EQ(readMotion<double>(motion).pose(1).translation(), Vector3d(length * length, 0, 0));
  }
}

TEST(FclMotionTest, SplinesAsPerformed) {
  Random random(4);
  double most = 0;
  for (int n = 0; n < 300; ++n) {
    Vector3d T[4], R[4];
    const double far = std::pow(10, random.uniform(-1, 2)), turn = std::pow(10, random.uniform(-12, 1));
    for (int i = 0; i < 4; ++i) {
      T[i] = far * random.uniform() * randomDirection(random);
      R[i] =
          random.coin(0.1) ? Vector3d(Vector3d::Zero()) : Vector3d(turn * random.uniform() * randomDirection(random));
    }
    const fcl::SplineMotion<double> motion(T[0], T[1], T[2], T[3], R[0], R[1], R[2], R[3]);
    const double error = farthestFromOwnPath<double>(motion), allowed = kRounding * (1 + far + turn);
    EXPECT_LE(error, allowed) << "case " << n;
    most = std::max(most, error / allowed);
  }
  std::printf("largest error %.3f of what is allowed\n", most);
}

TEST(FclMotionTest, LinkMotionsAsPerformed) {
  Random random(5);
  for (int n = 0; n < 200; ++n) {
    const auto tree = test::randomTree(random, 1 + random.index(9), 0.5);
    const JointMotion joints = test::randomMotion(*tree, random, 3);
    const FclLinkMotion motion(*tree, joints, tree->numLinks() - 1, randomPose(random, 0.2));
    EXPECT_LE(farthestFromOwnPath<double>(motion), 1e-13) << "case " << n;
  }
}

TEST(FclMotionTest, FloatMotionsAsPerformed) {
  Random random(6);
  constexpr double kFloatRounding = 5e-6;  // some 40 roundings of 1.2e-7 / 2 each, of FCL's
  for (int n = 0; n < 300; ++n) {
    const Poses p = randomPoses(random);
    const fcl::TranslationMotion<float> line(fcl::Transform3f(p.begin.matrix().cast<float>()),
                                             fcl::Transform3f(p.end.matrix().cast<float>()));
    EXPECT_LE(farthestFromOwnPath<float>(line), kFloatRounding * sizes(p)) << "case " << n;
    const BodyMotion read = readMotion<float>(line);
    const Matrix3d R = read.pose(0.5).linear();
    EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).norm(), 1e-15) << "proper in doubles";

    fcl::Vector3f v[8];
    for (auto& x : v) x = (3 * random.uniform() * randomDirection(random)).cast<float>();
    const fcl::SplineMotion<float> spline(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]);
    EXPECT_LE(farthestFromOwnPath<float>(spline), kFloatRounding * 10) << "case " << n;
  }
}

/// One object of each kind, in the state that integrate(t) leaves. (Not by new: FCL's library frees what it deletes in
/// another way than C++17 allocates it.)
std::vector<std::shared_ptr<fcl::MotionBased>> oneOfEach(double t) {
  Random random(7);
  const Poses p{randomPose(random, 1), randomPose(random, 2)};
  const auto tree = test::randomTree(random, 5, 0.5);
  std::vector<std::shared_ptr<fcl::MotionBased>> motions;
  motions.push_back(std::make_shared<fcl::TranslationMotiond>(p.begin, p.end));
  motions.push_back(std::make_shared<fcl::InterpMotion<double>>(p.begin.linear(), p.begin.translation(), p.end.linear(),
                                                                p.end.translation(), Vector3d(1, 2, 3)));
  motions.push_back(std::make_shared<fcl::ScrewMotion<double>>(p.begin, p.end));
  Vector3d v[8];
  for (auto& x : v) x = randomDirection(random);
  motions.push_back(std::make_shared<fcl::SplineMotion<double>>(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]));
  motions.push_back(std::make_shared<FclLinkMotion>(*tree, test::randomMotion(*tree, random, 2), tree->numLinks() - 1));
  motions.push_back(std::make_shared<test::SwayingMotion>(p.begin, v[0], 2, 1, 3));
  motions.push_back(std::make_shared<test::SpeedBoundedMotion>(p.begin, v[0], 2, 1, 3));
  for (const auto& motion : motions) motion->integrate(t);
  return motions;
}

std::size_t sizeOf(const fcl::MotionBased& motion) {
  if (dynamic_cast<const fcl::TranslationMotiond*>(&motion)) return sizeof(fcl::TranslationMotiond);
  if (dynamic_cast<const fcl::InterpMotion<double>*>(&motion)) return sizeof(fcl::InterpMotion<double>);
  if (dynamic_cast<const fcl::ScrewMotion<double>*>(&motion)) return sizeof(fcl::ScrewMotion<double>);
  if (dynamic_cast<const fcl::SplineMotion<double>*>(&motion)) return sizeof(fcl::SplineMotion<double>);
  if (dynamic_cast<const FclLinkMotion*>(&motion)) return sizeof(FclLinkMotion);
  return sizeof(test::SwayingMotion);
}

TEST(FclMotionTest, ObjectsStayByteForByteAndTheirStateDoesNotMatter) {
  const auto at_begin = oneOfEach(0), at_end = oneOfEach(1), between = oneOfEach(0.37);
  for (std::size_t i = 0; i < at_begin.size(); ++i) {
    const std::size_t size = sizeOf(*at_end[i]);
    const auto* bytes = reinterpret_cast<const unsigned char*>(at_end[i].get());
    const std::vector<unsigned char> before(bytes, bytes + size);
    BodyMotion read = readMotion<double>(*at_end[i]);
    EXPECT_EQ(std::memcmp(bytes, before.data(), size), 0) << "motion " << i;
    for (const auto* others : {&at_begin, &between}) {
      const BodyMotion other = readMotion<double>(*(*others)[i]);
      if (!read.elements[0].bounded) {
        EXPECT_TRUE(identical(read, other)) << "motion " << i;
      }
      EXPECT_EQ(read.pose(0.3).matrix(), other.pose(0.3).matrix()) << "motion " << i;
    }
  }
}

TEST(FclMotionTest, OneObjectServesEightThreads) {
  const auto motions = oneOfEach(0.5);
  std::vector<BodyMotion> alone;
  for (const auto& motion : motions) alone.push_back(readMotion<double>(*motion));
  std::vector<int> different(8, 0);
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 8; ++thread) {
    threads.emplace_back([&, thread] {
      for (int n = 0; n < 200; ++n) {
        for (std::size_t i = 0; i < motions.size(); ++i) {
          const BodyMotion read = readMotion<double>(*motions[i]);
          const double t = n / 200.0;
          different[static_cast<std::size_t>(thread)] +=
              !identical(read, alone[i]) || read.pose(t).matrix() != alone[i].pose(t).matrix();
        }
      }
    });
  }
  for (auto& thread : threads) thread.join();
  for (const int count : different) EXPECT_EQ(count, 0);
}

/// Memory full of one byte, where an object is then made.
template <class Motion>
struct Dirty {
  alignas(64) unsigned char memory[sizeof(Motion)];
  Motion* motion = nullptr;
  template <class... Args>
  explicit Dirty(unsigned char fill, const Args&... args) {
    volatile unsigned char* bytes = memory;  // volatile: else the compiler may leave the filling out
    for (std::size_t i = 0; i < sizeof(Motion); ++i) bytes[i] = fill;
    motion = new (memory) Motion(args...);
  }
  ~Dirty() { motion->~Motion(); }
};

TEST(FclMotionTest, ReferencePointsNeverSetAreReadAsTheyAreOrRefused) {
  using Interp = fcl::InterpMotion<double>;
  Random random(8);
  const Isometry3d begin = randomPose(random, 1), end = randomPose(random, 1);
  for (const unsigned char fill : {0x00, 0x40, 0xC0, 0x7F, 0xFF}) {
    const Dirty<Interp> dirty(fill, begin, end);
    const double o = dirty.motion->getReferencePoint().norm();
    if (o < 1e9) {
      EXPECT_LE(farthestFromOwnPath<double>(*dirty.motion), kRounding * (4 + 2 * o));
      EXPECT_LE(distance(readMotion<double>(*dirty.motion).pose(1), end), kRounding * (4 + 2 * o));
    } else {
      EXPECT_REFUSED(readMotion<double>(*dirty.motion), "reference point");
      EXPECT_REFUSED(readMotion<double>(*dirty.motion), "use (R1, T1, R2, T2, O)");
    }
  }
  const Dirty<Interp> big(0x7F, begin, end), nan(0xFF, begin, end);
  EXPECT_GT(big.motion->getReferencePoint().norm(), 1e9) << "the memory was not dirty";
  EXPECT_FALSE(nan.motion->getReferencePoint().allFinite()) << "the memory was not dirty";
}

TEST(FclMotionTest, MotionsNeverSetAreRefused) {
  Random random(9);
  const Isometry3d begin = randomPose(random, 1), end = randomPose(random, 1);
  for (const unsigned char fill : {0x00, 0x40, 0xC0, 0x7F, 0xFF}) {
    const Dirty<fcl::InterpMotion<double>> interp(fill, begin, end, Vector3d(0, 0, 0));
    EXPECT_REFUSED(readMotion<double>(*interp.motion), "InterpMotion");
    const Dirty<fcl::SplineMotion<double>> spline(fill, begin, end);
    EXPECT_REFUSED(readMotion<double>(*spline.motion), "SplineMotion");
  }
}

TEST(FclMotionTest, ValuesNotFiniteOrNotRigidAreRefused) {
  const Matrix3d one = Matrix3d::Identity();
  const Vector3d zero = Vector3d::Zero(), nan(0, std::nan(""), 0), far(0, 0, 1e300);
  EXPECT_REFUSED(readMotion<double>(fcl::TranslationMotiond(one, zero, nan)), "TranslationMotion");
  EXPECT_REFUSED(readMotion<double>(fcl::TranslationMotiond(one, zero, far)), "1e9 m");
  EXPECT_REFUSED(readMotion<double>(fcl::InterpMotion<double>(one, nan, one, zero, zero)), "not finite");
  EXPECT_REFUSED(readMotion<double>(fcl::InterpMotion<double>(2 * one, zero, one, zero, zero)), "not orthonormal");
  EXPECT_REFUSED(readMotion<double>(fcl::ScrewMotion<double>(-one, zero, one, zero)), "a reflection");
  EXPECT_REFUSED(readMotion<double>(fcl::SplineMotion<double>(zero, zero, far, zero, zero, zero, zero, zero)), "1e9 m");
  EXPECT_REFUSED(readMotion<double>(fcl::SplineMotion<double>(zero, zero, zero, zero, zero, zero, nan, zero)),
                 "finite");
}

/// Moves otherwise than its base class.
struct StubbornMotion : fcl::InterpMotion<double> {
  using fcl::InterpMotion<double>::InterpMotion;
  bool integrate(double) const override { return true; }
};

/// The same, but it says so.
struct HonestMotion : StubbornMotion, BoundedMotion {
  using StubbornMotion::StubbornMotion;
  State state(double) const override { return {}; }
  Bounds bounds(double, double) const override { return {}; }
};

TEST(FclMotionTest, UnknownMotionsAreRefusedWithAdvice) {
  const test::UnknownMotion unknown;
  EXPECT_REFUSED(readMotion<double>(unknown), "fcl_artic::test::UnknownMotion");
  EXPECT_REFUSED(readMotion<double>(unknown), "derive the class from fcl_artic::BoundedMotion");
  const Matrix3d one = Matrix3d::Identity();
  const Vector3d zero = Vector3d::Zero(), x = Vector3d::UnitX();
  EXPECT_REFUSED(readMotion<double>(StubbornMotion(one, zero, one, x, zero)), "StubbornMotion");
  const HonestMotion honest(one, zero, one, x, zero);
  EXPECT_EQ(readMotion<double>(honest).elements.at(0).bounded, &honest);
}

/// Says what the test wants it to say.
struct ClaimingMotion : test::UnknownMotion, BoundedMotion {
  State says;
  Bounds claims;
  bool derivatives = true;
  State state(double t) const override {
    State s = says;
    s.pose.translation().x() += t;
    return s;
  }
  Bounds bounds(double, double) const override { return claims; }
  bool hasDerivatives() const override { return derivatives; }
};

TEST(FclMotionTest, BoundedMotionsThatContradictThemselvesAreRefused) {
  ClaimingMotion good;
  good.says.velocity.x() = 1;
  good.claims.speed = 1;
  EXPECT_EQ(readMotion<double>(good).elements.at(0).bounded, &good);
  EXPECT_EQ(readMotion<double>(good).pose(0.25).translation(), Vector3d(0.25, 0, 0));

  const auto expectRefused = [&](const std::function<void(ClaimingMotion&)>& change, const char* part) {
    ClaimingMotion bad = good;
    change(bad);
    EXPECT_REFUSED(readMotion<double>(bad), part);
    EXPECT_REFUSED(readMotion<double>(bad), "ClaimingMotion");
  };
  expectRefused([](ClaimingMotion& m) { m.claims.speed = std::nan(""); }, "speed");
  expectRefused([](ClaimingMotion& m) { m.claims.angular_jerk = -1; }, "angular jerk");
  expectRefused([](ClaimingMotion& m) { m.claims.jerk = INFINITY; }, "jerk");
  expectRefused([](ClaimingMotion& m) { m.claims.speed = 0.5; }, "speed");
  expectRefused([](ClaimingMotion& m) { m.says.acceleration.y() = 1; }, "acceleration");
  expectRefused([](ClaimingMotion& m) { m.says.angular_velocity.y() = 1; }, "angular speed");
  expectRefused([](ClaimingMotion& m) { m.says.angular_acceleration.y() = 1; }, "angular acceleration");
  expectRefused([](ClaimingMotion& m) { m.says.pose.linear() *= 1 + 1e-11; }, "proper");
  expectRefused([](ClaimingMotion& m) { m.says.pose.linear() *= -1; }, "proper");
  expectRefused([](ClaimingMotion& m) { m.says.pose.translation().y() = std::nan(""); }, "not finite");
  expectRefused([](ClaimingMotion& m) { m.derivatives = false, m.claims.speed = 0.5; }, "farther");

  ClaimingMotion speeds = good;  // knows no more, and says nothing of it
  speeds.derivatives = false;
  speeds.says.acceleration.y() = 1;
  EXPECT_EQ(readMotion<double>(speeds).elements.size(), 1u);
}

TEST(MotionBetweenTest, EndPosesAreReached) {
  Random random(10);
  double most = 0;
  for (int n = 0; n < 1000; ++n) {
    const Poses p = randomPoses(random);
    const double angle = Eigen::AngleAxisd(Matrix3d(p.end.linear() * p.begin.linear().transpose())).angle();
    const double length = (p.end.translation() - p.begin.translation()).norm();
    for (const auto type : {fcl::CCDM_TRANS, fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
      const BodyMotion motion = motionBetween(p.begin, p.end, type);
      // A screw's axis is |o| / (2 sin(angle / 2)) away, which is where its digits go; angles below 1e-3 do without.
      const double axis = type == fcl::CCDM_SCREW && angle > 1e-3 ? length / std::sin(angle / 2) : 0;
      Isometry3d end = p.end;
      if (type == fcl::CCDM_TRANS) end.linear() = p.begin.linear();
      const double allowed = kRounding * (sizes(p) + axis);
      const double error = std::max(distance(motion.pose(0), p.begin), distance(motion.pose(1), end));
      EXPECT_LE(error, allowed) << "case " << n << " type " << type << " angle " << angle;
      most = std::max(most, error / allowed);
    }
  }
  std::printf("largest error %.3f of what is allowed\n", most);
}

TEST(MotionBetweenTest, LinearMovesTheOriginStraightAndTurnsTheShorterWay) {
  Random random(11);
  for (int n = 0; n < 500; ++n) {
    const Poses p = randomPoses(random);
    const BodyMotion motion = motionBetween(p.begin, p.end, fcl::CCDM_LINEAR);
    const Matrix3d half = motion.pose(0.5).linear() * p.begin.linear().transpose();
    // Twice the half turn is the whole turn, and the half turn is at most pi / 2: its trace is at least 1.
    EXPECT_LE((half * half * p.begin.linear() - p.end.linear()).norm(), 10 * kRounding);
    EXPECT_GE(half.trace(), 1 - kRounding);
    for (const double t : {0.25, 0.5, 0.9}) {
      const Vector3d straight = (1 - t) * p.begin.translation() + t * p.end.translation();
      EXPECT_LE((motion.pose(t).translation() - straight).norm(), kRounding * sizes(p));
    }
  }
}

/// A screw is the motion whose displacement over equal times is the same rigid transform.
TEST(MotionBetweenTest, ScrewsHaveConstantDisplacements) {
  Random random(12);
  for (int n = 0; n < 1000; ++n) {
    const Poses p = randomPoses(random);
    const BodyMotion motion = motionBetween(p.begin, p.end, fcl::CCDM_SCREW);
    const double angle = Eigen::AngleAxisd(Matrix3d(p.end.linear() * p.begin.linear().transpose())).angle();
    const double length = (p.end.translation() - p.begin.translation()).norm();
    const double axis = angle > 1e-3 ? length / std::sin(angle / 2) : 0;
    const Isometry3d D = motion.pose(0.125) * motion.pose(0).inverse();
    Isometry3d M = motion.pose(0);
    for (int i = 1; i <= 8; ++i) {
      M = D * M;
      EXPECT_LE(distance(motion.pose(i / 8.0), M), 30 * kRounding * (sizes(p) + axis))
          << "case " << n << " angle " << angle;
    }
  }
}

/// Above and below the angle where the screw's form changes, the paths differ by no more than the angles do.
TEST(MotionBetweenTest, ScrewFormsMeetAtSmallAngles) {
  const Vector3d axis = Vector3d(1, 2, 3).normalized(), o(0.3, -0.5, 0.4);
  Isometry3d M[2];
  const double angles[2] = {1e-3 * (1 - 1e-12), 1e-3 * (1 + 1e-12)};
  BodyMotion motions[2];
  for (int i = 0; i < 2; ++i) {
    M[i] = Eigen::Translation3d(o) * Eigen::AngleAxisd(angles[i], axis);
    motions[i] = motionBetween(Isometry3d::Identity(), M[i], fcl::CCDM_SCREW);
  }
  EXPECT_EQ(motions[0].elements[0].degree(), 5);
  EXPECT_EQ(motions[1].elements[0].degree(), 1);
  for (int i = 0; i <= 100; ++i) {
    // The second's axis is 700 m away: 1e-13 of rounding.
    EXPECT_LE(distance(motions[0].pose(i / 100.0), motions[1].pose(i / 100.0)), 5e-13) << i;
  }
}

TEST(MotionBetweenTest, PureTranslationsAreStraightWhateverTheType) {
  Random random(13);
  const Isometry3d begin = randomPose(random, 1);
  Isometry3d end = begin;
  end.translation() += Vector3d(0.5, 0, 6);
  for (const auto type : {fcl::CCDM_TRANS, fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
    const BodyMotion motion = motionBetween(begin, end, type);
    ASSERT_EQ(motion.elements.size(), 1u) << type;
    EXPECT_EQ(motion.elements[0].kind, MotionElement::Kind::slide);
    EXPECT_LE(distance(motion.pose(1), end), kRounding);
  }
}

TEST(MotionBetweenTest, WhatIsNotMeantIsRefused) {
  const Isometry3d one = Isometry3d::Identity();
  EXPECT_REFUSED(motionBetween(one, one, fcl::CCDM_SPLINE), "CCDM_SPLINE");
  EXPECT_REFUSED(motionBetween(one, one, fcl::CCDM_SPLINE), "CCDM_LINEAR");
  EXPECT_REFUSED(motionBetween(one, one, static_cast<fcl::CCDMotionType>(17)), "17");
  Isometry3d bad = one;
  bad.linear() *= 1.1;
  EXPECT_REFUSED(motionBetween(bad, one, fcl::CCDM_TRANS), "begin of the motion");
  EXPECT_REFUSED(motionBetween(one, bad, fcl::CCDM_SCREW), "end of the motion");
}

TEST(ReadTransformTest, FloatsMayBeLessOrthonormal) {
  fcl::Transform3f M = fcl::Transform3f::Identity();
  M.linear() *= 1 + 2e-5f;
  EXPECT_LE((readTransform<float>(M, "pose").linear() - Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_REFUSED(readTransform<double>(Isometry3d(M.matrix().cast<double>()), "the pose"), "the pose");
  M.linear() *= 1.001f;
  EXPECT_REFUSED(readTransform<float>(M, "the pose"), "the pose");
}

}  // namespace
}  // namespace fcl_motion_test
}  // namespace fcl_artic
