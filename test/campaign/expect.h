// SPDX-License-Identifier: BSD-3-Clause
//
// Expectations of a campaign's report, and campaigns whose judges are expectations.
#pragma once

#include <iostream>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "harness.h"

namespace campaign {

/// Looks at a case by a function of gtest's expectations: each that fails is a fault.
inline void lookByExpectations(const std::function<void(Case&)>& look, Case& c) {
  testing::TestPartResultArray results;
  {
    using Reporter = testing::ScopedFakeTestPartResultReporter;
    const Reporter reporter(Reporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    look(c);
  }
  for (int i = 0; i < results.size(); ++i) {
    const testing::TestPartResult& result = results.GetTestPartResult(i);
    if (result.failed()) c.fault("expectation", result.message());
  }
}

/// Writes a query to a file, and names it, where an expectation fails during this object's life.
class QueryOfExpectations {
 public:
  /// @param text  as QueryFiles::add() has it.
  QueryOfExpectations(std::string name, std::function<std::string()> text)
      : name_(std::move(name)), text_(std::move(text)) {}
  QueryOfExpectations(const QueryOfExpectations&) = delete;
  QueryOfExpectations& operator=(const QueryOfExpectations&) = delete;
  ~QueryOfExpectations() {
    if (failures() == before_) return;
    QueryFiles files(QueryFiles::usualFolder(), name_);
    files.add(text_);
    ADD_FAILURE() << files.lines();
  }

 private:
  static int failures() { return testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count(); }

  std::string name_;
  std::function<std::string()> text_;
  int before_ = failures();
};

/// The campaign's report, printed; a fault of any kind fails the test. The test names the campaign.
inline Report runWithoutFaults(Campaign campaign, const Options& options) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  campaign.name = std::string(test.test_suite_name()) + "." + test.name();
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
