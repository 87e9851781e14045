// SPDX-License-Identifier: BSD-3-Clause
#include "tolerance_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "kinematics/angles.h"
#include "robot_options.h"

namespace fcl_artic::app {
namespace {

constexpr const char* kGroup = "Robot and scene";

/// A number with its unit.
struct Quantity {
  bool angle;    ///< else a length
  double value;  ///< rad or m
};

[[noreturn]] void refuse(const std::string& where, const std::string& text, const std::string& why) {
  throw std::invalid_argument(fmt::format("{}: '{}' {}", where, text, why));
}

/// A number of at least 0, and what stands after it.
std::pair<double, std::string> readNumber(const std::string& where, const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || !std::isfinite(value)) refuse(where, text, "does not begin with a number");
  if (value < 0) refuse(where, text, "is below 0");
  return {value, std::string(stop, end)};
}

Quantity readQuantity(const std::string& where, const std::string& text) {
  const auto [value, unit] = readNumber(where, text);
  struct Unit {
    const char* name;
    bool angle;
    double size;
  };
  static constexpr Unit kUnits[] = {
      {"deg", true, kRadiansPerDegree}, {"rad", true, 1}, {"m", false, 1}, {"cm", false, 0.01}, {"mm", false, 0.001}};
  for (const Unit& known : kUnits) {
    if (unit == known.name) return {known.angle, value * known.size};
  }
  refuse(where, text, "has no unit: write deg or rad for an angle, m, cm or mm for a length");
}

/// @throws std::invalid_argument: a tolerance of all joints is an angle, and none turns, or a length, and none slides.
void requireFitsSome(const ToleranceSettings::OfJoint& of, const KinematicTree& tree) {
  const bool angle = of.angle.has_value();
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const JointType type = tree.joint(j).type;
    const bool turns = type != JointType::fixed && type != JointType::prismatic;
    const bool slides = type == JointType::prismatic || type == JointType::planar || type == JointType::floating;
    if (!tree.joint(j).mimics && (angle ? turns : slides)) return;
  }
  const auto [kind, moves, cure] = angle ? std::array{"an angle", "turns", "a length, as 1mm"}
                                         : std::array{"a length", "slides", "an angle, as 0.3deg"};
  throw std::invalid_argument(fmt::format("{}: {} for all joints fits none, as no joint of robot '{}' {}: write {}",
                                          of.where, kind, tree.name(), moves, cure));
}

ToleranceSettings::OfObject readPose(const std::string& where, const std::string& object, const std::string& text) {
  ToleranceSettings::OfObject of{where, object, 0, 0};
  bool has[2] = {false, false};
  for (const std::string& part : split(text, ',')) {
    const Quantity quantity = readQuantity(where, part);
    if (std::exchange(has[quantity.angle], true)) refuse(where, text, "has two angles or two lengths");
    (quantity.angle ? of.angle : of.length) = quantity.value;
  }
  return of;
}

/// The object that `text` names before its last '='; the rest is `value`.
template <class Settings>
std::string readObject(const std::string& where, const std::string& text, const char* form, const Settings& before,
                       std::string& value) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) refuse(where, text, fmt::format("is not {}", form));
  const std::string object = text.substr(0, equals);
  for (const auto& other : before) {
    if (other.object == object) refuse(where, text, "is a second one of this object");
  }
  value = text.substr(equals + 1);
  return object;
}

}  // namespace

void addToleranceOptions(CLI::App& verb, ToleranceOptions& o, bool timed) {
  verb.add_option("--joint-tolerance", o.joints,
                  "How far joints may be from the motion: 0.3deg for all that turn, 1mm for all that slide, "
                  "JOINT=0.5deg,JOINT2=1mm for some; may be repeated. Free is every path within")
      ->allow_extra_args(false)
      ->group(kGroup)
      ->type_name("TOLERANCE");
  verb.add_option("--base-tolerance", o.base,
                  "How far the robot's base may be from its place in the world: 2mm,0.1deg (about the origin)")
      ->group(kGroup)
      ->type_name("LENGTH,ANGLE");
  verb.add_option("--tolerance", o.objects,
                  "How far an obstacle or a carried object may be from its pose: OBJECT=5mm,1deg (about its frame's "
                  "origin); may be repeated")
      ->allow_extra_args(false)
      ->group(kGroup)
      ->type_name("OBJECT=LENGTH,ANGLE");
  verb.add_option("--speed", o.speeds,
                  "How fast an obstacle or a carried object may move by itself, from the plan's first waypoint on: "
                  "person=1.6, in m/s; may be repeated. Free is then wherever it goes. Plans need times")
      ->allow_extra_args(false)
      ->group(timed ? kGroup : "")
      ->type_name("OBJECT=SPEED");
}

