// SPDX-License-Identifier: BSD-3-Clause
// The seeded campaign, and proof that it would see a wrong answer. More queries: the program `campaign`.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "run.h"

namespace campaign {
namespace campaign_test {
namespace {

Options options(std::uint64_t queries) {
  Options o;
  o.queries = queries;
  o.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return o;
}

TEST(Campaign, NothingMissedNothingLateNothingFalse) {
  // CampaignFar asks for more; a debug or sanitizer build can ask for fewer.
  const char* wanted = std::getenv("FCL_ARTIC_CAMPAIGN_QUERIES");
  const Options o = options(wanted ? std::strtoull(wanted, nullptr, 10) : 5000);
  const Report report = run(o);
  std::cout << "seed " << o.seed << "\n" << toText(report);
  EXPECT_EQ(report.total.queries, o.queries);
  for (int f = 0; f < kFaults; ++f)
    EXPECT_EQ(report.total.faults[static_cast<std::size_t>(f)], 0u) << faultName(static_cast<Fault>(f));
  EXPECT_GE(report.total.hitShare(), 0.3);
  EXPECT_LE(report.total.hitShare(), 0.7);
  // The cases tell something only while they are hard.
  const double n = static_cast<double>(report.total.queries);
  EXPECT_GE(static_cast<double>(report.total.ends_free) / n, 0.1) << "hits between two free ends";
  EXPECT_GE(static_cast<double>(report.total.grazes) / n, 0.1) << "near misses";
  EXPECT_LE(static_cast<double>(report.total.starts) / n, 0.2) << "contacts at the start";
}

TEST(Campaign, SpoiltAnswersAreSeen) {
  Options o = options(3000);
  o.seed = 2;
  o.try_corruptions = true;
  const Report report = run(o);
  std::cout << "seed " << o.seed << "\n" << toText(report);
  for (int c = 1; c < kCorruptions; ++c) {
    const std::string name = corruptionName(static_cast<Corruption>(c));
    const auto spoilt = static_cast<double>(report.total.spoilt[static_cast<std::size_t>(c)]);
    const auto seen = static_cast<double>(report.total.spoilt_seen[static_cast<std::size_t>(c)]);
    ASSERT_GE(spoilt, 8) << name;
    // A moved point can stay inside a solid, and a contact at t = 0 has no direction that parts the bodies.
    EXPECT_GE(seen, (name == "point" || name == "normal" ? 0.75 : 0.99) * spoilt) << name;
  }
}

}  // namespace
}  // namespace campaign_test
}  // namespace campaign
