// SPDX-License-Identifier: BSD-3-Clause
// Answers to one motion are claims: "free before t_lower", "in contact at some time up to t_upper". However a query is
// put (the paper's method with any switches, any mode, any budget, or the standard method), no claim may contradict
// another, nor a contact that dense sampling finds. More scenes: FCL_ARTIC_REDON_CLAIMS, other ones:
// FCL_ARTIC_REDON_SEED.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "engine.h"
#include "generator.h"
#include "oracle.h"

namespace claims_test {

namespace {

using fcl_artic::CertifiedRequest;
using fcl_artic::CertifiedResult;
using fcl_artic::ContactMode;
using fcl_artic::Method;
using fcl_artic::MotionEnclosure;
using fcl_artic::Status;

std::uint64_t numberFrom(const char* name, std::uint64_t usual) {
  const char* wanted = std::getenv(name);
  return wanted ? std::strtoull(wanted, nullptr, 10) : usual;
}

/// All that is random about how a scene is asked.
CertifiedRequest anyWay(const CertifiedRequest& base, campaign::Random& random) {
  CertifiedRequest request = base;
  request.method = random.chance(0.1) ? Method::standard : Method::redon2004;
  // (The standard method's modes are a campaign of their own.)
  request.mode = request.method == Method::standard ? ContactMode::first : static_cast<ContactMode>(random.below(3));
  request.max_contacts = random.chance(0.5) ? 1 : static_cast<std::size_t>(random.between(1, 50));
  // Some combinations have no end on long motions: a large budget ends them, and what they have proven counts.
  request.work_budget = static_cast<std::uint64_t>(random.chance(0.4) ? random.logUniform(1, 20000) : 40000);
  request.redon.enclosure = static_cast<MotionEnclosure>(random.below(3));
  request.redon.refinement_level = random.chance(0.6) ? -1 : random.between(2, 6);
  request.redon.simultaneous = random.chance(0.5);
  request.redon.newton = random.chance(0.5);
  request.redon.early_validity = random.chance(0.7);
  request.redon.in_time_order = random.chance(0.4);
  request.redon.links_in_world = random.chance(0.4);
  if (random.chance(0.15)) {  // stage 2, which a budget switches off
    request.visibility = fcl_artic::VisibilityMode::on;
    request.work_budget = 0;
    request.redon = fcl_artic::RedonOptions();
  }
  return request;
}

std::string describe(const CertifiedRequest& r, const CertifiedResult& a) {
  std::ostringstream out;
  out.precision(9);
  out << (r.method == Method::standard ? "standard" : "paper") << " mode " << static_cast<int>(r.mode) << " contacts "
      << r.max_contacts << " budget " << r.work_budget << " level " << r.redon.refinement_level << " together "
      << r.redon.simultaneous << " newton " << r.redon.newton << " early " << r.redon.early_validity << " ordered "
      << r.redon.in_time_order << " in world " << r.redon.links_in_world << " visibility "
      << static_cast<int>(r.visibility) << ": "
      << (a.status == Status::free      ? "free"
          : a.status == Status::contact ? "contact"
                                        : "undecided")
      << " [" << a.t_lower << ", " << a.t_upper << "] certain " << a.certain;
  return out.str();
}

struct Count {
  std::uint64_t scenes = 0, answers = 0, free = 0, contacts = 0, undecided = 0, hits = 0, with_both = 0, ignored = 0,
                margins = 0;
  std::vector<std::string> faults;
  void add(const Count& other) {
    scenes += other.scenes;
    answers += other.answers;
    free += other.free;
    contacts += other.contacts;
    undecided += other.undecided;
    hits += other.hits;
    with_both += other.with_both;
    ignored += other.ignored;
    margins += other.margins;
    faults.insert(faults.end(), other.faults.begin(), other.faults.end());
  }
};

/// A scene asked in many ways.
void askScene(std::uint64_t seed, Count& count) {
  static const std::vector<std::string> families = {"chain/between", "tree/between", "chain/random", "tree/random",
                                                    "chain/graze"};
  campaign::Random random(campaign::Random::mix(0xc1a135, seed));
  const std::string& family = families[seed % families.size()];
  campaign::Scene scene = campaign::makeScene(family, random.bits());
  scene.margin = 0;
  scene.every_pair = true;
  // What starts in contact is asked about too: one obstacle in five comes to where a link starts.
  const bool ignore = random.chance(0.4);
  const campaign::Kinematics kinematics(scene);
  if (ignore && random.chance(0.7)) {
    int link_body = -1, obstacle = -1;
    for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b)
      (scene.bodies[static_cast<std::size_t>(b)].link >= 0 ? link_body : obstacle) = b;
    if (link_body >= 0 && obstacle >= 0) {
      campaign::Body& o = scene.bodies[static_cast<std::size_t>(obstacle)];
      o.pose.p = kinematics.bodyPose(link_body, 0).p + 0.05 * random.direction();
    }
  }
  campaign::Question question = campaign::prepare(scene);
  // Margins of their own take pairs from the paper's method.
  if (random.chance(0.4)) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      if (scene.bodies[b].link < 0 && random.chance(0.4))
        question.manager->setMargin(scene.nameOf(static_cast<int>(b)),
                                    random.chance(0.3) ? 0 : random.uniform(0, 0.05));
    }
    question.manager->setup();
    ++count.margins;
  }
  question.request.ignore_initial_contact = ignore;
  const fcl_artic::JointMotion motion = campaign::motionOf(scene, *question.tree);

  // The claims of the standard method are the first ones.
  CertifiedRequest standard = question.request;
  standard.mode = ContactMode::first;
  double free_before = 0, contact_by = 2;
  std::string free_says, contact_says;
  const std::string name = family + " scene " + std::to_string(seed);
  const auto claim = [&](const CertifiedRequest& request) {
    CertifiedResult result;
    question.manager->continuousCollide(motion, request, result);
    ++count.answers;
    ++(result.status == Status::free      ? count.free
       : result.status == Status::contact ? count.contacts
                                          : count.undecided);
    count.ignored += !result.ignored_initial_contacts.empty();
    const std::string says = describe(request, result);
    const double before = result.status == Status::free ? 1 : result.t_lower;
    if (before > free_before) free_before = before, free_says = says;
    double by = result.status == Status::contact && (result.certain || result.t_upper < 1) ? result.t_upper : 2;
    for (const auto& contact : result.contacts) {
      if (contact.certain) by = std::min(by, contact.t_upper);
      if (result.status == Status::contact && contact.t_upper < result.t_lower) {
        count.faults.push_back(name + ": a contact before t_lower: " + says);
      }
    }
    if (by < contact_by) contact_by = by, contact_says = says;
    if (result.status == Status::free && by < 2) count.faults.push_back(name + ": free with a contact: " + says);
    if (result.contacts.size() > request.max_contacts && request.method == Method::redon2004) {
      count.faults.push_back(name + ": too many contacts: " + says);
    }
    if (result.status == Status::contact && result.contacts.empty()) {
      count.faults.push_back(name + ": contact of none: " + says);
    }
    return result;
  };
  claim(standard);
  bool both = false;
  for (int way = 0; way < 8; ++way) {
    const CertifiedRequest request = anyWay(question.request, random);
    const CertifiedResult result = claim(request);
    both = both || (result.statistics.redon.pairs_by_standard > 0 && result.statistics.redon.box_tests > 0);
  }
  ++count.scenes;
  count.with_both += both;
  // t_upper is a computed time: nothing else is rounded here.
  if (contact_by < free_before) {
    count.faults.push_back(name + ": one says\n  " + free_says + "\nanother\n  " + contact_says);
  }
  // The sampled contacts of pairs that are apart at t = 0, so that nobody ignores them.
  const campaign::Oracle oracle(scene);
  double sampled = 2;
  for (const campaign::PairTruth& p : oracle.judge(true).pairs) {
    if (!p.hit) continue;
    if (ignore) {
      const campaign::Proximity start = oracle.at(p.a, p.b, 0, 0.5);
      if (start.touching || start.gap < 0.06) continue;  // the largest margin, and a little
    }
    sampled = std::min(sampled, p.time);
  }
  if (sampled > 1) return;
  ++count.hits;
  if (free_before > sampled) {
    count.faults.push_back(name + ": sampled contact at " + std::to_string(sampled) + ", and\n  " + free_says);
  }
}

