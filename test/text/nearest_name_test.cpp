// SPDX-License-Identifier: BSD-3-Clause
#include "text/nearest_name.h"

#include <gtest/gtest.h>

namespace fcl_artic::text {
namespace nearest_name_test {
namespace {

TEST(NearestNameTest, CountsSlips) {
  EXPECT_EQ(editDistance("", "abc"), 3u);
  EXPECT_EQ(editDistance("elbow", "elbow"), 0u);
  EXPECT_EQ(editDistance("elbow", "ELBOW"), 0u);
  EXPECT_EQ(editDistance("elbow", "ebow"), 1u);
  EXPECT_EQ(editDistance("elbow", "elbwo"), 1u) << "two neighbours swapped";
  EXPECT_EQ(editDistance("kitten", "sitting"), 3u);
}

TEST(NearestNameTest, FindsTheNameThatWasMeant) {
  const std::vector<std::string> names = {"shoulder_pan_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "j"};
  EXPECT_EQ(nearestName("elbow_jiont", names), "elbow_joint");
  EXPECT_EQ(nearestName("Elbow_Joint", names), "elbow_joint");
  EXPECT_EQ(nearestName("wrist_2_join", names), "wrist_2_joint");
  EXPECT_EQ(nearestName("elbow", names), "elbow_joint") << "the only one that holds it";
  EXPECT_EQ(nearestName("wrist", names), "") << "two hold it";
  EXPECT_EQ(nearestName("gripper", names), "");
  EXPECT_EQ(nearestName("k", names), "") << "of one letter nothing can be said";
  EXPECT_EQ(nearestName("", names), "");
  EXPECT_EQ(didYouMean("elbow", names), "; did you mean 'elbow_joint'?");
  EXPECT_EQ(didYouMean("gripper", names), "");
}

}  // namespace
}  // namespace nearest_name_test
}  // namespace fcl_artic::text
