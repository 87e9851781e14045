// SPDX-License-Identifier: BSD-3-Clause
//
// Rigid bodies that move freely: two of them, or many.
#include <pybind11/stl.h>

#include <map>
#include <mutex>
#include <sstream>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>

#include "collected.h"
#include "fcl_artic/bounded_motion.h"
#include "fcl_artic/continuous_collision.h"
#include "fcl_artic/continuous_manager.h"
#include "fcl_artic/fcl_link_motion.h"
#include "geometry.h"
#include "guarded.h"
#include "kinematics.h"
#include "motion.h"
#include "options.h"
#include "result.h"
#include "text/nearest_name.h"
#include "watch.h"

namespace fcl_artic::python {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// @param kind   also the name of Motion's member that makes it.
/// @param given  what that was called with.
template <class Kind, class... Arguments>
Motion makeMotion(const char* kind, const py::tuple& given, const Arguments&... arguments) {
  const auto twin = std::make_shared<const Kind>(arguments...);
  return {kind, std::make_shared<const Kind>(arguments...),
          [twin](double t) {
            twin->integrate(t);
            Isometry3d pose;
            twin->getCurrentTransform(pose);
            return pose;
          },
          Recipe(kind, given)};
}

Motion still(py::handle pose) {
  const Isometry3d at = poseOf(pose, "pose");
  return makeMotion<fcl::TranslationMotiond>("still", py::make_tuple(pose), at, at);
}

Motion translation(py::handle begin, py::handle displacement) {
  const Isometry3d from = poseOf(begin, "begin");
  Isometry3d to = from;
  to.translation() += vector3Of(displacement, "displacement");
  return makeMotion<fcl::TranslationMotiond>("translation", py::make_tuple(begin, displacement), from, to);
}

Motion linear(py::handle begin, py::handle end) {
  const Isometry3d from = poseOf(begin, "begin"), to = poseOf(end, "end");
  // The point that goes straight is given: FCL's constructor of two poses leaves it uninitialised.
  return makeMotion<fcl::InterpMotion<double>>("linear", py::make_tuple(begin, end), from.linear(), from.translation(),
                                               to.linear(), to.translation(), Vector3d(Vector3d::Zero()));
}

Motion screw(py::handle begin, py::handle end) {
  return makeMotion<fcl::ScrewMotion<double>>("screw", py::make_tuple(begin, end), poseOf(begin, "begin"),
                                              poseOf(end, "end"));
}

Motion spline(py::handle positions, py::handle rotations) {
  const Matrix T = matrixOf(positions, "positions", 3), R = matrixOf(rotations, "rotations", 3);
  if (T.array.shape(0) != 4 || R.array.shape(0) != 4) valueError("a spline has 4 positions and 4 rotation vectors");
  const auto row = [](const Matrix& m, int i) { return Vector3d(m.rows().row(i).transpose()); };
  return makeMotion<fcl::SplineMotion<double>>("spline", py::make_tuple(positions, rotations), row(T, 0), row(T, 1),
                                               row(T, 2), row(T, 3), row(R, 0), row(R, 1), row(R, 2), row(R, 3));
}

Motion ofLink(py::handle tree, py::handle motion, py::handle link, py::handle offset) {
  const auto of = treeOf(tree);
  if (!py::isinstance<JointMotion>(motion)) typeError("motion is no JointMotion but " + typeName(motion));
  const auto made = std::make_shared<const FclLinkMotion>(*of, py::cast<const JointMotion&>(motion), linkOf(*of, link),
                                                          poseOf(offset, "offset"));
  return {"of_link", made, [made](double t) { return made->pose(t); },
          Recipe("of_link", py::make_tuple(treeOfRobot(of), motion, link, offset))};
}

/// A motion of one's own. Python functions give its state and bounds, and must outlive it: Motion's recipe has them.
class OwnMotion : public fcl::MotionBased, public BoundedMotion {
 public:
  OwnMotion(py::handle state, py::handle bounds, bool derivatives)
      : state_(state), bounds_(bounds), derivatives_(derivatives) {}

