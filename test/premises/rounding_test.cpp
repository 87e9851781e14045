// SPDX-License-Identifier: BSD-3-Clause
//
// Every public entry, the readers of files and the texts of messages in all four rounding modes, beside their answers
// in the usual one. Whole numbers of turns, verdicts and words are the same. Times and lengths are the same but for
// rounding and the tolerances. The caller finds his mode again.
#include <cfenv>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <gtest/gtest.h>

#include "all_modes.h"
#include "arms.h"
#include "fcl_artic/fcl_artic.h"
#include "fcl_artic/urdf/urdf.h"
#include "meshes.h"
#include "temp_folder.h"
#include "text/nearest_name.h"
#include "text/xml.h"

#ifdef FCL_ARTIC_HDF5
#include "hdf5/hdf5.h"
#endif
#ifdef FCL_ARTIC_VERIFIER
#include "proof.h"
#endif
#ifdef FCL_ARTIC_PLANS
#include "plans/motion.h"
#include "plans/plan.h"
#include "plans/write.h"
#endif

namespace rounding_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using premises_test::expectSameInAllModes;
using premises_test::Said;
using test::makeJoint;
using test::object;
using test::pose;

/// Joints of all types: a wheel that turns forever and its follower, a rail, a drive in the plane, a ball, a drone.
std::shared_ptr<KinematicTree> allJoints() {
  auto tree = std::make_shared<KinematicTree>("all");
  const char* links[] = {"world", "wheel", "follower", "rail", "drive", "ball", "drone"};
  for (const char* link : links) tree->addLink(link);
  tree->addJoint(
      makeJoint("turn", JointType::continuous, "world", "wheel", {1, 2, 2}, pose({0.1, 0, 0}, 0.3, {1, 1, 1})));
  Joint follows = makeJoint("follow", JointType::revolute, "wheel", "follower", {0.3, 0.4, 0}, pose({0.2, 0.1, 0}));
  follows.mimics = true;
  follows.mimic = {"turn", 2, 0.1};
  tree->addJoint(follows);
  tree->addJoint(makeJoint("slide", JointType::prismatic, "follower", "rail", {0.1, 0.2, 0.3}, pose({0, 0.3, 0}, 1)));
  tree->addJoint(makeJoint("drive", JointType::planar, "world", "drive", {0.1, 0.2, -0.9}, pose({3, 0, 0})));
  tree->addJoint(
      makeJoint("ball", JointType::spherical, "rail", "ball", {1, 0, 0}, pose({0.2, 0, 0.1}, 0.7, {0, 1, 2})));
  tree->addJoint(makeJoint("fly", JointType::floating, "world", "drone", {1, 0, 0}, pose({0, 4, 0})));
  return tree;
}

VectorXd waypoint(const KinematicTree& tree, double s) {
  VectorXd q = tree.neutralConfiguration();
  for (int v = 0; v < tree.dof(); ++v) q[v] = std::sin(1.3 * v + s) + 0.1 * s;
  for (const JointId j : tree.quaternionJoints()) q.segment<4>(tree.quaternionVariable(j)).normalize();
  return q;
}

void addMotion(Said& said, const KinematicTree& tree, const JointMotion& motion) {
  std::vector<Isometry3d> M_0;
  for (const double t : {0.0, 0.3, 1.0}) {
    const VectorXd q = motion.configuration(t);
    said.addAll(q);
    tree.forwardKinematics(q, M_0);
    for (const Isometry3d& M : M_0) said.add(M);
  }
}

