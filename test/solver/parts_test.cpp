// SPDX-License-Identifier: BSD-3-Clause
//
// Each part of the solver by itself, on two balls whose times of contact are known.
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "two_balls.h"

namespace parts_test {

using namespace fcl_artic;
using namespace fcl_artic::baseline;
using fcl_artic::engine::LeafContact;

namespace {

TEST(TimeBatch, PartsHoldTheirIntervalsWithoutAGap) {
  const TimeBatch batch = TimeBatch::partsOf(0.2, 0.4);
  EXPECT_EQ(batch.start[0], 0.2);
  EXPECT_EQ(batch.end[kLanes - 1], 0.2 + 0.4);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_LT(batch.at[k] - batch.d, batch.start[k]);
    EXPECT_GT(batch.at[k] + batch.d, batch.end[k]);
    EXPECT_EQ(batch.start[k], k ? batch.end[k - 1] : 0.2);
  }
  EXPECT_LE(batch.begin(), 0.2);
  EXPECT_GE(batch.finish(), 0.6);
  const TimeBatch all = TimeBatch::partsOf(0, 1);
  EXPECT_EQ(all.begin(), 0);
  EXPECT_EQ(all.finish(), 1);
}

TEST(TimeBatch, IsEqualToTheSameIntervalsOnly) {
  EXPECT_TRUE(TimeBatch::partsOf(0, 1) == TimeBatch::partsOf(0, 1));
  EXPECT_FALSE(TimeBatch::partsOf(0, 1) == TimeBatch::partsOf(0, 0.5));
  EXPECT_FALSE(TimeBatch::partsOf(0, 1) == TimeBatch::middles());  // the same middles, as poses
  EXPECT_TRUE(TimeBatch::around(0.3) == TimeBatch::around(0.3));
  TimeBatch other = TimeBatch::middles();
  other.setPose(5, 0.7);
  EXPECT_FALSE(other == TimeBatch::middles());
}

TEST(EarliestFirst, GivesTimesInOrderAndEqualOnesAsNumbered) {
  std::mt19937 random(7);
  EarliestFirst waiting;
  for (int round = 0; round < 200; ++round) {
    waiting.clear();
    std::set<std::pair<double, int>> expected;  // the judge
    const int count = round % 40;
    for (int number = 0; number < count || !expected.empty();) {
      if (number < count && (expected.empty() || random() % 3)) {
        const double t = 0.125 * (random() % 8);  // many are equal
        waiting.add(t, number);
        expected.emplace(t, number++);
      } else {
        ASSERT_FALSE(waiting.empty());
        ASSERT_EQ(waiting.take(), expected.begin()->second) << "round " << round;
        expected.erase(expected.begin());
      }
    }
    EXPECT_TRUE(waiting.empty());
  }
}

TEST(Task, EndsWithItsBudgetOrByTheCaller) {
  TwoBalls world;
  world.asPair().query.work_budget = 10;
  world.begin();
  world.task.statistics.node_tests = 10;
  EXPECT_FALSE(world.task.mustEnd(0));
  world.task.statistics.leaf_tests = 1;
  EXPECT_TRUE(world.task.mustEnd(0));
  EXPECT_TRUE(world.task.ended());
  world.begin();
  EXPECT_FALSE(world.task.ended());

  double told = -1;
  world.query.progress = [](void* t, double until) {
    *static_cast<double*>(t) = until;
    return until < 0.5;
  };
  world.query.progress_context = &told;
  world.query.work_budget = 0;
  world.begin();
  EXPECT_FALSE(world.task.mustEnd(0.25));
  EXPECT_EQ(told, -1);  // not before some work is done
  world.task.statistics.node_tests = 5000;
  EXPECT_FALSE(world.task.mustEnd(0.25));
  EXPECT_EQ(told, 0.25);
  EXPECT_FALSE(world.task.mustEnd(0.5));  // not at once again
  EXPECT_EQ(told, 0.25);
  world.task.statistics.leaf_tests = 5000;
  EXPECT_TRUE(world.task.mustEnd(0.5));
  EXPECT_TRUE(world.task.ended());
}

// The search goes on past a contact in the pairs beside it: what the caller is told does not.
TEST(Horizon, TellsNoLaterTimeThanTheFirstContact) {
  TwoBalls world;
  double told = -1;
  world.asPair().query.progress = [](void* t, double until) {
    *static_cast<double*>(t) = until;
    return true;
  };
  world.query.progress_context = &told;
  world.begin();
  world.horizon.joinLower(0.3);
  world.horizon.provenFree(0.5);
  world.task.statistics.node_tests = 5000;
  EXPECT_FALSE(world.horizon.mustEnd());
  EXPECT_EQ(told, 0.3);
  EXPECT_EQ(world.horizon.provenFreeUntil(), 0.5);
}

TEST(Horizon, WhatIsSuspectedPutsLaterLanesOffAndNothingElse) {
  TwoBalls world;
  world.asPair().begin();
  Horizon& horizon = world.horizon;
  EXPECT_EQ(horizon.live(), kAllLanes);
  horizon.suspect(0.3);
  EXPECT_EQ(horizon.live(), 0b111u);
  EXPECT_EQ(horizon.contactLane(), 0b100u);
  horizon.suspect(0.9);  // later than what is suspected
  EXPECT_EQ(horizon.live(), 0b111u);
  EXPECT_EQ(horizon.end(), kNever);
  EXPECT_EQ(horizon.first().t_lower, kNever);
  horizon.setBatch(TimeBatch::partsOf(0.3, 0.1));  // proven free up to there: it was none
  EXPECT_EQ(horizon.live(), kAllLanes);
  horizon.setBatch(TimeBatch::middles());  // poses: none is put off
  horizon.suspect(0.1);
  EXPECT_EQ(horizon.live(), kAllLanes);
}

TEST(Horizon, WhatIsProvenEndsIt) {
  TwoBalls world;
  world.asPair().begin();
  Horizon& horizon = world.horizon;
  horizon.closeAt(0.5);
  EXPECT_EQ(horizon.live(), 0b1111u);
  EXPECT_EQ(horizon.contactLane(), 0u);  // it is at the very end of one
  horizon.closeAt(0.7);
  EXPECT_EQ(horizon.end(), 0.5);
  EXPECT_FALSE(horizon.isOver());
  horizon.provenFree(0.2);
  horizon.provenFree(0.1);
  EXPECT_EQ(horizon.provenFreeUntil(), 0.2);
  horizon.joinLower(0.4);
  horizon.joinUpper(0.5);
  horizon.beginSearch();  // of another pair: the bracket stays
  EXPECT_EQ(horizon.end(), kNever);
  EXPECT_EQ(horizon.provenFreeUntil(), 0);
  EXPECT_EQ(horizon.first().t_lower, 0.4);
  EXPECT_EQ(horizon.first().t_upper, 0.5);

  world.query.any = true;
  world.begin();
  horizon.closeAt(0.5);
  EXPECT_TRUE(horizon.isOver());
  EXPECT_EQ(horizon.live(), 0u);
}

TEST(ContactList, OneGateForAllProofs) {
  TwoBalls world;
  world.asPair().query.ignore_initial = true;
  world.begin();
  ContactList& contacts = world.contacts;
  EXPECT_FALSE(contacts.takeProof(TwoBalls::kPair, 0.5));  // it is not known yet what is ignored
  EXPECT_EQ(world.horizon.end(), kNever);
  contacts.ignore(TwoBalls::kPair, 0.25);
  contacts.beginWatching();
  EXPECT_FALSE(contacts.takeProof(TwoBalls::kPair, 0.2));
  EXPECT_EQ(contacts.record(TwoBalls::kPair, 0, 0, 0.2), nullptr);
  EXPECT_EQ(world.horizon.first().t_upper, kNever);
  const LeafContact* contact = contacts.record(TwoBalls::kPair, 0, 0, 0.5);
  ASSERT_NE(contact, nullptr);
  EXPECT_EQ(contact->t_lower, 0.25);
  EXPECT_EQ(contact->t_upper, 0.5);
  EXPECT_TRUE(contact->certain);
  EXPECT_EQ(world.horizon.first().t_upper, 0.5);
  EXPECT_EQ(world.horizon.end(), 0.5);
}

TEST(ContactList, KeepsTheFirstOfEachPairInOrder) {
  TwoBalls world;
  world.asPair().query.max_contacts = 2;
  world.begin();
  const double times[6] = {0.6, 0.2, 0.9, 0.4, 0.3, 0.5};
  const PairId pairs[6] = {PairId{1}, {}, {}, {}, {}, PairId{1}};
  for (int i = 0; i < 6; ++i) {
    LeafContact& contact = world.contacts.grow(TwoBalls::kPair, 0, 0);
    contact.pair = pairs[i];
    contact.t_lower = times[i];
    contact.t_upper = 1;
  }
  world.contacts.order(0, 0.7);
  ASSERT_EQ(world.contacts.size(), 2);
  EXPECT_EQ(world.contacts.data()[0].t_lower, 0.2);
  EXPECT_EQ(world.contacts.data()[0].pair, PairId{0});
  EXPECT_EQ(world.contacts.data()[1].t_lower, 0.5);
  EXPECT_EQ(world.contacts.data()[1].pair, PairId{1});
  world.contacts.order(0, 0.7);
  EXPECT_EQ(world.contacts.size(), 2);
  world.query.max_contacts = 1;
  world.contacts.order(0, 0.7);
  ASSERT_EQ(world.contacts.size(), 1);
  EXPECT_EQ(world.contacts.data()[0].pair, PairId{0});
}

TEST(SweptFrames, AreMadeOncePerBatchAndKeptOfTheWholeMotion) {
  TwoBalls world;
  world.asPair().begin();
  world.frames.set(world.task.whole);
  const std::int32_t number = world.frames.number();
  const auto expectWhole = [&] {
    const FrameLanes& frame = world.frames.of(0, 0);
    for (int k = 0; k < kLanes; ++k) EXPECT_NEAR(frame.o[2][k], -2 + 4 * world.task.whole.at[k], 1e-14);
    EXPECT_EQ(world.frames.number(), number);
  };
  expectWhole();
  world.frames.set(TimeBatch::partsOf(0, 1));
  expectWhole();
  EXPECT_EQ(world.task.statistics.motion_evaluations, 1u);
  world.frames.set(TimeBatch::around(0.3));
  EXPECT_NE(world.frames.number(), number);
  EXPECT_NEAR(world.frames.of(0, 0).o[2][0], -0.8, 1e-14);
  // The whole motion's are kept; those of another batch are not.
  world.frames.set(world.task.whole);
  expectWhole();
  EXPECT_EQ(world.task.statistics.motion_evaluations, 2u);
  const std::int32_t before = world.frames.number();
  world.frames.set(TimeBatch::around(0.4));
  EXPECT_GT(world.frames.number(), before + 1);
  EXPECT_NEAR(world.frames.of(0, 0).o[2][0], -0.4, 1e-14);
  EXPECT_EQ(world.task.statistics.motion_evaluations, 3u);
  EXPECT_EQ(world.frames.bounds(0, -1).D1, 0);
  EXPECT_GE(world.frames.bounds(0, 0).D1, 4);
}

TEST(RelativeMotion, SeesEachBodyFromTheOther) {
  TwoBalls world;
  world.asPair().begin();
  const Seen motion = world.motions.of(TwoBalls::kPair, world.task.whole);
  const DifferenceBody at = motion->differenceAt(world.round[0].piece, world.round[1].piece, 3);
  EXPECT_NEAR(at.pose.c[2], -2 + 4 * world.task.whole.at[3], 1e-14);
  EXPECT_NEAR(motion->differenceAt(world.round[0].piece, world.round[1].piece, 3, 1).pose.c[2], 0,
              1e-12);  // t = 0.5
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(motion->side(1).m.c[0][2][k], -(-2 + 4 * world.task.whole.at[k]), 1e-14);
  }
  EXPECT_NEAR(motion->amplitude(), 0.25, 1e-9);  // half a lane: 1/16 of 4 m
  const SweptBox& box = motion->sweptNode(0, 0, motion->moving(0).nodes[0]);
  const FloatLanes below = spread(-2.25f), above = spread(-1.25f);
  EXPECT_EQ(lanesOf(greater(box.lo[2], below)) & 1, 0u);  // lane 0: from -2.25 to -1.25
  EXPECT_EQ(lanesOf(greater(above, box.hi[2])) & 1, 0u);
  EXPECT_TRUE(motion->isSwept(0, 0));
  EXPECT_FALSE(world.motions.of(TwoBalls::kPair, TimeBatch::middles())->isSwept(0, 0));
}