  State state(double t) const override {
    const GilHeld held;
    const py::object answer = state_(t);
    if (answer.is_none()) typeError("state(t) returned None, not a pose");  // which is the identity elsewhere
    State s;
    if (!derivatives_ && !py::isinstance<py::tuple>(answer)) {
      s.pose = poseOf(answer, "state(t)");
      return s;
    }
    const auto items = sequenceOf(answer, "state(t)", 5);
    if (py::object(items[0]).is_none()) typeError("state(t) returned None for its pose");
    s.pose = poseOf(py::object(items[0]), "pose");
    s.velocity = vector3Of(py::object(items[1]), "velocity");
    s.acceleration = vector3Of(py::object(items[2]), "acceleration");
    s.angular_velocity = vector3Of(py::object(items[3]), "angular_velocity");
    s.angular_acceleration = vector3Of(py::object(items[4]), "angular_acceleration");
    return s;
  }
  Bounds bounds(double begin, double end) const override {
    const GilHeld held;
    const auto items = sequenceOf(bounds_(begin, end), "bounds(begin, end)", derivatives_ ? 6 : 2);
    const auto at = [&](std::size_t i) { return numberOf(py::object(items[i]), "bounds(begin, end)"); };
    Bounds b;
    b.speed = at(0);
    if (!derivatives_) {
      b.angular_speed = at(1);
      return b;
    }
    b.acceleration = at(1);
    b.jerk = at(2);
    b.angular_speed = at(3);
    b.angular_acceleration = at(4);
    b.angular_jerk = at(5);
    return b;
  }
  bool hasDerivatives() const override { return derivatives_; }

  // FCL's members: the library's queries do not call them.
  using fcl::MotionBased::getCurrentTransform;
  bool integrate(double) const override { return true; }
  void getCurrentTransform(fcl::Transform3d& pose) const override { pose = state(0).pose; }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return unbounded(); }
  double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return unbounded(); }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}

 private:
  static double unbounded() { return std::numeric_limits<double>::infinity(); }
  static py::sequence sequenceOf(const py::object& value, const char* what, std::size_t count) {
    if (!py::isinstance<py::sequence>(value) || py::len(value) != count) {
      typeError(std::string(what) + " returned no " + std::to_string(count) + " values but " + typeName(value));
    }
    return value;
  }
  const py::handle state_, bounds_;
  const bool derivatives_;
};

Motion bounded(const py::function& state, const py::function& bounds, bool derivatives) {
  const auto made = std::make_shared<const OwnMotion>(state, bounds, derivatives);
  return {"bounded", made, [made](double t) { return made->state(t).pose; },
          Recipe::ofFixed("bounded", py::make_tuple(state, bounds, derivatives))};
}

/// The request for two bodies. @throws py::type_error for an option that only worlds have.
Request readPairRequest(const py::kwargs& options) {
  for (const char* name : {"check_scene", "check_self", "visibility"}) {
    if (options.contains(name)) typeError(std::string("there is no option '") + name + "' for free bodies");
  }
  return readRequest(options);
}

CertifiedPairResult collidePair(py::handle a, py::handle motion_a, py::handle b, py::handle motion_b,
                                const py::kwargs& options) {
  const Geometry first = geometryOf(a, "geometry_a"), second = geometryOf(b, "geometry_b");
  const Motion moves_first = motionOf(motion_a, "motion_a"), moves_second = motionOf(motion_b, "motion_b");
  Request request = readPairRequest(options);
  Watch watch(std::move(request.progress));
  CertifiedPairRequest asked = request.request;
  asked.progress = [&watch](double t) { return watch.goOn(t); };
  CertifiedPairResult result;
  {
    const GilReleased released;
    const InLibrary within;
    continuousCollide(first.shape.get(), moves_first.motion.get(), second.shape.get(), moves_second.motion.get(), asked,
                      result);
  }
  watch.finish();
  return result;
}

/// The answer for many bodies, each by its name.
struct BodiesResult : Bracket {
  struct Pair {
    std::string name1, name2;
    CertifiedPairResult result;
  };
  std::vector<Pair> pairs;
  std::vector<std::pair<std::string, std::string>> ignored_initial_contacts;
  std::size_t never_apart_pairs = 0;
  std::string exceptions;  ///< exceptionsOf()
  QueryStatistics statistics;
};

/// Many bodies that move freely.
class Bodies {
 public:
  using Object = fcl::ContinuousCollisionObjectd;

  void add(const std::string& name, py::handle geometry, py::handle motion) {
    if (name.empty()) valueError("a body needs a name");
    if (bodies_.count(name)) valueError("there is a body '" + name + "' already");
    const Body body = make(geometryOf(geometry, "geometry"), motionOf(motion, "motion"));
    manager_.change(
        [&](ContinuousCollisionManager& manager) {
          // Another thread may have been first. (No thread writes the bodies now.)
          if (bodies_.count(name)) throw std::invalid_argument("there is a body '" + name + "' already");
          manager.registerObject(body.object.get());
        },
        [&] {
          order_.push_back(name);
          bodies_.emplace(name, body);
        });
  }
  void remove(const std::string& name) {
    const Body body = find(name);
    manager_.change([&](ContinuousCollisionManager& manager) { manager.unregisterObject(body.object.get()); },
                    [&] {
                      bodies_.erase(name);
                      order_.erase(std::find(order_.begin(), order_.end(), name));
                    });
  }
  /// Bodies are replaced: FCL's objects keep their motion for good.
  void setMotion(const std::string& name, py::handle motion) {
    const Body before = find(name), after = make(before.geometry, motionOf(motion, "motion"));
    manager_.change(
        [&](ContinuousCollisionManager& manager) {
          manager.registerObject(after.object.get());
          try {
            manager.unregisterObject(before.object.get());
          } catch (...) {  // another thread was first
            manager.unregisterObject(after.object.get());
            throw;
          }
        },
        [&] { bodies_[name] = after; });
  }
  const std::vector<std::string>& names() const { return order_; }
  /// For Python's garbage collector: the functions of motions.
  int visit(visitproc visit, void* arg) const {
    for (const auto& [name, body] : bodies_) {
      if (const int status = body.motion.visit(visit, arg)) return status;
    }
    return 0;
  }

