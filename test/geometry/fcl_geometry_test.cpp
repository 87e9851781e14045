// SPDX-License-Identifier: BSD-3-Clause
//
// Every FCL geometry is read as FCL means it, in float and double, and left as it was.
#include "fcl/fcl_geometry.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <tuple>
#include <type_traits>

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
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "random.h"

#include "numerics/baseline_isa.h"
#include "numerics/unit_vector.h"

#include "convex/piece_kinds.h"

namespace fcl_geometry_test {

using namespace fcl_artic;
using Eigen::Vector3d;
using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

namespace {

template <class S>
std::shared_ptr<std::vector<fcl::Vector3<S>>> points(std::size_t n) {
  Random random(n);
  auto out = std::make_shared<std::vector<fcl::Vector3<S>>>();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d p = Vector3d(0.5, -0.2, 0.1) + Vector3d(0.7, 0.4, 1.1).cwiseProduct(unit(random));
    const auto rounded = [&](int k) { return static_cast<S>(static_cast<float>(p[k])); };
    out->emplace_back(rounded(0), rounded(1), rounded(2));  // the same values in float and double
  }
  return out;
}

/// A cube's corners and faces (counter-clockwise from outside), shifted.
template <class S>
std::shared_ptr<fcl::Convex<S>> cube() {
  auto vertices = std::make_shared<std::vector<fcl::Vector3<S>>>();
  for (int i = 0; i < 8; ++i) {
    vertices->emplace_back(S(0.25) + S(i & 1 ? 0.5 : -0.5), S(i & 2 ? 0.75 : -0.75), S(-1) + S(i & 4 ? 1 : -1));
  }
  auto faces = std::make_shared<std::vector<int>>(
      std::vector<int>{4, 0, 2, 3, 1, 4, 4, 5, 7, 6, 4, 0, 1, 5, 4, 4, 2, 6, 7, 3, 4, 0, 4, 6, 2, 4, 1, 3, 7, 5});
  return std::make_shared<fcl::Convex<S>>(vertices, 6, faces, true);
}

template <class BV>
std::shared_ptr<fcl::BVHModel<BV>> mesh(std::size_t n = 30) {
  auto model = std::make_shared<fcl::BVHModel<BV>>();
  const auto p = points<typename BV::S>(n);
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i + 2 < n; ++i) triangles.emplace_back(i, i + 1, i + 2);
  model->beginModel();
  model->addSubModel(*p, triangles);
  model->endModel();
  return model;
}

/// 600 cells of three kinds of certainty around a sphere, and a corner of eight that octomap prunes to one.
std::shared_ptr<octomap::OcTree> map(double resolution = 0.1) {
  Random random(5);
  auto tree = std::make_shared<octomap::OcTree>(resolution);
  for (int i = 0; i < 600; ++i) {
    const Vector3d p = 1.5 * unit(random);
    const octomap::OcTreeKey key = tree->coordToKey(p[0], p[1], p[2]);
    for (int k = 0; k <= i % 3; ++k) tree->updateNode(key, i % 4 != 0, true);
  }
  const octomap::OcTreeKey corner = tree->coordToKey(0.01, 0.01, 0.01);
  for (int i = 0; i < 64; ++i) {
    octomap::OcTreeKey key = corner;
    for (unsigned k = 0; k < 3; ++k) key[k] = static_cast<octomap::key_type>(key[k] + (i >> (2 * k) & 3));
    for (int repeat = 0; repeat < 20; ++repeat) tree->updateNode(key, true, true);  // until clamped, all alike
  }
  tree->updateInnerOccupancy();
  tree->prune();
  return tree;
}