TEST(RelativeMotion, WitnessIsThePairs) {
  TwoBalls world;
  world.asPair().begin();
  const Vec3 up(0, 0, 1);
  const Seen first = world.motions.of(TwoBalls::kPair, world.task.whole);
  EXPECT_EQ(first->witness(), nullptr);
  first->setWitness(up);
  const Seen other = world.motions.of(TwoBalls::kPair, TimeBatch::middles());  // another batch: it serves still
  ASSERT_NE(other->witness(), nullptr);
  EXPECT_EQ((*other->witness())[2], 1);
  world.begin();
  EXPECT_EQ(world.motions.of(TwoBalls::kPair, world.task.whole)->witness(), nullptr);
}

TEST(Traversal, LeavesNoLaneWithContactOut) {
  for (const double shift : {0.0, 0.1, 0.37, 1.9}) {
    TwoBalls world(-2 - shift, 2 - shift);
    world.asPair().begin();
    const Seen seen = world.motions.of(TwoBalls::kPair, world.task.whole);
    const unsigned touching = TwoBalls::touching(TwoBalls::kFirst + shift / 4, TwoBalls::kLast + shift / 4);
    const unsigned blocked = world.traversal.blockedLanes(seen, kAllLanes);
    EXPECT_EQ(blocked & touching, touching) << shift;
    EXPECT_NE(blocked, kAllLanes) << shift;
    world.traversal.descend(seen, {TwoBalls::kPair, 0, 0, kAllLanes}, Aim::leaves, world.open);
    unsigned left = 0;
    for (int i = 0; i < world.open.size(); ++i) left |= world.open[i].mask;
    EXPECT_EQ(left & touching, touching) << shift;
  }
}

