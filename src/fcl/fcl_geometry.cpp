// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/fcl_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
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

#include "fcl/mesh_cache.h"
#include "fcl_artic/point_cloud.h"
#include "fcl_artic/solid_mesh.h"
#include "numerics/baseline_isa.h"
#include "numerics/rotation.h"
#include "numerics/shown.h"

#include "convex/cloud.h"

namespace fcl_artic {

SolidMark::~SolidMark() = default;

namespace {

using engine::Piece;
using engine::PieceKind;

template <class S>
using Mesh = MeshArrays<S>;

/// Whether a mesh is a SolidMesh. (Most are plain BVHModels: one comparison of types shows that.)
template <class BV>
bool isSolid(const fcl::CollisionGeometry<typename BV::S>& geometry) {
  return typeid(geometry) != typeid(fcl::BVHModel<BV>) && dynamic_cast<const SolidMark*>(&geometry);
}

template <class BV>
Mesh<typename BV::S> meshOf(const fcl::CollisionGeometry<typename BV::S>& geometry) {
  const auto& model = static_cast<const fcl::BVHModel<BV>&>(geometry);
  if (model.getModelType() == fcl::BVH_MODEL_POINTCLOUD) {
    throw std::invalid_argument("a point cloud has no surface to collide with: take a fcl_artic::PointCloud");
  }
  if (model.num_tris <= 0 || !model.tri_indices || !model.vertices) {
    throw std::invalid_argument("the mesh has no triangle (was endModel() called?)");
  }
  return {model.vertices, model.tri_indices, static_cast<std::size_t>(model.num_vertices),
          static_cast<std::size_t>(model.num_tris), isSolid<BV>(geometry)};
}

}  // namespace

template <class S>
bool asMesh(const fcl::CollisionGeometry<S>& geometry, Mesh<S>& mesh) {
  switch (geometry.getNodeType()) {
    case fcl::BV_AABB:
      return mesh = meshOf<fcl::AABB<S>>(geometry), true;
    case fcl::BV_OBB:
      return mesh = meshOf<fcl::OBB<S>>(geometry), true;
    case fcl::BV_RSS:
      return mesh = meshOf<fcl::RSS<S>>(geometry), true;
    case fcl::BV_kIOS:
      return mesh = meshOf<fcl::kIOS<S>>(geometry), true;
    case fcl::BV_OBBRSS:
      return mesh = meshOf<fcl::OBBRSS<S>>(geometry), true;
    case fcl::BV_KDOP16:
      return mesh = meshOf<fcl::KDOP<S, 16>>(geometry), true;
    case fcl::BV_KDOP18:
      return mesh = meshOf<fcl::KDOP<S, 18>>(geometry), true;
    case fcl::BV_KDOP24:
      return mesh = meshOf<fcl::KDOP<S, 24>>(geometry), true;
    default:
      return false;
  }
}

namespace {

template <class S>
std::vector<Eigen::Vector3d> toDouble(const fcl::Vector3<S>* points, std::size_t n) {
  std::vector<Eigen::Vector3d> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = points[i].template cast<double>();
  return out;
}

template <class S>
std::shared_ptr<const ShapeTree> readMesh(const Mesh<S>& mesh) {
  std::vector<std::array<int, 3>> triangles(mesh.num_triangles);
  for (std::size_t i = 0; i < mesh.num_triangles; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t index = mesh.triangles[i][static_cast<int>(k)];
      triangles[i][k] = index < mesh.num_vertices ? static_cast<int>(index) : -1;  // ShapeTree refuses it
    }
  }
  return ShapeTree::fromTriangles(toDouble(mesh.vertices, mesh.num_vertices), triangles, mesh.solid);
}

double requireSize(double x, const char* what) {
  if (!(x > 0) || !std::isfinite(x)) {
    throw std::invalid_argument(std::string("its ") + what + " is " + shown(x) + ", not a positive number");
  }
  return x;
}

/// Reads a Halfspace or Plane. FCL's constructors normalise n, but anybody may set n and d afterwards, and a float's
/// norm is rounded to float.
template <class Shape>
std::shared_ptr<const ShapeTree> readUnbounded(const fcl::CollisionGeometry<typename Shape::S>& geometry,
                                               PieceKind kind) {
  const auto& shape = static_cast<const Shape&>(geometry);
  Eigen::Vector3d n = shape.n.template cast<double>();
  double d = shape.d;
  const std::optional<UnitVector> unit = UnitVector::within3Ulps(n);
  if (!unit) throw std::invalid_argument("its normal is zero or not finite");
  if (unit->vector() != n) {  // divided by n's length, by way of the largest entry, as squares may vanish
    const double largest = n.cwiseAbs().maxCoeff();
    d = d / largest / (n / largest).norm();
    n = *unit;
  }
  if (!(std::abs(d) <= 1e9)) throw std::invalid_argument("its offset is not finite or beyond 1e9 m");
  Piece piece;
  piece.kind = kind;
  for (int k = 0; k < 3; ++k) piece.size[k] = n[k];
  piece.center[0] = d;
  return ShapeTree::fromPiece(piece);
}

#if FCL_HAVE_OCTOMAP
/// Occupied leaves of an octree, children in octomap's order.
template <class S>
class CellReader {
 public:
  using Node = typename fcl::OcTree<S>::OcTreeNode;
  explicit CellReader(const fcl::OcTree<S>& tree) : tree_(tree), root_half_(tree.getRootBV().max_[0]) {}
  void restrictTo(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
    lower_ = lower;
    upper_ = upper;
  }
  std::shared_ptr<const ShapeTree> read() {
    std::vector<Piece> cells;
    forEach([&](const Eigen::Vector3d& center, double half) {
      Piece cell;
      cell.kind = PieceKind::box;
      cell.primitive = static_cast<std::int32_t>(cells.size());
      for (int k = 0; k < 3; ++k) {
        cell.size[k] = half;
        cell.center[k] = center[k];
      }
      cells.push_back(cell);
      return true;
    });
    return ShapeTree::fromPieces(cells);
  }
  /// Calls found(center, half a side) for each cell, until that returns false.
  template <class OnCell>
  void forEach(const OnCell& found) const {
    if (const Node* root = tree_.getRoot()) visit(*root, Eigen::Vector3d::Zero(), root_half_, found);
  }
  /// Centres and half sizes are multiples of a power of two of the root's half size: exact, but for float resolutions'
  /// last digits, whatever the depth.
  static Eigen::Vector3d childCenter(const Eigen::Vector3d& center, double half, unsigned i) {
    return center + 0.5 * half * Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  }