/// One of every type: f(its name, pointer to the object).
template <class S, class F>
void forEachShape(const F& f) {
  f("Box", std::make_shared<fcl::Box<S>>(S(0.5), S(1.25), S(2)));
  f("Sphere", std::make_shared<fcl::Sphere<S>>(S(0.75)));
  f("Capsule", std::make_shared<fcl::Capsule<S>>(S(0.25), S(1.5)));
  f("Cylinder", std::make_shared<fcl::Cylinder<S>>(S(0.5), S(1.5)));
  f("Cone", std::make_shared<fcl::Cone<S>>(S(0.5), S(1.5)));
  f("Ellipsoid", std::make_shared<fcl::Ellipsoid<S>>(S(0.5), S(1.25), S(0.75)));
  f("Convex", cube<S>());
  f("Halfspace", std::make_shared<fcl::Halfspace<S>>(S(0.36), S(0.48), S(0.8), S(0.625)));
  f("Plane", std::make_shared<fcl::Plane<S>>(S(0.36), S(0.48), S(0.8), S(-0.625)));
  f("TriangleP", std::make_shared<fcl::TriangleP<S>>(fcl::Vector3<S>(1, 0, 0), fcl::Vector3<S>(0, 2, 0),
                                                     fcl::Vector3<S>(0, 0, S(0.5))));
  f("OcTree", std::make_shared<fcl::OcTree<S>>(map(0.125)));
  f("BVHModel<AABB>", mesh<fcl::AABB<S>>());
  f("BVHModel<OBB>", mesh<fcl::OBB<S>>());
  f("BVHModel<RSS>", mesh<fcl::RSS<S>>());
  f("BVHModel<kIOS>", mesh<fcl::kIOS<S>>());
  f("BVHModel<OBBRSS>", mesh<fcl::OBBRSS<S>>());
  f("BVHModel<KDOP16>", mesh<fcl::KDOP<S, 16>>());
  f("BVHModel<KDOP18>", mesh<fcl::KDOP<S, 18>>());
  f("BVHModel<KDOP24>", mesh<fcl::KDOP<S, 24>>());
}

template <class S>
std::map<std::string, std::shared_ptr<fcl::CollisionGeometry<S>>> shapes() {
  std::map<std::string, std::shared_ptr<fcl::CollisionGeometry<S>>> all;
  forEachShape<S>([&](const char* name, const auto& shape) { all[name] = shape; });
  return all;
}

/// Farthest point of a piece along u, its rounding included.
Vector3d support(const TreeView& view, const Piece& piece, const Vector3d& u) {
  const baseline::Vec3 x = baseline::supportPoint(view, piece, baseline::Vec3(u.data()));
  return Vector3d::Map(x.k) + piece.radius * u.normalized();
}

bool fclSaysTouching(const fcl::CollisionGeometryd& geometry, const fcl::CollisionGeometryd& other,
                     const Vector3d& at) {
  const fcl::Transform3d here = fcl::Transform3d::Identity();
  const fcl::Transform3d there(Eigen::Translation3d(at.x(), at.y(), at.z()));
  fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
  return fcl::collide(&geometry, here, &other, there, request, result) > 0;
}

/// The message of what is thrown; empty when nothing is.
template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// All that a tree shows, as one string of bytes, but for padding.
std::string dump(const TreeView& view) {
  std::ostringstream out;
  const auto put = [&](const auto* x, std::size_t n) { out.write(reinterpret_cast<const char*>(x), n * sizeof *x); };
  put(&view.extent, 1);
  for (int i = 0; i < view.num_nodes; ++i) {
    put(view.nodes[i].lo, 3);
    put(view.nodes[i].hi, 3);
    put(&view.nodes[i].child, 1);
  }
  for (int i = 0; i < view.num_pieces; ++i) {
    const Piece& p = view.pieces[i];
    put(&p.kind, 1);
    put(&p.primitive, 1);
    put(p.size, 3);
    put(p.center, 3);
    put(&p.radius, 1);
    put(&p.reach, 1);
    if (p.kind == PieceKind::vertices) put(view.vertices + 3 * p.first_vertex, 3 * p.num_vertices);
    if (p.kind == PieceKind::hull) put(view.hulls + p.first_vertex, 3 * p.num_vertices);
  }
  return out.str();
}

}  // namespace

