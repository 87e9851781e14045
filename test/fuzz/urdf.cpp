// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/urdf/urdf.h"

#include "fuzz.h"

using namespace fcl_artic;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Folder& folder = fuzz::Folder::instance();
  static const std::string mesh = folder.write("t.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n");
  const std::string path = folder.write("robot.urdf", std::string(reinterpret_cast<const char*>(data), size));
  Robot robot;
  if (!fuzz::loads(path, [&] { robot = loadUrdf(path); })) return 0;
  if (robot.tree->numLinks() > 12 || robot.geometry.size() > 12) return 0;  // time
  ArticulatedCollisionManager manager(robot.tree);
  try {
    robot.addTo(manager);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  fuzz::query(manager);
  return 0;
}
