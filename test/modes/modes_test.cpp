// SPDX-License-Identifier: BSD-3-Clause
//
// All modes against each other (rules.h). FCL_ARTIC_MODES_CASES asks for so many worlds, a dozen queries each, from
// seed FCL_ARTIC_MODES_SEED on. `campaign --of modes --replay <seed>` brings the world of a finding back.
#include <type_traits>

#include "expect.h"
#include "rules.h"

namespace modes_test {

namespace {

TEST(Modes, AgreeInAllCombinationsOfOptions) {
  constexpr std::uint64_t kCases = 600;
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_MODES", kCases, 16);
  const campaign::Tally all = runWithoutFaults(modes::campaignOfModes(), o).total;
  if (o.cases < kCases) return;
  for (const std::string& rule : modes::rules())
    EXPECT_GT(all[rule + " told"], o.cases / 100) << rule << " is hardly ever telling";
}

/// All that an answer says, and the work that it took.
std::string bitsOf(const fcl_artic::CertifiedResult& r, bool work) {
  std::string bits;
  const auto add = [&](const auto& value) { bits.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const auto number = [&](double value) { add(value); };
  const auto bracket = [&](const auto& b) {
    number(b.t_lower);
    number(b.t_upper);
    bits += b.certain ? 'c' : '-';
  };
  bits += std::to_string(static_cast<int>(r.status));
  bracket(r);
  for (const fcl_artic::CertifiedContact& c : r.contacts) {
    bits += c.body1.name + " " + c.body2.name;
    bracket(c);
    for (int i = 0; i < 3; ++i) number(c.point[i]), number(c.normal[i]);
    bits += std::to_string(c.q_witness.size());
  }
  for (const auto& pair : r.ignored_initial_contacts) bits += pair.first.name + " " + pair.second.name;
  add(r.statistics.pairs);
  const auto addAll = [&](const auto& statistics) {
    std::decay_t<decltype(statistics)>::forEachField([&](const char*, auto field) {
      if constexpr (std::is_same_v<std::decay_t<decltype(statistics.*field)>, std::uint64_t>) add(statistics.*field);
    });
  };
  if (work) addAll(static_cast<const fcl_artic::StandardStatistics&>(r.statistics));
  if (work) addAll(r.statistics.redon);
  return bits;
}

/// Tolerances that are gone, or 0, are none: the same bits, in all modes and by both methods.
TEST(Modes, NoTolerancesAreNone) {
  using namespace fcl_artic;
  int queries = 0, contacts = 0, other = 0, by_paper = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    modes::Random random(seed), again(seed), once_more(seed);
    modes::World never(random), reset(again), zero(once_more);
    if (never.isPair()) continue;
    std::vector<modes::Asked> asked = modes::randomQueries(random, 6);
    const auto setAll = [&](modes::World& world, double size) {
      const PoseTolerance pose{size, size, Eigen::Vector3d::Zero()};
      ArticulatedCollisionManager& manager = *world.manager();
      manager.setJointTolerances({size, size});
      for (JointId j = 0; j < manager.tree().numJoints(); ++j) {
        const Joint& joint = manager.tree().joint(j);
        const bool slides = joint.type == JointType::prismatic;
        if (joint.mimics || joint.type == JointType::fixed) continue;
        manager.setJointTolerance(joint.name, {slides ? 0 : 2 * size, slides ? 2 * size : 0});
      }
      manager.setBaseTolerance(pose);
      for (const modes::Body& body : world.bodies()) {
        if (body.kind != modes::Body::Kind::link) manager.setObjectTolerance(body.name, pose);
      }
      manager.setup();
    };
    setAll(reset, 0.02);
    setAll(zero, 0);
    CertifiedResult a, b, c;
    for (modes::Asked& one : asked) {
      if (one.request.method == Method::redon2004) continue;
      never.ask(one.request, a);
      reset.ask(one.request, b);
      other += bitsOf(a, false) != bitsOf(b, false);
    }
    reset.manager()->resetTolerances();
    reset.manager()->setup();
    for (modes::Asked& one : asked) {
      const bool work = one.request.visibility == VisibilityMode::off;  // whose work goes by the clock
      never.ask(one.request, a);
      reset.ask(one.request, b);
      zero.ask(one.request, c);
      EXPECT_EQ(bitsOf(a, work), bitsOf(b, work)) << seed;
      EXPECT_EQ(bitsOf(a, work), bitsOf(c, work)) << seed;
      ++queries;
      contacts += a.status == Status::contact;
      by_paper += one.request.method == Method::redon2004;
    }
    // Where only the base strays, nothing is left of what joints did.
    for (modes::World* world : {&never, &reset}) {
      world->manager()->setBaseTolerance({0.005, 0.005, Eigen::Vector3d::Zero()});
      world->manager()->setup();
    }
    for (modes::Asked& one : asked) {
      if (one.request.method == Method::redon2004) continue;
      never.ask(one.request, a);
      reset.ask(one.request, b);
      EXPECT_EQ(bitsOf(a, false), bitsOf(b, false)) << seed;
    }
  }
  EXPECT_GT(queries, 400);
  EXPECT_GT(contacts, queries / 10);
  EXPECT_GT(by_paper, queries / 10);
  EXPECT_GT(other, queries / 10) << "tolerances change answers";
}

/// Worlds that have found faults: a certain contact of the mode `any` that was not among the contacts, as a pair
/// beside it was still open.
TEST(Modes, WorldsThatFoundFaults) {
  campaign::Options o;
  o.cases = 1;
  for (const std::uint64_t seed : {5047764u}) {
    o.seed = seed;
    runWithoutFaults(modes::campaignOfModes(), o);
  }
}

/// Bodies that slide along each other, of which the paper's method bounds equations for a minute on end.
TEST(Modes, ThePapersMethodEndsWithoutABudget) {
  constexpr std::uint64_t kMaxWork = 1 << 17, kOneStep = 1 << 16;  // redon/redon.cpp; what is begun is ended
  const auto ask = [](std::uint64_t seed, const fcl_artic::CertifiedRequest& request,
                      fcl_artic::CertifiedResult& result) {
    modes::Random random(seed);
    if (random.chance(0.3)) random.snap(0.05);
    modes::World(random).ask(request, result);
  };
  fcl_artic::CertifiedRequest first, every;
  first.redon.refinement_level = every.redon.refinement_level = 2;
  first.redon.simultaneous = first.redon.newton = first.redon.in_time_order = first.redon.early_validity = false;
  every.mode = fcl_artic::ContactMode::firstOfEveryPair;
  every.max_contacts = 100;
  every.redon.enclosure = fcl_artic::MotionEnclosure::intervalChain;
  every.redon.in_time_order = every.redon.early_validity = false;
  for (auto& [seed, request] : {std::pair(20u, first), std::pair(62u, every)}) {
    fcl_artic::CertifiedResult standard, result, in_budget;
    ask(seed, request, standard);
    fcl_artic::CertifiedRequest paper = request;
    paper.method = fcl_artic::Method::redon2004;
    ask(seed, paper, result);
    const fcl_artic::RedonStatistics& s = result.statistics.redon;
    const std::uint64_t work = s.box_tests + s.leaf_pairs + s.equations + s.evaluations;
    EXPECT_GT(work, kMaxWork) << seed;
    EXPECT_LT(work, kMaxWork + kOneStep) << seed;
    EXPECT_GT(s.pairs_by_standard, 0u);
    EXPECT_EQ(result.status, standard.status);
    EXPECT_EQ(result.t_lower, standard.t_lower);
    EXPECT_EQ(result.t_upper, standard.t_upper);
    EXPECT_EQ(result.contacts.size(), standard.contacts.size());
    // A budget is the caller's: then nobody else is asked.
    paper.work_budget = 1000;
    ask(seed, paper, in_budget);
    EXPECT_EQ(in_budget.status, fcl_artic::Status::undecided) << seed;
  }
}

}  // namespace

}  // namespace modes_test
