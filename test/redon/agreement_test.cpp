// SPDX-License-Identifier: BSD-3-Clause
// The paper's method against the library's own and against dense sampling. More queries: FCL_ARTIC_REDON_QUERIES.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "generator.h"
#include "run.h"

namespace {

using fcl_artic::Status;

std::uint64_t queries() {
  const char* wanted = std::getenv("FCL_ARTIC_REDON_QUERIES");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 150;
}

TEST(Redon2004, NothingMissedNothingLateNothingFalse) {
  campaign::Options options;
  options.queries = queries();
  options.seed = 4;
  options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options.how.method = fcl_artic::Method::Redon2004;
  const campaign::Report report = campaign::run(options);
  std::cout << campaign::toText(report);
  EXPECT_EQ(report.total.queries, options.queries);
  for (int f = 0; f < campaign::kFaults; ++f) {
    EXPECT_EQ(report.total.faults[static_cast<std::size_t>(f)], 0u) << campaign::faultName(static_cast<campaign::Fault>(f));
  }
  EXPECT_GE(report.total.hitShare(), 0.3);
  EXPECT_LE(report.total.hitShare(), 0.75);
}

TEST(Redon2004, SameVerdictAndTimeAsTheStandardMethod) {
  fcl_artic::CertifiedRequest paper;
  paper.method = fcl_artic::Method::Redon2004;
  std::uint64_t contacts = 0, free = 0, doubtful = 0;
  for (std::uint64_t i = 0; i < queries(); ++i) {
    const std::string& family = campaign::familyOf(7, i);
    const campaign::Scene scene = campaign::makeScene(family, 1000 + i);
    const campaign::Answer own = campaign::ask(scene), other = campaign::ask(scene, paper);
    // A graze that one of them can't tell from contact is a contact that is not certain.
    if (own.result.status != other.result.status) {
      const auto& contact = own.result.status == Status::contact ? own.result : other.result;
      EXPECT_FALSE(contact.certain) << family << " seed " << 1000 + i;
      ++doubtful;
      continue;
    }
    ++(own.result.status == Status::contact ? contacts : free);
    const double tolerance = 2 * scene.tolerance_time + (own.result.certain && other.result.certain ? 0 : 1e-2);
    EXPECT_NEAR(own.result.t_lower, other.result.t_lower, tolerance) << family << " seed " << 1000 + i;
  }
  std::cout << contacts << " contacts, " << free << " free, " << doubtful << " told apart by one method only\n";
  EXPECT_LE(doubtful, queries() / 100);
  EXPECT_GE(contacts, queries() / 5);
  EXPECT_GE(free, queries() / 5);
}

}  // namespace
