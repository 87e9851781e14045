// SPDX-License-Identifier: BSD-3-Clause
// The executors osmesa and egl: the rule on each, what they cull beside cpu, threads, leaks, and what happens without
// them.
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
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
namespace executors_test {
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
    const std::uint64_t n = 1000, by_cpu = countWrongCulls(cpu, batch, 1, 0, n, gap),
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
INSTANTIATE_TEST_SUITE_P(Executors, GlRule,
                         testing::Combine(testing::Values(OffscreenBackend::osmesa, OffscreenBackend::egl),
                                          testing::Values(16, 32),
                                          testing::Values(VisibilityRule::intervals, VisibilityRule::occlusion)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(CampaignExecutors, GlRule,
                         testing::Combine(testing::Values(OffscreenBackend::osmesa, OffscreenBackend::egl),
                                          testing::Values(8, 64),
                                          testing::Values(VisibilityRule::intervals, VisibilityRule::occlusion)),
                         nameOf);

/// Without the margin for snapped vertices a few pairs in ten thousand are lost: only a large set shows it.
class Snapping : public testing::TestWithParam<OffscreenBackend> {};
TEST_P(Snapping, MissingMarginIsSeen) {
  const std::unique_ptr<Executor> executor = make(GetParam());
  Batch batch = batchOf(16, VisibilityRule::intervals);
  batch.growth.eta = 0;
  const std::uint64_t n = 200000, wrong = countWrongCulls(*executor, batch, 1, 0, n);
  std::cout << "no snapping margin: " << wrong << " of " << n << " culled wrongly\n";
  EXPECT_GT(wrong, 0u);
}
INSTANTIATE_TEST_SUITE_P(CampaignExecutors, Snapping, testing::Values(OffscreenBackend::osmesa, OffscreenBackend::egl),
                         [](const auto& info) { return info.param == OffscreenBackend::osmesa ? "osmesa" : "egl"; });

/// A volume of one point.
Volume pointAt(double x, double y, double z, double radius, Batch& batch) {
  const double p[3] = {x, y, z};
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.count = 1;
  volume.radius = radius;
  batch.points.insert(batch.points.end(), p, p + 3);
  return volume;
}

class AnyExecutor : public testing::TestWithParam<std::tuple<std::string, VisibilityRule>> {
 protected:
  AnyExecutor() {
    const std::string& name = std::get<0>(GetParam());
    if (name == "cpu") {
      executor_ = std::make_unique<CpuExecutor>();
    } else {
      executor_ = make(name == "osmesa" ? OffscreenBackend::osmesa : OffscreenBackend::egl);
    }
    batch_ = batchOf(32, std::get<1>(GetParam()));
    // A ball in the middle of a window, and one beside it.
    batch_.windows.push_back({{0, 0, 0}, {1, 1, 1}});
    batch_.swept.push_back({pointAt(0.3, 0.3, 0.3, 0.1, batch_), 0});
    batch_.objects.push_back({pointAt(0.8, 0.3, 0.3, 0.1, batch_), 0, 0});
    batch_.num_groups = 1;
  }
  /// Whether the object of the group may overlap.
  bool mayOverlap() {
    std::vector<std::uint8_t> may;
    executor_->run(batch_, may);
    return may.size() != 1 || may[0];
  }
  std::unique_ptr<Executor> executor_;
  Batch batch_;
};

TEST_P(AnyExecutor, BallsThatAreApartAreCulled) {
  EXPECT_FALSE(mayOverlap());
}

TEST_P(AnyExecutor, WhatIsNotFiniteMayOverlap) {
  const Batch good = batch_;
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
    for (const std::size_t i : {0u, 2u, 4u}) {  // of the swept ball and of the object
      batch_ = good;
      batch_.points[i] = bad;
      EXPECT_TRUE(mayOverlap()) << bad << " at " << i;
    }
    batch_ = good;
    batch_.windows[0].hi[1] = bad;
    EXPECT_TRUE(mayOverlap()) << "window " << bad;
  }
  for (const double bad : {std::nan(""), HUGE_VAL, -1.0}) {
    batch_ = good;
    batch_.swept[0].volume.radius = bad;
    EXPECT_TRUE(mayOverlap()) << "swept radius " << bad;
    batch_ = good;
    batch_.objects[0].volume.radius = bad;
    EXPECT_TRUE(mayOverlap()) << "radius " << bad;
  }
}

TEST_P(AnyExecutor, WindowWithoutVolumeMayOverlap) {
  const Batch good = batch_;
  for (int k = 0; k < 3; ++k) {
    batch_ = good;
    batch_.windows[0].hi[k] = batch_.windows[0].lo[k];
    EXPECT_TRUE(mayOverlap());
    std::swap(batch_.windows[0].hi[k], batch_.windows[0].lo[k]);
    batch_.windows[0].lo[k] = 1;
    batch_.windows[0].hi[k] = 0;
    EXPECT_TRUE(mayOverlap());
  }
}

TEST_P(AnyExecutor, VolumeWithoutPointsMayOverlap) {
  batch_.objects[0].volume.count = 0;
  EXPECT_TRUE(mayOverlap());
}

TEST_P(AnyExecutor, NothingToDoIsNothing) {
  batch_.clear();
  std::vector<std::uint8_t> may(3, 1);
  executor_->run(batch_, may);
  EXPECT_TRUE(may.empty());
}

/// Inside a closed surface nothing touches; inside a solid everything does.
TEST_P(AnyExecutor, SweptVolumeInsideASolidStays) {
  batch_.objects[0].volume = pointAt(0.35, 0.3, 0.3, 0.6, batch_);
  EXPECT_TRUE(mayOverlap());
}

INSTANTIATE_TEST_SUITE_P(Executors, AnyExecutor,
                         testing::Combine(testing::Values("cpu", "osmesa", "egl"),
                                          testing::Values(VisibilityRule::intervals, VisibilityRule::occlusion)),
                         [](const auto& info) {
                           return std::get<0>(info.param) +
                                  (std::get<1>(info.param) == VisibilityRule::intervals ? "Intervals" : "Occlusion");
                         });

class Contexts : public testing::TestWithParam<OffscreenBackend> {};

TEST_P(Contexts, FourThreadsWithFourContexts) {
  std::atomic<std::uint64_t> wrong{0}, culled{0};
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      const std::unique_ptr<Executor> executor = make(GetParam());
      Batch batch = batchOf(16, VisibilityRule::intervals);
      wrong += countWrongCulls(*executor, batch, 10 + t, 0, 4000);
      culled += countWrongCulls(*executor, batch, 10 + t, 0, 1000, 4);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(culled, 3500u);
}

/// A context that counts how many of its kind are current.
struct CountedContext : OffscreenContext {
  CountedContext(OffscreenBackend backend, std::atomic<int>& now, std::atomic<int>& most)
      : inner(OffscreenContext::create(backend, 4, 3)), now_(now), most_(most) {}
  void makeCurrent() override {
    inner->makeCurrent();
    most_ = std::max(most_.load(), ++now_);
  }
  void release() override {
    --now_;
    inner->release();
  }
  void* function(const char* name) const override { return inner->function(name); }
  std::unique_ptr<OffscreenContext> inner;
  std::atomic<int>&now_, &most_;
};

/// Mesa's llvmpipe crashes now and then where two are (doc/VISIBILITY.md, "Contexts").
TEST_P(Contexts, OneIsAtWorkAtATime) {
  std::atomic<int> now{0}, most{0};
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      GlExecutor executor(std::make_unique<CountedContext>(GetParam(), now, most));
      Batch batch = batchOf(16, VisibilityRule::intervals);
      countWrongCulls(executor, batch, 10 + t, 0, 4000);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(most, 1);
}

/// One executor goes from thread to thread, as a culler lends it.
TEST_P(Contexts, MovesBetweenThreads) {
  const std::unique_ptr<Executor> executor = make(GetParam());
  Batch batch = batchOf(16, VisibilityRule::intervals);
  for (std::uint64_t t = 0; t < 4; ++t) {
    std::uint64_t wrong = 1, culled = 0;
    std::thread([&] {
      wrong = countWrongCulls(*executor, batch, 20 + t, 0, 500);
      culled = countWrongCulls(*executor, batch, 20 + t, 0, 500, 4);
    }).join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(culled, 400u);
  }
}

double residentMegabytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// FCL_ARTIC_VISIBILITY_CONTEXTS=1000 in the environment makes it a campaign.
TEST_P(Contexts, LeaveNothingBehind) {
  const char* wanted = std::getenv("FCL_ARTIC_VISIBILITY_CONTEXTS");
  const int n = wanted ? std::atoi(wanted) : 60;
  const auto use = [&](int times) {
    for (int i = 0; i < times; ++i) {
      const std::unique_ptr<Executor> executor = make(GetParam());
      Batch batch = batchOf(16, VisibilityRule::intervals);
      ASSERT_EQ(countWrongCulls(*executor, batch, 30, 0, 64), 0u);
    }
  };
  use(20);  // what the driver keeps anyway
  const double before = residentMegabytes();
  use(n);
  const double grown = residentMegabytes() - before;
  std::cout << n << " contexts: " << grown << " MB more than " << before << "\n";
  EXPECT_LT(grown, 5 + 0.02 * n);
}

INSTANTIATE_TEST_SUITE_P(Executors, Contexts, testing::Values(OffscreenBackend::osmesa, OffscreenBackend::egl),
                         [](const auto& info) { return info.param == OffscreenBackend::osmesa ? "osmesa" : "egl"; });

/// Finds all objects free: the self-test has to see it.
struct Careless : Executor {
  void run(const Batch& batch, std::vector<std::uint8_t>& may) override { may.assign(batch.objects.size(), 0); }
};
/// Finds none free.
struct Useless : Executor {
  void run(const Batch& batch, std::vector<std::uint8_t>& may) override { may.assign(batch.objects.size(), 1); }
};

TEST(Culler, MissingDriverFallsBackWithAReason) {
  const VisibilityCuller culler({}, "egl",
                                []() -> std::unique_ptr<Executor> { throw std::runtime_error("no such library"); });
  EXPECT_EQ(culler.fallbackReason(), "");
  EXPECT_EQ(culler.executor(), "cpu");
  EXPECT_EQ(culler.fallbackReason(), "egl: no such library");
}

TEST(Culler, SelfTestDisablesWhatIsBroken) {
  const VisibilityCuller careless({}, "egl", [] { return std::make_unique<Careless>(); });
  EXPECT_EQ(careless.executor(), "cpu");
  EXPECT_EQ(careless.fallbackReason(), "egl: self-test: 1024 of 1024 touching pairs were culled");
  const VisibilityCuller useless({}, "egl", [] { return std::make_unique<Useless>(); });
  EXPECT_EQ(useless.executor(), "cpu");
  EXPECT_EQ(useless.fallbackReason(), "egl: self-test: it culls nothing");
}

TEST(Culler, BothBackendsWorkHere) {
  for (const auto backend : {OffscreenBackend::osmesa, OffscreenBackend::egl}) {
    const auto culler = makeOffscreenCuller(backend);
    EXPECT_EQ(culler->executor(), backend == OffscreenBackend::osmesa ? "osmesa" : "egl");
    EXPECT_EQ(culler->fallbackReason(), "");
  }
}

TEST(Culler, ResolutionOutOfRangeIsRefused) {
  VisibilityOptions options;
  for (const int resolution : {-1, 0, 3, 129}) {
    options.resolution = resolution;
    EXPECT_THROW(VisibilityCuller{options}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace executors_test
}  // namespace visibility
}  // namespace fcl_artic
