// SPDX-License-Identifier: BSD-3-Clause
// Clouds of points. The first byte says: 0 PCD, 1 PLY, 2 lines of numbers, of each remainder of 3.
#include "fcl_artic/point_cloud.h"
#include "load_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fcl_artic;
  if (size == 0) return 0;
  const char* const names[] = {"input.pcd", "input.ply", "input.xyz"};
  const std::string name = names[data[0] % 3], content(reinterpret_cast<const char*>(data + 1), size - 1);
  const std::string path = fuzz::Folder::instance().write(name, content);
  std::shared_ptr<PointCloud> cloud;
  if (!fuzz::loads(path, [&] { cloud = loadPointCloud(path, 0.01); })) return 0;
  for (const Eigen::Vector3d& point : cloud->points()) {
    if (!point.allFinite()) fuzz::fault("a point is not finite");
  }
  SceneOptions options;
  options.point_radius = 0.01;
  if (cloud->points().size() <= 2000) fuzz::loadAndQuery(name, content, options);
  return 0;
}