// A little ball beyond the farthest point along any direction is free by FCL's own static check; one that reaches past
// it is not. So kinds, sizes, axes and ends are what FCL means by them.
TEST(FclGeometry, EndsWhereFclSaysThatItEnds) {
  Random random(2);
  const double r = 1e-2, off = 1e-3;
  const fcl::Sphered ball(r);
  for (const auto& [name, geometry] : shapes<double>()) {
    const auto tree = readGeometry(*geometry);
    const TreeView& view = tree->view();
    if (view.num_pieces != 1 || name == "TriangleP") continue;  // FCL has no static check of a TriangleP
    const Piece& piece = view.pieces[0];
    for (int i = 0; i < 100; ++i) {
      Vector3d u = unit(random), x;
      if (baseline::unbounded(piece)) {
        u = Vector3d::Map(piece.size) * (name == "Plane" && i % 2 ? -1 : 1);
        Vector3d tangent = unit(random);
        tangent -= u.dot(tangent) * u;
        x = support(view, piece, u) + 10 * tangent;
      } else {
        x = support(view, piece, u);
      }
      EXPECT_FALSE(fclSaysTouching(*geometry, ball, x + (r + off) * u)) << name << ", u = " << u.transpose();
      EXPECT_TRUE(fclSaysTouching(*geometry, ball, x + (r - off) * u)) << name << ", u = " << u.transpose();
      // The inside: solids are full, a plane is thin.
      if (name == "Halfspace") EXPECT_TRUE(fclSaysTouching(*geometry, ball, x - 5 * u));
      if (name == "Plane") EXPECT_FALSE(fclSaysTouching(*geometry, ball, x - (2 * r + off) * u));
    }
  }
}

