// SPDX-License-Identifier: BSD-3-Clause
// The paper's method against the library's own and against dense sampling. More queries: FCL_ARTIC_REDON_QUERIES.
#include <algorithm>
#include <cmath>
#include <map>

#include "arms.h"
#include "expect.h"
#include "fcl_artic/continuous_collision.h"
#include "generator.h"
#include "pair_campaign.h"

namespace agreement_test {

namespace {

using campaign::Asked;
using campaign::Case;
using campaign::CaseId;
using fcl_artic::Method;
using fcl_artic::Status;

/// Two answers to one query: the same verdict and time, or a graze that one of them can't tell from contact, which is
/// then a contact that is not certain.
template <class Result>
void compare(const Result& own, const Result& other, double tolerance_time, Case& c) {
  const bool same = own.status == other.status, contact = own.status == Status::contact;
  const bool certain = own.certain && other.certain;
  c.tally.count("both contact", same && contact);
  c.tally.count("both free", same && !contact);
  c.tally.count("in doubt", !same || (contact && !certain));
  c.tally.count("by standard", other.statistics.redon.pairs_by_standard > 0);  // some pair or all
  if (!same && (contact ? own : other).certain) c.fault("verdict", "proven contact by one method, free by the other");
  if (same && certain && std::abs(own.t_lower - other.t_lower) > 2 * tolerance_time + 1e-12)
    c.fault("time", campaign::format("t_lower %.17g and %.17g", own.t_lower, other.t_lower));
}

void expectAgreement(const campaign::Campaign& campaign) {
  campaign::Options o;
  o.cases = campaign::fromEnvironment("FCL_ARTIC_REDON_QUERIES", 120);
  const campaign::Tally all = runWithoutFaults(campaign, o).total;
  EXPECT_LE(all["in doubt"], 1 + o.cases / 50);
  EXPECT_GE(all["both contact"], o.cases / 5);
  EXPECT_GE(all["both free"], o.cases / 5);
  EXPECT_GE(all["hits"], o.cases / 5);
}

TEST(Redon2004, ArmsAgreeWithTheStandardMethodAndWithSampling) {
  std::vector<std::string> families;  // those with a mesh
  for (const std::string& f : campaign::families()) {
    if (f.compare(0, 5, "shape") != 0) families.push_back(f);
  }
  campaign::Arms arms;
  arms.number = [&](std::uint64_t, std::uint64_t i) { return CaseId{families[i % families.size()], 1000 + i}; };
  arms.draw = campaign::drawAnd([](campaign::Scene& scene) { scene.margin = 0; });
  arms.ways = {campaign::asTheSceneSays, campaign::byMethod(Method::redon2004)};
  arms.judges = {campaign::againstSamples(1), [](const Asked& asked, Case& c) {
                   compare(asked.result(0), asked.result(1), asked.scene.tolerance_time, c);
                 }};
  expectAgreement(campaignOf(arms));
}

TEST(Redon2004, FreeBodiesAgreeWithTheStandardMethodAndWithSampling) {
  std::vector<pair_campaign::Family> families;
  for (const pair_campaign::Family& f : pair_campaign::families()) {
    if (f.bodies == pairs::Bodies::meshes && f.motion != "bounded") families.push_back(f);
  }
  ASSERT_FALSE(families.empty());
  campaign::Campaign free_bodies;
  free_bodies.number = [&](std::uint64_t, std::uint64_t i) {
    return CaseId{families[i % families.size()].name, 5000 + i};
  };
  free_bodies.look = [&](Case& c) {
    const pairs::PairQuery query = pair_campaign::makeQuery(pair_campaign::familyOf(c.id.family), c.id.seed);
    const auto motion1 = query.path1->motion(), motion2 = query.path2->motion();
    c.queryWithoutFile(campaign::kTwoBodies);
    const auto ask = [&](Method method) {
      fcl_artic::CertifiedRequest request;
      request.method = method;
      fcl_artic::CertifiedPairResult result;
      fcl_artic::continuousCollide(query.body1->geometry.get(), motion1.get(), query.body2->geometry.get(),
                                   motion2.get(), request, result);
      return result;
    };
    const fcl_artic::CertifiedPairResult other = ask(Method::redon2004);
    compare(ask(Method::standard), other, fcl_artic::CertifiedRequest().tolerance_time, c);
    const pairs::Truth truth = pairs::Judge(query).firstContact();
    c.tally.count("hits", truth.hit);
    if (truth.hit && other.status == Status::free) c.fault("missed", "");
    if (truth.hit && other.t_lower > truth.time) c.fault("late", "");
  };
  expectAgreement(free_bodies);
}

/// First contact of every pair: what one pair leaves behind must not reach the next.
TEST(Redon2004, EveryPairHasItsOwnFirstContact) {
  constexpr std::uint64_t kEach = 13;
  campaign::Arms arms;
  arms.number = [](std::uint64_t, std::uint64_t index) {
    static constexpr const char* kFamilies[] = {"chain/between", "chain/graze", "tree/between"};
    const std::uint64_t i = index % kEach;
    return CaseId{kFamilies[index / kEach], i ? i : 2309718913283115216};  // found what an earlier pair's boxes did
  };
  arms.draw = campaign::drawAnd([](campaign::Scene& scene) { scene.every_pair = true, scene.margin = 0; });
  arms.ways = {campaign::asTheSceneSays, campaign::byMethod(Method::redon2004)};
  arms.judges = {[](const Asked& asked, Case& c) {
    const auto timesOf = [](const campaign::Answer& answer) {
      std::map<std::pair<int, int>, double> times;
      for (const auto& contact : answer.result.contacts) {
        const std::pair<int, int> pair =
            std::minmax({answer.bodyOf(contact.body1.object), answer.bodyOf(contact.body2.object)});
        const auto known = times.emplace(pair, contact.t_lower).first;
        known->second = std::min(known->second, contact.t_lower);
      }
      return times;
    };
    const auto own = timesOf(asked.answers[0]), other = timesOf(asked.answers[1]);
    if (own.size() != other.size()) c.fault("pairs", "another number of them");
    c.tally.count("of several", own.size() > 1);
    c.tally.count("pairs", own.size());
    for (const auto& [pair, t] : own) {
      const auto found = other.find(pair);
      if (found == other.end() || std::abs(found->second - t) > 2 * asked.scene.tolerance_time)
        c.fault("pairs", campaign::format("bodies %d, %d at %.17g", pair.first, pair.second, t));
    }
  }};
  campaign::Options o;
  o.cases = 3 * kEach;
  const campaign::Tally all = runWithoutFaults(campaignOf(arms), o).total;
  EXPECT_GE(all["pairs"], 40u);
  EXPECT_GE(all["of several"], 8u);
}

}  // namespace

}  // namespace agreement_test
