// SPDX-License-Identifier: BSD-3-Clause
//
// Options about how far the real robot and scene may be from the model.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fcl_artic/manager.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::app {

/// As they are typed. An ANGLE ends with "deg" or "rad", a LENGTH with "m", "cm" or "mm".
struct ToleranceOptions {
  std::vector<std::string> joints;   ///< of all joints ANGLE or LENGTH; of some JOINT=..., several with commas
  std::string base;                  ///< LENGTH, ANGLE, or both with a comma; empty: none
  std::vector<std::string> objects;  ///< OBJECT=LENGTH,ANGLE, or one of both
  std::vector<std::string> speeds;   ///< OBJECT=SPEED, in m/s or with its unit
};

/// Adds --joint-tolerance, --base-tolerance and --tolerance, in the group "Robot and scene", and --speed.
/// @param timed  --speed is in that group, too; else the help does not show it, as the verb refuses it.
void addToleranceOptions(CLI::App& verb, ToleranceOptions& options, bool timed);

/// The same, read.
struct ToleranceSettings {
  struct OfJoint {
    std::string where;  ///< begins messages
    std::string joint;  ///< empty: all joints
    std::optional<double> angle, length;
  };
  struct OfObject {
    std::string where, object;
    double length = 0, angle = 0;
  };
  struct OfSpeed {
    std::string where, object;
    double speed = 0;  ///< m/s
  };
  std::vector<OfJoint> joints;
  std::optional<OfObject> base;
  std::vector<OfObject> objects;
  std::vector<OfSpeed> speeds;

  bool any() const { return !joints.empty() || base || !objects.empty() || !speeds.empty(); }
  /// Sets them. The name of an object of several shapes stands for all of them.
  /// @throws std::invalid_argument naming the option, as ArticulatedCollisionManager::setJointTolerance(). Also for a
  ///   tolerance of all joints that fits none: an angle where none turns, a length where none slides.
  void apply(const Scene& scene, ArticulatedCollisionManager& manager) const;
  /// The same text for the same settings: for hashes of what a run is about.
  std::string text() const;
};

/// @throws std::invalid_argument naming what was typed: it is not as above, or two tolerances or speeds of one
///   joint or object.
ToleranceSettings readToleranceSettings(const ToleranceOptions& options);

}  // namespace fcl_artic::app
