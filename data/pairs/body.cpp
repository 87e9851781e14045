// SPDX-License-Identifier: BSD-3-Clause
#include "pairs/body.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

#include "pairs/constants.h"

namespace pairs {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

/// Faces of the hull of points in general position, all of them its corners: the triangles with everything on one side.
Triangles hullOf(const std::vector<Vec3>& points) {
  Triangles faces;
  const int n = static_cast<int>(points.size());
  const auto at = [&](int i) -> const Vec3& { return points[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        const Vec3 normal = (at(j) - at(i)).cross(at(k) - at(i));
        int before = 0, behind = 0;
        for (int m = 0; m < n; ++m) {
          if (m == i || m == j || m == k) continue;
          (normal.dot(at(m) - at(i)) > 0 ? before : behind) += 1;
        }
        if (before == 0) faces.push_back({i, j, k});
        if (behind == 0) faces.push_back({i, k, j});
      }
    }
  }
  return faces;
}

std::shared_ptr<fcl::CollisionGeometryd> fclShape(const Body& b) {
  const Vec3& h = b.half;
  switch (b.kind) {
    case Kind::box:
      return std::make_shared<fcl::Boxd>(2 * h.x(), 2 * h.y(), 2 * h.z());
    case Kind::sphere:
      return std::make_shared<fcl::Sphered>(b.radius);
    case Kind::capsule:
      return std::make_shared<fcl::Capsuled>(b.radius, 2 * h.z());
    case Kind::cylinder:
      return std::make_shared<fcl::Cylinderd>(h.x(), 2 * h.z());
    case Kind::cone:
      return std::make_shared<fcl::Coned>(h.x(), 2 * h.z());
    case Kind::ellipsoid:
      return std::make_shared<fcl::Ellipsoidd>(h.x(), h.y(), h.z());
    case Kind::convex: {
      auto faces = std::make_shared<std::vector<int>>();
      const Triangles triangles = hullOf(b.vertices);
      for (const auto& t : triangles) faces->insert(faces->end(), {3, t[0], t[1], t[2]});
      return std::make_shared<fcl::Convexd>(std::make_shared<const std::vector<fcl::Vector3d>>(b.vertices),
                                            static_cast<int>(triangles.size()), faces, true);
    }
    case Kind::triangle:
      return std::make_shared<fcl::TrianglePd>(b.vertices[0], b.vertices[1], b.vertices[2]);
    case Kind::halfspace:
      return std::make_shared<fcl::Halfspaced>(b.normal, b.offset);
    case Kind::plane:
      return std::make_shared<fcl::Planed>(b.normal, b.offset);
    case Kind::mesh:
      break;
  }
  return nullptr;
}

double reachOf(const Body& b) {
  double core = 0;
  switch (b.kind) {
    case Kind::box:
      core = b.half.norm();
      break;
    case Kind::capsule:
      core = b.half.z();
      break;
    case Kind::cylinder:
    case Kind::cone:
      core = std::hypot(b.half.x(), b.half.z());
      break;
    case Kind::ellipsoid:
      core = b.half.maxCoeff();
      break;
    default:
      for (const Vec3& v : b.vertices) core = std::max(core, v.norm());
  }
  return (core + b.radius) * (1 + 1e-14);
}

void split(Body& body, int node, std::vector<int>& order, int begin, int end) {
  const auto corner = [&](int t, int k) -> const Vec3& {
    return body
        .vertices[static_cast<std::size_t>(body.triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)])];
  };
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (int i = begin; i < end; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& v = corner(order[static_cast<std::size_t>(i)], k);
      low = low.cwiseMin(v), high = high.cwiseMax(v);
    }
  }
  const Vec3 half = (high - low) / 2;
  body.nodes[static_cast<std::size_t>(node)] = {(low + high) / 2, half + Vec3::Constant(1e-13), -1,
                                                order[static_cast<std::size_t>(begin)]};
  if (end - begin == 1) return;
  int axis;
  half.maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int s, int t) {
    return corner(s, 0)[axis] + corner(s, 1)[axis] + corner(s, 2)[axis] <
           corner(t, 0)[axis] + corner(t, 1)[axis] + corner(t, 2)[axis];
  });
  const int left = static_cast<int>(body.nodes.size());
  body.nodes[static_cast<std::size_t>(node)].left = left;
  body.nodes.resize(body.nodes.size() + 2);
  split(body, left, order, begin, middle);
  split(body, left + 1, order, middle, end);
}

