// SPDX-License-Identifier: BSD-3-Clause
//
// Tables of where two links are proven apart (PairTable), and of where they are likely to touch (ContactGrid), one of
// each for each self pair that can have it. They are made again only when their links or the pair's margin change.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "model/query.h"
#include "setup/link_proofs.h"
#include "setup/margins.h"
#include "setup/pair_making.h"
#include "setup/registry.h"
#include "tables/contact_grid.h"
#include "tables/pair_table.h"

namespace fcl_artic {

class LinkTables {
 public:
  /// Tables of self pairs, for their own margins or none. (An attached object comes and goes: it gets none.)
  /// @param num_self_pairs  the first so many of the problem's link pairs.
  /// @param proven  pairs that need no table.
  void build(const Registry& registry, const engine::Problem& problem, const PairMargins& margins,
             std::size_t num_self_pairs, const ProvenPairs& proven);

  bool empty() const { return tables_.empty(); }

  /// Marks what tables prove apart of a motion: those built for at least the margin that the pair has here.
  /// @param[in,out] parts  of each link pair, as engine::Advisor::freeParts.
  void addFreeParts(const engine::Problem& problem, const JointMotion& motion, const engine::Margins& margins,
                    std::vector<std::uint8_t>& parts) const;

  /// Where links are likely to touch, the motion's end first: a guess, as engine::Advisor::suggest. (None for robots of
  /// more than 64 variables.)
  void likelyContacts(const JointMotion& motion, std::vector<engine::LikelyContact>& found) const;

 private:
  /// The tables of two links, and what they were made from.
  struct Made {
    PairMaking made;
    double margin;
    std::shared_ptr<const PairTable> table;   ///< null: none to be had
    std::shared_ptr<const ContactGrid> grid;  ///< null: none
  };

  /// Of a link pair. (All in one piece of memory: every query comes by.)
  struct Grid {
    std::int32_t link_pair;
    ContactGrid::Axes axes;
    std::size_t first;  ///< of its cells among likely_
  };

  void addGrid(const KinematicTree& tree, std::int32_t link_pair, const ContactGrid& grid);

  std::vector<Made> made_;                                                        ///< of all pairs
  std::vector<std::pair<std::size_t, std::shared_ptr<const PairTable>>> tables_;  ///< by link pair
  std::vector<Grid> grids_;
  std::vector<bool> likely_;                           ///< of all grids' cells
  std::vector<std::pair<int, VariableRange>> ranges_;  ///< of the variables that grids are over
};

}  // namespace fcl_artic
