// SPDX-License-Identifier: BSD-3-Clause
//
// Clusters of clouds beside a judge that knows poses and points only: times proven free are sampled. The balls' radii
// are made by the motion, so that most are missed narrowly, and some are not. Then lanes of one cluster have different
// answers: a box that is a little too small, or a lane too many, shows.
// FCL_ARTIC_CLUSTER_CASES and FCL_ARTIC_CLUSTER_SEED in the environment ask for more and for others.
#include <algorithm>
#include <cmath>

#include <fcl/geometry/shape/capsule.h>

#include "../support/random_placing.h"
#include "arms.h"
#include "expect.h"
#include "fcl_artic/point_cloud.h"
#include "own_kinematics.h"

namespace cloud_clusters_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr int kPoses = 192;

/// One to three joints in a row.
struct Robot {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("robot");
  std::vector<Joint> joints;
  std::vector<int> parents;
  VectorXd begin, end;

  explicit Robot(Random& random) {
    tree->addLink("l0");
    const int count = 1 + random.below(3);
    begin = end = VectorXd::Zero(count);
    for (int i = 0; i < count; ++i) {
      const std::string from = tip(), to = "l" + std::to_string(i + 1);
      tree->addLink(to);
      const JointType type = random.oneIn(3) ? JointType::prismatic : JointType::continuous;
      const Vector3d axis = random.direction();
      joints.push_back(makeJoint("j" + std::to_string(i), type, from, to, axis, random.pose(0.3)));
      joints.back().axis.normalize();
      tree->addJoint(joints.back());
      parents.push_back(i);
      begin[i] = random.uniform(-1, 1);
      end[i] = begin[i] + random.uniform(-1, 1) * (type == JointType::prismatic ? 0.5 : 1.5);
    }
  }
  /// The name of the last link, and its pose.
  std::string tip() const { return "l" + std::to_string(joints.size()); }
  Isometry3d pose(double t) const { return linkPoses(joints, parents, begin + t * (end - begin)).back(); }
};

/// A capsule and a cloud: the robot carries the one, the other one stands still.
struct Scene {
  explicit Scene(Random& random) : robot(random) {
    carries_cloud = random.oneIn(2);
    place = random.pose(0.5);
    half = random.logUniform(0.01, 0.3);
    radius = random.logUniform(0.005, 0.1);
    std::vector<Isometry3d> seen;
    for (int k = 0; k <= kPoses; ++k) seen.push_back(cloudFromCapsule(static_cast<double>(k) / kPoses));
    static const int kSizes[] = {2, 3, 15, 16, 17, 31, 32, 33, 48, 64};
    const int size = kSizes[random.below(10)];
    const double width = random.logUniform(1e-3, 0.1);
    touches = random.oneIn(2);
    Vector3d middle = Vector3d::Zero();  // of sixteen points
    for (int i = 0; i < size; ++i) {
      if (i % 16 == 0) middle = random.of(seen).inverse() * random.box(half + 0.1);
      const bool again = i > 0 && random.oneIn(10);
      points.push_back(again ? points[static_cast<std::size_t>(random.below(i))] : middle + random.box(width));
      double least = 1e9;
      for (const Isometry3d& X : seen) least = std::min(least, fromCapsule(X * points.back()));
      const bool met = touches && random.oneIn(size / 2 + 1);
      const double gap = met ? -random.logUniform(1e-6, 1e-2) : random.logUniform(1e-7, 1e-2);
      const double most = random.oneIn(4) ? random.logUniform(1e-9, 1e-2) : 1, ball = std::min(least - gap, most);
      radii.push_back(ball > 0 ? ball : random.logUniform(1e-9, 1e-4));
    }
  }
  Isometry3d cloudFromCapsule(double t) const {
    const Isometry3d tip = robot.pose(t);
    return carries_cloud ? place.inverse() * tip : tip.inverse() * place;
  }
  double fromCapsule(const Vector3d& x) const {
    return Vector3d(x[0], x[1], std::max(0.0, std::abs(x[2]) - half)).norm() - radius;
  }
  double gapAt(double t) const {
    const Isometry3d X = cloudFromCapsule(t);
    double gap = 1e9;
    for (std::size_t i = 0; i < points.size(); ++i) gap = std::min(gap, fromCapsule(X * points[i]) - radii[i]);
    return gap;
  }
  CertifiedResult ask(const CertifiedRequest& request) const {
    const auto cloud = object(std::make_shared<PointCloud>(points, radii));
    const auto capsule = object(std::make_shared<fcl::Capsuled>(radius, 2 * half));
    const auto& still = carries_cloud ? capsule : cloud;
    still->setTransform(place);
    ArticulatedCollisionManager manager(robot.tree);
    manager.bind(robot.tip(), carries_cloud ? cloud : capsule);
    manager.registerObject(still, "still");
    manager.setup();
    return test::ask(manager, robot.begin, robot.end, request);
  }

