// SPDX-License-Identifier: BSD-3-Clause
// Random trajectories of a Panda among boxes, a mesh and an octomap, with a body in its hand. The verdicts are compared
// with those for the same world read by this project's own URDF and SRDF readers, which know no MoveIt. They are also
// compared with FCL's look at many samples.
#include <ctime>
#include <iostream>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <octomap/octomap.h>

#include <fcl_artic/urdf/urdf.h>

#include "fcl_artic_moveit/certifier.h"
#include "models.h"
#include "planning/fcl_state_check.h"

namespace fcl_artic_moveit {
namespace {

using Eigen::VectorXd;
using fcl_artic::CertifiedResult;
using fcl_artic::JointTrajectory;
using fcl_artic::Status;

constexpr double kStep = 0.8;  // s between waypoints
// s: vertices come to MoveIt by assimp's floats, 3e-8 of their coordinates, and to this library's reader as doubles.
constexpr double kRounding = 1e-6;

double cpuMicroseconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// The same world twice: as MoveIt has it, and as this library's own readers and FCL's types have it.
struct Worlds {
  Worlds() : moveit(panda()), robot(fcl_artic::loadUrdf(pandaFolder() + "/panda_mbm.urdf")) {
    robot.allowed = fcl_artic::loadSrdf(pandaFolder() + "/panda_mbm.srdf", *robot.tree);
    for (const auto& [x, y, z] : std::vector<std::tuple<double, double, double>>{
             {0.5, 0.35, 0.3}, {0.5, -0.35, 0.5}, {-0.4, 0.3, 0.6}, {0.35, 0.1, 0.8}}) {
      const std::string name = "box" + std::to_string(scene.obstacles.size());
      moveit.add(name, std::make_shared<shapes::Box>(0.12, 0.2, 0.16), {x, y, z});
      add(name, std::make_shared<fcl::Boxd>(0.12, 0.2, 0.16), {x, y, z});
    }
    const auto mesh = std::static_pointer_cast<const shapes::Mesh>(boxMesh(0.02, 0.9, 0.3));
    moveit.add("plate", mesh, {0.62, 0, 0.2});
    auto triangles = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    triangles->beginModel();
    const auto vertex = [&](unsigned int i) { return fcl::Vector3d(mesh->vertices + 3 * mesh->triangles[i]); };
    for (unsigned int t = 0; t < 12; ++t) triangles->addTriangle(vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2));
    triangles->endModel();
    add("plate", triangles, {0.62, 0, 0.2});
    auto cells = std::make_shared<octomap::OcTree>(0.04);
    for (float a = 0; a < 6.2F; a += 0.02F) {
      if (a > 1 && a < 5) cells->updateNode(octomap::point3d(0.55F * std::cos(a), 0.55F * std::sin(a), 0.1F), true);
    }
    moveit.add("<octomap>", std::make_shared<shapes::OcTree>(cells), {0, 0, 0.3});
    add("octomap", std::make_shared<fcl::OcTreed>(cells), {0, 0, 0.3});

    const std::vector<std::string> touch{"panda_hand", "panda_leftfinger", "panda_rightfinger"};
    const Eigen::Vector3d at(0, 0, 0.16);
    moveit.attach("bar", "panda_hand", std::make_shared<shapes::Box>(0.04, 0.2, 0.04), at,
                  {touch.begin(), touch.end()});
    bar = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.04, 0.2, 0.04));
    Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();
    offset.translation() = at;

    manager = std::make_unique<fcl_artic::ArticulatedCollisionManager>(robot.tree);
    robot.addTo(*manager);
    scene.addTo(*manager);
    manager->registerObject(std::shared_ptr<const fcl::CollisionObjectd>(bar), "bar");
    manager->attach("panda_hand", bar.get(), offset, touch);
    manager->setup();
    check = std::make_unique<fcl_artic::planning_data::FclStateCheck>(
        robot, scene,
        std::vector<fcl_artic::planning_data::CarriedObject>{
            {"bar", bar, robot.tree->linkId("panda_hand"), offset, touch}});
    for (int v = 0; v < robot.tree->dof(); ++v)
      index.push_back(moveit.model->getVariableIndex(robot.tree->variableName(v)));
  }
  void add(const std::string& name, const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
           const Eigen::Vector3d& at) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = at;
    scene.obstacles.push_back({name, std::make_shared<fcl::CollisionObjectd>(geometry, pose)});
  }

  Surroundings moveit;
  fcl_artic::Robot robot;
  fcl_artic::Scene scene;
  std::shared_ptr<fcl::CollisionObjectd> bar;
  std::unique_ptr<fcl_artic::ArticulatedCollisionManager> manager;
  std::unique_ptr<fcl_artic::planning_data::FclStateCheck> check;
  std::vector<std::size_t> index;  ///< of the robot's variables among MoveIt's
};

