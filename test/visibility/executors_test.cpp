// SPDX-License-Identifier: BSD-3-Clause
// The rule on each executor, cpu, osmesa and egl: no wrong cull among pairs that touch by construction, and proof that
// the test would see one; what they cull beside each other; threads, leaks, and what happens without a driver.
#include <unistd.h>

#include <atomic>
#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "adversary.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace executors_test {

namespace {

using namespace fcl_artic;
using test::countCulls;
using visibility::Drawing;
using visibility::Executor;

std::uint64_t fromEnvironment(const char* name, std::uint64_t usual) {
  const char* wanted = std::getenv(name);
  return wanted ? std::strtoull(wanted, nullptr, 10) : usual;
}

std::unique_ptr<Executor> make(const std::string& name) {
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  const OffscreenBackend backend = name == "osmesa" ? OffscreenBackend::osmesa : OffscreenBackend::egl;
  if (name != "cpu") return visibility::makeOpenGlExecutor(OffscreenContext::create(backend, 4, 3));
#endif
  return visibility::makeCpuExecutor();
}
#ifdef FCL_ARTIC_HAS_OFFSCREEN
const char* const kExecutors[] = {"cpu", "osmesa", "egl"};
const char* const kOpenGl[] = {"osmesa", "egl"};
#else
const char* const kExecutors[] = {"cpu"};
#endif

Drawing drawingOf(int resolution) {
  Drawing drawing;
  drawing.resolution = resolution;
  return drawing;
}

class Rule : public testing::TestWithParam<std::tuple<const char*, int>> {
 protected:
  std::unique_ptr<Executor> executor_ = make(std::get<0>(GetParam()));
  Drawing drawing_ = drawingOf(std::get<1>(GetParam()));
};

/// FCL_ARTIC_VISIBILITY_PAIRS=1000000 in the environment makes it a campaign. OpenGL, whose every pair is drawn and
/// read by itself, is asked a quarter.
TEST_P(Rule, CullsNoPairThatTouches) {
  const bool cpu = std::string(std::get<0>(GetParam())) == "cpu";
  const std::uint64_t n = fromEnvironment("FCL_ARTIC_VISIBILITY_PAIRS", 30000) / (cpu ? 1 : 4);
  EXPECT_EQ(countCulls(*executor_, drawing_, 1, 0, n), 0u) << "of " << n;
}

TEST_P(Rule, FootprintsThatAreNotGrownAreSeen) {
  drawing_.grow_footprints = false;
  const std::uint64_t wrong = countCulls(*executor_, drawing_, 1, 0, 768);
  std::cout << wrong << " of 768 culled wrongly\n";
  EXPECT_GT(wrong, 400u);
}

/// OpenGL evaluates the same footprints, in float.
TEST_P(Rule, CullsPairsThatAreApartAsCpuDoes) {
  const std::unique_ptr<Executor> cpu = visibility::makeCpuExecutor();
  for (const double gap : {1.0, 4.0}) {
    const std::uint64_t n = 1000, by_cpu = countCulls(*cpu, drawing_, 1, 0, n, gap),
                        by_this = countCulls(*executor_, drawing_, 1, 0, n, gap);
    std::cout << gap << " pixels apart, of " << n << ": cpu " << by_cpu << ", this " << by_this << "\n";
    EXPECT_GT(by_cpu, gap > 3 ? n / 2 : n / 10);
    EXPECT_GE(by_this + 1, by_cpu);
    EXPECT_LE(by_this, by_cpu + 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Executors, Rule,
                         testing::Combine(testing::ValuesIn(kExecutors), testing::Values(8, 16, 32, 64)),
                         [](const auto& info) {
                           return std::get<0>(info.param) + std::to_string(std::get<1>(info.param));
                         });

/// Depths of a footprint hold the volume, in any rounding mode, and no more than floats make of it. Half of the volumes
/// end next to the window's border, where little is left of numbers that are large.
TEST(Footprints, DepthsHoldTheVolume) {
  pairs::Random random(5);
  int seen = 0;
  for (int trial = 0; trial < 40000; ++trial) {
    Drawing drawing = drawingOf(16);
    for (int k = 0; k < 3; ++k) {
      drawing.lo[k] = random.uniform(-1, 1);
      drawing.hi[k] = drawing.lo[k] + random.uniform(0.5, 2);
    }
    const int view = random.below(3), count = 1 + random.below(4);
    std::vector<test::Vector3d> points;
    for (int i = 0; i < count; ++i)
      points.push_back(test::Vector3d(0.3, 0.3, 0.3) + random.direction() * random.logUniform(1e-3, 1e3));
    double least = points[0][view], most = least;
    for (const test::Vector3d& point : points) {
      least = std::min(least, point[view]);
      most = std::max(most, point[view]);
    }
    double radius = random.logUniform(1e-3, 1e3);
    if (trial % 2) radius = std::abs(least - drawing.lo[view]) * (1 + random.uniform(-1e-14, 1e-14));
    drawing.swept.push_back(test::Adversary::addVolume(points, radius, drawing));
    visibility::Footprint footprint;
    constexpr int kModes[] = {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO};
    std::fesetround(kModes[trial / 2 % 4]);
    const bool shown = project(drawing, drawing.swept[0], view, footprint);
    std::fesetround(FE_TONEAREST);
    if (!shown) continue;
    ++seen;
    using Long = long double;
    const Long lo = drawing.lo[view], side = drawing.hi[view] - lo;
    const Long nearest = (least - lo - radius) / side, farthest = (most - lo + radius) / side;
    ASSERT_LE(footprint.nearest, nearest) << trial;
    ASSERT_GE(footprint.farthest, farthest) << trial;
    const Long room = 0x1p-21 * std::abs(nearest) + 0x1p-21 * std::abs(farthest) + 1e-9;
    ASSERT_GE(footprint.nearest, nearest - room) << trial;
    ASSERT_LE(footprint.farthest, farthest + room) << trial;
  }
  EXPECT_GT(seen, 10000);
}

class AnyExecutor : public testing::TestWithParam<const char*> {
 protected:
  /// A ball in the middle of a window, and one beside it.
  AnyExecutor() {
    std::fill_n(drawing_.hi, 3, 1.0);
    drawing_.swept.push_back(test::Adversary::addVolume({{0.3, 0.3, 0.3}}, 0.1, drawing_));
    drawing_.pieces.push_back({test::Adversary::addVolume({{0.8, 0.3, 0.3}}, 0.1, drawing_), 0});
    drawing_.num_groups = 1;
  }
  bool mayOverlap() {
    std::vector<std::uint8_t> may;
    executor_->draw(drawing_, may);
    return may.size() != 1 || may[0];
  }
  std::unique_ptr<Executor> executor_ = make(GetParam());
  Drawing drawing_;
};

TEST_P(AnyExecutor, BallsThatAreApartAreCulled) {
  EXPECT_FALSE(mayOverlap());
}

/// Two swept balls, one after the other along an axis, and a piece in one of them.
TEST_P(AnyExecutor, EachSweptVolumeCounts) {
  for (int k = 0; k < 3; ++k) {
    for (const bool in_first : {true, false}) {
      drawing_.clear();
      test::Vector3d first = test::Vector3d::Constant(0.3), second = first;
      second[k] = 0.8;
      for (const test::Vector3d& at : {first, second})
        drawing_.swept.push_back(test::Adversary::addVolume({at}, 0.1, drawing_));
      drawing_.pieces.push_back({test::Adversary::addVolume({in_first ? first : second}, 0.05, drawing_), 0});
      drawing_.num_groups = 1;
      EXPECT_TRUE(mayOverlap()) << "axis " << k << ", in the first: " << in_first;
    }
  }
}

TEST_P(AnyExecutor, WhatIsNotFiniteMayOverlap) {
  const Drawing good = drawing_;
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
    for (const std::size_t i : {0u, 2u, 4u}) {  // of the swept ball and of the object
      drawing_ = good;
      drawing_.points[i] = bad;
      EXPECT_TRUE(mayOverlap()) << bad << " at " << i;
    }
    drawing_ = good;
    drawing_.hi[1] = bad;
    EXPECT_TRUE(mayOverlap()) << "window " << bad;
  }
  for (const double bad : {std::nan(""), HUGE_VAL, -1.0}) {
    drawing_ = good;
    drawing_.swept[0].radius = bad;
    EXPECT_TRUE(mayOverlap()) << "swept radius " << bad;
    drawing_ = good;
    drawing_.pieces[0].volume.radius = bad;
    EXPECT_TRUE(mayOverlap()) << "radius " << bad;
  }
}

TEST_P(AnyExecutor, WindowWithoutVolumeMayOverlap) {
  const Drawing good = drawing_;
  for (int k = 0; k < 3; ++k) {
    for (const double hi : {0.0, -1.0, 1e-310}) {
      drawing_ = good;
      drawing_.hi[k] = hi;
      EXPECT_TRUE(mayOverlap());
    }
  }
}

/// More than OpenGL draws at once: every 997th touches.
TEST_P(AnyExecutor, EachOfVeryManyPiecesCounts) {
  drawing_.pieces.clear();
  drawing_.num_groups = 30000;
  const auto touches = [](int group) { return group % 997 == 0; };
  for (int group = 0; group < drawing_.num_groups; ++group) {
    const double x = touches(group) ? 0.3 : 0.8;
    drawing_.pieces.push_back({test::Adversary::addVolume({{x, 0.3, 0.3}}, 0.05, drawing_), group});
  }
  std::vector<std::uint8_t> may;
  executor_->draw(drawing_, may);
  for (int group = 0; group < drawing_.num_groups; ++group)
    ASSERT_EQ(may[static_cast<std::size_t>(group)] != 0, touches(group)) << group;
}

/// Inside a closed surface nothing touches; inside a solid everything does.
TEST_P(AnyExecutor, EdgeCases) {
  drawing_.pieces[0].volume.count = 0;
  EXPECT_TRUE(mayOverlap()) << "a volume without points";
  drawing_.pieces[0].volume = test::Adversary::addVolume({{0.35, 0.3, 0.3}}, 0.6, drawing_);
  EXPECT_TRUE(mayOverlap()) << "what is swept lies in a solid";
  drawing_.clear();
  std::vector<std::uint8_t> may(3, 1);
  executor_->draw(drawing_, may);
  EXPECT_TRUE(may.empty()) << "nothing to do";
}

INSTANTIATE_TEST_SUITE_P(Executors, AnyExecutor, testing::ValuesIn(kExecutors),
                         [](const auto& info) { return info.param; });

#ifdef FCL_ARTIC_HAS_OFFSCREEN
class Contexts : public testing::TestWithParam<const char*> {};

/// A context that counts how many of its kind are current.
struct CountedContext : OffscreenContext {
  CountedContext(const std::string& name, std::atomic<int>& now, std::atomic<int>& most)
      : inner(OffscreenContext::create(name == "osmesa" ? OffscreenBackend::osmesa : OffscreenBackend::egl, 4, 3)),
        now_(now),
        most_(most) {}
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

/// Mesa's llvmpipe crashes now and then where two are at work (doc/VISIBILITY.md, "Contexts").
TEST_P(Contexts, OfFourThreadsOneIsAtWorkAtATime) {
  std::atomic<int> now{0}, most{0};
  std::atomic<std::uint64_t> wrong{0}, culled{0};
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      const auto executor = visibility::makeOpenGlExecutor(std::make_unique<CountedContext>(GetParam(), now, most));
      wrong += countCulls(*executor, drawingOf(16), 10 + t, 0, 4000);
      culled += countCulls(*executor, drawingOf(16), 10 + t, 0, 1000, 4);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(most, 1);
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(culled, 2000u);
}

double residentMegabytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// FCL_ARTIC_VISIBILITY_CONTEXTS=1000 in the environment makes it a campaign.
TEST_P(Contexts, LeaveNothingBehind) {
  const std::uint64_t n = fromEnvironment("FCL_ARTIC_VISIBILITY_CONTEXTS", 60);
  const auto use = [&](std::uint64_t times) {
    for (std::uint64_t i = 0; i < times; ++i) ASSERT_EQ(countCulls(*make(GetParam()), drawingOf(16), 30, 0, 64), 0u);
  };
  use(20);  // what the driver keeps anyway
  const double before = residentMegabytes();
  use(n);
  const double grown = residentMegabytes() - before;
  std::cout << n << " contexts: " << grown << " MB more than " << before << "\n";
  EXPECT_LT(grown, 5 + 0.02 * static_cast<double>(n));
}

INSTANTIATE_TEST_SUITE_P(Executors, Contexts, testing::ValuesIn(kOpenGl), [](const auto& info) { return info.param; });

TEST(Culler, BothBackendsWorkHereFromAnyThread) {
  for (const auto backend : {OffscreenBackend::osmesa, OffscreenBackend::egl}) {
    const auto culler = makeOffscreenCuller(backend);
    EXPECT_EQ(culler->executor(), backend == OffscreenBackend::osmesa ? "osmesa" : "egl");
    EXPECT_EQ(culler->fallbackReason(), "");
    Drawing drawing = drawingOf(16);
    for (std::uint64_t i = 0; i < 100; ++i) {
      test::Adversary(3, i).draw(test::AdversaryKind::sweptHull, 0, drawing);
      std::vector<std::uint8_t> may;
      std::string by;
      std::thread([&] { by = visibility::drawBy(*culler, drawing, may); }).join();
      EXPECT_EQ(by, culler->executor());
      EXPECT_EQ(may, std::vector<std::uint8_t>(1, 1));
    }
  }
}
#endif

/// An executor that gives the same answer to everything; the self-test has to see it. Or one that fails later.
struct Broken : Executor {
  enum class How { careless, useless, failsLater };
  explicit Broken(How as) : how(as) {}
  void findThatMayOverlap(const Drawing& drawing, std::vector<std::uint8_t>& may) override {
    if (how == How::failsLater) {
      if (++runs > 1) throw std::runtime_error("lost");
      return cpu->draw(drawing, may);
    }
    may.assign(may.size(), how == How::useless);
  }
  How how;
  int runs = 0;  // the self-test is the first
  std::unique_ptr<Executor> cpu = visibility::makeCpuExecutor();
};

TEST(Culler, WhatIsMissingOrBrokenFallsBackWithAReason) {
  const VisibilityCuller missing({}, "egl",
                                 []() -> std::unique_ptr<Executor> { throw std::runtime_error("no such library"); }),
      careless({}, "egl", [] { return std::make_unique<Broken>(Broken::How::careless); }),
      useless({}, "egl", [] { return std::make_unique<Broken>(Broken::How::useless); }),
      failing({}, "egl", [] { return std::make_unique<Broken>(Broken::How::failsLater); });
  EXPECT_EQ(missing.fallbackReason(), "");
  for (const VisibilityCuller* one : {&missing, &careless, &useless}) EXPECT_EQ(one->executor(), "cpu");
  EXPECT_EQ(missing.fallbackReason(), "egl: no such library");
  EXPECT_EQ(careless.fallbackReason(), "egl: self-test: 512 of 512 touching pairs were culled");
  EXPECT_EQ(useless.fallbackReason(), "egl: self-test: it culls nothing");
  EXPECT_EQ(failing.executor(), "egl");
  Drawing drawing = drawingOf(16);
  test::Adversary(1, 1).draw(test::AdversaryKind::deep, 0, drawing);
  std::vector<std::uint8_t> may;
  EXPECT_EQ(visibility::drawBy(failing, drawing, may), "cpu");
  EXPECT_EQ(may, std::vector<std::uint8_t>(1, 1));
  EXPECT_EQ(failing.fallbackReason(), "egl: lost");
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
