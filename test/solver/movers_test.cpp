// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 1's comparisons of one mover's box with eight others: which pairs it leaves, beside balls whose distances are
// known.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "ball.h"

#include "setup/mover_rows.h"

namespace movers_test {

using namespace fcl_artic;
using namespace fcl_artic::baseline;

namespace {

/// Balls that slide along straight lines, each by a variable of its own, some pairs of which are asked for.
class ManyBalls : public SolverParts {
 public:
  ManyBalls(int count, std::mt19937& random) : count_(count) {
    const auto size = static_cast<std::size_t>(count);
    std::uniform_real_distribution<double> at(-1, 1), length(0, 0.6);
    balls.resize(size);
    bodies.resize(size);
    steps.resize(size);
    coefficients.resize(2 * size);
    for (std::size_t i = 0; i < size; ++i) {
      balls[i].make(0.1 + 0.3 * std::abs(at(random)), bodies[i]);
      bodies[i].step = bodies[i].mover = static_cast<std::int32_t>(i);
      movers.push_back(static_cast<std::int32_t>(i));
      steps[i].kind = engine::StepKind::prismatic;
      for (int k = 0; k < 9; ++k) steps[i].C[k] = 0;
      // The slide is along z of the frame C: one of the world's axes.
      const int axis = static_cast<int>(random() % 3);
      for (int k = 0; k < 3; ++k) steps[i].C[3 * ((axis + 1 + k) % 3) + k] = 1;
      for (double& x : steps[i].p) x = at(random);
      steps[i].length = norm(Vec3(steps[i].p));
      steps[i].ulps = 2;
      steps[i].variable = static_cast<std::int32_t>(i);
      axes.push_back(axis);
      coefficients[i] = 0;
      coefficients[size + i] = length(random);
    }
    sweep.steps = steps.data();
    sweep.num_steps = count;
    query.coefficients = coefficients.data();
    query.num_variables = count;
    problem.bodies = bodies.data();
    problem.num_bodies = count;
    problem.sweeps = &sweep;
    problem.num_sweeps = 1;
    problem.movers = movers.data();
    problem.num_movers = problem.num_scene_movers = count;
  }
  /// Asks for pairs [begin, end) of `pairs`.
  void ask(const std::vector<engine::MoverPair>& pairs, std::size_t begin, std::size_t end) {
    link_movers = pairs;
    rows.clear();
    addMoverRows(link_movers, 0, begin, rows);
    const std::size_t first = rows.size();
    addMoverRows(link_movers, begin, end, rows);
    link_pairs.resize(pairs.size());
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      link_pairs[p].a = pairs[p].a;
      link_pairs[p].b = pairs[p].b;
    }
    problem.link_pairs = link_pairs.data() + begin;
    problem.link_movers = link_movers.data() + begin;
    problem.num_link_pairs = static_cast<std::int32_t>(end - begin);
    problem.mover_rows = rows.data() + first;
    problem.num_mover_rows = static_cast<std::int32_t>(rows.size() - first);
    problem.first_in_rows = static_cast<std::int32_t>(begin);
  }
  void begin() {
    SolverParts::begin(problem, query);
    horizon.setBatch(task.whole);
  }
  Vec3 center(int i, double t) const {
    Vec3 c(steps[static_cast<std::size_t>(i)].p);
    c[axes[static_cast<std::size_t>(i)]] += coefficients[static_cast<std::size_t>(count_ + i)] * t;
    return c;
  }
  double radius(int i) const { return balls[static_cast<std::size_t>(i)].piece.radius; }

  std::vector<Ball> balls;
  std::vector<Body> bodies;
  std::vector<engine::SweepStep> steps;
  std::vector<int> axes;
  std::vector<std::int32_t> movers;
  std::vector<double> coefficients;
  std::vector<engine::MoverPair> link_movers;
  std::vector<engine::MoverRow> rows;
  std::vector<LinkPair> link_pairs;
  engine::SweepView sweep;
  Problem problem;
  Query query;

