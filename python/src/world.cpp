// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "collected.h"
#include "enums.h"
#include "fcl_artic/visibility/offscreen.h"
#include "guard_files.h"
#include "link_pairs.h"
#include "options.h"
#include "replay/query_file.h"
#include "robot.h"
#include "text/counted.h"
#include "text/nearest_name.h"
#include "watch.h"

namespace fcl_artic::python {

World::World(const Robot& robot, const Scene& scene) : robot_(robot), manager_(robot.tree) {
  manager_.change([&](ArticulatedCollisionManager& manager) { robot_.addTo(manager); });
  addScene(scene);
}

std::vector<std::string> World::names() const {
  std::vector<std::string> names;
  for (LinkId l = 0; l < robot_.tree->numLinks(); ++l) names.push_back(robot_.tree->linkName(l));
  for (const Body& body : bodies_) names.push_back(body.name);
  for (const MovingObstacle& mover : movers_) names.push_back(mover.name);
  return names;
}

AllowedCollisionMatrix World::allowed() const {
  return manager_.look([](const ArticulatedCollisionManager& manager) { return manager.allowedCollisions(); });
}

static std::vector<World::Body> bodiesOf(const Scene& scene) {
  std::vector<World::Body> bodies;
  for (const Scene::Obstacle& o : scene.obstacles) {
    const Geometry geometry{std::const_pointer_cast<fcl::CollisionGeometryd>(o.object->collisionGeometry())};
    const Eigen::Isometry3d pose(o.object->getTransform());
    bodies.push_back({o.name, objectOf(geometry, pose), pose, -1, Eigen::Isometry3d::Identity(), o.shape_of, {}});
  }
  return bodies;
}

void World::addScene(const Scene& scene) {
  const std::vector<Body> added = bodiesOf(scene);
  manager_.change(
      [&](ArticulatedCollisionManager& manager) {
        std::size_t done = 0;
        try {
          for (; done < added.size(); ++done) manager.registerObject(added[done].object, added[done].name);
        } catch (...) {
          while (done > 0) manager.unregisterObject(added[--done].object);
          throw;
        }
      },
      [&] { bodies_.insert(bodies_.end(), added.begin(), added.end()); });
}

void World::replaceScene(const Scene& scene) {
  const std::vector<Body> added = bodiesOf(scene);
  std::vector<std::shared_ptr<const fcl::CollisionObjectd>> objects;
  std::vector<std::string> names;
  for (const Body& body : added) {
    objects.push_back(body.object);
    names.push_back(body.name);
  }
  manager_.changeAtOnce([&](ArticulatedCollisionManager& manager) { manager.replaceObstacles(objects, names); },
                        [&] {
                          const auto stands = [](const Body& body) { return body.carrier < 0; };
                          bodies_.erase(std::remove_if(bodies_.begin(), bodies_.end(), stands), bodies_.end());
                          bodies_.insert(bodies_.end(), added.begin(), added.end());
                        });
}

void World::add(const std::string& name, const Geometry& geometry, const Eigen::Isometry3d& pose) {
  if (name.empty()) valueError("an obstacle needs a name");
  const Body body{name, objectOf(geometry, pose), pose};
  manager_.change([&](ArticulatedCollisionManager& manager) { manager.registerObject(body.object, name); },
                  [&] { bodies_.push_back(body); });
}

void World::addMoving(const std::string& name, const Geometry& geometry, const Motion& motion) {
  if (name.empty()) valueError("an obstacle needs a name");
  const MovingObstacle mover{name,
                             std::make_shared<fcl::ContinuousCollisionObjectd>(
                                 geometry.shape, std::const_pointer_cast<fcl::MotionBased>(motion.motion)),
                             motion};
  manager_.change([&](ArticulatedCollisionManager& manager) { manager.registerObject(mover.object.get(), name); },
                  [&] { movers_.push_back(mover); });
}

void World::remove(const std::string& name) {
  const auto mover =
      std::find_if(movers_.begin(), movers_.end(), [&](const MovingObstacle& other) { return other.name == name; });
  if (mover != movers_.end()) {
    const auto object = mover->object;
    manager_.change([&](ArticulatedCollisionManager& manager) { manager.unregisterObject(object.get()); },
                    [&] {
                      movers_.erase(std::find_if(movers_.begin(), movers_.end(),
                                                 [&](const MovingObstacle& m) { return m.object == object; }));
                    });
    return;
  }
  const std::vector<Body> all = find(name);
  manager_.change(
      [&](ArticulatedCollisionManager& manager) {
        for (const Body& body : all) manager.unregisterObject(body.object);
      },
      [&] {
        for (const Body& body : all) {
          bodies_.erase(
              std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.object == body.object; }));
        }
      });
}

