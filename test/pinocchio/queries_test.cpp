// SPDX-License-Identifier: BSD-3-Clause
//
// Random robots with coal's geometries. The answers of the adapter's manager are compared with those of a manager built
// by hand, and with pinocchio and coal, which look at many configurations on the way.
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include <pinocchio/fwd.hpp>  // before boost's variant

#include <coal/hfield.h>
#include <coal/shape/geometric_shape_to_BVH_model.h>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/collision/collision.hpp>
#include <pinocchio/collision/distance.hpp>

#include "fcl_artic/pinocchio/pinocchio.h"
#include "random_robot.h"

namespace fcl_artic {
namespace queries_test {
namespace {

using test::Random;

/// These ask for added margins only, or none.
const PinocchioOptions kSweptAsMargins{true};

/// Configurations that coal looks at on the way of a motion; more with FCL_ARTIC_SAMPLES.
int samples() {
  const char* asked = std::getenv("FCL_ARTIC_SAMPLES");
  return asked ? std::atoi(asked) : 60;
}

/// coal's view of a robot.
struct Looker {
  const pinocchio::Model& model;
  const pinocchio::GeometryModel& geometries;
  pinocchio::Data data{model};
  pinocchio::GeometryData geometry_data{geometries};

  bool touches(const Eigen::VectorXd& q) {
    return pinocchio::computeCollisions(model, data, geometries, geometry_data, q, true);
  }
  /// The smallest distance of any pair, m; below 0 where they overlap.
  double distance(const Eigen::VectorXd& q) {
    pinocchio::computeDistances(model, data, geometries, geometry_data, q);
    double least = INFINITY;
    for (const auto& result : geometry_data.distanceResults) least = std::min(least, result.min_distance);
    return least;
  }
};

/// Counts of a run over many motions.
struct Tally {
  int queries = 0, free = 0, contacts = 0, uncertain = 0, initial = 0;
  int other_verdict = 0, other_time = 0, missed = 0, not_there = 0;
  long looks = 0;
  void print(const char* what) const {
    std::cout << what << ": " << queries << " motions, " << free << " free, " << contacts << " in contact (" << initial
              << " from the start, " << uncertain << " not certain); other verdicts than by hand: " << other_verdict
              << ", other times: " << other_time << "; looks of coal: " << looks << ", missed: " << missed
              << ", contacts that coal does not see: " << not_there << "\n";
  }
};

/// Asks both managers about a motion, and coal about many configurations on its way.
void ask(const PinocchioRobot& robot, const ArticulatedCollisionManager& direct, const JointMotion& motion,
         const JointMotion& direct_motion, Looker& looker, Tally& tally) {
  const CertifiedResult result = robot.manager->continuousCollide(motion);
  const CertifiedResult by_hand = direct.continuousCollide(direct_motion);
  ++tally.queries;
  tally.other_verdict += result.status != by_hand.status;
  if (result.status != Status::free && by_hand.status == result.status) {
    tally.other_time += result.t_lower > by_hand.t_upper || by_hand.t_lower > result.t_upper;
  }
  const auto at = [&](double t) { return robot.toPinocchio(motion.configuration(t)); };
  if (result.status == Status::free) {
    ++tally.free;
  } else {
    ++tally.contacts;
    tally.uncertain += !result.certain;
    tally.initial += result.t_lower <= 0;
    // coal's GJK stops at 1e-6 m.
    if (result.certain)
      tally.not_there += !looker.touches(at(result.t_upper)) && looker.distance(at(result.t_upper)) > 2e-6;
  }
  const double until = result.status == Status::free ? 1 : result.t_lower;
  const int n = samples();
  for (int k = 0; k <= n; ++k) {
    const double t = until * k / n;
    if (result.status != Status::free && t >= until) break;  // at t_lower the gap is rounding's
    ++tally.looks;
    if (looker.touches(at(t)) && looker.distance(at(t)) < -1e-6) {
      ++tally.missed;
      break;
    }
  }
}

/// 1,000 motions of random robots of these joints.
Tally randomQueries(std::uint64_t seed, const std::vector<JointType>& kinds) {
  Random random(seed);
  Tally tally;
  for (int r = 0; r < 50; ++r) {
    const test::RandomRobot description = test::randomRobot(random, kinds);
    pinocchio::Model model;
    pinocchio::GeometryModel geometries;
    test::makePinocchio(description, model, geometries);
    const PinocchioRobot robot = fromPinocchio(model, geometries, kSweptAsMargins);
    const test::DirectRobot direct = test::makeDirect(description);
    Looker looker{model, geometries};
    EXPECT_EQ(robot.tree->dof(), direct.tree->dof());
    for (int i = 0; i < 20; ++i) {
      const Eigen::VectorXd q0 = test::randomConfiguration(*direct.tree, random, 2);
      Eigen::VectorXd q1 = test::randomConfiguration(*direct.tree, random, 2);
      if (i % 2) q1 = q0 + 0.2 * (q1 - q0);
      for (int v = 0; v < q1.size(); ++v) {
        if (direct.tree->variableName(v).find("/rot_x") != std::string::npos) q1.segment<4>(v).normalize();
      }
      // Both by way of pinocchio's q, as a user of the adapter has it, and straight.
      ask(robot, *direct.manager, robot.motion(robot.toPinocchio(q0), robot.toPinocchio(q1)),
          JointMotion::shortest(*direct.tree, q0, q1), looker, tally);
    }
  }
  return tally;
}

void expectRight(const Tally& tally) {
  EXPECT_EQ(tally.queries, 1000);
  EXPECT_GT(tally.free, 100);
  EXPECT_GT(tally.contacts - tally.initial, 100);
  EXPECT_EQ(tally.other_verdict, 0);
  EXPECT_EQ(tally.other_time, 0);
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.not_there, 0);
}

TEST(PinocchioQueries, ThousandMotionsOfTurnsAndSlides) {
  const Tally tally = randomQueries(13, {JointType::revolute, JointType::continuous, JointType::prismatic});
  tally.print("turns and slides");
  expectRight(tally);
}

TEST(PinocchioQueries, ThousandMotionsOfAllJoints) {
  const Tally tally = randomQueries(12, {JointType::revolute, JointType::continuous, JointType::prismatic,
                                         JointType::planar, JointType::spherical, JointType::floating});
  tally.print("all joints");
  expectRight(tally);
}

/// A post, an arm of two joints with a box along its first link, a ball at its end.
struct Arm {
  pinocchio::Model model;
  pinocchio::GeometryModel geometries;
  pinocchio::GeomIndex post, link1, link2;
  explicit Arm(std::shared_ptr<coal::CollisionGeometry> tip = std::make_shared<coal::Sphere>(0.1)) {
    using pinocchio::SE3;
    const auto at = [](double x, double y, double z) {
      return SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, y, z));
    };
    const auto shoulder = model.addJoint(0, pinocchio::JointModelRZ(), SE3::Identity(), "shoulder");
    const auto elbow = model.addJoint(shoulder, pinocchio::JointModelRZ(), at(1, 0, 0), "elbow");
    const auto add = [&](const char* name, pinocchio::JointIndex joint, std::shared_ptr<coal::CollisionGeometry> body,
                         const SE3& placement) {
      return geometries.addGeometryObject(pinocchio::GeometryObject(name, joint, placement, std::move(body)));
    };
    post = add("post", 0, std::make_shared<coal::Box>(0.2, 0.2, 1), at(0, 2, 0));
    link1 = add("link1", shoulder, std::make_shared<coal::Box>(0.9, 0.1, 0.1), at(0.5, 0, 0));
    link2 = add("tip", elbow, std::move(tip), at(1, 0, 0));
  }
};

