// SPDX-License-Identifier: BSD-3-Clause
// The executors osmesa and egl: the rule on each, what they cull beside cpu, threads, leaks, and what happens without them.
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "visibility/adversary.h"
#include "visibility/cpu_executor.h"
#include "visibility/culler.h"
#include "visibility/gl_executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// FCL_ARTIC_VISIBILITY_PAIRS=1000000 in the environment makes it a campaign.
std::uint64_t pairs(std::uint64_t usual) {
  const char* wanted = std::getenv("FCL_ARTIC_VISIBILITY_PAIRS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : usual;
}

std::unique_ptr<Executor> make(OffscreenBackend backend) {
  return std::make_unique<GlExecutor>(OffscreenContext::create(backend, 4, 3));
}

Batch batchOf(int resolution, VisibilityRule rule) {
  Batch batch;
  batch.resolution = resolution;
  batch.rule = rule;
  return batch;
}

class GlRule : public testing::TestWithParam<std::tuple<OffscreenBackend, int, VisibilityRule>> {
 protected:
  std::unique_ptr<Executor> executor_ = make(std::get<0>(GetParam()));
  Batch batch_ = batchOf(std::get<1>(GetParam()), std::get<2>(GetParam()));
};

TEST_P(GlRule, CullsNoPairThatTouches) {
  const std::uint64_t n = pairs(batch_.rule == VisibilityRule::intervals ? 30000 : 6000);
  EXPECT_EQ(countWrongCulls(*executor_, batch_, 1, 0, n), 0u) << "of " << n;
}

TEST_P(GlRule, WeakenedRulesAreSeen) {
  for (const Growth& growth : {Growth{false, false, 0}, Growth{false, true, 0}, Growth{true, false, 0}}) {
    batch_.growth = growth;
    EXPECT_GT(countWrongCulls(*executor_, batch_, 1, 0, 768), 300u) << growth.footprint << growth.depth;
  }
}

TEST_P(GlRule, CullsNearlyAllThatCpuCulls) {
  CpuExecutor cpu;
  Batch batch = batch_;
  for (const double gap : {1.0, 4.0}) {
    const std::uint64_t n = 2000, by_cpu = countWrongCulls(cpu, batch, 1, 0, n, gap),
                        by_gl = countWrongCulls(*executor_, batch_, 1, 0, n, gap);
    std::cout << gap << " pixels apart, of " << n << ": cpu " << by_cpu << ", this " << by_gl << "\n";
    EXPECT_GT(by_gl, by_cpu * 9 / 10);
  }
}

std::string nameOf(const testing::TestParamInfo<GlRule::ParamType>& info) {
  return std::string(std::get<0>(info.param) == OffscreenBackend::osmesa ? "osmesa" : "egl") +
         std::to_string(std::get<1>(info.param)) +
         (std::get<2>(info.param) == VisibilityRule::intervals ? "intervals" : "occlusion");
}
INSTANTIATE_TEST_SUITE_P(Osmesa, GlRule,
                         testing::Combine(testing::Values(OffscreenBackend::osmesa), testing::Values(16, 32, 64),
                                          testing::Values(VisibilityRule::intervals, VisibilityRule::occlusion)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Egl, GlRule,
                         testing::Combine(testing::Values(OffscreenBackend::egl), testing::Values(16, 32),
                                          testing::Values(VisibilityRule::intervals, VisibilityRule::occlusion)),
                         nameOf);

}  // namespace
}  // namespace visibility
}  // namespace fcl_artic