TEST(RoundingModes, Motions) {
  expectSameInAllModes("tree and motions", [](Said& said) {
    const auto tree = allJoints();
    for (const double s : {0.2, 3.1}) {
      const VectorXd q0 = waypoint(*tree, 0), q1 = waypoint(*tree, s);
      addMotion(said, *tree, JointMotion::linear(*tree, q0, q1));
      addMotion(said, *tree, JointMotion::still(*tree, q1));
      addMotion(said, *tree, JointMotion::tangentHalfAngle(*tree, q0, q1));
      VectorXd far = q1;
      for (const double turns : {-7.0, 0.6, 3.0, 3.3}) {
        far[0] = q0[0] + turns;
        far[tree->jointVariable(tree->jointId("drive")) + 2] -= turns;
        addMotion(said, *tree, JointMotion::shortest(*tree, q0, far));
      }
      MatrixXd c = MatrixXd::Zero(tree->dof(), 4);
      c.col(0) = q0;
      c.col(3).setConstant(0.1);
      for (const JointId j : tree->quaternionJoints()) c(tree->quaternionVariable(j) + 3, 3) = 0;
      addMotion(said, *tree, JointMotion::polynomial(*tree, c));
      addMotion(said, *tree, JointMotion::tangentHalfAnglePolynomial(*tree, c, q0));
    }
    for (const std::string& note : tree->limitNotes(waypoint(*tree, 1))) said.words << note << '\n';
    const auto between = inBetweenTree(*tree);
    std::vector<Isometry3d> begin, end;
    tree->forwardKinematics(waypoint(*tree, 0), begin);
    tree->forwardKinematics(waypoint(*tree, 1), end);
    addMotion(said, *between, inBetweenMotion(*between, begin, end));
    const FclLinkMotion link(*tree, JointMotion::linear(*tree, waypoint(*tree, 0), waypoint(*tree, 1)), 5,
                             pose({0.1, 0, 0}, 0.2));
    for (const double t : {0.0, 0.4, 1.0}) said.add(link.pose(t));
    said.add(link.speedBound(1));
    said.add(link.accelerationBound(1));
  });
}

/// The motion asked for is the one that is proven: 0 to 0.6 rad is no turn of -5.683.
TEST(RoundingModes, Trajectories) {
  expectSameInAllModes("trajectories", [](Said& said) {
    KinematicTree tree("wheel");
    tree.addLink("world");
    tree.addLink("wheel");
    tree.addLink("cart");
    tree.addJoint(makeJoint("turn", JointType::continuous, "world", "wheel", Vector3d::UnitZ()));
    tree.addJoint(makeJoint("drive", JointType::planar, "world", "cart", Vector3d::UnitZ()));
    const std::vector<double> times = {0, 0.7, 1.9, 3.1, 4, 5.3, 6, 7};
    std::vector<VectorXd> waypoints, rates;
    for (const double angle : {0.0, 0.6, -0.3, 3.4, 3.1, -3.1, 40.0, 40.0 + 3.14159}) {
      waypoints.push_back(Eigen::Vector4d(angle, 0.1 * angle, 1, -angle));
      rates.push_back(Eigen::Vector4d(0.1, 0.2, -0.1, std::sin(angle)));
    }
    const auto add = [&](const JointTrajectory& trajectory) {
      for (int i = 0; i <= 40; ++i) {
        const double t = trajectory.beginTime() + (trajectory.endTime() - trajectory.beginTime()) * i / 40;
        said.addAll(trajectory.configuration(t));
      }
      said.words << trajectory.numPieces() << " pieces; ";
    };
    for (const auto unwrap : {JointTrajectory::Unwrap::no, JointTrajectory::Unwrap::yes}) {
      add(JointTrajectory::linear(tree, times, waypoints, unwrap));
      add(JointTrajectory::cubic(tree, times, waypoints, rates, unwrap));
      add(JointTrajectory::quintic(tree, times, waypoints, rates, rates, unwrap));
      add(JointTrajectory::parabolicBlends(tree, times, waypoints, 0.2, unwrap));
    }
    add(JointTrajectory::tangentHalfAngle(tree, {0, 1, 2}, {waypoints[0], waypoints[1], waypoints[2]}));
    add(JointTrajectory::bspline(tree, 3, {0, 0, 0, 0, 0.3, 0.9, 1.7, 2, 3, 3, 3, 3}, waypoints));
    MatrixXd c = MatrixXd::Zero(4, 2);
    c.col(1) << 0.1, 0.2, 0.3, 0.4;
    MatrixXd next = c;
    next.col(0) = c.col(0) + 2 * c.col(1);
    add(JointTrajectory::piecewise(tree, {1, 3, 4}, {c, next}));
  });
  // Half a turn goes as the values say.
  KinematicTree tree("wheel");
  tree.addLink("world");
  tree.addLink("wheel");
  tree.addJoint(makeJoint("turn", JointType::continuous, "world", "wheel", Vector3d::UnitZ()));
  for (const int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    const std::vector<VectorXd> ends = {VectorXd::Zero(1), VectorXd::Constant(1, M_PI)};
    std::fesetround(mode);
    const auto half = JointTrajectory::linear(tree, {0, 1}, ends, JointTrajectory::Unwrap::yes);
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(half.configuration(1)[0], M_PI) << mode;
  }
}