TEST(PinocchioQueries, WorkedNumber) {
  // The stretched arm turns from 0 to π: the ball's centre at (2 cos φ, 2 sin φ) meets the post's face x = 0.1 where
  // 2 cos φ = 0.2 while |2 sin φ - 2| < 0.1 does not matter yet: at cos φ = 0.1, y = 1.98997, within the face.
  Arm arm;
  arm.geometries.addCollisionPair({arm.post, arm.link2});
  const PinocchioRobot robot = fromPinocchio(arm.model, arm.geometries);
  const CertifiedResult result =
      robot.manager->continuousCollide(robot.motion(Eigen::Vector2d(0, 0), Eigen::Vector2d(M_PI, 0)));
  ASSERT_TRUE(result.certain);
  EXPECT_NEAR(result.t_lower, std::acos(0.1) / M_PI, 2e-6);
  EXPECT_EQ(result.first()->body1.name, "tip");
  EXPECT_EQ(result.first()->body2.name, "post");
}

TEST(PinocchioQueries, OnlyPairsThatAreListedAreChecked) {
  Arm arm;
  const Eigen::Vector2d q0(0, 0), q1(M_PI, 0);
  PinocchioRobot robot = fromPinocchio(arm.model, arm.geometries);
  EXPECT_TRUE(robot.manager->isFree(robot.motion(q0, q1)));
  arm.geometries.addCollisionPair({arm.post, arm.link1});
  robot = fromPinocchio(arm.model, arm.geometries);
  EXPECT_TRUE(robot.manager->isFree(robot.motion(q0, q1)));
  arm.geometries.addCollisionPair({arm.post, arm.link2});
  EXPECT_FALSE(fromPinocchio(arm.model, arm.geometries).manager->isFree(robot.motion(q0, q1)));
  arm.geometries.geometryObjects[arm.link2].disableCollision = true;
  EXPECT_TRUE(fromPinocchio(arm.model, arm.geometries).manager->isFree(robot.motion(q0, q1)));
}

