// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fcl_artic/manager.h>
#include <moveit/collision_detection/collision_env.hpp>
#include <moveit/collision_detection/collision_matrix.hpp>

#include "fcl_artic_moveit/robot.h"

namespace fcl_artic_moveit {

/// The body in MoveIt that a body of the manager stands for.
struct BodyName {
  enum Kind { link, attached, object } kind = object;  ///< a link, an attached body, an object of the world
  std::string id;                                      ///< its name in MoveIt
};
/// As "link 'hand'".
std::ostream& operator<<(std::ostream& out, const BodyName& body);

/// How far the real robot and its scene may be from MoveIt's.
struct CellTolerances {
  fcl_artic::JointTolerance joints;   ///< of all joints of the model that turn, rad, and that slide, m
  std::map<std::string, double> own;  ///< of single joints, in place of that: rad, or m for one that slides
  fcl_artic::PoseTolerance base;      ///< of the robot, about the origin of the model's frame
  double objects = 0;                 ///< m, of each object of the world, octomap included
  /// m/s, by which each object of the world may move by itself while a trajectory with times lasts, octomap included:
  /// each of its cells then may.
  double object_speed = 0;
  std::map<std::string, double> object_speeds;  ///< of single objects, if they are there, in place of that

  /// Whether one of them is above 0.
  bool any() const;
};

/// A MoveIt robot and what surrounds it, as a manager.
///
/// The cell checks what MoveIt checks (PlanningScene::checkCollision()). `padding` is the distance that a link, and
/// each body that it carries, has to keep from the world:
/// - links with geometry against each other, neighbours too, without padding;
/// - attached bodies against links, except those that they may touch, without padding;
/// - attached bodies against each other, except on the same link or where one is among the other's touch links, without
///   padding;
/// - links and attached bodies against the objects of the world, octomap included, with the link's padding;
/// - but no pair of which neither body moves with the group, and none that the allowed collision matrix always allows,
///   by an entry or by defaults. A pair that it allows conditionally is checked.
///
/// A mimic joint that the group does not move stands where the state has it, also where its master would have it
/// elsewhere: MoveIt keeps what was measured.
///
/// update() takes over a scene. Bodies that are the same as before are kept, with all data that were computed from
/// them. A Cell whose update() threw is of no further use. One thread at a time may use a Cell.
class Cell {
 public:
  /// Shares ownership of the model.
  /// @throws std::invalid_argument as toTree().
  explicit Cell(moveit::core::RobotModelConstPtr model);

  /// Takes over the scene, and sets the manager up.
  /// @param env    its world and the links' padding.
  /// @param acm    pairs that may touch.
  /// @param state  of which the attached bodies count.
  /// @param group  whose joints move; null: all.
  /// @param tolerances  of the manager's answers from now on. They add no pair: two bodies of which neither moves with
  ///   the group stay unchecked.
  /// @throws std::invalid_argument naming link or object: another model, a link's scale that is not 1, a padding that
  ///   is negative or not finite, a shape that toFcl() refuses. Also for an unbounded shape (plane) on a link or in a
  ///   hand, and for geometry or a pose that ArticulatedCollisionManager refuses. Also for a tolerance of a joint that
  ///   is unknown, mimics another, or has several variables.
  void update(const collision_detection::CollisionEnv& env, const collision_detection::AllowedCollisionMatrix& acm,
              const moveit::core::RobotState& state, const moveit::core::JointModelGroup* group,
              const CellTolerances& tolerances = {});

  /// The model's tree, as of the last update().
  const RobotTree& robot() const { return robot_; }
  /// The manager, set up by update().
  const fcl_artic::ArticulatedCollisionManager& manager() const { return *manager_; }
  /// The same, to be kept until the next update().
  std::shared_ptr<const fcl_artic::ArticulatedCollisionManager> sharedManager() const { return manager_; }
  const moveit::core::RobotModelConstPtr& model() const { return model_; }
  /// The body in MoveIt that a body of an answer stands for.
  const BodyName& nameOf(const fcl_artic::BodyRef& body) const { return names_.at(body.name).first; }
  /// All bodies of the manager by their names there, with their padding, m.
  const std::map<std::string, std::pair<BodyName, double>>& names() const { return names_; }
  /// The distance that two bodies of an answer have to keep because of the links' padding, m.
  double paddingBetween(const fcl_artic::BodyRef& a, const fcl_artic::BodyRef& b) const;
  /// The tolerances of the last update(), for people; empty: none.
  const std::string& tolerances() const { return tolerances_text_; }
  /// How often the robot was read: 1 as long as nothing asked for another tree.
  int robotsRead() const { return robots_read_; }

 private:
  /// One shape of a body, as it is registered. A link has one entry for all of its shapes, unless they are apart.
  struct Body {
    std::string name;  ///< in the manager
    BodyName moveit;
    const moveit::core::LinkModel* link = nullptr;           ///< that carries it; null for an object
    const moveit::core::AttachedBody* attached = nullptr;    ///< null for a link and an object
    double padding = 0;                                      ///< of pairs with the world, m
    bool moves = false;                                      ///< with the group
    shapes::ShapeConstPtr shape;                             ///< null for a link
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the shape, in the world or in the link's frame
    std::string carrier;                                     ///< link of the tree; empty for an object
  };
  /// A body that is registered beside the links, by its name in the manager.
  struct Registered {
    shapes::ShapeConstPtr shape;
    Eigen::Isometry3d pose;
    std::string carrier;
    std::shared_ptr<fcl::CollisionObjectd> object;
  };

  void readRobot();
  std::vector<Body> linkBodies(const collision_detection::CollisionEnv& env,
                               const moveit::core::JointModelGroup* group) const;
  void addAttached(const collision_detection::CollisionEnv& env, const moveit::core::RobotState& state,
                   const moveit::core::JointModelGroup* group, std::vector<Body>& bodies);
  void addObjects(const collision_detection::World& world, std::vector<Body>& bodies);
  bool separate(const std::vector<Body>& bodies, const collision_detection::AllowedCollisionMatrix& acm);
  void registerBodies(const std::vector<Body>& bodies);
  void setPairs(const std::vector<Body>& bodies, const collision_detection::AllowedCollisionMatrix& acm);
  void setMargins(const std::vector<Body>& bodies);
  void setTolerances(const std::vector<Body>& bodies, const CellTolerances& tolerances);
  void requireChecked() const;
  std::string unused(const std::string& name);
  std::shared_ptr<fcl::CollisionGeometryd> geometryOf(const shapes::ShapeConstPtr& shape, const std::string& owner);

  moveit::core::RobotModelConstPtr model_;
  std::set<std::string> apart_;     ///< links whose shapes are attached to them, so that neighbours are checked
  std::set<std::string> mounts_;    ///< links that may not touch what they carry
  std::set<std::string> standing_;  ///< mimic joints that the group does not move
  RobotTree robot_;
  std::shared_ptr<fcl_artic::ArticulatedCollisionManager> manager_;
  int robots_read_ = 0;
  std::map<std::string, std::pair<BodyName, double>> names_;  ///< and the padding
  std::set<std::string> used_;                                ///< names in the manager
  std::map<std::string, Registered> registered_;
  std::map<const shapes::Shape*, std::pair<shapes::ShapeConstPtr, std::shared_ptr<fcl::CollisionGeometryd>>> geometry_;
  std::map<std::string, double> body_margins_;
  std::string tolerances_text_;
  /// Pairs of carried bodies that have to be checked. (The library judges pairs that no joint moves.)
  std::set<std::pair<std::string, std::string>> wanted_;
};

}  // namespace fcl_artic_moveit
