// SPDX-License-Identifier: BSD-3-Clause
// What the stage hands to an executor: swept volumes that hold the link, pieces that hold the obstacle, windows that
// hold what they share.
#include <cmath>
#include <random>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "fcl_artic/fcl_artic.h"
#include "recorder.h"

namespace swept_test {

namespace {

using namespace fcl_artic;
using Eigen::Vector3d;
using visibility::Drawing;

class Swept : public testing::Test {
 protected:
  static constexpr double kRadius = 0.05, kLength = 0.4;
  Swept() : capsule_(std::make_shared<fcl::Capsuled>(kRadius, kLength)), tree_(test::fourJoints()) {}
  Vector3d direction() {
    std::normal_distribution<double> normal;
    return Vector3d(normal(random_), normal(random_), normal(random_)).normalized();
  }
  /// Asks once; what the executor saw is in drawing_.
  void ask(const JointMotion& motion, const std::shared_ptr<fcl::CollisionGeometryd>& obstacle,
           const Eigen::Isometry3d& at, double margin) {
    fcl::CollisionObjectd link(capsule_), object(obstacle, at);
    ArticulatedCollisionManager manager(tree_);
    manager.bind("link3", &link);
    manager.registerObject(&object);
    manager.setup();
    manager.setVisibility(test::recordTo(drawing_));
    CertifiedRequest request;
    request.visibility = VisibilityMode::on;
    request.margin = margin;
    manager.continuousCollide(motion, request, result_);
    ASSERT_EQ(result_.statistics.visibility_executor, "changed");
  }
  std::shared_ptr<fcl::Capsuled> capsule_;
  std::shared_ptr<const KinematicTree> tree_;
  std::mt19937_64 random_{1};
  Drawing drawing_;
  CertifiedResult result_;
};

TEST_F(Swept, VolumesHoldTheLink) {
  double least_room = HUGE_VAL;
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd q0 = Eigen::VectorXd::Random(4) * 2, dq = Eigen::VectorXd::Random(4) * (trial % 4 ? 0.5 : 2);
    const JointMotion motion = JointMotion::linear(*tree_, q0, q0 + dq);
    ask(motion, std::make_shared<fcl::Boxd>(20, 20, 20), Eigen::Isometry3d::Identity(), 0);  // all of it in a solid
    ASSERT_EQ(drawing_.swept.size(), 8u);
    EXPECT_EQ(result_.statistics.visibility.culled, 0u);
    std::vector<Eigen::Isometry3d> M_0;
    for (int lane = 0; lane < 8; ++lane) {
      for (int k = 0; k < 40; ++k) {
        const Vector3d n = direction();
        const double held = test::support(drawing_, drawing_.swept[static_cast<std::size_t>(lane)], n);
        for (int i = 0; i <= 16; ++i) {
          tree_->forwardKinematics(motion.configuration((lane + i / 16.0) / 8), M_0);
          const Eigen::Isometry3d& M = M_0[static_cast<std::size_t>(tree_->linkId("link3"))];
          for (const double z : {-kLength / 2, kLength / 2}) {
            const double reached = n.dot(M * Vector3d(0, 0, z)) + kRadius;
            ASSERT_LE(reached, held + 1e-13) << trial << " " << lane << " " << i;
            least_room = std::min(least_room, held - reached);
          }
        }
      }
    }
  }
  EXPECT_LT(least_room, 1e-4) << "not just large";
}

/// Points on curved solids, in directions of their own, lie in the piece that stands for them.
TEST_F(Swept, PiecesHoldTheObstacle) {
  const double margin = 0.01, grown = margin + CertifiedRequest().tolerance_distance;
  const JointMotion motion = JointMotion::linear(*tree_, Eigen::VectorXd::Zero(4), Eigen::VectorXd::Constant(4, 0.5));
  const Vector3d e(0.3, 0.5, 0.9);
  const struct {
    std::shared_ptr<fcl::CollisionGeometryd> shape;
    std::function<Vector3d(const Vector3d&)> point;  ///< farthest along a direction
    double room;                                     ///< that a polyhedron around it takes
  } cases[] = {
      {std::make_shared<fcl::Sphered>(0.7), [](const Vector3d& n) -> Vector3d { return 0.7 * n; }, 1e-9},
      {std::make_shared<fcl::Boxd>(1, 2, 3),
       [](const Vector3d& n) {
         return Vector3d(std::copysign(0.5, n.x()), std::copysign(1, n.y()), std::copysign(1.5, n.z()));
       },
       1e-9},
      {std::make_shared<fcl::Capsuled>(0.5, 2),
       [](const Vector3d& n) -> Vector3d { return 0.5 * n + Vector3d(0, 0, std::copysign(1, n.z())); }, 1e-9},
      {std::make_shared<fcl::Cylinderd>(0.5, 2),
       [](const Vector3d& n) {
         const Eigen::Vector2d flat = 0.5 * n.head<2>().normalized();
         return Vector3d(flat.x(), flat.y(), std::copysign(1, n.z()));
       },
       0.05},
      {std::make_shared<fcl::Coned>(0.5, 2),
       [](const Vector3d& n) {
         const Eigen::Vector2d flat = 0.5 * n.head<2>().normalized();
         const Vector3d rim(flat.x(), flat.y(), -1), tip(0, 0, 1);
         return n.dot(rim) > n.dot(tip) ? rim : tip;
       },
       0.05},
      {std::make_shared<fcl::Ellipsoidd>(e.x(), e.y(), e.z()),
       [e](const Vector3d& n) -> Vector3d { return e.cwiseProduct(e.cwiseProduct(n).normalized()); }, 0.3},
  };
  for (const auto& c : cases) {
    Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
    at.rotate(Eigen::AngleAxisd(0.7, direction()));
    at.translation() << 0.4, 1.2, 1.2;  // about the link
    ask(motion, c.shape, at, margin);
    ASSERT_EQ(drawing_.pieces.size(), 1u) << c.shape->getNodeType();
    for (int k = 0; k < 2000; ++k) {
      const Vector3d n = direction();
      const double reached = n.dot(at * c.point(at.linear().transpose() * n)) + grown;
      const double held = test::support(drawing_, drawing_.pieces[0].volume, n);
      ASSERT_LE(reached, held + 1e-13) << c.shape->getNodeType();
      ASSERT_LE(held, reached + c.room) << c.shape->getNodeType();
    }
  }
}

}  // namespace

}  // namespace swept_test