 private:
  template <class OnCell>
  bool visit(const Node& node, const Eigen::Vector3d& center, double half, const OnCell& found) const {
    for (int k = 0; k < 3; ++k) {
      // The cell's faces are rounded, and two cells that touch must not leave a gap between them.
      const double reach = half + 0x1p-50 * root_half_;
      if (center[k] - reach > upper_[k] || center[k] + reach < lower_[k]) return true;
    }
    if (!tree_.nodeHasChildren(&node)) return !tree_.isNodeOccupied(&node) || found(center, half);
    for (unsigned i = 0; i < 8; ++i) {
      if (!tree_.nodeChildExists(&node, i)) continue;
      if (!visit(*tree_.getNodeChild(&node, i), childCenter(center, half, i), 0.5 * half, found)) return false;
    }
    return true;
  }
  const fcl::OcTree<S>& tree_;
  const double root_half_;
  Eigen::Vector3d lower_ = Eigen::Vector3d::Constant(-INFINITY), upper_ = Eigen::Vector3d::Constant(INFINITY);
};
#endif

/// FCL has no type of node for them.
template <class S>
const PointCloud* asCloud(const fcl::CollisionGeometry<S>& geometry) {
  if constexpr (std::is_same<S, double>::value) return dynamic_cast<const PointCloud*>(&geometry);
  return nullptr;
}

/// The tree of a mesh, made once for all geometries with these bytes.
template <class S>
std::shared_ptr<const ShapeTree> readCached(const Mesh<S>& mesh, const fcl::CollisionGeometry<S>& geometry) {
  static_assert(std::is_trivially_copyable<fcl::Triangle>::value && sizeof(fcl::Triangle) == 3 * sizeof(std::size_t) &&
                    sizeof(fcl::Vector3<S>) == 3 * sizeof(S),
                "equal bytes are equal meshes, and the other way round");
  // Never destroyed: a query may come from the destructor of somebody's static object.
  static MeshCache& cache = *new MeshCache(kMeshCacheBytes);
  const MeshBytes bytes{&geometry,
                        mesh.vertices,
                        mesh.triangles,
                        mesh.num_vertices * sizeof(fcl::Vector3<S>),
                        mesh.num_triangles * sizeof(fcl::Triangle),
                        sizeof(S),
                        mesh.solid};
  std::shared_ptr<const ShapeTree> tree = cache.find(bytes);
  if (!tree) cache.keep(bytes, tree = readMesh(mesh));
  return tree;
}

template <class S>
std::shared_ptr<const ShapeTree> read(const fcl::CollisionGeometry<S>& geometry, bool cached) {
  Mesh<S> mesh;
  if (asMesh(geometry, mesh)) {
    return cached ? readCached(mesh, geometry) : readMesh(mesh);
  }
  Piece piece;
  switch (geometry.getNodeType()) {
    case fcl::GEOM_BOX: {
      const auto& box = static_cast<const fcl::Box<S>&>(geometry);
      piece.kind = PieceKind::box;
      for (int k = 0; k < 3; ++k) piece.size[k] = 0.5 * requireSize(box.side[k], "side");
      break;
    }
    case fcl::GEOM_SPHERE:
      piece.kind = PieceKind::point;
      piece.radius = requireSize(static_cast<const fcl::Sphere<S>&>(geometry).radius, "radius");
      break;
    case fcl::GEOM_CAPSULE: {
      const auto& capsule = static_cast<const fcl::Capsule<S>&>(geometry);
      piece.kind = PieceKind::segment;
      piece.radius = requireSize(capsule.radius, "radius");
      piece.size[2] = 0.5 * requireSize(capsule.lz, "length");
      break;
    }
    case fcl::GEOM_CYLINDER: {
      const auto& cylinder = static_cast<const fcl::Cylinder<S>&>(geometry);
      piece.kind = PieceKind::cylinder;
      piece.size[0] = requireSize(cylinder.radius, "radius");
      piece.size[2] = 0.5 * requireSize(cylinder.lz, "length");
      break;
    }
    case fcl::GEOM_CONE: {
      const auto& cone = static_cast<const fcl::Cone<S>&>(geometry);
      piece.kind = PieceKind::cone;
      piece.size[0] = requireSize(cone.radius, "radius");
      piece.size[2] = 0.5 * requireSize(cone.lz, "length");
      break;
    }
    case fcl::GEOM_ELLIPSOID: {
      const auto& ellipsoid = static_cast<const fcl::Ellipsoid<S>&>(geometry);
      piece.kind = PieceKind::ellipsoid;
      for (int k = 0; k < 3; ++k) piece.size[k] = requireSize(ellipsoid.radii[k], "radius");
      break;
    }
    case fcl::GEOM_CONVEX: {
      const auto& vertices = static_cast<const fcl::Convex<S>&>(geometry).getVertices();
      return ShapeTree::fromHull(toDouble(vertices.data(), vertices.size()));
    }
    case fcl::GEOM_HALFSPACE:
      return readUnbounded<fcl::Halfspace<S>>(geometry, PieceKind::halfspace);
    case fcl::GEOM_PLANE:
      return readUnbounded<fcl::Plane<S>>(geometry, PieceKind::plane);
    case fcl::GEOM_TRIANGLE: {
      const auto& t = static_cast<const fcl::TriangleP<S>&>(geometry);
      return ShapeTree::fromTriangle(t.a.template cast<double>(), t.b.template cast<double>(),
                                     t.c.template cast<double>());
    }
#if FCL_HAVE_OCTOMAP
    case fcl::GEOM_OCTREE:
      return CellReader<S>(static_cast<const fcl::OcTree<S>&>(geometry)).read();
#endif
    default:
      if (const PointCloud* cloud = asCloud(geometry)) return ShapeTree::fromBalls(cloud->points(), cloud->radii());
      throw std::invalid_argument("this type of geometry is not supported");
  }
  return ShapeTree::fromPiece(piece);
}

/// Hands all that read() reads of a geometry to add(data, bytes), in one order, until that returns false.
template <class Add>
void visitContent(const fcl::CollisionGeometryd& geometry, const Add& add) {
  const auto numbers = [&](const double* data, std::size_t n) { return add(data, n * sizeof *data); };
  const auto vector = [&](const Eigen::Vector3d& v) { return numbers(v.data(), 3); };
  const fcl::NODE_TYPE type = geometry.getNodeType();
  if (!add(&type, sizeof type)) return;
  switch (type) {
    case fcl::GEOM_BOX:
      return (void)vector(static_cast<const fcl::Boxd&>(geometry).side);
    case fcl::GEOM_SPHERE:
      return (void)numbers(&static_cast<const fcl::Sphered&>(geometry).radius, 1);
    case fcl::GEOM_CAPSULE: {
      const auto& capsule = static_cast<const fcl::Capsuled&>(geometry);
      return (void)(numbers(&capsule.radius, 1) && numbers(&capsule.lz, 1));
    }
    case fcl::GEOM_CYLINDER: {
      const auto& cylinder = static_cast<const fcl::Cylinderd&>(geometry);
      return (void)(numbers(&cylinder.radius, 1) && numbers(&cylinder.lz, 1));
    }
    case fcl::GEOM_CONE: {
      const auto& cone = static_cast<const fcl::Coned&>(geometry);
      return (void)(numbers(&cone.radius, 1) && numbers(&cone.lz, 1));
    }
    case fcl::GEOM_ELLIPSOID:
      return (void)vector(static_cast<const fcl::Ellipsoidd&>(geometry).radii);
    case fcl::GEOM_CONVEX: {
      const auto& vertices = static_cast<const fcl::Convexd&>(geometry).getVertices();
      return (void)add(vertices.data(), vertices.size() * sizeof(Eigen::Vector3d));
    }
    case fcl::GEOM_HALFSPACE: {
      const auto& half = static_cast<const fcl::Halfspaced&>(geometry);
      return (void)(vector(half.n) && numbers(&half.d, 1));
    }
    case fcl::GEOM_PLANE: {
      const auto& plane = static_cast<const fcl::Planed&>(geometry);
      return (void)(vector(plane.n) && numbers(&plane.d, 1));
    }
    case fcl::GEOM_TRIANGLE: {
      const auto& t = static_cast<const fcl::TrianglePd&>(geometry);
      return (void)(vector(t.a) && vector(t.b) && vector(t.c));
    }
#if FCL_HAVE_OCTOMAP
    case fcl::GEOM_OCTREE:
      return CellReader<double>(static_cast<const fcl::OcTreed&>(geometry))
          .forEach([&](const Eigen::Vector3d& center, double half) { return vector(center) && numbers(&half, 1); });
#endif
    default: {
      if (const PointCloud* cloud = asCloud(geometry)) {
        const std::size_t counts[] = {cloud->points().size(), cloud->radii().size()};
        return (void)(add(counts, sizeof counts) && add(cloud->points().data(), counts[0] * sizeof(Eigen::Vector3d)) &&
                      numbers(cloud->radii().data(), counts[1]));
      }
      Mesh<double> mesh;
      if (!asMesh(geometry, mesh)) return;
      const std::size_t counts[] = {mesh.num_vertices, mesh.num_triangles, mesh.solid};
      (void)(add(counts, sizeof counts) && add(mesh.vertices, mesh.num_vertices * sizeof(fcl::Vector3d)) &&
             add(mesh.triangles, mesh.num_triangles * sizeof(fcl::Triangle)));
    }
  }
}

template <class S>
std::shared_ptr<const ShapeTree> readNamed(const fcl::CollisionGeometry<S>& geometry, bool cached) {
  try {
    return read(geometry, cached);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(std::string(geometryName(geometry)) + ": " + e.what());
  }
}

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> makeSolid(const fcl::CollisionGeometryd& mesh) {
  const auto copy = [&](auto bv) -> std::shared_ptr<fcl::CollisionGeometryd> {
    using BV = decltype(bv);
    return std::make_shared<SolidMesh<BV>>(static_cast<const fcl::BVHModel<BV>&>(mesh));
  };
  std::shared_ptr<fcl::CollisionGeometryd> solid;
  switch (mesh.getNodeType()) {
    case fcl::BV_AABB:
      solid = copy(fcl::AABBd());
      break;
    case fcl::BV_OBB:
      solid = copy(fcl::OBBd());
      break;
    case fcl::BV_RSS:
      solid = copy(fcl::RSSd());
      break;
    case fcl::BV_kIOS:
      solid = copy(fcl::kIOSd());
      break;
    case fcl::BV_OBBRSS:
      solid = copy(fcl::OBBRSSd());
      break;
    case fcl::BV_KDOP16:
      solid = copy(fcl::KDOP<double, 16>());
      break;
    case fcl::BV_KDOP18:
      solid = copy(fcl::KDOP<double, 18>());
      break;
    case fcl::BV_KDOP24:
      solid = copy(fcl::KDOP<double, 24>());
      break;
    default:
      throw std::invalid_argument(std::string("makeSolid: ") + geometryName(mesh) + " is no mesh");
  }
  (void)readGeometry(*solid);  // refuses what is none
  return solid;
}

template <class S>
const char* geometryName(const fcl::CollisionGeometry<S>& geometry) {
  switch (geometry.getNodeType()) {
    case fcl::BV_AABB:
      return "BVHModel<AABB>";
    case fcl::BV_OBB:
      return "BVHModel<OBB>";
    case fcl::BV_RSS:
      return "BVHModel<RSS>";
    case fcl::BV_kIOS:
      return "BVHModel<kIOS>";
    case fcl::BV_OBBRSS:
      return "BVHModel<OBBRSS>";
    case fcl::BV_KDOP16:
      return "BVHModel<KDOP16>";
    case fcl::BV_KDOP18:
      return "BVHModel<KDOP18>";
    case fcl::BV_KDOP24:
      return "BVHModel<KDOP24>";
    case fcl::GEOM_BOX:
      return "Box";
    case fcl::GEOM_SPHERE:
      return "Sphere";
    case fcl::GEOM_CAPSULE:
      return "Capsule";
    case fcl::GEOM_CONE:
      return "Cone";
    case fcl::GEOM_CYLINDER:
      return "Cylinder";
    case fcl::GEOM_CONVEX:
      return "Convex";
    case fcl::GEOM_PLANE:
      return "Plane";
    case fcl::GEOM_HALFSPACE:
      return "Halfspace";
    case fcl::GEOM_TRIANGLE:
      return "TriangleP";
    case fcl::GEOM_OCTREE:
      return "OcTree";
    case fcl::GEOM_ELLIPSOID:
      return "Ellipsoid";
    default:
      return asCloud(geometry) ? "PointCloud" : "unknown geometry";
  }
}

template <class S>
std::shared_ptr<const ShapeTree> readGeometry(const fcl::CollisionGeometry<S>& geometry) {
  return readNamed(geometry, false);
}

bool neverChanges(const fcl::CollisionGeometryd& geometry) {
  return asCloud(geometry) != nullptr;
}

GeometryContent::GeometryContent(const fcl::CollisionGeometryd& geometry, std::shared_ptr<const ShapeTree> tree) {
  if (tree && asCloud(geometry)) {
    balls_ = std::move(tree);
    return;
  }
  std::size_t size = 0;
  visitContent(geometry, [&](const void*, std::size_t n) {
    size += n;
    return true;
  });
  bytes_.reserve(size);
  visitContent(geometry, [&](const void* data, std::size_t n) {
    const char* begin = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), begin, begin + n);
    return true;
  });
}