/// Does something for all shapes of an object, or for none.
/// @param undo  for one for which it was done.
template <class Do, class Undo>
static void forAll(const std::vector<World::Body>& all, const Do& act, const Undo& undo) {
  std::size_t done = 0;
  try {
    for (; done < all.size(); ++done) act(all[done]);
  } catch (...) {
    while (done > 0) undo(all[--done]);
    throw;
  }
}

/// Where a shape of an object goes, when the object's first one goes to `pose`.
static Eigen::Isometry3d poseWith(const World::Body& first, const World::Body& shape, const Eigen::Isometry3d& pose) {
  return &first == &shape ? pose : pose * first.pose.inverse() * shape.pose;
}

void World::move(const std::string& name, const Eigen::Isometry3d& pose) {
  const std::vector<Body> all = find(name);
  for (const Body& body : all) {
    if (body.carrier >= 0) valueError("'" + body.name + "' is carried by a link; detach it at a pose");
  }
  manager_.change(
      [&](ArticulatedCollisionManager& manager) {
        const auto place = [&](const Body& body, const Eigen::Isometry3d& at) {
          body.object->setTransform(at);
          manager.update(body.object);
        };
        forAll(
            all,
            [&](const Body& body) {
              try {
                place(body, poseWith(all[0], body, pose));
              } catch (...) {
                body.object->setTransform(body.pose);
                throw;
              }
            },
            [&](const Body& body) { place(body, body.pose); });
      },
      [&] {
        for (const Body& body : all) ofObject(body.object).pose = poseWith(all[0], body, pose);
      });
}

void World::attach(const std::string& name, LinkId link, const Eigen::Isometry3d& offset,
                   const std::vector<std::string>& touch_links) {
  const std::vector<Body> all = find(name);
  manager_.change(
      [&](ArticulatedCollisionManager& manager) {
        forAll(
            all,
            [&](const Body& body) { manager.attach(link, body.object, poseWith(all[0], body, offset), touch_links); },
            [&](const Body& body) { manager.detach(body.object); });
      },
      [&] {
        for (const Body& carried : all) {
          Body& body = ofObject(carried.object);
          body.carrier = link;
          body.offset = poseWith(all[0], carried, offset);
          body.touch_links = touch_links;
        }
      });
}

void World::detach(const std::string& name, const std::optional<Eigen::Isometry3d>& pose) {
  const std::vector<Body> all = find(name);
  const auto poseOf = [&](const Body& body) { return pose ? poseWith(all[0], body, *pose) : body.pose; };
  manager_.change(
      [&](ArticulatedCollisionManager& manager) {
        forAll(
            all,
            [&](const Body& body) {
              const Eigen::Isometry3d before(body.object->getTransform());
              body.object->setTransform(poseOf(body));
              try {
                manager.detach(body.object);
              } catch (...) {
                body.object->setTransform(before);
                throw;
              }
            },
            [&](const Body& body) {
              body.object->setTransform(body.pose);
              manager.attach(body.carrier, body.object, body.offset, body.touch_links);
            });
      },
      [&] {
        for (const Body& carried : all) {
          Body& body = ofObject(carried.object);
          body.carrier = -1;
          body.pose = poseOf(carried);
        }
      });
}

std::vector<World::Body> World::find(const std::string& name) const {
  std::vector<Body> all;
  for (const Body& body : bodies_) {
    if (body.name == name || body.shape_of == name) all.push_back(body);
  }
  if (all.empty()) refuseName(name);
  return all;
}

std::vector<std::string> World::namesOf(const std::string& name) const {
  std::vector<std::string> names;
  for (const Body& body : bodies_) {
    if (body.name == name || body.shape_of == name) names.push_back(body.name);
  }
  if (names.empty()) names.push_back(name);
  return names;
}

int World::visit(visitproc visit, void* arg) const {
  for (const MovingObstacle& mover : movers_) {
    if (const int status = mover.motion.recipe.visit(visit, arg)) return status;
  }
  return 0;
}

