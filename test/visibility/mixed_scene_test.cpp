// SPDX-License-Identifier: BSD-3-Clause
// Stage 2 amid obstacles of all kinds at once, for motions of all kinds that end where their first contact begins: what
// is culled wrongly in a last part of a motion, by a pixel or by a piece, is missed.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include "fcl_artic/fcl_artic.h"
#include "fcl_artic/point_cloud.h"
#include "fcl_artic/solid_mesh.h"
#include "recorder.h"
#include "with_and_without.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace mixed_scene_test {

namespace {

using namespace fcl_artic;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

class MixedScene : public testing::Test {
 protected:
  MixedScene() : manager_(tree_) {
    bind("link0", std::make_shared<fcl::Capsuled>(0.04, 0.3), {0, 0, 0.1});
    bind("link1", std::make_shared<fcl::Boxd>(0.05, 0.08, 0.3), {0, 0, 0.1});
    bind("link2", mesh({0.03, 0.05, 0.2}, 1, 0), {0, 0, 0.1});
    bind("link3", std::make_shared<fcl::Sphered>(0.07), {0, 0, 0.2});
    bind("link3", std::make_shared<fcl::Capsuled>(0.01, 0.4), {0, 0, 0.3});
    for (int i = 0; i < 2; ++i) {
      add(std::make_shared<fcl::Boxd>(0.05, 0.3, 0.1));
      add(std::make_shared<fcl::Boxd>(0.001, 0.5, 0.001));
      add(std::make_shared<fcl::Sphered>(0.1));
      add(std::make_shared<fcl::Capsuled>(0.005, 1));
      add(std::make_shared<fcl::Cylinderd>(0.05, 0.3));
      add(std::make_shared<fcl::Coned>(0.1, 0.2));
      add(std::make_shared<fcl::Ellipsoidd>(0.05, 0.1, 0.2));
      add(std::make_shared<fcl::TrianglePd>(vector(0.3), vector(0.3), vector(0.3)));
      add(makeSolid(*mesh({0.1, 0.1, 0.05}, 1, 0)));
      add(mesh({0.2, 0.2, 0.2}, 4, 0.02));
      add(soup());
      add(cloud());
      add(octree());
    }
    obstacle(std::make_shared<fcl::Halfspaced>(Vector3d(0.6, 0, 0.8), -0.5), Vector3d::Zero());
    obstacle(std::make_shared<fcl::Planed>(Vector3d(0, 1, 0), 1.6), Vector3d::Zero());
    manager_.allow("link1", "7");
    manager_.setMargin("2", 0.05);
    manager_.setup();
  }
  void bind(const std::string& link, const Geometry& geometry, const Vector3d& at) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(geometry));
    manager_.bind(link, objects_.back().get(), Eigen::Isometry3d(Eigen::Translation3d(at)));
  }
  void obstacle(const Geometry& geometry, const Vector3d& at) {
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(
        geometry, Matrix3d(Eigen::AngleAxisd(number(3), vector(1).normalized())), at));
    manager_.registerObject(objects_.back().get(), std::to_string(num_obstacles_++));
  }
  void add(const Geometry& geometry) { obstacle(geometry, Vector3d(vector(1.4) + Vector3d(0, 0.2, 0.6))); }
  double number(double most) { return std::uniform_real_distribution<double>(-most, most)(random_); }
  Vector3d vector(double most) {
    const double x = number(most), y = number(most);
    return {x, y, number(most)};
  }

  /// A box, its sides cut n x n, with corners moved by up to `noise`.
  std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>> mesh(const Vector3d& half, int n, double noise) {
    auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    model->beginModel();
    for (int axis = 0; axis < 3; ++axis) {
      for (const int side : {-1, 1}) {
        std::vector<Vector3d> corners;
        for (int i = 0; i <= n; ++i) {
          for (int j = 0; j <= n; ++j) {
            Vector3d x;
            x[axis] = side;
            x[(axis + 1) % 3] = (2.0 * i / n - 1) * side;
            x[(axis + 2) % 3] = 2.0 * j / n - 1;
            corners.emplace_back(x.cwiseProduct(half) + vector(noise));
          }
        }
        const auto corner = [&](int i, int j) { return corners[static_cast<std::size_t>(i * (n + 1) + j)]; };
        for (int i = 0; i < n; ++i) {
          for (int j = 0; j < n; ++j) {
            model->addTriangle(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
            model->addTriangle(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
          }
        }
      }
    }
    model->endModel();
    return model;
  }
  /// Triangles of all shapes: slivers, others without area, some twice, some along the axes.
  Geometry soup() {
    auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    model->beginModel();
    for (int i = 0; i < 90; ++i) {
      const Vector3d a = vector(0.5), u = vector(0.15);
      Vector3d v = vector(0.15);
      if (i % 5 == 0) v = 2 * u;
      if (i % 5 == 1) v = 0.5 * u + vector(1e-7);
      if (i % 7 == 0) v = u;
      if (i % 11 == 0) v = Vector3d(0.2, 0, 0);
      for (int times = 0; times < (i % 13 ? 1 : 2); ++times) model->addTriangle(a, a + u, a + v);
    }
    model->endModel();
    return model;
  }
  Geometry cloud() {
    std::vector<Vector3d> points;
    std::vector<double> radii;
    for (int i = 0; i < 80; ++i) {
      points.push_back(vector(0.4));
      radii.push_back(i % 20 ? 0.005 : 0.1);
    }
    return std::make_shared<PointCloud>(points, radii);
  }
  Geometry octree() {
    auto cells = std::make_shared<octomap::OcTree>(0.06);
    for (int i = 0; i < 25; ++i) {
      const Vector3d x = vector(0.4);
      cells->updateNode(octomap::point3d(static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])),
                        i % 6 != 0);
    }
    return std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(cells));
  }

  /// A motion of kind 0 to 3 from q, as far as its parameter `end`: straight, by a polynomial, by half angles, and with
  /// a turn or more.
  JointMotion motion(int kind, const VectorXd& q, const VectorXd& dq, double end) {
    if (kind == 2) {
      VectorXd tangents(4), to(4);
      for (int k = 0; k < 4; ++k) {
        tangents[k] = end * std::tan(dq[k] / 2);
        to[k] = q[k] + (k == 2 ? end * dq[k] : 2 * std::atan(tangents[k]));
      }
      return JointMotion::tangentHalfAngle(*tree_, q, to, q);
    }
    if (kind == 1) {
      Eigen::MatrixXd c(4, 4);
      c.col(0) = q;
      c.col(1) = 0.5 * end * dq;
      c.col(2) = end * end * dq.reverse();
      c.col(3) = -0.5 * end * end * end * dq;
      return JointMotion::polynomial(*tree_, c);
    }
    VectorXd by = end * dq;
    if (kind == 3) by[0] = by[3] = end * 7;
    return JointMotion::linear(*tree_, q, q + by);
  }
  VectorXd configuration() {
    VectorXd q(4);
    for (Eigen::Index k = 0; k < 4; ++k) q[k] = (k == 2 ? 0.1 : 3) * number(1);
    return q;
  }
  /// Motions of all kinds. Those with a contact on the way end there: a part of 1e-6 to 1e-2 of the motion after it.
  /// @param apart  nothing touches at the start.
  std::vector<JointMotion> make(std::size_t n, const CertifiedRequest& request, bool apart) {
    std::vector<JointMotion> all;
    for (std::size_t i = 0; i < n; ++i) {
      const int kind = static_cast<int>(i % 4);
      VectorXd q = configuration();
      while (apart && !manager_.collide(q, request).isFree()) q = configuration();
      const VectorXd dq = configuration() / 3;
      all.push_back(motion(kind, q, dq, 1));
      const CertifiedResult whole = manager_.continuousCollide(all.back(), request);
      if (whole.certain && whole.t_upper > 1e-3) {
        all.back() = motion(kind, q, dq, whole.t_upper * (1 + std::pow(10, -4 - 2 * number(1))));
      }
    }
    return all;
  }

  std::mt19937_64 random_{7};
  std::shared_ptr<const KinematicTree> tree_ = test::fourJoints();
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  int num_obstacles_ = 0;
  ArticulatedCollisionManager manager_;
};

