// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz.h"
#include "waypoints.h"

using namespace fcl_artic;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const KinematicTree tree = [] {
    KinematicTree all("r");
    for (const char* link : {"a", "b", "c", "d"}) all.addLink(link);
    const auto add = [&](const char* name, JointType type, const char* parent, const char* child) {
      Joint joint;
      joint.name = name;
      joint.type = type;
      joint.parent = parent;
      joint.child = child;
      all.addJoint(joint);
    };
    add("turn", JointType::continuous, "a", "b");
    add("rail", JointType::prismatic, "b", "c");
    add("ball", JointType::spherical, "c", "d");
    return all;
  }();
  const std::string_view content(reinterpret_cast<const char*>(data), size);
  app::Waypoints waypoints;
  try {
    waypoints = app::parseWaypoints(tree, content, "input.csv");
  } catch (const std::invalid_argument& error) {
    if (std::string(error.what()).find("input.csv") == std::string::npos)
      fuzz::fault("the error does not name the file");
    return 0;
  }
  if (waypoints.times.size() < 2 || waypoints.times.size() != waypoints.configurations.size())
    fuzz::fault("too few waypoints");
  for (const auto interpolation : {app::Interpolation::linear, app::Interpolation::cubic}) {
    for (const bool shortest : {false, true}) {
      try {
        const JointTrajectory way = app::interpolate(tree, waypoints, interpolation, shortest);
        if (way.beginTime() != waypoints.times.front() || way.endTime() != waypoints.times.back()) {
          fuzz::fault("the trajectory has another time than the file");
        }
      } catch (const std::invalid_argument&) {
      }
    }
  }
  return 0;
}
