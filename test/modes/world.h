// SPDX-License-Identifier: BSD-3-Clause
//
// Random small robots and scenes for the campaign of contact modes, with what a judge needs that shares no code with
// the library: FCL geometries a little smaller and a little larger, poses, pairs and their margins.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fcl/narrowphase/continuous_collision_object.h>

#include "fcl_artic/fcl_artic.h"

namespace modes {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double lower, double upper) {
    return lower + (upper - lower) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  bool chance(double p) { return in(0, 1) < p; }
  /// From now on lengths are multiples of this, and poses have the world's axes: so faces come to lie in one plane, and
  /// bodies graze each other or stop where they touch. 0: no longer.
  void snap(double grid) { grid_ = grid; }
  bool snaps() const { return grid_ > 0; }
  double length(double lower, double upper) {
    const double x = in(lower, upper);
    return grid_ > 0 ? grid_ * std::round(x / grid_) : x;
  }
  Vector3d vector(double size);
  Isometry3d pose(double size);

 private:
  double grid_ = 0;
  std::mt19937_64 engine_;
};

/// FCL answers up to this, in m: a hit counts for geometry that is so much smaller.
constexpr double kAround = 1e-5;

struct Shape {
  std::shared_ptr<fcl::CollisionGeometryd> exact, smaller;
};
Shape randomShape(Random& random, double size);

/// One body of the scene. Two bodies are known by their names.
struct Body {
  enum class Kind { link, attached, still, moving } kind = Kind::link;
  std::string name;
  Shape shape;
  fcl_artic::LinkId link = -1;                 ///< that carries it
  Isometry3d offset = Isometry3d::Identity();  ///< in the link's frame; of what stands still: its pose
  std::shared_ptr<fcl::CollisionObjectd> object;
  std::shared_ptr<fcl::ContinuousCollisionObjectd> moving_object;
  double margin = -1;  ///< of its own; < 0: none
};

using Pair = std::pair<std::string, std::string>;
inline Pair pairOf(const std::string& a, const std::string& b) {
  return a < b ? Pair(a, b) : Pair(b, a);
}

/// A robot, its obstacles, and one motion or trajectory; or two bodies with motions of their own, for the drop-in.
class World {
 public:
  explicit World(Random& random);

  /// @param t  in [begin(), end()].
  std::vector<Isometry3d> poses(double t) const;
  struct Watched {
    std::size_t a, b;  ///< bodies
    bool scene;        ///< asked for by check_scene, else by check_self
    double margin;     ///< of its own; < 0: the request's
    Pair names;
  };
  const std::vector<Watched>& pairs() const { return pairs_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  /// FCL's answer of one pair at these poses: the smaller shapes touch, or come nearer than their margin.
  bool touches(const Watched& pair, const std::vector<Isometry3d>& poses, double margin) const;
  /// Distance by FCL, 0 in contact.
  double distance(const Watched& pair, const std::vector<Isometry3d>& poses) const;

  double begin() const { return trajectory_ ? trajectory_->beginTime() : 0; }
  double end() const { return trajectory_ ? trajectory_->endTime() : 1; }
  bool isPair() const { return !tree_; }  ///< firstOfEveryPair is first there
  bool isTrajectory() const { return trajectory_ != nullptr; }
  void ask(const fcl_artic::CertifiedRequest& request, fcl_artic::CertifiedResult& result) const;
  /// @throws std::invalid_argument for two bodies, which no manager has.
  std::string writeQuery(const fcl_artic::CertifiedRequest& request) const;
  /// Null for two bodies. What is changed is the caller's to set up.
  fcl_artic::ArticulatedCollisionManager* manager() { return manager_.get(); }

 private:
  void addPair(Random& random);
  void addRobot(Random& random);
  void addObstacles(Random& random);
  void choosePairs(Random& random);
  void chooseMotion(Random& random);

  std::shared_ptr<fcl_artic::KinematicTree> tree_;
  std::vector<Body> bodies_;
  std::vector<Watched> pairs_;
  std::unique_ptr<fcl_artic::ArticulatedCollisionManager> manager_;
  std::unique_ptr<fcl_artic::JointMotion> motion_;
  std::unique_ptr<fcl_artic::JointTrajectory> trajectory_;
};

}  // namespace modes
