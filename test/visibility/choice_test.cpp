// SPDX-License-Identifier: BSD-3-Clause
// The automatic switch: when it tries, what it makes of that, and what it costs where the stage does not pay. All times
// are told, none is measured.
#include <functional>

#include <gtest/gtest.h>

#include "visibility/choice.h"

namespace fcl_artic {
namespace visibility {
namespace choice_test {
namespace {

/// Queries that take these times, us, answered as solve() answers them.
struct Load {
  double without_us = 50;
  double cpu_us = 100, cpu_stage_us = 60;  ///< the query with the executor cpu, and of that the stage
  double own_us = 100, making_us = -1;     ///< the query with the culler's own executor; making one, below 0: none
  bool telling = true;
};

/// Asks a Choice about queries and keeps what they took.
class Asker {
 public:
  explicit Asker(const Load& load) : load_(load), choice_(load.making_us) {}

  void ask() {
    ++queries;
    TrialPermit trial;
    if (choice_.measuresNext()) {
      trial = choice_.mayTry(own_is_made_);
      const double us = costOf(choice_.best());
      choice_.addQueries(us);
    }
    off_us += load_.without_us;
    all_us += costOf(choice_.best());
    if (!trial.given()) return;
    ++trials[trial.kind == ExecutorKind::own];
    const bool makes = trial.kind == ExecutorKind::own && !own_is_made_;
    own_is_made_ = own_is_made_ || makes;
    const double with_us = costOf(trial.kind), making_us = makes ? load_.making_us : 0;
    const double chosen_us = choice_.best() == ExecutorKind::none ? load_.without_us : with_us;
    const double extra_us = with_us + load_.without_us + making_us - chosen_us;
    trials_us += extra_us;
    all_us += extra_us;
    const double stage_us = trial.kind == ExecutorKind::own ? load_.own_us - 10 : load_.cpu_stage_us;
    choice_.addTrial(trial, {with_us, load_.without_us, stage_us, extra_us, load_.telling});
  }
  void ask(int n) {
    for (int i = 0; i < n; ++i) ask();
  }
  /// Queries until the way is taken; at most `most`.
  int askUntil(ExecutorKind kind, int most) {
    for (int i = 0; i < most; ++i) {
      if (choice_.best() == kind) return i;
      ask();
    }
    return most;
  }
  Choice& choice() { return choice_; }
  Load& load() { return load_; }

  std::uint64_t queries = 0, trials[2] = {0, 0};
  double off_us = 0, all_us = 0, trials_us = 0;

 private:
  double costOf(ExecutorKind kind) const {
    return kind == ExecutorKind::none ? load_.without_us : kind == ExecutorKind::cpu ? load_.cpu_us : load_.own_us;
  }
  Load load_;
  Choice choice_;
  bool own_is_made_ = false;
};

TEST(Choice, TrialsTakeTwoPercentOfTheTimeFromTheBeginning) {
  Asker asker({50, 90, 60});
  for (int i = 0; i < 200000; ++i) {
    asker.ask();
    // One query of many is measured and stands for all: what is known of the time is off by less than as many.
    ASSERT_LE(asker.trials_us, Choice::kShare * (asker.all_us + Choice::kMeasured * 100)) << i;
  }
  EXPECT_GT(asker.trials_us, 0.8 * Choice::kShare * asker.all_us);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::none);
  EXPECT_LT(asker.all_us, 1.021 * asker.off_us);
}

/// Where the stage is far from paying, trials take a quarter of that; and yet what changes is seen.
TEST(Choice, FarFromPayingIsTriedLess) {
  Asker asker({50, 150, 60});
  asker.ask(200000);
  EXPECT_LT(asker.all_us, 1.006 * asker.off_us);
  EXPECT_GT(asker.trials[0], 20u);
  asker.load().cpu_us = 20;
  EXPECT_LT(asker.askUntil(ExecutorKind::cpu, 1000000), 60000);
}

/// Early: six trials, each of which waits for its part of the time.
TEST(Choice, WhatPaysIsTakenAfterSomeHundredQueries) {
  Asker asker({50, 20, 15});
  EXPECT_LT(asker.askUntil(ExecutorKind::cpu, 100000), 1200);
  asker.ask(10000);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::cpu);
  EXPECT_LT(asker.all_us, 0.55 * asker.off_us) << "20 : 50, trials and the beginning";
}

TEST(Choice, OneTrialIsNoReason) {
  Choice choice;
  choice.addQueries(1e6, 20000, 1);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(choice.best(), ExecutorKind::none) << i;
    const TrialPermit leave = choice.mayTry(false);
    ASSERT_EQ(leave.kind, ExecutorKind::cpu);
    choice.addTrial(leave, {20, 50, 15, 20, true});
  }
  EXPECT_EQ(choice.best(), ExecutorKind::cpu);
}

TEST(Choice, FollowsWhatPays) {
  Asker asker({100, 50, 30});
  asker.ask(5000);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::cpu);
  asker.load().cpu_us = 95;
  asker.ask(20000);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::none) << "an advantage of 5 % is none";
  asker.load().cpu_us = 50;
  asker.ask(20000);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::cpu);
  asker.load().telling = false;
  asker.load().cpu_us = 200;
  asker.ask(20000);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::cpu) << "trials with nothing to do tell nothing";
}

