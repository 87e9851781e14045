// SPDX-License-Identifier: BSD-3-Clause
#include "replay/geometry.h"

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

#include "fcl/fcl_geometry.h"
#include "fcl_artic/point_cloud.h"
#include "fcl_artic/solid_mesh.h"

namespace fcl_artic::replay {
namespace {

using Eigen::Vector3d;

std::vector<double> numbers(std::initializer_list<Vector3d> vectors) {
  std::vector<double> out;
  for (const Vector3d& v : vectors) out.insert(out.end(), v.data(), v.data() + 3);
  return out;
}

#if FCL_HAVE_OCTOMAP
/// Below a node; a node without an occupied cell below it is as good as none.
std::string cellsOf(const fcl::OcTreed& tree, const fcl::OcTreed::OcTreeNode* node) {
  if (!tree.nodeHasChildren(node)) return tree.isNodeOccupied(node) ? "#" : ".";
  std::string cells = "+";
  for (unsigned i = 0; i < 8; ++i)
    cells += tree.nodeChildExists(node, i) ? cellsOf(tree, tree.getNodeChild(node, i)) : ".";
  return cells == "+........" ? "." : cells;
}

constexpr int kOcTreeDepth = 16;

/// Turns cells into the bytes that octomap reads of a node: its log-odds, a bit for each of its children, and these.
class CellReader {
 public:
  CellReader(const std::string& cells, const std::string& at) : cells_(cells), at_(at) {}

  std::string bytes() {
    const char root = next();
    if (root == '.') refuse(at_, "begins with '.': a tree without cells is empty text");
    addNode(root, 0);
    if (place_ != cells_.size()) refuse(at_, "goes on after its last cell");
    return bytes_;
  }

 private:
  char next() {
    if (place_ == cells_.size()) refuse(at_, "ends within a node");
    const char c = cells_[place_++];
    if (c != '#' && c != '.' && c != '+') refuse(at_, std::string("has '") + c + "', which is none of # . +");
    return c;
  }
  void addNode(char node, int depth) {
    const float occupied = 1;  // log-odds above FCL's threshold, which is 0
    bytes_.append(reinterpret_cast<const char*>(&occupied), sizeof occupied);
    const std::size_t children_at = bytes_.size();
    bytes_.push_back(0);
    if (node == '#') return;
    if (depth == kOcTreeDepth) refuse(at_, "is more than 16 levels deep");
    unsigned children = 0;
    for (unsigned i = 0; i < 8; ++i) {
      const char child = next();
      if (child == '.') continue;
      children |= 1u << i;
      addNode(child, depth + 1);
    }
    if (children == 0) refuse(at_, "has a node without a child");
    bytes_[children_at] = static_cast<char>(children);
  }

