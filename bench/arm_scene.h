// SPDX-License-Identifier: BSD-3-Clause
//
// Seeded scenes for benchmarks and cross-checks: a chain of bumpy ellipsoids (a PUMA 560 by its published
// Denavit-Hartenberg parameters, or a random chain) amid bumpy spheres, everything a triangle mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

#include "fcl_artic/joint_motion.h"
#include "random.h"

namespace fcl_artic::bench {

constexpr double kPi = 3.14159265358979323846;

struct TriangleMesh {
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
};

template <class BV>
std::shared_ptr<fcl::BVHModel<BV>> toBvh(const TriangleMesh& mesh) {
  auto model = std::make_shared<fcl::BVHModel<BV>>();
  model->beginModel(static_cast<int>(mesh.triangles.size()), static_cast<int>(mesh.vertices.size()));
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  model->computeLocalAABB();
  return model;
}

inline TriangleMesh merge(const std::vector<TriangleMesh>& meshes) {
  TriangleMesh all;
  for (const TriangleMesh& mesh : meshes) {
    const std::size_t base = all.vertices.size();
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const fcl::Triangle& t : mesh.triangles) all.triangles.emplace_back(base + t[0], base + t[1], base + t[2]);
  }
  return all;
}

/// A star-shaped solid: an ellipsoid whose radius carries two waves, so that it has hollows and no symmetry.
struct BumpyEllipsoid {
  fcl::Vector3d centre = fcl::Vector3d::Zero();
  fcl::Vector3d half = fcl::Vector3d::Ones();  ///< half axes, m
  double bump = 0.03;                          ///< amplitude of the first wave, relative

  double wave(double polar, double azimuth) const {
    const double fade = std::sin(polar);  // the poles stay smooth
    return 1 +
           bump * fade *
               (std::sin(5 * azimuth) * std::sin(4 * polar) + 0.5 * std::sin(11 * azimuth + 1) * std::sin(9 * polar));
  }
  fcl::Vector3d point(double polar, double azimuth) const {
    const fcl::Vector3d direction(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                  std::cos(polar));
    return centre + wave(polar, azimuth) * half.cwiseProduct(direction);
  }
  bool contains(const fcl::Vector3d& x) const {
    const fcl::Vector3d u = (x - centre).cwiseQuotient(half);
    const double length = u.norm();
    return length == 0 || length < wave(std::acos(u.z() / length), std::atan2(u.y(), u.x()));
  }
  /// 2 * meridians * (bands - 1) triangles.
  TriangleMesh mesh(int meridians, int bands) const {
    TriangleMesh mesh;
    mesh.vertices.push_back(point(0, 0));
    for (int i = 1; i < bands; ++i) {
      for (int j = 0; j < meridians; ++j) mesh.vertices.push_back(point(kPi * i / bands, 2 * kPi * j / meridians));
    }
    mesh.vertices.push_back(point(kPi, 0));
    const std::size_t south = mesh.vertices.size() - 1;
    const auto vertex = [&](int ring, int j) {
      return static_cast<std::size_t>(1 + (ring - 1) * meridians + j % meridians);
    };
    for (int j = 0; j < meridians; ++j) {
      mesh.triangles.emplace_back(0, vertex(1, j), vertex(1, j + 1));
      for (int i = 1; i + 1 < bands; ++i) {
        mesh.triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
        mesh.triangles.emplace_back(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
      }
      mesh.triangles.emplace_back(south, vertex(bands - 1, j + 1), vertex(bands - 1, j));
    }
    return mesh;
  }
};

/// One row of Denavit-Hartenberg parameters: Rz(q) Tz(d) Tx(a) Rx(twist).
struct DhRow {
  double a, d, twist;
};

/// PUMA 560 (Corke and Armstrong-Helouvry 1994), with a flange of 56 mm.
inline std::vector<DhRow> pumaRows() {
  return {{0, 0, kPi / 2},      {0.4318, 0, 0},   {0.0203, 0.15005, -kPi / 2},
          {0, 0.4318, kPi / 2}, {0, 0, -kPi / 2}, {0, 0.056, 0}};
}

/// A chain of `joints` revolute joints whose links share out `reach`, with random right-angled twists.
inline std::vector<DhRow> randomRows(int joints, double reach, Random& random) {
  std::vector<DhRow> rows;
  for (int i = 0; i < joints; ++i) {
    const double twist = random.coin(1.0 / 3) ? 0 : random.sign() * kPi / 2;
    rows.push_back({reach / joints, 0, twist});
  }
  return rows;
}

struct ArmLink {
  LinkId link;
  Eigen::Isometry3d offset;  ///< mesh in the link's frame
  BumpyEllipsoid shape;
  TriangleMesh mesh;
};

struct ArmScene {
  std::shared_ptr<const KinematicTree> tree;
  std::vector<ArmLink> links;
  std::vector<BumpyEllipsoid> spheres;
  std::vector<TriangleMesh> obstacles;  ///< one per sphere, in world axes