World::Body& World::ofObject(const std::shared_ptr<fcl::CollisionObjectd>& object) {
  return *std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& body) { return body.object == object; });
}

void World::refuseName(const std::string& name) const {
  std::vector<std::string> names;
  for (const Body& body : bodies_) names.push_back(body.name);
  for (const MovingObstacle& mover : movers_) {
    if (mover.name == name) valueError("'" + name + "' moves by itself");
    names.push_back(mover.name);
  }
  valueError("the world has no obstacle '" + name + "'" + text::didYouMean(name, names));
}

Question questionOf(const World& world, py::handle motion, py::handle q1) {
  if (!isMotion(motion)) {
    if (q1.is_none()) typeError("q1 is missing, or the first argument is no JointMotion or JointTrajectory");
    return linearMotion(*world.tree(), motion, q1);
  }
  if (!q1.is_none()) typeError("a motion and q1 are given; the motion has its end already");
  if (py::isinstance<JointMotion>(motion)) return py::cast<const JointMotion&>(motion);
  return py::cast<const JointTrajectory&>(motion);
}

/// Where a question's time begins, and how long it is.
static std::pair<double, double> timeOf(const Question& question) {
  const auto* trajectory = std::get_if<JointTrajectory>(&question);
  if (!trajectory) return {0, 1};
  return {trajectory->beginTime(), trajectory->endTime() - trajectory->beginTime()};
}

void requireAnswerOf(const World& world, const Question& question, const CertifiedResult& result) {
  const KinematicTree& tree = *world.tree();
  for (const CertifiedContact& c : result.contacts) {
    if (std::max(c.body1.link, c.body2.link) >= tree.numLinks()) valueError("result is of another robot");
  }
  if (result.isFree()) return;
  if (result.M_0_at_lower.empty()) valueError("result has no link poses: it was asked for with max_contacts=0");
  std::vector<Eigen::Isometry3d> M_0;
  std::visit([&](const auto& motion) { tree.forwardKinematics(motion.configuration(result.t_lower), M_0); }, question);
  if (M_0.size() != result.M_0_at_lower.size()) valueError("result is of another robot");
  for (std::size_t i = 0; i < M_0.size(); ++i) {
    if (!M_0[i].isApprox(result.M_0_at_lower[i], 1e-6)) {
      valueError("result is of another motion: at its t_lower link '" + tree.linkName(static_cast<LinkId>(i)) +
                 "' stands elsewhere on this one");
    }
  }
}

void requireClock(const ArticulatedCollisionManager& manager, const Question& question, const std::string& no_clock) {
  if (!manager.hasSpeeds()) return;
  if (!no_clock.empty()) throw std::invalid_argument(no_clock);
  if (std::holds_alternative<JointTrajectory>(question)) return;
  throw std::invalid_argument(
      "an object moves by itself (set_object_speed()), and nothing says how long this motion takes: ask about a "
      "trajectory with its times, as JointTrajectory.linear(robot, [0, 2], [q0, q1])");
}

CertifiedResult answer(const World& world, const Question& question, Request request, const std::string& no_clock) {
  Watch watch(std::move(request.progress));
  const auto [begin, length] = timeOf(question);
  const struct {
    double begin, length;
    Watch* watch;
  } clock{begin, length, &watch};
  request.request.progress = [&clock](double t) { return clock.watch->goOn((t - clock.begin) / clock.length); };
  CertifiedResult result;
  world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    requireClock(manager, question, no_clock);
    std::visit([&](const auto& motion) { manager.continuousCollide(motion, request.request, result); }, question);
  });
  watch.finish();
  return result;
}