/// An arm of three links, the last of which is a mesh, obstacles that stand and one that moves.
struct Cell {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> links;
  std::shared_ptr<fcl::CollisionObjectd> box = object(std::make_shared<fcl::Boxd>(0.3, 0.3, 0.3),
                                                      pose({1.1, 0.9, 0}, 0.3)),
                                         carried = test::ball(0.1),
                                         floor = object(std::make_shared<fcl::Halfspaced>(Vector3d(0, 0.1, 1), -1.1));
  std::shared_ptr<fcl::ContinuousCollisionObjectd> moving;
  ArticulatedCollisionManager manager;

  Cell() : manager(makeTree()) {
    for (const char* link : {"upper", "fore", "hand"}) {
      const bool hand = std::string(link) == "hand";
      links.push_back(hand ? object(test::boxMesh(Vector3d(0.1, 0.07, 0.05))) : test::ball(0.15));
      manager.bind(link, links.back().get(), pose({0.3, 0, 0}, 0.2));
    }
    manager.registerObject(box.get(), "box");
    manager.registerObject(carried.get(), "carried");
    manager.registerObject(floor.get(), "floor");
    const Isometry3d far = pose({-1.5, 0, 0}), near = pose({-0.7, 0.2, 0});
    moving = std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(0.1),
                                                               std::make_shared<fcl::TranslationMotiond>(far, near));
    manager.registerObject(moving.get(), "moving");
    manager.attach("hand", carried.get(), pose({0.25, 0, 0}), {"hand"});
    manager.setMargin("box", 0.01);
    manager.setup();
  }

 private:
  std::shared_ptr<KinematicTree> makeTree() {
    for (const char* link : {"base", "upper", "fore", "hand"}) tree->addLink(link);
    tree->addJoint(Joint::revolute("shoulder", "base", "upper", {0.1, 0, 1}, Isometry3d::Identity(), -3, 3));
    tree->addJoint(Joint::revolute("elbow", "upper", "fore", {0, 0.1, 1}, pose({0.6, 0, 0}), -3, 3));
    tree->addJoint(Joint::revolute("wrist", "fore", "hand", {1, 0.2, 0.3}, pose({0.6, 0, 0}), -3, 3));
    return tree;
  }
};

TEST(RoundingModes, Managers) {
  expectSameInAllModes("a manager", [](Said& said) {
    Cell cell;
    const ArticulatedCollisionManager& manager = cell.manager;
    const Vector3d q0(-1, 0.2, 0), q1(1, 0.4, 0.5), aside(-0.9, 0.3, 0.2);
    for (const Method method : {Method::standard, Method::redon2004}) {
      for (const ContactMode mode : {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair}) {
        CertifiedRequest request;
        request.method = method;
        request.mode = mode;
        for (const Vector3d& to : {q1, aside}) {
          const CertifiedResult result = manager.continuousCollide(q0, to, request);
          if (mode == ContactMode::any) {
            said.words << result.status << ' ' << result.certain << "; ";
          } else {
            said.add(result);
          }
        }
      }
    }
    CertifiedRequest request;
    request.added_margin = 0.02;
    request.certificate = true;
    const CertifiedResult free = manager.continuousCollide(q0, aside, request);
    said.add(free);
    said.words << "free " << manager.isFree(q0, aside) << manager.isFree(q0, q1) << "; ";
    said.add(manager.collide(q0));
    said.add(manager.collide(q1));
    std::vector<CertifiedResult> results;
    manager.continuousCollide({JointMotion::linear(*cell.tree, q0, q1), JointMotion::linear(*cell.tree, q0, aside)}, {},
                              results, 2);
    for (const CertifiedResult& result : results) said.add(result);
    said.add(manager.continuousCollide(JointTrajectory::cubic(
        *cell.tree, {0, 2, 3}, {q0, aside, q1}, {Vector3d(0, 0, 0), Vector3d(0.1, 0, 0), Vector3d(0, 0, 0)})));
    const Clearance clearance = manager.clearance(JointMotion::linear(*cell.tree, q0, aside));
    said.words << (clearance.upper - clearance.lower < 2e-3) << "; ";
    request = {};
    request.margin = 0.99 * clearance.lower;
    said.words << "clear " << manager.isFree(q0, aside, request);
    request.margin = 1.01 * clearance.upper;
    said.words << manager.isFree(q0, aside, request) << "; ";
#ifdef FCL_ARTIC_VERIFIER
    const verify::World world = verify::readWorld(*free.certificate->world);
    const std::string record = free.certificate->record();
    said.words << verify::verifyRecord(world, verify::splitRecords(record).at(0)).reason << "; ";
#endif
    said.add(manager.boundOffset(cell.links[0].get()));
    cell.manager.detach(cell.carried.get());
    cell.manager.setVisibility(std::make_shared<VisibilityCuller>());
    cell.manager.update();
    said.add(cell.manager.continuousCollide(q0, q1));
    const auto post = object(std::make_shared<fcl::Boxd>(0.1, 0.3, 0.7), pose({0.9, 0.4, 0.1}, 0.7, {1, 2, 3}));
    cell.manager.replaceObstacles({post, cell.box}, {"post", "box"});
    said.add(cell.manager.continuousCollide(q0, q1));
    LinkPairOptions few;
    few.samples = 100;
    const LinkPairReport report = cell.manager.classifyLinkPairs(few);
    said.words << report.pairs.size() << " pairs";
  });
}