TEST(Traversal, PutsOffWhatIsLaterThanASuspicion) {
  TwoBalls world;
  world.asPair().begin();
  const Seen seen = world.motions.of(TwoBalls::kPair, world.task.whole);
  world.horizon.suspect(0.2);
  world.traversal.descend(seen, {TwoBalls::kPair, 0, 0, kAllLanes}, Aim::split, world.open);
  unsigned put_off = 0, looked_at = 0;
  for (int i = 0; i < world.open.size(); ++i) {
    (world.open[i].put_off ? put_off : looked_at) |= world.open[i].mask;
  }
  EXPECT_EQ(put_off, 0b11111100u);
  EXPECT_EQ(looked_at & put_off, 0u);
}

/// Balls of these radii in the middle of the two bodies' trees, each in a closed part that reaches as far as its body.
struct BallsInside {
  BallsInside(TwoBalls& world, double radius_a, double radius_b) {
    const double radius[2] = {radius_a, radius_b};
    for (int i = 0; i < 2; ++i) {
      const double reach = world.round[i].piece.radius;
      for (int k = 0; k < 3; ++k) {
        parts[i].lo[k] = -reach;
        parts[i].hi[k] = reach;
        for (int n = 0; n < 8; ++n) parts[i].points[k][n] = n / 2 == k ? (n % 2 ? reach : -reach) : 0;
      }
      for (int n = 0; n < InnerBalls::kMax; ++n) balls[i].radius[n] = -1e300;
      balls[i].radius[0] = radius[i];
      balls[i].count = 1;
      balls[i].reach = radius[i];
      balls[i].parts = &parts[i];
      world.bodies[i].balls = &balls[i];
    }
  }
  InnerBalls balls[2] = {};
  ClosedPart parts[2] = {};
};

