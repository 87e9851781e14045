// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/interpolation.h"

#include <cstddef>
#include <stdexcept>
#include <utility>

namespace fcl_artic {
namespace {

using Eigen::VectorXd;

constexpr std::pair<const char*, Interpolation> kInterpolations[]{
    {"auto", Interpolation::automatic},
    {"linear", Interpolation::linear},
    {"cubic", Interpolation::cubic},
    {"quintic", Interpolation::quintic},
    {"blends", Interpolation::blends},
    {"jtc", Interpolation::jtc},
    {"jtc-upsampled", Interpolation::jtcUpsampled},
    {"jtc-none", Interpolation::jtcNone},
    {"tangent-half-angle", Interpolation::tangentHalfAngle}};
constexpr std::pair<const char*, Turns> kTurns[]{
    {"ask", Turns::ask}, {"given", Turns::given}, {"shortest", Turns::shortest}};

template <class T, std::size_t n>
T valueNamed(const std::pair<const char*, T> (&all)[n], const std::string& name, const char* what) {
  std::string known;
  for (const auto& one : all) {
    if (name == one.first) return one.second;
    known += (known.empty() ? "" : ", ") + std::string(one.first);
  }
  throw std::invalid_argument("'" + name + "' is no value of " + what + ": " + known + " are");
}

[[noreturn]] void refuseCurve(Interpolation kind, const std::string& why) {
  throw std::invalid_argument("interpolation " + std::string(toString(kind)) + ' ' + why);
}

}  // namespace

Interpolation interpolationNamed(const std::string& name) {
  if (name == "totg") {
    throw std::invalid_argument(
        "totg rounds the corners of a path, and the controller then runs a spline through samples of that: certify "
        "its result, by interpolation jtc");
  }
  return valueNamed(kInterpolations, name, "interpolation");
}

const char* toString(Interpolation interpolation) {
  for (const auto& known : kInterpolations) {
    if (interpolation == known.second) return known.first;
  }
  return "";
}

Turns turnsNamed(const std::string& name) {
  return valueNamed(kTurns, name, "turns");
}

bool isController(Interpolation interpolation) {
  return interpolation == Interpolation::jtc || interpolation == Interpolation::jtcUpsampled ||
         interpolation == Interpolation::jtcNone;
}

Turns turnsOf(Interpolation interpolation, Turns asked) {
  const bool says_itself = isController(interpolation) || interpolation == Interpolation::tangentHalfAngle;
  if (says_itself && asked == Turns::shortest) {
    refuseCurve(interpolation, "says which way round a joint goes, as the values say, and turns shortest another way");
  }
  return isController(interpolation) ? Turns::given : asked;
}

Interpolation curveOf(Interpolation interpolation, const WaypointValues& given) {
  Interpolation kind = interpolation;
  const bool positions_only = !given.velocities && !given.accelerations;
  if (kind == Interpolation::jtcNone || kind == Interpolation::tangentHalfAngle) return kind;
  if (kind == Interpolation::jtcUpsampled && positions_only) return kind;
  if (kind == Interpolation::automatic || isController(kind)) {
    if (given.accelerations && !given.velocities) {
      throw std::invalid_argument("there are accelerations and no velocities: `interpolation` says what is meant");
    }
    if (!given.velocities) return Interpolation::linear;
    kind = given.accelerations ? Interpolation::quintic : Interpolation::cubic;
  }
  const bool polynomial = kind == Interpolation::cubic || kind == Interpolation::quintic;
  if (polynomial && !given.velocities) refuseCurve(kind, "needs velocities, and there are none");
  if (kind == Interpolation::quintic && !given.accelerations)
    refuseCurve(kind, "needs accelerations, and there are none");
  if (kind != Interpolation::linear && !given.times) refuseCurve(kind, "needs times, and there are none");
  return kind;
}

/// With h_k = t_{k+1} - t_k and slopes s_k = (q_{k+1} - q_k) / h_k, the accelerations before and after waypoint k,
/// (2 v_{k-1} + 4 v_k - 6 s_{k-1}) / h_{k-1} and (6 s_k - 4 v_k - 2 v_{k+1}) / h_k, are the same if
///   a v_{k-1} + 2 v_k + b v_{k+1} = 3 (a s_{k-1} + b s_k),  a = h_k / (h_{k-1} + h_k),  b = h_{k-1} / (h_{k-1} + h_k).
/// The diagonal exceeds the rest of its row by 1, so elimination goes without pivots, and errors do not grow
/// (doc/NUMERICS.md, section 12).
std::vector<VectorXd> restToRestVelocities(const std::vector<double>& t, const std::vector<VectorXd>& q) {
  const std::size_t n = q.size();
  if (n < 2 || t.size() != n) {
    throw std::invalid_argument("restToRestVelocities: " + std::to_string(t.size()) + " times for " +
                                std::to_string(n) + " waypoints, of which two are needed");
  }
  std::vector<VectorXd> v(n, VectorXd::Zero(q[0].size()));
  std::vector<double> over(n, 0);  // what is left above the diagonal, of a diagonal of 1
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double before = t[k] - t[k - 1], after = t[k + 1] - t[k], both = before + after;
    const double a = after / both, b = before / both, pivot = 2 - a * over[k - 1];
    const VectorXd wanted = 3 * (a * ((q[k] - q[k - 1]) / before) + b * ((q[k + 1] - q[k]) / after));
    v[k] = (wanted - a * v[k - 1]) / pivot;
    over[k] = b / pivot;
  }
  for (std::size_t k = n - 1; k-- > 1;) v[k] -= over[k] * v[k + 1];
  return v;
}

JointTrajectory makeTrajectory(const KinematicTree& tree, Interpolation curve, const Waypoints& w, double blend,
                               JointTrajectory::Unwrap unwrap) {
  switch (curve) {
    case Interpolation::cubic:
      return JointTrajectory::cubic(tree, w.times, w.positions, w.velocities, unwrap);
    case Interpolation::quintic:
      return JointTrajectory::quintic(tree, w.times, w.positions, w.velocities, w.accelerations, unwrap);
    case Interpolation::blends:
      return JointTrajectory::parabolicBlends(tree, w.times, w.positions, blend, unwrap);
    case Interpolation::tangentHalfAngle:
      return JointTrajectory::tangentHalfAngle(tree, w.times, w.positions);
    case Interpolation::jtcUpsampled:
      return JointTrajectory::cubic(tree, w.times, w.positions, restToRestVelocities(w.times, w.positions), unwrap);
    case Interpolation::jtcNone:
    case Interpolation::automatic:
    case Interpolation::jtc:
    case Interpolation::linear:
      break;
  }
  return JointTrajectory::linear(tree, w.times, w.positions, unwrap);
}

}  // namespace fcl_artic
