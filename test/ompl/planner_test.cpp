// SPDX-License-Identifier: BSD-3-Clause
//
// Whole plans: none of them may collide when it is looked at 100 times more closely than OMPL's default does.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include <ompl/util/Console.h>

#include "plan.h"

namespace fcl_artic::planning {
namespace planner_test {
namespace {

namespace ob = ::ompl::base;
using planning_data::Edge;
using planning_data::Environment;

TEST(PlannerTest, PlansAmongThinPlatesTouchNothing) {
  // A ball on two slides, and plates of 0.1 mm with gaps at alternating ends.
  auto tree = std::make_shared<KinematicTree>("gantry");
  for (const char* link : {"frame", "bridge", "ball"}) tree->addLink(link);
  tree->addJoint(makeJoint("x", JointType::prismatic, "frame", "bridge", Eigen::Vector3d::UnitX(), -5, 5));
  tree->addJoint(makeJoint("y", JointType::prismatic, "bridge", "ball", Eigen::Vector3d::UnitY(), -5, 5));
  World world(tree);
  world.bind("ball", std::make_shared<fcl::Sphered>(0.3));
  const auto plate = std::make_shared<fcl::Boxd>(1e-4, 8, 1);
  for (int i = -1; i <= 1; ++i) world.obstacle(plate, at(2.0 * i, i % 2 ? 2 : -2));
  const PlanningSetup setup = setUpPlanning(world.manager(), {});
  // The state of a ball and a plate, in closed form.
  const auto touches = [](const std::vector<double>& q) {
    for (int i = -1; i <= 1; ++i) {
      const double dx = std::max(0.0, std::abs(q[0] - 2.0 * i) - 0.5e-4);
      const double dy = std::max(0.0, std::abs(q[1] - (i % 2 ? 2 : -2)) - 4);
      if (dx * dx + dy * dy <= 0.09) return true;
    }
    return false;
  };
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Plans plans = plan(setup, {-4, 0}, {4, 0}, seed, 10.0);
    ASSERT_TRUE(plans.solved);
    EXPECT_EQ(firstSample(setup, plans.raw, touches), -1);
    EXPECT_EQ(firstSample(setup, plans.simplified, touches), -1);
    EXPECT_GT(plans.raw.size(), 2u) << "there is no straight way";
  }
}

class PlannerData : public testing::Test {
 protected:
  void SetUp() override {
    data_ = planning_data::sharedData();
    if (data_.empty())
      GTEST_SKIP() << "PlannerData: FCL_ARTIC_DATA does not name a folder with robots/, problems/, edges/";
  }
  std::filesystem::path data_;
};

TEST_F(PlannerData, EveryCollisionThatSamplingMissedIsRejected) {
  const Robot robot = planning_data::readRobot(data_, "panda");
  const std::vector<Edge> edges = planning_data::readMissed(data_ / "edges/panda_missed.json");
  ASSERT_EQ(edges.size(), 295u);
  std::map<std::string, Environment> environments;
  std::map<std::pair<std::string, int>, PlanningSetup> setups;
  int rejected = 0, late = 0, discrete = 0;
  for (const Edge& edge : edges) {
    if (!environments.count(edge.environment)) {
      environments[edge.environment] =
          planning_data::readEnvironment(data_ / "problems/panda" / (edge.environment + ".json"), *robot.tree);
    }
    const Environment& environment = environments.at(edge.environment);
    auto [at, is_new] = setups.try_emplace({edge.environment, edge.problem});
    if (is_new) at->second = setUp(robot, environment, environment.problem(edge.problem));
    const PlanningSetup& setup = at->second;
    const TestState s1(setup.space, edge.from), s2(setup.space, edge.to);
    std::pair<ob::State*, double> last{nullptr, 2};
    rejected += !setup.si->checkMotion(s1, s2) && !setup.si->checkMotion(s1, s2, last);
    late += last.second > edge.seen_at;
    discrete += ob::DiscreteMotionValidator(setup.si).checkMotion(s1, s2);
  }
  EXPECT_EQ(rejected, 295);
  EXPECT_EQ(late, 0);
  EXPECT_GT(discrete, 200) << "OMPL's own validator accepts them";
}

TEST_F(PlannerData, VerdictsAreTheManagersFromEightThreads) {
  const Robot robot = planning_data::readRobot(data_, "panda");
  const Environment environment = planning_data::readEnvironment(data_ / "problems/panda/thin.json", *robot.tree);
  const std::vector<Edge> edges = planning_data::readTrace(data_ / "edges/panda_trace.thin.json");
  std::map<int, PlanningSetup> setups;
  for (const Edge& edge : edges) {
    auto [at, is_new] = setups.try_emplace(edge.problem);
    if (is_new) at->second = setUp(robot, environment, environment.problem(edge.problem));
  }
  std::vector<bool> free(edges.size());
  int hits = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    CertifiedResult result;
    const ArticulatedCollisionManager& manager = *setups.at(edges[i].problem).manager;
    manager.continuousCollide(JointMotion::linear(*robot.tree, environment.configuration(*robot.tree, edges[i].from),
                                                  environment.configuration(*robot.tree, edges[i].to)),
                              planningRequest(), result);
    free[i] = result.isFree();
    EXPECT_FALSE(free[i] && edges[i].hit) << "edge " << i;
    hits += edges[i].hit;
  }
  ASSERT_GT(hits, 20);
  std::atomic<int> different{0}, asked{0}, late{0}, invalid_last{0};
  std::vector<std::thread> threads;
  for (unsigned n = 0; n < 8; ++n) {
    threads.emplace_back([&, n] {
      for (std::size_t k = 0; k < edges.size(); ++k) {
        const std::size_t i = (k + n * edges.size() / 8) % edges.size();
        const PlanningSetup& setup = setups.at(edges[i].problem);
        const TestState s1(setup.space, edges[i].from), s2(setup.space, edges[i].to), state(setup.space, edges[i].from);
        std::pair<ob::State*, double> last{state, 2};
        const bool valid = n % 2 ? setup.si->checkMotion(s1, s2) : setup.si->checkMotion(s1, s2, last);
        different += valid != free[i];
        late += !valid && n % 2 == 0 && last.second >= edges[i].seen_at;
        invalid_last += !valid && last.second > 0 && !setup.si->isValid(state);
        ++asked;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0);
  EXPECT_EQ(late, 0) << "last valid times at or after a collision that sampling saw";
  EXPECT_EQ(invalid_last, 0) << "last valid states that are not valid";
  EXPECT_EQ(asked, static_cast<int>(8 * edges.size()));
}

TEST_F(PlannerData, FewPandaPlansHoldNoCollision) {
  EXPECT_EQ(collidingPlans(data_, "panda", "bookshelf_thin", 3, 1).colliding, 0);
  EXPECT_EQ(collidingPlans(data_, "panda", "thin", 3, 1).colliding, 0);
}

TEST_F(PlannerData, FewUr5PlansHoldNoCollision) {
  EXPECT_EQ(collidingPlans(data_, "ur5_coarse", "table_pick", 1, 1).colliding, 0);
}

}  // namespace
}  // namespace planner_test
}  // namespace fcl_artic::planning
