// SPDX-License-Identifier: BSD-3-Clause
//
// The behaviour of neighbours over all values of the joint between them, as it was found before set-up
// (query/link_pairs.cpp), with what it was found for.
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "fcl_artic/link_pairs.h"
#include "numerics/assertion.h"
#include "setup/link_proofs.h"
#include "setup/pair_making.h"

namespace fcl_artic {

struct NeighbourFindings {
  struct Pair {
    LinkPairFinding finding;
    std::vector<PairMaking> made;  ///< of the two links' geometries, each with each
    /// Which of these are apart at a tried value, though the links touch at all of them; empty: none.
    std::vector<bool> apart;

    /// Whether some of the geometries are checked.
    bool isChecked() const { return !finding.leftOut() || !apart.empty(); }
  };
  using Links = std::pair<LinkId, LinkId>;  ///< the lower number first
  std::map<Links, Pair> pairs;
  LinkPairProofs proofs;  ///< of those that are proven apart

  /// Null: nobody looked at the two.
  const Pair* find(LinkId a, LinkId b) const {
    const auto pair = pairs.find(std::minmax(a, b));
    return pair == pairs.end() ? nullptr : &pair->second;
  }
  /// Whether the rule for neighbours leaves out these two geometries of two links.
  bool leavesOut(const KinematicTree& tree, const ManagedBody& a, const ManagedBody& b) const {
    const Pair* const pair = find(a.link, b.link);
    if (!pair || !pair->finding.leftOut()) return false;
    if (pair->apart.empty()) return true;
    const PairMaking asked = PairMaking::inOrder(tree, a, b);
    const auto here =
        std::find_if(pair->made.begin(), pair->made.end(), [&](const PairMaking& m) { return m.sameAs(asked); });
    FCL_ARTIC_ASSERT(here != pair->made.end());
    return here != pair->made.end() && !pair->apart[static_cast<std::size_t>(here - pair->made.begin())];
  }
};

}  // namespace fcl_artic