namespace {

CertifiedResult check(const World& world, py::handle q0, py::handle q1, const py::kwargs& options) {
  return answer(world, questionOf(world, q0, q1), readRequest(options));
}

CertifiedResult checkTrajectory(const World& world, py::handle waypoints, py::handle times, py::handle velocities,
                                py::handle accelerations, py::handle blend, bool unwrap, const py::kwargs& options) {
  return answer(world, trajectoryThrough(*world.tree(), waypoints, times, velocities, accelerations, blend, unwrap),
                readRequest(options),
                times.is_none()
                    ? "an object moves by itself (set_object_speed()), and the waypoints have no times: give "
                      "check_trajectory() times"
                    : "");
}

bool isFree(const World& world, py::handle q0, py::handle q1, const py::kwargs& options) {
  Request request = readRequest(options);
  request.request.mode = ContactMode::any;
  request.request.max_contacts = 0;
  return answer(world, questionOf(world, q0, q1), std::move(request)).isFree();
}

CertifiedResult collide(const World& world, py::handle q, const py::kwargs& options) {
  Request request = readRequest(options);
  Watch watch(std::move(request.progress));
  request.request.progress = [&watch](double t) { return watch.goOn(t); };
  const Eigen::VectorXd at = vectorOf(q, "q");
  CertifiedResult result;
  world.manager().ask(
      [&](const ArticulatedCollisionManager& manager) { manager.collide(at, request.request, result); });
  watch.finish();
  return result;
}

py::tuple removeSelf(const World& world, py::handle points, py::handle q, py::handle padding, py::handle pose) {
  const PointArray seen = pointArrayOf(points, "points");
  const Eigen::VectorXd at = vectorOf(q, "q");
  const double within = numberOf(padding, "padding");
  const Eigen::Isometry3d frame = poseOf(pose, "pose");
  const std::vector<std::uint8_t> marks = world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    return manager.pointsOnSelf(seen.frame.points, at, within, frame);
  });
  py::array_t<bool> stay(seen.rows.shape(0));
  bool* const out = stay.mutable_data();
  std::fill_n(out, stay.size(), true);
  std::size_t removed = 0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (!marks[i]) continue;
    out[seen.frame.rows.empty() ? i : seen.frame.rows[i]] = false;
    ++removed;
  }
  return py::make_tuple(seen.rows[stay], removed);
}

void dump(const World& world, py::handle path, py::handle q0, py::handle q1, const py::kwargs& options) {
  const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
  const Request request = readRequest(options);
  const Question question = questionOf(world, q0, q1);
  const std::string text = world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    requireClock(manager, question);
    return std::visit([&](const auto& motion) { return manager.writeQuery(motion, request.request); }, question);
  });
  writeFiles({{file, text}});
}

CertifiedResult askAgain(py::handle path) {
  const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
  RecordedQuery query = guardFiles(file, [&] { return replay::readQueryFile(file); });
  Watch watch;
  query.request.progress = [&watch](double) { return watch.goOn(0); };
  CertifiedResult result = guardFiles(file, [&] { return query.ask(); });
  watch.finish();
  return result;
}

/// Asks a search.
/// @param read  its request's reader.
/// @param search  (manager, motion or trajectory, request)
template <class Read, class Search>
auto searchOn(const World& world, py::handle q0, py::handle q1, const py::kwargs& options, const Read& read,
              const Search& search) {
  py::object progress;
  auto request = read(options, progress);
  const Question question = questionOf(world, q0, q1);
  Watch watch(std::move(progress));
  request.progress = [&watch](double lower, double upper) {
    return watch.goOn(upper > 0 && std::isfinite(upper) ? lower / upper : 0);
  };
  const auto found = world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    requireClock(manager, question);
    return std::visit([&](const auto& motion) { return search(manager, motion, request); }, question);
  });
  watch.finish();
  return found;
}

Clearance clearance(const World& world, py::handle q0, py::handle q1, const py::kwargs& options) {
  return searchOn(
      world, q0, q1, options, readClearanceRequest,
      [](const auto& manager, const auto& motion, const auto& request) { return manager.clearance(motion, request); });
}

ToleranceLeft toleranceLeft(const World& world, py::handle q0, py::handle q1, const py::kwargs& options) {
  return searchOn(world, q0, q1, options, readToleranceLeftRequest,
                  [](const auto& manager, const auto& motion, const auto& request) {
                    return manager.toleranceLeft(motion, request);
                  });
}

std::shared_ptr<const VisibilityCuller> cullerOf(VisibilityExecutor executor, const VisibilityOptions& options) {
  if (executor == VisibilityExecutor::cpu) return std::make_shared<const VisibilityCuller>(options);
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  const bool egl = executor == VisibilityExecutor::egl;
  return makeOffscreenCuller(egl ? OffscreenBackend::egl : OffscreenBackend::osmesa, options);
#else
  valueError("this module was built without the component visibility: there is only the executor 'cpu'");
#endif
}

/// Changes a pair of names, each shape of an object with each.
template <class Change>
void forEachPair(World& world, const std::string& a, const std::string& b, const Change& change) {
  const std::vector<std::string> of_a = world.namesOf(a), of_b = world.namesOf(b);
  world.manager().change([&](ArticulatedCollisionManager& manager) {
    for (const std::string& x : of_a) {
      for (const std::string& y : of_b) change(manager, x, y);
    }
  });
}

