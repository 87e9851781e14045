// SPDX-License-Identifier: BSD-3-Clause
// A part of the campaign, and proof that it would see a wrong answer. All of it: the program `urdf_trees`.
#include <iostream>

#include <gtest/gtest.h>

#include "tree_campaign.h"

namespace urdf_trees {
namespace random_trees_test {
namespace {

TEST(RandomTrees, NothingIsMissedAndWrongAnswersWouldBeSeen) {
  Options options;
  options.trees = 400;
  options.spoil = true;
  const Report report = run(options);
  std::cout << "seed " << options.seed << "\n" << toText(report);
  EXPECT_EQ(report.missed, 0);
  EXPECT_EQ(report.untrue, 0);
  EXPECT_EQ(report.differing, 0);
  EXPECT_GT(report.hits - report.at_start, report.trees * 3 / 10);
  EXPECT_GT(report.free, report.trees * 3 / 10);
  EXPECT_LT(report.uncertain, report.trees / 50);
  for (const long count : report.of_kind) EXPECT_GT(count, report.joints / 20);
  EXPECT_GT(report.mimics, report.joints / 50);
  EXPECT_GT(report.chains, report.mimics / 50);
  EXPECT_GT(report.spoilt, 50);
  EXPECT_GT(report.spoilt_seen, report.spoilt * 9 / 10);
}

}  // namespace
}  // namespace random_trees_test
}  // namespace urdf_trees
