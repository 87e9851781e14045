// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "kinematics/angles.h"
#include "kinematics/exact_motion.h"
#include "kinematics/rotation_vector.h"
#include "model/sweep.h"
#include "numerics/shown.h"

namespace fcl_artic {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A difference between two pieces of up to kJump (rad or m) and kJumpPart of the values counts as rounding.
constexpr double kJump = 1e-9, kJumpPart = 1e-12;

std::string number(std::size_t k) {
  return std::to_string(k);
}

void requireTimes(const std::vector<double>& times) {
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k])) throw std::invalid_argument("trajectory: times[" + number(k) + "] is not finite");
    if (k > 0 && !(times[k] > times[k - 1] && std::isfinite(times[k] - times[k - 1]))) {
      throw std::invalid_argument("trajectory: times[" + number(k) + "] = " + shown(times[k]) +
                                  " is not later than times[" + number(k - 1) + "] = " + shown(times[k - 1]));
    }
  }
  // Moving obstacles go by parts of the whole time, so it must be finite.
  if (times.size() > 1 && !std::isfinite(times.back() - times.front())) {
    throw std::invalid_argument("trajectory: the time from " + shown(times.front()) + " to " + shown(times.back()) +
                                " is not finite");
  }
}

void requireWaypoints(const KinematicTree& tree, const std::vector<double>& times,
                      const std::vector<VectorXd>& waypoints) {
  if (waypoints.size() < 2)
    throw std::invalid_argument("trajectory: " + number(waypoints.size()) + " waypoints, not 2 or more");
  if (times.size() != waypoints.size()) {
    throw std::invalid_argument("trajectory: " + number(times.size()) + " times for " + number(waypoints.size()) +
                                " waypoints");
  }
  requireTimes(times);
  for (std::size_t k = 0; k < waypoints.size(); ++k) tree.requireConfiguration(waypoints[k], "waypoint " + number(k));
}

/// Velocities or accelerations.
void requireRates(const KinematicTree& tree, const std::vector<VectorXd>& rates, std::size_t waypoints,
                  const char* what) {
  if (rates.size() != waypoints) {
    throw std::invalid_argument("trajectory: " + number(rates.size()) + " " + what + " for " + number(waypoints) +
                                " waypoints");
  }
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const std::string where = std::string("trajectory: ") + what + " of waypoint " + number(k);
    if (rates[k].size() != tree.dof()) {
      throw std::invalid_argument(where + " have " + std::to_string(rates[k].size()) + " entries, robot '" +
                                  tree.name() + "' has " + std::to_string(tree.dof()));
    }
    for (int v = 0; v < tree.dof(); ++v) {
      if (std::isfinite(rates[k][v])) continue;
      throw std::invalid_argument(where + ": joint '" + tree.variableName(v) + "': not finite");
    }
    for (const JointId j : tree.quaternionJoints()) {
      const int v = tree.quaternionVariable(j);
      if (rates[k][v + 3] == 0) continue;
      throw std::invalid_argument(where + ": '" + tree.variableName(v + 3) +
                                  "' is not 0: a quaternion's rate is an angular velocity");
    }
  }
}

void refuseQuaternions(const KinematicTree& tree, const char* what) {
  if (tree.quaternionJoints().empty()) return;
  throw std::invalid_argument("trajectory: joint '" + tree.joint(tree.quaternionJoints().front()).name +
                              "' turns by a quaternion, which " + what + " cannot describe");
}

/// A quaternion that stands still is accepted without a curve: its rates are 0, its coefficients vanish.
void requireStillQuaternions(const KinematicTree& tree, const std::vector<VectorXd>& waypoints,
                             const std::vector<VectorXd>& velocities, const std::vector<VectorXd>& accelerations) {
  for (const JointId j : tree.quaternionJoints()) {
    const int v = tree.quaternionVariable(j);
    for (std::size_t k = 0; k < waypoints.size(); ++k) {
      if (waypoints[k].segment<4>(v) == waypoints[0].segment<4>(v) && velocities[k].segment<4>(v).isZero(0) &&
          accelerations[k].segment<4>(v).isZero(0)) {
        continue;
      }
      throw std::invalid_argument("trajectory: joint '" + tree.joint(j).name + "' turns by a quaternion at waypoint " +
                                  number(k) + ", which quintic() cannot describe");
    }
  }
}