// The node box, extent and reach hold farthest points in every direction; where a box is tight it is tight to floats.
TEST(FclGeometry, BoundsHoldTheShape) {
  Random random(3);
  for (const auto& [name, geometry] : shapes<double>()) {
    const auto tree = readGeometry(*geometry);
    const TreeView& view = tree->view();
    ASSERT_GE(view.num_pieces, 1) << name;
    if (baseline::unbounded(view.pieces[0])) {
      EXPECT_EQ(tree->lower(), Vector3d::Constant(-static_cast<double>(engine::kUnbounded)));
      EXPECT_EQ(tree->upper(), Vector3d::Constant(static_cast<double>(engine::kUnbounded)));
      EXPECT_TRUE(std::isfinite(view.nodes[0].radius));
      EXPECT_DOUBLE_EQ(view.extent, 0.625);
      EXPECT_DOUBLE_EQ(view.pieces[0].reach, 0.625);
      EXPECT_EQ(view.outer, view.pieces);
      EXPECT_TRUE(contains(refusal([&] { tree->lineSweptSphere(); }), "unbounded"));
      continue;
    }
    const std::array<double, 7> lss = tree->lineSweptSphere();
    Vector3d farthest = Vector3d::Constant(-INFINITY), nearest = -farthest;
    for (int i = 0; i < 2000; ++i) {
      Vector3d u = unit(random);
      if (i < 6) u = (i % 2 ? 1 : -1) * Vector3d::Unit(i / 2);
      for (int p = 0; p < view.num_pieces; ++p) {
        const Vector3d x = support(view, view.pieces[p], u);
        farthest = farthest.cwiseMax(x);
        nearest = nearest.cwiseMin(x);
        ASSERT_LE(x.norm(), view.extent) << name;
        ASSERT_LE((x - view.pieces[p].radius * u).norm(), view.pieces[p].reach + 1e-15) << name;
        const Vector3d p0 = Vector3d::Map(&lss[0]), d = Vector3d::Map(&lss[3]) - p0;
        const double s = d.squaredNorm() > 0 ? std::clamp((x - p0).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
        ASSERT_LE((x - p0 - s * d).norm(), lss[6] * (1 + 1e-14)) << name;
      }
      if (view.num_pieces > 100 && i > 50) break;
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(tree->lower()[k], nearest[k]) << name;
      EXPECT_GE(tree->upper()[k], farthest[k]) << name;
      EXPECT_NEAR(tree->lower()[k], nearest[k], 1e-6) << name;
      EXPECT_NEAR(tree->upper()[k], farthest[k], 1e-6) << name;
    }
  }
}

// The numbers above are floats, so that both ways of reading must give the same bits.
TEST(FclGeometry, FloatIsReadAsTheSameNumbers) {
  const auto in_float = shapes<float>();
  const auto in_double = shapes<double>();
  EXPECT_EQ(in_float.size(), 19u);
  for (const auto& [name, geometry] : in_float) {
    EXPECT_EQ(geometryName(*geometry), name);
    if (name == "Halfspace" || name == "Plane") {  // normalised by FCL in float
      const auto a = readGeometry(*geometry), b = readGeometry(*in_double.at(name));
      EXPECT_LE((Vector3d::Map(a->view().pieces[0].size) - Vector3d::Map(b->view().pieces[0].size)).norm(), 1e-7);
      EXPECT_NEAR(Vector3d::Map(a->view().pieces[0].size).squaredNorm(), 1, 1e-15);
      continue;
    }
    EXPECT_TRUE(dump(readGeometry(*geometry)->view()) == dump(readGeometry(*in_double.at(name))->view())) << name;
    EXPECT_TRUE(dump(cachedGeometry(*geometry)->view()) == dump(readGeometry(*in_double.at(name))->view())) << name;
  }
}

TEST(FclGeometry, PrimitiveIdsAreFcls) {
  for (const auto& [name, geometry] : shapes<double>()) {
    const auto tree = readGeometry(*geometry);
    const TreeView& view = tree->view();
    for (int i = 0; i < view.num_pieces; ++i) {
      EXPECT_EQ(view.pieces[i].primitive, name.substr(0, 3) == "BVH" || name == "OcTree" ? i : -1) << name;
    }
    if (name.substr(0, 3) == "BVH") EXPECT_EQ(view.num_pieces, 28) << name;
  }
}

TEST(FclGeometry, IsLeftAsItWas) {
  int checked = 0;
  const auto check = [&](const char* name, const auto& shape) {
    std::vector<unsigned char> before(sizeof *shape), after(sizeof *shape);
    std::memcpy(before.data(), static_cast<const void*>(shape.get()), before.size());
    readGeometry(*shape);
    cachedGeometry(*shape);
    cachedGeometry(*shape);
    std::memcpy(after.data(), static_cast<const void*>(shape.get()), after.size());
    EXPECT_TRUE(before == after) << name;
    ++checked;
  };
  forEachShape<double>(check);
  forEachShape<float>(check);
  EXPECT_EQ(checked, 38);
  // The corners to which they point.
  const auto model = mesh<fcl::OBBRSS<double>>();
  const std::vector<Vector3d> vertices(model->vertices, model->vertices + model->num_vertices);
  cachedGeometry(*model);
  for (int i = 0; i < model->num_vertices; ++i) EXPECT_EQ(model->vertices[i], vertices[static_cast<std::size_t>(i)]);
  const auto convex = cube<double>();
  const std::vector<Vector3d> corners = convex->getVertices();
  readGeometry(*convex);
  EXPECT_EQ(corners, convex->getVertices());
  auto tree = map();
  std::ostringstream before, after;
  tree->write(before);
  const fcl::OcTreed octree(tree);
  readOcTree(octree);
  tree->write(after);
  EXPECT_TRUE(before.str() == after.str());
}

TEST(FclGeometry, ConvexIsTheHullOfItsVertices) {
  Random random(7);
  const auto faces = std::make_shared<std::vector<int>>();
  const auto check = [&](const auto& vertices, const auto& convex) {
    const auto tree = readGeometry(convex);
    const TreeView& view = tree->view();
    ASSERT_EQ(view.num_pieces, 1);
    const Piece& piece = view.pieces[0];
    ASSERT_EQ(piece.kind, PieceKind::hull);
    EXPECT_EQ(view.outer, view.pieces);
    EXPECT_EQ(piece.num_vertices % 8, 0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(view.hulls) % 64, 0u);
    EXPECT_EQ(static_cast<std::size_t>(piece.num_vertices), (vertices.size() + 7) / 8 * 8);
    for (int i = 0; i < 100; ++i) {
      const Vector3d u = unit(random);
      double most = -INFINITY, least = INFINITY, lower, upper;
      for (const auto& v : vertices) {
        most = std::max(most, u.dot(v.template cast<double>()));
        least = std::min(least, u.dot(v.template cast<double>()));
      }
      baseline::coreRange(view, piece, baseline::Vec3(u.data()), lower, upper);
      EXPECT_NEAR(upper, most, 1e-14);
      EXPECT_NEAR(lower, least, 1e-14);
      EXPECT_NEAR(support(view, piece, u).dot(u), most, 1e-14);
    }
  };
  for (const std::size_t n : {1u, 3u, 8u, 9u, 64u, 65u, 5000u}) {
    check(*points<double>(n), fcl::Convexd(points<double>(n), 0, faces));
    check(*points<float>(n), fcl::Convexf(points<float>(n), 0, faces));
  }
}

TEST(FclGeometry, NormalsAreMadeUnit) {
  fcl::Halfspaced halfspace(Vector3d(0, 0, 1), 0.5);
  halfspace.n = Vector3d(0, 3, 4) * 1e200;  // whoever sets it himself
  halfspace.d = 1e200;
  const auto tree = readGeometry(halfspace);
  EXPECT_LE((Vector3d::Map(tree->view().pieces[0].size) - Vector3d(0, 0.6, 0.8)).norm(), UnitVector::kUlps * 0x1p-52);
  EXPECT_NEAR(tree->view().pieces[0].center[0], 0.2, 1e-16);
  // A float's unit normal is off by 1e-7, which would be 100 m at the far end of the world.
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f n = unit(random).cast<float>();
    const fcl::Planef plane(n, 3.0f);
    const auto read = readGeometry(plane);
    const Piece& p = read->view().pieces[0];
    EXPECT_NEAR(Vector3d::Map(p.size).squaredNorm(), 1, 1e-15);
    // The same set of points: the foot of the perpendicular fulfils FCL's own equation.
    EXPECT_NEAR((p.center[0] * Vector3d::Map(p.size)).dot(plane.n.cast<double>()), plane.d, 4e-15);
  }
  // One that is of unit length to rounding stays as it is, and so does its offset.
  int kept = 0;
  for (int i = 0; i < 1000; ++i) {
    halfspace.n = unit(random);
    halfspace.d = 0.3;
    if (UnitVector::within3Ulps(halfspace.n)->vector() != halfspace.n) continue;
    const Piece p = readGeometry(halfspace)->view().pieces[0];
    EXPECT_TRUE(Vector3d::Map(p.size) == halfspace.n && p.center[0] == halfspace.d) << halfspace.n.squaredNorm() - 1;
    ++kept;
  }
  EXPECT_GT(kept, 900);
}

