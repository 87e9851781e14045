// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>

#include "detail.h"
#include "fcl_artic/solid_mesh.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "meshes/readers.h"
#include "meshes/text.h"

namespace fcl_artic {
namespace detail {
namespace {

void requireLength(double value, const std::string& what, const std::string& where) {
  if (!(value > 0 && std::isfinite(value))) fail(where, what + " " + text(value) + " is not a positive length");
}

/// No area beyond the rounding of its own edges.
bool isDegenerate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a;
  return !(u.cross(v).norm() > 8 * std::numeric_limits<double>::epsilon() * u.norm() * v.norm());
}

/// Drops the vertices that no triangle uses, as FCL takes all of them for the box around a mesh.
/// @return how many those are.
std::size_t keepUsed(std::vector<Eigen::Vector3d>& vertices, std::vector<fcl::Triangle>& triangles) {
  constexpr std::size_t kUnused = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> number(vertices.size(), kUnused);
  for (const fcl::Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) number[triangle[k]] = 0;
  }
  std::size_t used = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] == kUnused) continue;
    vertices[used] = vertices[v];
    number[v] = used++;
  }
  const std::size_t unused = vertices.size() - used;
  vertices.resize(used);
  for (fcl::Triangle& triangle : triangles) {
    triangle.set(number[triangle[0]], number[triangle[1]], number[triangle[2]]);
  }
  return unused;
}

using Place = std::array<double, 3>;
using Segment = std::array<Place, 2>;  ///< The smaller end first; a point has both ends in one place.

Segment segmentOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Place p{a[0] + 0.0, a[1] + 0.0, a[2] + 0.0}, q{b[0] + 0.0, b[1] + 0.0, b[2] + 0.0};  // -0 becomes 0
  return {std::min(p, q), std::max(p, q)};
}

/// Drops triangles that are a segment or a point, as two of their corners are in one place. Each must be an edge or a
/// corner of a triangle that stays. Nothing of the surface is lost. @return how many.
std::size_t dropCovered(const std::vector<Eigen::Vector3d>& vertices, std::vector<fcl::Triangle>& triangles) {
  const auto corner = [&](const fcl::Triangle& t, int k) -> const Eigen::Vector3d& { return vertices[t[k % 3]]; };
  // The corner before the two that are in one place; 3 for other triangles.
  const auto apexOf = [&](const fcl::Triangle& t) {
    int k = 0;
    while (k < 3 && corner(t, k + 1) != corner(t, k + 2)) ++k;
    return k;
  };
  const auto isSegment = [&](const fcl::Triangle& t) { return apexOf(t) < 3; };
  if (std::none_of(triangles.begin(), triangles.end(), isSegment)) return 0;
  std::set<Segment> kept;
  const auto keep = [&](const fcl::Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      kept.insert(segmentOf(corner(t, k), corner(t, k)));
      kept.insert(segmentOf(corner(t, k), corner(t, k + 1)));
    }
  };
  for (const fcl::Triangle& t : triangles) {
    if (!isSegment(t)) keep(t);
  }
  const auto isCovered = [&](const fcl::Triangle& t) {
    const int k = apexOf(t);
    if (k == 3) return false;
    if (kept.count(segmentOf(corner(t, k), corner(t, k + 1)))) return true;
    keep(t);
    return false;
  };
  const auto last =
      std::stable_partition(triangles.begin(), triangles.end(), [&](const fcl::Triangle& t) { return !isCovered(t); });
  const auto dropped = static_cast<std::size_t>(triangles.end() - last);
  triangles.erase(last, triangles.end());
  return dropped;
}

}  // namespace

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

GeometryPtr makeBox(const Eigen::Vector3d& size, const std::string& where) {
  for (const double length : size) requireLength(length, "box size", where);
  return std::make_shared<fcl::Boxd>(size);
}

GeometryPtr makeSphere(double radius, const std::string& where) {
  requireLength(radius, "sphere radius", where);
  return std::make_shared<fcl::Sphered>(radius);
}

GeometryPtr makeCylinder(double radius, double length, const std::string& where) {
  requireLength(radius, "cylinder radius", where);
  requireLength(length, "cylinder length", where);
  return std::make_shared<fcl::Cylinderd>(radius, length);
}

