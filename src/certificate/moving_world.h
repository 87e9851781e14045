// SPDX-License-Identifier: BSD-3-Clause
//
// A world in motion, in doubles: where its frames are, how far its bodies reach along a direction, how fast they can
// turn away. Nothing here is proven: the emitter uses it to choose the hints that it writes.
#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "certificate/world.h"

namespace fcl_artic::certificate {

/// One motion over t in [0, 1], as a certificate states it.
struct Motion {
  Eigen::MatrixXd coefficients;               ///< of the world's variables, column k for t^k
  std::vector<Eigen::Matrix3d> orientations;  ///< R0, as World::orientations lists them
  double margin = 0, added = 0;               ///< m
  bool self = true, scene = true;             ///< what is checked
  struct Ignored {
    int a, b;      ///< bodies, a < b
    double until;  ///< not checked before that time
  };
  std::vector<Ignored> ignored;
  /// The time that has passed since the whole motion's begin, at t = 0 and at t = 1; linear between.
  double clock_begin = 0, clock_end = 1;
  double until = 1;     ///< the claim is on [0, until]
  std::string missing;  ///< why the motion cannot be stated; empty: it can
};

struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  Pose operator*(const Pose& next) const { return {R * next.R, R * next.c + c}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * c)}; }
};

class MovingWorld {
 public:
  MovingWorld(const World& world, const Motion& motion);

  const World& world() const { return world_; }
  const Motion& motion() const { return motion_; }
  const Body& body(int i) const { return world_.bodies[static_cast<std::size_t>(i)]; }
  const Geometry& geometry(int body) const {
    return world_.geometries[static_cast<std::size_t>(this->body(body).geometry)];
  }
  /// Pose of the body's geometry at time t, in the frame.
  const Pose& pose(int body, int frame, double t);
  /// Bound, by rule of thumb, on |x''| for the body's points x seen from the frame, around time t.
  double acceleration(int body, int frame, double t);
  /// About the most that tolerances let the points below the two nodes move against each other at time t, seen from
  /// where that is least (doc/TUBES.md).
  double stray(int a, std::int32_t node_a, int b, std::int32_t node_b, double t);
  /// The same of one body against a place that stands still in the world.
  double stray(int body, std::int32_t node, double t);
  /// How far a body can have come by itself at time t.
  double wayOf(int body, double t) const;
  /// How far a body strays by the tolerance of its own pose.
  double ownStray(int body, std::int32_t node);
  double margin(int a, int b) const { return world_.marginOf(body(a), body(b), motion_.margin, motion_.added); }

 private:
  double value(int variable, double t) const;
  Pose pose(const Element& element, double t) const;
  const World& world_;
  const Motion& motion_;
  std::vector<Pose> in_frame_;               ///< of bodies
  std::vector<Pose> origins_;                ///< of frames
  std::vector<double> rate_, acceleration_;  ///< of variables: bounds on |q'|, |q''|
  struct Moment {
    std::vector<Pose> frames;                    ///< in the world
    std::map<std::pair<int, int>, Pose> bodies;  ///< seen from frames
    std::vector<std::vector<Pose>> places;       ///< of each frame's gives, in the world
    /// By body, node, place (a frame and the number of a give; -1 - body): the most that it moves the points there.
    std::map<std::array<int, 4>, double> moves;
  };
  /// A place where something gives: a frame's, or a body's own.
  struct Place {
    int frame, give, body;  ///< frame -1: the body's
  };
  std::vector<Place> placesBetween(int a, int b) const;
  double moveAt(const Place& place, int body, std::int32_t node, double t);
  Moment& moment(double t);
  std::map<double, Moment> moments_;
};

/// The largest distance of the pieces below a node from the axis through a point, or, without an axis, from the point;
/// of round shapes a little more.
/// @param axis  unit vector, or 0.
double largestDistance(const Geometry& geometry, std::int32_t node, const Eigen::Vector3d& point,
                       const Eigen::Vector3d& axis);

/// A point of the pieces below a node that is farthest along u, not far from it where `exact` is false.
/// @param u  in the geometry's frame, any length but 0.
Eigen::Vector3d farthest(const Geometry& geometry, std::int32_t node, const Eigen::Vector3d& u, bool exact);

}  // namespace fcl_artic::certificate