  BodiesResult check(const py::kwargs& options) const {
    return answer(options, [&](const auto& request, auto& result, const auto& nameThem) {
      manager_.ask([&](const ContinuousCollisionManager& manager) {
        nameThem(*this);  // now that nothing changes
        manager.continuousCollide(request, result);
      });
    });
  }
  BodiesResult checkAgainst(const Bodies& other, const py::kwargs& options) const {
    return answer(options, [&](const auto& request, auto& result, const auto& nameThem) {
      manager_.askWith(other.manager_, [&](const auto& manager, const auto& theirs) {
        for (const Bodies* one : {this, &other}) nameThem(*one);
        manager.continuousCollide(&theirs, request, result);
      });
    });
  }
  std::pair<Doubles, Doubles> sweptBox(const std::string& name) const {
    const Body body = find(name);
    const fcl::AABBd box =
        manager_.ask([&](const ContinuousCollisionManager& manager) { return manager.sweptAABB(body.object.get()); });
    return {arrayOf(Eigen::VectorXd(box.min_)), arrayOf(Eigen::VectorXd(box.max_))};
  }

 private:
  struct Body {
    Geometry geometry;
    Motion motion;
    std::shared_ptr<Object> object;
  };
  static Body make(const Geometry& geometry, const Motion& motion) {
    return {geometry, motion,
            std::make_shared<Object>(geometry.shape, std::const_pointer_cast<fcl::MotionBased>(motion.motion))};
  }
  const Body& find(const std::string& name) const {
    const auto at = bodies_.find(name);
    if (at == bodies_.end()) valueError("there is no body '" + name + "'" + text::didYouMean(name, order_));
    return at->second;
  }
  template <class Ask>
  BodiesResult answer(const py::kwargs& options, const Ask& ask) const {
    const Request request = readPairRequest(options);
    if (!request.progress.is_none()) typeError("there is no progress to tell for many bodies");
    const CertifiedPairRequest asked = request.request;
    CertifiedPairsResult found;
    std::map<const Object*, std::string> name;
    const auto nameThem = [&](const Bodies& bodies) {
      for (const auto& [key, body] : bodies.bodies_) name[body.object.get()] = key;
    };
    ask(asked, found, nameThem);
    BodiesResult result;
    static_cast<Bracket&>(result) = found;
    result.never_apart_pairs = found.never_apart_pairs;
    result.exceptions = exceptionsOf(found);
    for (MovingPair& pair : found.pairs) {
      result.pairs.push_back({name[pair.object1], name[pair.object2], std::move(pair.result)});
    }
    for (const auto& [a, b] : found.ignored_initial_contacts) {
      result.ignored_initial_contacts.emplace_back(name[a], name[b]);
    }
    result.statistics = found.statistics;
    return result;
  }

  Guarded<ContinuousCollisionManager> manager_;
  // Written with the GIL held while the manager changes, so that to hold one of the two is enough to read them.
  std::vector<std::string> order_;
  std::map<std::string, Body> bodies_;
};

void bindRigidMotion(py::module_& module) {
  py::class_<Motion>(module, "Motion", collected<Motion>(), "How a rigid body moves in the world over t in [0, 1].")
      .def_static("still", &still, "Stands still at a pose.", py::arg("pose") = py::none())
      .def_static("translation", &translation, "Goes straight by a displacement, without turning.", py::arg("begin"),
                  py::arg("displacement"))
      .def_static("linear", &linear,
                  "From pose to pose: the origin goes straight while the body turns at constant speed the shorter way.",
                  py::arg("begin"), py::arg("end"))
      .def_static("screw", &screw, "From pose to pose: turns about an axis and slides along it.", py::arg("begin"),
                  py::arg("end"))
      .def_static("spline", &spline, "A cubic B-spline of 4 positions (4, 3) and 4 rotation vectors (4, 3), as FCL's.",
                  py::arg("positions"), py::arg("rotations"))
      .def_static("of_link", &ofLink,
                  "Moves as what is fixed to a link while the joints move at constant speed (JointMotion.linear()).",
                  py::arg("tree"), py::arg("motion"), py::arg("link"), py::arg("offset") = py::none())
      .def_static(
          "bounded", &bounded,
          "A motion of one's own. `state(t)` returns pose, velocity, acceleration, angular velocity and angular\n"
          "acceleration; `bounds(begin, end)` six numbers that these and the jerks do not exceed in between:\n"
          "speed, acceleration, jerk, and the same of the angle. Without `derivatives` state(t) is the pose, and\n"
          "the bounds are speed and angular speed. All answers rest on these bounds.",
          py::arg("state"), py::arg("bounds"), py::arg("derivatives") = true)
      .def_property_readonly("kind", [](const Motion& m) { return m.kind; })
      .def(
          "pose", [](const Motion& m, double t) { return arrayOf(m.pose(t)); },
          "Pose (4, 4) in the world at t, as rounded.", py::arg("t"))
      .def("__repr__", [](const Motion& m) { return std::string("<Motion: ") + m.kind + ">"; })
      .def("__reduce__", [](const py::object& self) { return py::cast<const Motion&>(self).recipe.reduced(self); });
}

}  // namespace

