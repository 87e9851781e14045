// SPDX-License-Identifier: BSD-3-Clause
//
// The part of one query in a batch: its links' swept volumes and the other bodies' pieces that they may touch. Also
// what the batch's answer says of its pairs (doc/VISIBILITY.md). A batch may hold several queries: they share nothing
// in it.
#pragma once

#include <cstdint>
#include <vector>

#include "fcl_artic/statistics.h"
#include "model/query.h"
#include "visibility/batch.h"
#include "visibility/volumes.h"

namespace fcl_artic {
namespace visibility {

class QueryVolumes {
 public:
  /// Adds one window per swept volume, its parts, and per pair those pieces of the other body whose bounds meet a
  /// part's, in groups by cluster. Pairs of two links are left out unless they seem to be worth it.
  /// @param links, candidates  as engine::Advisor::clear is given them; not needed any more afterwards.
  /// @param tolerance_distance  of the query, m: what is nearer stays, since the solver alone may take it for a
  /// contact.
  void add(const engine::Problem& problem, const engine::SweptLink* links, const engine::CullCandidate* candidates,
           std::int32_t n, double tolerance_distance, bool every_link_pair, Batch& batch);
  /// Whether it looks at that candidate: what it does not look at stays.
  bool looksAt(std::int32_t candidate) const { return kinds_[static_cast<std::size_t>(candidate)] != Kind::none; }
  /// Takes the executor's answer for the batch that this query was added to.
  void conclude(const Batch& batch, const std::vector<std::uint8_t>& may);

  // After conclude():
  /// Clears the candidates that are proven free, and sets the free nodes of the others; they stay valid until the next
  /// add(). @param candidates  those of add(), in their order.
  void apply(engine::CullCandidate* candidates) const;
  /// Pairs, pieces and what was culled.
  const VisibilityStatistics& work() const { return work_; }

 private:
  /// The kind of the other body; none: the pair is not looked at.
  enum class Kind : std::uint8_t { none, obstacle, link, moving };
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::int32_t first_group_ = 0;
  std::size_t first_object_ = 0, end_object_ = 0;  ///< in the batch
  std::vector<Kind> kinds_;                        ///< of each pair
  std::vector<std::size_t> num_words_;             ///< of each pair: a bit for each node of the other body's tree
  std::vector<Cluster> clusters_;                  ///< of each group, from first_group_ on
  std::vector<Cluster> free_;                      ///< proven free
  std::vector<std::uint8_t> stays_;                ///< by group
  std::vector<std::size_t> first_word_;            ///< of each pair, in free_nodes_; kNone: nothing of it stays
  std::vector<std::uint64_t> free_nodes_;          ///< CullCandidate::free_nodes, one after the other
  VisibilityStatistics work_;

  static Kind kindOf(const engine::Problem& problem, std::int32_t still);
  bool isFree(std::size_t pair) const { return kinds_[pair] != Kind::none && first_word_[pair] == kNone; }
};

}  // namespace visibility
}  // namespace fcl_artic