/// With margins and without; with contacts at the start that are ignored, a link within a solid mesh among them.
TEST_F(MixedScene, ContactsAtTheVeryEndAreFoundByEveryExecutorAtEveryResolution) {
  std::vector<std::pair<std::string, std::shared_ptr<const VisibilityCuller>>> cullers;
  for (const int resolution : {4, 16, 32, 128}) {
    VisibilityOptions options;
    options.resolution = resolution;
    cullers.emplace_back("cpu", std::make_shared<VisibilityCuller>(options));
#ifdef FCL_ARTIC_HAS_OFFSCREEN
    if (resolution > 32) continue;
    cullers.emplace_back("osmesa", makeOffscreenCuller(OffscreenBackend::osmesa, options));
    cullers.emplace_back("egl", makeOffscreenCuller(OffscreenBackend::egl, options));
#endif
  }
  for (int kind = 0; kind < 3; ++kind) {
    CertifiedRequest request;
    request.check_self = kind == 2;
    request.margin = request.added_margin = kind == 1 ? 0.01 : 0;
    request.ignore_initial_contact = kind == 2;
    const std::vector<JointMotion> all = make(257, request, kind != 2);
    std::vector<CertifiedResult> off;
    manager_.continuousCollide(all, request, off);
    std::size_t contacts = 0, late = 0, ignoring = 0;
    for (const CertifiedResult& result : off) {
      contacts += result.status == Status::contact;
      late += result.certain && result.t_lower > 0.98;
      ignoring += !result.ignored_initial_contacts.empty();
    }
    request.visibility = VisibilityMode::on;
    std::uint64_t culled = 0;
    for (const auto& [name, culler] : cullers) {
      manager_.setVisibility(culler);
      for (std::size_t i = 0; i < all.size(); ++i) {
        const CertifiedResult on = manager_.continuousCollide(all[i], request);
        EXPECT_TRUE(test::sameBits(off[i], on)) << name << ", motion " << i << ": " << off[i] << ", " << on;
        culled += on.statistics.visibility.culled;
      }
      EXPECT_EQ(culler->fallbackReason(), "");
    }
    std::cout << all.size() << " motions, " << contacts << " with contact, " << late << " at the end, " << ignoring
              << " with some ignored; " << culled << " pairs culled\n";
    EXPECT_GT(late, 40u);
    EXPECT_GT(all.size() - contacts, 20u);
    EXPECT_GT(culled, 1000u);
    EXPECT_EQ(ignoring > 10, kind == 2);
  }
}

}  // namespace

}  // namespace mixed_scene_test