TEST(Claims, NoTwoAnswersContradictEachOtherOrASample) {
  const std::uint64_t scenes = numberFrom("FCL_ARTIC_REDON_CLAIMS", 60), seed = numberFrom("FCL_ARTIC_REDON_SEED", 1);
  Count all;
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t) {
    threads.emplace_back([&] {
      Count own;
      for (std::uint64_t i; (i = next++) < scenes;) askScene(seed * 1000003 + i, own);
      const std::lock_guard<std::mutex> lock(mutex);
      all.add(own);
    });
  }
  for (std::thread& t : threads) t.join();
  std::cout << all.scenes << " scenes, " << all.answers << " answers: " << all.free << " free, " << all.contacts
            << " contacts, " << all.undecided << " undecided; " << all.with_both
            << " scenes with pairs for both methods, " << all.margins << " with margins of bodies, " << all.ignored
            << " answers with ignored contacts, " << all.hits << " sampled contacts\n";
  for (std::size_t i = 0; i < all.faults.size() && i < 20; ++i) ADD_FAILURE() << all.faults[i];
  EXPECT_EQ(all.faults.size(), 0u);
  EXPECT_GE(all.free, all.answers / 10);
  EXPECT_GE(all.contacts, all.answers / 5);
  EXPECT_GE(all.undecided, all.answers / 50);
  EXPECT_GE(all.with_both, all.scenes / 4);
  EXPECT_GE(all.ignored, all.answers / 20);
  EXPECT_GE(all.hits, all.scenes / 5);
}

}  // namespace

}  // namespace claims_test
