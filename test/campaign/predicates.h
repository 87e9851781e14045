// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include <Eigen/Core>

namespace campaign {

using Vec3 = Eigen::Vector3d;
using Triangle = std::array<Vec3, 3>;

/// Exact sign of det(a - d, b - d, c - d): floating-point filter first, rational arithmetic where it can't tell.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The same by rational arithmetic alone; the twin that the filter is tested against.
int orient3dExact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Whether the closed triangles with exactly these corners have a point in common. Neither may be degenerate.
bool trianglesTouch(const Triangle& s, const Triangle& t);

/// Whether an edge of one triangle crosses the inside of the other, and still does so wherever each corner moves by up
/// to `displacement` (m). A contact that no rounding of poses can explain.
bool trianglesClearlyCross(const Triangle& s, const Triangle& t, double displacement);

}  // namespace campaign
