// SPDX-License-Identifier: BSD-3-Clause
//
// A seeded arm of six capsules amid pipes: single ones, or chains of four that make concave objects. Each pipe is a
// mesh of 120 triangles, each chain one object.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <fcl/geometry/shape/capsule.h>
#include <Eigen/Geometry>

#include "arm_scene.h"
#include "fcl_artic/manager.h"

namespace fcl_artic::bench {

struct PipeSceneOptions {
  int objects = 500, chain = 1;  ///< pipes of an object
  double thickness = 1;          ///< times radii of 15 to 50 mm
  bool merged = false;           ///< all objects in one mesh
  std::uint64_t seed = 77;
};

/// Distance of two segments, by sampling one of them finely enough for keeping pipes off the base.
inline double roughDistance(const fcl::Vector3d& a, const fcl::Vector3d& b, const fcl::Vector3d& c,
                            const fcl::Vector3d& d) {
  double least = 1e9;
  for (int i = 0; i <= 32; ++i) {
    const fcl::Vector3d p = a + (b - a) * (i / 32.0), u = d - c;
    const double s = std::clamp((p - c).dot(u) / u.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - c - s * u).norm());
  }
  return least;
}

/// Adds a closed pipe from p to q: 12 sides, 4 rings, two caps.
inline void addPipe(const fcl::Vector3d& p, const fcl::Vector3d& q, double radius, TriangleMesh& mesh) {
  constexpr std::size_t kSides = 12, kRings = 4;
  const fcl::Vector3d d = (q - p).normalized();
  const fcl::Vector3d u = d.unitOrthogonal(), w = d.cross(u);
  const std::size_t base = mesh.vertices.size();
  for (std::size_t j = 0; j <= kRings; ++j) {
    for (std::size_t i = 0; i < kSides; ++i) {
      const double t = 2 * kPi * static_cast<double>(i) / kSides;
      mesh.vertices.push_back(p + (q - p) * (static_cast<double>(j) / kRings) +
                              radius * (std::cos(t) * u + std::sin(t) * w));
    }
  }
  mesh.vertices.push_back(p);
  mesh.vertices.push_back(q);
  const auto at = [&](std::size_t i, std::size_t j) { return base + kSides * j + i % kSides; };
  const std::size_t caps = base + kSides * (kRings + 1);
  for (std::size_t i = 0; i < kSides; ++i) {
    for (std::size_t j = 0; j < kRings; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
      mesh.triangles.emplace_back(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
    mesh.triangles.emplace_back(caps, at(i + 1, 0), at(i, 0));
    mesh.triangles.emplace_back(caps + 1, at(i, kRings), at(i + 1, kRings));
  }
}

/// The scene in a manager, and its motions.
class PipeScene {
 public:
  explicit PipeScene(const PipeSceneOptions& options) : random_(options.seed), manager_(makeTree()) {
    for (std::size_t i = 0; i < kLinks; ++i) {
      objects_.push_back(
          std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Capsuled>(kRadius[i], kLength[i])));
      manager_.bind("link" + std::to_string(i), objects_.back().get(),
                    Eigen::Isometry3d(Eigen::Translation3d(0, 0, kLength[i] / 2)));
    }
    while (boxes_.size() < static_cast<std::size_t>(options.objects)) addObject(options);
    if (options.merged) {
      const Eigen::AlignedBox3d all = std::accumulate(boxes_.begin(), boxes_.end(), Eigen::AlignedBox3d(),
                                                      [](auto a, const auto& b) { return a.merged(b); });
      boxes_.assign(1, all);
      registerMesh(merged_);
    }
    manager_.setup();
  }

  ArticulatedCollisionManager& manager() { return manager_; }
  std::size_t triangles() const { return triangles_; }

  /// Pairs of a link and an object whose axis-aligned boxes, the link's over all of the motion, meet (by 65 poses).
  std::size_t pairsWhoseBoxesMeet(const JointMotion& motion) const {
    std::vector<Eigen::AlignedBox3d> swept(kLinks);
    std::vector<Eigen::Isometry3d> M_0;
    for (int k = 0; k <= 64; ++k) {
      manager_.tree().forwardKinematics(motion.configuration(k / 64.0), M_0);
      for (std::size_t i = 0; i < kLinks; ++i) {
        const Eigen::Isometry3d& M = M_0[i + 1];
        for (const double z : {0.0, kLength[i]}) {
          const Eigen::Vector3d p = M * Eigen::Vector3d(0, 0, z), r = Eigen::Vector3d::Constant(kRadius[i]);
          swept[i].extend(Eigen::AlignedBox3d(p - r, p + r));
        }
      }
    }
    std::size_t count = 0;
    for (const Eigen::AlignedBox3d& link : swept) {
      for (const Eigen::AlignedBox3d& box : boxes_) count += link.intersects(box);
    }
    return count;
  }

  /// Random motions whose starts keep 1 cm clear of everything; the joint that turns most turns by `step` (rad).
  std::vector<JointMotion> motions(double step, std::size_t count) {
    std::vector<JointMotion> found;
    CertifiedRequest clear;
    clear.check_self = false;
    clear.margin = 0.01;
    CertifiedResult result;
    while (found.size() < count) {
      Eigen::VectorXd q(kLinks), dq(kLinks);
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        q[i] = random_.uniform(-kPi, kPi);
        dq[i] = random_.uniform(-1, 1);
      }
      q[1] = random_.uniform(-1.2, 1.2);
      dq *= step / dq.cwiseAbs().maxCoeff();
      manager_.collide(q, clear, result);
      if (result.isFree()) found.push_back(JointMotion::linear(manager_.tree(), q, q + dq));
    }
    return found;
  }

 private:
  static constexpr std::size_t kLinks = 6;
  static constexpr double kLength[kLinks] = {0.3, 0.45, 0.4, 0.2, 0.15, 0.1};
  static constexpr double kRadius[kLinks] = {0.08, 0.07, 0.06, 0.05, 0.045, 0.035};

  static std::shared_ptr<const KinematicTree> makeTree() {
    constexpr int kAxis[kLinks] = {2, 1, 1, 0, 1, 0};
    auto tree = std::make_shared<KinematicTree>("six capsules");
    tree->addLink("base");
    for (std::size_t i = 0; i < kLinks; ++i) {
      Joint joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = JointType::revolute;
      joint.parent = i ? "link" + std::to_string(i - 1) : "base";
      joint.child = "link" + std::to_string(i);
      joint.axis = Eigen::Vector3d::Unit(kAxis[i]);
      joint.origin.translation() << 0, 0, i ? kLength[i - 1] : 0.1;
      tree->addLink(joint.child);
      tree->addJoint(joint);
    }
    return tree;
  }

  fcl::Vector3d direction() {
    for (;;) {
      const fcl::Vector3d d(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1));
      if (d.norm() > 0.1 && d.norm() < 1) return d.normalized();
    }
  }

  void addObject(const PipeSceneOptions& options) {
    const double radius = options.thickness * random_.uniform(0.015, 0.05);
    fcl::Vector3d at(random_.uniform(-2, 2), random_.uniform(-2, 2), random_.uniform(0, 2.5));
    const bool along_axes = random_.coin(0.8);
    std::vector<std::array<fcl::Vector3d, 2>> pipes;
    int last = -1;
    fcl::Vector3d d = direction();
    for (int k = 0; k < options.chain; ++k) {
      if (along_axes) {
        int axis = random_.index(3);
        while (axis == last) axis = random_.index(3);
        last = axis;
        d = fcl::Vector3d::Unit(axis) * random_.sign();
      } else if (k) {
        d = direction();
      }
      const double length = random_.uniform(0.3, 1.2);
      if (options.chain == 1) at -= d * (length / 2);
      pipes.push_back({at, at + d * length});
      at += d * length;
    }
    TriangleMesh mesh;
    for (const auto& pipe : pipes) {
      if (roughDistance({0, 0, 0}, {0, 0, 0.4}, pipe[0], pipe[1]) < 0.25) return;
      addPipe(pipe[0], pipe[1], radius, mesh);
    }
    triangles_ += mesh.triangles.size();
    boxes_.emplace_back();
    for (const fcl::Vector3d& v : mesh.vertices) boxes_.back().extend(v);
    if (!options.merged) return registerMesh(mesh);
    const std::size_t base = merged_.vertices.size();
    merged_.vertices.insert(merged_.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const fcl::Triangle& t : mesh.triangles) merged_.triangles.emplace_back(base + t[0], base + t[1], base + t[2]);
  }

  void registerMesh(const TriangleMesh& mesh) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(toBvh<fcl::OBBRSSd>(mesh)));
    manager_.registerObject(objects_.back().get());
  }

  Random random_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< of the obstacles
  ArticulatedCollisionManager manager_;
  TriangleMesh merged_;
  std::size_t triangles_ = 0;
};

}  // namespace fcl_artic::bench