template <class Kind>
py::list namesOf(const std::vector<Kind>& all, const std::function<bool(const Kind&)>& take) {
  py::list names;
  for (const Kind& one : all) {
    if (take(one)) names.append(one.name);
  }
  return names;
}

const Scene& sceneOf(py::handle scene) {
  return required<Scene>(scene, "scene", "Scene", "load_scene() reads one from a file");
}

std::unique_ptr<World> makeWorld(py::handle robot, py::handle scene) {
  const Robot& of = required<Robot>(robot, "robot", "Robot", "load_urdf() reads one from a file");
  return std::make_unique<World>(of, scene.is_none() ? Scene{} : sceneOf(scene));
}

void bindChanges(py::class_<World>& world) {
  world
      .def(
          "add",
          [](World& w, const std::string& name, py::handle geometry, py::handle pose) {
            w.add(name, geometryOf(geometry, "geometry"), poseOf(pose, "pose"));
          },
          "Adds an obstacle that stands still at a pose.", py::arg("name"), py::arg("geometry"),
          py::arg("pose") = py::none())
      .def(
          "add_scene", [](World& w, py::handle scene) { w.addScene(sceneOf(scene)); },
          "Adds all obstacles of a scene, or none if one is refused.", py::arg("scene"))
      .def(
          "replace_scene", [](World& w, py::handle scene) { w.replaceScene(sceneOf(scene)); },
          "Puts a scene in place of all obstacles that stand still, or changes nothing if one is refused. What links\n"
          "carry and what moves by itself stays, and so do allowed pairs and margins of names that the new scene has\n"
          "too. What was made of the robot is kept, so this takes microseconds where a new World takes milliseconds.",
          py::arg("scene"))
      .def(
          "add_moving",
          [](World& w, const std::string& name, py::handle geometry, const Motion& motion) {
            w.addMoving(name, geometryOf(geometry, "geometry"), motion);
          },
          "Adds an obstacle that moves while the robot does, over the same time.", py::arg("name"), py::arg("geometry"),
          py::arg("motion"))
      .def("remove", &World::remove,
           "Removes an obstacle, also one that a link carries, with its allowed pairs and margins: the next of its "
           "name has\n"
           "none.",
           py::arg("name"))
      .def(
          "move", [](World& w, const std::string& name, py::handle pose) { w.move(name, poseOf(pose, "pose")); },
          "Puts an obstacle at another pose.", py::arg("name"), py::arg("pose"))
      .def(
          "attach",
          [](World& w, const std::string& name, py::handle link, py::handle offset,
             const std::vector<std::string>& touch_links) {
            w.attach(name, linkOf(*w.tree(), link), poseOf(offset, "offset"), touch_links);
          },
          "Has a link carry an obstacle; `offset` is its pose in the link's frame. It may touch that link and\n"
          "`touch_links`, and is checked against all else.",
          py::arg("name"), py::arg("link"), py::arg("offset") = py::none(),
          py::arg("touch_links") = std::vector<std::string>())
      .def(
          "detach",
          [](World& w, const std::string& name, py::handle pose) {
            w.detach(name, pose.is_none() ? std::nullopt : std::optional(poseOf(pose, "pose")));
          },
          "Puts down what a link carries, at a pose in the world; None: where it was before attach().", py::arg("name"),
          py::arg("pose") = py::none())
      .def(
          "allow",
          [](World& w, const std::string& a, const std::string& b) {
            forEachPair(w, a, b, [](auto& m, const auto& x, const auto& y) { m.allow(x, y); });
          },
          "Lets a pair touch: it is not checked any more.", py::arg("a"), py::arg("b"))
      .def(
          "disallow",
          [](World& w, const std::string& a, const std::string& b) {
            forEachPair(w, a, b, [](auto& m, const auto& x, const auto& y) { m.disallow(x, y); });
          },
          "Has a pair checked again, also if the two are neighbours, or stand still against each other. An attached "
          "object may touch the link that carries it and its `touch_links` all the same.",
          py::arg("a"), py::arg("b"))
      .def_property(
          "allowed", [](const World& w) { return pairsOf(w.allowed()); },
          [](World& w, py::handle pairs) {
            const AllowedCollisionMatrix matrix = matrixOfPairs(pairs, "allowed", w.allowed());
            w.manager().change([&](ArticulatedCollisionManager& m) { m.setAllowedCollisions(matrix); });
          },
          "The pairs that may touch; neighbours that World leaves out (notes) are not among them.")
      .def(
          "set_margin",
          [](World& w, const std::string& body, py::handle second, py::handle margin) {
            const bool pair = !margin.is_none();
            const double m = numberOf(pair ? margin : second, "margin");
            const std::string other = pair ? py::cast<std::string>(second) : std::string();
            if (pair) {
              forEachPair(w, body, other,
                          [m](auto& manager, const auto& x, const auto& y) { manager.setMargin(x, y, m); });
            } else {
              const std::vector<std::string> names = w.namesOf(body);
              w.manager().change([&](ArticulatedCollisionManager& manager) {
                for (const std::string& name : names) manager.setMargin(name, m);
              });
            }
          },
          "set_margin(body, margin) sets a body's own margin, set_margin(a, b, margin) a pair's, in m.",
          py::arg("body"), py::arg("other_or_margin"), py::arg("margin") = py::none())
      .def(
          "reset_margins",
          [](World& w) { w.manager().change([](ArticulatedCollisionManager& m) { m.resetMargins(); }); },
          "Forgets all margins of bodies and pairs.")
      .def(
          "set_joint_tolerance",
          [](World& w, double angle, double length, const std::optional<std::string>& joint) {
            const JointTolerance tolerance{angle, length};
            w.manager().change([&](ArticulatedCollisionManager& m) {
              joint ? m.setJointTolerance(*joint, tolerance) : m.setJointTolerances(tolerance);
            });
          },
          "Sets how far all joints, or one, may be from what a motion says: those that turn by `angle` (rad), those "
          "that "
          "slide by `length` (m). Free holds for every path within the tolerances.",
          py::arg("angle") = 0.0, py::arg("length") = 0.0, py::kw_only(), py::arg("joint") = py::none())
      .def(
          "set_base_tolerance",
          [](World& w, double length, double angle, py::handle pivot) {
            const PoseTolerance tolerance{length, angle, vectorOf(pivot, "pivot").head<3>()};
            w.manager().change([&](ArticulatedCollisionManager& m) { m.setBaseTolerance(tolerance); });
          },
          "Sets how far the robot's base may be from its place: turned by at most `angle` (rad) about a point of the "
          "world, then moved by at most `length` (m).",
          py::arg("length") = 0.0, py::arg("angle") = 0.0, py::kw_only(), py::arg("pivot") = py::make_tuple(0, 0, 0))
      .def(
          "set_object_tolerance",
          [](World& w, const std::string& name, double length, double angle, py::handle pivot) {
            const PoseTolerance tolerance{length, angle, vectorOf(pivot, "pivot").head<3>()};
            const std::vector<std::string> names = w.namesOf(name);
            w.manager().change([&](ArticulatedCollisionManager& m) {
              for (const std::string& one : names) m.setObjectTolerance(one, tolerance);
            });
          },
          "Sets how far an obstacle or attached object may be from its pose: turned by at most `angle` (rad) about a "
          "point of its own frame, then moved by at most `length` (m).",
          py::arg("name"), py::arg("length") = 0.0, py::arg("angle") = 0.0, py::kw_only(),
          py::arg("pivot") = py::make_tuple(0, 0, 0))
      .def(
          "set_object_speed",
          [](World& w, const std::string& name, double speed, double since) {
            const std::vector<std::string> names = w.namesOf(name);
            w.manager().change([&](ArticulatedCollisionManager& m) {
              for (const std::string& one : names) m.setObjectSpeed(one, {speed, since});
            });
          },
          "Says how fast an obstacle or attached object may move by itself, in any direction, as a person does: free "
          "then\n"
          "holds wherever it goes. `speed`: m/s for a trajectory in seconds; `since`: from then on, after the "
          "trajectory's\n"
          "begin; negative: it was seen so long before. Motions without times are then refused; a single configuration "
          "takes\n"
          "1 s.",
          py::arg("name"), py::arg("speed"), py::arg("since") = 0.0)
      .def(
          "set_time_tolerance",
          [](World& w, double time) {
            w.manager().change([&](ArticulatedCollisionManager& m) { m.setTimeTolerance(time); });
          },
          "Sets how much earlier or later than the motion says the robot may be, against obstacles with a motion of "
          "their\n"
          "own (add_moving()): s for a trajectory in seconds; a motion without times takes 1.\n"
          "Objects with a speed have as much longer to move.",
          py::arg("time"))
      .def(
          "reset_tolerances",
          [](World& w) { w.manager().change([](ArticulatedCollisionManager& m) { m.resetTolerances(); }); },
          "Forgets the tolerances of joints, base, objects and time, and the objects' speeds.")
      .def_property_readonly(
          "tolerances",
          [](const World& w) {
            return w.manager().look([](const ArticulatedCollisionManager& m) { return m.describeTolerances(); });
          })
      .def(
          "set_proofs",
          [](World& w, const Proofs* proofs) {
            const auto use = proofs ? proofs->proofs : nullptr;
            w.manager().change([&](ArticulatedCollisionManager& m) { m.setLinkPairProofs(use); });
          },
          "Uses proofs of pairs of links that never touch (LinkPairReport.proofs); None: none.", py::arg("proofs"))
      .def(
          "set_visibility",
          [](World& w, py::handle executor, int resolution) {
            const auto culler = cullerOf(enumOf<VisibilityExecutor>(executor, "executor"), {resolution});
            w.manager().change([&](ArticulatedCollisionManager& m) { m.setVisibility(culler); });
          },
          "Selects who culls by visibility in queries that ask for it (Request.visibility). `resolution`: pixels along "
          "a side of each view.",
          py::arg("executor") = "cpu", py::kw_only(), py::arg("resolution") = 32)
      .def(
          "prepare_for",
          [](World& w, py::handle method) {
            const Method chosen = enumOf<Method>(method, "method");
            w.manager().change([&](ArticulatedCollisionManager& m) { m.prepareFor(chosen); });
          },
          "Has set-up compute beforehand what the first question by this method would.", py::arg("method"))
      .def(
          "setup", [](const World& w) { w.manager().ask([](const ArticulatedCollisionManager&) {}); },
          "Makes all changes effective now, and not at the next question.");
}

