// SPDX-License-Identifier: BSD-3-Clause
// The rule on the executor cpu: no wrong cull among pairs that touch by construction, and proof that the test would see
// one.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>

#include <gtest/gtest.h>

#include "visibility/adversary.h"
#include "visibility/cpu_executor.h"

namespace fcl_artic {
namespace visibility {
namespace rule_test {
namespace {

/// FCL_ARTIC_VISIBILITY_PAIRS=1000000 in the environment makes it a campaign.
std::uint64_t pairs() {
  const char* wanted = std::getenv("FCL_ARTIC_VISIBILITY_PAIRS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 30000;
}

class CpuRule : public testing::TestWithParam<std::tuple<int, VisibilityRule>> {
 protected:
  Batch batch() const {
    Batch b;
    b.resolution = std::get<0>(GetParam());
    b.rule = std::get<1>(GetParam());
    return b;
  }
  CpuExecutor executor_;
};

TEST_P(CpuRule, CullsNoPairThatTouches) {
  Batch b = batch();
  std::uint64_t by_kind[static_cast<int>(AdversaryKind::count)] = {};
  EXPECT_EQ(countWrongCulls(executor_, b, 1, 0, pairs(), 0, by_kind), 0u);
  for (int k = 0; k < static_cast<int>(AdversaryKind::count); ++k) EXPECT_EQ(by_kind[k], 0u) << "kind " << k;
}

TEST_P(CpuRule, WeakenedRulesAreSeen) {
  const struct {
    const char* name;
    bool footprint, depth;
    double least;  ///< part of the pairs that it culls wrongly
  } rules[] = {
      {"no dilation", false, false, 0.5}, {"depth only", false, true, 0.5}, {"footprint only", true, false, 0.01}};
  for (const auto& rule : rules) {
    Batch b = batch();
    b.growth = {rule.footprint, rule.depth, -1};
    const std::uint64_t n = 3000, wrong = countWrongCulls(executor_, b, 1, 0, n);
    std::cout << rule.name << ": " << wrong << " of " << n << " culled wrongly\n";
    EXPECT_GT(static_cast<double>(wrong), rule.least * static_cast<double>(n)) << rule.name;
  }
}

TEST_P(CpuRule, CullsPairsThatAreApart) {
  for (const double gap : {1.0, 4.0, 8.0}) {
    Batch b = batch();
    const std::uint64_t n = 2000, culled = countWrongCulls(executor_, b, 1, 0, n, gap);
    std::cout << gap << " pixels apart: " << culled << " of " << n << " culled\n";
    EXPECT_GT(culled, (gap > 3 ? n / 2 : n / 10));
  }
}

INSTANTIATE_TEST_SUITE_P(Resolutions, CpuRule,
                         testing::Combine(testing::Values(8, 16, 32, 64),
                                          testing::Values(VisibilityRule::intervals, VisibilityRule::occlusion)),
                         [](const auto& info) {
                           return std::string(std::get<1>(info.param) == VisibilityRule::intervals ? "intervals"
                                                                                                   : "occlusion") +
                                  std::to_string(std::get<0>(info.param));
                         });

}  // namespace
}  // namespace rule_test
}  // namespace visibility
}  // namespace fcl_artic
