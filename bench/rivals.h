// SPDX-License-Identifier: BSD-3-Clause
//
// What FCL itself offers for the same question, on exactly the same motion (FclLinkMotion). Used by the benchmarks and,
// the oriented advancement, as a cross-check in the tests.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/detail/conservative_advancement_func_matrix.h>

#include "arm_scene.h"
#include "fcl_artic/fcl_link_motion.h"

namespace fcl_artic::bench {

/// Answer of a rival: the first contact time that it reports, 2 when it says free.
constexpr double kFree = 2;

/// Motion of something that stands still.
inline fcl::TranslationMotion<double> still(const fcl::Transform3d& M_0 = fcl::Transform3d::Identity()) {
  return fcl::TranslationMotion<double>(M_0.linear(), M_0.translation(), M_0.translation());
}

/// FCL's oriented conservative advancement on RSS trees, the one of its mesh routines that can be trusted.
inline double orientedAdvancement(const fcl::BVHModel<fcl::RSSd>& o1, const fcl::MotionBased& motion1,
                                  const fcl::BVHModel<fcl::RSSd>& o2, const fcl::MotionBased& motion2) {
  motion1.integrate(0);  // it starts from whatever state an earlier run left
  motion2.integrate(0);
  const fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
  double toc = 1;
  const bool contact = fcl::detail::conservativeAdvancementMeshOriented<
      fcl::RSSd, fcl::detail::MeshConservativeAdvancementTraversalNodeRSS<double>>(o1, &motion1, o2, &motion2, request,
                                                                                   result, toc);
  return contact ? toc : kFree;
}

/// FCL's ways to check an arm among still meshes.
class FclRivals {
 public:
  explicit FclRivals(const ArmScene& scene) : scene_(scene) {
    for (const ArmLink& link : scene.links) {
      link_rss_.push_back(toBvh<fcl::RSSd>(link.mesh));
      link_objects_.push_back(std::make_unique<fcl::CollisionObjectd>(toBvh<fcl::OBBRSSd>(link.mesh)));
    }
    for (const TriangleMesh& mesh : scene.obstacles) {
      obstacle_rss_.push_back(toBvh<fcl::RSSd>(mesh));
      obstacle_objects_.push_back(std::make_unique<fcl::CollisionObjectd>(toBvh<fcl::OBBRSSd>(mesh)));
      broadphase_.registerObject(obstacle_objects_.back().get());
    }
    broadphase_.setup();
  }

  /// Oriented conservative advancement on every pair whose swept boxes overlap.
  double advancement(const JointMotion& motion) const {
    const auto at_rest = still();
    return overPairs(motion, [&](std::size_t i, std::size_t k, const FclLinkMotion& m) {
      return orientedAdvancement(*link_rss_[i], m, *obstacle_rss_[k], at_rest);
    });
  }

  /// Public entry, naive solver, on the same pairs.
  double naive(const JointMotion& motion, std::size_t steps) const {
    const auto at_rest = still();
    fcl::ContinuousCollisionRequestd request;
    request.num_max_iterations = steps;
    request.toc_err = 0.5 / static_cast<double>(steps);  // caps the number of steps at its inverse
    request.ccd_solver_type = fcl::CCDC_NAIVE;
    return overPairs(motion, [&](std::size_t i, std::size_t k, const FclLinkMotion& m) {
      fcl::ContinuousCollisionResultd result;
      fcl::continuousCollide(link_objects_[i]->collisionGeometry().get(), &m,
                             obstacle_objects_[k]->collisionGeometry().get(), &at_rest, request, result);
      return result.is_collide ? result.time_of_contact : kFree;
    });
  }

  /// What planners do: static checks through FCL's broadphase, at most `resolution` rad apart in the joint norm, in
  /// order of time up to the first that collides.
  double sampling(const JointMotion& motion, double resolution) {
    const int steps = std::max(1, static_cast<int>(std::ceil(motion.dq().norm() / resolution)));
    for (int s = 0; s <= steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      scene_.tree->forwardKinematics(motion.configuration(t), M_0_);
      for (std::size_t i = 0; i < link_objects_.size(); ++i) {
        const ArmLink& link = scene_.links[i];
        link_objects_[i]->setTransform(M_0_[static_cast<std::size_t>(link.link)] * link.offset);
        link_objects_[i]->computeAABB();
        fcl::DefaultCollisionData<double> data;
        broadphase_.collide(link_objects_[i].get(), &data, fcl::DefaultCollisionFunction);
        if (data.result.isCollision()) return t;
      }
    }
    return kFree;
  }

  /// Pairs that the swept boxes have left since the last call.
  std::size_t takePairsLeft() { return std::exchange(pairs_left_, 0); }

 private:
  /// Encloses a swept mesh: boxes at evenly spaced times, grown by how far a point can leave the chord between two of
  /// them (acceleration h^2 / 8).
  static fcl::AABBd sweptBox(const fcl::AABBd& local, const FclLinkMotion& motion) {
    constexpr int kIntervals = 8;
    fcl::AABBd swept;
    double reach = 0;
    for (int i = 0; i <= kIntervals; ++i) {
      const Eigen::Isometry3d M = motion.pose(static_cast<double>(i) / kIntervals);
      for (int c = 0; c < 8; ++c) {
        const fcl::Vector3d corner(local.min_[0] + (c & 1) * (local.max_[0] - local.min_[0]),
                                   local.min_[1] + ((c >> 1) & 1) * (local.max_[1] - local.min_[1]),
                                   local.min_[2] + ((c >> 2) & 1) * (local.max_[2] - local.min_[2]));
        reach = std::max(reach, corner.norm());
        swept += fcl::Vector3d(M * corner);
      }
    }
    const double sag = motion.accelerationBound(reach) / (8.0 * kIntervals * kIntervals);
    return swept.expand(fcl::Vector3d::Constant(sag));
  }

  template <class Pair>
  double overPairs(const JointMotion& motion, Pair&& pair) const {
    double first = kFree;
    for (std::size_t i = 0; i < link_rss_.size(); ++i) {
      const FclLinkMotion link_motion(*scene_.tree, motion, scene_.links[i].link, scene_.links[i].offset);
      const fcl::AABBd swept = sweptBox(link_rss_[i]->aabb_local, link_motion);
      for (std::size_t k = 0; k < obstacle_rss_.size(); ++k) {
        if (!swept.overlap(obstacle_rss_[k]->aabb_local)) continue;
        ++pairs_left_;
        first = std::min(first, pair(i, k, link_motion));
      }
    }
    return first;
  }

  const ArmScene& scene_;
  std::vector<std::shared_ptr<fcl::BVHModel<fcl::RSSd>>> link_rss_, obstacle_rss_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> link_objects_, obstacle_objects_;
  fcl::DynamicAABBTreeCollisionManagerd broadphase_;
  std::vector<Eigen::Isometry3d> M_0_;
  mutable std::size_t pairs_left_ = 0;
};

}  // namespace fcl_artic::bench
