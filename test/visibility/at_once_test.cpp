// SPDX-License-Identifier: BSD-3-Clause
// VisibilityMode::atOnce: queries that are solved once, with what the stage has proven left out. They are held against
// the campaign's sampled truth, which shares no code with the library, and against the answers without the stage.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "generator.h"
#include "run.h"
#include "visibility/cpu_executor.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

namespace at_once_test {

namespace {

using fcl_artic::CertifiedResult;
using fcl_artic::Status;
using fcl_artic::VisibilityMode;
using Culler = std::shared_ptr<const fcl_artic::VisibilityCuller>;

/// FCL_ARTIC_VISIBILITY_QUERIES=20000 in the environment makes it a campaign.
std::uint64_t queries(std::uint64_t usual) {
  const char* wanted = std::getenv("FCL_ARTIC_VISIBILITY_QUERIES");
  return wanted ? std::strtoull(wanted, nullptr, 10) : usual;
}

campaign::Report examine(std::uint64_t n, fcl_artic::Method method, const Culler& culler) {
  campaign::Options o;
  o.queries = n;
  o.seed = 21;
  o.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  o.how.method = method;
  o.how.visibility = VisibilityMode::atOnce;
  o.culler = culler;
  campaign::Report report = campaign::run(o);
  std::cout << report.total.queries << " queries, " << report.total.answers_contact << " with contact, "
            << report.total.faulty() << " faulty\n";
  return report;
}

TEST(AtOnce, NothingMissedNothingLateNothingFalse) {
  for (const auto method : {fcl_artic::Method::standard, fcl_artic::Method::redon2004}) {
    const campaign::Report report =
        examine(queries(method == fcl_artic::Method::standard ? 1600 : 200), method, nullptr);
    for (int f = 0; f < campaign::kFaults; ++f) {
      EXPECT_EQ(report.total.faults[static_cast<std::size_t>(f)], 0u)
          << campaign::faultName(static_cast<campaign::Fault>(f));
    }
    EXPECT_GE(report.total.hitShare(), 0.3);
  }
}

#ifdef FCL_ARTIC_HAS_OFFSCREEN
TEST(AtOnce, NothingMissedWithOsmesaAndEgl) {
  for (const auto backend : {fcl_artic::OffscreenBackend::osmesa, fcl_artic::OffscreenBackend::egl}) {
    const auto culler = fcl_artic::makeOffscreenCuller(backend);
    const campaign::Report report = examine(queries(2000) / 8, fcl_artic::Method::standard, culler);
    EXPECT_EQ(report.total.faulty(), 0u);
    EXPECT_EQ(culler->fallbackReason(), "");
  }
}
#endif

/// The executor cpu, but that it takes some of what may overlap for free.
struct Careless : fcl_artic::visibility::Executor {
  explicit Careless(const bool& honest) : honest_(honest) {}
  void run(const fcl_artic::visibility::Batch& batch, std::vector<std::uint8_t>& may) override {
    cpu_.run(batch, may);
    for (std::size_t i = 0; i < may.size() && !honest_; ++i) {
      if (batch.objects[i].group % 4 == 1) may[i] = 0;
    }
  }
  const bool& honest_;
  fcl_artic::visibility::CpuExecutor cpu_;
};

/// Nothing else checks the stage's answers here: what it culls wrongly is missed, and this test sees that.
TEST(AtOnce, WrongCullsAreSeen) {
  bool honest = true;  // while it is tested by its culler
  const auto culler = std::make_shared<fcl_artic::VisibilityCuller>(
      fcl_artic::VisibilityOptions(), "careless", [&honest] { return std::make_unique<Careless>(honest); });
  ASSERT_EQ(culler->executor(), "careless");
  honest = false;
  campaign::Options o;
  o.queries = 600;
  o.seed = 22;
  o.threads = 1;  // one executor, the one that was made above
  o.how.visibility = VisibilityMode::atOnce;
  o.culler = culler;
  const campaign::Report report = campaign::run(o);
  const std::uint64_t missed = report.total.faults[static_cast<std::size_t>(campaign::Fault::missed)],
                      late = report.total.faults[static_cast<std::size_t>(campaign::Fault::late)];
  std::cout << "a quarter of the groups culled wrongly: " << missed << " missed, " << late << " late of "
            << report.total.queries << "\n";
  EXPECT_GT(missed + late, 10u);
}

/// The same verdicts as without the stage, and brackets that hold the same time; less work than `on`, which solves
/// queries with contact twice.
TEST(AtOnce, AgreesWithOffAndSolvesOnce) {
  std::uint64_t contacts = 0, other_bits = 0, culled = 0, nodes = 0, more = 0;
  const std::uint64_t n = queries(2000) / 4;
  for (std::uint64_t i = 0; i < n; ++i) {
    const std::uint64_t seed = 1000003 * 9 + i;
    const campaign::Scene scene = campaign::makeScene(campaign::familyOf(9, i), seed);
    campaign::Question question = campaign::prepare(scene);
    const fcl_artic::JointMotion motion = campaign::motionOf(scene, *question.tree);
    CertifiedResult off, at_once, on;
    question.manager->continuousCollide(motion, question.request, off);
    question.request.visibility = VisibilityMode::on;
    question.manager->continuousCollide(motion, question.request, on);
    question.request.visibility = VisibilityMode::atOnce;
    question.manager->continuousCollide(motion, question.request, at_once);
    const auto& s = at_once.statistics.visibility;
    EXPECT_EQ(s.repeated, 0u);
    culled += s.culled;
    nodes += s.nodes;
    more += on.statistics.visibility.repeated && on.statistics.node_tests > at_once.statistics.node_tests;
    if (off.certain || off.status == Status::free) {
      ASSERT_EQ(at_once.status, off.status) << seed;
    }
    if (off.status != Status::contact || at_once.status != Status::contact) continue;
    ++contacts;
    const double late = off.certain ? off.t_upper : 1, late_at_once = at_once.certain ? at_once.t_upper : 1;
    ASSERT_LE(at_once.t_lower, late) << seed;
    ASSERT_LE(off.t_lower, late_at_once) << seed;
    other_bits += off.t_lower != at_once.t_lower || off.t_upper != at_once.t_upper;
  }
  std::cout << n << " queries, " << contacts << " contacts, of which " << other_bits << " have other bits; " << culled
            << " pairs and " << nodes << " nodes culled; less work than `on` in " << more << "\n";
  EXPECT_GT(contacts, n / 4);
  EXPECT_GT(nodes, n / 20);
  EXPECT_GT(more, n / 20);
}

}  // namespace

}  // namespace at_once_test
