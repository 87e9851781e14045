// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs of pairs of links over the whole ranges of their joints (tables/range_proof.h), with what they were proven
// for; and what a query may take from them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl_artic/joint_motion.h"
#include "fcl_artic/link_pairs.h"
#include "model/margins.h"
#include "model/variable_strays.h"
#include "setup/pair_making.h"
#include "setup/registry.h"
#include "tables/range_proof.h"

namespace fcl_artic {

class LinkPairProofs {
 public:
  /// Proven: more than `margin` apart for all values of these variables within their whole ranges.
  struct Proof {
    PairMaking made;
    double margin;
    std::vector<int> variables;
  };
  void add(Proof proof);
  /// Null where there is none for just these two bodies and this margin.
  const Proof* find(const PairMaking& made, double margin) const;
  bool has(LinkId a, LinkId b) const { return proofs_.count({a, b}) > 0; }
  std::size_t size() const { return proofs_.size(); }

 private:
  std::multimap<std::pair<LinkId, LinkId>, Proof> proofs_;
};

/// The proofs that hold for a set-up, by its pairs.
class ProvenPairs {
 public:
  /// @param margins  of the pairs' own.
  /// @param num_self_pairs  number of the problem's link pairs, from the first on, that are two links.
  void buildSelf(const Registry& registry, const engine::Problem& problem, const PairMargins& margins,
                 std::size_t num_self_pairs);
  /// Builds what depends on the obstacles.
  void buildScene(const Registry& registry);

  bool empty() const { return checked_.empty(); }
  /// Whether the link pair is proven apart within the joints' limits, for the margin that it has of its own.
  bool proven(std::size_t link_pair) const { return link_pair < is_proven_.size() && is_proven_[link_pair]; }

  /// Marks the pairs that are proven apart for a whole motion.
  /// @param strays  of the motion's variables.
  /// @param[in,out] parts  of each link pair, as engine::Advisor::freeParts.
  void addFreeParts(const engine::Problem& problem, const JointMotion& motion, const VariableStrays& strays,
                    const engine::Margins& margins, std::vector<std::uint8_t>& parts) const;

  /// Number of allowed pairs of names, of two links or of link and obstacle, which nothing proves apart for all of
  /// these motions; undecidedNeighbours() included.
  std::size_t unprovenAllowed(const JointMotion* const* motions, std::size_t num_motions, const VariableStrays& strays,
                              const engine::Margins& margins, bool self, bool scene) const;

  /// Neighbours that the rule leaves out as it can't be decided whether they touch; null: none.
  using Names = std::vector<std::pair<std::string, std::string>>;
  const std::shared_ptr<const Names>& undecidedNeighbours() const { return undecided_; }

 private:
  struct Pair {
    std::size_t number;  ///< of a link pair, or of an allowed pair of names
    double margin;       ///< of the proof
    std::vector<int> variables;
    double own = -1;  ///< margin of an allowed pair of names, as NamedMargins::of()
  };
  /// Fills in what follows from the lists of pairs.
  void summarize();
  bool within(const std::vector<int>& variables, const JointMotion& motion, const VariableStrays& strays) const;

  std::vector<Pair> checked_, allowed_;
  std::shared_ptr<const Names> undecided_;
  std::vector<bool> is_proven_;
  std::vector<int> used_;                             ///< variables of all of these proofs
  std::vector<ValueRange> ranges_;                    ///< by variable
  std::size_t allowed_self_ = 0, allowed_scene_ = 0;  ///< pairs of names
  std::size_t proven_names_ = 0;                      ///< of `allowed_self_`, those in `allowed_`
  double least_allowed_margin_ = 0;                   ///< of proofs in `allowed_`; below 0: some pair's own counts
};

}  // namespace fcl_artic
