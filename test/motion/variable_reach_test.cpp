// SPDX-License-Identifier: BSD-3-Clause
//
// How far points go per unit of one joint variable, on random chains, against plain kinematics.
#include "motion/variable_reach.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "motion/frame_sweep.h"

namespace variable_reach_test {

using namespace fcl_artic;
using Eigen::Vector3d;

namespace {

constexpr double kMost = 0.6;  // of all variables

struct Chain {
  KinematicTree tree{"chain"};
  LinkId tip = 0;
};

/// Turns and slides about and along random axes, followers among them.
Chain randomChain(std::mt19937& random, int joints, bool only_in_line = false) {
  std::uniform_real_distribution<double> u(-1, 1);
  Chain chain;
  chain.tree.addLink("link0");
  for (int j = 0; j < joints; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = "link" + std::to_string(j);
    joint.child = "link" + std::to_string(j + 1);
    joint.type = !only_in_line && random() % 3 == 0 ? JointType::prismatic : JointType::revolute;
    joint.axis = Vector3d(u(random), u(random), u(random));
    joint.origin = Eigen::Translation3d(u(random), u(random), u(random)) *
                   Eigen::AngleAxisd(3 * u(random), Vector3d(u(random), u(random), u(random)).normalized());
    if (only_in_line) {
      joint.axis = Vector3d::UnitX();
      joint.origin = Eigen::Translation3d(0, std::abs(u(random)), 0) * Eigen::Isometry3d::Identity();
    }
    joint.mimics = j > 0 && random() % 3 == 0;
    if (joint.mimics) joint.mimic = {"joint0", 2 * u(random), u(random)};
    if (only_in_line && joint.mimics) joint.mimic = {"joint0", 1 + std::abs(u(random)), 0};
    chain.tip = chain.tree.addLink(joint.child);
    chain.tree.addJoint(joint);
  }
  return chain;
}

double size(int) {
  return kMost;
}

struct Box {
  engine::Node node;
  engine::TreeView view;
  Box(const Vector3d& lo, const Vector3d& hi) {
    for (int k = 0; k < 3; ++k) {
      node.lo[k] = static_cast<float>(lo[k]);
      node.hi[k] = static_cast<float>(hi[k]);
    }
    view.nodes = &node;
    view.extent = std::max(lo.norm(), hi.norm());
  }
};

}  // namespace

TEST(VariableReach, NoPointGoesFarther) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  double most = 0;
  for (int i = 0; i < 400; ++i) {
    const Chain chain = randomChain(random, 1 + i % 5);
    FrameSweep sweep = FrameSweep::fromLink(chain.tree, 0);
    const Carrier carrier = sweep.carrier(chain.tip);
    const Vector3d c(u(random), u(random), u(random));
    const Box box(c - Vector3d::Constant(0.1), c + Vector3d::Constant(0.1));
    const Eigen::Isometry3d offset =
        Eigen::Translation3d(u(random), 0, 0) * Eigen::AngleAxisd(u(random), Vector3d::UnitZ());
    for (int v = 0; v < chain.tree.dof(); ++v) {
      const double bound =
          reachPerUnit(sweep.view(), carrier.step,
                       makePlacement(carrier, RigidTransform::within12Ulps(offset, 1e-12).value()), box.view, v, size);
      for (int k = 0; k < 50; ++k) {
        Eigen::VectorXd q(chain.tree.dof());
        for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = kMost * u(random);
        const Vector3d x = c + 0.1 * Vector3d(u(random), u(random), u(random));
        const auto at = [&](double value) {
          q[v] = value;
          std::vector<Eigen::Isometry3d> M_0;
          chain.tree.forwardKinematics(q, M_0);
          return Vector3d(M_0[static_cast<std::size_t>(chain.tip)] * offset * x);
        };
        const double from = kMost * u(random), step = k % 2 ? 1e-4 : kMost * u(random) - from;
        const double way = (at(from + step) - at(from)).norm();
        EXPECT_LE(way, bound * std::abs(step) * (1 + 1e-9) + 1e-12) << "chain " << i << ", variable " << v;
        if (way > 0) most = std::max(most, way / (bound * std::abs(step)));
      }
    }
  }
  EXPECT_GT(most, 0.95);
}

/// A body that stands in the base, seen from the tip, while the first joint alone moves.
TEST(VariableReach, NothingOfTheBaseGoesFarther) {
  std::mt19937 random(14);
  std::uniform_real_distribution<double> u(-1, 1);
  double most = 0;
  int checked = 0;
  for (int i = 0; i < 400; ++i) {
    const Chain chain = randomChain(random, 1 + i % 5);
    FrameSweep sweep = FrameSweep::fromLink(chain.tree, 0);
    sweep.carrier(chain.tip);
    const engine::SweepStep& first = sweep.view().steps[0];
    bool alone = first.parent < 0;
    for (int s = 1; s < sweep.view().num_steps; ++s) alone = alone && sweep.view().steps[s].variable != first.variable;
    if (!alone) continue;
    ++checked;
    const Vector3d c(u(random), u(random), u(random));
    const Box box(c - Vector3d::Constant(0.1), c + Vector3d::Constant(0.1));
    const Eigen::Isometry3d offset =
        Eigen::Translation3d(u(random), 0, 0) * Eigen::AngleAxisd(u(random), Vector3d::UnitZ());
    const double bound =
        reachOfBase(first, makePlacement(RigidTransform::within12Ulps(offset, 1e-12)->inverse()), box.view);
    for (int k = 0; k < 50; ++k) {
      Eigen::VectorXd q(chain.tree.dof());
      for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = kMost * u(random);
      const Vector3d x = c + 0.1 * Vector3d(u(random), u(random), u(random));
      const auto at = [&](double value) {
        q[first.variable] = value;
        std::vector<Eigen::Isometry3d> M_0;
        chain.tree.forwardKinematics(q, M_0);
        return Vector3d(M_0[static_cast<std::size_t>(chain.tip)].inverse() * (M_0[0] * (offset * x)));
      };
      const double from = kMost * u(random), step = k % 2 ? 1e-4 : kMost * u(random) - from;
      const double way = (at(from + step) - at(from)).norm();
      EXPECT_LE(way, bound * std::abs(step) * (1 + 1e-9) + 1e-12) << "chain " << i;
      if (way > 0) most = std::max(most, way / (bound * std::abs(step)));
    }
  }
  EXPECT_GT(most, 0.95);
  EXPECT_GT(checked, 100);
}

/// Links in one line, turning alike: the farthest corner goes as far as is said.
TEST(VariableReach, IsAttained) {
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    const Chain chain = randomChain(random, 1 + i % 5, true);
    FrameSweep sweep = FrameSweep::fromLink(chain.tree, 0);
    const Carrier carrier = sweep.carrier(chain.tip);
    const Box box({0, 0, 0}, {0, 0.5, 0});
    const double bound =
        reachPerUnit(sweep.view(), carrier.step, makePlacement(carrier, RigidTransform()), box.view, 0, size);
    const auto at = [&](double value) {
      std::vector<Eigen::Isometry3d> M_0;
      chain.tree.forwardKinematics(value * Eigen::VectorXd::Unit(chain.tree.dof(), 0), M_0);
      return Vector3d(M_0[static_cast<std::size_t>(chain.tip)] * Vector3d(0, 0.5, 0));
    };
    const double way = (at(1e-5) - at(-1e-5)).norm() / 2e-5;
    EXPECT_LE(way, bound * (1 + 1e-8));
    EXPECT_GE(way, bound * (1 - 1e-8)) << "chain " << i;
  }
}

}  // namespace variable_reach_test