  std::size_t sceneTriangles() const {
    std::size_t n = 0;
    for (const TriangleMesh& m : obstacles) n += m.triangles.size();
    return n;
  }
};

struct ArmSceneOptions {
  std::uint64_t seed = 11;
  std::vector<DhRow> rows = pumaRows();
  int first_link = 2;        ///< links before carry no geometry (1 = the link after the first joint)
  double thickness = 0.055;  ///< smallest half axis of a link, m
  int link_meridians = 24, link_bands = 22;
  int spheres = 10;
  int scene_triangles = 100000;  ///< about; a sphere has 2 n^2 of them, n = half its meridians rounded
};

inline ArmScene makeArmScene(const ArmSceneOptions& options) {
  ArmScene scene;
  auto tree = std::make_shared<KinematicTree>("arm");
  tree->addLink("link0");
  Eigen::Isometry3d past_joint = Eigen::Isometry3d::Identity();  // the part of the row that follows the rotation
  for (std::size_t i = 0; i < options.rows.size(); ++i) {
    const DhRow& row = options.rows[i];
    const std::string number = std::to_string(i + 1);
    const LinkId link = tree->addLink("link" + number);
    Joint joint;
    joint.name = "joint" + number;
    joint.type = JointType::revolute;
    joint.parent = "link" + std::to_string(i);
    joint.child = "link" + number;
    joint.origin = past_joint;
    joint.axis = Eigen::Vector3d::UnitZ();
    tree->addJoint(joint);

    past_joint = Eigen::Translation3d(row.a, 0, row.d) * Eigen::AngleAxisd(row.twist, Eigen::Vector3d::UnitX());
    if (static_cast<int>(i) + 1 < options.first_link) continue;
    // The link spans from the joint to the end of its row; seen from that end the joint lies at `back`.
    const Eigen::Vector3d back = past_joint.inverse(Eigen::Isometry) * Eigen::Vector3d::Zero();
    ArmLink body;
    body.link = link;
    body.offset = past_joint;
    body.shape.centre = back / 2;
    body.shape.half = (1.05 / 2 * back).cwiseAbs().cwiseMax(options.thickness);
    body.mesh = body.shape.mesh(options.link_meridians, options.link_bands);
    scene.links.push_back(std::move(body));
  }
  scene.tree = tree;

  Random random(options.seed);
  const double per_sphere = static_cast<double>(options.scene_triangles) / options.spheres;
  const int bands = std::max(2, static_cast<int>(std::lround(std::sqrt(per_sphere) / 2)));
  for (int i = 0; i < options.spheres; ++i) {
    const double azimuth = 2 * kPi * i / options.spheres;
    const double distance = random.uniform(0.4, 0.7);
    BumpyEllipsoid sphere;
    sphere.half.setConstant(random.uniform(0.1, 0.18));
    sphere.centre << distance * std::cos(azimuth), distance * std::sin(azimuth), random.uniform(-0.45, 0.45);
    scene.spheres.push_back(sphere);
    scene.obstacles.push_back(sphere.mesh(2 * bands, bands + 1));
  }
  return scene;
}

struct ArmQuery {
  Eigen::VectorXd q0, q1;  ///< rad
};

/// Tells whether a configuration touches nothing and no link lies wholly inside a sphere (both are surfaces for FCL).
class StartChecker {
 public:
  explicit StartChecker(const ArmScene& scene) : scene_(scene) {
    for (const ArmLink& link : scene.links) links_.push_back(toBvh<fcl::OBBRSSd>(link.mesh));
    for (const TriangleMesh& mesh : scene.obstacles) obstacles_.push_back(toBvh<fcl::OBBRSSd>(mesh));
  }
  bool isFree(const Eigen::VectorXd& q) {
    scene_.tree->forwardKinematics(q, M_0_);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const fcl::Transform3d M_0g = M_0_[static_cast<std::size_t>(scene_.links[i].link)] * scene_.links[i].offset;
      const fcl::Vector3d centre = M_0g * scene_.links[i].shape.centre;
      for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        // Without touching surfaces a link is inside exactly when its centre is: it is thinner than any sphere.
        if (scene_.spheres[k].contains(centre)) return false;
        fcl::CollisionResultd result;
        if (fcl::collide(links_[i].get(), M_0g, obstacles_[k].get(), fcl::Transform3d::Identity(),
                         fcl::CollisionRequestd(), result) > 0) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  const ArmScene& scene_;
  std::vector<std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>>> links_, obstacles_;
  std::vector<Eigen::Isometry3d> M_0_;
};

/// Random motions with free starts: every joint anywhere, then one step up or down.
/// @param step  rad, for each joint.
/// @param collides  verdict of one query.
/// @return `count` free ones and `count` colliding ones.
template <class Collides>
std::array<std::vector<ArmQuery>, 2> makeArmQueries(const ArmScene& scene, double step, std::size_t count,
                                                    std::uint64_t seed, Collides&& collides) {
  Random random(seed);
  StartChecker start(scene);
  std::array<std::vector<ArmQuery>, 2> sets;
  while (sets[0].size() < count || sets[1].size() < count) {
    ArmQuery query{Eigen::VectorXd(scene.tree->dof()), Eigen::VectorXd(scene.tree->dof())};
    for (Eigen::Index i = 0; i < query.q0.size(); ++i) {
      query.q0[i] = random.uniform(-kPi, kPi);
      query.q1[i] = query.q0[i] + random.sign() * step;
    }
    if (!start.isFree(query.q0)) continue;
    auto& set = sets[collides(query) ? 1 : 0];
    if (set.size() < count) set.push_back(std::move(query));
  }
  return sets;
}

}  // namespace fcl_artic::bench