/// Whole turns are added so that every step is the shorter way. A joint that mimics one that is unwrapped must come to
/// the same pose with them.
std::vector<VectorXd> unwrapped(const KinematicTree& tree, std::vector<VectorXd> waypoints) {
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    const bool forever = joint.type == JointType::continuous || (joint.type == JointType::planar && tree.isAngle(v));
    if (!forever) continue;
    double turns = 0, previous = waypoints[0][v];
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
      const double value = waypoints[k][v];
      turns -= nearestInteger((value - previous) / kTwoPi);
      previous = value;
      if (turns == 0) continue;
      waypoints[k][v] = value + turns * kTwoPi;
      for (JointId j = 0; j < tree.numJoints(); ++j) {
        const Joint& other = tree.joint(j);
        if (!other.mimics || tree.jointVariable(j) != v) continue;
        const double m = other.mimic.multiplier;
        if (m == 0 || (other.type != JointType::prismatic && m == std::round(m))) continue;
        throw std::invalid_argument("trajectory: joint '" + other.name + "' mimics the continuous joint '" +
                                    joint.name + "', which cannot be unwrapped: '" + other.name +
                                    "' would not come to waypoint " + number(k));
      }
    }
  }
  return waypoints;
}

std::vector<VectorXd> waypointsOf(const KinematicTree& tree, const std::vector<VectorXd>& waypoints,
                                  JointTrajectory::Unwrap unwrap) {
  return unwrap == JointTrajectory::Unwrap::yes ? unwrapped(tree, waypoints) : waypoints;
}

/// A piece of its own time in [0, 1], from coefficients of t - begin in [0, duration].
JointMotion pieceOf(const KinematicTree& tree, MatrixXd coefficients, double duration, std::size_t k) {
  double power = 1;
  for (Eigen::Index j = 1; j < coefficients.cols(); ++j) coefficients.col(j) *= power *= duration;
  try {
    return JointMotion::polynomial(tree, coefficients);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("trajectory: piece " + number(k) + ": " + error.what());
  }
}

void requirePieces(const std::vector<double>& times, std::size_t pieces) {
  if (pieces == 0) throw std::invalid_argument("trajectory: no piece");
  if (times.size() != pieces + 1) {
    throw std::invalid_argument("trajectory: " + number(times.size()) + " times for " + number(pieces) +
                                " pieces, not one more");
  }
}

/// w' at the end of a turn by exp([w]) where the angular velocity is W: W = w' + b w x w' + c w x (w x w') solved for
/// w', which is W - w x W / 2 + e w x (w x W), e = 1/g - (1 + cos) / (2 theta sin), g = theta^2 (Bullo and Murray
/// 1995).
Vector3d rateOfRotationVector(const Vector3d& w, const Vector3d& W) {
  const double g = w.squaredNorm(), theta = std::sqrt(g), half = theta / 2;
  // 1/g - cot(theta/2) / (2 theta); where that cancels, its series.
  const double e =
      g < 1e-2 ? 1.0 / 12 + g / 720 + g * g / 30240 : 1 / g - std::cos(half) / (2 * theta * std::sin(half));
  return W - 0.5 * w.cross(W) + e * w.cross(w.cross(W));
}

}  // namespace

JointTrajectory::JointTrajectory(const KinematicTree& tree, std::vector<double> times, std::vector<JointMotion> pieces)
    : times_(std::move(times)), pieces_(std::move(pieces)) {
  requireTimes(times_);
  for (std::size_t k = 1; k < pieces_.size(); ++k) {
    VectorXd before = pieces_[k - 1].configuration(1), after = pieces_[k].configuration(0);
    for (const JointId j : tree.quaternionJoints()) {
      const int v = tree.quaternionVariable(j);
      if (before.segment<4>(v).dot(after.segment<4>(v)) < 0) after.segment<4>(v) = -after.segment<4>(v);
    }
    for (int v = 0; v < tree.dof(); ++v) {
      if (std::abs(after[v] - before[v]) <= kJump + kJumpPart * std::max(std::abs(before[v]), std::abs(after[v])))
        continue;
      throw std::invalid_argument("trajectory: piece " + number(k) + " begins elsewhere than piece " + number(k - 1) +
                                  " ends: joint '" + tree.variableName(v) + "' jumps from " +
                                  std::to_string(before[v]) + " to " + shown(after[v]));
    }
  }
}