/// A surface over a grid of rows and columns, f(row in [0, 1], angle): closed like a ring, or between two poles.
template <class F>
void revolve(int rows, int columns, bool ring, F f, std::vector<Vec3>& v, Triangles& t) {
  const auto point = [&](int r, int c) { return f(static_cast<double>(r) / rows, 2 * kPi * c / columns); };
  if (!ring) v.push_back(point(0, 0));
  for (int r = ring ? 0 : 1; r < rows; ++r)
    for (int c = 0; c < columns; ++c) v.push_back(point(r, c));
  const auto id = [&](int r, int c) { return (ring ? r % rows * columns : 1 + (r - 1) * columns) + c % columns; };
  for (int r = ring ? 0 : 1; r < (ring ? rows : rows - 1); ++r) {
    for (int c = 0; c < columns; ++c) {
      t.push_back({id(r, c), id(r + 1, c), id(r + 1, c + 1)});
      t.push_back({id(r, c), id(r + 1, c + 1), id(r, c + 1)});
    }
  }
  if (ring) return;
  v.push_back(point(rows, 0));
  const int last = static_cast<int>(v.size()) - 1;
  for (int c = 0; c < columns; ++c) {
    t.push_back({0, id(1, c), id(1, c + 1)});
    t.push_back({last, id(rows - 1, c + 1), id(rows - 1, c)});
  }
}

/// The six sides of a box, n x n cells each, corners moved a little. Sides share no vertices.
void noisyBox(const Vec3& half, int n, double noise, Random& random, std::vector<Vec3>& v, Triangles& t) {
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, first = static_cast<int>(v.size());
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        Vec3 x;
        x[axis] = side % 2 ? half[axis] : -half[axis];
        x[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * i / n - 1);
        x[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * j / n - 1);
        v.push_back(x + random.vector(0, noise));
      }
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const int a = first + i * (n + 1) + j;
        t.push_back({a, a + n + 1, a + n + 2});
        t.push_back({a, a + n + 2, a + 1});
      }
    }
  }
}

}  // namespace

const char* kindName(Kind kind) {
  static constexpr const char* kNames[] = {"Box",    "Sphere",   "Capsule",   "Cylinder", "Cone", "Ellipsoid",
                                           "Convex", "Triangle", "Halfspace", "Plane",    "Mesh"};
  return kNames[static_cast<int>(kind)];
}

BodyPtr randomShape(Kind kind, Random& random) {
  constexpr double kLeast = 0.1, kMost = 0.6;
  const auto size = [&] { return random.uniform(kLeast, kMost); };
  auto body = std::make_shared<Body>();
  body->kind = kind;
  Vec3& h = body->half;
  switch (kind) {
    case Kind::box:
    case Kind::ellipsoid:
      for (int k = 0; k < 3; ++k) h[k] = size();
      break;
    case Kind::sphere:
      body->radius = size();
      break;
    case Kind::capsule:
      body->radius = random.uniform(kLeast, kMost / 2);
      h.z() = size();
      break;
    case Kind::cylinder:
    case Kind::cone:
      h.x() = h.y() = size();
      h.z() = size();
      break;
    case Kind::convex:
      for (int k = 0; k < 3; ++k) h[k] = size();
      for (int i = 0; i < 20; ++i) body->vertices.push_back(h.cwiseProduct(random.direction()));
      break;
    case Kind::triangle:
      for (int i = 0; i < 3; ++i) body->vertices.push_back(random.vector(kLeast, kMost));
      break;
    case Kind::halfspace:
    case Kind::plane:
      body->normal = random.direction();
      body->offset = random.uniform(-0.5, 0.5);
      break;
    case Kind::mesh:
      return randomMesh(Volume::obbrss, random);
  }
  body->geometry = fclShape(*body);
  body->geometry->computeLocalAABB();
  if (body->unbounded()) {  // FCL makes the normal a unit one once more
    const auto read = [&](const auto& g) { body->normal = g.n, body->offset = g.d; };
    if (kind == Kind::halfspace)
      read(static_cast<const fcl::Halfspaced&>(*body->geometry));
    else
      read(static_cast<const fcl::Planed&>(*body->geometry));
  } else {
    body->reach = reachOf(*body);
  }
  return body;
}