TEST(BallProofs, ABallInALinkMeetsASolid) {
  TwoBalls world;
  world.asLinkAndObstacle().query.any = true;
  BallsInside inside(world, 0.4, 0.2);
  for (int k = 0; k < kLanes; ++k) {
    world.begin();
    world.frames.set(world.task.whole);
    const double z = -2 + 4 * world.task.whole.at[k];
    EXPECT_EQ(world.balls.inSolid(TwoBalls::kPair, k), std::abs(z) < 0.5 + 0.2) << k;
    EXPECT_EQ(world.contacts.size(), std::abs(z) < 0.5 + 0.2) << k;
  }
  // A solid that is within what the mesh encloses need not meet its surface.
  for (int k = 0; k < 3; ++k) {
    inside.parts[1].lo[k] = -10;
    inside.parts[1].hi[k] = 10;
  }
  world.begin();
  world.frames.set(world.task.whole);
  EXPECT_FALSE(world.balls.inSolid(TwoBalls::kPair, 3));
  world.bodies[1].balls = nullptr;
  EXPECT_FALSE(world.balls.inSolid(TwoBalls::kPair, 3));
}

TEST(BallProofs, BallsInLinksMeetAndNeitherLinkIsWithinTheOther) {
  TwoBalls world(-2.2, 1.8);  // B's middles: lane 2: -0.95, lane 3: -0.45, lane 4: 0.05, lane 5: 0.55
  const std::int32_t movers[2] = {0, 1};
  world.asPair().query.any = true;
  world.problem.movers = movers;
  world.problem.num_movers = world.problem.num_scene_movers = 2;
  world.bodies[0].mover = 0;
  world.bodies[1].mover = 1;
  world.bodies[1].step = 0;
  const BallsInside inside(world, 0.4, 0.2);
  EXPECT_EQ(world.problem.parts(TwoBalls::kPair).b, 1);
  for (int k = 0; k < kLanes; ++k) {
    world.begin();
    world.frames.set(world.task.whole);
    EXPECT_DOUBLE_EQ(world.balls.ballReach(TwoBalls::kPair), 0.4 + 0.2);
    const bool meet = k == 3 || k == 5;  // in lane 4 B lies within A
    EXPECT_EQ(world.balls.inLinks(TwoBalls::kPair, k), meet) << k;
    ASSERT_EQ(world.contacts.size(), meet) << k;
    if (meet) {
      EXPECT_EQ(world.horizon.first().t_upper, world.task.whole.at[k]);
    }
  }
  world.bodies[0].balls = nullptr;
  EXPECT_EQ(world.balls.ballReach(TwoBalls::kPair), 0);
}

