// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <thread>

#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <ompl/base/spaces/SO2StateSpace.h>

#include "fcl_artic/ompl/motion_validator.h"
#include "fcl_artic/ompl/planning_setup.h"
#include "slide.h"

namespace fcl_artic::planning {
namespace motion_validator_test {
namespace {

namespace ob = ::ompl::base;
using Last = std::pair<ob::State*, double>;
constexpr double kPi = 3.14159265358979323846;
constexpr double kTolerance = 0x1p-12;  // planningRequest()

/// A space information with our validator over all joints of a world.
struct Planning {
  World world;
  ob::StateSpacePtr space;
  ob::SpaceInformationPtr si;
  std::shared_ptr<ContinuousMotionValidator> validator;

  Planning(World w, ob::StateSpacePtr s, const CertifiedRequest& request = planningRequest())
      : world(std::move(w)), space(std::move(s)), si(std::make_shared<ob::SpaceInformation>(space)) {
    validator = std::make_shared<ContinuousMotionValidator>(si, world.manager(), request);
    si->setMotionValidator(validator);
    si->setStateValidityChecker(std::make_shared<CollisionStateValidityChecker>(si, world.manager(), request));
    si->setup();
  }
};

/// Both ways of asking. @return time of the last valid state, 2 when the motion is valid.
double lastValid(const Planning& planning, const std::vector<double>& from, const std::vector<double>& to) {
  const TestState s1(planning.space, from), s2(planning.space, to), state(planning.space, from);
  Last last{state, 2};
  const bool valid = planning.si->checkMotion(s1, s2, last);
  EXPECT_EQ(planning.si->checkMotion(s1, s2), valid);
  EXPECT_EQ(valid, last.second == 2);
  if (!valid) {
    const TestState there(planning.space, from);
    planning.space->interpolate(s1, s2, last.second, there);
    EXPECT_TRUE(planning.space->equalStates(there, state));
    if (last.second > 0) {
      EXPECT_TRUE(planning.si->isValid(state));
    }
  }
  return last.second;
}

TEST(ContinuousMotionValidatorTest, SlideStopsBeforeTheBox) {
  const Planning planning(slideWorld(), reals(1));
  EXPECT_EQ(lastValid(planning, {0}, {1.9}), 2);
  EXPECT_EQ(lastValid(planning, {5}, {9}), 2);
  for (const auto& [from, to] : {std::make_pair(0.0, 4.0), {0.0, 2.5}, {-7.0, 9.0}, {6.0, -1.0}}) {
    // Faces meet at 2 from below, at 4 from above.
    const double contact = ((to > from ? 2 : 4) - from) / (to - from);
    const double t = lastValid(planning, {from}, {to});
    EXPECT_LT(t, contact);
    EXPECT_GT(t, contact - 3 * kTolerance) << from << " to " << to;
  }
}

TEST(ContinuousMotionValidatorTest, ThinObstacleIsNotStepped) {
  World world = slideWorld();
  world.obstacle(std::make_shared<fcl::Boxd>(1e-6, 1, 1), at(-5, 0));
  const Planning planning(std::move(world), reals(1));
  // The cube's face meets the plate at -4.5.
  const double t = lastValid(planning, {0}, {-10});
  EXPECT_LT(t, 0.45);
  EXPECT_GT(t, 0.45 - 3 * kTolerance);
}

TEST(ContinuousMotionValidatorTest, OnTrueNothingIsTouched) {
  const Planning planning(slideWorld(), reals(1));
  const TestState s1(planning.space, {0}), s2(planning.space, {1}), state(planning.space, {77});
  Last last{state, -5};
  EXPECT_TRUE(planning.validator->checkMotion(s1, s2, last));
  EXPECT_EQ(last.first, static_cast<ob::State*>(state));
  EXPECT_EQ(last.second, -5);
  EXPECT_EQ(state[0], 77);
  EXPECT_EQ(s1[0], 0);
  EXPECT_EQ(s2[0], 1);
}

TEST(ContinuousMotionValidatorTest, LastValidStateMayBeNullOrAnEnd) {
  const Planning planning(slideWorld(), reals(1));
  const auto ask = [&](int which) {
    const TestState s1(planning.space, {0}), s2(planning.space, {4});
    ob::State* const place[] = {nullptr, s1, s2};
    Last last{place[which], 2};
    EXPECT_FALSE(planning.validator->checkMotion(s1, s2, last));
    EXPECT_EQ(s1[0], which == 1 ? 4 * last.second : 0);
    EXPECT_EQ(s2[0], which == 2 ? 4 * last.second : 4);
    return last.second;
  };
  const double t = ask(0);
  EXPECT_GT(t, 0.49);
  EXPECT_LT(t, 0.5);
  EXPECT_EQ(ask(1), t);
  EXPECT_EQ(ask(2), t);
}

TEST(ContinuousMotionValidatorTest, MarginMovesTheContact) {
  CertifiedRequest request = planningRequest();
  request.margin = 0.5;
  const Planning planning(slideWorld(), reals(1), request);
  EXPECT_EQ(lastValid(planning, {0}, {1.49}), 2);
  const double t = lastValid(planning, {0}, {3});
  EXPECT_LT(t, 0.5);
  EXPECT_GT(t, 0.5 - 3 * kTolerance);
}

TEST(ContinuousMotionValidatorTest, TolerancesOfTheManagerCountForStatesAndMotions) {
  World world = slideWorld();
  world.tolerance({0, 0.3});  // faces meet at 2: what is beyond 1.7 may touch
  const Planning planning(std::move(world), reals(1)), exact(slideWorld(), reals(1));
  for (const double q : {1.69, 1.75, 4.25, 4.31}) {
    EXPECT_TRUE(exact.si->isValid(TestState(exact.space, {q}))) << q;
    EXPECT_EQ(planning.si->isValid(TestState(planning.space, {q})), q < 1.7 || q > 4.3) << q;
  }
  EXPECT_EQ(lastValid(planning, {0}, {1.69}), 2);
  EXPECT_EQ(lastValid(exact, {0}, {1.75}), 2);
  const double t = lastValid(planning, {0}, {1.75});
  EXPECT_LT(t, 1.7 / 1.75);
  EXPECT_GT(t, 1.7 / 1.75 - 3 * kTolerance);
  EXPECT_EQ(lastValid(planning, {1.75}, {0}), 0);
  // A start within the tolerances may be left, and no motion comes back to one.
  CertifiedRequest lenient = planningRequest();
  lenient.ignore_initial_contact = true;
  const Planning leaving(World(std::move(slideWorld().tolerance({0, 0.3}))), reals(1), lenient);
  const TestState near(leaving.space, {1.75}), far(leaving.space, {0});
  EXPECT_TRUE(leaving.si->checkMotion(near, far));
  EXPECT_FALSE(leaving.si->checkMotion(far, near));
}

TEST(ContinuousMotionValidatorTest, LastValidStateLeavesRoomWhereTheMotionGrazes) {
  // A ball of 0.1 m on a slide of 8 m passes the like at 3 m and overlaps it by no more than `deep`: the gap hardly
  // changes about the contact.
  for (const double deep : {1e-3, 1e-4, 1e-5, 3e-6, 1e-6, 1e-7}) {
    auto tree = std::make_shared<KinematicTree>("slide");
    tree->addLink("rail");
    tree->addLink("ball");
    tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "ball", Eigen::Vector3d::UnitX(), -10, 10));
    World world(tree);
    const auto ball = std::make_shared<fcl::Sphered>(0.1);
    const double y = 0.2 - deep;
    world.bind("ball", ball).obstacle(ball, at(3, y));
    const Planning planning(std::move(world), reals(1));
    const double t = lastValid(planning, {0}, {8});  // looks at the state too
    // Contact with the margin that the proof leaves, 2e-5 m; and that much room at the state, up to roundings.
    EXPECT_GT(t, (3 - std::sqrt(0.20002 * 0.20002 - y * y)) / 8 - 2 * kTolerance);
    EXPECT_GT(std::hypot(3 - 8 * t, y) - 0.2, 2e-5 - 1e-12);
  }
}

TEST(ContinuousMotionValidatorTest, StartInContact) {
  Planning strict(slideWorld(), reals(1));
  EXPECT_EQ(lastValid(strict, {2.5}, {-1}), 0);
  const TestState s1(strict.space, {2.5}), s2(strict.space, {-1}), state(strict.space, {77});
  Last last{state, 2};
  EXPECT_FALSE(strict.validator->checkMotion(s1, s2, last));
  EXPECT_EQ(state[0], 2.5) << "a copy of s1";

  CertifiedRequest request = planningRequest();
  request.ignore_initial_contact = true;
  World world = slideWorld();
  world.obstacle(std::make_shared<fcl::Boxd>(1, 1, 1), at(-5, 0));
  const Planning lenient(std::move(world), reals(1), request);
  EXPECT_EQ(lastValid(lenient, {2.5}, {-1}), 2) << "it may separate";
  EXPECT_FALSE(lenient.si->isValid(s1)) << "the state is in contact all the same";
  // Another obstacle is not excused: met at x = -4.
  const double t = lastValid(lenient, {2.5}, {-10.5});
  EXPECT_LT(t, 0.5);
  EXPECT_GT(t, 0.5 - 3 * kTolerance);
}

/// Planners go on from where a motion ended and from lastValid: no way may lead through an obstacle in steps that begin
/// in contact with it.
TEST(ContinuousMotionValidatorTest, InitialContactIsNoWayThrough) {
  CertifiedRequest request = planningRequest();
  request.ignore_initial_contact = true;
  const Planning planning(slideWorld(), reals(1), request);  // faces meet at 2 and part at 4
  EXPECT_EQ(lastValid(planning, {2.5}, {2.6}), 0) << "s2 is in contact";
  EXPECT_EQ(lastValid(planning, {2.5}, {3.9999}), 0);
  EXPECT_EQ(lastValid(planning, {2}, {2.5}), 0);
  EXPECT_EQ(lastValid(planning, {2}, {0}), 2) << "it separates";
  EXPECT_LT(lastValid(planning, {0}, {2 - 1e-12}), 1) << "what can hardly be told from a contact is none to go on from";
  for (const double from : {0.0, 1.0, 1.5, 1.9, 1.999, 1.99999, 1.999999, 1.9999999}) {
    const TestState s1(planning.space, {from}), s2(planning.space, {8}), state(planning.space, {77});
    Last last{state, 2};
    ASSERT_FALSE(planning.validator->checkMotion(s1, s2, last)) << from;
    EXPECT_LT(state[0], 2);
    EXPECT_FALSE(planning.validator->checkMotion(state, s2)) << from;
    if (from >= 1.9999) continue;
    EXPECT_GT(last.second, (2 - from) / (8 - from) - 3 * kTolerance);
    EXPECT_TRUE(planning.si->isValid(state)) << from;
  }
}

TEST(ContinuousMotionValidatorTest, UndecidedIsInvalid) {
  // Balls within the arm's circle, 5 cm from the one that it carries: near, free, and some work.
  const auto ringWorld = [] {
    World world = turnWorld(JointType::continuous, 0);
    for (const double angle : {1.0, 2.0, 3.0, 4.0, 5.0}) {
      world.obstacle(std::make_shared<fcl::Sphered>(0.1), at(0.75 * std::cos(angle), 0.75 * std::sin(angle)));
    }
    return world;
  };
  CertifiedRequest request = planningRequest();
  request.work_budget = 1;
  const Planning limited(ringWorld(), reals(1), request);
  CertifiedResult result;
  const auto manager = limited.world.manager();
  manager->continuousCollide(
      JointMotion::linear(manager->tree(), Eigen::VectorXd::Constant(1, 0.25), Eigen::VectorXd::Constant(1, 6)),
      request, result);
  ASSERT_EQ(result.status, Status::undecided);
  const TestState s1(limited.space, {0.25}), s2(limited.space, {6}), state(limited.space, {77});
  EXPECT_FALSE(limited.validator->checkMotion(s1, s2));
  Last last{state, 2};
  EXPECT_FALSE(limited.validator->checkMotion(s1, s2, last));
  EXPECT_LE(last.second, result.t_lower);
  EXPECT_NEAR(state[0], 0.25 + last.second * 5.75, 1e-15);
  const Planning unlimited(ringWorld(), reals(1));
  EXPECT_TRUE(unlimited.validator->checkMotion(s1, s2));
}

TEST(ContinuousMotionValidatorTest, TurnsTakeTheShorterWay) {
  const double reach = 2 * std::asin(0.1);  // chord of 0.2 m at 1 m
  for (const JointType type : {JointType::continuous, JointType::revolute}) {
    const auto so2 = std::make_shared<ob::SO2StateSpace>();
    const Planning over_pi(turnWorld(type, kPi), so2);
    // From 2.5 on over pi to -2.5, a way of 2 pi - 5; and the other way round.
    for (const double from : {2.5, -2.5}) {
      const double contact = (kPi - reach - 2.5) / (2 * kPi - 5);
      const double t = lastValid(over_pi, {from}, {-from});
      EXPECT_LT(t, contact);
      EXPECT_GT(t, contact - 3 * kTolerance);
    }
    EXPECT_EQ(lastValid(over_pi, {1.5}, {-1.5}), 2) << "through 0";
    const Planning at_zero(turnWorld(type, 0), so2);
    EXPECT_EQ(lastValid(at_zero, {2.5}, {-2.5}), 2) << "over pi";
    const double contact = (1.5 - reach) / 3;
    const double t = lastValid(at_zero, {1.5}, {-1.5});
    EXPECT_LT(t, contact);
    EXPECT_GT(t, contact - 3 * kTolerance);
    // A real vector goes straight, also where the joint could wrap.
    const Planning straight(turnWorld(type, 0), reals(1));
    EXPECT_NEAR(lastValid(straight, {2.5}, {-2.5}), (2.5 - reach) / 5, 3 * kTolerance);
    EXPECT_EQ(lastValid(straight, {2.5}, {3.5}), 2);
  }
}

// From 2.8 to -2.8 an SO2StateSpace goes over pi, where a joint with limits can't: its drive goes through 0, and the
// ball there. Without limits the way over pi is the joint's own.
TEST(ContinuousMotionValidatorTest, LimitsForbidTheWayOverPi) {
  for (const double limit : {0.0, 3.0}) {
    auto tree = std::make_shared<KinematicTree>("arm");
    for (const char* link : {"base", "arm"}) tree->addLink(link);
    tree->addJoint(makeJoint("turn", JointType::revolute, "base", "arm", Eigen::Vector3d::UnitZ(), -limit, limit));
    World world(tree);
    const auto ball = std::make_shared<fcl::Sphered>(0.1);
    world.bind("arm", ball, at(1, 0)).obstacle(ball, at(1, 0));
    const auto so2 = std::make_shared<ob::SO2StateSpace>();
    if (limit > 0) {
      try {
        const Planning planning(std::move(world), so2);
        ADD_FAILURE() << "accepted";
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("cannot drive joint 'turn', which has the limits [-3"),
                  std::string::npos)
            << error.what();
      }
    } else {
      const Planning planning(std::move(world), so2);
      EXPECT_EQ(lastValid(planning, {2.8}, {-2.8}), 2);  // valid
    }
  }
}