Motion motionOf(py::handle value, const char* what) {
  if (py::isinstance<Motion>(value)) return py::cast<Motion>(value);
  if (py::isinstance<py::array>(value)) return still(value);
  typeError(std::string(what) + " is no Motion, and no array with a pose to stand still at, but " + typeName(value));
}

void bindRigid(py::module_& module) {
  bindRigidMotion(module);
  module.def(
      "continuous_collide", &collidePair,
      "Finds the first contact of two geometries along two motions, or proves that there is none. In place of a\n"
      "motion a pose (4, 4) to stand still at is taken. Options are those of Request that are not about links.",
      py::arg("geometry_a"), py::arg("motion_a"), py::arg("geometry_b"), py::arg("motion_b"));

  py::class_<BodiesResult::Pair>(module, "BodyPair", "Two bodies that are not proven free, and their answer.")
      .def_readonly("name1", &BodiesResult::Pair::name1)
      .def_readonly("name2", &BodiesResult::Pair::name2)
      .def_readonly("result", &BodiesResult::Pair::result)
      .def("__repr__", [](const BodiesResult::Pair& p) {
        std::ostringstream out;
        out << "<BodyPair: " << p.name1 << " and " << p.name2 << ", " << static_cast<const Bracket&>(p.result) << ">";
        return out.str();
      });
  py::class_<BodiesResult> result(module, "BodiesResult", "The answer for many bodies that move freely.");
  bindBracket(result);
  result
      .def_property_readonly("pairs",
                             [](const BodiesResult& r) {
                               py::list pairs;
                               for (const auto& pair : r.pairs) pairs.append(pair);
                               return pairs;
                             })
      .def_readonly("ignored_initial_contacts", &BodiesResult::ignored_initial_contacts)
      .def_readonly("never_apart_pairs", &BodiesResult::never_apart_pairs)
      .def_property_readonly("statistics", [](const BodiesResult& r) { return statisticsOf(r.statistics); })
      .def("__repr__", [](const BodiesResult& r) {
        std::ostringstream out;
        out << "<BodiesResult: " << static_cast<const Bracket&>(r);
        if (!r.exceptions.empty()) out << ", " << r.exceptions;
        if (!r.pairs.empty()) out << ": " << r.pairs.front().name1 << " and " << r.pairs.front().name2;
        out << ">";
        return out.str();
      });
  py::class_<Bodies>(module, "Bodies", collected<Bodies>(),
                     "Many bodies that move freely, each with a name. Threads may share it.")
      .def(py::init<>())
      .def("add", &Bodies::add, "Adds a body with its motion, or a pose to stand still at.", py::arg("name"),
           py::arg("geometry"), py::arg("motion"))
      .def("remove", &Bodies::remove, "Removes a body.", py::arg("name"))
      .def("set_motion", &Bodies::setMotion, "Gives a body another motion.", py::arg("name"), py::arg("motion"))
      .def_property_readonly("names", &Bodies::names)
      .def("check", &Bodies::check, "Finds the first contact of all pairs, or proves that there is none.")
      .def("check_against", &Bodies::checkAgainst,
           "Finds the first contact of these bodies with other ones, or proves that there is none.", py::arg("other"))
      .def("swept_box", &Bodies::sweptBox, "Lower and upper corner of a box that is proven to hold the whole motion.",
           py::arg("name"))
      .def("__len__", [](const Bodies& b) { return b.names().size(); })
      .def("__contains__",
           [](const Bodies& b, const std::string& name) {
             return std::find(b.names().begin(), b.names().end(), name) != b.names().end();
           })
      .def("__repr__", [](const Bodies& b) { return "<Bodies: " + std::to_string(b.names().size()) + ">"; });
}

}  // namespace fcl_artic::python
