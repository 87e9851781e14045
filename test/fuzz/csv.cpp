// SPDX-License-Identifier: BSD-3-Clause
// Plans in CSV, and all curves through their waypoints.
#include "plans/csv.h"
#include "fuzz.h"
#include "plans/motion.h"

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
  plans::Plan plan;
  try {
    plan = plans::parseCsv(tree, content);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  using plans::Interpolation;
  for (const auto interpolation : {Interpolation::automatic, Interpolation::linear, Interpolation::jtcUpsampled,
                                   Interpolation::jtcNone, Interpolation::tangentHalfAngle}) {
    for (const auto turns : {plans::Turns::given, plans::Turns::shortest}) {
      plans::MotionOptions options;
      options.interpolation = interpolation;
      options.turns = turns;
      try {
        const plans::PlanMotion way = plans::toMotion(tree, plan, options);
        if (way.times.size() < 2 || way.times.size() != plan.positions.size()) fuzz::fault("too few waypoints");
        if (way.trajectory.beginTime() != way.times.front() || way.trajectory.endTime() != way.times.back()) {
          fuzz::fault("the trajectory has another time than the file");
        }
      } catch (const std::invalid_argument&) {
      }
    }
  }
  return 0;
}
