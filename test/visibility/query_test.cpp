// SPDX-License-Identifier: BSD-3-Clause
// Whole queries with the stage off and on: the same answers, bit for bit, over the campaign's scenes.
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include "engine.h"
#include "generator.h"

namespace {

using fcl_artic::CertifiedContact;
using fcl_artic::CertifiedResult;
using fcl_artic::VisibilityMode;

/// FCL_ARTIC_VISIBILITY_QUERIES=20000 in the environment makes it a campaign.
std::uint64_t queries() {
  const char* wanted = std::getenv("FCL_ARTIC_VISIBILITY_QUERIES");
  return wanted ? std::strtoull(wanted, nullptr, 10) : 600;
}

bool sameContact(const CertifiedContact& a, const CertifiedContact& b) {
  return a.body1.name == b.body1.name && a.body2.name == b.body2.name && a.b1 == b.b1 && a.b2 == b.b2 &&
         a.feature == b.feature && a.point == b.point && a.normal == b.normal && a.t_lower == b.t_lower &&
         a.t_upper == b.t_upper && a.certain == b.certain;
}

bool sameAnswer(const CertifiedResult& a, const CertifiedResult& b) {
  if (a.status != b.status || a.t_lower != b.t_lower || a.t_upper != b.t_upper || a.certain != b.certain ||
      a.contacts.size() != b.contacts.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    if (!sameContact(a.contacts[i], b.contacts[i])) return false;
  }
  return true;
}

TEST(VisibilityQueries, SameAnswersOffOnAndAutomatic) {
  std::uint64_t pairs = 0, culled = 0, contacts = 0, different = 0;
  const std::uint64_t n = queries();
  for (std::uint64_t i = 0; i < n; ++i) {
    const std::uint64_t seed = 1000003 * 7 + i;
    const std::string& family = campaign::familyOf(7, i);
    const campaign::Scene scene = campaign::makeScene(family, seed);
    campaign::Question question = campaign::prepare(scene);
    const fcl_artic::JointMotion motion = campaign::motionOf(scene, *question.tree);
    CertifiedResult off, result;
    question.manager->continuousCollide(motion, question.request, off);
    contacts += off.status == fcl_artic::Status::contact;
    for (const VisibilityMode mode : {VisibilityMode::on, VisibilityMode::automatic}) {
      question.request.visibility = mode;
      question.manager->continuousCollide(motion, question.request, result);
      if (!sameAnswer(off, result)) {
        ++different;
        std::cout << family << " " << seed << ": " << static_cast<int>(off.status) << " " << off.t_lower - result.t_lower << " "
                  << off.t_upper - result.t_upper << " " << off.contacts.size() << "/" << result.contacts.size() << " " << off.t_lower << "\n";
      }
      if (mode != VisibilityMode::on) continue;
      pairs += result.statistics.visibility_pairs;
      culled += result.statistics.visibility_culled;
    }
  }
  std::cout << n << " queries, " << contacts << " with contact, " << pairs << " pairs seen, " << culled << " culled, "
            << different << " different\n";
  EXPECT_EQ(different, 0u);
  EXPECT_GT(culled, n / 10);
}

}  // namespace