// Each edge would begin where the obstacle does.
TEST(ContinuousMotionValidatorTest, ObstaclesThatMoveAreRefused) {
  const auto cube = std::make_shared<fcl::Boxd>(1, 1, 1);
  fcl::ContinuousCollisionObjectd cart(cube, std::make_shared<fcl::TranslationMotiond>(at(0, 50), at(5, 50)));
  const auto refused = [](const std::function<void()>& call) {
    try {
      call();
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("an obstacle moves"), std::string::npos) << error.what();
    }
  };
  const auto tree = slideWorld().manager()->sharedTree();
  const auto manager = std::make_shared<ArticulatedCollisionManager>(tree);
  manager->setup();
  const auto space = reals(1);
  const auto si = std::make_shared<ob::SpaceInformation>(space);
  const ContinuousMotionValidator validator(si, manager);
  const CollisionStateValidityChecker checker(si, manager);
  const TestState s1(space, {0}), s2(space, {1});
  EXPECT_TRUE(validator.checkMotion(s1, s2));
  // It comes later, when the scene changes; and it is there from the beginning on.
  manager->registerObject(&cart, "cart");
  manager->setup();
  refused([&] { (void)validator.checkMotion(s1, s2); });
  std::pair<ob::State*, double> last{nullptr, 2};
  refused([&] { (void)validator.checkMotion(s1, s2, last); });
  EXPECT_EQ(last.second, 0);
  refused([&] { (void)checker.isValid(s1); });
  refused([&] { (void)ContinuousMotionValidator(si, manager); });
  refused([&] { (void)CollisionStateValidityChecker(si, manager); });
  manager->unregisterObject(&cart);
  manager->setup();
  EXPECT_TRUE(validator.checkMotion(s1, s2));
}

