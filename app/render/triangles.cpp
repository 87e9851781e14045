// SPDX-License-Identifier: BSD-3-Clause
#include "triangles.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

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
#include "fcl_artic/point_cloud.h"
#include "kinematics/angles.h"
#if FCL_HAVE_OCTOMAP
#include <fcl/geometry/octree/octree.h>
#endif

namespace fcl_artic::render {
namespace {

using Eigen::Vector3d;

constexpr int kSectors = 64;            // around an axis
constexpr int kRings = 16;              // pole to equator
constexpr double kPlaneHalfWidth = 10;  // m

template <typename BV>
Triangles fromMesh(const fcl::CollisionGeometryd& geometry) {
  const auto& mesh = static_cast<const fcl::BVHModel<BV>&>(geometry);
  Triangles out;
  out.vertices.assign(mesh.vertices, mesh.vertices + mesh.num_vertices);
  out.faces.reserve(static_cast<std::size_t>(mesh.num_tris));
  for (int i = 0; i < mesh.num_tris; ++i) {
    const fcl::Triangle& t = mesh.tri_indices[i];
    out.faces.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  }
  return out;
}

void addBox(Triangles& out, const Vector3d& center, const Vector3d& size) {
  const int base = static_cast<int>(out.vertices.size());
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    out.vertices.push_back(center + 0.5 * sign.cwiseProduct(size));
  }
  static constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : kQuads) {
    out.faces.push_back({base + q[0], base + q[1], base + q[2]});
    out.faces.push_back({base + q[0], base + q[2], base + q[3]});
  }
}

/// Each point as an octahedron, as much as a few pixels show.
Triangles octahedra(const PointCloud& cloud) {
  Triangles out;
  for (std::size_t i = 0; i < cloud.points().size(); ++i) {
    const int base = static_cast<int>(out.vertices.size());
    for (int k = 0; k < 3; ++k) {
      for (const double sign : {-1.0, 1.0})
        out.vertices.push_back(cloud.points()[i] + sign * cloud.radius(i) * Vector3d::Unit(k));
    }
    for (int octant = 0; octant < 8; ++octant) {
      const std::array<int, 3> face{base + (octant & 1), base + 2 + (octant >> 1 & 1), base + 4 + (octant >> 2 & 1)};
      const bool inside_out = (octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1) != 1 && octant != 7;
      out.faces.push_back(inside_out ? std::array<int, 3>{face[0], face[2], face[1]} : face);
    }
  }
  return out;
}

/// A point of a profile that is turned about the z axis.
struct ProfilePoint {
  double radius, z;
};

/// Surface of revolution of a profile that runs from the lower to the upper pole.
Triangles turned(const std::vector<ProfilePoint>& profile) {
  Triangles out;
  for (const ProfilePoint& p : profile) {
    for (int s = 0; s < kSectors; ++s) {
      const double angle = 2 * kPi * s / kSectors;
      out.vertices.emplace_back(p.radius * std::cos(angle), p.radius * std::sin(angle), p.z);
    }
  }
  const auto at = [](std::size_t ring, int s) { return static_cast<int>(ring) * kSectors + s % kSectors; };
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (int s = 0; s < kSectors; ++s) {
      if (profile[ring].radius > 0) out.faces.push_back({at(ring, s), at(ring, s + 1), at(ring + 1, s + 1)});
      if (profile[ring + 1].radius > 0) out.faces.push_back({at(ring, s), at(ring + 1, s + 1), at(ring + 1, s)});
    }
  }
  return out;
}

/// Half circles of radius r, their centres half a length below and above the origin.
std::vector<ProfilePoint> capsuleProfile(double r, double half_length) {
  std::vector<ProfilePoint> profile;
  for (int side = -1; side <= 1; side += 2) {
    if (side > 0 && half_length == 0) profile.pop_back();  // the equator is one ring
    for (int i = 0; i <= kRings; ++i) {
      const double latitude = kPi / 2 * (side < 0 ? i - kRings : i) / kRings;
      const bool pole = i == (side < 0 ? 0 : kRings);
      profile.push_back({pole ? 0 : r * std::cos(latitude), side * half_length + r * std::sin(latitude)});
    }
  }
  return profile;
}