TEST(FclGeometry, RefusesByName) {
  const auto of = [](const auto& geometry) { return refusal([&] { readGeometry(geometry); }); };
  const auto expect = [](const std::string& text, const std::string& name, const std::string& part) {
    EXPECT_TRUE(text.rfind(name + ": ", 0) == 0 && contains(text, part)) << text;
  };
  expect(of(fcl::Boxd(1, -1, 1)), "Box", "side");
  expect(of(fcl::Boxf(1, NAN, 1)), "Box", "side");
  expect(of(fcl::Sphered(0)), "Sphere", "radius");
  expect(of(fcl::Sphered(2e9)), "Sphere", "1e9");
  expect(of(fcl::Capsulef(1, INFINITY)), "Capsule", "length");
  expect(of(fcl::Cylinderd(-1, 1)), "Cylinder", "radius");
  expect(of(fcl::Coned(1, 0)), "Cone", "length");
  expect(of(fcl::Ellipsoidd(1, 1, NAN)), "Ellipsoid", "radius");
  expect(of(fcl::TrianglePd({0, 0, 0}, {NAN, 0, 0}, {0, 1, 0})), "TriangleP", "vertex 1 is not finite");
  fcl::Halfspaced halfspace(Vector3d::UnitX(), 0);
  halfspace.n.setZero();
  expect(of(halfspace), "Halfspace", "normal");
  fcl::Planed plane(Vector3d::UnitX(), 0);
  plane.n[1] = NAN;
  expect(of(plane), "Plane", "normal");
  plane.n = Vector3d::UnitY();
  plane.d = INFINITY;
  expect(of(plane), "Plane", "offset");
  const auto faces = std::make_shared<std::vector<int>>();
  expect(of(fcl::Convexd(std::make_shared<std::vector<Vector3d>>(1, Vector3d(0, 0, NAN)), 0, faces)), "Convex",
         "vertex 0");
  fcl::BVHModel<fcl::RSSd> cloud;
  expect(of(cloud), "BVHModel<RSS>", "no triangle");
  cloud.beginModel();
  cloud.addSubModel(*points<double>(10));
  cloud.endModel();
  expect(of(cloud), "BVHModel<RSS>", "point cloud");
  expect(refusal([&] { cachedGeometry(cloud); }), "BVHModel<RSS>", "point cloud");
  const auto model = mesh<fcl::AABB<float>>();
  model->tri_indices[7][1] = (std::size_t{1} << 32) + 1;  // 1 when cut to 32 bits
  expect(of(*model), "BVHModel<AABB>", "triangle 7");
  model->tri_indices[7][1] = 1;
  EXPECT_EQ(of(*model), "");
  model->vertices[3][0] = INFINITY;
  expect(of(*model), "BVHModel<AABB>", "vertex 3");
}