TEST(PinocchioQueries, NeighboursAreCheckedWhereTheyAreListed) {
  // The elbow folds the ball, 1 m from it, onto the beginning of the box: a pair that a manager takes for
  // neighbours unless the adapter sees to it.
  Arm arm;
  arm.geometries.addCollisionPair({arm.link1, arm.link2});
  const PinocchioRobot robot = fromPinocchio(arm.model, arm.geometries);
  EXPECT_EQ(robot.manager->checkedLinkPairs().size(), 1u);
  const CertifiedResult result =
      robot.manager->continuousCollide(robot.motion(Eigen::Vector2d(0, 0), Eigen::Vector2d(0, M_PI)));
  EXPECT_EQ(result.status, Status::contact);
  ASSERT_NE(result.first(), nullptr);
  EXPECT_EQ(result.first()->body1.name + result.first()->body2.name, "link1tip");
}

/// Planners list all pairs with an obstacle or a tool that is added, those on its own joint too. No motion has these
/// touch, and the notes name pairs on a joint that do.
TEST(PinocchioQueries, PairsOnOneJointStandStill) {
  Arm arm;
  const auto add = [&](const char* name, pinocchio::JointIndex on) {
    return arm.geometries.addGeometryObject(
        pinocchio::GeometryObject(name, on, arm.geometries.geometryObjects[on == 0 ? arm.post : arm.link2].placement,
                                  std::make_shared<coal::Sphere>(0.01)));
  };
  const auto twin = add("twin", 2), base = add("base", 0);
  for (const pinocchio::CollisionPair& pair :
       {pinocchio::CollisionPair(arm.link2, twin), pinocchio::CollisionPair(arm.post, base),
        pinocchio::CollisionPair(arm.post, arm.link2)}) {
    arm.geometries.addCollisionPair(pair);
  }
  const PinocchioRobot robot = fromPinocchio(arm.model, arm.geometries);
  EXPECT_TRUE(robot.manager->isFree(robot.motion(Eigen::Vector2d(0, 0), Eigen::Vector2d(0.5, 0))));
  EXPECT_FALSE(robot.manager->isFree(robot.motion(Eigen::Vector2d(0, 0), Eigen::Vector2d(M_PI, 0))));
  const std::vector<std::string> notes = robot.manager->notes();
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("twin"), std::string::npos) << notes[0];
}

TEST(PinocchioQueries, CarriedObjectsTouchWhatTheyMay) {
  Arm arm;
  arm.geometries.addCollisionPair({arm.post, arm.link2});
  const PinocchioRobot robot = fromPinocchio(arm.model, arm.geometries);
  auto cup = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2));
  robot.manager->registerObject(cup, "cup");
  robot.manager->attach(robot.link(2), cup, Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0)), robot.geometries(2));
  robot.manager->setup();
  EXPECT_TRUE(robot.manager->isFree(robot.motion(Eigen::Vector2d(0, 0), Eigen::Vector2d(0.5, 0))));
  EXPECT_FALSE(robot.manager->isFree(robot.motion(Eigen::Vector2d(0, 0), Eigen::Vector2d(M_PI, 0))));
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(PinocchioQueries, WhatCannotBeCheckedIsNamed) {
  const auto with_tip = [](std::shared_ptr<coal::CollisionGeometry> tip) {
    return refusal([&] {
      const Arm arm(std::move(tip));
      fromPinocchio(arm.model, arm.geometries);
    });
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(with_tip(std::make_shared<coal::HeightField<coal::AABB>>(1, 1, Eigen::MatrixXd::Ones(3, 3))),
         "geometry 'tip': this type of geometry is not supported");
  expect(with_tip(std::make_shared<coal::Halfspace>(Eigen::Vector3d::UnitZ(), 0)), "geometry 'tip'");
  expect(with_tip(std::make_shared<coal::BVHModel<coal::OBBRSS>>()), "geometry 'tip': the mesh has no triangle");
  expect(with_tip(nullptr), "geometry 'tip': it has no geometry");
  expect(with_tip(std::make_shared<coal::Sphere>(-1)), "geometry 'tip'");
  Arm arm;
  const auto twin = arm.geometries.addGeometryObject(
      pinocchio::GeometryObject("twin", 2, pinocchio::SE3::Identity(), std::make_shared<coal::Sphere>(0.1)));
  arm.geometries.geometryObjects[twin].name = "tip";
  expect(refusal([&] { fromPinocchio(arm.model, arm.geometries); }), "two geometries are named 'tip'");
}

/// A margin that stands for a swept radius takes the place of a request's, which nobody would notice.
TEST(PinocchioQueries, MarginsOfRequestsAreNotDroppedUnasked) {
  const auto armWith = [](const std::shared_ptr<coal::ShapeBase>& shape) {
    shape->setSweptSphereRadius(0.05);
    Arm arm;
    const auto index = arm.geometries.addGeometryObject(pinocchio::GeometryObject(
        "swept", 0, pinocchio::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 2.35, 0)), shape));
    arm.geometries.addCollisionPair({arm.link2, index});
    return arm;
  };
  // The ball reaches y = 2.1 at most, the swept bodies begin at 2.25.
  const Arm boxed = armWith(std::make_shared<coal::Box>(0.1, 0.1, 0.1));
  const std::string message = refusal([&] { fromPinocchio(boxed.model, boxed.geometries); });
  EXPECT_NE(message.find("geometry 'swept': it is swept with a ball of radius 0.05"), std::string::npos) << message;
  const Eigen::Vector2d q0(0.3, 0), q1(2.8, 0);
  const auto free = [&](const PinocchioRobot& robot, double margin, double added) {
    CertifiedRequest request;
    request.margin = margin;
    request.added_margin = added;
    return robot.manager->continuousCollide(robot.motion(q0, q1), request).status == Status::free;
  };
  const PinocchioRobot robot = fromPinocchio(boxed.model, boxed.geometries, kSweptAsMargins);
  EXPECT_TRUE(free(robot, 0, 0.14));
  EXPECT_FALSE(free(robot, 0, 0.16));
  // A ball's and a capsule's radius has it: margins of requests count.
  const Arm round = armWith(std::make_shared<coal::Sphere>(0.05));
  const PinocchioRobot ball = fromPinocchio(round.model, round.geometries);
  EXPECT_TRUE(free(ball, 0.14, 0));
  EXPECT_FALSE(free(ball, 0.16, 0));
}

