// SPDX-License-Identifier: BSD-3-Clause
//
// Random robots, motions, pairs and convex pieces, and their exact poses and supports.
#pragma once

#include <cfenv>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/kinematic_tree.h"
#include "motion/frame_sweep.h"
#include "real.h"
#include "subject.h"

namespace fcl_artic {
namespace numerics_test {

/// Checks that a test asks for, times FCL_ARTIC_NUMERICS_SCALE (default 1; 100 makes 10^7 of all).
int scaled(int checks);
/// Seed of a test, from FCL_ARTIC_NUMERICS_SEED and its name; printed.
std::uint64_t seedOf(const std::string& test);

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double in(double lo, double hi) { return lo + (hi - lo) * unit(); }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  bool chance(double p) { return unit() < p; }
  /// Log-uniform size.
  double size(double lo, double hi);
  Eigen::Vector3d direction();
  Eigen::Matrix3d rotation();

 private:
  std::mt19937_64 engine_;
};

constexpr int kRoundingModes[4] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

/// Another rounding mode for a while.
class ScopedRounding {
 public:
  explicit ScopedRounding(int mode) : before_(std::fegetround()) { std::fesetround(mode); }
  ~ScopedRounding() { std::fesetround(before_); }
  ScopedRounding(const ScopedRounding&) = delete;
  ScopedRounding& operator=(const ScopedRounding&) = delete;

 private:
  int before_;
};

/// Coefficients of a tangent of half an angle, up to `degree`. Some are small, some large, some cross 0 fast or touch
/// it at `t`. Some pass where the bounds of its angle's derivatives have their largest values.
std::vector<double> randomTangent(Random& random, int degree, double t);

/// A transform that is orthonormal to rounding.
inline RigidTransform stored(const Eigen::Isometry3d& M) {
  return RigidTransform::within12Ulps(M, 1e-12).value();
}

/// Two bodies on a random robot (or one in the world) over eight neighbouring intervals.
struct PairCase {
  KinematicTree tree;
  LinkId link_a = -1, link_b = -1;  ///< -1: the world
  Eigen::Isometry3d offset_a, offset_b;
  double extent_a = 0, extent_b = 0;
  std::vector<double> q0, dq;
  std::vector<double> coefficients;  ///< q0, then dq
  std::unique_ptr<FrameSweep> sweep;
  Carrier carrier;  ///< of link_b
  PairInput in;
  std::vector<std::uint8_t> half_angles;  ///< per variable: whether it goes by the tangent of half its angle; or empty
  std::vector<double> references;

  /// @param rounding  mode in which the sweep is set up.
  PairCase(Random& random, int rounding);
  /// Lets all angles go by polynomials that are the tangents of their halves, and slides as before.
  void goByHalfAngles(Random& random);
  /// A joint variable, exact.
  Real variable(std::size_t v, const Real& t) const;
  /// B's geometry in A's, exact.
  RealRigid relative(const Real& t) const;
  /// Pose of a link, exact.
  RealRigid pose(LinkId link, const Real& t) const;

 private:
  void makeTree(Random& random);
};

/// The proper rigid transform that a stored one stands for: Gram and Schmidt's.
RealRigid properly(const Eigen::Isometry3d& M);
Real3 exactly(const Eigen::Vector3d& p);

/// A random point not farther away than `extent`.
Eigen::Vector3d pointWithin(Random& random, double extent);

/// X0 + tau X1 + tau^2 X2 of a point, from doubles without rounding.
Real3 quadraticAt(const PairOutput& m, int side, int lane, const Eigen::Vector3d& p, double tau);

constexpr int kPieceKinds = 8;

/// One convex piece with what its view points to.
struct OwnedPiece {
  engine::Piece piece;
  std::vector<double> vertices;
  std::shared_ptr<double> hull;  ///< a hull's coordinates, 64-byte aligned
  engine::TreeView view() const;
  double extent() const { return (piece.reach + piece.radius) * (1 + 1e-15); }

  OwnedPiece(Random& random, engine::PieceKind kind, double size, bool centered = false);
  /// max of p.u over the core, exact.
  Real support(const Real3& u) const;
};

/// Exact gap of the pieces along the unit direction n, in A's frame, from A to B.
Real gapAlong(const OwnedPiece& a, const OwnedPiece& b, const RealRigid& M_ab, const Real3& n);

}  // namespace numerics_test
}  // namespace fcl_artic