TEST(RoundingModes, Pairs) {
  expectSameInAllModes("pairs", [](Said& said) {
    const auto box = std::make_shared<fcl::Boxd>(1, 0.6, 0.4);
    const auto mesh = test::boxMesh(Vector3d(0.3, 0.2, 0.4));
    const auto solid = makeSolid(*mesh);
    const auto cloud = std::make_shared<PointCloud>(std::vector<Vector3d>{{0, 0, 0}, {0.1, 0.3, 0.2}}, 0.11);
    const auto wall = std::make_shared<fcl::Planed>(Vector3d(0.6, 0.1, 0.3), 0.3);
    const Isometry3d begin = pose({-2, 0.1, 0}, 0.3, {1, 2, 3}), end = pose({2, 0.2, 0.1}, 1.9, {-1, 2, 1});
    const Isometry3d still = pose({0, 0, 0}, 0.1, {1, 0, 1});
    Vector3d Td[4], Rd[4];
    for (int i = 0; i < 4; ++i) {
      Td[i] = Vector3d(1.2 * i - 2.2, 0.1, 0.01 * i);
      Rd[i] = Vector3d(0.1 * i, 0.2, -0.3 * i);
    }
    const std::vector<std::shared_ptr<fcl::MotionBased>> motions = {
        std::make_shared<fcl::TranslationMotiond>(begin, end),
        std::make_shared<fcl::InterpMotion<double>>(begin.linear(), begin.translation(), end.linear(),
                                                    end.translation(), Vector3d(0.1, 0.2, 0)),
        std::make_shared<fcl::ScrewMotion<double>>(begin, end),
        std::make_shared<fcl::SplineMotion<double>>(Td[0], Td[1], Td[2], Td[3], Rd[0], Rd[1], Rd[2], Rd[3])};
    const fcl::TranslationMotiond stays(still, still);
    const std::shared_ptr<fcl::CollisionGeometryd> geometries[] = {box, mesh, solid, cloud, wall};
    for (const auto& other : geometries) {
      for (const auto& motion : motions) {
        CertifiedPairResult result;
        continuousCollide(box.get(), motion.get(), other.get(), &stays, {}, result);
        said.add(result);
        said.add(result.tf1_at_lower);
        fcl::ContinuousCollisionRequestd asked;
        asked.toc_err = 1e-6;
        fcl::ContinuousCollisionResultd answer;
        said.add(continuousCollide<double>(box.get(), motion.get(), other.get(), &stays, asked, answer));
        said.words << answer.is_collide << "; ";
      }
      for (const fcl::CCDMotionType type : {fcl::CCDM_TRANS, fcl::CCDM_LINEAR, fcl::CCDM_SCREW}) {
        CertifiedPairResult result;
        continuousCollide(box.get(), begin, end, other.get(), still, still, type, {}, result);
        said.add(result);
      }
    }
    std::vector<std::unique_ptr<fcl::ContinuousCollisionObjectd>> objects;
    ContinuousCollisionManager manager;
    for (std::size_t i = 0; i < 4; ++i) {
      objects.push_back(std::make_unique<fcl::ContinuousCollisionObjectd>(geometries[i], motions[i]));
      manager.registerObject(objects.back().get());
      const fcl::AABBd swept = sweptAABB(*objects.back());
      said.addAll(swept.min_);
      said.addAll(swept.max_);
    }
    manager.setup();
    CertifiedPairsResult pairs;
    manager.continuousCollide({}, pairs);
    said.add(pairs);
    const fcl::Boxf small(0.4f, 0.4f, 0.4f);
    const fcl::Transform3f from(begin.cast<float>()), to(end.cast<float>()), at(still.cast<float>());
    fcl::ContinuousCollisionRequestf asked;
    fcl::ContinuousCollisionResultf answer;
    said.words << (continuousCollide<float>(&small, from, to, &small, at, at, asked, answer) < 1) << "; ";
  });
}