// Cell by cell octomap's own leaves, in its order.
template <class S>
void compareCells(const octomap::OcTree& map, const fcl::OcTree<S>& octree, double threshold, double accuracy) {
  const auto tree = readOcTree(octree);
  const TreeView& view = tree->view();
  int n = 0, large = 0;
  for (auto leaf = map.begin_leafs(); leaf != map.end_leafs(); ++leaf) {
    if (leaf->getLogOdds() < threshold) continue;
    ASSERT_LT(n, view.num_pieces);
    const Piece& cell = view.pieces[n];
    EXPECT_EQ(cell.kind, PieceKind::box);
    EXPECT_EQ(cell.primitive, n++);
    const Vector3d center(leaf.getX(), leaf.getY(), leaf.getZ());
    EXPECT_LE((Vector3d::Map(cell.center) - center).cwiseAbs().maxCoeff(), accuracy);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(cell.size[k], 0.5 * leaf.getSize(), accuracy);
    large += leaf.getSize() > 1.5 * map.getResolution();
    EXPECT_EQ(octree.getRoot() + ocTreeCellId(octree, Vector3d::Map(cell.center)), &*leaf);
  }
  EXPECT_EQ(n, view.num_pieces);
  EXPECT_GT(n, 100);
  EXPECT_GT(large, 0);  // pruned cells are among them
}

TEST(FclOcTree, CellsAreOctomapsOwn) {
  const auto tree = map();
  std::vector<int> sizes;
  for (const double occupancy : {0.5, 0.75, 0.9}) {
    fcl::OcTreed octree(tree);
    octree.setOccupancyThres(occupancy);
    compareCells(*tree, octree, static_cast<double>(octomap::logodds(occupancy)), 1e-15);
    sizes.push_back(readGeometry(octree)->view().num_pieces);
    fcl::OcTreef in_float(tree);
    in_float.setOccupancyThres(static_cast<float>(occupancy));
    compareCells(*tree, in_float, static_cast<double>(octomap::logodds(occupancy)), 1e-6);
  }
  EXPECT_GT(sizes[0], sizes[1]);
  EXPECT_GT(sizes[1], sizes[2]);
}

TEST(FclOcTree, EndsWhereFclSaysThatItEnds) {
  const fcl::OcTreed octree(map());
  const auto tree = readOcTree(octree);
  const fcl::Boxd probe(0.002, 0.002, 0.002);
  Random random(4);
  int touching = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p =
        i % 2 ? Vector3d(1.5 * unit(random))
              : Vector3d(0.6 * Vector3d(uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)));
    double gap = INFINITY;
    for (int k = 0; k < tree->view().num_pieces; ++k) {
      const Piece& cell = tree->view().pieces[k];
      gap = std::min(gap, ((p - Vector3d::Map(cell.center)).cwiseAbs() - Vector3d::Map(cell.size)).maxCoeff());
    }
    if (std::abs(gap - 0.001) < 1e-6) continue;
    EXPECT_EQ(gap < 0.001, fclSaysTouching(octree, probe, p)) << p.transpose();
    touching += gap < 0.001;
  }
  EXPECT_GT(touching, 500);
  EXPECT_LT(touching, 2500);
}

