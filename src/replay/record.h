// SPDX-License-Identifier: BSD-3-Clause
//
// A query as plain data, and its fields in JSON (replay/json_fields.h): all that an answer depends on. Numbers are
// those that the library has, not rounded once more, in m and rad. A pose is 12 numbers, the rows of (R | t).
#pragma once

#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/request.h"
#include "motion/body_motion.h"
#include "replay/json_fields.h"

namespace fcl_artic {

inline constexpr NamedValue<JointType> kJointTypes[] = {
    {JointType::fixed, "fixed"},         {JointType::revolute, "revolute"}, {JointType::continuous, "continuous"},
    {JointType::prismatic, "prismatic"}, {JointType::planar, "planar"},     {JointType::spherical, "spherical"},
    {JointType::floating, "floating"}};
constexpr const auto& namesOf(JointType) {
  return kJointTypes;
}
/// (No text holds a BoundedMotion.)
inline constexpr NamedValue<MotionElement::Kind> kMotionElements[] = {{MotionElement::Kind::revolute, "revolute"},
                                                                      {MotionElement::Kind::prismatic, "prismatic"},
                                                                      {MotionElement::Kind::slide, "slide"},
                                                                      {MotionElement::Kind::turn, "turn"}};
constexpr const auto& namesOf(MotionElement::Kind) {
  return kMotionElements;
}

namespace replay {

enum class Shape {
  box,
  sphere,
  ellipsoid,
  capsule,
  cylinder,
  cone,
  halfspace,
  plane,
  triangle,
  convex,
  mesh,
  points,
  octree
};
inline constexpr NamedValue<Shape> kShapes[] = {{Shape::box, "box"},
                                                {Shape::sphere, "sphere"},
                                                {Shape::ellipsoid, "ellipsoid"},
                                                {Shape::capsule, "capsule"},
                                                {Shape::cylinder, "cylinder"},
                                                {Shape::cone, "cone"},
                                                {Shape::halfspace, "halfspace"},
                                                {Shape::plane, "plane"},
                                                {Shape::triangle, "triangle"},
                                                {Shape::convex, "convex"},
                                                {Shape::mesh, "mesh"},
                                                {Shape::points, "points"},
                                                {Shape::octree, "octree"}};
constexpr const auto& namesOf(Shape) {
  return kShapes;
}

struct RobotRecord {
  std::string name;
  std::vector<std::string> links;
  std::vector<Joint> joints;
};
template <class A>
void fields(A& a, Mimic& m) {
  a("joint", m.master);
  a.unless(1.0, "multiplier", m.multiplier);
  a.unless(0.0, "offset", m.offset);
}
template <class A>
void fields(A& a, Joint& j) {
  a("name", j.name);
  a("type", j.type);
  a("parent", j.parent);
  a("child", j.child);
  a("origin", j.origin);
  a("axis", j.axis);
  a.unless(0.0, "lower", j.lower);
  a.unless(0.0, "upper", j.upper);
  a.unless(false, "mimics", j.mimics);
  if (j.mimics) a("mimic", j.mimic);
}
template <class A>
void fields(A& a, RobotRecord& r) {
  a("name", r.name);
  a("links", r.links);
  a("joints", r.joints);
}
/// @throws std::invalid_argument as KinematicTree::addLink() and addJoints().
inline KinematicTree treeOf(const RobotRecord& robot) {
  KinematicTree tree(robot.name);
  for (const std::string& link : robot.links) tree.addLink(link);
  tree.addJoints(robot.joints);
  return tree;
}

/// A geometry as FCL has it.
struct GeometryRecord {
  Shape shape = Shape::box;
  /// A box has its sides. A sphere has its radius, an ellipsoid has three. Capsule, cylinder and cone have radius and
  /// length, halfspace and plane n and d. A triangle has its corners.
  std::vector<double> sizes;
  bool solid = false;                   ///< of a mesh
  std::vector<Eigen::Vector3d> points;  ///< of hulls, meshes and clouds
  std::vector<std::array<int, 3>> triangles;
  std::vector<double> radii;  ///< of a cloud: one, or one for each point
  double resolution = 0;      ///< of an OcTree
  /// An OcTree's cells from the root on, children in their order after their parent. An occupied cell is `#`, one with
  /// eight children is `+`, any other is `.`.
  std::string cells;
};
template <class A>
void fields(A& a, GeometryRecord& g) {
  a("shape", g.shape);
  const bool mesh = g.shape == Shape::mesh, cloud = g.shape == Shape::points, octree = g.shape == Shape::octree;
  const bool points = mesh || cloud || g.shape == Shape::convex;
  if (mesh) a("solid", g.solid);
  if (points) a("points", g.points);
  if (mesh) a("triangles", g.triangles);
  if (cloud) a("radii", g.radii);
  if (octree) a("resolution", g.resolution);
  if (octree) a("cells", g.cells);
  if (!points && !octree) a("sizes", g.sizes);
}

/// Geometry that a link carries, bound to it or attached.
struct CarriedRecord {
  std::string link;
  std::size_t geometry = 0;  ///< its number in the query
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();
  std::string attached;                  ///< its name as an obstacle; empty: it is bound
  std::vector<std::string> touch_links;  ///< of what is attached
};
template <class A>
void fields(A& a, CarriedRecord& c) {
  a("link", c.link);
  a("geometry", c.geometry);
  a("offset", c.offset);
  a.unless(std::string(), "attached", c.attached);
  a.unless(std::vector<std::string>(), "touch_links", c.touch_links);
}

struct ObstacleRecord {
  std::string name;
  std::size_t geometry = 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};
template <class A>
void fields(A& a, ObstacleRecord& o) {
  a("name", o.name);
  a("geometry", o.geometry);
  a("pose", o.pose);
}

/// A RigidTransform with its error.
struct TransformRecord {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double ulps = 0, length = 0;
};
template <class A>
void fields(A& a, TransformRecord& t) {
  a("pose", t.pose);
  a("ulps", t.ulps);
  a("length", t.length);
}
/// A MotionElement.
struct ElementRecord {
  TransformRecord before;
  MotionElement::Kind kind = MotionElement::Kind::slide;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Eigen::MatrixXd coefficients;
};
template <class A>
void fields(A& a, ElementRecord& e) {
  a("before", e.before);
  a("kind", e.kind);
  a("axis", e.axis);
  a("coefficients", e.coefficients);
}
/// An obstacle that moves, by its BodyMotion.
struct MovingRecord {
  std::string name;
  std::size_t geometry = 0;
  std::vector<ElementRecord> elements;
  TransformRecord after;
};
template <class A>
void fields(A& a, MovingRecord& m) {
  a("name", m.name);
  a("geometry", m.geometry);
  a("elements", m.elements);
  a("after", m.after);
}

using Names = std::array<std::string, 2>;
struct AllowedRecord {
  std::vector<Names> allowed, disallowed;
  bool complete = false;
};
template <class A>
void fields(A& a, AllowedRecord& p) {
  a("allowed", p.allowed);
  a("disallowed", p.disallowed);
  a("complete", p.complete);
}
/// A margin of a body, or of a pair of bodies.
struct MarginRecord {
  std::vector<std::string> of;
  double margin = 0;
};
template <class A>
void fields(A& a, MarginRecord& m) {
  a("of", m.of);
  a("margin", m.margin);
}
/// A tolerance that is not 0, or a joint's own; or the speed of an object, or the tolerance of time.
struct ToleranceRecord {
  enum class Of { joints, joint, base, object, speed, time };
  Of of = Of::joints;
  std::string name;  ///< of a joint or an object
  double angle = 0, length = 0;
  double speed = 0, since = 0;
  double time = 0;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< of a base or an object

