// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/solid_space.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/closed_parts.h"
#include "geometry/mesh_triangle.h"
#include "geometry/shape_tree.h"
#include "numerics/baseline_isa.h"

#include "convex/cloud.h"

namespace fcl_artic {
namespace {

using Eigen::Vector3d;
using engine::ContainmentVerdict;
using engine::Node;
using engine::PairPose;
using engine::Piece;
using engine::PieceKind;

/// Number of points near the given one that are tried along each axis. A line through one of them meets an edge, within
/// the precision of doubles, by bad luck only.
constexpr int kTrials = 8;

/// Approximately the nearest point of an edge.
Vector3d nearestOfEdge(const Vector3d& a, const Vector3d& b, const Vector3d& x) {
  const Vector3d along = b - a;
  const double square = along.squaredNorm();
  return square > 0 ? Vector3d(a + std::clamp((x - a).dot(along) / square, 0.0, 1.0) * along) : a;
}

/// Lower bound of x's distance from a triangle. If x is near, the direction to the nearest point is known badly, so the
/// normal is tried. If the triangle has hardly any area, the nearest point is known badly too, so the edges' nearest
/// points are tried. Any direction gives a lower bound.
double surelyApart(const MeshTriangle& t, const Vector3d& x, Vector3d& nearest) {
  nearest = nearestPoint(t, x);
  double most = clearanceOf(t, x, nearest);
  if (most > 0.9 * (nearest - x).norm()) return most;
  const Vector3d normal = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]);
  most = std::max({most, clearanceAlong(t, x, normal), clearanceAlong(t, x, -normal)});
  for (int i = 0; i < 3; ++i) {
    const Vector3d y = nearestOfEdge(t.corner[i], t.corner[(i + 1) % 3], x);
    const double clearance = clearanceOf(t, x, y);
    if (clearance <= most) continue;
    most = clearance;
    nearest = y;
  }
  return most;
}

/// A vector of some length up to 1. No face of a mesh that people made is likely to have its direction.
Vector3d someDirection(std::uint32_t number) {
  Vector3d d;
  std::uint32_t bits = number * 2654435761u + 12345u;
  for (int k = 0; k < 3; ++k) {
    bits ^= bits << 13;
    bits ^= bits >> 17;
    bits ^= bits << 5;
    d[k] = (static_cast<double>(bits) * 0x1p-31 - 1) * 0.577;
  }
  return d;
}

}  // namespace

double SolidSpace::clearance(const Vector3d& x, Vector3d& nearest) const {
  const auto clearance = [&](std::int32_t piece, Vector3d& point) {
    return surelyApart(triangleOf(mesh_, piece), x, point);
  };
  return leastClearance(mesh_, x, clearance, nearest);
}

SolidSpace::Winding SolidSpace::winding(const Vector3d& x, int axis) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int above = 0, all = 0;
  std::int32_t open[64];
  std::size_t count = 0;
  open[count++] = 0;
  while (count) {
    const Node& node = mesh_.nodes[open[--count]];
    if (x[u] < node.lo[u] || x[u] > node.hi[u] || x[v] < node.lo[v] || x[v] > node.hi[v]) continue;
    if (!node.isLeaf()) {
      open[count++] = node.left();
      open[count++] = node.right();
      continue;
    }
    const MeshTriangle t = triangleOf(mesh_, node.piece());
    if (t.corner[0] == t.corner[1] || t.corner[1] == t.corner[2] || t.corner[2] == t.corner[0]) continue;
    LineCrossing crossing;
    const Crosses answer = crosses(t, x, axis, crossing);
    if (answer == Crosses::no) continue;
    if (answer == Crosses::unknown || !crossing.certain) return {};
    all += crossing.direction;
    if (crossing.height > 0) above += crossing.direction;
  }
  // A line crosses a closed surface as often up as down.
  return {all == 0, above};
}

SolidSpace::Side SolidSpace::sideOf(const Vector3d& x, double error, Vector3d& nearest) const {
  const Node& root = mesh_.nodes[0];
  if (clearanceOf(root, x) > error) return Side::outside;
  const double clearance = this->clearance(x, nearest);
  // All points nearer to x than the clearance are on one side of the surface. So is the point that x stands for,
  // `error` away.
  const double room = clearance - error;
  if (!(room > 64 * kMeshUlp * x.norm())) return Side::unknown;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector3d y = x + 0.5 * room * someDirection(static_cast<std::uint32_t>(trial));
    for (int axis = 0; axis < 3; ++axis) {
      const Winding around = winding(y, axis);
      if (around.known) return around.number ? Side::inside : Side::outside;
    }
  }
  return Side::unknown;
}

