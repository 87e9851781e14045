// SPDX-License-Identifier: BSD-3-Clause
// Plans in all formats: the first byte says which.
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
    add("cart", JointType::planar, "c", "d");
    return all;
  }();
  constexpr plans::Format kFormats[] = {plans::Format::csv,  plans::Format::json, plans::Format::jsonl,
                                        plans::Format::yaml, plans::Format::ompl, plans::Format::numpy};
  if (size == 0) return 0;
  const std::string_view content(reinterpret_cast<const char*>(data + 1), size - 1);
  std::vector<plans::Plan> all;
  try {
    all = plans::parsePlans(tree, content, kFormats[data[0] % 6]);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  if (all.empty()) fuzz::fault("neither a plan nor an error");
  for (const plans::Plan& plan : all) {
    for (const plans::Turns turns : {plans::Turns::ask, plans::Turns::shortest}) {
      plans::MotionOptions options;
      options.turns = turns;
      try {
        const plans::PlanMotion motion = plans::toMotion(tree, plan, options);
        if (!plan.error.empty()) fuzz::fault("a wrong plan has become a motion");
        if (motion.times.size() != plan.positions.size() || motion.trajectory.beginTime() != motion.times.front() ||
            motion.trajectory.endTime() != motion.times.back()) {
          fuzz::fault("the motion has other waypoints than the plan");
        }
        for (std::size_t k = 0; k < motion.times.size(); ++k) {
          for (std::size_t j = 0; j < motion.joints.size(); ++j) {
            if (!std::isfinite(plan.positions[k][j])) fuzz::fault("a waypoint that is not finite");
          }
        }
      } catch (const std::invalid_argument&) {
      }
    }
  }
  return 0;
}