void bindQueries(py::class_<World>& world) {
  world
      .def("check", &check,
           "Finds the first contact on the straight way from q0 to q1 in joint space, or proves that there is none.\n"
           "In place of q0 and q1 a JointMotion or JointTrajectory is taken. Options are those of Request.",
           py::arg("q0"), py::arg("q1") = py::none())
      .def("check_trajectory", &checkTrajectory,
           "Finds the first contact on the way through waypoints (N, n), in the unit of `times`; without times, in\n"
           "numbers of waypoints. Straight from point to point, cubic with velocities, quintic with accelerations too.",
           py::arg("waypoints"), py::arg("times") = py::none(), py::kw_only(), py::arg("velocities") = py::none(),
           py::arg("accelerations") = py::none(), py::arg("blend") = py::none(), py::arg("unwrap") = false)
      .def("is_free", &isFree,
           "Whether the way is proven free: the fastest question. False also where that is not decided. What a free\n"
           "result does not speak of (Result.never_apart_pairs, Result.unproven_allowed_pairs) it does not say.",
           py::arg("q0"), py::arg("q1") = py::none())
      .def("collide", &collide,
           "Finds what touches at one configuration. (Obstacles that move do so all the same, over all of their time.)",
           py::arg("q"))
      .def("dump", &dump,
           "Writes the question that check(q0, q1) asks to a file, JSON with all that its answer depends on. replay()\n"
           "and the program's check --replay ask it again, with the same bits: a report of a surprising answer should\n"
           "have one.",
           py::arg("path"), py::arg("q0"), py::arg("q1") = py::none())
      .def(
          "clearance", &clearance,
          "The smallest distance of any checked pair on the whole way, proven from below and from above. With\n"
          "ignore_initial_contact=True, pairs that touch at its begin, or are within their margin (ignored_margin, or\n"
          "their own), are left out.",
          py::arg("q0"), py::arg("q1") = py::none())
      .def("tolerance_left", &toleranceLeft,
           "How many times all tolerances of the world together may be as large, so that the whole way is still free.\n"
           "With ignore_initial_contact=True, pairs that check() ignores are left out.",
           py::arg("q0"), py::arg("q1") = py::none())
      .def("remove_self", &removeSelf,
           "Drops points, as a sensor has seen them, that lie in or within `padding` of what links carry at q: the\n"
           "other rows, in their order, and how many were dropped. Rows that are not finite stay. `pose` is that of "
           "the\n"
           "points' frame. A mesh is its surface, unless it is a solid.",
           py::arg("points"), py::arg("q"), py::arg("padding") = 0.0, py::kw_only(), py::arg("pose") = py::none())
      .def(
          "checked_link_pairs",
          [](const World& w) { return w.manager().ask([](const auto& m) { return m.checkedLinkPairs(); }); },
          "The pairs of what links carry that are checked against each other.")
      .def(
          "classify_link_pairs",
          [](const World& w, py::handle only, double margin, std::uint64_t work, std::size_t samples, int threads,
             py::object progress) {
            return classifyWatched(only, margin, work, samples, threads, std::move(progress), [&](const auto& run) {
              w.manager().ask(
                  [&](const auto& m) { run([&](const LinkPairOptions& o) { return m.classifyLinkPairs(o); }); });
            });
          },
          "Finds out which pairs of links never touch, proven; which always do; which do sometimes.", py::kw_only(),
          py::arg("only") = py::none(), py::arg("margin") = 0.0, py::arg("work") = LinkPairOptions().work,
          py::arg("samples") = LinkPairOptions().samples, py::arg("threads") = 0, py::arg("progress") = py::none());
}

}  // namespace

