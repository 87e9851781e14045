// SPDX-License-Identifier: BSD-3-Clause
// VisibilityMode::atOnce: queries that are solved once, with what the stage has proven left out. They are held against
// the campaign's sampled truth, which shares no code with the library, and against the answers without the stage.
#include "visibility/cpu_executor.h"
#include "with_and_without.h"
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
  return campaign::fromEnvironment("FCL_ARTIC_VISIBILITY_QUERIES", usual);
}

campaign::Campaign atOnce(fcl_artic::Method method, const Culler& culler) {
  campaign::Arms arms;
  arms.ways = {[method](fcl_artic::CertifiedRequest& request, campaign::Random&) {
    request.method = method;
    request.visibility = VisibilityMode::atOnce;
  }};
  arms.culler = culler;
  return campaignOf(arms);
}

campaign::Options options(std::uint64_t cases, std::uint64_t seed) {
  campaign::Options o;
  o.cases = cases;
  o.seed = seed;
  return o;
}

TEST(AtOnce, NothingMissedNothingLateNothingFalse) {
  for (const auto method : {fcl_artic::Method::standard, fcl_artic::Method::redon2004}) {
    const std::uint64_t n = queries(method == fcl_artic::Method::standard ? 1600 : 200);
    EXPECT_GE(runWithoutFaults(atOnce(method, nullptr), options(n, 21)).total.share("hits"), 0.3);
  }
}

#ifdef FCL_ARTIC_HAS_OFFSCREEN
TEST(AtOnce, NothingMissedWithOsmesaAndEgl) {
  for (const auto backend : {fcl_artic::OffscreenBackend::osmesa, fcl_artic::OffscreenBackend::egl}) {
    const auto culler = fcl_artic::makeOffscreenCuller(backend);
    runWithoutFaults(atOnce(fcl_artic::Method::standard, culler), options(queries(2000) / 8, 21));
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
  campaign::Options o = options(600, 22);
  o.threads = 1;  // one executor, the one that was made above
  o.folder.clear();
  const campaign::Tally all = run(atOnce(fcl_artic::Method::standard, culler), o).total;
  const std::uint64_t missed = all.faults("missed"), late = all.faults("late");
  std::cout << "a quarter of the groups culled wrongly: " << missed << " missed, " << late << " late of " << o.cases
            << "\n";
  EXPECT_GT(missed + late, 10u);
}

/// The same verdicts as without the stage, and brackets that hold the same time; less work than `on`, which solves
/// queries with contact twice.
TEST(AtOnce, AgreesWithOffAndSolvesOnce) {
  campaign::Arms arms;
  arms.number = fcl_artic::test::inTurn;
  arms.ways = {campaign::byVisibility(VisibilityMode::off), campaign::byVisibility(VisibilityMode::on),
               campaign::byVisibility(VisibilityMode::atOnce)};
  arms.judges = {[](const campaign::Asked& asked, campaign::Case& c) {
    const CertifiedResult &off = asked.result(0), &on = asked.result(1), &at_once = asked.result(2);
    const auto& s = at_once.statistics.visibility;
    if (s.repeated) c.fault("repeated", "solved twice");
    c.tally.count("culled", s.culled);
    c.tally.count("nodes", s.nodes);
    c.tally.count("less work",
                  on.statistics.visibility.repeated && on.statistics.node_tests > at_once.statistics.node_tests);
    if ((off.certain || off.status == Status::free) && at_once.status != off.status) c.fault("verdict", "another one");
    const bool contact = off.status == Status::contact && at_once.status == Status::contact;
    c.tally.count("contact", contact);
    c.tally.count("other bits", contact && (off.t_lower != at_once.t_lower || off.t_upper != at_once.t_upper));
    const double late = off.certain ? off.t_upper : 1, late_at_once = at_once.certain ? at_once.t_upper : 1;
    if (contact && (at_once.t_lower > late || off.t_lower > late_at_once))
      c.fault("late", "brackets hold no common time");
  }};
  campaign::Options o = options(queries(2000) / 4, 9);
  o.threads = 1;
  const campaign::Tally all = runWithoutFaults(campaignOf(arms), o).total;
  EXPECT_GT(all["contact"], o.cases / 4);
  EXPECT_GT(all["nodes"], o.cases / 20);
  EXPECT_GT(all["less work"], o.cases / 20);
}

}  // namespace

}  // namespace at_once_test