/// Drawing with OpenGL is tried where the trials of cpu show that culling saves more than any drawing takes; a context
/// is made when its time is there.
TEST(Choice, OpenGlIsTriedWhereCullingSavesEnough) {
  Load load{400, 700, 550, 150, 200000};  // culling for nothing would take 400 us to 150
  Asker asker(load);
  const int until = asker.askUntil(ExecutorKind::own, 200000);
  // 200 ms are two percent of 10 s, 25,000 queries; a quarter of the share goes to trials of cpu meanwhile.
  EXPECT_GT(until, 24000);
  EXPECT_LT(until, 36000);
  EXPECT_LE(asker.trials_us, Choice::kShare * (asker.all_us + Choice::kMeasured * 700));
  asker.ask(400000);
  EXPECT_EQ(asker.choice().best(), ExecutorKind::own);
  EXPECT_LT(asker.all_us, 0.6 * asker.off_us);
}

TEST(Choice, OpenGlIsNeverMadeWhereCullingSavesLess) {
  Asker asker({50, 70, 35, 20, 200000});  // culling for nothing would take 50 us to 35
  asker.ask(1000000);
  EXPECT_EQ(asker.trials[1], 0u);
  EXPECT_GT(asker.trials[0], 0u);
  EXPECT_LT(asker.all_us, 1.021 * asker.off_us);
}

/// A culler whose executor the caller has made.
TEST(Choice, AnExecutorThatIsReadyIsTriedAtOnce) {
  Choice choice(200000);
  choice.addQueries(1e6, 20000, 1);
  int tried[3] = {0, 0, 0};
  TrialPermit last[3];
  for (int i = 0; i < 1000; ++i) {
    const TrialPermit leave = choice.mayTry(true);
    ++tried[static_cast<int>(leave.kind)];
    last[static_cast<int>(leave.kind)] = leave;
  }
  // Of 20 ms a quarter for cpu, whose trials are expected to take 0.1 ms, the others 1 ms.
  EXPECT_EQ(tried[static_cast<int>(ExecutorKind::cpu)], 50);
  EXPECT_EQ(tried[static_cast<int>(ExecutorKind::own)], 15);
  for (int i = 0; i < 6; ++i) choice.addTrial(last[static_cast<int>(ExecutorKind::own)], {20, 50, 15, 20, true});
  EXPECT_EQ(choice.best(), ExecutorKind::own);
  for (int i = 0; i < 6; ++i) choice.addTrial(last[static_cast<int>(ExecutorKind::cpu)], {10, 50, 15, 20, true});
  EXPECT_EQ(choice.best(), ExecutorKind::cpu) << "the better one of both";
}

/// Time is taken when leave is given, so that threads do not take it twice.
TEST(Choice, ReservedTimeIsSpent) {
  Choice choice;
  choice.addQueries(100 / Choice::kShare, 200, 1);
  EXPECT_TRUE(choice.mayTry(false).given());
  EXPECT_FALSE(choice.mayTry(false).given());
}

/// A batch of queries is tried as one.
TEST(Choice, QueriesOfABatchCountEach) {
  Choice choice;
  choice.addQueries(64 * 100 / Choice::kShare, 10000, 1);
  const TrialPermit leave = choice.mayTry(false, 64);
  ASSERT_TRUE(leave.given());
  EXPECT_NEAR(leave.reserved_us, 64 * 100, 1e-6);
  EXPECT_FALSE(choice.mayTry(false, 1).given());
}

}  // namespace
}  // namespace choice_test
}  // namespace visibility
}  // namespace fcl_artic