TEST(HullSimplices, AreOfThePairItsNodeAndTheQuery) {
  HullSimplices simplices;
  simplices.begin();
  EXPECT_EQ(simplices.of(PairId{3}, 0).n, 0);
  simplices.of(PairId{3}, 0).n = 2;
  EXPECT_EQ(simplices.of(PairId{4}, 0).n, 0);
  EXPECT_EQ(simplices.of(PairId{3}, 0).n, 2);
  EXPECT_EQ(simplices.of(PairId{3}, 2).n, 0);  // another node of the same body
  EXPECT_EQ(simplices.of(PairId{3}, 0).n, 2);
  EXPECT_EQ(simplices.of(PairId{3 + 32}, 0).n, 0);  // pushes the other out
  EXPECT_EQ(simplices.of(PairId{3}, 0).n, 0);
  simplices.of(PairId{3}, 0).n = 2;
  simplices.begin();
  EXPECT_EQ(simplices.of(PairId{3}, 0).n, 0);
}

TEST(SweptRanges, AreOfOneBatchAndOneQueryAndOfTheirLanes) {
  TwoBalls world;
  world.round[1].tree.outer = world.round[1].tree.pieces;
  world.asPair().begin();
  const Piece& ball = world.round[0].tree.pieces[0];
  const Vec3 along(0, 0, 1);
  std::uint64_t looks = 0;
  SweptRanges ranges;
  const auto whole = [&] { return world.motions.of(TwoBalls::kPair, world.task.whole); };
  const unsigned apart = ranges.add(whole(), ball, along, kAllLanes);
  EXPECT_NE(apart, 0u);
  EXPECT_EQ(apart & TwoBalls::touching(), 0u);
  EXPECT_EQ(ranges.separate(whole(), ball, kAllLanes, looks), apart);
  EXPECT_EQ(ranges.separate(whole(), ball, 1, looks), 1u);
  // Another batch, in which the balls touch where they were apart before.
  const TimeBatch middle = TimeBatch::partsOf(TwoBalls::kFirst, TwoBalls::kLast - TwoBalls::kFirst);
  EXPECT_EQ(ranges.separate(world.motions.of(TwoBalls::kPair, middle), ball, kAllLanes, looks), 0u);
  // Only the lanes that were asked for are known.
  EXPECT_EQ(ranges.add(whole(), ball, along, 1), 1u);
  EXPECT_EQ(ranges.separate(whole(), ball, kAllLanes, looks), 1u);
  // The same pair and batch, by their number, may be those of another query.
  ranges.forget();
  EXPECT_EQ(ranges.separate(whole(), ball, kAllLanes, looks), 0u);
}

TEST(PoseProofs, ProveContactWhereItIs) {
  TwoBalls world;
  world.asPair().query.any = true;
  for (int k = 0; k < kLanes; ++k) {
    world.begin();
    const Seen seen = world.motions.of(TwoBalls::kPair, world.task.whole);
    const bool touch = k == 3 || k == 4;  // at 0.4375 and 0.5625; 0.3125 and 0.6875 are the very ends
    EXPECT_EQ(world.proofs.leaves(seen, 0, 0, k), touch) << k;
    ASSERT_EQ(world.contacts.size(), touch) << k;
    if (touch) {
      EXPECT_EQ(world.contacts.data()[0].t_upper, world.task.whole.at[k]);
      EXPECT_LE(norm(Vec3(world.contacts.data()[0].point)), 0.5 + 1e-9);
    }
  }
}

