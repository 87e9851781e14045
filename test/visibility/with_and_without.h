// SPDX-License-Identifier: BSD-3-Clause
//
// The campaign's scenes, asked without stage 2, with it, and as `automatic` says: the same bits.
#pragma once

#include "answers.h"
#include "arms.h"
#include "expect.h"
#include "generator.h"

namespace fcl_artic {
namespace test {

/// Cases whose seeds follow one another.
inline campaign::CaseId inTurn(std::uint64_t seed, std::uint64_t index) {
  return {campaign::familyOf(seed, index), 1000003 * seed + index};
}

inline void sameBitsWithTheStage(const campaign::Asked& asked, campaign::Case& c) {
  const CertifiedResult& off = asked.result(0);
  for (std::size_t way = 1; way < asked.answers.size(); ++way) {
    if (!sameBits(off, asked.result(way))) c.fault("different", "way " + std::to_string(way));
  }
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
  arms.ways = {campaign::byVisibility(VisibilityMode::off), campaign::byVisibility(VisibilityMode::on),
               campaign::byVisibility(VisibilityMode::automatic)};
  arms.judges = {sameBitsWithTheStage};
  arms.culler = culler;
  return arms;
}

}  // namespace test
}  // namespace fcl_artic