TEST(ContinuousMotionValidatorTest, CompoundOfSlideAndTurn) {
  // The arm of turnWorld on a slide along x; the obstacle ball at (4, 1).
  auto tree = std::make_shared<KinematicTree>("cart");
  for (const char* link : {"rail", "cart", "arm"}) tree->addLink(link);
  tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Eigen::Vector3d::UnitX(), -10, 10));
  tree->addJoint(makeJoint("turn", JointType::continuous, "cart", "arm", Eigen::Vector3d::UnitZ()));
  World world(tree);
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  world.bind("arm", ball, at(1, 0)).obstacle(ball, at(4, 1));
  const auto so2 = std::make_shared<ob::SO2StateSpace>();
  const auto space = std::make_shared<ob::CompoundStateSpace>(std::vector<ob::StateSpacePtr>{reals(1), so2},
                                                              std::vector<double>{1, 1});
  const Planning planning(std::move(world), space);
  // Arm straight up: balls meet when the slide is 0.2 before 4.
  const double t = lastValid(planning, {0, kPi / 2}, {8, kPi / 2});
  EXPECT_LT(t, 3.8 / 8);
  EXPECT_GT(t, 3.8 / 8 - 3 * kTolerance);
  // At the slide's 4 and turning over pi, away from pi/2.
  EXPECT_EQ(lastValid(planning, {4, 2.5}, {4, -2.5}), 2);
  EXPECT_NEAR(lastValid(planning, {4, 2.5}, {4, 0}), (2.5 - kPi / 2 - 2 * std::asin(0.1)) / 2.5, 3 * kTolerance);
}

