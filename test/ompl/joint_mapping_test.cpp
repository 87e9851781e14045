// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

#include <ompl/base/spaces/DiscreteStateSpace.h>
#include <ompl/base/spaces/DubinsStateSpace.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/SO3StateSpace.h>
#include <ompl/base/spaces/TimeStateSpace.h>

#include "fcl_artic/ompl/motion_validator.h"
#include "slide.h"

namespace fcl_artic::planning {
namespace joint_mapping_test {
namespace {

namespace ob = ::ompl::base;
constexpr double kPi = 3.14159265358979323846;

/// Two slides and two turning joints, in mixed order, and a fixed joint.
std::shared_ptr<KinematicTree> mixedTree() {
  auto tree = std::make_shared<KinematicTree>("mixed");
  for (const char* link : {"l0", "l1", "l2", "l3", "l4", "l5"}) tree->addLink(link);
  tree->addJoint(makeJoint("slide_a", JointType::prismatic, "l0", "l1", Eigen::Vector3d::UnitX()));
  tree->addJoint(makeJoint("turn_a", JointType::continuous, "l1", "l2", Eigen::Vector3d::UnitZ()));
  tree->addJoint(makeJoint("weld", JointType::fixed, "l2", "l3", Eigen::Vector3d::UnitZ()));
  tree->addJoint(makeJoint("slide_b", JointType::prismatic, "l3", "l4", Eigen::Vector3d::UnitY()));
  tree->addJoint(makeJoint("turn_b", JointType::revolute, "l4", "l5", Eigen::Vector3d::UnitY()));
  return tree;
}

ob::StateSpacePtr compound(const std::vector<ob::StateSpacePtr>& parts) {
  return std::make_shared<ob::CompoundStateSpace>(parts, std::vector<double>(parts.size(), 1.0));
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(JointMappingTest, MotionIsTheWayOfInterpolate) {
  const auto tree = mixedTree();
  // (slides), (turn_b, (turn_a)): the order is the space's, not the tree's.
  const ob::StateSpacePtr space = compound(
      {reals(2), compound({std::make_shared<ob::SO2StateSpace>(), compound({std::make_shared<ob::SO2StateSpace>()})})});
  const std::vector<std::string> joints{"slide_b", "slide_a", "turn_b", "turn_a"};
  const int variable[] = {2, 0, 3, 1};
  const JointMapping mapping(*space, tree, joints);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> length(-10, 10), angle(-kPi, kPi);
  std::vector<std::vector<double>> ends;
  for (int i = 0; i < 200; ++i) ends.push_back({length(random), length(random), angle(random), angle(random)});
  for (const double a : {-kPi, -3.1, 0.0, 3.1, kPi}) ends.push_back({0, 0, a, -a});
  int wrapped = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const std::vector<double>&from = ends[i], &to = ends[(i * 7 + 1) % ends.size()];
    const TestState s1(space, from), s2(space, to), between(space, from);
    const JointMotion motion = mapping.motion(s1, s2);
    for (const double t : {0.0, 0.1, 0.5, 0.77, 1.0}) {
      space->interpolate(s1, s2, t, between);
      const Eigen::VectorXd q = motion.configuration(t);
      // Lengths up to 10, a few roundings of them: OMPL's may be fused.
      for (unsigned k = 0; k < 2; ++k) EXPECT_NEAR(q[variable[k]], between[k], 8e-15);
      for (unsigned k = 2; k < 4; ++k) {
        // Angles up to 2 pi, a few roundings of them.
        EXPECT_NEAR(std::remainder(q[variable[k]] - between[k], 2 * kPi), 0, 4e-15) << from[k] << " to " << to[k];
      }
    }
    wrapped += std::abs(to[2] - from[2]) > kPi;
  }
  EXPECT_GT(wrapped, 20);
}

TEST(JointMappingTest, UnnamedJointsStayAtTheirValues) {
  const auto space = reals(1);
  const Eigen::VectorXd others = Eigen::Vector4d(1, 2, 3, 4);
  const JointMapping mapping(*space, mixedTree(), {"slide_b"}, others);
  const TestState s1(space, {-5}), s2(space, {6});
  const JointMotion motion = mapping.motion(s1, s2);
  EXPECT_EQ(motion.configuration(0), Eigen::VectorXd(Eigen::Vector4d(1, 2, -5, 4)));
  EXPECT_EQ(motion.configuration(1), Eigen::VectorXd(Eigen::Vector4d(1, 2, 6, 4)));
  Eigen::VectorXd q;
  mapping.configuration(s2, q);
  EXPECT_EQ(q, Eigen::VectorXd(Eigen::Vector4d(1, 2, 6, 4)));
}

/// One joint of each kind with several variables, after one another.
std::shared_ptr<KinematicTree> freeTree() {
  auto tree = std::make_shared<KinematicTree>("free");
  for (const char* link : {"world", "cart", "drone", "camera"}) tree->addLink(link);
  tree->addJoint(makeJoint("drive", JointType::planar, "world", "cart", Eigen::Vector3d::UnitZ()));
  tree->addJoint(makeJoint("fly", JointType::floating, "cart", "drone", Eigen::Vector3d::UnitX()));
  tree->addJoint(makeJoint("look", JointType::spherical, "drone", "camera", Eigen::Vector3d::UnitX()));
  return tree;
}

/// Largest distance of a pose's entries.
double apart(const KinematicTree& tree, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  std::vector<Eigen::Isometry3d> M_a, M_b;
  tree.forwardKinematics(a, M_a);
  tree.forwardKinematics(b, M_b);
  double most = 0;
  for (std::size_t i = 0; i < M_a.size(); ++i)
    most = std::max(most, (M_a[i].matrix() - M_b[i].matrix()).cwiseAbs().maxCoeff());
  return most;
}

TEST(JointMappingTest, FreeBodiesMoveAsInterpolateSays) {
  const auto tree = freeTree();
  const auto se2 = std::make_shared<ob::SE2StateSpace>();
  const auto se3 = std::make_shared<ob::SE3StateSpace>();
  se2->setBounds(ob::RealVectorBounds(2));
  se3->setBounds(ob::RealVectorBounds(3));
  const ob::StateSpacePtr space = compound({std::make_shared<ob::SO3StateSpace>(), se2, se3});
  const JointMapping mapping(*space, tree, {"look", "drive", "fly"});
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> ends;
  for (int i = 0; i < 100; ++i) {
    std::vector<double> end;
    for (int k = 0; k < 14; ++k) end.push_back(normal(random));
    end[6] = std::remainder(3 * end[6], 2 * kPi);
    for (const int k : {0, 10}) Eigen::Map<Eigen::Vector4d>(end.data() + k).normalize();
    ends.push_back(end);
    // The same orientation, and half a turn from it, but for roundings: the last one's way round hangs on them.
    for (int k = 0; k < 4; ++k) end[k] = -end[k];
    const Eigen::Quaterniond half(
        Eigen::AngleAxisd(kPi, Eigen::Vector3d(normal(random), normal(random), 1).normalized()));
    const Eigen::Quaterniond turned = half * Eigen::Quaterniond(end[13], end[10], end[11], end[12]);
    for (int k = 0; k < 4; ++k) end[10 + k] = turned.coeffs()[k];
    ends.push_back(end);
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const TestState s1(space, ends[i]), s2(space, ends[(i + 1) % ends.size()]), between(space, ends[i]);
    const JointMotion motion = mapping.motion(s1, s2);
    for (const double t : {0.0, 0.3, 0.8, 1.0}) {
      space->interpolate(s1, s2, t, between);
      Eigen::VectorXd q;
      mapping.configuration(between, q);
      // Products of a few matrices with entries up to 10.
      EXPECT_LT(apart(*tree, motion.configuration(t), q), 1e-12) << "case " << i << ", t = " << t;
    }
  }
  // Without names, in the tree's order.
  EXPECT_NO_THROW(JointMapping(*compound({se2, se3, std::make_shared<ob::SO3StateSpace>()}), tree));
}

TEST(JointMappingTest, PartsOfQuaternionsGoNoWayOfTheirOwn) {
  const auto tree = freeTree();
  EXPECT_NE(
      refusal([&] { JointMapping(*reals(1), tree, {"look/rot_x"}); }).find("'look/rot_x' is part of a quaternion"),
      std::string::npos);
  EXPECT_NE(refusal([&] { JointMapping(*reals(14), tree); }).find("part of a quaternion"), std::string::npos);
  EXPECT_NE(refusal([&] { JointMapping(ob::SO2StateSpace(), tree, {"drive/x"}); }).find("'drive/x'"),
            std::string::npos);
  EXPECT_NE(refusal([&] { JointMapping(ob::SE3StateSpace(), tree, {"look"}); }).find("floating joint: 'look'"),
            std::string::npos);
  EXPECT_EQ(refusal([&] {
              JointMapping(*reals(5), tree, {"drive/theta", "drive/y", "fly/trans_x", "fly/trans_z", "drive/x"});
            }),
            "");
  EXPECT_EQ(refusal([&] { JointMapping(ob::SO2StateSpace(), tree, {"drive/theta"}); }), "");
}

class SomeoneElsesSpace : public ob::RealVectorStateSpace {
 public:
  using RealVectorStateSpace::RealVectorStateSpace;
};

TEST(JointMappingTest, OtherSpacesAreRefusedByName) {
  const auto tree = mixedTree();
  std::vector<ob::StateSpacePtr> spaces{
      std::make_shared<ob::SE2StateSpace>(),          std::make_shared<ob::SE3StateSpace>(),
      std::make_shared<ob::SO3StateSpace>(),          std::make_shared<ob::TimeStateSpace>(),
      std::make_shared<ob::DiscreteStateSpace>(0, 3), std::make_shared<ob::DubinsStateSpace>(),
      std::make_shared<ob::ReedsSheppStateSpace>(),   std::make_shared<SomeoneElsesSpace>(4)};
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    const std::string name = "the space " + std::to_string(i);
    spaces[i]->setName(name);
    for (const ob::StateSpacePtr& space : {spaces[i], compound({reals(1), spaces[i]})}) {
      const std::string message = refusal([&] { JointMapping(*space, tree); });
      EXPECT_NE(message.find("'" + name + "'"), std::string::npos) << "message: " << message;
      EXPECT_TRUE(message.find("not supported") != std::string::npos ||
                  (i < 3 && message.find("needs a") != std::string::npos))
          << "message: " << message;
    }
  }
}

TEST(JointMappingTest, WrongJointsAreRefusedByName) {
  const auto tree = mixedTree();
  const auto message = [&](const ob::StateSpacePtr& space, const std::vector<std::string>& joints) {
    return refusal([&] { JointMapping(*space, tree, joints); });
  };
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(contains(message(reals(3), {}), "3 values for 4 joints"));
  EXPECT_TRUE(contains(message(reals(1), {"elbow"}), "'elbow'"));
  EXPECT_TRUE(contains(message(reals(1), {"weld"}), "'weld'"));
  EXPECT_TRUE(contains(message(reals(2), {"turn_a", "turn_a"}), "'turn_a' is named twice"));
  EXPECT_TRUE(contains(message(std::make_shared<ob::SO2StateSpace>(), {"slide_a"}), "prismatic joint 'slide_a'"));
  EXPECT_TRUE(contains(refusal([&] { JointMapping(*reals(4), nullptr); }), "null"));
  EXPECT_FALSE(refusal([&] { JointMapping(*reals(1), tree, {"turn_a"}, Eigen::VectorXd::Zero(3)); }).empty());
  EXPECT_TRUE(message(reals(4), {}).empty());
}

TEST(JointMappingTest, WholeTurnsOfAMimickedJoint) {
  for (const double multiplier : {0.5, 1.0, -2.0}) {
    const auto tree = mixedTree();
    tree->addLink("hand");
    Joint follower = makeJoint("follower", JointType::continuous, "l5", "hand", Eigen::Vector3d::UnitX());
    follower.mimics = true;
    follower.mimic = {"turn_a", multiplier, 0};
    tree->addJoint(follower);
    const ob::SO2StateSpace space;
    const std::string message = refusal([&] { JointMapping(space, tree, {"turn_a"}); });
    if (multiplier == 0.5) {
      EXPECT_NE(message.find("'follower'"), std::string::npos) << message;
    } else {
      EXPECT_TRUE(message.empty()) << message;
    }
  }
}

}  // namespace
}  // namespace joint_mapping_test
}  // namespace fcl_artic::planning