using RoundingModesOfFiles = TempFolderTest;

TEST_F(RoundingModesOfFiles, RobotsAndScenes) {
  const std::string data = std::string(FCL_ARTIC_SOURCE) + "/data/";
  const std::string numbers = "0.1 0.7 -1.3\n0.3333333333333333 2e-3 1.0e1\n-4.9e-3 0.05 .6\n";
  const std::string cloud = write("cloud.xyz", numbers);
  const std::string pcd = write("cloud.pcd",
                                "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
                                "POINTS 3\nDATA ascii\n" +
                                    numbers);
  const std::string scene = write("cell.scene",
                                  "(noname)+++\n* crate\n0.1 0.7 0.3\n0 0 0.3 0.953939\n1\nbox\n0.1 0.3 0.7\n0.1 0 0\n"
                                  "0 0 0 1\n0 0 0 0\n0\n.\n");
  const std::string obj = write("plate.obj", "v 0.1 0.7 0\nv 1.1 .3 0.001\nv 0.2 1e-1 3.3\nf 1 2 3\n");
  const std::string urdf = write("arm.urdf", R"(<robot name="arm"><link name="base"/><link name="arm"><collision>
    <origin xyz="0.7 0 0.1" rpy="0.1 0.2 0.3"/><geometry><box size="0.7 0.1 0.3"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>
    <origin xyz="0.1 0.3 0" rpy="0.07 0 0"/><axis xyz="0.01 0 1"/></joint></robot>)");
  expectSameInAllModes("files of robots and scenes", [&](Said& said) {
    const Robot robot = loadUrdf(data + "puma560/puma560.urdf");
    for (const std::string& note : robot.notes) said.words << note << '\n';
    for (JointId j = 0; j < robot.tree->numJoints(); ++j) {
      said.add(robot.tree->joint(j).origin);
      said.add(robot.tree->joint(j).lower);
      said.addAll(robot.tree->joint(j).axis);
    }
    said.add(reachUpper(*robot.tree));
    const Scene plate = loadScene(obj);
    for (const std::string& note : unitNotes(robot, plate)) said.words << note << '\n';
    ArticulatedCollisionManager manager(robot.tree);
    robot.addTo(manager);
    plate.addTo(manager);
    manager.setup();
    VectorXd q0(6), q1(6);
    q0 << -2.1, 1.0, -1.0, -0.1, -0.1, 0.0;
    q1 << -0.1, 0.3, -2.3, -1.0, 1.1, 0.0;
    said.add(manager.continuousCollide(q0, q1));
    SceneOptions options;
    options.point_radius = 0.1;
    for (const std::string& file : {cloud, pcd, scene, obj}) {
      const Scene read = loadScene(file, options);
      for (const auto& obstacle : read.obstacles) {
        said.words << obstacle.name << '\n';
        said.addAll(obstacle.object->getAABB().min_);
        said.addAll(obstacle.object->getAABB().max_);
        said.add(Isometry3d(obstacle.object->getTransform()));
      }
      for (const std::string& note : read.notes) said.words << note << '\n';
    }
    const Robot arm = loadUrdf(urdf);
    const Robot two = combineRobots({{&arm, "left_"}, {&arm, "right_", pose({1.3, 0.3, 0.1}, 2.9, {0.1, 0, 1})}});
    for (JointId j = 0; j < two.tree->numJoints(); ++j) said.add(two.tree->joint(j).origin);
    ArticulatedCollisionManager both(two.tree);
    two.addTo(both);
    both.setup();
    said.add(both.continuousCollide(Vector2d(-2.1, 0.1), Vector2d(2.3, 0.3)));
    const std::string srdf = path("pairs.srdf");
    LinkPairReport report;
    writeSrdf(srdf, "puma560", report);
    said.words << loadSrdf(srdf, *robot.tree).pairs().size() << " pairs";
  });
}