struct Trip {
  std::vector<double> times;
  std::vector<VectorXd> q, v, a;
  int degree;
};

/// The polynomial of one variable by its conditions at both ends, solved: no formula is shared with what is judged.
VectorXd at(const Trip& trip, std::size_t k, double s) {
  if (trip.degree == 1) return trip.q[k] + s * (trip.q[k + 1] - trip.q[k]);
  const double h = trip.times[k + 1] - trip.times[k];
  const int conditions = (trip.degree + 1) / 2, n = 2 * conditions;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n), b(n, trip.q[k].size());
  const std::vector<VectorXd>* rows[3] = {&trip.q, &trip.v, &trip.a};
  for (int d = 0; d < conditions; ++d) {
    for (int j = 0; j < n; ++j) {
      double factor = 1;
      for (int i = 0; i < d; ++i) factor *= j - i;
      A(d, j) = j == d ? factor : 0;
      A(conditions + d, j) = factor;
    }
    b.row(d) = std::pow(h, d) * (*rows[d])[k].transpose();
    b.row(conditions + d) = std::pow(h, d) * (*rows[d])[k + 1].transpose();
  }
  const Eigen::MatrixXd c = A.fullPivLu().solve(b);
  VectorXd q = VectorXd::Zero(trip.q[k].size());
  for (int j = n - 1; j >= 0; --j) q = q * s + c.row(j).transpose();
  return q;
}

