// SPDX-License-Identifier: BSD-3-Clause
//
// Expectations of a campaign's report.
#pragma once

#include <iostream>

#include <gtest/gtest.h>

#include "harness.h"

namespace campaign {

/// The campaign's report, printed; a fault of any kind fails the test.
inline Report runWithoutFaults(const Campaign& campaign, const Options& options) {
  Report report = run(campaign, options);
  std::cout << "seed " << options.seed << "\n" << toText(report);
  EXPECT_EQ(report.total["cases"], options.cases);
  for (const auto& [kind, cases] : report.total.faultKinds()) EXPECT_EQ(cases, 0u) << kind;
  return report;
}

/// Each mutant spoils at least so many answers, and the judge sees its share of them.
inline void expectMutantsAreSeen(const Tally& tally, std::uint64_t least) {
  EXPECT_FALSE(tally.mutants().empty());
  for (const auto& [name, m] : tally.mutants()) {
    EXPECT_GE(m.spoilt, least) << name;
    EXPECT_GE(static_cast<double>(m.seen), m.share * static_cast<double>(m.spoilt)) << name;
  }
}

/// The same of a run for that alone.
inline void expectMutantsDie(const Campaign& campaign, Options options, std::uint64_t least) {
  options.mutants = true;
  expectMutantsAreSeen(runWithoutFaults(campaign, options).total, least);
}

}  // namespace campaign
