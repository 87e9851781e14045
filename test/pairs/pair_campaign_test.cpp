// SPDX-License-Identifier: BSD-3-Clause
// The seeded campaign of pairs, and proof that it would see a wrong answer. More: the program `campaign --of pairs`.
#include "pair_campaign.h"
#include "expect.h"

namespace pair_campaign {
namespace pair_campaign_test {
namespace {

TEST(PairCampaign, NothingMissedNothingLateNothingFalse) {
  campaign::Options o;
  // PairCampaignFar asks for more; a debug or sanitizer build can ask for fewer.
  o.cases = campaign::fromEnvironment("FCL_ARTIC_PAIR_QUERIES", 2500);
  const campaign::Report report = runWithoutFaults(campaignOfPairs(), o);
  // The cases tell something only while they are hard.
  for (const auto& [name, tally] : report.families) {
    if (tally["cases"] < 100) continue;
    EXPECT_GE(tally.share("hits"), 0.3) << name;
    EXPECT_LE(tally.share("hits"), 0.75) << name;
    EXPECT_LE(tally.share("starts"), 0.35) << name;
  }
  const campaign::Tally& all = report.total;
  EXPECT_GE(all.share("between"), 0.1) << "hits between two free ends";
  EXPECT_GE(all.share("grazes"), 0.07) << "near misses";
  EXPECT_LE(all.share("uncertain", "certain"), 0.03);
}

// Found by other seeds: a sheet resting in a wide lane's wrong pose (point); a contact at a half-space's border
// (point); a proof that a divided lane forgot, so that the first contact was not the one that proves the answer
// (fields).
TEST(PairCampaign, FormerFaultsStayMended) {
  const campaign::CaseId cases[] = {{"mesh-shape/bounded", 4241737038310152947u},
                                    {"mesh-shape/bounded", 10989185904564861599u},
                                    {"mesh-shape/interp", 2920486461526761451u},
                                    {"mesh-shape/bounded", 3497044358052386707u}};
  for (const campaign::CaseId& id : cases) {
    std::string words;
    EXPECT_TRUE(replay(campaignOfPairs(), id, "", words)) << words;
  }
}

TEST(PairCampaign, SpoiltAnswersAreSeen) {
  campaign::Options o;
  o.cases = 800;
  o.seed = 2;
  expectMutantsDie(campaignOfPairs(), o, 50);
}

}  // namespace
}  // namespace pair_campaign_test
}  // namespace pair_campaign