  Robot robot;
  bool carries_cloud, touches;
  Isometry3d place;  ///< of what stands still
  double half, radius;
  std::vector<Vector3d> points;  ///< in the cloud's frame
  std::vector<double> radii;
};

void lookAtCase(campaign::Case& c) {
  Random random(c.id.seed);
  const Scene scene(random);
  CertifiedRequest request;
  request.mode = static_cast<ContactMode>(random.below(3));
  const CertifiedResult r = scene.ask(request);
  const auto fault = [&](const char* kind, double t, double gap) {
    c.fault(kind, campaign::format("%s [%.12g, %.12g], mode %d: gap %g at %.12g, %zu balls", toString(r.status),
                                   r.t_lower, r.t_upper, static_cast<int>(request.mode), gap, t, scene.points.size()));
  };
  if (r.status == Status::undecided) return fault("undecided", 0, 0);
  constexpr double kLess = 1e-11;  // m: what the judge's own poses may be off
  double least = 1e9;
  for (int k = 0; k <= kPoses; ++k) {
    const double t = static_cast<double>(k) / kPoses;
    if (!r.isFree() && t >= r.t_lower) break;
    const double gap = scene.gapAt(t);
    least = std::min(least, gap);
    if (gap < -kLess) return fault("missed", t, gap);
  }
  if (r.status == Status::contact && r.t_lower > 0) {  // just before it
    const double t = r.t_lower * (1 - 1e-12), gap = scene.gapAt(t);
    if (gap < -kLess) return fault("missed", t, gap);
  }
  if (r.certain && request.mode != ContactMode::any) {
    const double gap = std::min(scene.gapAt(r.t_lower), scene.gapAt(r.t_upper));
    if (gap > 1e-5) fault("no contact", r.t_upper, gap);
  }
  const std::string which = scene.carries_cloud ? "carried" : "still";
  c.tally.count(which + ", free", r.isFree());
  c.tally.count(which + ", free within 1e-5 m", r.isFree() && least < 1e-5);
  c.tally.count(which + ", later contact", r.status == Status::contact && r.t_lower > 0);
  c.tally.count("contact at once", r.status == Status::contact && r.t_lower == 0);
  c.tally.count("leaves", r.statistics.leaf_tests > 0);
}

}  // namespace

TEST(CloudClusters, FreeTimesHaveNoContact) {
  campaign::Campaign clusters;
  clusters.look = lookAtCase;
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_CLUSTER", 6000);
  const campaign::Tally all = runWithoutFaults(clusters, o).total;
  for (const char* which : {"still", "carried"}) {
    EXPECT_GT(all.share(which + std::string(", free")), 0.05);
    EXPECT_GT(all.share(which + std::string(", free within 1e-5 m")), 0.03);
    EXPECT_GT(all.share(which + std::string(", later contact")), 0.05);
  }
  EXPECT_GT(all.share("leaves"), 0.5);
}

}  // namespace cloud_clusters_test
