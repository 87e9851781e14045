// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.h"

#include <gtest/gtest.h>

namespace report_test {

namespace {

using fcl_artic::app::directionText;
using fcl_artic::app::placeText;

TEST(ReportText, HasNoMinusZeroAndNothingThatRoundingLeaves) {
  EXPECT_EQ(placeText({-0.0, 1e-17, 0.5}), "(0, 0, 0.5)");
  EXPECT_EQ(placeText({1e-17, -3e-17, 0}), "(0, 0, 0)");
  EXPECT_EQ(placeText({1234.56789, -1e-7, 2}, 4), "(1235, -1e-07, 2)");
  EXPECT_EQ(directionText({6.123e-17, -0.0, 1}), "(0, 0, 1)");
  EXPECT_EQ(directionText({-1e-9, -0.6, 0.8}), "(0, -0.6, 0.8)");
  EXPECT_EQ(directionText({-1e-4, -0.6, 0.8}, 3), "(0, -0.6, 0.8)");
}

}  // namespace

}  // namespace report_test
