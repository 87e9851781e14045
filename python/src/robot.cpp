// SPDX-License-Identifier: BSD-3-Clause
#include "robot.h"

#include <pybind11/stl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "link_pairs.h"
#include "text/counted.h"

namespace fcl_artic::python {
namespace {

Robot loadRobot(py::handle urdf, py::handle srdf, py::handle packages, py::handle base, bool floating_base,
                bool virtual_joint, bool solid_meshes, bool collada_up_axis, bool import_meshes) {
  const Input file(urdf, "urdf");
  UrdfOptions options;
  options.packages = packagesOf(packages);
  options.solid_meshes = solid_meshes;
  options.collada_up_axis = collada_up_axis;
  options.import_meshes = import_meshes;
  options.base = poseOf(base, "base");
  options.floating_base = floating_base;
  if (virtual_joint) {
    if (srdf.is_none()) throw py::value_error("virtual_joint=True: no srdf is given that has one");
    const Input joint(srdf, "srdf");
    options.virtual_joint = joint.read([&] { return loadVirtualJoint(joint.path()); });
    if (!options.virtual_joint) {
      throw py::value_error("virtual_joint=True: the SRDF has no planar or floating virtual_joint");
    }
  }
  Robot robot = file.read([&] { return loadUrdf(file.path(), options); });
  if (!srdf.is_none()) {
    const Input pairs(srdf, "srdf");
    robot.allowed = pairs.read([&] { return loadSrdf(pairs.path(), *robot.tree, &robot.notes); });
  }
  return robot;
}

void addGeometry(Robot& robot, py::handle link, py::handle geometry, py::handle offset, const std::string& source) {
  LinkGeometry part;
  part.link = linkOf(*robot.tree, link);
  const Geometry shape = geometryOf(geometry, "geometry");
  part.offset = poseOf(offset, "offset");
  part.object = objectOf(shape, Eigen::Isometry3d::Identity());
  part.source = source.empty() ? std::string(py::str(geometryState(shape)[0])) : source;
  robot.geometry.push_back(std::move(part));
}

std::shared_ptr<fcl::CollisionGeometryd> shapeOf(const fcl::CollisionObjectd& object) {
  return std::const_pointer_cast<fcl::CollisionGeometryd>(object.collisionGeometry());
}

py::frozenset frozensetOf(const AllowedCollisionMatrix::Pairs& names) {
  py::set pairs;
  for (const auto& [a, b] : names) pairs.add(py::make_tuple(a, b));
  return py::frozenset(pairs);
}

/// Links, joints, shapes, allowed pairs: all that the files said. Meshes that links share are written once. Proofs of
/// pairs are left out: without them more pairs are checked.
py::tuple robotState(const Robot& robot) {
  std::vector<const fcl::CollisionGeometryd*> seen;
  py::list shapes, parts;
  for (const LinkGeometry& g : robot.geometry) {
    const fcl::CollisionGeometryd* shape = g.object->collisionGeometry().get();
    const auto at = std::find(seen.begin(), seen.end(), shape);
    if (at == seen.end()) shapes.append(geometryState({shapeOf(*g.object)}));
    const auto index = at - seen.begin();
    if (at == seen.end()) seen.push_back(shape);
    parts.append(py::make_tuple(g.link, arrayOf(g.offset), index, g.source));
  }
  return py::make_tuple(treeOfRobot(robot.tree), shapes, parts, pairsOf(robot.allowed), textsOf(robot.notes),
                        robot.allowed.complete(), frozensetOf(robot.allowed.disallowedPairs()));
}

Robot robotOfState(const py::tuple& s) {
  Robot robot;
  robot.tree = py::cast<const Tree&>(s[0]).tree;
  std::vector<Geometry> shapes;
  for (const py::handle shape : py::list(s[1])) {
    shapes.push_back(geometryOfState(py::reinterpret_borrow<py::tuple>(shape)));
  }
  for (const py::handle item : py::list(s[2])) {
    const auto part = py::reinterpret_borrow<py::tuple>(item);
    LinkGeometry g;
    g.link = py::cast<LinkId>(part[0]);
    g.offset = poseOf(part[1], "offset");
    g.object = objectOf(shapes.at(py::cast<std::size_t>(part[2])), Eigen::Isometry3d::Identity());
    g.source = py::cast<std::string>(part[3]);
    robot.geometry.push_back(std::move(g));
  }
  robot.allowed = matrixOfPairs(s[3], "allowed");
  robot.allowed.setComplete(py::cast<bool>(s[5]));
  const AllowedCollisionMatrix disallowed = matrixOfPairs(s[6], "disallowed");
  for (const auto& [a, b] : disallowed.pairs()) robot.allowed.disallow(a, b);
  robot.notes = py::cast<std::vector<std::string>>(s[4]);
  return robot;
}

Robot combine(const py::sequence& parts, const std::string& name) {
  std::vector<Robot> robots;
  robots.reserve(parts.size());
  std::vector<PlacedRobot> placed;
  for (const py::handle part : parts) {
    const auto tuple = py::reinterpret_borrow<py::object>(part);
    if (!py::isinstance<py::tuple>(tuple) || py::len(tuple) < 2 || py::len(tuple) > 3) {
      typeError("combine_robots() takes tuples (robot, prefix) or (robot, prefix, base)");
    }
    const auto items = py::cast<py::tuple>(tuple);
    robots.push_back(py::cast<Robot>(items[0]));
    placed.push_back({&robots.back(), py::cast<std::string>(items[1]),
                      items.size() == 3 ? poseOf(items[2], "base") : Eigen::Isometry3d::Identity()});
  }
  return combineRobots(placed, name);
}

}  // namespace

py::frozenset pairsOf(const AllowedCollisionMatrix& matrix) {
  return frozensetOf(matrix.pairs());
}

AllowedCollisionMatrix matrixOfPairs(py::handle value, const char* what, const AllowedCollisionMatrix& before) {
  AllowedCollisionMatrix matrix = matrixOfPairs(value, what);
  matrix.setComplete(before.complete());
  for (const auto& [a, b] : before.disallowedPairs()) {
    if (!matrix.allowed(a, b)) matrix.disallow(a, b);
  }
  return matrix;
}

AllowedCollisionMatrix matrixOfPairs(py::handle value, const char* what) {
  AllowedCollisionMatrix matrix;
  for (const py::handle item : py::iter(value)) {
    const bool pair = (py::isinstance<py::tuple>(item) || py::isinstance<py::list>(item)) && py::len(item) == 2;
    if (!pair) typeError(std::string(what) + " holds " + std::string(py::repr(item)) + ", which is no pair of names");
    const auto names = py::reinterpret_borrow<py::sequence>(item);
    if (!py::isinstance<py::str>(py::object(names[0])) || !py::isinstance<py::str>(py::object(names[1]))) {
      typeError(std::string(what) + " holds " + std::string(py::repr(item)) + ", which is no pair of names");
    }
    matrix.allow(py::cast<std::string>(py::object(names[0])), py::cast<std::string>(py::object(names[1])));
  }
  return matrix;
}

std::map<std::string, std::string> packagesOf(py::handle value) {
  std::map<std::string, std::string> packages;
  if (value.is_none()) return packages;
  if (!py::isinstance<py::dict>(value)) typeError("packages is no dict from name to folder but " + typeName(value));
  const py::object fspath = py::module_::import("os").attr("fspath");
  for (const auto& [name, folder] : py::reinterpret_borrow<py::dict>(value)) {
    packages[py::cast<std::string>(name)] = py::cast<std::string>(fspath(folder));
  }
  return packages;
}

Input::Input(py::handle value, const char* what) {
  const bool is_path = py::hasattr(value, "__fspath__");
  if (!py::isinstance<py::str>(value) && !is_path) {
    typeError(std::string(what) + " is neither a path nor text but " + typeName(value));
  }
  path_ = py::cast<std::string>(is_path ? value.attr("__fspath__")() : py::reinterpret_borrow<py::object>(value));
  const std::size_t first = path_.find_first_not_of(" \t\r\n");
  if (is_path || first == std::string::npos || path_[first] != '<') return;
  // The loaders read files: the text becomes one without a name, whose relative paths begin at the present folder.
  file_ = ::memfd_create(what, MFD_CLOEXEC);
  const std::string text = std::move(path_).substr(first);  // an XML declaration stands at the very begin
  std::size_t written = 0;
  while (file_ >= 0 && written < text.size()) {
    const ssize_t now = ::write(file_, text.data() + written, text.size() - written);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) break;
    written += static_cast<std::size_t>(now);
  }
  if (written < text.size()) {
    if (file_ >= 0) ::close(file_);
    PyErr_SetFromErrno(PyExc_OSError);
    throw py::error_already_set();
  }
  path_ = "/proc/self/fd/" + std::to_string(file_);
}