void bindWorld(py::module_& module) {
  module.def("replay", &askAgain,
             "Asks the question of a file that World.dump() or the program's check --dump has written. The answer has\n"
             "the same bits as the first one, on a processor with the same instruction_set().",
             py::arg("path"));
  py::class_<World> world(
      module, "World", collected<World>(),
      "Robots and obstacles, ready to be asked. Threads may share it. The robot is copied: what is changed\n"
      "in it later does not reach the world.");
  world.def(py::init(&makeWorld), py::arg("robot"), py::arg("scene") = py::none())
      .def_property_readonly("robot", [](const World& w) { return w.robot(); })
      .def_property_readonly("tree", [](const World& w) { return treeOfRobot(w.tree()); })
      .def_property_readonly("dof", [](const World& w) { return w.tree()->dof(); })
      .def_property_readonly(
          "obstacles",
          [](const World& w) { return namesOf<World::Body>(w.bodies(), [](const auto& b) { return b.carrier < 0; }); })
      .def_property_readonly(
          "moving",
          [](const World& w) { return namesOf<World::MovingObstacle>(w.movers(), [](const auto&) { return true; }); })
      .def_property_readonly("attached",
                             [](const World& w) {
                               py::dict attached;
                               for (const World::Body& b : w.bodies()) {
                                 if (b.carrier >= 0) attached[py::str(b.name)] = w.tree()->linkName(b.carrier);
                               }
                               return attached;
                             })
      .def_property_readonly(
          "notes",
          [](const World& w) {
            return w.manager().look([](const ArticulatedCollisionManager& manager) { return manager.notes(); });
          },
          "What is unusual about robot and pairs, a list of texts: neighbours that are not checked, and why.")
      .def_property_readonly(
          "neighbours",
          [](const World& w) {
            return w.manager().look([](const ArticulatedCollisionManager& manager) { return manager.neighbours(); });
          },
          "What was found of neighbours that nobody allowed or disallowed, a list of LinkPairFinding.")
      .def_property_readonly("names", &World::names)
      .def(
          "pose",
          [](const World& w, const std::string& name) {
            for (const World::Body& b : w.bodies()) {
              if (b.name == name) return arrayOf(b.carrier < 0 ? b.pose : b.offset);
            }
            valueError("the world has no obstacle '" + name + "'" + text::didYouMean(name, w.names()));
          },
          "Pose (4, 4) of an obstacle in the world, or of what a link carries in the link's frame.", py::arg("name"))
      .def("__repr__", [](const World& w) {
        std::size_t carried = 0;
        for (const World::Body& b : w.bodies()) carried += b.carrier >= 0;
        return py::str("<World: robot {!r} with {}, {}, {} moving, {} attached>")
            .format(w.tree()->name(), text::counted(w.tree()->dof(), "variable"),
                    text::counted(w.bodies().size() - carried, "obstacle"), w.movers().size(), carried);
      });
  bindChanges(world);
  bindQueries(world);
  bindPlans(module, world);
  bindBatch(module, world);
  bindPicture(module, world);
  bindReport(world);
  bindGuard(module);
}

}  // namespace fcl_artic::python