ToleranceSettings readToleranceSettings(const ToleranceOptions& o) {
  ToleranceSettings out;
  for (const std::string& option : o.joints) {
    const std::string where = "--joint-tolerance";
    for (const std::string& text : split(option, ',')) {
      const std::size_t equals = text.rfind('=');
      ToleranceSettings::OfJoint of{where, equals == std::string::npos ? "" : text.substr(0, equals), {}, {}};
      if (equals == 0) refuse(where, text, "names no joint");
      const Quantity quantity = readQuantity(where, equals == std::string::npos ? text : text.substr(equals + 1));
      (quantity.angle ? of.angle : of.length) = quantity.value;
      for (const ToleranceSettings::OfJoint& before : out.joints) {
        const bool again = of.angle ? before.angle.has_value() : before.length.has_value();
        if (before.joint == of.joint && again) {
          refuse(where, text, of.joint.empty() ? "is a second one of all joints" : "is a second one of this joint");
        }
      }
      out.joints.push_back(of);
    }
  }
  if (!o.base.empty()) out.base = readPose("--base-tolerance", "", o.base);
  for (const std::string& text : o.objects) {
    const std::string where = "--tolerance";
    std::string value;
    const std::string object = readObject(where, text, "OBJECT=LENGTH,ANGLE", out.objects, value);
    out.objects.push_back(readPose(where, object, value));
  }
  for (const std::string& text : o.speeds) {
    const std::string where = "--speed";
    std::string value;
    const std::string object = readObject(where, text, "OBJECT=SPEED", out.speeds, value);
    const auto [speed, unit] = readNumber(where, value);
    if (!unit.empty() && unit != "m/s") refuse(where, value, "has another unit: write it in m/s, as 1.6");
    out.speeds.push_back({where, object, speed});
  }
  return out;
}

void ToleranceSettings::apply(const Scene& scene, ArticulatedCollisionManager& manager) const {
  const auto set = [](const std::string& where, const auto& change) {
    try {
      change();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("{}: {}", where, error.what()));
    }
  };
  JointTolerance all;
  for (const OfJoint& of : joints) {
    if (!of.joint.empty()) continue;
    requireFitsSome(of, manager.tree());
    all.angle = of.angle.value_or(all.angle);
    all.length = of.length.value_or(all.length);
  }
  manager.setJointTolerances(all);
  for (const OfJoint& of : joints) {
    if (of.joint.empty()) continue;
    JointTolerance own;  // an angle and a length of one joint are two options
    for (const OfJoint& other : joints) {
      if (other.joint != of.joint) continue;
      own.angle = other.angle.value_or(own.angle);
      own.length = other.length.value_or(own.length);
    }
    set(of.where, [&] { manager.setJointTolerance(of.joint, own); });
  }
  if (base) manager.setBaseTolerance({base->length, base->angle, Eigen::Vector3d::Zero()});
  const auto setAll = [&](const auto& of, const auto& change) {
    std::vector<std::string> names = scene.namesOf(of.object);
    if (names.empty()) names.push_back(of.object);
    for (const std::string& name : names) set(of.where, [&] { change(name); });
  };
  for (const OfObject& of : objects) {
    setAll(of, [&](const std::string& name) {
      manager.setObjectTolerance(name, {of.length, of.angle, Eigen::Vector3d::Zero()});
    });
  }
  for (const OfSpeed& of : speeds) {
    setAll(of, [&](const std::string& name) { manager.setObjectSpeed(name, {of.speed, 0}); });
  }
}

std::string ToleranceSettings::text() const {
  std::vector<std::string> lines;
  for (const OfJoint& of : joints) {
    lines.push_back(fmt::format("joint {}\n{:a} {:a}", of.joint, of.angle.value_or(-1), of.length.value_or(-1)));
  }
  if (base) lines.push_back(fmt::format("base {:a} {:a}", base->length, base->angle));
  for (const OfObject& of : objects)
    lines.push_back(fmt::format("object {}\n{:a} {:a}", of.object, of.length, of.angle));
  for (const OfSpeed& of : speeds) lines.push_back(fmt::format("speed {}\n{:a}", of.object, of.speed));
  std::sort(lines.begin(), lines.end());
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

}  // namespace fcl_artic::app
