// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/collision_geometry.h>

#include "convex.h"

namespace campaign {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Rigid pose, kept apart from Eigen::Isometry3d so that nothing is shared with the library under test.
struct Pose {
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();

  Vec3 operator*(const Vec3& x) const { return R * x + p; }
  Pose operator*(const Pose& o) const { return {R * o.R, R * o.p + p}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

/// Rotation by `angle` (rad) about a unit axis.
Mat3 rotationAbout(const Vec3& axis, double angle);

/// A triangle mesh (a surface) or a solid box, cylinder or sphere in its own frame, as one convex piece for each
/// triangle or for the whole solid, under a tree of boxes; beside it the same thing as an FCL geometry.
class Geometry {
 public:
  enum class BV { obbrss, obb, aabb, rss };

  static std::shared_ptr<const Geometry> mesh(std::string name, std::vector<Vec3> vertices,
                                              std::vector<std::array<int, 3>> triangles, BV bv = BV::obbrss);
  static std::shared_ptr<const Geometry> box(const Vec3& sides);
  static std::shared_ptr<const Geometry> cylinder(double radius, double length);
  static std::shared_ptr<const Geometry> sphere(double radius);

  const std::string& name() const { return name_; }
  bool isMesh() const { return kind_ == Piece::triangle; }
  Piece::Kind kind() const { return kind_; }
  const Vec3& half() const { return half_; }  ///< half sides of a solid, a cylinder's along z
  BV volume() const { return volume_; }       ///< of a mesh for FCL
  int numPieces() const { return isMesh() ? static_cast<int>(triangles_.size()) : 1; }
  const std::vector<Vec3>& vertices() const { return vertices_; }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  /// Ball about `centre` in the geometry's frame that holds all of it.
  const Vec3& centre() const { return centre_; }
  double radius() const { return radius_; }
  /// The piece in the world, with the geometry's frame at M.
  Piece piece(int index, const Pose& M) const;
  /// A point of its surface, chosen by u, v, w in [0, 1).
  Vec3 surfacePoint(double u, double v, double w) const;
  const std::shared_ptr<fcl::CollisionGeometryd>& fclGeometry() const { return fcl_; }

  /// An oriented box around a part of the geometry.
  struct Node {
    Mat3 R;  ///< axes in the geometry's frame, one a column
    Vec3 centre, half;
    int left;   ///< children are left and left + 1; -1 for a leaf
    int piece;  ///< of a leaf
    double size;
  };
  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  Geometry() = default;
  void buildTree();
  void split(int node, std::vector<int>& order, int begin, int end);

  std::string name_;
  Piece::Kind kind_ = Piece::triangle;
  Vec3 half_ = Vec3::Zero();
  BV volume_ = BV::obbrss;
  std::vector<Vec3> vertices_;
  std::vector<std::array<int, 3>> triangles_;
  Vec3 centre_ = Vec3::Zero();
  double radius_ = 0;
  std::vector<Node> nodes_;
  std::shared_ptr<fcl::CollisionGeometryd> fcl_;
};

using GeometryPtr = std::shared_ptr<const Geometry>;

/// The same geometry for FCL. In a file of its own, as FCL's mesh headers are slow to compile.
std::shared_ptr<fcl::CollisionGeometryd> makeFclMesh(const std::vector<Vec3>& vertices,
                                                     const std::vector<std::array<int, 3>>& triangles, Geometry::BV bv);
std::shared_ptr<fcl::CollisionGeometryd> makeFclShape(Piece::Kind kind, const Vec3& half);

/// How two bodies stand to each other at one time.
struct Proximity {
  double gap = 0;         ///< lower bound on the distance less the margin, within the wanted share of it when positive
  double upper = 0;       ///< upper bound
  bool touching = false;  ///< they touch as far as doubles tell (meshes: exactly, for the rounded corners)
  bool clear = false;     ///< they touch also after any rounding of the poses
  int piece_a = 0, piece_b = 0;             ///< nearest pieces; a first guess for the next call
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();  ///< nearest points
  Vec3 direction = Vec3::Zero();            ///< unit, from A to B
};

/// What counts as a clear contact, in m. Poses of chains of up to 9 joints with a reach of a few metres carry errors of
/// some 1e-14 m; meshes have to cross through ten times that. Solids count where they are in each other by at least
/// `kClearSolids`, which doubles resolve a thousandfold.
constexpr double kClearMeshes = 1e-13;
constexpr double kClearSolids = 2e-11;

/// @param margin  bodies nearer than this touch (m)
/// @param wanted  share of the distance to which the gap is wanted
/// @param hint    pieces to look at first
Proximity proximity(const Geometry& A, const Pose& M_a, const Geometry& B, const Pose& M_b, double margin,
                    double wanted, const Proximity& hint);

/// Distance of x from the body (0 inside a solid).
double distanceTo(const Geometry& g, const Pose& M, const Vec3& x);
double distanceTo(const Geometry& g, int piece, const Pose& M, const Vec3& x);

}  // namespace campaign