 private:
  int count_;
};

TEST(MoverRows, HoldEachPairOnce) {
  std::mt19937 random(11);
  std::vector<engine::MoverPair> pairs;
  for (std::int32_t a = 0; a < 37; ++a) {
    for (std::int32_t b = 0; b < a; ++b) {
      if (random() % 3) pairs.push_back(random() % 2 ? engine::MoverPair{a, b} : engine::MoverPair{b, a});
    }
  }
  std::shuffle(pairs.begin(), pairs.end(), random);
  std::vector<engine::MoverRow> rows;
  addMoverRows(pairs, 100, pairs.size(), rows);
  std::set<std::size_t> found;
  for (const engine::MoverRow& row : rows) {
    for (std::int32_t lane = 0; lane < 8; ++lane) {
      ASSERT_EQ((row.lanes >> lane & 1) != 0, row.pair[lane] >= 0);
      if (row.pair[lane] < 0) continue;
      const auto p = static_cast<std::size_t>(row.pair[lane]);
      ASSERT_GE(p, 100u);
      EXPECT_TRUE(found.insert(p).second);
      EXPECT_EQ(std::minmax(pairs[p].a, pairs[p].b), std::minmax(row.mover, 8 * row.group + lane));
    }
  }
  EXPECT_EQ(found.size(), pairs.size() - 100);
}

/// This holds for any number of movers, any order of pairs, and any part of them that is asked for. Pairs that touch in
/// a part of the motion are left there, and most others are not.
TEST(StageOne, LeavesAllPairsOfMoversThatTouch) {
  std::mt19937 random(13);
  int touching = 0, left = 0, asked = 0;
  for (int round = 0; round < 60; ++round) {
    const int count = 2 + round % 29;
    ManyBalls world(count, random);
    std::vector<engine::MoverPair> pairs;
    for (std::int32_t a = 0; a < count; ++a) {
      for (std::int32_t b = 0; b < a; ++b) {
        if (random() % 4) pairs.push_back(random() % 2 ? engine::MoverPair{a, b} : engine::MoverPair{b, a});
      }
    }
    std::shuffle(pairs.begin(), pairs.end(), random);
    const std::size_t first = round % 2 ? pairs.size() / 3 : 0;
    const std::size_t end = round % 4 < 2 ? pairs.size() : pairs.size() - pairs.size() / 4;
    world.ask(pairs, first, end);
    world.begin();
    world.stage_one.cull(world.open);
    std::vector<unsigned> mask(end - first, 0);
    int previous = -1;
    for (int i = 0; i < world.open.size(); ++i) {
      const int p = world.problem.linkPairOf(world.open[i].pair);
      EXPECT_GT(p, previous) << "in their order";
      previous = p;
      mask[static_cast<std::size_t>(p)] = world.open[i].mask;
      left += __builtin_popcount(world.open[i].mask);
    }
    for (std::size_t p = first; p < end; ++p) {
      asked += kLanes;
      const auto [a, b] = pairs[p];
      for (int lane = 0; lane < kLanes; ++lane) {
        bool touch = false;
        for (int sample = 0; sample <= 20; ++sample) {
          const double t = 0.125 * (lane + 0.05 * sample);
          touch = touch || norm(world.center(a, t) - world.center(b, t)) <= world.radius(a) + world.radius(b);
        }
        touching += touch;
        if (touch) {
          EXPECT_TRUE(mask[p - first] >> lane & 1) << "round " << round << " pair " << p << " lane " << lane;
        }
      }
    }
  }
  std::printf("%d of %d (pair, part) touch, %d are left\n", touching, asked, left);
  EXPECT_GT(touching, 500);
  EXPECT_LT(left, 2 * touching);
}

/// A box of which some part is no number is no box: nothing is left out.
TEST(StageOne, LeavesWhatOverflows) {
  std::mt19937 random(14);
  int overflowed = 0;
  for (const double slope : {1.7e308, -1.7e308, std::numeric_limits<double>::quiet_NaN()}) {
    for (const double from : {0.0, 1e308, -1e308}) {
      ManyBalls world(3, random);
      world.coefficients[1] = from;
      world.coefficients[4] = slope;
      world.ask({{0, 1}, {2, 1}, {0, 2}}, 0, 3);
      world.begin();
      world.stage_one.cull(world.open);
      unsigned mask = 0;
      for (int i = 0; i < world.open.size(); ++i) {
        if (world.problem.linkPairOf(world.open[i].pair) == 0) mask = world.open[i].mask;
      }
      for (int lane = 0; lane < kLanes; ++lane) {
        const bool known = std::isfinite(from + slope * 0.125 * (lane + 1));
        if (!known) {
          EXPECT_TRUE(mask >> lane & 1) << slope << " from " << from << " lane " << lane;
        }
        overflowed += !known;
      }
    }
  }
  EXPECT_GT(overflowed, 20);
}

}  // namespace

}  // namespace movers_test
