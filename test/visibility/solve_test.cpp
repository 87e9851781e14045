// SPDX-License-Identifier: BSD-3-Clause
// When a query is solved again without the stage, and what is told and measured of it; with a solver that says what it
// is told to say, and a clock that stands but for it.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/shape_tree.h"
#include "visibility/cpu_executor.h"
#include "visibility/solve.h"

namespace fcl_artic {
namespace visibility {
namespace solve_test {
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
      engine::CullCandidate pair = {{}, 0, 0, &body_.placement, 0xff, query.margins.of({})};
      query.advisors[0].clear(query.advisors[0].self, problem_, links, &pair, 1);
    }
    now_us_ += !query.num_advisors ? without_us_ : own_ran_ ? own_us_ : with_us_;
    for (const double t : {0.1, query.num_advisors ? 0.5 : 0.4, query.num_advisors ? 0.5 : 0.6}) {
      if (query.progress) query.progress(query.progress_context, t);
    }
    answer.status = status_;
    answer.num_ignored = ignored_;
    answer.statistics.node_tests = 10;
  }
  void solve(VisibilityMode mode) { solve(mode, choice_); }
  void solve(VisibilityMode mode, Choice& choice) {
    refined_.clear();
    own_ran_ = false;
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
        *culler_, choice, mode, [this](const engine::Query& asked, engine::Answer& out) { answer(asked, out); },
        problem_, query, answer_, report_, [this] { return now_us_; });
    EXPECT_EQ(query.progress_context, &told_);
  }
  using Calls = std::vector<bool>;  ///< of the solver: with the stage?

  std::shared_ptr<const ShapeTree> tree_;
  engine::Body body_;
  engine::Problem problem_;
  std::unique_ptr<const VisibilityCuller> culler_ = std::make_unique<VisibilityCuller>();
  Choice choice_;
  /// A solve with the stage, by cpu or by the culler's own executor, and one without.
  double now_us_ = 0, with_us_ = 500, own_us_ = 500, without_us_ = 30000;
  bool own_ran_ = false;
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

/// One solve with what is proven free left out, whatever the answer is; also with a budget, which counts that solve.
TEST_F(SolveTwice, AtOnceIsSolvedOnce) {
  for (const Status status : {Status::free, Status::contact, Status::undecided}) {
    for (const std::uint64_t budget : {std::uint64_t{0}, std::uint64_t{1000}}) {
      status_ = status;
      budget_ = budget;
      solve(VisibilityMode::atOnce);
      EXPECT_EQ(refined_, Calls({true}));
      EXPECT_EQ(report_.culled, 1u);
      EXPECT_EQ(report_.repeated, 0u);
      EXPECT_TRUE(answer_.status == status);
    }
  }
}

/// A trial answers both ways and reports the answer without the stage. With it free queries take less, and those with
/// contact more.
TEST_F(SolveTwice, AutomaticCountsBothSolves) {
  status_ = Status::contact;
  double all_us = 0, lost_us = 0;
  for (int i = 0; i < 2000; ++i) {
    const double begin = now_us_;
    solve(VisibilityMode::automatic);
    all_us += now_us_ - begin;
    if (report_.trials) {
      EXPECT_EQ(refined_, Calls({true, false}));
      lost_us += with_us_;
    } else {
      EXPECT_EQ(refined_, Calls({false}));
    }
    EXPECT_EQ(report_.repeated, 0u);
  }
  EXPECT_EQ(choice_.best(), ExecutorKind::none);
  EXPECT_GT(lost_us, 2 * with_us_);
  EXPECT_LT(lost_us, Choice::kShare * all_us);
}

TEST_F(SolveTwice, AutomaticTakesTheStageForFreeMotions) {
  for (int trial = 0; trial < 6; ++trial) {
    EXPECT_EQ(choice_.best(), ExecutorKind::none);
    report_.trials = 0;
    for (int asked = 0; asked < 3000 && !report_.trials; ++asked) solve(VisibilityMode::automatic);
    ASSERT_EQ(report_.trials, 1u);
    EXPECT_EQ(refined_, Calls({true, false}));
    EXPECT_EQ(report_.repeated, 0u);
  }
  EXPECT_EQ(choice_.best(), ExecutorKind::cpu);
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({true}));
  status_ = Status::contact;
  solve(VisibilityMode::automatic);
  EXPECT_EQ(refined_, Calls({true, false}));
  EXPECT_EQ(report_.repeated, 1u);
  EXPECT_EQ(report_.trials, 0u);
}

/// An executor of the culler's own: says that it has run.
struct Own : Executor {
  explicit Own(bool& tell) : ran(tell) {}
  void run(const Batch& batch, std::vector<std::uint8_t>& may) override {
    ran = true;
    cpu.run(batch, may);
  }
  bool& ran;
  CpuExecutor cpu;
};

/// What making an executor takes is time that is to be there first, and none of what queries cost with it.
TEST_F(SolveTwice, MakingAnExecutorIsNoCostOfAQuery) {
  int made = 0;
  culler_ = std::make_unique<VisibilityCuller>(VisibilityOptions(), "own", [&] {
    ++made;
    now_us_ += 200000;
    return std::make_unique<Own>(own_ran_);
  });
  Choice choice(ExecutorLoan::makingCost(*culler_));
  with_us_ = 29000;  // by cpu hardly anything is gained
  own_us_ = 500;
  while (!made && now_us_ < 1e8) solve(VisibilityMode::automatic, choice);
  EXPECT_EQ(made, 1);
  EXPECT_GT(now_us_, 200000 / Choice::kShare);
  EXPECT_EQ(report_.making_us, 200000);
  EXPECT_EQ(report_.trials, 1u);
  const double begin = now_us_;
  while (choice.best() == ExecutorKind::none && now_us_ < 1e9) solve(VisibilityMode::automatic, choice);
  EXPECT_EQ(choice.best(), ExecutorKind::own);
  EXPECT_LT(now_us_ - begin, 3e7) << "the making counted as a cost of a query";
  solve(VisibilityMode::automatic, choice);
  EXPECT_EQ(made, 1);
}

}  // namespace
}  // namespace solve_test
}  // namespace visibility
}  // namespace fcl_artic
