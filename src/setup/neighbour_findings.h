// SPDX-License-Identifier: BSD-3-Clause
//
// What neighbours do over all values of the joint between them, as it was found before set-up (query/link_pairs.cpp),
// with what it was found for.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "fcl_artic/link_pairs.h"
#include "setup/link_proofs.h"
#include "setup/pair_making.h"

namespace fcl_artic {

struct NeighbourFindings {
  struct Pair {
    LinkPairFinding finding;
    std::vector<PairMaking> made;  ///< of the two links' geometries, each with each
  };
  using Links = std::pair<LinkId, LinkId>;  ///< the lower number first
  std::map<Links, Pair> pairs;
  LinkPairProofs proofs;  ///< of those that are proven apart

  /// Null: nobody looked at the two.
  const LinkPairFinding* find(LinkId a, LinkId b) const {
    const auto pair = pairs.find(std::minmax(a, b));
    return pair == pairs.end() ? nullptr : &pair->second.finding;
  }
};

}  // namespace fcl_artic
