// SPDX-License-Identifier: BSD-3-Clause
// When a query is solved again without the stage, and what is told and measured of it; with a solver that says what it
// is told to say.
#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/shape_tree.h"
#include "visibility/solve.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// One pair of a ball that sweeps along x and a triangle, `away` above it.
class SolveTwice : public testing::Test {
 protected:
  SolveTwice() : tree_(ShapeTree::fromTriangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})) {
    body_.tree = &tree_->view();
    problem_.bodies = &body_;
    problem_.num_bodies = problem_.num_obstacles = problem_.num_scene_pairs = 1;
  }
  /// Asks the stage, tells times and answers.
  void answer(const engine::Query& query, engine::Answer& answer) {
    refined_.push_back(query.num_advisors > 0);
    if (query.num_advisors) {
      engine::SweptLink links[8];
      for (int k = 0; k < 8; ++k) {
        for (int i = 0; i < 6; ++i) {
          links[k].points[i][0] = (k + i % 3 / 2.0) / 8;
          links[k].points[i][1] = 0.1;
          links[k].points[i][2] = away_;
        }
        links[k].radius = 0.05;
      }
      engine::CullCandidate pair = {0, 0, 0, 0xff, query.margins.of(0)};
      query.advisors[0].clear(query.advisors[0].self, problem_, links, &pair, 1);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(query.num_advisors ? 500 : 30000));
    for (const double t : {0.1, query.num_advisors ? 0.5 : 0.4, query.num_advisors ? 0.5 : 0.6}) {
      if (query.progress) query.progress(query.progress_context, t);
    }
    answer.status = status_;
    answer.num_ignored = ignored_;
    answer.statistics.node_tests = 10;
  }
  void solve(VisibilityMode mode) {
    refined_.clear();
    told_.clear();
    report_ = Report();
    engine::Query query;
    query.work_budget = budget_;
    query.progress = [](void* told, double t) {
      static_cast<std::vector<double>*>(told)->push_back(t);
      return true;
    };
    query.progress_context = &told_;
    answer_ = engine::Answer();
    visibility::solve(
        culler_, choice_, mode, [this](const engine::Query& asked, engine::Answer& out) { answer(asked, out); },
        problem_, query, answer_, report_);
    EXPECT_EQ(query.progress_context, &told_);
  }
  using Calls = std::vector<bool>;  ///< of the solver: with the stage?

  std::shared_ptr<const ShapeTree> tree_;
  engine::Body body_;
  engine::Problem problem_;
  VisibilityCuller culler_;
  Choice choice_{0};
  double away_ = 0.5;
  Status status_ = Status::free;
  int ignored_ = 0;
  std::uint64_t budget_ = 0;
  Calls refined_;
  std::vector<double> told_;
  Report report_;
  engine::Answer answer_;
};

TEST_F(SolveTwice, FreeStands) {
  solve(VisibilityMode::on);
  EXPECT_EQ(refined_, Calls({true}));
  EXPECT_EQ(report_.culled, 1u);
  EXPECT_EQ(report_.repeated, 0u);
}

TEST_F(SolveTwice, ContactIsSolvedAgain) {
  status_ = Status::contact;
  solve(VisibilityMode::on);
  EXPECT_EQ(refined_, Calls({true, false}));
  EXPECT_EQ(report_.culled, 1u);
  EXPECT_EQ(report_.repeated, 1u);
  EXPECT_EQ(told_, std::vector<double>({0.1, 0.5, 0.5, 0.5, 0.5, 0.6})) << "what is proven stays proven";
  EXPECT_EQ(answer_.statistics.node_tests, 20u);
}

/// From when a pair that touched is watched is part of the answer.
TEST_F(SolveTwice, IgnoredContactIsSolvedAgain) {
  ignored_ = 1;
  solve(VisibilityMode::on);
  EXPECT_EQ(refined_, Calls({true, false}));
}

TEST_F(SolveTwice, ContactOfWhichNothingWasTakenOutStands) {
  status_ = Status::contact;
  away_ = 0.04;
  solve(VisibilityMode::on);
  EXPECT_EQ(refined_, Calls({true}));
  EXPECT_EQ(report_.culled, 0u);
  EXPECT_EQ(report_.repeated, 0u);
}

/// What is nearer than the tolerance may be a contact to the solver alone.
TEST_F(SolveTwice, PairWithinTheToleranceIsNotCulled) {
  for (const double gap : {0.5e-6, 2e-6}) {
    away_ = 0.05 + gap;
    solve(VisibilityMode::on);
    EXPECT_EQ(report_.culled, gap > engine::Query().tolerance_distance ? 1u : 0u);
  }
}

TEST_F(SolveTwice, BudgetIsSpentWithoutTheStage) {
  budget_ = 1000;
  for (const VisibilityMode mode : {VisibilityMode::off, VisibilityMode::on, VisibilityMode::automatic}) {
    solve(mode);
    EXPECT_EQ(refined_, Calls({false}));
  }
}

/// A trial answers both ways and reports the answer without the stage. With it free queries take less, and those with
/// contact more.
TEST_F(SolveTwice, AutomaticCountsBothSolves) {
  status_ = Status::contact;
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({true, false}));
  EXPECT_EQ(report_.trials, 1u);
  EXPECT_EQ(report_.repeated, 0u);
  EXPECT_FALSE(choice_.pays());
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({false})) << "no time for a trial, and the stage does not pay";
}

TEST_F(SolveTwice, AutomaticTakesTheStageForFreeMotions) {
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({true, false}));
  EXPECT_TRUE(choice_.pays());
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({true}));
  status_ = Status::contact;
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({true, false}));
  EXPECT_EQ(report_.repeated, 1u);
  EXPECT_EQ(report_.trials, 0u);
}

}  // namespace
}  // namespace visibility
}  // namespace fcl_artic
