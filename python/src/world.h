// SPDX-License-Identifier: BSD-3-Clause
//
// A world: robots and obstacles, ready to be asked: an ArticulatedCollisionManager that owns all that it checks, each
// by its name.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fcl_artic/manager.h"
#include "fcl_artic/urdf/urdf.h"
#include "geometry.h"
#include "guarded.h"
#include "motion.h"
#include "options.h"

namespace fcl_artic::python {

/// A world. All members are to be called with the GIL held, but for names(), which a question may call too.
class World {
 public:
  /// A body that stands still, or that a link carries.
  struct Body {
    std::string name;
    std::shared_ptr<fcl::CollisionObjectd> object;
    Eigen::Isometry3d pose;  ///< the object's, which queries read without the GIL; not while a link carries it
    LinkId carrier = -1;     ///< -1: an obstacle
    Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();
    std::string shape_of = {};  ///< as Scene::Obstacle::shape_of
    std::vector<std::string> touch_links = {};
  };
  /// A body that moves by itself.
  struct MovingObstacle {
    std::string name;
    std::shared_ptr<fcl::ContinuousCollisionObjectd> object;
    Motion motion;
  };

  World(const Robot& robot, const Scene& scene);

  const Robot& robot() const { return robot_; }
  std::shared_ptr<const KinematicTree> tree() const { return robot_.tree; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<MovingObstacle>& movers() const { return movers_; }
  /// Names of links, then of all else, in the order of their registration.
  std::vector<std::string> names() const;
  AllowedCollisionMatrix allowed() const;

  /// Copies references to the geometries, so the scene may be destroyed, and its objects stay as they are.
  void addScene(const Scene& scene);
  /// Puts a scene in place of all obstacles that stand still and are not carried.
  void replaceScene(const Scene& scene);
  void add(const std::string& name, const Geometry& geometry, const Eigen::Isometry3d& pose);
  void addMoving(const std::string& name, const Geometry& geometry, const Motion& motion);
  /// If a member gets the name of an object with several shapes, it acts on all of them.
  void remove(const std::string& name);
  void move(const std::string& name, const Eigen::Isometry3d& pose);
  void attach(const std::string& name, LinkId link, const Eigen::Isometry3d& offset,
              const std::vector<std::string>& touch_links);
  void detach(const std::string& name, const std::optional<Eigen::Isometry3d>& pose);

  /// The manager. @see Guarded
  Guarded<ArticulatedCollisionManager>& manager() { return manager_; }
  const Guarded<ArticulatedCollisionManager>& manager() const { return manager_; }

  /// For Python's garbage collector: the functions of motions.
  int visit(visitproc visit, void* arg) const;

  /// Names of all bodies that a name stands for: of a whole object, its shapes; of other names themselves.
  std::vector<std::string> namesOf(const std::string& name) const;

 private:
  /// The bodies that a name stands for, the object's first shape first.
  std::vector<Body> find(const std::string& name) const;
  /// The body that has the object, which the manager has.
  Body& ofObject(const std::shared_ptr<fcl::CollisionObjectd>& object);
  [[noreturn]] void refuseName(const std::string& name) const;

  Robot robot_;
  Guarded<ArticulatedCollisionManager> manager_;
  // Written with the GIL held while the manager changes, so that to hold one of the two is enough to read them.
  std::vector<Body> bodies_;
  std::vector<MovingObstacle> movers_;
};

/// The motion of a question: straight from q0 to q1, a motion, or a trajectory.
using Question = std::variant<JointMotion, JointTrajectory>;
/// @param q1  None where `motion` is a motion or trajectory itself.
Question questionOf(const World& world, py::handle motion, py::handle q1);

/// Objects that move by themselves move for as long as a motion takes: from its begin to its end. So a motion needs
/// times of its own where the manager has such objects.
/// @param no_clock  why the question's times are none; empty: a trajectory has some.
/// @throws std::invalid_argument.
void requireClock(const ArticulatedCollisionManager& manager, const Question& question,
                  const std::string& no_clock = {});
/// Asks, and tells `progress` of the request and Ctrl-C meanwhile.
/// @param no_clock  as in requireClock().
CertifiedResult answer(const World& world, const Question& question, Request request, const std::string& no_clock = {});
/// @throws ValueError for a result of another question: its links stand elsewhere at t_lower, or are other links.
void requireAnswerOf(const World& world, const Question& question, const CertifiedResult& result);

void bindWorld(py::module_& module);
void bindGuard(py::module_& module);
void bindPlans(py::module_& module, py::class_<World>& world);
void bindBatch(py::module_& module, py::class_<World>& world);
void bindPicture(py::module_& module, py::class_<World>& world);
void bindReport(py::class_<World>& world);

}  // namespace fcl_artic::python