namespace {

/// A ball of a tree of balls; a tree of one stores it as a piece.
struct BallOfTree {
  std::int32_t number;
  const double* center;
  double radius;
};
BallOfTree ballOf(const engine::TreeView& tree, std::int32_t i) {
  if (tree.balls) return {tree.balls[i].number, tree.balls[i].center, baseline::radiusOfBall(tree, i)};
  const Piece& piece = tree.pieces[i];
  return {piece.primitive, piece.center, piece.radius};
}

/// Whether the tree is that of these balls: it has the number of each.
bool isOfBalls(const engine::TreeView& tree, const PointCloud& cloud) {
  const std::vector<Eigen::Vector3d>& points = cloud.points();
  if (points.size() != static_cast<std::size_t>(tree.num_pieces)) return false;
  for (std::int32_t i = 0; i < tree.num_pieces; ++i) {
    const BallOfTree ball = ballOf(tree, i);
    const auto number = static_cast<std::size_t>(ball.number);
    if (!std::equal(ball.center, ball.center + 3, points[number].data())) return false;
    if (cloud.radius(number) != ball.radius) return false;
  }
  return true;
}

bool haveSameBalls(const engine::TreeView& a, const engine::TreeView& b) {
  if (a.num_pieces != b.num_pieces) return false;
  for (std::int32_t i = 0; i < a.num_pieces; ++i) {
    const BallOfTree one = ballOf(a, i), other = ballOf(b, i);
    if (one.number != other.number || one.radius != other.radius) return false;
    if (!std::equal(one.center, one.center + 3, other.center)) return false;
  }
  return true;
}

}  // namespace