Triangles fromConvex(const fcl::Convexd& convex) {
  Triangles out;
  out.vertices = convex.getVertices();
  const std::vector<int>& code = convex.getFaces();
  std::size_t at = 0;
  for (int f = 0; f < convex.getFaceCount(); ++f) {
    const int n = code[at];
    for (int i = 2; i < n; ++i) {
      out.faces.push_back(
          {code[at + 1], code[at + static_cast<std::size_t>(i)], code[at + static_cast<std::size_t>(i) + 1]});
    }
    at += static_cast<std::size_t>(n) + 1;
  }
  return out;
}

Triangles planeSquare(const Vector3d& normal, double distance) {
  const Vector3d side = normal.unitOrthogonal(), other = normal.cross(side);
  const Vector3d center = distance * normal;
  Triangles out;
  for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    out.vertices.push_back(center + kPlaneHalfWidth * (a * side + b * other));
  }
  out.faces = {{0, 1, 2}, {0, 2, 3}};
  return out;
}

}  // namespace

Triangles triangulate(const fcl::CollisionGeometryd& geometry) {
  switch (geometry.getNodeType()) {
    case fcl::BV_AABB:
      return fromMesh<fcl::AABBd>(geometry);
    case fcl::BV_OBB:
      return fromMesh<fcl::OBBd>(geometry);
    case fcl::BV_RSS:
      return fromMesh<fcl::RSSd>(geometry);
    case fcl::BV_kIOS:
      return fromMesh<fcl::kIOSd>(geometry);
    case fcl::BV_OBBRSS:
      return fromMesh<fcl::OBBRSSd>(geometry);
    case fcl::BV_KDOP16:
      return fromMesh<fcl::KDOPd<16>>(geometry);
    case fcl::BV_KDOP18:
      return fromMesh<fcl::KDOPd<18>>(geometry);
    case fcl::BV_KDOP24:
      return fromMesh<fcl::KDOPd<24>>(geometry);
    case fcl::GEOM_BOX: {
      Triangles out;
      addBox(out, Vector3d::Zero(), static_cast<const fcl::Boxd&>(geometry).side);
      return out;
    }
    case fcl::GEOM_SPHERE:
      return turned(capsuleProfile(static_cast<const fcl::Sphered&>(geometry).radius, 0));
    case fcl::GEOM_ELLIPSOID: {
      Triangles out = turned(capsuleProfile(1, 0));
      for (Vector3d& v : out.vertices) v = v.cwiseProduct(static_cast<const fcl::Ellipsoidd&>(geometry).radii);
      return out;
    }
    case fcl::GEOM_CAPSULE: {
      const auto& c = static_cast<const fcl::Capsuled&>(geometry);
      return turned(capsuleProfile(c.radius, c.lz / 2));
    }
    case fcl::GEOM_CYLINDER: {
      const auto& c = static_cast<const fcl::Cylinderd&>(geometry);
      return turned({{0, -c.lz / 2}, {c.radius, -c.lz / 2}, {c.radius, c.lz / 2}, {0, c.lz / 2}});
    }
    case fcl::GEOM_CONE: {
      const auto& c = static_cast<const fcl::Coned&>(geometry);
      return turned({{0, -c.lz / 2}, {c.radius, -c.lz / 2}, {0, c.lz / 2}});
    }
    case fcl::GEOM_CONVEX:
      return fromConvex(static_cast<const fcl::Convexd&>(geometry));
    case fcl::GEOM_TRIANGLE: {
      const auto& t = static_cast<const fcl::TrianglePd&>(geometry);
      return {{t.a, t.b, t.c}, {{0, 1, 2}}};
    }
    case fcl::GEOM_PLANE: {
      const auto& p = static_cast<const fcl::Planed&>(geometry);
      return planeSquare(p.n, p.d);
    }
    case fcl::GEOM_HALFSPACE: {
      const auto& h = static_cast<const fcl::Halfspaced&>(geometry);
      return planeSquare(h.n, h.d);
    }
#if FCL_HAVE_OCTOMAP
    case fcl::GEOM_OCTREE: {
      Triangles out;
      const auto& tree = static_cast<const fcl::OcTreed&>(geometry);
      for (const auto& cell : tree.toBoxes()) {  // the occupied cells: x, y, z, size, ...
        addBox(out, {cell[0], cell[1], cell[2]}, Vector3d::Constant(cell[3]));
      }
      return out;
    }
#endif
    default:
      if (const auto* cloud = dynamic_cast<const PointCloud*>(&geometry)) return octahedra(*cloud);
      break;
  }
  throw std::invalid_argument("can't draw a geometry of FCL's node type " +
                              std::to_string(static_cast<int>(geometry.getNodeType())));
}

}  // namespace fcl_artic::render
