// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include "arm_scene.h"
#include "fcl_artic/manager.h"
#include "harness.h"
#include "rivals.h"

namespace fcl_artic::bench {

inline Answer toAnswer(const CertifiedResult& result) {
  if (result.status == Status::undecided) throw std::runtime_error("a query without a budget ended undecided");
  return result.status == Status::contact ? result.t_lower : kFree;
}

/// Certified queries on an arm scene, robot against itself off, tolerance 2^-13 of the step.
class CertifiedArm {
 public:
  /// @param merged  all obstacles as one mesh.
  explicit CertifiedArm(const ArmScene& scene, bool merged = false) : manager_(scene.tree) {
    for (const ArmLink& link : scene.links) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(toBvh<fcl::OBBRSSd>(link.mesh)));
      manager_.bind(link.link, objects_.back().get(), link.offset);
    }
    const auto meshes = merged ? std::vector<TriangleMesh>{merge(scene.obstacles)} : scene.obstacles;
    for (const TriangleMesh& mesh : meshes) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(toBvh<fcl::OBBRSSd>(mesh)));
      manager_.registerObject(objects_.back().get());
    }
    manager_.setup();
    request_.check_self = false;
    request_.tolerance_time = 0x1p-13;
  }

  Answer operator()(const JointMotion& motion) {
    manager_.continuousCollide(motion, request_, result_);
    return toAnswer(result_);
  }
  const CertifiedResult& result() const { return result_; }

  /// Times the motions, and counts their work in a pass of its own.
  Measured measureAll(const std::vector<JointMotion>& motions, int passes) {
    Measured measured = measure(motions.size(), passes, [&](std::size_t i) { return (*this)(motions[i]); });
    for (const JointMotion& motion : motions) {
      (*this)(motion);
      addCounters(measured.row, result_.statistics);
    }
    return measured;
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  ArticulatedCollisionManager manager_;
  CertifiedRequest request_;
  CertifiedResult result_;
};

inline std::vector<JointMotion> toMotions(const ArmScene& scene, const std::vector<ArmQuery>& queries) {
  std::vector<JointMotion> motions;
  for (const ArmQuery& q : queries) motions.push_back(JointMotion::linear(*scene.tree, q.q0, q.q1));
  return motions;
}

}  // namespace fcl_artic::bench
