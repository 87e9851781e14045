// SPDX-License-Identifier: BSD-3-Clause
// Every combination of the paper's ideas gives the same answers.
#include <vector>

#include <gtest/gtest.h>

#include "engine.h"
#include "generator.h"

namespace {

using fcl_artic::CertifiedRequest;
using fcl_artic::MotionEnclosure;
using fcl_artic::Status;

std::vector<CertifiedRequest> allSwitches() {
  std::vector<CertifiedRequest> all;
  for (const auto enclosure : {MotionEnclosure::intervalChain, MotionEnclosure::meanValue, MotionEnclosure::taylor}) {
    for (const int level : {-1, 0, 3}) {
      for (const bool simultaneous : {true, false}) {
        for (const bool newton : {true, false}) {
          for (const bool in_time_order : {true, false}) {
            CertifiedRequest request;
            request.method = fcl_artic::Method::redon2004;
            request.redon.enclosure = enclosure;
            request.redon.refinement_level = level;
            request.redon.simultaneous = simultaneous;
            request.redon.newton = newton;
            request.redon.in_time_order = in_time_order;
            all.push_back(request);
          }
        }
      }
    }
  }
  return all;
}

TEST(Switches, AllCombinationsAgree) {
  const std::vector<CertifiedRequest> switches = allSwitches();
  int contacts = 0, free = 0;
  for (const char* family : {"mesh_mesh/between", "mesh_mesh/graze", "chain/between", "tree/random"}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      campaign::Scene scene = campaign::makeScene(family, seed);
      for (std::size_t v = 0; v < scene.q1.size(); ++v) scene.q1[v] = scene.q0[v] + 0.15 * (scene.q1[v] - scene.q0[v]);
      scene.margin = 0;
      scene.every_pair = false;
      const campaign::Answer standard = campaign::ask(scene);
      ++(standard.result.status == Status::contact ? contacts : free);
      for (std::size_t i = 0; i < switches.size(); ++i) {
        const campaign::Answer answer = campaign::ask(scene, switches[i]);
        ASSERT_EQ(answer.result.status, standard.result.status) << family << " seed " << seed << " switches " << i;
        ASSERT_LE(std::abs(answer.result.t_lower - standard.result.t_lower), scene.tolerance_time * 2)
            << family << " seed " << seed << " switches " << i;
      }
    }
  }
  EXPECT_GE(contacts, 3);
  EXPECT_GE(free, 3);
}

}  // namespace