bool GeometryContent::sameAs(const GeometryContent& other) const {
  if (balls_ && other.balls_) return balls_ == other.balls_ || haveSameBalls(balls_->view(), other.balls_->view());
  return !balls_ && !other.balls_ && bytes_ == other.bytes_;
}

bool GeometryContent::sameAs(const fcl::CollisionGeometryd& geometry) const {
  if (balls_) {
    const PointCloud* cloud = asCloud(geometry);
    return cloud && isOfBalls(balls_->view(), *cloud);
  }
  std::size_t at = 0;
  bool same = true;
  try {
    visitContent(geometry, [&](const void* data, std::size_t n) {
      same = n <= bytes_.size() - at && (n == 0 || std::memcmp(bytes_.data() + at, data, n) == 0);
      at += n;
      return same;
    });
  } catch (const std::invalid_argument&) {  // no mesh any more
    return false;
  }
  return same && at == bytes_.size();
}

template <class S>
std::shared_ptr<const ShapeTree> cachedGeometry(const fcl::CollisionGeometry<S>& geometry) {
  return readNamed(geometry, true);
}

#if FCL_HAVE_OCTOMAP
template <class S>
std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<S>& tree) {
  return readNamed<S>(tree, false);
}

template <class S>
std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<S>& tree, const Eigen::Vector3d& lower,
                                            const Eigen::Vector3d& upper) {
  CellReader<S> reader(tree);
  reader.restrictTo(lower, upper);
  return reader.read();
}