TEST(FclOcTree, CellsOfABox) {
  Random random(6);
  const fcl::OcTreed octree(map());
  const auto all = readOcTree(octree);
  std::size_t read = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3d middle = 1.5 * unit(random), half = uniform(random, 0, 0.5) * Vector3d::Ones();
    const auto some = readOcTree(octree, middle - half, middle + half);
    std::vector<const Piece*> expected;
    for (int k = 0; k < all->view().num_pieces; ++k) {
      const Piece& cell = all->view().pieces[k];
      const Vector3d gap = (middle - Vector3d::Map(cell.center)).cwiseAbs() - half - Vector3d::Map(cell.size);
      if (gap.maxCoeff() <= 0) expected.push_back(&cell);
    }
    ASSERT_EQ(static_cast<std::size_t>(some->view().num_pieces), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const Piece& cell = some->view().pieces[k];
      EXPECT_EQ(cell.primitive, expected.size() == 1 ? 0 : static_cast<int>(k));
      EXPECT_EQ(Vector3d::Map(cell.center), Vector3d::Map(expected[k]->center));
    }
    read += expected.size();
  }
  EXPECT_GT(read, 1000u);
  // Faces that just touch count, infinite boxes hold all, and what cannot be compared leaves nothing out.
  const Piece& first = all->view().pieces[0];
  const Vector3d corner = Vector3d::Map(first.center) - Vector3d::Map(first.size);
  EXPECT_GE(readOcTree(octree, corner, corner)->view().num_pieces, 1);
  for (const double x : {static_cast<double>(INFINITY), static_cast<double>(NAN)}) {
    EXPECT_TRUE(dump(readOcTree(octree, Vector3d::Constant(-x), Vector3d::Constant(x))->view()) == dump(all->view()));
  }
}

TEST(FclOcTree, NoOccupiedCellIsAnEmptyTree) {
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  const fcl::OcTreed octree(tree);
  EXPECT_EQ(readGeometry(octree)->view().num_pieces, 0);
  EXPECT_EQ(ocTreeCellId(octree, Vector3d::Zero()), -1);
  tree->updateNode(octomap::point3d(1, 1, 1), false);
  EXPECT_EQ(readGeometry(octree)->view().num_pieces, 0);
  tree->updateNode(octomap::point3d(1, 2, 1), true);  // seen at once: nothing of an octree is remembered
  EXPECT_EQ(cachedGeometry(octree)->view().num_pieces, 1);
  EXPECT_EQ(cachedGeometry(octree)->view().pieces[0].primitive, 0);
}

