// SPDX-License-Identifier: BSD-3-Clause
//
// The world that verbs ask about: a robot, the pairs of its links that need no check, obstacles, carried objects.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fcl_artic/urdf/urdf.h"
#include "outputs.h"
#include "pair_options.h"
#include "robot_options.h"
#include "tolerance_options.h"

namespace fcl_artic::app {

struct WorldOptions {
  RobotOptions robot;
  PairOptions pairs;
  ToleranceOptions tolerances;
  std::string auto_srdf;                              ///< file to write; empty: none
  std::uint64_t proof_work = LinkPairOptions().work;  ///< tests at most for the proof of one pair of links
  std::vector<std::string> scenes, solids;            ///< files; names of links and obstacles
  bool unknown_cells = false;
  double scale = 1;         ///< of the scenes
  double point_radius = 0;  ///< of point clouds, m; 0: none is given
  /// The verb asks about whole plans with their times. Else objects must have no speed: where each motion is asked by
  /// itself, they would begin at their places again, and `free` would not hold.
  bool timed = false;
};

/// Adds the whole group "Robot and scene": the robot's options, --auto-srdf, --scene, --scale, --collada-up-axis,
/// --unknown-cells, --point-radius, --solid-meshes, --solid, --attach and those of addPairOptions() and
/// addToleranceOptions(). Each takes one value, so that a verb's own arguments may stand after it.
/// @param robot_names  of the robot's option.
void addWorldOptions(CLI::App& verb, WorldOptions& options, const std::string& robot_names = kRobotNames);

/// The options as `check` takes them, ready for a shell. Without an SRDF they have the pairs of links that need no
/// check found again (--auto-srdf /dev/null).
std::string shellArguments(const WorldOptions& options);

/// The files that the options name as fcl_artic_verify takes them, each word after a space. (It takes no files of
/// carried bodies, and scenes only where it reads all of them.)
std::string verifierArguments(const WorldOptions& options);
/// A word of a shell's command.
std::string shellWord(const std::string& word);

/// The scene's options; what links carry has the same, but for the scale.
SceneOptions sceneOptions(const WorldOptions& options);

/// Reads and sets up what the options name: open(), or its steps, in their order, where a verb measures their time.
class World {
 public:
  /// @param options  must outlive this object.
  /// @throws as readPairSettings() and readToleranceSettings(); std::invalid_argument for a speed without
  ///   WorldOptions::timed.
  explicit World(const WorldOptions& options);

  /// Reads the robot, proves pairs of links if the request's queries use that, and reads the obstacles.
  /// @throws as the steps below.
  void open(const CertifiedRequest& request);

  /// Reads the robot and the pairs that its SRDF allows.
  /// @throws as loadUrdf() and loadSrdf(), and std::invalid_argument for a link that can't be made solid.
  void readRobot();
  /// Finds proofs of pairs of links that never come within a margin, and notes pairs without a proof. With --srdf, of
  /// the pairs that it and --allow allow. Without, of all pairs: those that always touch become allowed, and
  /// --auto-srdf is written.
  /// @param margin  m.
  LinkPairReport provePairs(double margin);
  /// Reads the obstacles and what links carry.
  /// @throws as loadScene() and parseAttachment(), and std::invalid_argument for a --solid that names nothing.
  void readScene();
  /// A manager of all this, after setup().
  /// @throws std::invalid_argument as ArticulatedCollisionManager::attach(), and as PairSettings::apply().
  /// @param change  called before setup().
  ArticulatedCollisionManager makeManager(const std::function<void(ArticulatedCollisionManager&)>& change = {}) const;
  /// Notes of robot, scene and manager, and what suggests other units, one line each.
  /// @param manager  of this world.
  std::vector<std::string> notes(const ArticulatedCollisionManager& manager) const;
  const PairSettings& pairs() const { return pairs_; }
  const ToleranceSettings& tolerances() const { return tolerances_; }

  Robot robot;
  Scene scene;                          ///< The last obstacles are carried, one for each attachment.
  std::vector<Attachment> attachments;  ///< in the order of the carried obstacles
  UnwrittenOutputs unwritten;           ///< of the run

 private:
  void allowLinks();

  const WorldOptions& options_;
  const PairSettings pairs_;
  const ToleranceSettings tolerances_;
  std::set<std::string> solids_;  ///< names that are still to be found
};

}  // namespace fcl_artic::app