TEST(ContinuousMotionValidatorTest, FloatingBodyTurnsIntoAPost) {
  // A ball of 0.1 m, 1 m along x from the body's frame, which turns by 3 rad about z and moves up by 0.5 m; a ball of
  // the same size waits on its way, at 2 rad and 1/3 m. Seen from it, both are a way of 1/3 apart: balls meet where (2
  // sin(1.5 s))^2 + (0.5 s)^2 = 0.04, s = 2/3 - t.
  auto tree = std::make_shared<KinematicTree>("drone");
  tree->addLink("world");
  tree->addLink("body");
  tree->addJoint(makeJoint("fly", JointType::floating, "world", "body", Eigen::Vector3d::UnitX()));
  World world(tree);
  const auto ball = std::make_shared<fcl::Sphered>(0.1);
  world.bind("body", ball, at(1, 0)).obstacle(ball, at(std::cos(2), std::sin(2), 1.0 / 3));
  SetupOptions options;
  EXPECT_THROW(setUpPlanning(world.manager(), {}), std::invalid_argument) << "no bounds";
  options.position_lower.setConstant(-2);
  options.position_upper.setConstant(2);
  const PlanningSetup setup = setUpPlanning(world.manager(), {}, options);
  ASSERT_EQ(setup.space->getType(), ob::STATE_SPACE_SE3);
  const TestState s1(setup.space, {0, 0, 0, 0, 0, 0, 1}),
      s2(setup.space, {0, 0, 0.5, 0, 0, std::sin(1.5), std::cos(1.5)});
  const TestState low(setup.space, {0, 0, -0.5, 0, 0, std::sin(1.5), std::cos(1.5)});
  double s = 0.2 / std::hypot(3, 0.5);
  for (int i = 0; i < 50; ++i)
    s = std::sqrt(0.04 - 0.25 * s * s) / 2 < 1 ? std::asin(std::sqrt(0.04 - 0.25 * s * s) / 2) / 1.5 : s;
  std::pair<ob::State*, double> last{nullptr, 2};
  EXPECT_FALSE(setup.si->checkMotion(s1, s2, last));
  EXPECT_LT(last.second, 2.0 / 3 - s);
  EXPECT_GT(last.second, 2.0 / 3 - s - 2 * kTolerance);
  EXPECT_TRUE(setup.si->checkMotion(s1, low));
}

