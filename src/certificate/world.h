// SPDX-License-Identifier: BSD-3-Clause
//
// The world of a certificate (doc/CERTIFICATES.md): what stands and moves and what is checked, as plain data and as the
// text that proofs are about. It is made from what callers gave the manager, not from what the engine made of that.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "certificate/tolerances.h"
#include "geometry/shape_tree.h"
#include "setup/registry.h"

namespace fcl_artic::certificate {

/// A factor of a frame's pose. Its parameter is multiplier * q(t) + offset for the variable's q.
struct Element {
  enum class Kind {
    turn,   ///< about `axis`, rad
    slide,  ///< along `axis`, m
    rotate  ///< exp([w]) R0, w of three variables
  };
  Kind kind;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  int variable = 0;  ///< its first one
  double multiplier = 1, offset = 0;
};

/// A place where tolerances let one side move against the other: its points by at most `slide` + `chord` times their
/// distance from an axis, or from a point.
struct Give {
  int element = -1;  ///< of the frame; the place is after it, or before all of them
  bool axis = false;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< the axis through the origin, or the point
  double slide = 0, chord = 0;                   ///< m; 2 sin(angle / 2)
};

/// pose = pose of the parent * origin * elements. Frame 0 is the world; parents come before their children.
struct Frame {
  std::string name;
  int parent = 0;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  std::vector<Element> elements;
  std::vector<Give> gives;  ///< in their order
};

/// A geometry's pieces in the order of its tree, so that what is below a node is an interval of them.
struct Geometry {
  std::shared_ptr<const ShapeTree> shape;
  struct Interval {
    std::int32_t begin, end;
  };
  std::vector<Interval> below;      ///< by node of the tree
  std::vector<std::int32_t> order;  ///< the tree's piece at each place
  bool unbounded = false;
  double radius = 0;  ///< of a ball about the geometry's frame that holds it, m; of bounded ones

  explicit Geometry(std::shared_ptr<const ShapeTree> shape);
};

struct Body {
  enum class Role { link, carried, obstacle };
  Role role;
  std::string name;
  int frame, geometry;
  Eigen::Isometry3d pose;     ///< in the frame
  std::int32_t number;        ///< as the registry counts bodies
  double own_margin = -1;     ///< of its name, m; -1: none
  std::vector<Give> gives;    ///< of its pose, in the geometry's frame: none or one
  ObjectSpeed speed;          ///< at which it may move by itself
  std::vector<int> partners;  ///< bodies of lower number that make a checked pair with it, ascending
};

struct World {
  std::vector<std::string> variables;  ///< the robot's, then those of moving obstacles
  std::vector<Frame> frames;
  std::vector<Geometry> geometries;
  std::vector<Body> bodies;  ///< obstacles that stand still first, unbounded ones before the others; then those that
                             ///< move; then what links carry
  NamedMargins margins;
  bool tolerant = false;  ///< a frame or a body gives, or a body moves by itself
  bool clocked = false;   ///< a body moves by itself: motions state their clock
  /// Polynomials of moving obstacles' variables over t in [0, 1], column k for t^k: rows for variables from
  /// `first_moving` on.
  Eigen::MatrixXd moving;
  int first_moving = 0;
  std::vector<int> orientations;            ///< first variable of each `rotate` whose R0 the motion gives, in its order
  std::shared_ptr<const std::string> text;  ///< what a verifier reads
  std::string hash;                         ///< its SHA-256, in hexadecimal digits
  std::string missing;                      ///< why no certificate can be made in this world; empty: one can

  /// The body that the registry counts as `number`.
  int bodyOf(std::int32_t number) const;
  /// Margin of a pair that a motion with these margins asks for, m.
  double marginOf(const Body& a, const Body& b, double margin, double added) const;
};

/// @param registry  what is set up.
World makeWorld(const Registry& registry, const WorldTolerances& tolerances);
/// Two bodies, "body1" and "body2", each with a motion of its own. The shapes must outlive the world.
World makeWorld(const ShapeTree& shape1, const BodyMotion& motion1, const ShapeTree& shape2, const BodyMotion& motion2,
                const WorldTolerances& tolerances = {});

/// A number as statements have it: C's hexadecimal floating-point constant.
std::string numberText(double x);
/// Verifiers refuse larger numbers (doc/CERTIFICATES.md, "The verifier's arithmetic").
constexpr double kLargestNumber = 0x1p40;
/// The nine numbers of a rotation by rows, words separated by spaces.
std::string rotationText(const Eigen::Matrix3d& R);

}  // namespace fcl_artic::certificate