Input::~Input() {
  if (file_ >= 0) ::close(file_);
}

void bindRobot(py::module_& module) {
  py::class_<LinkGeometry>(module, "LinkGeometry", "A geometry of a robot's link.")
      .def_readonly("link", &LinkGeometry::link)
      .def_property_readonly("offset", [](const LinkGeometry& g) { return arrayOf(g.offset); })
      .def_property_readonly("geometry", [](const LinkGeometry& g) { return Geometry{shapeOf(*g.object)}; })
      .def_readonly("source", &LinkGeometry::source);

  py::class_<Robot>(module, "Robot", "A tree of links, and the geometry that they carry.")
      .def(py::init([](const Tree& tree) {
             Robot robot;
             robot.tree = std::make_shared<const KinematicTree>(*tree.tree);  // the caller's may grow
             return robot;
           }),
           py::arg("tree"))
      .def_property_readonly("tree", [](const Robot& r) { return treeOfRobot(r.tree); })
      .def_property_readonly("name", [](const Robot& r) { return r.tree->name(); })
      .def_property_readonly("dof", [](const Robot& r) { return r.tree->dof(); })
      .def_property_readonly("geometry", [](const Robot& r) { return py::cast(r.geometry); })
      .def_property(
          "allowed", [](const Robot& r) { return pairsOf(r.allowed); },
          [](Robot& r, py::handle pairs) { r.allowed = matrixOfPairs(pairs, "allowed", r.allowed); })
      .def_property(
          "allowed_complete", [](const Robot& r) { return r.allowed.complete(); },
          [](Robot& r, bool complete) { r.allowed.setComplete(complete); })
      .def_property(
          "proofs", [](const Robot& r) { return Proofs{r.proofs}; },
          [](Robot& r, const Proofs* proofs) { r.proofs = proofs ? proofs->proofs : nullptr; })
      .def_property_readonly("notes", [](const Robot& r) { return textsOf(r.notes); })
      .def("add_geometry", &addGeometry, "Gives a link a geometry; `offset` is its pose in the link's frame.",
           py::arg("link"), py::arg("geometry"), py::arg("offset") = py::none(), py::arg("source") = "")
      .def(
          "classify_link_pairs",
          [](const Robot& robot, py::handle only, double margin, std::uint64_t work, std::size_t samples, int threads,
             py::object progress) {
            // The library gets a copy: another thread may change the robot meanwhile.
            return classifyWatched(only, margin, work, samples, threads, std::move(progress), [robot](const auto& run) {
              const GilReleased released;
              const InLibrary within;
              run([&](const LinkPairOptions& o) { return generateAllowedCollisions(robot, o); });
            });
          },
          "Finds out which pairs of links never touch, proven; which always do; which do sometimes.", py::kw_only(),
          py::arg("only") = py::none(), py::arg("margin") = 0.0, py::arg("work") = LinkPairOptions().work,
          py::arg("samples") = LinkPairOptions().samples, py::arg("threads") = 0, py::arg("progress") = py::none())
      .def_property_readonly("reach", [](const Robot& r) { return reachUpper(*r.tree, r.geometry); })
      .def("__repr__",
           [](const Robot& r) {
             return py::str("<Robot {!r}: {}, {}, {}>")
                 .format(r.tree->name(), text::counted(r.tree->numLinks(), "link"),
                         text::counted(r.tree->dof(), "variable"),
                         text::counted(r.geometry.size(), "geometry", "geometries"));
           })
      .def(py::pickle(&robotState, &robotOfState));

  module.def("load_urdf", &loadRobot,
             "Reads a robot from a URDF file, or from text that begins with '<'; with an SRDF, its allowed pairs too.",
             py::arg("urdf"), py::arg("srdf") = py::none(), py::kw_only(), py::arg("packages") = py::none(),
             py::arg("base") = py::none(), py::arg("floating_base") = false, py::arg("virtual_joint") = false,
             py::arg("solid_meshes") = false, py::arg("collada_up_axis") = false, py::arg("import_meshes") = false);
  module.def("combine_robots", &combine,
             "Combines several robots into one, each a tuple (robot, prefix) or (robot, prefix, base).",
             py::arg("parts"), py::arg("name") = "robots");
  module.def(
      "load_srdf",
      [](py::handle srdf, py::handle tree) {
        const Input file(srdf, "srdf");
        const auto of = finishedTreeOf(tree);
        std::vector<std::string> notes;
        const AllowedCollisionMatrix pairs = file.read([&] { return loadSrdf(file.path(), *of, &notes); });
        warn(notes);
        return pairsOf(pairs);
      },
      "Reads the pairs of links that need no check from an SRDF file, as MoveIt does: for Robot.allowed. They are all\n"
      "that may touch: Robot.allowed_complete says so. What was passed over is a UserWarning.",
      py::arg("srdf"), py::arg("tree"));
  module.def(
      "read_srdf",
      [](py::handle srdf, py::handle tree) {
        const Input file(srdf, "srdf");
        const auto of = finishedTreeOf(tree);
        py::list pairs;
        std::vector<std::string> notes;
        const std::vector<SrdfPair> all = file.read([&] { return readSrdf(file.path(), *of, &notes); });
        warn(notes);
        for (const SrdfPair& p : all) {
          pairs.append(py::make_tuple(p.link1, p.link2, p.reason));
        }
        return pairs;
      },
      "Reads the same pairs as load_srdf(), each with the reason that the file gives.", py::arg("srdf"),
      py::arg("tree"));
}

}  // namespace fcl_artic::python