  const std::string& cells_;
  const std::string& at_;
  std::size_t place_ = 0;
  std::string bytes_;
};

std::shared_ptr<fcl::CollisionGeometryd> ocTreeOf(const GeometryRecord& record, const std::string& at) {
  if (!(record.resolution > 0 && std::isfinite(record.resolution))) {
    refuse(at + ".resolution", "is no positive number");
  }
  const auto tree = std::make_shared<octomap::OcTree>(record.resolution);
  if (!record.cells.empty()) {
    std::istringstream in(CellReader(record.cells, at + ".cells").bytes());
    tree->readData(in);
  }
  return std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
}
#endif

std::shared_ptr<fcl::CollisionGeometryd> meshOf(const GeometryRecord& record, const std::string& at) {
  using Mesh = fcl::BVHModel<fcl::AABBd>;  // queries read no bounding volume
  std::vector<fcl::Triangle> triangles;
  for (const std::array<int, 3>& t : record.triangles) {
    for (const int vertex : t) {
      if (vertex >= 0 && static_cast<std::size_t>(vertex) < record.points.size()) continue;
      refuse(entry(at + ".triangles", triangles.size()), "names a point that is not there: " + std::to_string(vertex));
    }
    triangles.emplace_back(t[0], t[1], t[2]);
  }
  if (triangles.empty()) refuse(at, "has no triangle");
  const auto fill = [&](auto mesh) -> std::shared_ptr<fcl::CollisionGeometryd> {
    mesh->beginModel(static_cast<int>(triangles.size()), static_cast<int>(record.points.size()));
    mesh->addSubModel(record.points, triangles);
    mesh->endModel();
    return mesh;
  };
  return record.solid ? fill(std::make_shared<SolidMesh<fcl::AABBd>>()) : fill(std::make_shared<Mesh>());
}

std::shared_ptr<fcl::CollisionGeometryd> hullOf(const GeometryRecord& record, const std::string& at) {
  if (record.points.empty()) refuse(at, "has no point");
  return std::make_shared<fcl::Convexd>(std::make_shared<const std::vector<Vector3d>>(record.points), 0,
                                        std::make_shared<const std::vector<int>>());  // queries read no face
}

std::size_t numSizes(Shape shape) {
  switch (shape) {
    case Shape::sphere:
      return 1;
    case Shape::capsule:
    case Shape::cylinder:
    case Shape::cone:
      return 2;
    case Shape::box:
    case Shape::ellipsoid:
      return 3;
    case Shape::halfspace:
    case Shape::plane:
      return 4;
    case Shape::triangle:
      return 9;
    case Shape::convex:
    case Shape::mesh:
    case Shape::points:
    case Shape::octree:
      return 0;
  }
  return 0;
}

/// FCL's constructors divide n and d by n's length.
template <class Wall>
std::shared_ptr<fcl::CollisionGeometryd> wallOf(const std::vector<double>& s) {
  const auto wall = std::make_shared<Wall>(Vector3d(0, 0, 1), 0);
  wall->n = Vector3d(s[0], s[1], s[2]);
  wall->d = s[3];
  return wall;
}

GeometryRecord shapeRecord(Shape shape, std::vector<double> sizes) {
  GeometryRecord record;
  record.shape = shape;
  record.sizes = std::move(sizes);
  return record;
}

GeometryRecord pointsRecord(Shape shape, const std::vector<Vector3d>& points) {
  GeometryRecord record;
  record.shape = shape;
  record.points = points;
  return record;
}

GeometryRecord meshRecord(const MeshArrays<double>& mesh) {
  GeometryRecord record = pointsRecord(Shape::mesh, {mesh.vertices, mesh.vertices + mesh.num_vertices});
  record.solid = mesh.solid;
  for (std::size_t i = 0; i < mesh.num_triangles; ++i) {
    const fcl::Triangle& t = mesh.triangles[i];
    record.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  }
  return record;
}

GeometryRecord cloudRecord(const PointCloud& cloud) {
  GeometryRecord record = pointsRecord(Shape::points, cloud.points());
  record.radii = cloud.radii();
  return record;
}

#if FCL_HAVE_OCTOMAP
GeometryRecord ocTreeRecord(const fcl::OcTreed& tree) {
  GeometryRecord record;
  record.shape = Shape::octree;
  record.resolution = std::ldexp(tree.getRootBV().max_[0], 1 - kOcTreeDepth);  // half of the root's sides
  if (tree.getRoot()) record.cells = cellsOf(tree, tree.getRoot());
  if (record.cells == ".") record.cells.clear();
  return record;
}
#endif

}  // namespace

GeometryRecord geometryRecord(const fcl::CollisionGeometryd& geometry) {
  if (MeshArrays<double> mesh; asMesh(geometry, mesh)) return meshRecord(mesh);
  if (const auto* cloud = dynamic_cast<const PointCloud*>(&geometry)) return cloudRecord(*cloud);
  if (const auto* box = dynamic_cast<const fcl::Boxd*>(&geometry)) return shapeRecord(Shape::box, numbers({box->side}));
  if (const auto* sphere = dynamic_cast<const fcl::Sphered*>(&geometry)) {
    return shapeRecord(Shape::sphere, {sphere->radius});
  }
  if (const auto* ellipsoid = dynamic_cast<const fcl::Ellipsoidd*>(&geometry)) {
    return shapeRecord(Shape::ellipsoid, numbers({ellipsoid->radii}));
  }
  if (const auto* capsule = dynamic_cast<const fcl::Capsuled*>(&geometry)) {
    return shapeRecord(Shape::capsule, {capsule->radius, capsule->lz});
  }
  if (const auto* cylinder = dynamic_cast<const fcl::Cylinderd*>(&geometry)) {
    return shapeRecord(Shape::cylinder, {cylinder->radius, cylinder->lz});
  }
  if (const auto* cone = dynamic_cast<const fcl::Coned*>(&geometry)) {
    return shapeRecord(Shape::cone, {cone->radius, cone->lz});
  }
  if (const auto* half = dynamic_cast<const fcl::Halfspaced*>(&geometry)) {
    return shapeRecord(Shape::halfspace, {half->n[0], half->n[1], half->n[2], half->d});
  }
  if (const auto* plane = dynamic_cast<const fcl::Planed*>(&geometry)) {
    return shapeRecord(Shape::plane, {plane->n[0], plane->n[1], plane->n[2], plane->d});
  }
  if (const auto* t = dynamic_cast<const fcl::TrianglePd*>(&geometry)) {
    return shapeRecord(Shape::triangle, numbers({t->a, t->b, t->c}));
  }
  if (const auto* hull = dynamic_cast<const fcl::Convexd*>(&geometry)) {
    return pointsRecord(Shape::convex, hull->getVertices());
  }
#if FCL_HAVE_OCTOMAP
  if (const auto* tree = dynamic_cast<const fcl::OcTreed*>(&geometry)) return ocTreeRecord(*tree);
#endif
  throw std::invalid_argument(std::string("writeQuery: no text holds a ") + geometryName(geometry));
}

std::shared_ptr<fcl::CollisionGeometryd> geometryOf(const GeometryRecord& record, const std::string& at) {
  const std::vector<double>& s = record.sizes;
  if (s.size() != numSizes(record.shape)) {
    refuse(at + ".sizes",
           "has " + std::to_string(s.size()) + " entries, not " + std::to_string(numSizes(record.shape)));
  }
  switch (record.shape) {
    case Shape::box:
      return std::make_shared<fcl::Boxd>(s[0], s[1], s[2]);
    case Shape::sphere:
      return std::make_shared<fcl::Sphered>(s[0]);
    case Shape::ellipsoid:
      return std::make_shared<fcl::Ellipsoidd>(s[0], s[1], s[2]);
    case Shape::capsule:
      return std::make_shared<fcl::Capsuled>(s[0], s[1]);
    case Shape::cylinder:
      return std::make_shared<fcl::Cylinderd>(s[0], s[1]);
    case Shape::cone:
      return std::make_shared<fcl::Coned>(s[0], s[1]);
    case Shape::halfspace:
      return wallOf<fcl::Halfspaced>(s);
    case Shape::plane:
      return wallOf<fcl::Planed>(s);
    case Shape::triangle:
      return std::make_shared<fcl::TrianglePd>(Vector3d(s[0], s[1], s[2]), Vector3d(s[3], s[4], s[5]),
                                               Vector3d(s[6], s[7], s[8]));
    case Shape::convex:
      return hullOf(record, at);
    case Shape::mesh:
      return meshOf(record, at);
    case Shape::points:
      return std::make_shared<PointCloud>(record.points, record.radii);
    case Shape::octree:
#if FCL_HAVE_OCTOMAP
      return ocTreeOf(record, at);
#else
      refuse(at, "is an OcTree, which this FCL was built without");
#endif
  }
  refuse(at, "is of no known shape");
}

}  // namespace fcl_artic::replay
