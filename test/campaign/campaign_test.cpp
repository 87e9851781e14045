// SPDX-License-Identifier: BSD-3-Clause
// The seeded campaign of arms, and proof that it would see a wrong answer. More queries: the program `campaign`.
#include "arms.h"
#include "expect.h"

namespace campaign {
namespace campaign_test {
namespace {

TEST(Campaign, NothingMissedNothingLateNothingFalse) {
  Options o;
  // CampaignFar asks for more; a debug or sanitizer build can ask for fewer.
  o.cases = fromEnvironment("FCL_ARTIC_CAMPAIGN_QUERIES", 5000);
  const Tally all = runWithoutFaults(campaignOf(Arms()), o).total;
  EXPECT_GE(all.share("hits"), 0.3);
  EXPECT_LE(all.share("hits"), 0.7);
  // The cases tell something only while they are hard.
  EXPECT_GE(all.share("between"), 0.1) << "hits between two free ends";
  EXPECT_GE(all.share("grazes"), 0.1) << "near misses";
  EXPECT_LE(all.share("starts"), 0.2) << "contacts at the start";
}

TEST(Campaign, SpoiltAnswersAreSeen) {
  Options o;
  o.cases = 3000;
  o.seed = 2;
  expectMutantsDie(campaignOf(Arms()), o, 8);
}

}  // namespace
}  // namespace campaign_test
}  // namespace campaign