TEST(ContinuousMotionValidatorTest, StatesAreCheckedByTheSameManager) {
  const Planning planning(slideWorld(), reals(1));
  for (const auto& [x, valid] :
       {std::make_pair(0.0, true), {1.9, true}, {2.1, false}, {3.0, false}, {3.9, false}, {4.1, true}}) {
    EXPECT_EQ(planning.si->isValid(TestState(planning.space, {x})), valid) << x;
  }
}

TEST(ContinuousMotionValidatorTest, BadInputThrows) {
  const Planning planning(slideWorld(), reals(1));
  const TestState s1(planning.space, {0}), nan(planning.space, {std::nan("")});
  EXPECT_THROW(planning.validator->checkMotion(s1, nan), std::invalid_argument);
  EXPECT_THROW(planning.si->isValid(nan), std::invalid_argument);
  EXPECT_EQ(planning.validator->getCheckedMotionCount(), 0u);
  EXPECT_THROW(ContinuousMotionValidator(nullptr, planning.world.manager()), std::invalid_argument);
  EXPECT_THROW(ContinuousMotionValidator(planning.si, nullptr), std::invalid_argument);
  EXPECT_THROW(CollisionStateValidityChecker(planning.si, nullptr), std::invalid_argument);
  const World other = slideWorld();
  EXPECT_THROW(ContinuousMotionValidator(planning.si, planning.world.manager(),
                                         JointMapping(*planning.space, other.manager()->sharedTree())),
               std::invalid_argument);
}

