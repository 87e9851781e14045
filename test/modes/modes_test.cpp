// SPDX-License-Identifier: BSD-3-Clause
//
// All modes against each other (rules.h). FCL_ARTIC_MODES_CASES asks for so many worlds, a dozen queries each, from
// seed FCL_ARTIC_MODES_SEED on; a finding names the seed that brings it back with FCL_ARTIC_MODES_CASES=1.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "rules.h"

namespace modes_test {

namespace {

std::uint64_t fromEnvironment(const char* name, std::uint64_t otherwise) {
  const char* value = std::getenv(name);
  return value ? std::strtoull(value, nullptr, 10) : otherwise;
}

TEST(Modes, AgreeInAllCombinationsOfOptions) {
  constexpr std::uint64_t kCases = 600;
  const std::uint64_t cases = fromEnvironment("FCL_ARTIC_MODES_CASES", kCases);
  const std::uint64_t seed = fromEnvironment("FCL_ARTIC_MODES_SEED", 16);
  modes::Tally tally;
  for (std::uint64_t i = 0; i < cases; ++i) modes::runCase(seed + i, tally);
  std::printf("%ld worlds, %ld queries: %ld free, %ld certain, %ld uncertain, %ld undecided\n", tally.cases,
              tally.queries, tally.free, tally.certain, tally.uncertain, tally.undecided);
  for (std::size_t i = 0; i < modes::kNumRules; ++i) {
    std::printf("  %-8s telling %ld times, broken %ld times\n", modes::kRuleNames[i], tally.telling[i],
                tally.broken[i]);
  }
  for (const std::string& finding : tally.findings) ADD_FAILURE() << finding;
  if (cases < kCases) return;
  for (std::size_t i = 0; i < modes::kNumRules; ++i) {
    EXPECT_GT(tally.telling[i], static_cast<long>(cases) / 100) << modes::kRuleNames[i] << " is hardly ever telling";
  }
}

/// Worlds that have found faults: a certain contact of the mode `any` that was not among the contacts, as a pair
/// beside it was still open.
TEST(Modes, WorldsThatFoundFaults) {
  modes::Tally tally;
  for (const std::uint64_t seed : {5047764u}) modes::runCase(seed, tally);
  EXPECT_GT(tally.queries, 0);
  for (const std::string& finding : tally.findings) ADD_FAILURE() << finding;
}

}  // namespace

}  // namespace modes_test
