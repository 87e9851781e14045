// SPDX-License-Identifier: BSD-3-Clause
// The automatic switch: when it tries, and what it makes of that.
#include <gtest/gtest.h>

#include "visibility/choice.h"

namespace fcl_artic {
namespace visibility {
namespace {

TEST(Choice, TrialsTakeOnePercentOfTheTime) {
  Choice choice(1000);
  double all_us = 0, trials_us = 0;
  for (int i = 0; i < 100000; ++i) {
    const bool trial = choice.mayTry();
    choice.addQuery(50);
    all_us += 50;
    if (!trial) continue;
    choice.addTrial(800, 850, 50, true);
    trials_us += 800;
    ASSERT_LE(trials_us, 0.01 * all_us + 1000) << i;
  }
  EXPECT_GT(trials_us, 0.008 * all_us);
  EXPECT_FALSE(choice.pays());
}

TEST(Choice, FirstTrialWaitsForItsTime) {
  Choice choice(1000);
  for (int i = 0; i < 1999; ++i) {
    ASSERT_FALSE(choice.mayTry()) << i;
    choice.addQuery(50);
  }
  choice.addQuery(50);
  EXPECT_TRUE(choice.mayTry());
  EXPECT_FALSE(choice.mayTry()) << "the time is spoken for";
}

TEST(Choice, FollowsWhatPays) {
  Choice choice(0);
  for (int i = 0; i < 5; ++i) choice.addTrial(10, 50, 100, true);
  EXPECT_TRUE(choice.pays());
  for (int i = 0; i < 30; ++i) choice.addTrial(10, 95, 100, true);
  EXPECT_FALSE(choice.pays()) << "an advantage of 5 % is none";
  for (int i = 0; i < 30; ++i) choice.addTrial(10, 50, 100, true);
  EXPECT_TRUE(choice.pays());
  for (int i = 0; i < 30; ++i) choice.addTrial(10, 200, 100, false);
  EXPECT_TRUE(choice.pays()) << "trials with nothing to do tell nothing";
}

}  // namespace
}  // namespace visibility
}  // namespace fcl_artic