TEST(Follower, FindsTheRootAndProvesTheContact) {
  TwoBalls world;
  world.asPair().begin();
  Candidate f = {};
  f.entry = {TwoBalls::kPair, 0, 0, kAllLanes};
  EXPECT_FALSE(world.follower.followToRoot(f, 1, true));
  EXPECT_TRUE(f.gap_closed);
  EXPECT_LE(f.t_lower, TwoBalls::kFirst);
  EXPECT_GT(f.t_lower, TwoBalls::kFirst - 1e-6);
  EXPECT_FALSE(world.follower.decide(f, 1));
  ASSERT_TRUE(f.certain);
  EXPECT_GE(f.t_upper, TwoBalls::kFirst);
  EXPECT_LE(f.t_upper - f.t_lower, world.query.tolerance_time);
  ContactWriter(world).record(f);
  ASSERT_EQ(world.contacts.size(), 1);
  const LeafContact& contact = world.contacts.data()[0];
  EXPECT_NEAR(contact.normal[2], -1, 1e-6);  // from A to B, which comes from below
  EXPECT_NEAR(contact.point[2], -0.5, 1e-5);
  EXPECT_EQ(world.horizon.first().t_lower, f.t_lower);
  EXPECT_EQ(world.horizon.first().t_upper, f.t_upper);
}

TEST(Bracket, AContactAtTheEndMakesItCertain) {
  Bracket any = {Status::contact, 0.5, 1, false}, first = any, free = {Status::free, 1, 1, false};
  engine::sharpen(any, 1, 1e-6, true);
  EXPECT_TRUE(any.certain);
  EXPECT_EQ(any.t_upper, 1);
  engine::sharpen(first, 1, 1e-6, false);
  EXPECT_FALSE(first.certain);  // wider than the tolerance
  engine::sharpen(free, 1, 1e-6, true);
  EXPECT_EQ(free.status, Status::free);
  EXPECT_FALSE(free.certain);
}

TEST(Follower, ComesToTheEndOfWhatIsFree) {
  TwoBalls world;
  world.asPair().begin();
  Candidate f = {};
  f.entry = {TwoBalls::kPair, 0, 0, kAllLanes};
  EXPECT_TRUE(world.follower.followToRoot(f, 0.3, false));
  EXPECT_FALSE(f.gap_closed);
  EXPECT_GE(f.t_lower, 0.3);
}

TEST(AnyContact, TriesWhatIsGuessedAndBelievesNothing) {
  TwoBalls world;
  world.asPair().query.any = true;
  world.begin();
  EXPECT_FALSE(world.any.tryOverlaps(world.open));      // nothing is guessed
  world.any.guessOverlap(TwoBalls::kPair, 0b10000001);  // free at both
  EXPECT_FALSE(world.any.tryOverlaps(world.open));
  EXPECT_EQ(world.contacts.size(), 0);
  EXPECT_EQ(world.horizon.live(), kAllLanes);
  EXPECT_EQ(world.open.size(), 0);
  world.any.forgetOverlaps();
  world.any.guessOverlap(TwoBalls::kPair, 0b1000);
  EXPECT_TRUE(world.any.tryOverlaps(world.open));
  ASSERT_EQ(world.contacts.size(), 1);
  EXPECT_EQ(world.contacts.data()[0].t_upper, world.task.whole.at[3]);
}

TEST(StageOne, LeavesWhatMayMeet) {
  for (const bool as_pair : {true, false}) {
    TwoBalls world;
    (as_pair ? world.asPair() : world.asLinkAndObstacle()).begin();
    world.stage_one.cull(world.open);
    ASSERT_EQ(world.open.size(), 1);
    EXPECT_EQ(world.open[0].mask & TwoBalls::touching(), TwoBalls::touching());
    EXPECT_EQ(world.open[0].mask == kAllLanes, as_pair);  // of free bodies it knows nothing
    EXPECT_EQ(world.task.statistics.pairs, 1u);
  }
  TwoBalls away(1, 5);
  away.asLinkAndObstacle().begin();
  away.stage_one.cull(away.open);
  EXPECT_EQ(away.open.size(), 0);
}