JointTrajectory ExactMotion::trajectory(const KinematicTree& tree, const std::vector<double>& times,
                                        std::vector<JointMotion> pieces) {
  requirePieces(times, pieces.size());
  return {tree, times, std::move(pieces)};
}

JointTrajectory JointTrajectory::piecewise(const KinematicTree& tree, const std::vector<double>& times,
                                           const std::vector<MatrixXd>& coefficients) {
  requirePieces(times, coefficients.size());
  requireTimes(times);
  std::vector<JointMotion> pieces;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    pieces.push_back(pieceOf(tree, coefficients[k], times[k + 1] - times[k], k));
  }
  return {tree, times, std::move(pieces)};
}

JointTrajectory JointTrajectory::linear(const KinematicTree& tree, const std::vector<double>& times,
                                        const std::vector<VectorXd>& waypoints, Unwrap unwrap) {
  requireWaypoints(tree, times, waypoints);
  const std::vector<VectorXd> q = waypointsOf(tree, waypoints, unwrap);
  std::vector<JointMotion> pieces;
  for (std::size_t k = 0; k + 1 < q.size(); ++k) {
    try {
      pieces.push_back(JointMotion::linear(tree, q[k], q[k + 1]));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("trajectory: piece " + number(k) + ": " + error.what());
    }
  }
  return {tree, times, std::move(pieces)};
}

JointTrajectory JointTrajectory::tangentHalfAngle(const KinematicTree& tree, const std::vector<double>& times,
                                                  const std::vector<VectorXd>& waypoints, const VectorXd& reference) {
  requireWaypoints(tree, times, waypoints);
  std::vector<JointMotion> pieces;
  for (std::size_t k = 0; k + 1 < waypoints.size(); ++k) {
    try {
      pieces.push_back(JointMotion::tangentHalfAngle(tree, waypoints[k], waypoints[k + 1], reference));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("trajectory: piece " + number(k) + ": " + error.what());
    }
  }
  return {tree, times, std::move(pieces)};
}

JointTrajectory JointTrajectory::cubic(const KinematicTree& tree, const std::vector<double>& times,
                                       const std::vector<VectorXd>& waypoints, const std::vector<VectorXd>& velocities,
                                       Unwrap unwrap) {
  requireWaypoints(tree, times, waypoints);
  requireRates(tree, velocities, waypoints.size(), "velocities");
  const std::vector<VectorXd> q = waypointsOf(tree, waypoints, unwrap);
  std::vector<JointMotion> pieces;
  for (std::size_t k = 0; k + 1 < q.size(); ++k) {
    const double h = times[k + 1] - times[k];
    VectorXd delta = q[k + 1] - q[k], v0 = h * velocities[k], v1 = h * velocities[k + 1];
    for (const JointId j : tree.quaternionJoints()) {
      const int v = tree.quaternionVariable(j);
      const auto orientation = [&](const VectorXd& x) {
        return Eigen::Quaterniond(Eigen::Vector4d(x.segment<4>(v))).normalized();
      };
      const Vector3d w = rotationVectorOf(orientation(q[k + 1]) * orientation(q[k]).conjugate());
      delta.segment<4>(v) << w, 0;
      v1.segment<3>(v) = rateOfRotationVector(w, v1.segment<3>(v));
    }
    MatrixXd c(q[k].size(), 4);
    c << q[k], v0, 3 * delta - 2 * v0 - v1, v0 + v1 - 2 * delta;
    pieces.push_back(pieceOf(tree, c, 1, k));
  }
  return {tree, times, std::move(pieces)};
}