#ifdef FCL_ARTIC_PLANS
TEST(RoundingModes, Plans) {
  expectSameInAllModes("plans", [](Said& said) {
    const auto tree = test::sliderTree({"rail", "cart", "tool"});
    const std::pair<plans::Format, std::string> files[] = {
        {plans::Format::csv, "time,slide1,slide2\n0,0.1,0.7\n0.3,1.3,-0.4\n1.7,0.3333333333333333,1e-3\n"},
        {plans::Format::json, R"({"joints": ["slide1", "slide2"], "waypoints": [[0.1, 0.7], [1.3, -4e-1]]})"},
        {plans::Format::yaml, "joints: [slide1, slide2]\nwaypoints: [[0.1, 0.7], [1.3, -0.4]]\n"},
        {plans::Format::ompl, "0.1 0.7\n1.3 -0.4\n"}};
    for (const auto& [format, content] : files) {
      for (plans::Plan& plan : plans::parsePlans(*tree, content, format)) {
        said.words << plan.error << '\n';
        for (const auto& row : plan.positions) {
          for (const double x : row) said.add(x);
        }
        const plans::PlanMotion motion = plans::toMotion(*tree, plan, {});
        for (const double t : {0.0, 0.2, 0.9}) said.addAll(motion.trajectory.configuration(t));
        for (const std::string& note : motion.notes) said.words << note << '\n';
        if (plan.joints.empty()) plan.joints = {"slide1", "slide2"};
        const std::string written = plans::writePlans({plan}, plans::Format::json);
        const std::vector<plans::Plan> again = plans::parsePlans(*tree, written, plans::Format::json);
        for (const auto& row : again.at(0).positions) {
          for (const double x : row) said.add(x);
        }
      }
    }
  });
}
#endif

#ifdef FCL_ARTIC_HDF5
TEST(RoundingModes, TablesHoldTheVeryNumbers) {
  const std::vector<double> doubles = {0.1, -0.1, 1.0 / 3, 0x1p-1074, -0x1.fffffffffffffp1023, 1e9};
  const std::vector<std::int64_t> whole = {(std::int64_t{1} << 62) + 1, -7, 0};
  expectSameInAllModes("tables", [&](Said& said) {
    hdf5::Image image;
    image.add("doubles", {3, 2}, doubles.data());
    image.add("whole", {3}, whole.data());
    const hdf5::File file(image.bytes(), "table");
    std::vector<double> read;
    file.read("doubles", 0, 3, read);
    said.words << (read == doubles);
    std::vector<std::int64_t> numbers;
    file.read("whole", 0, 3, numbers);
    said.words << (numbers == whole);
  });
}
#endif

TEST(RoundingModes, Texts) {
  expectSameInAllModes("texts", [](Said& said) {
    const std::vector<std::string> names = {"shoulder_pan", "shoulder_lift", "elbow"};
    for (const char* typed : {"shoulder_plan", "elbwo", "lift", "x", ""}) {
      said.words << text::didYouMean(typed, names) << text::editDistance(typed, "elbow") << text::xmlText(typed);
    }
    said.words << text::xmlText("a < b & \"c\"");
    KinematicTree tree("named");
    tree.addLink("base");
    try {
      (void)tree.linkId("bsae");
    } catch (const std::out_of_range& e) {
      said.words << e.what();
    }
    Cell cell;
    try {
      (void)cell.manager.continuousCollide(Vector3d(0, 0, 1.5e5), Vector3d(0, 0, 0));
    } catch (const std::invalid_argument& e) {
      said.words << e.what();
    }
    said.words << cell.manager.continuousCollide(Vector3d(0, 0, 0), Vector3d(0, 0, 0)).status;
  });
}

}  // namespace rounding_test
