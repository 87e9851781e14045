// SPDX-License-Identifier: BSD-3-Clause
// A part of the campaign, and proof that it would see a wrong answer. All of it: the program `campaign --of trees`.
#include "expect.h"
#include "tree_campaign.h"

namespace urdf_trees {
namespace random_trees_test {
namespace {

TEST(RandomTrees, NothingIsMissedAndWrongAnswersWouldBeSeen) {
  campaign::Options o;
  o.cases = 400;
  o.threads = 1;
  o.mutants = true;
  const campaign::Tally all = runWithoutFaults(campaignOfTrees(), o).total;
  EXPECT_GT(all.share("hits") - all.share("starts"), 0.3);
  EXPECT_GT(all.share("free"), 0.3);
  EXPECT_LT(all.share("uncertain"), 0.02);
  for (const char* kind : {"revolute", "continuous", "prismatic", "fixed", "planar", "floating"})
    EXPECT_GT(all.share(kind, "joints"), 0.05) << kind;
  EXPECT_GT(all.share("mimics", "joints"), 0.02);
  EXPECT_GT(all.share("chains", "mimics"), 0.02);
  expectMutantsAreSeen(all, 50);
}

}  // namespace
}  // namespace random_trees_test
}  // namespace urdf_trees
