// SPDX-License-Identifier: BSD-3-Clause
// The first byte says which of the files it is.
#include "fuzz.h"
#include "planning/problems.h"

using namespace fcl_artic;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const auto tree = [] {
    auto all = std::make_shared<KinematicTree>("r");
    all->addLink("base");
    all->addLink("arm");
    Joint joint;
    joint.name = "turn";
    joint.type = JointType::continuous;
    joint.parent = "base";
    joint.child = "arm";
    all->addJoint(joint);
    return all;
  }();
  const std::string path =
      fuzz::Folder::instance().write("input.json", std::string(reinterpret_cast<const char*>(data + 1), size - 1));
  if (const int kind = data[0] % 3; kind > 0) {
    std::vector<planning_data::Edge> edges;
    fuzz::loads(path, [&] { edges = kind == 1 ? planning_data::readTrace(path) : planning_data::readMissed(path); });
    for (const planning_data::Edge& edge : edges) {
      if (edge.problem < 0) fuzz::fault("a problem's number that no file has");
    }
    return 0;
  }
  planning_data::Environment environment;
  if (!fuzz::loads(path, [&] { environment = planning_data::readEnvironment(path, *tree); })) return 0;
  for (const planning_data::Problem& problem : environment.problems) {
    ArticulatedCollisionManager manager(tree);
    try {
      problem.scene.addTo(manager);
    } catch (const std::invalid_argument&) {
      continue;
    }
    fuzz::query(manager);
  }
  return 0;
}
