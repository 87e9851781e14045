// SPDX-License-Identifier: BSD-3-Clause
#include "edges/generate_edges.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "edges/scene_source.h"
#include "exit_status.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "hdf5/hdf5.h"
#include "outputs.h"
#include "random_motions.h"
#include "text/counted.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

struct Edges {
  std::string robot, path;
  std::size_t count = 1000;
  double angle = 0.5;
  std::uint64_t seed = 1;
};

void writeEdges(Edges& o) {
  removeEarlierOutputs({{"OUT.h5", &o.path}}, {o.robot});
  const Robot robot = loadUrdf(o.robot);
  const KinematicTree& tree = *robot.tree;
  RandomMotions motions(tree, o.angle, o.seed);
  std::vector<double> from, to;
  for (std::size_t i = 0; i < o.count; ++i) {
    const MotionEnds ends = motions.next();
    from.insert(from.end(), ends.from.data(), ends.from.data() + ends.from.size());
    to.insert(to.end(), ends.to.data(), ends.to.data() + ends.to.size());
  }
  std::vector<std::string> joints;
  for (int v = 0; v < tree.dof(); ++v) joints.push_back(tree.variableName(v));
  hdf5::Image image;
  image.add("from", {o.count, joints.size()}, from.data());
  image.add("to", {o.count, joints.size()}, to.data());
  image.attribute("", "joints", joints);
  files::write(o.path, image.bytes());
}

struct Scenes {
  std::string path;
  std::size_t count = 10, obstacles = 20;
  double near = 0.35, far = 1.2, size = 0.3;
  std::uint64_t seed = 1;
};

/// Boxes, spheres, cylinders and capsules, turned anyhow, in a ball shell about the origin.
void writeScenes(Scenes& o) {
  removeEarlierOutputs({{"OUT.h5", &o.path}}, {});
  Random random(o.seed);
  std::vector<std::int64_t> first = {0};
  std::vector<std::int8_t> kind;
  std::vector<double> size, position, orientation;
  const auto inBall = [&](auto vector) {
    do {
      for (double& x : vector) x = random.uniform(-1, 1);
    } while (vector.squaredNorm() > 1 || vector.squaredNorm() < 1e-4);
    return vector;
  };
  for (std::size_t s = 0; s < o.count; ++s) {
    for (std::size_t i = 0; i < o.obstacles; ++i) {
      const int which = static_cast<int>(random.uniform(0, kNumShapeKinds));
      kind.push_back(static_cast<std::int8_t>(which));
      // Half of the largest size: a radius, or an edge of a box.
      const double most = which == 0 ? o.size : o.size / 2;
      for (int k = 0; k < 3; ++k) size.push_back(random.uniform(0.1, 1) * most);
      const Eigen::Vector3d p = inBall(Eigen::Vector3d()).normalized() * random.uniform(o.near, o.far);
      position.insert(position.end(), {p[0], p[1], std::abs(p[2])});
      const Eigen::Vector4d q = inBall(Eigen::Vector4d()).normalized();
      orientation.insert(orientation.end(), q.data(), q.data() + 4);
    }
    first.push_back(static_cast<std::int64_t>(kind.size()));
  }
  hdf5::Image image;
  image.add("first", {first.size()}, first.data());
  image.add("kind", {kind.size()}, kind.data());
  image.add("size", {kind.size(), 3}, size.data());
  image.add("position", {kind.size(), 3}, position.data());
  image.add("orientation", {kind.size(), 4}, orientation.data());
  files::write(o.path, image.bytes());
}

}  // namespace

void addGenerateEdges(CLI::App& generate, int& exit_status) {
  auto edges = std::make_shared<Edges>();
  CLI::App* verb = generate.add_subcommand("edges", "Random straight motions within the joints' limits, HDF5");
  verb->add_option("--robot,--urdf", edges->robot, "URDF file")->required()->check(requireInput);
  verb->add_option("--count", edges->count, "Edges wanted")->check(CLI::PositiveNumber)->capture_default_str();
  verb->add_option("--angle", edges->angle, "Joints turn by this at most, rad")
      ->check(requirePositive)
      ->capture_default_str();
  verb->add_option("--seed", edges->seed, "The same seed gives the same edges")->capture_default_str();
  verb->add_option("OUT.h5", edges->path, "File to write")->required();
  verb->callback([edges, &exit_status] {
    writeEdges(*edges);
    fmt::print("{} written to {}\n", text::counted(edges->count, "edge"), edges->path);
    exit_status = kExitFree;
  });

  auto scenes = std::make_shared<Scenes>();
  verb = generate.add_subcommand("scenes", "Random boxes, spheres, cylinders and capsules about the origin, HDF5");
  verb->add_option("--count", scenes->count, "Scenes wanted")->check(CLI::PositiveNumber)->capture_default_str();
  verb->add_option("--obstacles", scenes->obstacles, "Obstacles of each")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb->add_option("--near", scenes->near, "Their centres are farther from the origin than this, m")
      ->check(requireNotNegative)
      ->capture_default_str();
  verb->add_option("--far", scenes->far, "And nearer than this, m")->check(requirePositive)->capture_default_str();
  verb->add_option("--size", scenes->size, "Their largest size along an axis, m")
      ->check(requirePositive)
      ->capture_default_str();
  verb->add_option("--seed", scenes->seed, "The same seed gives the same scenes")->capture_default_str();
  verb->add_option("OUT.h5", scenes->path, "File to write")->required();
  verb->callback([scenes, &exit_status] {
    writeScenes(*scenes);
    fmt::print("{} written to {}\n", text::counted(scenes->count, "scene"), scenes->path);
    exit_status = kExitFree;
  });
}

}  // namespace fcl_artic::app
