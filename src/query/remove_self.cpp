// SPDX-License-Identifier: BSD-3-Clause
//
// Points that a sensor has seen of the robot itself (doc/NUMERICS.md, "Points on the robot").
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "fcl/fcl_geometry.h"
#include "fcl_artic/manager.h"
#include "geometry/nearness.h"
#include "numerics/shown.h"
#include "query/manager_impl.h"
#include "threads/parallel.h"

namespace fcl_artic {
namespace {

using Eigen::Vector3d;

/// Points of one task, and of one box that is asked first: frames come row by row, so points of one lie side by side.
constexpr std::size_t kPointsOfTask = 4096, kPointsOfBlock = 128;

struct PointBox {
  Eigen::Array3d lo = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
  void add(const Vector3d& x) {  // passes NaN over
    lo = (x.array() < lo).select(x.array(), lo);
    hi = (x.array() > hi).select(x.array(), hi);
  }
  bool meets(const PointBox& other) const { return (lo <= other.hi).all() && (hi >= other.lo).all(); }
  bool holds(const Vector3d& x) const { return (x.array() >= lo).all() && (x.array() <= hi).all(); }  // false for NaN
};

/// A link's geometry, where it stands in the points' frame.
struct PlacedShape {
  PlacedShape(const ManagedBody& body, const Eigen::Isometry3d& pose, double error, double padding)
      : nearness(*body.shape), R(pose.linear().transpose()), t(pose.translation()) {
    // Nothing that is farther than the padding is within this: so the pose's error takes part of the padding.
    most = padding > 2 * error ? padding - error : padding;
    const Vector3d middle = 0.5 * (body.shape->lower() + body.shape->upper());
    const Vector3d half = 0.5 * (body.shape->upper() - body.shape->lower());
    const Eigen::Array3d reach = (pose.linear().cwiseAbs() * half).array() + padding + error;
    box.lo = (pose * middle).array() - reach;
    box.hi = (pose * middle).array() + reach;
  }
  bool isNear(const Vector3d& x, std::int32_t& leaf) const { return nearness.isNear(R * (x - t), most, leaf); }

  Nearness nearness;
  Eigen::Matrix3d R;
  Vector3d t;
  double most;
  PointBox box;
};

/// Bound on how far a link's geometry, as computed, is from where it stands. It is the error of the product of the
/// transforms on the way to it, two for each joint (RigidTransform), and of the numbers of a point that is near.
double errorOfPlace(const KinematicTree& tree, const std::vector<Eigen::Isometry3d>& M_0, const ManagedBody& body,
                    double frame_length, double padding) {
  double ulps = 256 + 2 * kTransformUlps;
  double length = frame_length + body.offset.length() + body.shape->view().extent + padding;
  for (LinkId link = body.link; tree.parentJoint(link) >= 0; link = tree.parentLink(link)) {
    const Vector3d& at = M_0[static_cast<std::size_t>(link)].translation();
    const Vector3d& parent = M_0[static_cast<std::size_t>(tree.parentLink(link))].translation();
    // A slide is no longer than the whole step and the joint's own place together.
    length += (at - parent).norm() + 2 * tree.joint(tree.parentJoint(link)).origin.translation().norm();
    ulps += 2 * kTransformUlps;
  }
  return 0x1p-52 * ulps * length;
}

/// Marks points of [begin, end).
void markNear(const std::vector<PlacedShape>& shapes, const std::vector<Vector3d>& points, std::size_t begin,
              std::size_t end, std::vector<std::uint8_t>& marks) {
  std::vector<std::int32_t> leaves(shapes.size(), -1);  // that were near the last point
  std::vector<std::size_t> open;                        // shapes, the one that was near last first
  for (std::size_t block = begin; block < end; block += kPointsOfBlock) {
    const std::size_t last = std::min(end, block + kPointsOfBlock);
    PointBox around;
    for (std::size_t i = block; i < last; ++i) around.add(points[i]);
    open.clear();
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      if (shapes[s].box.meets(around)) open.push_back(s);
    }
    if (open.empty()) continue;
    for (std::size_t i = block; i < last; ++i) {
      for (std::size_t& s : open) {
        if (!shapes[s].box.holds(points[i]) || !shapes[s].isNear(points[i], leaves[s])) continue;
        marks[i] = 1;
        std::swap(s, open[0]);
        break;
      }
    }
  }
}

}  // namespace

std::vector<std::uint8_t> ArticulatedCollisionManager::pointsOnSelf(const std::vector<Vector3d>& points,
                                                                    const Eigen::VectorXd& q, double padding,
                                                                    const Eigen::Isometry3d& frame) const {
  impl_->requireReady();
  if (!(padding >= 0 && padding <= kFarthest)) {
    throw std::invalid_argument("removeSelf: the padding is " + shown(padding) + ", not a length from 0 to 1e9 m");
  }
  const RigidTransform placed = requireRigid(frame, "removeSelf: the points' frame");
  std::vector<Eigen::Isometry3d> M_0;
  tree().forwardKinematics(q, M_0);
  std::vector<PlacedShape> shapes;
  const Eigen::Isometry3d to_points = placed.isometry().inverse();
  for (const ManagedBody& body : impl_->registry.links()) {
    if (body.empty()) continue;
    const Eigen::Isometry3d pose = to_points * (M_0[static_cast<std::size_t>(body.link)] * body.offset);
    shapes.emplace_back(body, pose, errorOfPlace(tree(), M_0, body, 2 * placed.length(), padding), padding);
  }
  std::vector<std::uint8_t> marks(points.size(), 0);
  const std::size_t tasks = (points.size() + kPointsOfTask - 1) / kPointsOfTask;
  parallelFor(tasks, tasks < 4 ? 1 : 0, [&](std::size_t k) {
    markNear(shapes, points, k * kPointsOfTask, std::min(points.size(), (k + 1) * kPointsOfTask), marks);
  });
  return marks;
}

std::size_t ArticulatedCollisionManager::removeSelf(std::vector<Vector3d>& points, const Eigen::VectorXd& q,
                                                    double padding, const Eigen::Isometry3d& frame) const {
  const std::vector<std::uint8_t> marks = pointsOnSelf(points, q, padding, frame);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[kept] = points[i];
    kept += !marks[i];
  }
  const std::size_t removed = points.size() - kept;
  points.resize(kept);
  return removed;
}

}  // namespace fcl_artic
