// SPDX-License-Identifier: BSD-3-Clause
#include "meshes/triangle_soup.h"

#include <Eigen/Geometry>

#include <cmath>

#include "meshes/polygon.h"

namespace fcl_artic::meshes {
namespace {

/// Whether a corner is farther from the plane through the corners' middle than decimals of six digits may leave it.
/// Such decimals move a coordinate by up to 5e-6 of its size, so a corner by 9e-6 of the largest, and the plane by as
/// much.
bool isUneven(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  double size = 0;
  for (const Eigen::Vector3d& x : corners) {
    middle += x / static_cast<double>(corners.size());
    size = std::max(size, x.cwiseAbs().maxCoeff());
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += (corners[i] - middle).cross(corners[(i + 1) % corners.size()] - middle);
  }
  if (!(normal.norm() > 0)) return false;
  normal.normalize();
  for (const Eigen::Vector3d& x : corners) {
    if (std::abs(normal.dot(x - middle)) > 2e-5 * size) return true;
  }
  return false;
}

}  // namespace

void TriangleSoup::addFace(const std::size_t* corners, std::size_t count, const Source& source) {
  if (count == 0) source.refuse("has a face without a corner");
  for (std::size_t k = 0; k < count; ++k) {
    if (corners[k] >= vertices.size()) {
      source.refuse("has a face with vertex " + std::to_string(corners[k]) + " of " + std::to_string(vertices.size()));
    }
    if (!vertices[corners[k]].allFinite()) source.refuse("vertex " + std::to_string(corners[k]) + " is not finite");
  }
  if (count < 3) return void(++(count == 1 ? points : lines));
  if (count == 3) {
    triangles.emplace_back(corners[0], corners[1], corners[2]);
    return;
  }
  std::vector<Eigen::Vector3d> x;
  x.reserve(count);
  for (std::size_t k = 0; k < count; ++k) x.push_back(vertices[corners[k]]);
  const auto cut = cutPolygon(x, compared);
  if (cut.empty()) {
    source.refuse("has a face of " + std::to_string(count) +
                  " corners that takes too long to cut: cut it into triangles");
  }
  uneven += isUneven(x);
  for (const auto& [a, b, c] : cut) triangles.emplace_back(corners[a], corners[b], corners[c]);
}

void TriangleSoup::noteSkipped(const Source& source) const {
  if (points > 0) source.note("its points, " + std::to_string(points) + ", have no surface and were left out");
  if (lines > 0) source.note("its lines, " + std::to_string(lines) + ", have no surface and were left out");
  if (uneven > 0) {
    source.note(counted(uneven, "face") + (uneven == 1 ? " is" : " are") +
                " not flat: how they were cut into triangles is this reader's choice");
  }
}

}  // namespace fcl_artic::meshes