/// Every geometry that fromCoal() takes, as an obstacle in the ball's way, and a little out of it.
TEST(PinocchioQueries, EveryGeometryOfCoals) {
  const auto octree = std::make_shared<octomap::OcTree>(0.1);
  octree->updateNode(octomap::point3d(0.05f, 0.05f, 0.05f), true);
  auto mesh = std::make_shared<coal::BVHModel<coal::OBBRSS>>();
  coal::generateBVHModel(*mesh, coal::Box(0.2, 0.2, 0.2), coal::Transform3s());
  auto kdop = std::make_shared<coal::BVHModel<coal::KDOP<18>>>();
  coal::generateBVHModel(*kdop, coal::Sphere(0.1), coal::Transform3s(), 12, 12);
  auto rounded = std::make_shared<coal::Box>(0.1, 0.1, 0.1);
  rounded->setSweptSphereRadius(0.05);
  const std::vector<std::shared_ptr<coal::CollisionGeometry>> bodies{
      std::make_shared<coal::Box>(0.2, 0.2, 0.2),
      std::make_shared<coal::Sphere>(0.1),
      std::make_shared<coal::Ellipsoid>(0.1, 0.1, 0.2),
      std::make_shared<coal::Capsule>(0.1, 0.3),
      std::make_shared<coal::Cone>(0.1, 0.3),
      std::make_shared<coal::Cylinder>(0.1, 0.3),
      mesh,
      kdop,
      rounded,
      std::make_shared<coal::Halfspace>(Eigen::Vector3d(0, -1, 0), 0),
      std::make_shared<coal::Plane>(Eigen::Vector3d(0, 1, 0), 0),
      std::make_shared<coal::TriangleP>(Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(-0.1, 0, 0.1),
                                        Eigen::Vector3d(0, 0, -0.1)),
      std::make_shared<coal::OcTree>(octree)};
  for (const auto& body : bodies) {
    Arm arm;
    // The ball reaches y = 2.1 at most, on the y axis.
    const auto add = [&](const char* name, double y) {
      const auto index = arm.geometries.addGeometryObject(pinocchio::GeometryObject(
          name, 0, pinocchio::SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, y, 0)), body));
      arm.geometries.addCollisionPair({arm.link2, index});
      return index;
    };
    const int type = body->getNodeType();
    const auto far = add("far", 2.35);
    PinocchioRobot robot = fromPinocchio(arm.model, arm.geometries, kSweptAsMargins);
    const Eigen::Vector2d q0(0.3, 0), q1(2.8, 0);
    EXPECT_TRUE(robot.manager->isFree(robot.motion(q0, q1))) << "node type " << type;
    arm.geometries.geometryObjects[far].placement.translation().y() = 2.05;
    robot = fromPinocchio(arm.model, arm.geometries, kSweptAsMargins);
    EXPECT_FALSE(robot.manager->isFree(robot.motion(q0, q1))) << "node type " << type;
  }
}

}  // namespace
}  // namespace queries_test
}  // namespace fcl_artic
