// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics.h"

#include <pybind11/stl.h>

#include <limits>

#include "enums.h"
#include "fcl_artic/in_between.h"
#include "fcl_artic/tool_line.h"
#include "recipe.h"
#include "text/counted.h"
#include "text/nearest_name.h"

namespace fcl_artic::python {
namespace {

py::list names(int count, const std::function<const std::string&(int)>& name) {
  py::list out;
  for (int i = 0; i < count; ++i) out.append(name(i));
  return out;
}

Joint makeJoint(JointType type, const std::string& name, const std::string& parent, const std::string& child,
                py::handle axis, py::handle origin, double lower, double upper, py::handle mimic) {
  Joint joint;
  joint.type = type;
  joint.name = name;
  joint.parent = parent;
  joint.child = child;
  if (!axis.is_none()) joint.axis = vector3Of(axis, "axis");
  joint.origin = poseOf(origin, "origin");
  joint.lower = lower;
  joint.upper = upper;
  if (!mimic.is_none()) {
    joint.mimics = true;
    joint.mimic = py::cast<Mimic>(mimic);
  }
  return joint;
}

py::tuple jointState(const Joint& j) {
  return py::make_tuple(memberOf(j.type), j.name, j.parent, j.child, arrayOf(Eigen::VectorXd(j.axis)),
                        arrayOf(j.origin), j.lower, j.upper, j.mimics ? py::cast(j.mimic) : py::none());
}

Joint jointOfState(const py::tuple& s) {
  return makeJoint(enumOf<JointType>(s[0], "type"), py::cast<std::string>(s[1]), py::cast<std::string>(s[2]),
                   py::cast<std::string>(s[3]), s[4], s[5], py::cast<double>(s[6]), py::cast<double>(s[7]), s[8]);
}

void bindJoint(py::module_& module) {
  py::class_<Mimic>(module, "Mimic", "How a joint follows another one: q = multiplier * q_master + offset.")
      .def(py::init([](std::string master, double multiplier, double offset) {
             return Mimic{std::move(master), multiplier, offset};
           }),
           py::arg("master"), py::arg("multiplier") = 1.0, py::arg("offset") = 0.0)
      .def_readwrite("master", &Mimic::master)
      .def_readwrite("multiplier", &Mimic::multiplier)
      .def_readwrite("offset", &Mimic::offset)
      .def("__repr__",
           [](const Mimic& m) {
             return py::str("Mimic({!r}, multiplier={}, offset={})").format(m.master, m.multiplier, m.offset);
           })
      .def(py::pickle([](const Mimic& m) { return py::make_tuple(m.master, m.multiplier, m.offset); },
                      [](const py::tuple& s) {
                        return Mimic{py::cast<std::string>(s[0]), py::cast<double>(s[1]), py::cast<double>(s[2])};
                      }));

  py::class_<Joint> joint(module, "Joint",
                          "One joint, as in URDF: it carries the child link, whose frame is the joint's at q = 0.");
  const auto withLimits = [&joint](const char* name, JointType type, const char* doc) {
    joint.def_static(
        name,
        [type](const std::string& n, const std::string& parent, const std::string& child, py::handle axis,
               py::handle origin, double lower, double upper,
               py::handle mimic) { return makeJoint(type, n, parent, child, axis, origin, lower, upper, mimic); },
        doc, py::arg("name"), py::arg("parent"), py::arg("child"), py::arg("axis"), py::arg("origin") = py::none(),
        py::arg("lower") = 0.0, py::arg("upper") = 0.0, py::arg("mimic") = py::none());
  };
  withLimits("revolute", JointType::revolute,
             "A joint that turns about `axis` by q rad, from `lower` to `upper`; both 0: without limits.");
  withLimits("prismatic", JointType::prismatic,
             "A joint that slides along `axis` by q m, from `lower` to `upper`; both 0: without limits.");
  joint.def_static(
      "continuous",
      [](const std::string& name, const std::string& parent, const std::string& child, py::handle axis,
         py::handle origin,
         py::handle mimic) { return makeJoint(JointType::continuous, name, parent, child, axis, origin, 0, 0, mimic); },
      "A joint that turns about `axis` without limits.", py::arg("name"), py::arg("parent"), py::arg("child"),
      py::arg("axis"), py::arg("origin") = py::none(), py::arg("mimic") = py::none());
  joint.def_static(
      "planar",
      [](const std::string& name, const std::string& parent, const std::string& child, py::handle normal,
         py::handle origin) {
        return makeJoint(JointType::planar, name, parent, child, normal, origin, 0, 0, py::none());
      },
      "A joint of x, y (m) and theta (rad) in the plane across `normal`.", py::arg("name"), py::arg("parent"),
      py::arg("child"), py::arg("normal"), py::arg("origin") = py::none());
  const auto withoutAxis = [&joint](const char* name, JointType type, const char* doc) {
    joint.def_static(
        name,
        [type](const std::string& n, const std::string& parent, const std::string& child, py::handle origin) {
          return makeJoint(type, n, parent, child, py::none(), origin, 0, 0, py::none());
        },
        doc, py::arg("name"), py::arg("parent"), py::arg("child"), py::arg("origin") = py::none());
  };
  withoutAxis("fixed", JointType::fixed, "A joint that does not move: the child stands at `origin`.");
  withoutAxis("spherical", JointType::spherical, "A joint that turns freely: a quaternion x, y, z, w.");
  withoutAxis("floating", JointType::floating, "A joint that moves freely: a position, then a quaternion x, y, z, w.");
  joint.def_readonly("name", &Joint::name)
      .def_property_readonly("type", [](const Joint& j) { return memberOf(j.type); })
      .def_readonly("parent", &Joint::parent)
      .def_readonly("child", &Joint::child)
      .def_property_readonly("origin", [](const Joint& j) { return arrayOf(j.origin); })
      .def_property_readonly("axis", [](const Joint& j) { return arrayOf(Eigen::VectorXd(j.axis)); })
      .def_readonly("lower", &Joint::lower)
      .def_readonly("upper", &Joint::upper)
      .def_property_readonly("has_limits", [](const Joint& j) { return hasLimits(j); })
      .def_property_readonly("mimic", [](const Joint& j) { return j.mimics ? py::cast(j.mimic) : py::none(); })
      .def("__repr__",
           [](const Joint& j) {
             return py::str("<Joint {!r}: {}, {!r} carries {!r}>")
                 .format(j.name, memberOf(j.type).attr("value"), j.parent, j.child);
           })
      .def(py::pickle(&jointState, &jointOfState));
}

py::tuple treeState(const Tree& t) {
  const KinematicTree& tree = *t.tree;
  py::list joints;
  for (JointId j = 0; j < tree.numJoints(); ++j) joints.append(tree.joint(j));
  return py::make_tuple(tree.name(),
                        names(
                            tree.numLinks(), [&](int i) -> auto& { return tree.linkName(i); }),
                        joints, t.own == nullptr);
}

Tree treeOfState(const py::tuple& s) {
  Tree tree = treeInBuilding(py::cast<std::string>(s[0]));
  for (const py::handle link : py::list(s[1])) tree.own->addLink(py::cast<std::string>(link));
  std::vector<Joint> joints;
  for (const py::handle joint : py::list(s[2])) joints.push_back(py::cast<const Joint&>(joint));
  tree.own->addJoints(joints);
  if (py::cast<bool>(s[3])) tree.own = nullptr;
  return tree;
}

KinematicTree& growing(Tree& t) {
  if (!t.own) {
    valueError("the tree of '" + t.tree->name() +
               "' belongs to a robot and does not change; build a KinematicTree, then make a Robot of it");
  }
  return *t.own;
}

RowMajor limitsOf(const KinematicTree& tree) {
  RowMajor limits(tree.dof(), 2);
  limits.col(0).setConstant(-std::numeric_limits<double>::infinity());
  limits.col(1).setConstant(std::numeric_limits<double>::infinity());
  for (int v = 0; v < tree.dof(); ++v) {
    const Joint& joint = tree.joint(tree.variableJoint(v));
    if (!hasLimits(joint)) continue;
    limits(v, 0) = joint.lower;
    limits(v, 1) = joint.upper;
  }
  return limits;
}

void bindTree(py::module_& module) {
  py::class_<Tree>(module, "KinematicTree", "A forest of links carried by joints: one robot or several.")
      .def(py::init(&treeInBuilding), py::arg("name") = "robot")
      .def(
          "add_link", [](Tree& t, const std::string& name) { return growing(t).addLink(name); },
          "Adds a link, which is a root until a joint carries it.", py::arg("name"))
      .def(
          "add_joint", [](Tree& t, const Joint& joint) { return growing(t).addJoint(joint); },
          "Adds a joint between two links that were added before.", py::arg("joint"))
      .def_property_readonly("name", [](const Tree& t) { return t.tree->name(); })
      .def_property_readonly("dof", [](const Tree& t) { return t.tree->dof(); })
      .def_property_readonly("links",
                             [](const Tree& t) {
                               return names(
                                   t.tree->numLinks(), [&](int i) -> auto& { return t.tree->linkName(i); });
                             })
      .def_property_readonly("joints",
                             [](const Tree& t) {
                               py::list joints;
                               for (JointId j = 0; j < t.tree->numJoints(); ++j) joints.append(t.tree->joint(j));
                               return joints;
                             })
      .def_property_readonly("variables",
                             [](const Tree& t) {
                               return names(
                                   t.tree->dof(), [&](int v) -> auto& { return t.tree->variableName(v); });
                             })
      .def_property_readonly("limits", [](const Tree& t) { return arrayOfRows(limitsOf(*t.tree)); })
      .def_property_readonly("neutral", [](const Tree& t) { return arrayOf(t.tree->neutralConfiguration()); })
      .def(
          "joint", [](const Tree& t, const std::string& name) { return named([&] { return t.tree->joint(name); }); },
          "The joint of this name.", py::arg("name"))
      .def(
          "parent",
          [](const Tree& t, py::handle link) -> py::object {
            const LinkId parent = t.tree->parentLink(linkOf(*t.tree, link));
            return parent < 0 ? py::object(py::none()) : py::str(t.tree->linkName(parent));
          },
          "Name of a link's parent; None of a root.", py::arg("link"))
      .def(
          "is_angle", [](const Tree& t, int variable) { return t.tree->isAngle(variable); },
          "Whether a joint variable, by its index, is an angle.", py::arg("variable"))
      .def(
          "joint_value",
          [](const Tree& t, const std::string& joint, py::handle q) {
            return named([&] { return t.tree->jointValue(t.tree->jointId(joint), vectorOf(q, "q")); });
          },
          "Value of a joint of at most one variable, with mimic applied.", py::arg("joint"), py::arg("q"))
      .def(
          "joint_pose",
          [](const Tree& t, const std::string& joint, py::handle q) {
            return arrayOf(named([&] { return t.tree->jointPose(t.tree->jointId(joint), vectorOf(q, "q")); }));
          },
          "Pose (4, 4) of the child link in the joint's frame.", py::arg("joint"), py::arg("q"))
      .def(
          "forward_kinematics",
          [](const Tree& t, py::handle q) {
            std::vector<Eigen::Isometry3d> M_0;
            t.tree->forwardKinematics(vectorOf(q, "q"), M_0);
            return arrayOf(M_0);
          },
          "Poses (L, 4, 4) of all links in the world, in the order of `links`.", py::arg("q"))
      .def(
          "link_pose",
          [](const Tree& t, py::handle link, py::handle q) {
            return arrayOf(t.tree->linkPose(linkOf(*t.tree, link), vectorOf(q, "q")));
          },
          "Pose (4, 4) of one link in the world.", py::arg("link"), py::arg("q"))
      .def(
          "limit_notes", [](const Tree& t, py::handle q) { return t.tree->limitNotes(vectorOf(q, "q")); },
          "One line of text for each variable beyond its joint's limits.", py::arg("q"))
      .def("__repr__",
           [](const Tree& t) {
             return py::str("<KinematicTree {!r}: {}, {}>")
                 .format(t.tree->name(), text::counted(t.tree->numLinks(), "link"),
                         text::counted(t.tree->dof(), "variable"));
           })
      .def(py::pickle(&treeState, &treeOfState))
      .def(
          "__deepcopy__",  // a robot's tree does not change
          [](const Tree& t, py::handle) { return t.own ? treeOfState(treeState(t)) : t; }, py::arg("memo"));
}

/// The tree alone of an object that has one: a recipe needs no geometry.
py::object treeAlone(py::handle value) {
  return py::cast(treeOfRobot(treeOf(value)));
}

Eigen::VectorXd optionalVector(py::handle value, const char* what) {
  return value.is_none() ? Eigen::VectorXd() : vectorOf(value, what);
}

void bindMotion(py::module_& module) {
  // Python sees the library's own motions, which have no recipe, nowhere.
  py::class_<JointMotion>(module, "_JointMotion");
  py::class_<MadeMotion, JointMotion> motion(module, "JointMotion",
                                             "A motion in joint space over t in [0, 1]: each variable is a polynomial "
                                             "of t, or its angle's half has a tangent\n"
                                             "that is one.");
  const auto between = [&motion](const char* name, const char* doc, auto make) {
    motion.def_static(
        name,
        [name, make](py::handle tree, py::handle q0, py::handle q1) {
          return MadeMotion(make(*treeOf(tree), vectorOf(q0, "q0"), vectorOf(q1, "q1")),
                            Recipe(name, py::make_tuple(treeAlone(tree), q0, q1)));
        },
        doc, py::arg("tree"), py::arg("q0"), py::arg("q1"));
  };
  between("linear", "Moves every variable straight from q0 to q1.", &JointMotion::linear);
  between("shortest", "As linear(), except that joints without limits take the shorter way round.",
          &JointMotion::shortest);
  motion
      .def_static(
          "still",
          [](py::handle tree, py::handle q) {
            return MadeMotion(JointMotion::still(*treeOf(tree), vectorOf(q, "q")),
                              Recipe("still", py::make_tuple(treeAlone(tree), q)));
          },
          "Stands still at q.", py::arg("tree"), py::arg("q"))
      .def_static(
          "polynomial",
          [](py::handle tree, py::handle coefficients) {
            const Matrix matrix = matrixOf(coefficients, "coefficients");
            return MadeMotion(JointMotion::polynomial(*treeOf(tree), matrix.rows()),
                              Recipe("polynomial", py::make_tuple(treeAlone(tree), coefficients)));
          },
          "Moves along polynomials up to the fifth degree: column k of the coefficients belongs to t**k.",
          py::arg("tree"), py::arg("coefficients"))
      .def_static(
          "tangent_half_angle",
          [](py::handle tree, py::handle q0, py::handle q1, py::handle reference) {
            return MadeMotion(JointMotion::tangentHalfAngle(*treeOf(tree), vectorOf(q0, "q0"), vectorOf(q1, "q1"),
                                                            optionalVector(reference, "reference")),
                              Recipe("tangent_half_angle", py::make_tuple(treeAlone(tree), q0, q1, reference)));
          },
          "Moves every angle so that tan((q - reference) / 2) goes straight, as planners in the tangent configuration\n"
          "space do; slides and quaternions as in linear(). `reference` is 0 unless it is given.",
          py::arg("tree"), py::arg("q0"), py::arg("q1"), py::arg("reference") = py::none())
      .def_static(
          "tangent_half_angle_polynomial",
          [](py::handle tree, py::handle coefficients, py::handle reference) {
            const Matrix matrix = matrixOf(coefficients, "coefficients");
            return MadeMotion(
                JointMotion::tangentHalfAnglePolynomial(*treeOf(tree), matrix.rows(),
                                                        optionalVector(reference, "reference")),
                Recipe("tangent_half_angle_polynomial", py::make_tuple(treeAlone(tree), coefficients, reference)));
          },
          "As polynomial(), but rows of angles hold the coefficients of tan((q - reference) / 2).", py::arg("tree"),
          py::arg("coefficients"), py::arg("reference") = py::none())
      .def_property_readonly("q0", [](const JointMotion& m) { return arrayOf(m.q0()); })
      .def_property_readonly("dq", [](const JointMotion& m) { return arrayOf(m.dq()); })
      .def_property_readonly("degree", &JointMotion::degree)
      .def_property_readonly("is_polynomial", &JointMotion::isPolynomial)
      .def_property_readonly("coefficients",
                             [](const JointMotion& m) { return arrayOfRows(RowMajor(m.coefficients())); })
      .def_property_readonly("references",
                             [](const JointMotion& m) {
                               return m.isPolynomial() ? py::object(py::none()) : py::object(arrayOf(m.references()));
                             })
      .def(
          "configuration", [](const JointMotion& m, double t) { return arrayOf(m.configuration(t)); },
          "The configuration at time t.", py::arg("t"))
      .def(
          "is_of", [](const JointMotion& m, py::handle tree) { return m.isOf(*treeOf(tree)); },
          "Whether the motion is of the tree's joint variables.", py::arg("tree"))
      .def("__len__", &JointMotion::size)
      .def("__repr__",
           [](const JointMotion& m) {
             return py::str("<JointMotion of {}, degree {}{}>")
                 .format(text::counted(m.size(), "variable"), m.degree(),
                         m.isPolynomial() ? "" : ", tangents of half angles");
           })
      .def("__reduce__", [](const py::object& self) { return py::cast<const MadeMotion&>(self).recipe.reduced(self); });

  module.def(
      "in_between_tree", [](py::handle tree) { return treeOfRobot(inBetweenTree(*treeOf(tree))); },
      "The tree on which in_between_motion() moves: each link floats in its parent's frame.", py::arg("tree"));
  module.def(
      "in_between_motion",
      [](py::handle tree, const py::iterable& begin, const py::iterable& end) {
        const py::list from(begin), to(end);
        const auto poses = [](const py::list& value, const char* what) {
          std::vector<Eigen::Isometry3d> out;
          for (const py::handle pose : value) out.push_back(poseOf(pose, what));
          return out;
        };
        return MadeMotion(inBetweenMotion(*treeOf(tree), poses(from, "begin"), poses(to, "end")),
                          Recipe("in_between_motion", py::make_tuple(treeAlone(tree), from, to), py::none()));
      },
      "The arbitrary in-between motion of Redon et al. (2004), Section 3, between two sets of link poses.",
      py::arg("tree"), py::arg("begin"), py::arg("end"));
}

void bindTrajectory(py::module_& module) {
  py::class_<JointTrajectory>(module, "_JointTrajectory");
  py::class_<MadeTrajectory, JointTrajectory>(module, "JointTrajectory",
                                              "A trajectory in joint space: motions one after the other, in a time of "
                                              "its own.")
      .def_static(
          "linear",
          [](py::handle tree, py::handle times, py::handle waypoints, bool unwrap) {
            return MadeTrajectory(
                trajectoryThrough(*treeOf(tree), waypoints, times, py::none(), py::none(), py::none(), unwrap),
                Recipe("linear", py::make_tuple(treeAlone(tree), times, waypoints, unwrap)));
          },
          "Goes straight from waypoint to waypoint.", py::arg("tree"), py::arg("times"), py::arg("waypoints"),
          py::arg("unwrap") = false)
      .def_static(
          "tangent_half_angle",
          [](py::handle tree, py::handle times, py::handle waypoints, py::handle reference) {
            const Eigen::VectorXd t = vectorOf(times, "times");
            return MadeTrajectory(
                JointTrajectory::tangentHalfAngle(*treeOf(tree), {t.begin(), t.end()},
                                                  vectorsOf(waypoints, "waypoints"),
                                                  optionalVector(reference, "reference")),
                Recipe("tangent_half_angle", py::make_tuple(treeAlone(tree), times, waypoints, reference)));
          },
          "From waypoint to waypoint as JointMotion.tangent_half_angle() goes.", py::arg("tree"), py::arg("times"),
          py::arg("waypoints"), py::arg("reference") = py::none())
      .def_static(
          "cubic",
          [](py::handle tree, py::handle times, py::handle waypoints, py::handle velocities, bool unwrap) {
            return MadeTrajectory(
                trajectoryThrough(*treeOf(tree), waypoints, times, velocities, py::none(), py::none(), unwrap),
                Recipe("cubic", py::make_tuple(treeAlone(tree), times, waypoints, velocities, unwrap)));
          },
          "Cubic pieces with given velocities at the waypoints.", py::arg("tree"), py::arg("times"),
          py::arg("waypoints"), py::arg("velocities"), py::arg("unwrap") = false)
      .def_static(
          "quintic",
          [](py::handle tree, py::handle times, py::handle waypoints, py::handle velocities, py::handle accelerations,
             bool unwrap) {
            return MadeTrajectory(
                trajectoryThrough(*treeOf(tree), waypoints, times, velocities, accelerations, py::none(), unwrap),
                Recipe("quintic",
                       py::make_tuple(treeAlone(tree), times, waypoints, velocities, accelerations, unwrap)));
          },
          "Quintic pieces with given velocities and accelerations at the waypoints.", py::arg("tree"), py::arg("times"),
          py::arg("waypoints"), py::arg("velocities"), py::arg("accelerations"), py::arg("unwrap") = false)
      .def_static(
          "parabolic_blends",
          [](py::handle tree, py::handle times, py::handle waypoints, double blend, bool unwrap) {
            return MadeTrajectory(
                trajectoryThrough(*treeOf(tree), waypoints, times, py::none(), py::none(), py::float_(blend), unwrap),
                Recipe("parabolic_blends", py::make_tuple(treeAlone(tree), times, waypoints, blend, unwrap)));
          },
          "Straight lines joined by parabolas over [t - blend, t + blend] around each inner waypoint.", py::arg("tree"),
          py::arg("times"), py::arg("waypoints"), py::arg("blend"), py::arg("unwrap") = false)
      .def_static(
          "bspline",
          [](py::handle tree, int degree, py::handle knots, py::handle control_points) {
            const Eigen::VectorXd k = vectorOf(knots, "knots");
            return MadeTrajectory(JointTrajectory::bspline(*treeOf(tree), degree, {k.begin(), k.end()},
                                                           vectorsOf(control_points, "control_points")),
                                  Recipe("bspline", py::make_tuple(treeAlone(tree), degree, knots, control_points)));
          },
          "Along a B-spline.", py::arg("tree"), py::arg("degree"), py::arg("knots"), py::arg("control_points"))
      .def_static(
          "piecewise",
          [](py::handle tree, py::handle times, const py::sequence& coefficients) {
            const Eigen::VectorXd t = vectorOf(times, "times");
            std::vector<Eigen::MatrixXd> pieces;
            for (const py::handle piece : coefficients) {
              const Matrix matrix = matrixOf(piece, "coefficients");
              pieces.emplace_back(matrix.rows());
            }
            return MadeTrajectory(JointTrajectory::piecewise(*treeOf(tree), {t.begin(), t.end()}, pieces),
                                  Recipe("piecewise", py::make_tuple(treeAlone(tree), times, coefficients)));
          },
          "Polynomials of t - times[k], one matrix of coefficients for each piece.", py::arg("tree"), py::arg("times"),
          py::arg("coefficients"))
      .def_property_readonly("begin_time", &JointTrajectory::beginTime)
      .def_property_readonly("end_time", &JointTrajectory::endTime)
      .def_property_readonly("times",
                             [](const JointTrajectory& t) {
                               return arrayOf(Eigen::Map<const Eigen::VectorXd>(
                                   t.times().data(), static_cast<Eigen::Index>(t.times().size())));
                             })
      .def(
          "configuration", [](const JointTrajectory& t, double time) { return arrayOf(t.configuration(time)); },
          "The configuration at a time, which is clamped to the trajectory's.", py::arg("t"))
      .def(
          "piece",
          [](const py::object& self, std::size_t k) {
            const auto& t = py::cast<const JointTrajectory&>(self);
            if (k >= t.numPieces())
              throw py::index_error("the trajectory has " + text::counted(t.numPieces(), "piece"));
            return MadeMotion(t.piece(k), Recipe("piece", py::make_tuple(k), self));
          },
          "Piece k as a motion over t in [0, 1].", py::arg("k"))
      .def("__len__", &JointTrajectory::numPieces)
      .def("__repr__",
           [](const JointTrajectory& t) {
             return py::str("<JointTrajectory of {} from {} to {}>")
                 .format(text::counted(t.numPieces(), "piece"), t.beginTime(), t.endTime());
           })
      .def("__reduce__",
           [](const py::object& self) { return py::cast<const MadeTrajectory&>(self).recipe.reduced(self); });
}

ToolDeviation toolDeviationOf(py::handle tree, py::handle motion, py::handle link, py::handle tool, py::handle via,
                              double tolerance_distance, double tolerance_angle, std::uint64_t work_budget) {
  const auto of = treeOf(tree);
  const LinkId id = linkOf(*of, link);
  ToolLineRequest request;
  request.tool = poseOf(tool, "tool");
  if (!via.is_none()) request.via = vector3Of(via, "via");
  request.tolerance_distance = tolerance_distance;
  request.tolerance_angle = tolerance_angle;
  request.work_budget = work_budget;
  if (py::isinstance<JointMotion>(motion)) return toolDeviation(*of, py::cast<const JointMotion&>(motion), id, request);
  if (py::isinstance<JointTrajectory>(motion)) {
    return toolDeviation(*of, py::cast<const JointTrajectory&>(motion), id, request);
  }
  typeError("motion is no JointMotion or JointTrajectory but " + typeName(motion));
}

void bindToolLine(py::module_& module) {
  using D = ToolDeviation;
  py::class_<D>(module, "ToolDeviation", "How far a tool leaves its straight line or its arc: proven brackets.")
      .def_readonly("distance_lower", &D::distance_lower)
      .def_readonly("distance_upper", &D::distance_upper)
      .def_readonly("distance_time", &D::distance_time)
      .def_readonly("angle_lower", &D::angle_lower)
      .def_readonly("angle_upper", &D::angle_upper)
      .def_readonly("angle_time", &D::angle_time)
      .def_readonly("length", &D::length)
      .def_readonly("within_tolerance", &D::within_tolerance)
      .def("certainly_keeps", &D::certainlyKeeps, "Whether the tool certainly keeps as near as that, m and rad.",
           py::arg("distance"), py::arg("angle"))
      .def("certainly_leaves", &D::certainlyLeaves, "Whether the tool is farther off at some time, m or rad.",
           py::arg("distance"), py::arg("angle"))
      .def("__repr__",
           [](const D& d) {
             return py::str("<ToolDeviation: at most {:.6g} m, {:.6g} rad>").format(d.distance_upper, d.angle_upper);
           })
      .def(py::pickle(
          [](const D& d) {
            return py::make_tuple(d.distance_lower, d.distance_upper, d.distance_time, d.angle_lower, d.angle_upper,
                                  d.angle_time, d.length, d.within_tolerance);
          },
          [](const py::tuple& s) {
            D d;
            d.distance_lower = py::cast<double>(s[0]);
            d.distance_upper = py::cast<double>(s[1]);
            d.distance_time = py::cast<double>(s[2]);
            d.angle_lower = py::cast<double>(s[3]);
            d.angle_upper = py::cast<double>(s[4]);
            d.angle_time = py::cast<double>(s[5]);
            d.length = py::cast<double>(s[6]);
            d.within_tolerance = py::cast<bool>(s[7]);
            return d;
          }));
  const ToolLineRequest usual;
  module.def(
      "tool_deviation", &toolDeviationOf,
      "How far a tool leaves the straight line between its poses at a motion's ends, proven: for welding along a\n"
      "line while joints go by splines. `tool` is its frame in the link's. With `via`, a point of the world in m, it "
      "is\n"
      "the arc of a circle through that point, and the tool's orientation is to turn along it. `work_budget`: poses\n"
      "that are looked at, at most; 0: no limit. Says nothing of contacts.",
      py::arg("tree"), py::arg("motion"), py::arg("link"), py::kw_only(), py::arg("tool") = py::none(),
      py::arg("via") = py::none(), py::arg("tolerance_distance") = usual.tolerance_distance,
      py::arg("tolerance_angle") = usual.tolerance_angle, py::arg("work_budget") = usual.work_budget);
}

}  // namespace

Tree treeInBuilding(std::string name) {
  const auto tree = std::make_shared<KinematicTree>(std::move(name));
  return {tree, tree};
}

std::shared_ptr<const KinematicTree> treeOf(py::handle value) {
  if (py::isinstance<Tree>(value)) return py::cast<const Tree&>(value).tree;
  const py::object tree = py::getattr(value, "tree", py::none());
  if (py::isinstance<Tree>(tree)) return py::cast<const Tree&>(tree).tree;
  typeError("tree is no KinematicTree, Robot or World but " + typeName(value));
}

std::shared_ptr<const KinematicTree> finishedTreeOf(py::handle value) {
  if (py::isinstance<Tree>(value)) {
    const Tree& tree = py::cast<const Tree&>(value);
    if (tree.own) return std::make_shared<const KinematicTree>(*tree.own);
  }
  return treeOf(value);
}

LinkId linkOf(const KinematicTree& tree, py::handle link) {
  if (PyLong_Check(link.ptr()) && !PyBool_Check(link.ptr())) {
    const auto index = py::cast<LinkId>(link);
    if (index < 0 || index >= tree.numLinks()) {
      throw py::index_error("robot '" + tree.name() + "' has no link " + std::to_string(index));
    }
    return index;
  }
  if (!py::isinstance<py::str>(link)) typeError("link is no name but " + typeName(link));
  return named([&] { return tree.linkId(py::cast<std::string>(link)); });
}

JointMotion linearMotion(const KinematicTree& tree, py::handle q0, py::handle q1) {
  return JointMotion::linear(tree, vectorOf(q0, "q0"), vectorOf(q1, "q1"));
}

JointTrajectory trajectoryThrough(const KinematicTree& tree, py::handle waypoints, py::handle times,
                                  py::handle velocities, py::handle accelerations, py::handle blend, bool unwrap) {
  using Unwrap = JointTrajectory::Unwrap;
  const std::vector<Eigen::VectorXd> points = vectorsOf(waypoints, "waypoints");
  std::vector<double> at(points.size());
  if (times.is_none()) {
    for (std::size_t k = 0; k < at.size(); ++k) at[k] = static_cast<double>(k);
  } else {
    const Eigen::VectorXd given = vectorOf(times, "times");
    at.assign(given.begin(), given.end());
  }
  const Unwrap turns = unwrap ? Unwrap::yes : Unwrap::no;
  if (!blend.is_none()) {
    if (!velocities.is_none() || !accelerations.is_none()) valueError("blend goes without velocities");
    return JointTrajectory::parabolicBlends(tree, at, points, numberOf(blend, "blend"), turns);
  }
  if (!accelerations.is_none()) {
    if (velocities.is_none()) valueError("accelerations need velocities");
    return JointTrajectory::quintic(tree, at, points, vectorsOf(velocities, "velocities"),
                                    vectorsOf(accelerations, "accelerations"), turns);
  }
  if (!velocities.is_none()) {
    return JointTrajectory::cubic(tree, at, points, vectorsOf(velocities, "velocities"), turns);
  }
  return JointTrajectory::linear(tree, at, points, turns);
}

void bindKinematics(py::module_& module) {
  bindJoint(module);
  bindTree(module);
  bindMotion(module);
  bindTrajectory(module);
  bindToolLine(module);
}

}  // namespace fcl_artic::python
