// SPDX-License-Identifier: BSD-3-Clause
//
// Where the paper measures its Table 1: a PUMA 560 among pipes, and steps of trajectories that go close to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::app {

/// Scene and steps of a question.
struct PipeOptions {
  std::size_t triangles = 100000;
  bool one_mesh = false;                     ///< All pipes are one obstacle; else each is one of its own.
  std::vector<double> angles{1, 5, 15, 30};  ///< degrees
  std::size_t queries = 20;
  double closeness = 0.01;  ///< m
  bool self = false;        ///< Links against links too; else, as in the paper's Section 5, against obstacles only.
  std::uint64_t seed = 1;
};
/// Adds --triangles, --one-mesh, --angles, --queries, --closeness, --self and --seed.
void addPipeOptions(CLI::App& verb, PipeOptions& o);

/// A robot and pipes, ready for queries.
struct PumaInPipes {
  Robot robot;
  Scene pipes;
  std::unique_ptr<ArticulatedCollisionManager> manager;
};
PumaInPipes pumaInPipes(const PipeOptions& o);

/// Steps of one angle, all of them from free configurations.
struct CloseSteps {
  double degrees = 0;
  std::vector<JointMotion> colliding;  ///< Proven to hit a pipe; each ends a trajectory of its own.
  std::vector<JointMotion> free;       ///< Proven free, and to come within the closeness of a pipe.
  std::size_t looked_at = 0;           ///< Free steps that were asked for their closeness to find these.
  double leaf_pairs = 0;               ///< Pairs of triangles that the paper's method compares in a free step, mean.

  /// In one line, with its end.
  std::string summary() const;
  /// Why the free steps measure no exact contact; empty where they do.
  std::string refusal() const;
};

/// Takes steps from trajectories. Each goes straight through joint space, from a random free configuration in a random
/// direction. In each step the joint that moves most moves by the angle. The trajectory ends when a step hits something
/// or would leave the joints' limits. The same angle has the same steps, whatever other angles are asked for.
/// @throws std::runtime_error when the scene has no such steps.
CloseSteps closeSteps(const PumaInPipes& scenery, const PipeOptions& o, double degrees);

/// "PUMA 560 in ...": scene and steps in words, several lines.
std::string description(const PumaInPipes& scenery, const PipeOptions& o, int passes);

}  // namespace fcl_artic::app