JointTrajectory JointTrajectory::quintic(const KinematicTree& tree, const std::vector<double>& times,
                                         const std::vector<VectorXd>& waypoints,
                                         const std::vector<VectorXd>& velocities,
                                         const std::vector<VectorXd>& accelerations, Unwrap unwrap) {
  requireWaypoints(tree, times, waypoints);
  requireRates(tree, velocities, waypoints.size(), "velocities");
  requireRates(tree, accelerations, waypoints.size(), "accelerations");
  requireStillQuaternions(tree, waypoints, velocities, accelerations);
  const std::vector<VectorXd> q = waypointsOf(tree, waypoints, unwrap);
  std::vector<JointMotion> pieces;
  for (std::size_t k = 0; k + 1 < q.size(); ++k) {
    const double h = times[k + 1] - times[k];
    const VectorXd delta = q[k + 1] - q[k], v0 = h * velocities[k], v1 = h * velocities[k + 1],
                   a0 = h * h * accelerations[k], a1 = h * h * accelerations[k + 1];
    MatrixXd c(q[k].size(), 6);
    c << q[k], v0, 0.5 * a0, 10 * delta - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
        -15 * delta + 8 * v0 + 7 * v1 + 1.5 * a0 - a1, 6 * delta - 3 * (v0 + v1) - 0.5 * (a0 - a1);
    pieces.push_back(pieceOf(tree, c, 1, k));
  }
  return {tree, times, std::move(pieces)};
}

JointTrajectory JointTrajectory::parabolicBlends(const KinematicTree& tree, const std::vector<double>& times,
                                                 const std::vector<VectorXd>& waypoints, double blend, Unwrap unwrap) {
  requireWaypoints(tree, times, waypoints);
  refuseQuaternions(tree, "parabolicBlends()");
  if (!std::isfinite(blend) || blend < 0) {
    throw std::invalid_argument("trajectory: the blend " + shown(blend) + " is not a number >= 0");
  }
  if (blend == 0) return linear(tree, times, waypoints, unwrap);
  const std::vector<VectorXd> q = waypointsOf(tree, waypoints, unwrap);
  const std::size_t last = q.size() - 1;
  std::vector<double> cuts{times[0]};
  std::vector<JointMotion> pieces;
  VectorXd here = q[0];
  for (std::size_t k = 0; k < last; ++k) {
    const double h = times[k + 1] - times[k];
    const double blends = (k > 0 ? blend : 0) + (k + 1 < last ? blend : 0);
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * (std::abs(times[k]) + std::abs(times[k + 1]));
    if (blends > h + rounding) {
      throw std::invalid_argument("trajectory: the blends of " + shown(blend) + " overlap between waypoints " +
                                  number(k) + " and " + number(k + 1) + ", which are " + shown(h) + " apart");
    }
    const VectorXd rate = (q[k + 1] - q[k]) / h;
    const auto add = [&](double end, const MatrixXd& c) {
      pieces.push_back(pieceOf(tree, c, end - cuts.back(), pieces.size()));
      cuts.push_back(end);
      here = pieces.back().configuration(1);
    };
    const double line_end = k + 1 < last ? times[k + 1] - blend : times[k + 1];
    if (line_end > cuts.back()) {
      MatrixXd c(here.size(), 2);
      c << here, rate;
      add(line_end, c);
    }
    if (k + 1 < last) {
      const double next = times[k + 2] - times[k + 1];
      const VectorXd change = (q[k + 2] - q[k + 1]) / next - rate;
      const double end = std::min(times[k + 1] + blend, times[k + 2]);
      if (!(end > cuts.back())) continue;  // a blend below the resolution of the times: a corner
      MatrixXd c(here.size(), 3);
      c << here, rate, change / (2 * (end - cuts.back()));
      add(end, c);
    }
  }
  return {tree, std::move(cuts), std::move(pieces)};
}

