// SPDX-License-Identifier: BSD-3-Clause
//
// Every shared problem of the Panda and the UR5, three seeds each (label `planning`).
#include <gtest/gtest.h>

#include "plan.h"

namespace fcl_artic::planning {
namespace {

struct Case {
  const char *robot, *environment;
};

class PlanningCampaign : public testing::TestWithParam<Case> {};

TEST_P(PlanningCampaign, NoPlanCollides) {
  const std::filesystem::path data = planning_data::sharedData();
  if (data.empty())
    GTEST_SKIP() << "PlanningCampaign: FCL_ARTIC_DATA does not name a folder with robots/, problems/, edges/";
  EXPECT_EQ(collidingPlans(data, GetParam().robot, GetParam().environment, 1000, 3).colliding, 0);
}

std::vector<Case> cases() {
  std::vector<Case> all{{"panda", "thin"}};
  for (const char* robot : {"panda", "ur5_coarse"}) {
    for (const char* environment :
         {"bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage", "table_pick", "table_under_pick"}) {
      all.push_back({robot, environment});
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, PlanningCampaign, testing::ValuesIn(cases()),
                         [](const auto& info) { return std::string(info.param.robot) + "_" + info.param.environment; });

}  // namespace
}  // namespace fcl_artic::planning