TEST(StageOne, TakesWhatAdvisorsClear) {
  TwoBalls world;
  world.asLinkAndObstacle();
  struct Asked {
    int pairs = 0;
    unsigned keep = 0;
  } asked;
  asked.keep = 0b1000;
  engine::Advisor advisor;
  advisor.self = &asked;
  advisor.clear = [](void* context, const Problem&, const engine::SweptLink* links, engine::CullCandidate* pairs,
                     std::int32_t n) {
    Asked& a = *static_cast<Asked*>(context);
    a.pairs += n;
    for (int k = 0; k < kLanes; ++k) EXPECT_GE(links[k].radius, 0.25);
    for (int i = 0; i < n; ++i) pairs[i].lanes &= a.keep;
  };
  world.query.ask(advisor);
  world.begin();
  world.stage_one.cull(world.open);
  ASSERT_NE(world.stage_one.direction(world.open[0]), nullptr);
  world.stage_one.refine(world.open);
  EXPECT_EQ(asked.pairs, 1);
  ASSERT_EQ(world.open.size(), 1);
  EXPECT_EQ(world.open[0].mask, 0b1000u);
  EXPECT_NE(world.stage_one.direction(world.open[0]), nullptr);
  asked.keep = 0;
  world.stage_one.refine(world.open);
  EXPECT_EQ(world.open.size(), 0);
}

/// For two bodies that move, the advisor is given the volume that B sweeps in a frame in which A stands still: a ball
/// that goes straight along z.
TEST(StageOne, OffersPairsThatBothMoveWhereOneStandsStill) {
  TwoBalls world(-2, 2);
  world.asPair();
  const double ball[7] = {0, 0, 0, 0, 0, 0, 0.25};
  engine::Advisor advisor;
  int asked = 0;
  advisor.self = &asked;
  advisor.clear = [](void* context, const Problem& problem, const engine::SweptLink* links,
                     engine::CullCandidate* pairs, std::int32_t n) {
    ASSERT_EQ(n, 1);
    ++*static_cast<int*>(context);
    EXPECT_EQ(pairs->pair, problem.linkPair(0));
    EXPECT_EQ(pairs->still, 0);
    EXPECT_TRUE(pairs->at->identity);
    EXPECT_EQ(pairs->lanes, kAllLanes);
    for (int k = 0; k < kLanes; ++k) {
      const engine::SweptLink& part = links[kLanes * pairs->swept + k];
      EXPECT_GE(part.radius, 0.25);
      EXPECT_LT(part.radius, 0.25 + 1e-9);
      const double at[3] = {0, 1, 0.5};  // begin, end, and the Bernstein point between them
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(part.points[i][2], -2 + 0.5 * (k + at[i / 2]), 1e-12) << k << " " << i;
    }
    pairs->lanes = 0b10;
  };
  world.query.ask(advisor);
  world.begin();
  world.stage_one.cull(world.open);
  world.stage_one.refine(world.open);
  EXPECT_EQ(asked, 0) << "free bodies";
  world.bodies[1].tree_lss = ball;
  world.stage_one.refine(world.open);
  EXPECT_EQ(asked, 1);
  ASSERT_EQ(world.open.size(), 1);
  EXPECT_EQ(world.open[0].mask, 0b10u);
}

/// A toy advisor: it knows the two balls by heart, and counts how often it is asked.
struct Toy {
  unsigned free = 0;  ///< parts that it clears
  int asked = 0, suggested = 0;
  std::uint8_t parts[1] = {0};
  engine::LikelyContact likely = {0, 3};

  engine::Advisor advisor() {
    engine::Advisor advisor;
    advisor.self = this;
    advisor.clear = [](void* self, const Problem&, const engine::SweptLink*, engine::CullCandidate* pairs,
                       std::int32_t n) {
      Toy& toy = *static_cast<Toy*>(self);
      ++toy.asked;
      for (int i = 0; i < n; ++i) pairs[i].lanes &= ~toy.free;
    };
    advisor.freeParts = [](void* self) -> const std::uint8_t* {
      Toy& toy = *static_cast<Toy*>(self);
      toy.parts[0] = static_cast<std::uint8_t>(toy.free);
      return toy.parts;
    };
    advisor.suggest = [](void* self, std::int32_t& count) -> const engine::LikelyContact* {
      Toy& toy = *static_cast<Toy*>(self);
      ++toy.suggested;
      count = 0;  // the balls are no meshes
      return &toy.likely;
    };
    return advisor;
  }
};

TEST(Advisors, WhatTheyClearIsTrustedAndTheRestIsTheSameBits) {
  const unsigned really_free = kAllLanes & ~TwoBalls::touching();
  for (const bool any : {false, true}) {
    Solver solver;
    TwoBalls alone;
    alone.asLinkAndObstacle().query.any = any;
    engine::Answer without, with;
    solver.solve(alone.problem, alone.query, without);
    ASSERT_EQ(without.status, Status::contact);
    const double t_lower = without.t_lower, t_upper = without.t_upper;

    TwoBalls advised;
    Toy first, second;
    first.free = really_free & 0b1111;
    second.free = really_free & 0b11110000;
    advised.asLinkAndObstacle().query.any = any;
    advised.query.ask(first.advisor());
    advised.query.ask(second.advisor());
    solver.solve(advised.problem, advised.query, with);
    EXPECT_EQ(with.status, Status::contact);
    EXPECT_EQ(with.t_lower, t_lower);
    EXPECT_EQ(with.t_upper, t_upper);
    EXPECT_EQ(first.suggested, any);
    EXPECT_EQ(first.asked, 1);
    EXPECT_EQ(second.asked, 1);
  }
}