JointTrajectory JointTrajectory::bspline(const KinematicTree& tree, int degree, const std::vector<double>& knots,
                                         const std::vector<VectorXd>& control_points) {
  refuseQuaternions(tree, "bspline()");
  if (degree < 1 || degree > engine::kMaxDegree) {
    throw std::invalid_argument("trajectory: a B-spline of degree " + std::to_string(degree) + ", not 1 to 5");
  }
  const std::size_t p = static_cast<std::size_t>(degree), n = control_points.size();
  if (n < p + 1) {
    throw std::invalid_argument("trajectory: " + number(n) + " control points for a B-spline of degree " + number(p) +
                                ", not " + number(p + 1) + " or more");
  }
  if (knots.size() != n + p + 1) {
    throw std::invalid_argument("trajectory: " + number(knots.size()) + " knots for " + number(n) +
                                " control points, not " + number(n + p + 1));
  }
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i]) || (i > 0 && knots[i] < knots[i - 1])) {
      throw std::invalid_argument("trajectory: knot " + number(i) + ", " + shown(knots[i]) +
                                  ", is not finite or less than the one before");
    }
  }
  for (std::size_t i = 0; i < n; ++i) tree.requireConfiguration(control_points[i], "control point " + number(i));
  for (std::size_t i = p + 1; i + p < n; ++i) {
    if (knots[i + p] > knots[i]) continue;
    throw std::invalid_argument("trajectory: inner knot " + shown(knots[i]) + " is there more than " + number(p) +
                                " times: the B-spline jumps");
  }

  std::vector<double> times;
  std::vector<JointMotion> pieces;
  for (std::size_t s = p; s < n; ++s) {  // the span [knots[s], knots[s + 1]] is ruled by points s - p to s
    const double u = knots[s], h = knots[s + 1] - u;
    if (!(h > 0)) continue;
    // The m-th derivative is a B-spline of degree p - m with the points P_m,i = (p - m + 1) (P_(m-1),i - P_(m-1),i-1)
    // over the knots' difference; de Boor's scheme gives its value at u.
    std::vector<VectorXd> points(control_points.begin() + static_cast<std::ptrdiff_t>(s - p),
                                 control_points.begin() + static_cast<std::ptrdiff_t>(s + 1));
    MatrixXd c(tree.dof(), degree + 1);
    double factor = 1;  // h^m / m!
    for (std::size_t m = 0; m <= p; ++m) {
      std::vector<VectorXd> d = points;  // d[i] belongs to point s - (p - m) + i
      for (std::size_t r = 1; r + m <= p; ++r) {
        for (std::size_t i = p - m; i >= r; --i) {
          const double left = knots[s - (p - m) + i], right = knots[s + 1 + i - r];
          const double a = (u - left) / (right - left);
          d[i] = (1 - a) * d[i - 1] + a * d[i];
        }
      }
      c.col(static_cast<Eigen::Index>(m)) = factor * d[p - m];
      factor *= h / static_cast<double>(m + 1);
      for (std::size_t i = p - m; i >= 1; --i) {
        const double width = knots[s + i] - knots[s - (p - m) + i];
        points[i] = static_cast<double>(p - m) / width * (points[i] - points[i - 1]);
      }
      points.erase(points.begin());
    }
    if (times.empty()) times.push_back(u);
    times.push_back(knots[s + 1]);
    pieces.push_back(pieceOf(tree, c, 1, pieces.size()));
  }
  if (pieces.empty()) throw std::invalid_argument("trajectory: the B-spline's inner knots span no time");
  return {tree, std::move(times), std::move(pieces)};
}

void JointTrajectory::requireOf(const KinematicTree& tree) const {
  if (pieces_.empty()) throw std::invalid_argument("the trajectory has been moved from");
  pieces_.front().requireOf(tree, "the trajectory");  // all were made for one tree
}

VectorXd JointTrajectory::configuration(double t) const {
  if (pieces_.empty()) throw std::out_of_range("JointTrajectory: the trajectory has been moved from");
  const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
  const std::size_t k = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double s = (t - times_[k]) / (times_[k + 1] - times_[k]);
  return pieces_[k].configuration(std::min(1.0, std::max(0.0, s)));
}

}  // namespace fcl_artic
