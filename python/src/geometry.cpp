// SPDX-License-Identifier: BSD-3-Clause
#include "geometry.h"

#include <cmath>
#include <sstream>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <octomap/OcTree.h>

#include "fcl_artic/point_cloud.h"
#include "fcl_artic/solid_mesh.h"
#include "gil.h"
#include "hull.h"
#include "options.h"
#include "text/counted.h"

namespace fcl_artic::python {
namespace {

using Eigen::Vector3d;
using Faces = std::vector<Eigen::Matrix<std::size_t, 3, 1>>;

/// A length that must be positive and finite.
double lengthOf(py::handle value, const char* what) {
  const double length = numberOf(value, what);
  if (!(length > 0) || !std::isfinite(length)) {
    valueError(std::string(what) + " is " + std::string(py::str(py::float_(length))) + ", not a positive length");
  }
  return length;
}

std::vector<Vector3d> pointsOf(py::handle value, const char* what) {
  const Matrix matrix = matrixOf(value, what, 3);
  const Rows rows = matrix.rows();
  std::vector<Vector3d> points(static_cast<std::size_t>(rows.rows()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = rows.row(static_cast<Eigen::Index>(i)).transpose();
    if (!points[i].allFinite()) {
      valueError(std::string(what) + "[" + std::to_string(i) + "] has an entry that is not finite");
    }
  }
  return points;
}

RowMajor rowsOf(const Vector3d* points, std::size_t count) {
  RowMajor rows(static_cast<Eigen::Index>(count), 3);
  for (std::size_t i = 0; i < count; ++i) rows.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  return rows;
}

py::array_t<std::int64_t> arrayOfFaces(const fcl::Triangle* faces, std::size_t count) {
  py::array_t<std::int64_t> array({static_cast<py::ssize_t>(count), py::ssize_t{3}});
  std::int64_t* out = array.mutable_data();
  for (std::size_t f = 0; f < count; ++f) {
    for (int i = 0; i < 3; ++i) *out++ = static_cast<std::int64_t>(faces[f][static_cast<std::size_t>(i)]);
  }
  return array;
}

template <class Shape, class... Sizes>
Geometry makeShape(Sizes&&... sizes) {
  return {std::make_shared<Shape>(std::forward<Sizes>(sizes)...)};
}

Geometry box(py::handle size) {
  const Vector3d s = vector3Of(size, "size");
  if (!(s.array() > 0).all()) valueError("size has an entry that is not a positive length");
  return makeShape<fcl::Boxd>(s);
}
Geometry sphere(py::handle radius) {
  return makeShape<fcl::Sphered>(lengthOf(radius, "radius"));
}
Geometry ellipsoid(py::handle radii) {
  const Vector3d r = vector3Of(radii, "radii");
  if (!(r.array() > 0).all()) valueError("radii has an entry that is not a positive length");
  return makeShape<fcl::Ellipsoidd>(r);
}
template <class Shape>
Geometry round(py::handle radius, py::handle length) {
  return makeShape<Shape>(lengthOf(radius, "radius"), lengthOf(length, "length"));
}
template <class Shape>
Geometry unbounded(py::handle normal, py::handle offset) {
  const Vector3d n = vector3Of(normal, "normal");
  const double d = numberOf(offset, "offset");
  if (!(n.norm() > 1e-9)) valueError("normal is zero");
  if (!std::isfinite(d)) valueError("offset is not finite");
  // FCL divides both by the normal's length; the offset here is the distance from the origin.
  const Vector3d unit = n.normalized();
  return makeShape<Shape>(unit, d);
}
Geometry triangle(py::handle a, py::handle b, py::handle c) {
  return makeShape<fcl::TrianglePd>(vector3Of(a, "a"), vector3Of(b, "b"), vector3Of(c, "c"));
}

Geometry meshOf(const std::vector<Vector3d>& vertices, const Faces& faces, bool solid) {
  if (vertices.empty() || faces.empty()) valueError("the mesh has no triangle");
  const auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(faces.size());
  for (const auto& f : faces) triangles.emplace_back(f[0], f[1], f[2]);
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  model->addSubModel(vertices, triangles);
  model->endModel();
  if (solid) return {makeSolid(*model)};
  return {model};
}

Geometry mesh(py::handle vertices, py::handle faces, bool solid) {
  if (!faces.is_none()) {
    const std::vector<Vector3d> points = pointsOf(vertices, "vertices");
    return meshOf(points, facesOf(faces, points.size()), solid);
  }
  if (!py::hasattr(vertices, "vertices") || !py::hasattr(vertices, "faces")) {
    typeError("mesh() takes vertices and faces, or one object that has both, not one " + typeName(vertices));
  }
  return mesh(vertices.attr("vertices"), vertices.attr("faces"), solid);
}

Geometry convex(py::handle vertices, py::handle faces) {
  const auto points = std::make_shared<std::vector<Vector3d>>(pointsOf(vertices, "vertices"));
  if (points->empty()) valueError("vertices has no row");
  // Queries take the hull of the vertices; the faces are for pictures, and for FCL's own queries.
  const Faces triangles = faces.is_none() ? hullFaces(*points) : facesOf(faces, points->size());
  const auto code = std::make_shared<std::vector<int>>();
  for (const auto& f : triangles) {
    code->insert(code->end(), {3, static_cast<int>(f[0]), static_cast<int>(f[1]), static_cast<int>(f[2])});
  }
  return makeShape<fcl::Convexd>(points, static_cast<int>(triangles.size()), code);
}

Geometry octree(py::handle points, py::handle resolution) {
  const double size = lengthOf(resolution, "resolution");
  const Matrix matrix = matrixOf(points, "points", 3);
  const auto tree = std::make_shared<octomap::OcTree>(size);
  const Rows rows = matrix.rows();
  if (rows.rows() == 0) valueError("points has no row");
  octomap::OcTreeKey key;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double x = rows(i, 0), y = rows(i, 1), z = rows(i, 2);
    // octomap leaves out points that it cannot hold, and says so on the console only.
    const bool good = std::isfinite(x) && std::isfinite(y) && std::isfinite(z) &&
                      (rows.row(i).cwiseAbs().array() < 32767 * size).all() && tree->coordToKeyChecked(x, y, z, key);
    if (!good) {
      valueError("points[" + std::to_string(i) + "] is not finite or farther than 32767 times the resolution away");
    }
    tree->setNodeValue(key, tree->getClampingThresMaxLog(), true);
  }
  tree->updateInnerOccupancy();
  tree->prune();
  return makeShape<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
}

/// The layout of an array that can be read where it lies: rows without gaps, x, y and z of one type, which is the
/// machine's own float32 or float64.
bool layoutOf(const py::array& rows, FrameLayout& layout) {
  if (!(rows.flags() & py::array::c_style)) return false;
  const auto isPlain = [&](const py::dtype& type) {
    const bool is_double = type.equal(py::dtype::of<double>());
    layout.is_double = is_double;
    return is_double || type.equal(py::dtype::of<float>());
  };
  layout.stride = static_cast<std::size_t>(rows.itemsize()) * (rows.ndim() == 2 ? 3 : 1);
  if (rows.ndim() == 2) {
    layout.x = 0;
    layout.y = static_cast<std::size_t>(rows.itemsize());
    layout.z = 2 * layout.y;
    return isPlain(rows.dtype());
  }
  const py::dict fields = rows.dtype().attr("fields");
  std::size_t* const places[] = {&layout.x, &layout.y, &layout.z};
  py::object first;
  for (int k = 0; k < 3; ++k) {
    const py::tuple field = fields[py::str(std::string(1, "xyz"[k]))];
    if (k > 0 && !first.equal(field[0])) return false;
    first = field[0];
    *places[k] = py::cast<std::size_t>(field[1]);
  }
  return isPlain(py::dtype::from_args(first));
}

Geometry points(py::handle points, py::handle radius, py::handle voxel) {
  FramePoints frame = pointArrayOf(points, "points").frame;
  std::vector<double> radii;
  if (PySequence_Check(radius.ptr())) {
    const Eigen::VectorXd each = vectorOf(radius, "radius");
    radii.assign(each.data(), each.data() + each.size());
    if (radii.size() != frame.points.size() + frame.missing) {
      valueError("there are " + text::counted(frame.points.size() + frame.missing, "point") + " and " +
                 text::counted(radii.size(), "radius", "radii"));
    }
    if (frame.missing > 0) {
      for (std::size_t i = 0; i < frame.rows.size(); ++i) radii[i] = radii[frame.rows[i]];
      radii.resize(frame.rows.size());
    }
  } else {
    radii.push_back(lengthOf(radius, "radius"));
  }
  const double side = voxel.is_none() ? 0 : lengthOf(voxel, "voxel");
  if (frame.missing > 0) {
    if (frame.points.empty()) valueError("points has no row that is finite");
    // (The same text each time: Python shows it once for each place that it comes from.)
    std::vector<std::string> notes{
        "points() leaves out rows that are not finite, as of rays without an echo; Geometry.missing counts them"};
    if (frame.too_near > 0) {
      notes.push_back(
          "some of these rows are -inf, by which some cameras mean that something is too near to be measured: it is "
          "not "
          "in the scene");
    }
    warn(notes);
  }
  Geometry cloud;
  cloud.missing = frame.missing;
  const GilReleased released;
  const auto all = std::make_shared<PointCloud>(std::move(frame.points), std::move(radii));
  cloud.shape = side > 0 ? all->thinned(side) : all;
  return cloud;
}

/// OctoMap's readData() reads a node as its log-odds, then a bit for each of its eight children, then the children.
/// Probabilities are not kept, only which cells are occupied: FCL's thresholds can't be read to the last bit.
void writeNode(const fcl::OcTreed& tree, const octomap::OcTreeNode* node, std::ostream& out) {
  const float log_odds = tree.isNodeOccupied(node) ? 3.5f : -2.0f;
  out.write(reinterpret_cast<const char*>(&log_odds), sizeof log_odds);
  unsigned char children = 0;
  for (unsigned i = 0; i < 8; ++i) {
    if (tree.nodeChildExists(node, i)) children = static_cast<unsigned char>(children | 1u << i);
  }
  out.put(static_cast<char>(children));
  for (unsigned i = 0; i < 8; ++i) {
    if (children & 1u << i) writeNode(tree, tree.getNodeChild(node, i), out);
  }
}

py::tuple octreeState(const fcl::OcTreed& tree) {
  std::ostringstream out;
  if (tree.getRoot()) writeNode(tree, tree.getRoot(), out);
  const double resolution = tree.getRootBV().max_[0] / 32768;
  return py::make_tuple("octree", resolution, py::bytes(out.str()));
}

Geometry octreeOfState(double resolution, const std::string& data) {
  const auto tree = std::make_shared<octomap::OcTree>(resolution);
  std::istringstream in(data);
  if (!data.empty()) tree->readData(in);
  if (!in) valueError("the pickled octree is cut short");
  return makeShape<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
}

/// The mesh of a BVHModel; null for another geometry or kind of bounding volume.
const fcl::BVHModel<fcl::OBBRSSd>* asMesh(const fcl::CollisionGeometryd& g) {
  return g.getNodeType() == fcl::BV_OBBRSS ? static_cast<const fcl::BVHModel<fcl::OBBRSSd>*>(&g) : nullptr;
}

template <class Shape>
const Shape& as(const fcl::CollisionGeometryd& g) {
  return static_cast<const Shape&>(g);
}

}  // namespace

py::tuple geometryState(const Geometry& geometry) {
  const fcl::CollisionGeometryd& g = *geometry.shape;
  switch (g.getNodeType()) {
    case fcl::GEOM_BOX:
      return py::make_tuple("box", array3(as<fcl::Boxd>(g).side));
    case fcl::GEOM_SPHERE:
      return py::make_tuple("sphere", as<fcl::Sphered>(g).radius);
    case fcl::GEOM_ELLIPSOID:
      return py::make_tuple("ellipsoid", array3(as<fcl::Ellipsoidd>(g).radii));
    case fcl::GEOM_CAPSULE:
      return py::make_tuple("capsule", as<fcl::Capsuled>(g).radius, as<fcl::Capsuled>(g).lz);
    case fcl::GEOM_CYLINDER:
      return py::make_tuple("cylinder", as<fcl::Cylinderd>(g).radius, as<fcl::Cylinderd>(g).lz);
    case fcl::GEOM_CONE:
      return py::make_tuple("cone", as<fcl::Coned>(g).radius, as<fcl::Coned>(g).lz);
    case fcl::GEOM_HALFSPACE:
      return py::make_tuple("halfspace", array3(as<fcl::Halfspaced>(g).n), as<fcl::Halfspaced>(g).d);
    case fcl::GEOM_PLANE:
      return py::make_tuple("plane", array3(as<fcl::Planed>(g).n), as<fcl::Planed>(g).d);
    case fcl::GEOM_TRIANGLE: {
      const auto& t = as<fcl::TrianglePd>(g);
      return py::make_tuple("triangle", array3(t.a), array3(t.b), array3(t.c));
    }
    case fcl::GEOM_CONVEX: {
      const auto& vertices = as<fcl::Convexd>(g).getVertices();
      return py::make_tuple("convex", arrayOfRows(rowsOf(vertices.data(), vertices.size())));
    }
    case fcl::GEOM_OCTREE:
      return octreeState(as<fcl::OcTreed>(g));
    default:
      break;
  }
  if (const auto* cloud = dynamic_cast<const PointCloud*>(&g)) {
    const std::vector<double>& radii = cloud->radii();
    return py::make_tuple("points", arrayOfRows(rowsOf(cloud->points().data(), cloud->points().size())),
                          py::array_t<double>(static_cast<py::ssize_t>(radii.size()), radii.data()), geometry.missing);
  }
  const auto* model = asMesh(g);
  if (!model) valueError("this kind of geometry has no description");
  return py::make_tuple("mesh", arrayOfRows(rowsOf(model->vertices, static_cast<std::size_t>(model->num_vertices))),
                        arrayOfFaces(model->tri_indices, static_cast<std::size_t>(model->num_tris)),
                        dynamic_cast<const SolidMark*>(&g) != nullptr);
}

Geometry geometryOfState(const py::tuple& s) {
  const std::string kind = py::cast<std::string>(s[0]);
  if (kind == "box") return makeShape<fcl::Boxd>(vector3Of(s[1], "size"));
  if (kind == "sphere") return makeShape<fcl::Sphered>(py::cast<double>(s[1]));
  if (kind == "ellipsoid") return makeShape<fcl::Ellipsoidd>(vector3Of(s[1], "radii"));
  if (kind == "capsule") return makeShape<fcl::Capsuled>(py::cast<double>(s[1]), py::cast<double>(s[2]));
  if (kind == "cylinder") return makeShape<fcl::Cylinderd>(py::cast<double>(s[1]), py::cast<double>(s[2]));
  if (kind == "cone") return makeShape<fcl::Coned>(py::cast<double>(s[1]), py::cast<double>(s[2]));
  if (kind == "triangle") return triangle(s[1], s[2], s[3]);
  if (kind == "convex") return convex(s[1], py::none());
  if (kind == "mesh") return mesh(s[1], s[2], py::cast<bool>(s[3]));
  if (kind == "points") {
    const py::object radii = py::len(s[2]) == 1 ? py::object(s[2][py::int_(0)]) : py::object(s[2]);
    Geometry cloud = points(s[1], radii, py::none());
    if (s.size() > 3) cloud.missing = py::cast<std::size_t>(s[3]);
    return cloud;
  }
  if (kind == "octree") return octreeOfState(py::cast<double>(s[1]), py::cast<std::string>(s[2]));
  // The constructor is not used: it would divide by the normal's length, which is not 1 to the last bit.
  if (kind == "halfspace") {
    Geometry g = makeShape<fcl::Halfspaced>();
    static_cast<fcl::Halfspaced&>(*g.shape).n = vector3Of(s[1], "normal");
    static_cast<fcl::Halfspaced&>(*g.shape).d = py::cast<double>(s[2]);
    return g;
  }
  if (kind == "plane") {
    Geometry g = makeShape<fcl::Planed>();
    static_cast<fcl::Planed&>(*g.shape).n = vector3Of(s[1], "normal");
    static_cast<fcl::Planed&>(*g.shape).d = py::cast<double>(s[2]);
    return g;
  }
  valueError("there is no kind of geometry '" + kind + "'");
}

PointArray pointArrayOf(py::handle value, const char* what) {
  const py::module_ numpy = py::module_::import("numpy");
  const bool is_array =
      py::isinstance<py::array>(value) && !py::isinstance(value, numpy.attr("ma").attr("MaskedArray"));
  const py::object names = is_array ? py::object(value.attr("dtype").attr("names")) : py::none();
  PointArray points;
  py::array numbers;  // as readFrame() takes them
  FrameLayout layout;
  if (!names.is_none()) {
    for (const char* name : {"x", "y", "z"}) {
      if (!py::cast<bool>(names.attr("__contains__")(name))) {
        valueError(std::string(what) + " has no field '" + name + "'; it has " + std::string(py::str(names)));
      }
    }
    points.rows = numbers = numpy.attr("ascontiguousarray")(value).attr("reshape")(-1);
    if (!layoutOf(numbers, layout)) {  // other types or orders of bytes: NumPy converts
      const auto column = [&](const char* name) { return doubles(points.rows[py::str(name)], what); };
      numbers = numpy.attr("column_stack")(py::make_tuple(column("x"), column("y"), column("z")));
      layout = {24, 0, 8, 16, true};
    }
  } else {
    if (is_array) numbers = py::reinterpret_borrow<py::array>(value);
    const bool as_it_is = is_array && numbers.ndim() == 2 && numbers.shape(1) == 3 && layoutOf(numbers, layout);
    if (!as_it_is) {
      numbers = matrixOf(value, what, 3).array;
      layout = {24, 0, 8, 16, true};
    }
    points.rows = numbers;
  }
  const auto count = static_cast<std::size_t>(numbers.shape(0));
  const GilReleased released;
  points.frame = readFrame(numbers.data(), count, layout);
  return points;
}

Geometry geometryOf(py::handle value, const char* what) {
  if (py::isinstance<Geometry>(value)) return py::cast<Geometry>(value);
  if (py::hasattr(value, "vertices") && py::hasattr(value, "faces")) return mesh(value, py::none(), false);
  typeError(std::string(what) + " is no Geometry, and no mesh with vertices and faces, but " + typeName(value));
}

std::shared_ptr<fcl::CollisionObjectd> objectOf(const Geometry& geometry, const Eigen::Isometry3d& pose) {
  return std::make_shared<fcl::CollisionObjectd>(geometry.shape, pose);
}

void bindGeometry(py::module_& module) {
  py::class_<Geometry>(module, "Geometry", "A shape or a mesh, in a frame of its own; it does not change.")
      .def_property_readonly("kind", [](const Geometry& g) -> py::object { return geometryState(g)[0]; })
      .def_property_readonly("solid",
                             [](const Geometry& g) {
                               const auto kind = g.shape->getNodeType();
                               if (kind == fcl::GEOM_PLANE || kind == fcl::GEOM_TRIANGLE) return false;
                               return !asMesh(*g.shape) || dynamic_cast<const SolidMark*>(g.shape.get()) != nullptr;
                             })
      .def_property_readonly("vertices",
                             [](const Geometry& g) -> py::object {
                               const auto kind = std::string(py::str(geometryState(g)[0]));
                               if (kind != "mesh" && kind != "convex") {
                                 throw py::attribute_error("a " + kind + " has no vertices");
                               }
                               return geometryState(g)[1];
                             })
      .def_property_readonly("faces",
                             [](const Geometry& g) -> py::object {
                               const auto* model = asMesh(*g.shape);
                               if (!model) throw py::attribute_error("only a mesh has faces");
                               return arrayOfFaces(model->tri_indices, static_cast<std::size_t>(model->num_tris));
                             })
      .def_property_readonly("missing", [](const Geometry& g) { return g.missing; })
      .def(
          "as_solid", [](const Geometry& g) { return Geometry{makeSolid(*g.shape)}; },
          "A solid mesh of the same triangles, so that what lies within touches it. They must be closed.")
      .def("__eq__",
           [](const Geometry& g, py::handle other) -> py::object {
             if (!py::isinstance<Geometry>(other)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
             return py::bool_(g.shape == py::cast<const Geometry&>(other).shape);
           })
      .def("__hash__", [](const Geometry& g) { return std::hash<const void*>()(g.shape.get()); })
      .def("__repr__",
           [](const Geometry& g) -> std::string {
             if (const auto* model = asMesh(*g.shape)) {
               return "<Geometry: " + std::string(dynamic_cast<const SolidMark*>(g.shape.get()) ? "solid " : "") +
                      "mesh of " + text::counted(model->num_tris, "triangle") + ">";
             }
             const py::tuple state = geometryState(g);
             const std::string kind = py::str(state[0]);
             if (kind == "points") return "<Geometry: " + text::counted(py::len(state[1]), "point") + ">";
             if (kind == "octree") return "<Geometry: octree, cells of " + std::string(py::str(state[1])) + " m>";
             std::string text = "<Geometry: " + kind;
             if (kind == "convex") return text + ", " + text::counted(py::len(state[1]), "vertex", "vertices") + ">";
             for (std::size_t i = 1; i < state.size(); ++i)
               text += (i == 1 ? " " : ", ") + std::string(py::str(state[i]));
             return text + ">";
           })
      .def(py::pickle(&geometryState, &geometryOfState));

  module.def("box", &box, "A box with edges of these lengths, centred at the origin.", py::arg("size"));
  module.def("sphere", &sphere, "A ball around the origin.", py::arg("radius"));
  module.def("ellipsoid", &ellipsoid, "An ellipsoid around the origin.", py::arg("radii"));
  module.def("capsule", &round<fcl::Capsuled>,
             "A cylinder of this length along z, centred at the origin, with half a ball at each end.",
             py::arg("radius"), py::arg("length"));
  module.def("cylinder", &round<fcl::Cylinderd>, "A cylinder along z, centred at the origin.", py::arg("radius"),
             py::arg("length"));
  module.def("cone", &round<fcl::Coned>, "A cone along z with its tip up, centred at the origin.", py::arg("radius"),
             py::arg("length"));
  module.def("halfspace", &unbounded<fcl::Halfspaced>,
             "All points x with normal . x <= offset, the normal taken as of length 1; only for obstacles.",
             py::arg("normal"), py::arg("offset") = 0.0);
  module.def("plane", &unbounded<fcl::Planed>,
             "All points x with normal . x == offset, the normal taken as of length 1; only for obstacles.",
             py::arg("normal"), py::arg("offset") = 0.0);
  module.def("triangle", &triangle, "One triangle.", py::arg("a"), py::arg("b"), py::arg("c"));
  module.def("convex", &convex,
             "The convex hull of vertices (V, 3). Faces (F, 3), for pictures, are found if not given.",
             py::arg("vertices"), py::arg("faces") = py::none());
  module.def(
      "mesh", &mesh,
      "A mesh of vertices (V, 3) and triangles (F, 3), or of one object that has `vertices` and `faces`. It is its\n"
      "surface; if `solid`, what lies within touches it too, and it must be closed.",
      py::arg("vertices"), py::arg("faces") = py::none(), py::arg("solid") = false);
  module.def("octree", &octree, "The cells, cubes of this edge length, that hold one of the points (N, 3) or more.",
             py::arg("points"), py::arg("resolution"));
  module.def(
      "points", &points,
      "Points, each a ball of this radius, or of one radius each (N,): numbers (N, 3), or an array with fields x,\n"
      "y, z, as a PointCloud2 has them. Rows that are not finite are left out (Geometry.missing). With `voxel`, one\n"
      "ball for each cube of this side that has points, which holds all of their balls.",
      py::arg("points"), py::arg("radius"), py::kw_only(), py::arg("voxel") = py::none());
}

}  // namespace fcl_artic::python
