// SPDX-License-Identifier: BSD-3-Clause
//
// The campaign's scenes, asked without stage 2 and with it: the same bits.
#pragma once

#include <algorithm>

#include "arms.h"
#include "expect.h"
#include "fcl_artic/result.h"
#include "generator.h"

namespace fcl_artic {
namespace test {

inline bool sameBits(const CertifiedResult& a, const CertifiedResult& b) {
  const auto sameContact = [](const CertifiedContact& x, const CertifiedContact& y) {
    return x.body1.name == y.body1.name && x.body2.name == y.body2.name && x.b1 == y.b1 && x.b2 == y.b2 &&
           x.feature == y.feature && x.point == y.point && x.normal == y.normal && x.t_lower == y.t_lower &&
           x.t_upper == y.t_upper && x.certain == y.certain;
  };
  return a.status == b.status && a.t_lower == b.t_lower && a.t_upper == b.t_upper && a.certain == b.certain &&
         a.contacts.size() == b.contacts.size() &&
         std::equal(a.contacts.begin(), a.contacts.end(), b.contacts.begin(), sameContact) &&
         a.ignored_initial_contacts.size() == b.ignored_initial_contacts.size() &&
         a.unproven_allowed_pairs == b.unproven_allowed_pairs;
}

/// Cases whose seeds follow one another.
inline campaign::CaseId inTurn(std::uint64_t seed, std::uint64_t index) {
  return {campaign::familyOf(seed, index), 1000003 * seed + index};
}

inline void sameBitsWithTheStage(const campaign::Asked& asked, campaign::Case& c) {
  const CertifiedResult& off = asked.result(0);
  if (!sameBits(off, asked.result(1))) c.fault("different", "answer");
  const QueryStatistics& on = asked.result(1).statistics;
  if (!on.visibility_fallback.empty()) c.fault("fallback", on.visibility_fallback);
  c.tally.count("contact", off.status == Status::contact);
  c.tally.count("pairs", on.visibility.pairs);
  c.tally.count("culled", on.visibility.culled);
  c.tally.count("nodes", on.visibility.nodes);
  c.tally.count("repeated", on.visibility.repeated);
}

inline campaign::Arms withAndWithoutStage(const std::shared_ptr<const VisibilityCuller>& culler = nullptr) {
  campaign::Arms arms;
  arms.number = inTurn;
  arms.ways = {campaign::byVisibility(VisibilityMode::off), campaign::byVisibility(VisibilityMode::on)};
  arms.judges = {sameBitsWithTheStage};
  arms.culler = culler;
  return arms;
}

}  // namespace test
}  // namespace fcl_artic
