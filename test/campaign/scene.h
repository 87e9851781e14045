// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "geometry.h"

namespace campaign {

enum class JointKind { fixed, revolute, continuous, prismatic };

/// A link with the joint that carries it; a root has none and rests at the world's frame.
struct Link {
  int parent = -1;  ///< index of an earlier link; -1: a root
  JointKind joint = JointKind::fixed;
  Pose origin;                ///< joint frame in the parent's frame
  Vec3 axis = Vec3::UnitX();  ///< unit, in the joint frame
  int master = -1;            ///< link whose joint this one mimics; -1: none
  double multiplier = 1, offset = 0;

  bool hasVariable() const { return parent >= 0 && joint != JointKind::fixed && master < 0; }
};

/// A geometry on a link (pose in the link's frame), or an obstacle (link = -1, pose in the world).
struct Body {
  GeometryPtr geometry;
  int link = -1;
  Pose pose;
};

/// One question to the library, and all that the oracle knows about it.
struct Scene {
  std::string family;      ///< class of the campaign
  std::uint64_t seed = 0;  ///< makes the same scene again
  std::vector<Link> links;
  std::vector<Body> bodies;
  std::set<std::pair<int, int>> allowed;  ///< bodies that may touch, smaller index first; see allow()
  std::vector<double> q0, q1;             ///< one value for each link with a variable, in the order of the links
  bool shortest = false;                  ///< continuous joints take the shorter way
  double tolerance_time = 1e-6, tolerance_distance = 1e-6, margin = 0;
  bool check_scene = true, check_self = true, every_pair = false;
  int max_contacts = 1;

  /// Name of the body for the library: that of its link, or the obstacle's.
  std::string nameOf(int body) const;
  /// Lets two bodies touch, with all others of the same links.
  void allow(int a, int b);
};

/// Poses over time, written apart from the library's.
class Kinematics {
 public:
  explicit Kinematics(const Scene& scene);

  /// Value of the link's joint at time t, rad or m.
  double jointValue(int link, double t) const;
  Pose linkPose(int link, double t) const;
  Pose bodyPose(int body, double t) const;
  /// No point of one body moves faster than this against the other, in m per unit of t, for t in [0, 1].
  double relativeSpeed(int a, int b) const;
  /// Pairs of bodies that the question is about.
  std::vector<std::pair<int, int>> pairs() const;
  double deltaQ(int variable) const { return dq_[static_cast<std::size_t>(variable)]; }

 private:
  /// Speed of the body's points against the frame of the ancestor link (-1: the world).
  double speedAgainst(int body, int ancestor) const;
  bool joined(int link_a, int link_b) const;
  int carrier(int link) const;
  bool hasBody(int link) const;
  std::vector<int> ancestors(int link) const;

  const Scene& scene_;
  std::vector<int> variable_;  ///< of the link's joint, or of its master; -1 when fixed
  std::vector<double> dq_;
};

}  // namespace campaign
