// SPDX-License-Identifier: BSD-3-Clause
//
// Rotation vectors and quaternions.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace fcl_artic {

/// exp([w]) as a quaternion.
inline Eigen::Quaterniond quaternionOf(const Eigen::Vector3d& w) {
  const double angle = w.norm(), half = angle / 2;
  const double part = angle > 0 ? std::sin(half) / angle : 0.5;
  Eigen::Quaterniond q;
  q.vec() = part * w;
  q.w() = std::cos(half);
  return q;
}

/// The shortest w with exp([w]) = q, |w| <= π. If there are two, at exactly π, it is the one of q as it is given.
inline Eigen::Vector3d rotationVectorOf(Eigen::Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine == 0) return Eigen::Vector3d::Zero();
  return (2 * std::atan2(sine, q.w()) / sine) * q.vec();
}

}  // namespace fcl_artic