template <class S>
std::intptr_t ocTreeCellId(const fcl::OcTree<S>& tree, const Eigen::Vector3d& point) {
  const auto* root = std::as_const(tree).getRoot();
  double half = tree.getRootBV().max_[0];
  if (!root || !(point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= half)) return -1;
  const auto* node = static_cast<const typename fcl::OcTree<S>::OcTreeNode*>(root);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  while (tree.nodeHasChildren(node)) {
    const unsigned i =
        (point[0] > center[0] ? 1u : 0u) | (point[1] > center[1] ? 2u : 0u) | (point[2] > center[2] ? 4u : 0u);
    if (!tree.nodeChildExists(node, i)) return -1;
    node = tree.getNodeChild(node, i);
    center = CellReader<S>::childCenter(center, half, i);
    half *= 0.5;
  }
  return node - root;
}
#endif

RigidTransform requireRigid(const Eigen::Isometry3d& M, const std::string& what) {
  return requireRigid(M, 1e-6, [&] { return what; });
}

template bool asMesh(const fcl::CollisionGeometry<double>&, MeshArrays<double>&);
template std::shared_ptr<const ShapeTree> readGeometry(const fcl::CollisionGeometry<float>&);
template std::shared_ptr<const ShapeTree> readGeometry(const fcl::CollisionGeometry<double>&);
template std::shared_ptr<const ShapeTree> cachedGeometry(const fcl::CollisionGeometry<float>&);
template std::shared_ptr<const ShapeTree> cachedGeometry(const fcl::CollisionGeometry<double>&);
template const char* geometryName(const fcl::CollisionGeometry<float>&);
template const char* geometryName(const fcl::CollisionGeometry<double>&);
#if FCL_HAVE_OCTOMAP
template std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<float>&);
template std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<double>&);
template std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<float>&, const Eigen::Vector3d&,
                                                     const Eigen::Vector3d&);
template std::shared_ptr<const ShapeTree> readOcTree(const fcl::OcTree<double>&, const Eigen::Vector3d&,
                                                     const Eigen::Vector3d&);
template std::intptr_t ocTreeCellId(const fcl::OcTree<float>&, const Eigen::Vector3d&);
template std::intptr_t ocTreeCellId(const fcl::OcTree<double>&, const Eigen::Vector3d&);
#endif

}  // namespace fcl_artic