SurfacePoints::SurfacePoints(const engine::TreeView& tree) {
  if (tree.num_pieces == 0 || !(tree.nodes[0].radius < engine::kUnbounded)) return;
  std::vector<bool> begun;
  // Points far from each other: if one of them is too near the other surface, another one may not be.
  const auto add = [&](std::size_t number, const Vector3d& x) {
    static const Vector3d kWays[kPerPart] = {{1, 0.6, 0.3}, {-1, -0.6, -0.3}, {-0.5, 0.9, -0.8}, {0.5, -0.9, 0.8}};
    Part& part = parts_[number];
    for (std::size_t k = 0; k < kPerPart; ++k) {
      if (!begun[number] || x.dot(kWays[k]) > part.points[k].dot(kWays[k])) part.points[k] = x;
    }
    begun[number] = true;
  };
  if (tree.pieces[0].kind == PieceKind::vertices) {
    const ConnectedParts connected = findConnectedParts(tree);
    parts_.resize(static_cast<std::size_t>(connected.count));
    begun.assign(parts_.size(), false);
    for (std::int32_t i = 0; i < tree.num_pieces; ++i) {
      const auto number = static_cast<std::size_t>(connected.part_of_piece[static_cast<std::size_t>(i)]);
      for (const Vector3d& corner : triangleOf(tree, i).corner) add(number, corner);
    }
  } else {
    static const Vector3d kPlaces[kPerPart] = {{0, 0, 0}, {0.1, 0.2, 0.3}, {-0.3, 0.1, -0.2}, {0.2, -0.3, -0.4}};
    parts_.resize(static_cast<std::size_t>(tree.num_pieces));
    begun.assign(parts_.size(), false);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      baseline::PieceRoom room;
      const Piece& piece = baseline::pieceOf(tree, static_cast<int>(i), room);
      if (piece.kind == PieceKind::hull) {
        baseline::coverCore(tree, piece, [&](double x, double y, double z) { add(i, {x, y, z}); });
      } else {
        for (std::size_t k = 0; k < kPerPart; ++k)
          baseline::pointWithin(tree, piece, baseline::Vec3(kPlaces[k].data())).store(parts_[i].points[k].data());
      }
    }
  }
  std::vector<BoxBounds> boxes(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (int k = 0; k < 3; ++k) boxes[i].lo[k] = boxes[i].hi[k] = parts_[i].points[0][k];
  }
  tree_ = buildBoxTree(boxes);
}

namespace {

/// One body's points as seen from the other, in the other's tree frame, up to an error.
class SeenPoints {
 public:
  /// @param inverse  points of A seen from B.
  SeenPoints(const PairPose& pose, bool inverse) : inverse_(inverse), error_(pose.error) {
    R_ = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.R);
    c_ = Vector3d::Map(pose.c);
  }
  Vector3d point(const Vector3d& p, double& error) const {
    if (!inverse_) {
      error = error_;
      return R_ * p + c_;
    }
    // Rigid motions keep distances, so the error of y is that of its image R y + c, which is known up to error_, from
    // p.
    Vector3d y = R_.transpose() * (p - c_);
    error = error_ + (R_ * y + c_ - p).norm() * (1 + 1e-9);
    return y;
  }
  /// A direction in the other body's frame, turned back into the points' own tree frame.
  Vector3d back(const Vector3d& d) const { return inverse_ ? Vector3d(R_ * d) : Vector3d(R_.transpose() * d); }

 private:
  bool inverse_;
  double error_;
  Eigen::Matrix3d R_;
  Vector3d c_;
};

/// Parts of one body whose first points may lie in the box of a solid that they are seen from.
template <class F>
void forPartsWithin(const SurfacePoints& points, const engine::TreeView& solid, const SeenPoints& seen,
                    const F& visit) {
  const std::vector<Node>& tree = points.tree();
  if (tree.empty()) return;
  const Node& root = solid.nodes[0];
  std::int32_t open[64];
  std::size_t count = 0;
  open[count++] = 0;
  while (count) {
    const Node& node = tree[static_cast<std::size_t>(open[--count])];
    const Vector3d lo = Eigen::Vector3f::Map(node.lo).cast<double>(), hi = Eigen::Vector3f::Map(node.hi).cast<double>();
    double error;
    const Vector3d middle = seen.point(0.5 * (lo + hi), error);
    // A ball around the node's box. Most bodies have few parts, so it need not be tight.
    const double reach = static_cast<double>(node.radius) * (1 + 1e-9) + error;
    bool apart = false;
    for (int k = 0; k < 3; ++k) apart = apart || middle[k] - reach > root.hi[k] || middle[k] + reach < root.lo[k];
    if (apart) continue;
    if (node.isLeaf()) {
      if (visit(points.parts()[static_cast<std::size_t>(node.piece())])) return;
      continue;
    }
    open[count++] = node.left();
    open[count++] = node.right();
  }
}

/// Parts of the one body within the other, a solid.
/// @param of_b  the parts are B's and the solid is A.
void partsWithin(const SurfacePoints& points, const engine::Body& solid, const PairPose& pose, bool of_b,
                 ContainmentVerdict& found) {
  const SeenPoints seen(pose, !of_b);
  forPartsWithin(points, *solid.tree, seen, [&](const SurfacePoints::Part& part) {
    for (const Vector3d& p : part.points) {
      double error;
      Vector3d nearest;
      const Vector3d x = seen.point(p, error);
      const SolidSpace::Side side = solid.space->sideOf(x, error, nearest);
      if (side == SolidSpace::Side::unknown) continue;
      if (side == SolidSpace::Side::outside) return false;
      // The shortest way out for a part of B is away from A.
      Vector3d out = nearest - x;
      out = out.norm() > kLeastMeshLength ? Vector3d(out.normalized()) : Vector3d::UnitZ();
      Vector3d::Map(found.point) = of_b ? x : p;
      Vector3d::Map(found.normal) = of_b ? out : Vector3d(-seen.back(out));
      found.verdict = ContainmentVerdict::kCertain;
      return true;
    }
    if (found.verdict == ContainmentVerdict::kNone) {
      found.verdict = ContainmentVerdict::kPossible;
      double error;
      const Vector3d x = seen.point(part.points[0], error);
      Vector3d::Map(found.point) = of_b ? x : part.points[0];
      Vector3d::Map(found.normal) = Vector3d::UnitZ();
    }
    return false;
  });
}

}  // namespace

void findContained(const engine::Body& a, const engine::Body& b, const PairPose& pose, ContainmentVerdict& found) {
  found.verdict = ContainmentVerdict::kNone;
  if (a.space && b.points) partsWithin(*b.points, a, pose, true, found);
  if (found.verdict != ContainmentVerdict::kCertain && b.space && a.points)
    partsWithin(*a.points, b, pose, false, found);
}

}  // namespace fcl_artic