  bool operator==(const ToleranceRecord& other) const {
    return of == other.of && name == other.name && angle == other.angle && length == other.length &&
           speed == other.speed && since == other.since && time == other.time && pivot == other.pivot;
  }
};
inline constexpr NamedValue<ToleranceRecord::Of> kToleranceKinds[] = {
    {ToleranceRecord::Of::joints, "joints"}, {ToleranceRecord::Of::joint, "joint"},
    {ToleranceRecord::Of::base, "base"},     {ToleranceRecord::Of::object, "object"},
    {ToleranceRecord::Of::speed, "speed"},   {ToleranceRecord::Of::time, "time"}};
constexpr const auto& namesOf(ToleranceRecord::Of) {
  return kToleranceKinds;
}
template <class A>
void fields(A& a, ToleranceRecord& t) {
  a("of", t.of);
  if (t.of == ToleranceRecord::Of::time) return a("time", t.time);
  const bool named = t.of != ToleranceRecord::Of::joints && t.of != ToleranceRecord::Of::base;
  if (named) a("name", t.name);
  if (t.of == ToleranceRecord::Of::speed) {
    a("speed", t.speed);
    a("since", t.since);
    return;
  }
  a("angle", t.angle);
  a("length", t.length);
  if (t.of == ToleranceRecord::Of::base || t.of == ToleranceRecord::Of::object) a("pivot", t.pivot);
}
/// Two links whose own geometries are proven apart for all values within the joints' limits.
struct ProofRecord {
  Names of;
  double margin = 0;
};
template <class A>
void fields(A& a, ProofRecord& p) {
  a("of", p.of);
  a("margin", p.margin);
}

/// A JointMotion: coefficients as its coefficients() returns them.
struct MotionRecord {
  Eigen::MatrixXd coefficients;
  std::vector<double> references;  ///< of tangents of half angles; empty: all variables are polynomials
};
template <class A>
void fields(A& a, MotionRecord& m) {
  a("coefficients", m.coefficients);
  a.unless(std::vector<double>(), "references", m.references);
}
/// A motion, or a trajectory of pieces.
struct QuestionRecord {
  std::vector<double> times;  ///< of a trajectory; empty: it is a motion
  std::vector<MotionRecord> pieces;
};
template <class A>
void fields(A& a, QuestionRecord& q) {
  a.unless(std::vector<double>(), "times", q.times);
  a("pieces", q.pieces);
}

template <class A>
void fields(A& a, RedonOptions& o) {
  a("enclosure", o.enclosure);
  a("refinement_level", o.refinement_level);
  a("simultaneous", o.simultaneous);
  a("newton", o.newton);
  a("early_validity", o.early_validity);
  a("in_time_order", o.in_time_order);
  a("links_in_world", o.links_in_world);
}
template <class A>
void fields(A& a, CertifiedRequest& request) {
  forEachRequestOption([&](const RequestOption& option, auto member) { a(option.name, request.*member); });
}

/// The whole file.
struct QueryRecord {
  int format = 1;
  std::string library, instruction_set;  ///< version, and what it ran on
  RobotRecord robot;
  std::vector<GeometryRecord> geometries;
  std::vector<CarriedRecord> carried;
  std::vector<MovingRecord> moving;
  std::vector<ObstacleRecord> obstacles;
  AllowedRecord pairs;
  std::vector<MarginRecord> margins;
  std::vector<ToleranceRecord> tolerances;
  std::vector<ProofRecord> proofs;
  QuestionRecord motion;
  CertifiedRequest request;
};
template <class A>
void fields(A& a, QueryRecord& q) {
  a("fcl_artic_query", q.format);
  a("library", q.library);
  a("instruction_set", q.instruction_set);
  a("robot", q.robot);
  a("geometries", q.geometries);
  a("carried", q.carried);
  a("moving", q.moving);
  a("obstacles", q.obstacles);
  a("pairs", q.pairs);
  a("margins", q.margins);
  a.unless(std::vector<ToleranceRecord>(), "tolerances", q.tolerances);
  a("proofs", q.proofs);
  a("motion", q.motion);
  a("request", q.request);
}

}  // namespace replay
}  // namespace fcl_artic