GeometryPtr makeCone(double radius, double length, const std::string& where) {
  requireLength(radius, "cone radius", where);
  requireLength(length, "cone length", where);
  return std::make_shared<fcl::Coned>(radius, length);
}

GeometryPtr makeMesh(std::vector<Eigen::Vector3d> vertices, std::vector<fcl::Triangle> triangles,
                     const std::string& where, std::vector<std::string>* notes, bool solid) {
  if (triangles.empty()) fail(where, "has no triangles");
  const auto noteLeftOut = [&](std::size_t count, std::size_t all, const std::string& what) {
    if (notes && count > 0) {
      notes->push_back(where + ": " + std::to_string(count) + " of " + std::to_string(all) + " " + what + " left out");
    }
  };
  bool has_area = false;
  for (const fcl::Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= vertices.size()) {
        fail(where,
             "has a triangle with vertex " + std::to_string(triangle[k]) + " of " + std::to_string(vertices.size()));
      }
      if (!vertices[triangle[k]].allFinite()) {
        fail(where, "vertex " + std::to_string(triangle[k]) + " is not finite");
      }
    }
    has_area = has_area || !isDegenerate(vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]);
  }
  if (!has_area) fail(where, "has no triangle with an area");
  const std::size_t all_vertices = vertices.size(), all_triangles = triangles.size();
  noteLeftOut(keepUsed(vertices, triangles), all_vertices, "vertices belong to no triangle and were");
  if (!solid) {
    noteLeftOut(dropCovered(vertices, triangles), all_triangles,
                "triangles have no area, lie on edges of others and were");
  }
  keepUsed(vertices, triangles);
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  bool built =
      model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size())) == fcl::BVH_OK &&
      model->addSubModel(vertices, triangles) == fcl::BVH_OK;
  // Freed here: FCL has copies, and needs much memory for its tree.
  vertices = {};
  triangles = {};
  built = built && model->endModel() == fcl::BVH_OK;
  if (!built) fail(where, "FCL cannot build its tree");
  model->computeLocalAABB();
  if (!solid) return model;
  try {
    return makeSolid(*model);
  } catch (const std::invalid_argument& error) {
    fail(where, error.what());
  }
}

}  // namespace detail

namespace {

/// @throws std::runtime_error naming the source.
meshes::TriangleSoup readMesh(const meshes::Source& source, bool turn, bool import_meshes) {
  const std::string ending = detail::endingOf(source.path);
  if (ending == ".stl") return meshes::readStl(source);
  if (ending == ".obj") return meshes::readObj(source);
  if (ending == ".ply") return meshes::readPly(source);
  if (ending == ".off") return meshes::readOff(source);
  if (ending == ".dae") return meshes::readCollada(source, turn);
  if (ending == ".gltf" || ending == ".glb") return meshes::readGltf(source, turn);
  if (import_meshes) return detail::importMesh(source, ending);
  source.refuse(
      "its name ends in '" + ending +
      "': meshes are read from .stl, .obj, .ply, .off, .dae, .gltf and .glb, others by assimp if that is asked "
      "for (--import, option import_meshes)");
}

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> loadMesh(const std::string& path, const Eigen::Vector3d& scale,
                                                  std::vector<std::string>* notes, bool solid, bool collada_up_axis,
                                                  bool import_meshes) {
  const std::string where = "mesh '" + path + "'";
  if (!scale.allFinite() || (scale.array() == 0).any()) {
    detail::fail(where, "its scale has an entry that is zero or not finite");
  }
  if (std::error_code error; !std::filesystem::exists(path, error)) detail::fail(where, "no such file");

  const std::string content = files::read(path);
  const meshes::Source source{path, content, where, notes};
  meshes::TriangleSoup soup = readMesh(source, collada_up_axis, import_meshes);
  soup.noteSkipped(source);
  meshes::noteComments(source);
  for (Eigen::Vector3d& x : soup.vertices) x = x.cwiseProduct(scale);
  return detail::makeMesh(std::move(soup.vertices), std::move(soup.triangles), where, notes, solid);
}

}  // namespace fcl_artic
