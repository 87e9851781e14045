// SPDX-License-Identifier: BSD-3-Clause
// Every combination of the paper's ideas gives the same answers, also with modes, budgets, and pairs that are left to
// the standard method. More scenes: FCL_ARTIC_REDON_SWITCHES.
#include <algorithm>
#include <iostream>
#include <vector>

#include <gtest/gtest.h>

#include "engine.h"
#include "generator.h"
#include "harness.h"

namespace switches_test {

namespace {

using fcl_artic::CertifiedRequest;
using fcl_artic::CertifiedResult;
using fcl_artic::ContactMode;
using fcl_artic::MotionEnclosure;
using fcl_artic::Status;

/// Number of scenes of each family.
std::uint64_t scenes() {
  return campaign::fromEnvironment("FCL_ARTIC_REDON_SWITCHES", 3);
}

/// Each scene is asked with every so many-th combination: all scenes together with all.
constexpr std::size_t kStride = 3;

std::vector<fcl_artic::RedonOptions> allSwitches() {
  std::vector<fcl_artic::RedonOptions> all;
  for (const auto enclosure : {MotionEnclosure::intervalChain, MotionEnclosure::meanValue, MotionEnclosure::taylor}) {
    for (const int level : {-1, 0, 3}) {
      for (int bits = 0; bits < 32; ++bits) {
        fcl_artic::RedonOptions options;
        options.enclosure = enclosure;
        options.refinement_level = level;
        options.simultaneous = bits & 1;
        options.newton = bits & 2;
        options.early_validity = bits & 4;
        options.in_time_order = bits & 8;
        options.links_in_world = bits & 16;
        all.push_back(options);
      }
    }
  }
  return all;
}

TEST(Switches, AllCombinationsAgreeInAllModesAndWithinBudgets) {
  const std::vector<fcl_artic::RedonOptions> switches = allSwitches();
  int contacts = 0, free = 0, undecided = 0, answers = 0, mixed = 0;
  for (const char* family :
       {"mesh_mesh/between", "mesh_mesh/graze", "chain/between", "tree/random", "tree/between", "chain/random"}) {
    for (std::uint64_t seed = 1; seed <= scenes(); ++seed) {
      campaign::Scene scene = campaign::makeScene(family, seed);
      for (std::size_t v = 0; v < scene.q1.size(); ++v) scene.q1[v] = scene.q0[v] + 0.15 * (scene.q1[v] - scene.q0[v]);
      scene.margin = 0;
      scene.every_pair = false;
      const campaign::Question question = campaign::prepare(scene);
      const auto ask = [&](const CertifiedRequest& request) { return campaign::ask(question, request).result; };
      const CertifiedResult standard = ask(question.request);
      const double first = standard.isFree() ? 1 : standard.t_upper;
      ++(standard.status == Status::contact ? contacts : free);
      for (std::size_t i = seed % kStride; i < switches.size(); i += kStride) {
        const std::string name =
            std::string(family) + " seed " + std::to_string(seed) + " switches " + std::to_string(i);
        CertifiedRequest request = question.request;
        request.method = fcl_artic::Method::redon2004;
        request.redon = switches[i];
        request.max_contacts = 10;
        request.mode = static_cast<ContactMode>(i % 3);
        // A motion that has no end without levels (0) ends by the larger budget.
        for (const std::uint64_t budget : {std::uint64_t{200000}, std::uint64_t{1} << (seed + i) % 14}) {
          request.work_budget = budget;
          const CertifiedResult result = ask(request);
          ++answers;
          mixed += result.statistics.redon.pairs_by_standard > 0 && result.statistics.redon.box_tests > 0;
          if (result.status == Status::undecided) {
            ++undecided;
            ASSERT_LE(result.t_lower, first) << name << " budget " << budget;
          } else {
            ASSERT_EQ(result.status, standard.status) << name << " budget " << budget;
            ASSERT_LE(std::abs(result.t_lower - standard.t_lower), scene.tolerance_time * 2) << name;
          }
        }
      }
    }
  }
  std::cout << answers << " answers, " << contacts << " scenes with contact, " << free << " free; " << mixed
            << " answers by both methods, " << undecided << " undecided within a budget\n";
  EXPECT_GE(contacts, 3);
  EXPECT_GE(free, 3);
  EXPECT_GE(mixed, answers / 20);
  EXPECT_GE(undecided, answers / 10);
  EXPECT_LE(undecided, answers / 2);
}

}  // namespace

}  // namespace switches_test