BodyPtr makeMesh(std::vector<Vec3> vertices, Triangles triangles, Volume volume) {
  auto body = std::make_shared<Body>();
  body->kind = Kind::mesh;
  body->vertices = std::move(vertices);
  body->triangles = std::move(triangles);
  body->geometry = makeFclMesh(body->vertices, body->triangles, volume);
  body->reach = reachOf(*body);
  std::vector<int> order(body->triangles.size());
  std::iota(order.begin(), order.end(), 0);
  body->nodes.resize(1);
  split(*body, 0, order, 0, static_cast<int>(order.size()));
  return body;
}

BodyPtr randomMesh(Volume volume, Random& random) {
  std::vector<Vec3> v;
  Triangles t;
  const double size = random.uniform(0.2, 0.8), wanted = random.logUniform(12, 2000);
  switch (random.below(8)) {
    case 0:
    case 1: {  // a ring of 2 rows x columns triangles
      const double thick = random.uniform(0.2, 0.45);
      const int rows = std::max(3, static_cast<int>(std::sqrt(wanted / 4)));
      const int columns = std::max(3, static_cast<int>(wanted / (2 * rows)));
      revolve(
          rows, columns, true,
          [&](double s, double a) {
            const double r = size / 2 * (1 - thick / 2 + thick / 2 * std::cos(2 * kPi * s));
            return Vec3(r * std::cos(a), r * std::sin(a), size / 2 * thick / 2 * std::sin(2 * kPi * s));
          },
          v, t);
      break;
    }
    case 2:
    case 3: {
      const int n = std::max(1, static_cast<int>(std::sqrt(wanted / 12)));
      Vec3 half;
      for (int k = 0; k < 3; ++k) half[k] = size / 2 * random.uniform(0.3, 1);
      noisyBox(half, n, random.chance(0.5) ? 0 : 0.1 * size / n, random, v, t);
      break;
    }
    case 4: {  // loose triangles, slivers among them
      const int n = static_cast<int>(wanted);
      for (int i = 0; i < n; ++i) {
        const Vec3 c = random.vector(0, size / 2), u = random.direction();
        const Vec3 w = u.cross(random.direction()).normalized();
        const double a = size * random.uniform(0.05, 0.3), b = a * random.logUniform(0.02, 1), s = random.unit();
        v.insert(v.end(), {c, c + a * u, c + s * a * u + b * w});
        t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
      break;
    }
    default: {  // 2 columns x (rows - 1) triangles
      std::array<Vec3, 4> wave;
      for (Vec3& w : wave) w = random.vector(1, 6);
      const double bumps = random.uniform(0, 0.12);
      Vec3 half;
      for (int k = 0; k < 3; ++k) half[k] = size / 2 * random.uniform(0.4, 1);
      const int rows = std::max(3, static_cast<int>(std::sqrt(wanted / 2)));
      const int columns = std::max(3, static_cast<int>(wanted / (2 * (rows - 1))));
      revolve(
          rows, columns, false,
          [&](double s, double a) {
            const Vec3 d(std::sin(kPi * s) * std::cos(a), std::sin(kPi * s) * std::sin(a), std::cos(kPi * s));
            double r = 1;
            for (const Vec3& w : wave) r += bumps * std::sin(w.dot(d));
            return Vec3(r * d.cwiseProduct(half));
          },
          v, t);
    }
  }
  return makeMesh(std::move(v), std::move(t), volume);
}

}  // namespace pairs
