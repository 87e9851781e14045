// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace fcl_artic {

/// Gap of two triangles, corners in columns, along n; below 0: they overlap along it.
inline double gapAlong(const Eigen::Vector3d& n, const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (n.transpose() * b).minCoeff() - (n.transpose() * a).maxCoeff();
}

/// A direction, from a to b, along which two triangles hardly overlap. It is the one given, unit, where they hardly
/// overlap along that. Else it is the normal of a face, or the common one of two edges or of a face and an edge, along
/// which they overlap least. (Some such direction parts triangles that do not cross each other.)
inline Eigen::Vector3d partingDirection(const Eigen::Vector3d corners_a[3], const Eigen::Vector3d corners_b[3],
                                        const Eigen::Vector3d& given) {
  using Eigen::Vector3d;
  const Eigen::Matrix3d a = Eigen::Matrix3d::Map(corners_a[0].data()), b = Eigen::Matrix3d::Map(corners_b[0].data());
  Vector3d best = given;
  double most = gapAlong(given, a, b);
  constexpr double kLeastOverlap = 1e-6;  // of their size
  if (most >= -kLeastOverlap * (a.cwiseAbs().maxCoeff() + b.cwiseAbs().maxCoeff())) return given;
  // Below this sine a cross product is no direction any more.
  const auto offer = [&](const Vector3d& u, const Vector3d& v) {
    const Vector3d across = u.cross(v);
    if (!(across.norm() > 1e-9 * u.norm() * v.norm())) return;
    for (const double sign : {1.0, -1.0}) {
      const Vector3d n = sign * across.normalized();
      const double gap = gapAlong(n, a, b);
      if (gap > most) most = gap, best = n;
    }
  };
  const Vector3d edges_a[] = {a.col(1) - a.col(0), a.col(2) - a.col(1), a.col(0) - a.col(2)},
                 edges_b[] = {b.col(1) - b.col(0), b.col(2) - b.col(1), b.col(0) - b.col(2)};
  const Vector3d face_a = edges_a[0].cross(edges_a[1]), face_b = edges_b[0].cross(edges_b[1]);
  offer(edges_a[0], edges_a[1]);
  offer(edges_b[0], edges_b[1]);
  for (const Vector3d& e : edges_a) {
    offer(face_a, e);
    for (const Vector3d& f : edges_b) offer(e, f);
  }
  for (const Vector3d& f : edges_b) offer(face_b, f);
  return best;
}

}  // namespace fcl_artic