TEST(Advisors, WhatSeveralClearIsCleared) {
  Solver solver;
  TwoBalls world;
  Toy first, second;
  first.free = 0b01010101;
  second.free = 0b10101010;
  world.asLinkAndObstacle().query.ask(first.advisor());
  world.query.ask(second.advisor());
  engine::Answer answer;
  solver.solve(world.problem, world.query, answer);
  EXPECT_EQ(answer.status, Status::free);  // they are believed: it is they that prove
  EXPECT_EQ(first.asked, 1);
  EXPECT_EQ(second.asked, 1);
}

TEST(InitialContacts, AreIgnoredUntilTheyHaveSeparated) {
  TwoBalls world(0, 4);  // leaves at z = 0.75, t = 0.1875
  world.asPair().query.ignore_initial = true;
  world.begin();
  world.stage_one.cull(world.open);
  world.initial.collect(world.open);
  EXPECT_TRUE(world.contacts.watching());
  ASSERT_TRUE(world.contacts.isIgnored(TwoBalls::kPair));
  EXPECT_GE(world.contacts.watchFrom(TwoBalls::kPair), 0.1875);
  EXPECT_LE(world.contacts.watchFrom(TwoBalls::kPair), 0.1875 + 2.0 / 512);

  TwoBalls apart;
  apart.asPair().query.ignore_initial = true;
  apart.begin();
  apart.stage_one.cull(apart.open);
  apart.initial.collect(apart.open);
  EXPECT_FALSE(apart.contacts.isIgnored(TwoBalls::kPair));
}

TEST(Containment, AsksOfSolidsOnlyAndReportsAtTheStart) {
  TwoBalls world(0, 4);
  world.asPair().problem.contained = [](const Body&, const Body&, const engine::PairPose& pose,
                                        engine::ContainmentVerdict& found) {
    found = {};
    found.verdict = pose.c[2] < 0.5 ? engine::ContainmentVerdict::kCertain : engine::ContainmentVerdict::kNone;
    found.normal[2] = 1;
  };
  world.begin();
  world.stage_one.cull(world.open);
  world.containment.findAtStart();
  EXPECT_EQ(world.containment.size(), 0);                               // neither is a solid mesh
  world.bodies[0].space = reinterpret_cast<const SolidSpace*>(&world);  // only that there is one matters here
  world.containment.findAtStart();
  ASSERT_EQ(world.containment.size(), 1);
  EXPECT_TRUE(world.containment.isContainedAtStart(TwoBalls::kPair));
  EXPECT_FALSE(world.containment.mayBeContained(TwoBalls::kPair, 0.5));
  world.containment.report(world.open);
  EXPECT_EQ(world.horizon.end(), 0);
  ASSERT_EQ(world.contacts.size(), 1);
  EXPECT_EQ(world.contacts.data()[0].t_upper, 0);
}

TEST(PairSearch, FindsTheFirstContact) {
  for (const bool as_pair : {true, false}) {
    TwoBalls world;
    (as_pair ? world.asPair() : world.asLinkAndObstacle()).begin();
    world.stage_one.cull(world.open);
    world.search.testHulls(world.open, world.stage_one);
    world.search.run(world.open);
    const engine::FirstContact& first = world.horizon.first();
    EXPECT_LE(first.t_lower, TwoBalls::kFirst);
    EXPECT_GE(first.t_upper, TwoBalls::kFirst);
    EXPECT_LE(first.t_upper - first.t_lower, world.query.tolerance_time);
    EXPECT_EQ(world.contacts.size(), 1);
  }
  TwoBalls away(0.76, 4.76);
  away.asPair().begin();
  away.stage_one.cull(away.open);
  away.search.testHulls(away.open, away.stage_one);
  away.search.run(away.open);
  EXPECT_EQ(away.horizon.first().t_lower, kNever);
  EXPECT_EQ(away.horizon.provenFreeUntil(), 1);
}

}  // namespace

}  // namespace parts_test
