// SPDX-License-Identifier: BSD-3-Clause
//
// Link pairs by their movers: one against eight others, as stage 1 compares boxes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "model/problem.h"
#include "numerics/assertion.h"

namespace fcl_artic {

/// Appends the rows of pairs [begin, end): each pair once, under the lesser of its movers.
inline void addMoverRows(const std::vector<engine::MoverPair>& pairs, std::size_t begin, std::size_t end,
                         std::vector<engine::MoverRow>& rows) {
  std::map<std::pair<std::int32_t, std::int32_t>, engine::MoverRow> row_of;  // of a mover and a group of eight
  for (std::size_t p = begin; p < end; ++p) {
    const auto [mover, other] = std::minmax(pairs[p].a, pairs[p].b);
    engine::MoverRow& row = row_of[{mover, other / 8}];
    const std::int32_t lane = other % 8;
    FCL_ARTIC_ASSERT(mover >= 0 && mover != other && row.pair[lane] < 0);  // two movers make one pair
    row.mover = mover;
    row.group = other / 8;
    row.pair[lane] = static_cast<std::int32_t>(p);
    row.lanes |= 1u << lane;
  }
  for (const auto& [key, row] : row_of) rows.push_back(row);
}

/// The movers of link pairs, both ways.
struct PairMovers {
  std::vector<engine::MoverPair> pairs;
  std::vector<engine::MoverRow> rows;  ///< of two links first
  std::size_t num_self_rows = 0;       ///< of these
};

}  // namespace fcl_artic