// FCL reports the same ids.
TEST(FclOcTree, CellIdIsFcls) {
  const fcl::OcTreed octree(map());
  const auto tree = readOcTree(octree);
  const fcl::Boxd probe(0.002, 0.002, 0.002);
  int compared = 0;
  for (int i = 0; i < tree->view().num_pieces; i += 7) {
    const Vector3d center = Vector3d::Map(tree->view().pieces[i].center);
    fcl::CollisionResultd result;
    const fcl::Transform3d there(Eigen::Translation3d(center.x(), center.y(), center.z()));
    fcl::CollisionRequestd request(10, true);
    fcl::collide<double>(&octree, fcl::Transform3d::Identity(), &probe, there, request, result);
    ASSERT_GE(result.numContacts(), 1u);
    EXPECT_EQ(result.getContact(0).b1, ocTreeCellId(octree, center));
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

// One bit of any number that makes a geometry makes it another one; a copy, and the bit put back, do not.
TEST(GeometryContent, SeesEveryNumber) {
  std::map<std::string, std::vector<double*>> numbers;
  forEachShape<double>([&](const std::string& name, const auto& shape) {
    using Shape = std::decay_t<decltype(*shape)>;
    auto& g = *shape;
    std::vector<double*>& all = numbers[name];
    const auto add = [&](auto& v) {
      for (int k = 0; k < 3; ++k) all.push_back(&v[k]);
    };
    if constexpr (std::is_same_v<Shape, fcl::Boxd>) add(g.side);
    if constexpr (std::is_same_v<Shape, fcl::Sphered>) all = {&g.radius};
    if constexpr (std::is_same_v<Shape, fcl::Capsuled> || std::is_same_v<Shape, fcl::Cylinderd> ||
                  std::is_same_v<Shape, fcl::Coned>) {
      all = {&g.radius, &g.lz};
    }
    if constexpr (std::is_same_v<Shape, fcl::Ellipsoidd>) add(g.radii);
    if constexpr (std::is_same_v<Shape, fcl::Convexd>) {
      for (const Vector3d& v : g.getVertices()) add(const_cast<Vector3d&>(v));
    }
    if constexpr (std::is_same_v<Shape, fcl::Halfspaced> || std::is_same_v<Shape, fcl::Planed>) {
      add(g.n);
      all.push_back(&g.d);
    }
    if constexpr (std::is_same_v<Shape, fcl::TrianglePd>) {
      add(g.a);
      add(g.b);
      add(g.c);
    }
    const GeometryContent content(g);
    EXPECT_TRUE(content.sameAs(g)) << name;
    if constexpr (!std::is_base_of_v<fcl::ShapeBase<double>, Shape> && !std::is_same_v<Shape, fcl::OcTreed>) {
      for (int i = 0; i < g.num_vertices; ++i) add(g.vertices[i]);
      for (int i = 0; i < g.num_tris; ++i) {
        const fcl::Triangle t = g.tri_indices[i];
        for (const auto& changed : {fcl::Triangle(t[0] + 1, t[1], t[2]), fcl::Triangle(t[0], t[1] + 1, t[2]),
                                    fcl::Triangle(t[0], t[1], t[2] + 1)}) {
          g.tri_indices[i] = changed;
          EXPECT_FALSE(content.sameAs(g)) << name << " triangle " << i;
        }
        g.tri_indices[i] = t;
      }
      --g.num_tris;
      EXPECT_FALSE(content.sameAs(g)) << name;
      ++g.num_tris;
    }
    for (double* x : all) {
      const double before = *x;
      *x = std::nextafter(before, 100.0);
      EXPECT_FALSE(content.sameAs(g)) << name << ' ' << before;
      *x = before;
    }
    EXPECT_TRUE(content.sameAs(g)) << name;
  });
  for (const auto& [name, all] : numbers) {
    if (name != "OcTree") EXPECT_FALSE(all.empty()) << name;
  }

  // Other types with the same numbers; a map's cells and threshold.
  EXPECT_FALSE(GeometryContent(fcl::Cylinderd(1, 2)).sameAs(fcl::Coned(1, 2)));
  EXPECT_FALSE(GeometryContent(fcl::Boxd(1, 2, 3)).sameAs(fcl::Ellipsoidd(1, 2, 3)));
  EXPECT_TRUE(GeometryContent(fcl::Boxd(1, 2, 3)).sameAs(fcl::Boxd(1, 2, 3)));
  const auto cells = map(0.125);
  fcl::OcTreed octree(cells);
  const GeometryContent content(octree);
  EXPECT_TRUE(content.sameAs(fcl::OcTreed(map(0.125))));
  EXPECT_FALSE(content.sameAs(fcl::OcTreed(map(0.0625))));
  octree.setOccupancyThres(0.9);
  EXPECT_FALSE(content.sameAs(octree));
  octree.setOccupancyThres(cells->getOccupancyThres());
  EXPECT_TRUE(content.sameAs(octree));
  cells->setNodeValue(octomap::point3d(5, 5, 5), -1.0f);  // free: none of the cells that count
  EXPECT_TRUE(content.sameAs(octree));
  cells->setNodeValue(octomap::point3d(5, 5, 5), 1.0f);
  EXPECT_FALSE(content.sameAs(octree));
}

TEST(RequireRigid, TakesWhatIsNextToARotation) {
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() = Eigen::AngleAxisd(uniform(random, 0, 3), unit(random)).toRotationMatrix();
    M.linear() += 1e-7 * Eigen::Matrix3d::Random();
    M.translation() = unit(random);
    const Eigen::Isometry3d rigid = requireRigid(M, "it");
    EXPECT_LE((rigid.linear().transpose() * rigid.linear() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LE((rigid.linear() - M.linear()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(rigid.translation(), M.translation());
  }
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.linear()(0, 0) = 1 + 1e-6;
  const std::string text = refusal([&] { requireRigid(M, "the first body"); });
  EXPECT_TRUE(contains(text, "the first body") && contains(text, "orthonormal")) << text;
  M = Eigen::Isometry3d::Identity();
  M.translation()[1] = NAN;
  EXPECT_TRUE(contains(refusal([&] { requireRigid(M, "it"); }), "finite"));
}

}  // namespace fcl_geometry_test