TEST(Truth, RandomTrajectoriesOfAPanda) {
  if (pandaFolder().empty()) GTEST_SKIP() << "FCL_ARTIC_DATA names no folder with robots/panda_mbm";
  Worlds worlds;
  const auto& tree = *worlds.robot.tree;
  const Certifier certifier;
  std::mt19937 random(2024);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto randomState = [&](const VectorXd* near) {
    for (;;) {
      VectorXd q(tree.dof());
      for (int v = 0; v < tree.dof(); ++v) {
        const auto& joint = tree.joint(tree.variableJoint(v));
        const double span = joint.upper - joint.lower, u = unit(random);
        q[v] = joint.lower + span * u;
        if (near) q[v] = std::min(joint.upper, std::max(joint.lower, (*near)[v] + 0.35 * span * (u - 0.5)));
        if (joint.name.find("finger") != std::string::npos) q[v] = 0.02;
      }
      if (!worlds.check->collides(q)) return q;
    }
  };
  int free = 0, contact = 0, hidden = 0, missed = 0, sampled = 0, seen_by_samples = 0;
  std::vector<double> cost_us, direct_us;
  double apart = 0;
  for (int run = 0; run < 300; ++run) {
    Trip trip;
    trip.degree = 1 + 2 * (run % 3);
    for (int k = 0; k < 3; ++k) {
      trip.times.push_back(kStep * k);
      trip.q.push_back(randomState(k ? &trip.q[0] : nullptr));
      VectorXd v = VectorXd::Zero(tree.dof()), a = VectorXd::Zero(tree.dof());
      for (int j = 0; j < 7; ++j) {
        v[j] = k == 1 ? unit(random) - 0.5 : 0;
        a[j] = 2 * unit(random) - 1;
      }
      trip.v.push_back(v);
      trip.a.push_back(a);
    }
    robot_trajectory::RobotTrajectory asked(worlds.moveit.model, "panda_arm");
    bool valid = true;
    for (std::size_t k = 0; k < 3; ++k) {
      moveit::core::RobotState state(worlds.moveit.state);
      for (int v = 0; v < tree.dof(); ++v)
        state.setVariablePosition(worlds.index[static_cast<std::size_t>(v)], trip.q[k][v]);
      for (int v = 0; v < 7 && trip.degree > 1; ++v) {
        state.setVariableVelocity(tree.variableName(v), trip.v[k][v]);
        if (trip.degree > 3) state.setVariableAcceleration(tree.variableName(v), trip.a[k][v]);
      }
      state.update();
      valid = valid && !worlds.moveit.moveitCollides(state, "panda_arm");
      asked.addSuffixWayPoint(state, k ? kStep : 0);
    }
    const double begin = cpuMicroseconds();
    const Verdict ours = certifier.certify(*worlds.moveit.env, worlds.moveit.acm, asked);
    cost_us.push_back(cpuMicroseconds() - begin);
    const JointTrajectory motion = trip.degree == 1 ? JointTrajectory::linear(tree, trip.times, trip.q)
                                   : trip.degree == 3
                                       ? JointTrajectory::cubic(tree, trip.times, trip.q, trip.v)
                                       : JointTrajectory::quintic(tree, trip.times, trip.q, trip.v, trip.a);
    const double direct_begin = cpuMicroseconds();
    const CertifiedResult direct = worlds.manager->continuousCollide(motion);
    direct_us.push_back(cpuMicroseconds() - direct_begin);
    EXPECT_EQ(ours.status, direct.status) << "run " << run;
    // Both brackets hold the first contact; the two readers' vertices differ by rounding.
    EXPECT_LE(ours.t_lower, direct.t_upper + kRounding) << "run " << run;
    EXPECT_LE(direct.t_lower, ours.t_upper + kRounding) << "run " << run;
    apart = std::max({apart, ours.t_lower - direct.t_upper, direct.t_lower - ours.t_upper});
    EXPECT_NEAR(ours.t_lower, direct.t_lower, 3e-6) << "run " << run;
    double seen = std::numeric_limits<double>::infinity();
    constexpr int kSamples = 100;
    for (std::size_t k = 0; k < 2 && !std::isfinite(seen); ++k) {
      for (int i = 0; i <= kSamples; ++i, ++sampled) {
        const double s = static_cast<double>(i) / kSamples;
        if (!worlds.check->collides(at(trip, k, s))) continue;
        seen = trip.times[k] + s * kStep;
        break;
      }
    }
    seen_by_samples += std::isfinite(seen);
    if (ours.isFree()) {
      ++free;
      missed += std::isfinite(seen);
    } else {
      ++contact;
      hidden += valid;
      missed += seen < ours.t_lower - 1e-9;
    }
  }
  std::sort(cost_us.begin(), cost_us.end());
  std::sort(direct_us.begin(), direct_us.end());
  std::cout << free << " free, " << contact << " in contact, of these " << hidden
            << " with waypoints that MoveIt calls valid; " << seen_by_samples << " seen by " << sampled
            << " samples of FCL; missed: " << missed << "; brackets at most " << apart
            << " s apart; CPU time of one: " << cost_us[150] << " us (median), " << cost_us[297] << " us (99 %), "
            << cost_us.back() << " us (the first); of the query alone " << direct_us[150] << " us (median), "
            << direct_us[297] << " us (99 %)\n";
  EXPECT_EQ(missed, 0);
  EXPECT_GE(free, 50);
  EXPECT_GE(contact, 50);
  EXPECT_GE(hidden, 30);
  EXPECT_GE(seen_by_samples, contact * 8 / 10) << "the contacts are real ones";
}

/// The pairs that are checked are the same, but those that no group's joint moves.
TEST(Truth, PairsOfAPanda) {
  if (pandaFolder().empty()) GTEST_SKIP() << "FCL_ARTIC_DATA names no folder with robots/panda_mbm";
  Worlds worlds;
  Cell cell(worlds.moveit.model);
  cell.update(*worlds.moveit.env, worlds.moveit.acm, worlds.moveit.state, nullptr);
  const auto sorted = [](const fcl_artic::ArticulatedCollisionManager& manager) {
    std::set<std::set<std::string>> out;
    for (const auto& pair : manager.checkedLinkPairs()) out.insert({pair.first, pair.second});
    return out;
  };
  const auto pairs = sorted(cell.manager());
  EXPECT_EQ(pairs, sorted(*worlds.manager));
  EXPECT_GE(pairs.size(), 20U);
  EXPECT_EQ(cell.robotsRead(), 1) << "its SRDF allows all neighbours";
  const auto q = cell.robot().configuration(worlds.moveit.state);
  const auto count = cell.manager().collide(q).statistics.pairs;
  // Its SRDF has the base float, which then moves against each object of the world; in the URDF alone it stands still.
  const auto by_hand = worlds.manager->collide(worlds.robot.tree->neutralConfiguration()).statistics.pairs;
  EXPECT_EQ(count, by_hand + worlds.moveit.world->size());
  std::cout << pairs.size() << " pairs of links and body, " << count << " with the world\n";
}

}  // namespace
}  // namespace fcl_artic_moveit
