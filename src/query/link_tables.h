// SPDX-License-Identifier: BSD-3-Clause
//
// Tables of where two links are proven apart (PairTable), one for each self pair that can have one. A table is made
// again only when its links or their margin change.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "narrowphase/problem.h"
#include "query/pair_table.h"
#include "query/registry.h"

namespace fcl_artic {

class LinkTables {
 public:
  /// Tables of self pairs, for their own margins or none. (An attached object comes and goes: it gets none.)
  /// @param num_self_pairs  the first so many of the problem's link pairs.
  void build(const Registry& registry, const engine::Problem& problem, std::size_t num_self_pairs);

  bool empty() const { return tables_.empty(); }

  /// What tables tell of a motion, as engine::Query::link_free.
  /// @param margin  the query's, of pairs that have none of their own.
  /// @param memory  holds the answer.
  const std::uint8_t* freeParts(const engine::Problem& problem, const JointMotion& motion, double margin,
                                std::vector<std::uint8_t>& memory) const;

 private:
  /// The table of two links, and what it was made from.
  struct Made {
    std::shared_ptr<const ShapeTree> shape_a, shape_b;
    LinkId link_a, link_b;
    Eigen::Matrix4d offset_a, offset_b;
    double margin;
    std::shared_ptr<const PairTable> table;  ///< null: none to be had

    Made(const ManagedBody& a, const ManagedBody& b, double margin);
    bool sameMaking(const Made& other) const;
  };

  std::vector<Made> made_;  ///< of all pairs
  std::vector<std::pair<std::size_t, std::shared_ptr<const PairTable>>> tables_;  ///< by link pair
};

}  // namespace fcl_artic
