// SPDX-License-Identifier: BSD-3-Clause
#include "roadmap/roadmap.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "edges/columns.h"
#include "random_motions.h"
#include "roadmap/nearest.h"

namespace fcl_artic::app {
namespace {

/// Values that variable v is drawn from.
struct Range {
  double low, high;
};

Range rangeOf(const KinematicTree& tree, int v) {
  const Joint& joint = tree.joint(tree.variableJoint(v));
  if (hasLimits(joint)) return {joint.lower, joint.upper};
  if (joint.type == JointType::continuous || joint.type == JointType::revolute) return {-M_PI, M_PI};
  throw std::invalid_argument(
      fmt::format("roadmap: joint '{}' of robot '{}' {}: a roadmap knows no values to draw", joint.name, tree.name(),
                  joint.type == JointType::prismatic ? "slides without limits" : "is planar, floating or spherical"));
}

}  // namespace

double Roadmap::length(std::size_t edge) const {
  return (configuration(static_cast<std::size_t>(edges[2 * edge])) -
          configuration(static_cast<std::size_t>(edges[2 * edge + 1])))
      .norm();
}

Roadmap makeRoadmap(const ArticulatedCollisionManager& manager, const CertifiedRequest& request,
                    const RoadmapOptions& options, std::size_t& tried) {
  assert(!request.ignore_initial_contact);
  const KinematicTree& tree = manager.tree();
  Roadmap roadmap;
  std::vector<Range> ranges;
  for (int v = 0; v < tree.dof(); ++v) {
    roadmap.joints.push_back(tree.variableName(v));
    ranges.push_back(rangeOf(tree, v));
  }
  if (ranges.empty())
    throw std::invalid_argument(fmt::format("roadmap: robot '{}' has no joint that moves", tree.name()));
  const auto add = [&](const Eigen::VectorXd& q) {
    roadmap.configurations.insert(roadmap.configurations.end(), q.data(), q.data() + q.size());
  };
  CertifiedRequest still = request;
  still.mode = ContactMode::any;
  for (std::size_t i = 0; i < options.given.size(); ++i) {
    const Eigen::VectorXd& q = options.given[i];
    const CertifiedResult result = manager.collide(q, still);
    if (!result.isFree()) {
      const CertifiedContact* const c = result.first();
      throw std::invalid_argument(fmt::format("roadmap: given configuration {} is not proven free{}", i,
                                              c ? fmt::format(": {} and {}", c->body1.name, c->body2.name) : ""));
    }
    add(q);
  }
  Random random(options.seed);
  std::vector<JointMotion> motions;
  std::vector<CertifiedResult> results;
  std::vector<Eigen::VectorXd> drawn;
  constexpr std::size_t kMaxPerVertex = 1000;
  std::size_t draws = 0;
  while (roadmap.numVertices() < options.vertices) {
    if (draws > kMaxPerVertex * (roadmap.numVertices() + 10)) {
      throw std::runtime_error(
          fmt::format("roadmap: of {} random configurations only {} are proven free", draws, roadmap.numVertices()));
    }
    motions.clear();
    drawn.clear();
    const std::size_t n = std::min(kMotionsAtOnce, 2 * (options.vertices - roadmap.numVertices()) + 16);
    for (std::size_t i = 0; i < n; ++i) {
      Eigen::VectorXd q(tree.dof());
      for (std::size_t v = 0; v < ranges.size(); ++v)
        q[static_cast<Eigen::Index>(v)] = random.uniform(ranges[v].low, ranges[v].high);
      motions.push_back(JointMotion::still(tree, q));
      drawn.push_back(std::move(q));
    }
    manager.continuousCollide(motions, still, results, options.threads);
    for (std::size_t i = 0; i < n && roadmap.numVertices() < options.vertices; ++i) {
      ++draws;
      if (results[i].isFree()) add(drawn[i]);
    }
  }

  const NearestPoints nearest(roadmap.configurations, roadmap.joints.size());
  std::vector<std::pair<std::int64_t, std::int64_t>> edges;
  for (std::size_t i = 0; i < roadmap.numVertices(); ++i) {
    for (const std::int64_t j : nearest.of(i, options.neighbours))
      edges.push_back(std::minmax(static_cast<std::int64_t>(i), j));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  tried = edges.size();
  for (std::size_t begin = 0; begin < edges.size(); begin += kMotionsAtOnce) {
    const std::size_t end = std::min(edges.size(), begin + kMotionsAtOnce);
    motions.clear();
    for (std::size_t e = begin; e < end; ++e) {
      motions.push_back(JointMotion::linear(tree, roadmap.configuration(static_cast<std::size_t>(edges[e].first)),
                                            roadmap.configuration(static_cast<std::size_t>(edges[e].second))));
    }
    manager.continuousCollide(motions, still, results, options.threads);
    for (std::size_t e = begin; e < end; ++e) {
      if (!results[e - begin].isFree()) continue;
      roadmap.edges.push_back(edges[e].first);
      roadmap.edges.push_back(edges[e].second);
    }
  }
  roadmap.self_margin = request.margin;
  roadmap.self_proven = request.check_self && !request.ignore_initial_contact;
  return roadmap;
}

bool certifyRoadmap(const ArticulatedCollisionManager& manager, const CertifiedRequest& request, int threads,
                    Roadmap& roadmap) {
  const KinematicTree& tree = manager.tree();
  const std::size_t all = roadmap.numEdges();
  std::vector<const fcl::CollisionObjectd*> objects;
  manager.getObjects(objects);
  roadmap.answers.assign(all, false);
  roadmap.bodies.assign(all, {});
  std::vector<JointMotion> motions;
  std::vector<CertifiedResult> results;
  bool checked = false;
  for (std::size_t begin = 0; begin < all; begin += kMotionsAtOnce) {
    const std::size_t end = std::min(all, begin + kMotionsAtOnce);
    motions.clear();
    for (std::size_t e = begin; e < end; ++e) {
      motions.push_back(JointMotion::linear(tree, roadmap.configuration(static_cast<std::size_t>(roadmap.edges[2 * e])),
                                            roadmap.configuration(static_cast<std::size_t>(roadmap.edges[2 * e + 1]))));
    }
    manager.continuousCollide(motions, request, results, threads);
    for (std::size_t e = begin; e < end; ++e) {
      const CertifiedResult& result = results[e - begin];
      checked = checked || !result.nothingChecked();
      putRow(
          result,
          [&](const BodyRef& body) {
            return static_cast<std::int32_t>(std::find(objects.begin(), objects.end(), body.object) - objects.begin());
          },
          e, roadmap.answers);
      if (const CertifiedContact* const c = result.first()) roadmap.bodies[e] = c->body1.name + ", " + c->body2.name;
    }
  }
  return checked;
}

}  // namespace fcl_artic::app
