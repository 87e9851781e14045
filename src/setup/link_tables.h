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
  /// Tables of self pairs, for their own margins or none. (An attached object comes and goes: it gets none.) If a
  /// robot could have many thousands, only about the first kMax pairs get one, those of the largest links. The time
  /// that tables save is lost again where they don't fit in a cache.
  /// @param num_self_pairs  number of the problem's link pairs, from the first on, that are two links.
  /// @param proven  pairs that need no table.
  void build(const Registry& registry, const engine::Problem& problem, const PairMargins& margins,
             std::size_t num_self_pairs, const ProvenPairs& proven);

  bool empty() const { return num_tables_ == 0; }

  /// The parts of a motion that the pair's table proves apart, if it was built for at least the margin that the pair
  /// has here: bit k for the part [k/8, (k+1)/8].
  /// @param strays  of the motion's variables.
  unsigned freeParts(const engine::Problem& problem, const JointMotion& motion, const VariableStrays& strays,
                     const engine::Margins& margins, std::int32_t link_pair) const;

  /// Where links are likely to touch, the motion's end first: a guess, as engine::Advisor::suggest. (None for robots of
  /// more than 64 variables.)
  void likelyContacts(const JointMotion& motion, std::vector<engine::LikelyContact>& found) const;

 private:
  static constexpr std::size_t kMax = 1000, kBlock = 128;
  /// The tables of two links, and what they were made from.
  struct Made {
    PairMaking made;
    double margin;
    std::shared_ptr<const PairTable> table;   ///< null: none to be had
    std::shared_ptr<const ContactGrid> grid;  ///< null: none
  };

  /// The grid of a link pair. (All in one piece of memory: every query comes by.)
  struct Grid {
    std::int32_t link_pair;
    ContactGrid::Axes axes;
    std::size_t first;  ///< of its cells among likely_
  };

  void addGrid(const KinematicTree& tree, std::int32_t link_pair, const ContactGrid& grid);

  std::vector<Made> made_;                                ///< of all pairs that were asked for
  std::vector<std::shared_ptr<const PairTable>> tables_;  ///< by link pair; null: none
  std::size_t num_tables_ = 0;
  std::vector<Grid> grids_;
  std::vector<bool> likely_;                           ///< of all grids' cells
  int most_cells_ = 0;                                 ///< along a variable's range, in any grid
  std::vector<std::pair<int, VariableRange>> ranges_;  ///< of the variables that grids are over
};

}  // namespace fcl_artic
