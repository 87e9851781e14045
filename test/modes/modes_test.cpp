// SPDX-License-Identifier: BSD-3-Clause
//
// All modes against each other (rules.h). FCL_ARTIC_MODES_CASES asks for so many worlds, a dozen queries each, from
// seed FCL_ARTIC_MODES_SEED on. `campaign --of modes --replay <seed>` brings the world of a finding back.
#include "expect.h"
#include "rules.h"

namespace modes_test {

namespace {

TEST(Modes, AgreeInAllCombinationsOfOptions) {
  constexpr std::uint64_t kCases = 600;
  campaign::Options o;
  o.cases = campaign::fromEnvironment("FCL_ARTIC_MODES_CASES", kCases);
  o.seed = campaign::fromEnvironment("FCL_ARTIC_MODES_SEED", 16);
  o.threads = 1;
  const campaign::Tally all = runWithoutFaults(modes::campaignOfModes(), o).total;
  if (o.cases < kCases) return;
  for (const std::string& rule : modes::rules())
    EXPECT_GT(all[rule + " told"], o.cases / 100) << rule << " is hardly ever telling";
}

/// Worlds that have found faults: a certain contact of the mode `any` that was not among the contacts, as a pair
/// beside it was still open.
TEST(Modes, WorldsThatFoundFaults) {
  campaign::Options o;
  o.cases = 1;
  for (const std::uint64_t seed : {5047764u}) {
    o.seed = seed;
    runWithoutFaults(modes::campaignOfModes(), o);
  }
}

/// Bodies that slide along each other, of which the paper's method bounds equations for a minute on end.
TEST(Modes, ThePapersMethodEndsWithoutABudget) {
  constexpr std::uint64_t kMaxWork = 1 << 17, kOneStep = 1 << 16;  // redon/redon.cpp; what is begun is ended
  const auto ask = [](std::uint64_t seed, fcl_artic::CertifiedRequest request, fcl_artic::CertifiedResult& result) {
    modes::Random random(seed);
    if (random.chance(0.3)) random.snap(0.05);
    modes::World(random).ask(request, result);
  };
  fcl_artic::CertifiedRequest first, every;
  first.redon.refinement_level = every.redon.refinement_level = 2;
  first.redon.simultaneous = first.redon.newton = first.redon.in_time_order = first.redon.early_validity = false;
  every.mode = fcl_artic::ContactMode::firstOfEveryPair;
  every.max_contacts = 100;
  every.redon.enclosure = fcl_artic::MotionEnclosure::intervalChain;
  every.redon.in_time_order = every.redon.early_validity = false;
  for (auto& [seed, request] : {std::pair(20u, first), std::pair(62u, every)}) {
    fcl_artic::CertifiedResult standard, result, in_budget;
    ask(seed, request, standard);
    fcl_artic::CertifiedRequest paper = request;
    paper.method = fcl_artic::Method::redon2004;
    ask(seed, paper, result);
    const fcl_artic::RedonStatistics& s = result.statistics.redon;
    const std::uint64_t work = s.box_tests + s.leaf_pairs + s.equations + s.evaluations;
    EXPECT_GT(work, kMaxWork) << seed;
    EXPECT_LT(work, kMaxWork + kOneStep) << seed;
    EXPECT_GT(s.pairs_by_standard, 0u);
    EXPECT_EQ(result.status, standard.status);
    EXPECT_EQ(result.t_lower, standard.t_lower);
    EXPECT_EQ(result.t_upper, standard.t_upper);
    EXPECT_EQ(result.contacts.size(), standard.contacts.size());
    // A budget is the caller's: then nobody else is asked.
    paper.work_budget = 1000;
    ask(seed, paper, in_budget);
    EXPECT_EQ(in_budget.status, fcl_artic::Status::undecided) << seed;
  }
}

}  // namespace

}  // namespace modes_test