// The last motion's "valid up to 0.7" in that place is no answer to a motion that is none.
TEST(ContinuousMotionValidatorTest, WhenItThrowsTheStartIsTheLastValidState) {
  const Planning planning(slideWorld(), reals(1));
  const TestState s1(planning.space, {1}), far(planning.space, {1e6}),
      nowhere(planning.space, {std::numeric_limits<double>::quiet_NaN()}), state(planning.space, {7});
  for (const ob::State* to : {static_cast<ob::State*>(far), static_cast<ob::State*>(nowhere)}) {
    Last last{state, 0.7};
    EXPECT_THROW(planning.validator->checkMotion(s1, to, last), std::invalid_argument);
    EXPECT_EQ(last.second, 0);
    EXPECT_EQ(state[0], 1);
    last = {nullptr, 0.7};
    EXPECT_THROW(planning.validator->checkMotion(s1, to, last), std::invalid_argument);
    EXPECT_EQ(last.second, 0);
    last = {s1, 0.7};
    EXPECT_THROW(planning.validator->checkMotion(s1, to, last), std::invalid_argument);
    EXPECT_EQ(last.second, 0);
    EXPECT_EQ(s1[0], 1);
  }
  EXPECT_EQ(planning.validator->getCheckedMotionCount(), 0u);
}

TEST(ContinuousMotionValidatorTest, CountsFromManyThreads) {
  Planning planning(slideWorld(), reals(1));
  constexpr int kThreads = 8, kMotions = 2000;
  std::vector<std::vector<double>> times(kThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      const TestState s1(planning.space, {0}), state(planning.space, {0});
      for (int k = 0; k < kMotions; ++k) {
        const TestState s2(planning.space, {4.0 * k / kMotions});
        Last last{state, 2};
        if (k % 2) {
          planning.si->checkMotion(s1, s2, last);
        } else {
          last.second = planning.si->checkMotion(s1, s2) ? 2 : 0;
        }
        times[i].push_back(last.second);
        EXPECT_LE(planning.validator->getCheckedMotionCount(), 1u * kThreads * kMotions);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (int i = 1; i < kThreads; ++i) EXPECT_EQ(times[i], times[0]) << "bit for bit";
  unsigned valid = 0;
  for (const double t : times[0]) valid += t == 2;
  EXPECT_EQ(valid, kMotions / 2u) << "k / kMotions < 1/2 ends before the box";
  EXPECT_EQ(planning.validator->getValidMotionCount(), kThreads * valid);
  EXPECT_EQ(planning.validator->getInvalidMotionCount(), kThreads * (kMotions - valid));
  EXPECT_EQ(planning.validator->getValidMotionFraction(), 0.5);
  // Through OMPL's own, non-virtual getters.
  EXPECT_EQ(planning.si->getCheckedMotionCount(), 1u * kThreads * kMotions);
  EXPECT_EQ(planning.si->getMotionValidator()->getValidMotionCount(), kThreads * valid);
  planning.validator->resetMotionCounter();
  EXPECT_EQ(planning.si->getCheckedMotionCount(), 0u);
  EXPECT_EQ(planning.validator->getValidMotionFraction(), 0);
}

}  // namespace
}  // namespace motion_validator_test
}  // namespace fcl_artic::planning
