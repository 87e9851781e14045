// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "meshes/readers.h"
#include "meshes/text.h"

namespace fcl_artic {

std::shared_ptr<PointCloud> loadPointCloud(const std::string& path, double radius, std::vector<std::string>* notes) {
  const std::string ending = detail::endingOf(path);
  if (!(radius > 0 && std::isfinite(radius))) {
    throw std::invalid_argument("loadPointCloud: a radius of " + detail::text(radius) + " m is not above 0 and finite");
  }
  const std::string content = files::read(path);
  const meshes::Source source{path, content, "point cloud '" + path + "'", notes};
  meshes::Points points;
  if (ending == ".pcd") {
    points = meshes::readPcd(source);
  } else if (ending == ".ply") {
    points = meshes::readPlyPoints(source);
  } else if (ending == ".xyz") {
    points = meshes::readXyz(source);
  } else {
    source.refuse("its name ends in none of .pcd, .ply and .xyz");
  }
  meshes::noteComments(source);
  const std::size_t all = points.size();
  const auto isNear = [](const Eigen::Vector3d& x) {
    return (x.array() == -std::numeric_limits<double>::infinity()).any();
  };
  const auto near = static_cast<std::size_t>(std::count_if(points.begin(), points.end(), isNear));
  points.erase(std::remove_if(points.begin(), points.end(), [](const Eigen::Vector3d& x) { return !x.allFinite(); }),
               points.end());
  if (points.empty()) source.refuse("has no point");
  if (points.size() < all) {
    source.note(std::to_string(all - points.size()) + " of " + std::to_string(all) +
                " points are not finite, as of rays without an echo, and left out");
  }
  if (near > 0) {
    source.note(std::to_string(near) +
                " of these are -inf, by which some cameras mean that something is too near to be "
                "measured: it is not in the scene");
  }
  try {
    return std::make_shared<PointCloud>(std::move(points), radius);
  } catch (const std::invalid_argument& e) {
    source.refuse(e.what());
  }
}

}  // namespace fcl_artic
