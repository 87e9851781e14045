// SPDX-License-Identifier: BSD-3-Clause
// The paper's method against the library's own and against dense sampling. More queries: FCL_ARTIC_REDON_QUERIES.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "fcl_artic/continuous_collision.h"
#include "generator.h"
#include "pair_campaign.h"
#include "run.h"

namespace agreement_test {

namespace {

using fcl_artic::CertifiedRequest;
using fcl_artic::Status;

std::uint64_t queries() {
  const char* wanted = std::getenv("FCL_ARTIC_REDON_QUERIES");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 120;
}

CertifiedRequest paper() {
  CertifiedRequest request;
  request.method = fcl_artic::Method::redon2004;
  return request;
}

/// What two methods say to many queries.
struct Count {
  std::uint64_t contacts = 0, free = 0, doubtful = 0, by_standard = 0, hits = 0;
  std::vector<std::string> faults;
};

/// Two answers to one query: the same verdict and time, or a graze that one of them can't tell from contact, which is
/// then a contact that is not certain.
template <class Result>
void compare(const Result& own, const Result& other, double tolerance_time, const std::string& name, Count& count) {
  count.by_standard += other.statistics.redon.pairs_by_standard > 0;
  if (own.status != other.status) {
    if ((own.status == Status::contact ? own : other).certain) count.faults.push_back(name + ": another verdict");
    ++count.doubtful;
    return;
  }
  ++(own.status == Status::contact ? count.contacts : count.free);
  const bool certain = own.certain && other.certain;
  if (!certain && own.status == Status::contact) ++count.doubtful;
  if (certain && std::abs(own.t_lower - other.t_lower) > 2 * tolerance_time + 1e-12) {
    count.faults.push_back(name + ": t_lower " + std::to_string(own.t_lower) + " and " + std::to_string(other.t_lower));
  }
}

Count overThreads(const std::function<void(std::uint64_t, Count&)>& query) {
  Count all;
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t) {
    threads.emplace_back([&] {
      Count own;
      for (std::uint64_t i; (i = next++) < queries();) query(i, own);
      const std::lock_guard<std::mutex> lock(mutex);
      all.contacts += own.contacts;
      all.free += own.free;
      all.doubtful += own.doubtful;
      all.by_standard += own.by_standard;
      all.hits += own.hits;
      all.faults.insert(all.faults.end(), own.faults.begin(), own.faults.end());
    });
  }
  for (std::thread& t : threads) t.join();
  return all;
}

void expectAgreement(const Count& count) {
  std::cout << queries() << " queries: " << count.contacts << " contacts, " << count.free << " free, " << count.doubtful
            << " not certain in one method or told apart by one only; " << count.hits
            << " sampled contacts, none missed; in " << count.by_standard
            << " some pairs or all were left to the standard method\n";
  for (std::size_t i = 0; i < count.faults.size() && i < 20; ++i) ADD_FAILURE() << count.faults[i];
  EXPECT_EQ(count.faults.size(), 0u);
  EXPECT_LE(count.doubtful, 1 + queries() / 50);
  EXPECT_GE(count.contacts, queries() / 5);
  EXPECT_GE(count.free, queries() / 5);
  EXPECT_GE(count.hits, queries() / 5);
}

TEST(Redon2004, ArmsAgreeWithTheStandardMethodAndWithSampling) {
  std::vector<std::string> families;  // those with a mesh
  for (const std::string& f : campaign::families()) {
    if (f.compare(0, 5, "shape") != 0) families.push_back(f);
  }
  expectAgreement(overThreads([&](std::uint64_t i, Count& count) {
    const std::string& family = families[i % families.size()];
    const std::uint64_t seed = 1000 + i;
    campaign::Scene scene = campaign::makeScene(family, seed);
    scene.margin = 0;
    const std::string name = family + " seed " + std::to_string(seed);
    const campaign::Answer own = campaign::ask(scene), other = campaign::ask(scene, paper());
    compare(own.result, other.result, scene.tolerance_time, name, count);
    const campaign::Oracle oracle(scene);
    const campaign::Truth truth = oracle.judge(scene.every_pair);
    count.hits += truth.hit;
    for (const campaign::Finding& f : campaign::examine(scene, oracle, truth, other)) {
      count.faults.push_back(name + ": " + campaign::faultName(f.fault) + " " + f.text);
    }
  }));
}

TEST(Redon2004, FreeBodiesAgreeWithTheStandardMethodAndWithSampling) {
  std::vector<pair_campaign::Family> families;
  for (const pair_campaign::Family& f : pair_campaign::families()) {
    if (f.bodies == pairs::Bodies::meshes && f.motion != "bounded") families.push_back(f);
  }
  ASSERT_FALSE(families.empty());
  expectAgreement(overThreads([&](std::uint64_t i, Count& count) {
    const pair_campaign::Family& family = families[i % families.size()];
    const std::uint64_t seed = 5000 + i;
    const pairs::PairQuery query = pair_campaign::makeQuery(family, seed);
    const std::string name = family.name + " seed " + std::to_string(seed);
    const auto motion1 = query.path1->motion(), motion2 = query.path2->motion();
    const auto ask = [&](const CertifiedRequest& request) {
      fcl_artic::CertifiedPairResult result;
      fcl_artic::continuousCollide(query.body1->geometry.get(), motion1.get(), query.body2->geometry.get(),
                                   motion2.get(), request, result);
      return result;
    };
    const fcl_artic::CertifiedPairResult own = ask({}), other = ask(paper());
    compare(own, other, CertifiedRequest().tolerance_time, name, count);
    const pairs::Truth truth = pairs::Judge(query).firstContact();
    count.hits += truth.hit;
    if (truth.hit && other.status == Status::free) count.faults.push_back(name + ": missed");
    if (truth.hit && other.t_lower > truth.time) count.faults.push_back(name + ": late");
  }));
}

/// First contact of every pair: what one pair leaves behind must not reach the next.
TEST(Redon2004, EveryPairHasItsOwnFirstContact) {
  fcl_artic::CertifiedRequest paper;
  paper.method = fcl_artic::Method::redon2004;
  const auto timesOf = [](const campaign::Answer& answer) {
    std::map<std::pair<int, int>, double> times;
    for (const auto& c : answer.result.contacts) {
      const std::pair<int, int> pair = std::minmax({answer.bodyOf(c.body1.object), answer.bodyOf(c.body2.object)});
      const auto known = times.emplace(pair, c.t_lower).first;
      known->second = std::min(known->second, c.t_lower);
    }
    return times;
  };
  int pairs = 0, scenes = 0;
  for (const char* family : {"chain/between", "chain/graze", "tree/between"}) {
    for (std::uint64_t i = 0; i <= 12; ++i) {
      const std::uint64_t seed = i ? i : 2309718913283115216;  // found what an earlier pair's boxes did
      campaign::Scene scene = campaign::makeScene(family, seed);
      scene.every_pair = true;
      scene.margin = 0;
      const auto own = timesOf(campaign::ask(scene)), other = timesOf(campaign::ask(scene, paper));
      ASSERT_EQ(own.size(), other.size()) << family << " seed " << seed;
      scenes += own.size() > 1;
      for (const auto& [pair, t] : own) {
        ++pairs;
        ASSERT_TRUE(other.count(pair)) << family << " seed " << seed;
        EXPECT_NEAR(other.at(pair), t, 2 * scene.tolerance_time)
            << family << " seed " << seed << " bodies " << pair.first << ", " << pair.second;
      }
    }
  }
  EXPECT_GE(pairs, 40);
  EXPECT_GE(scenes, 8);
}

}  // namespace

}  // namespace agreement_test
