// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plans/plan.h"

namespace fcl_artic::plans {

/// Numbers in columns: comma separated values, of which the first line names the columns. Empty lines and lines that
/// begin with # are passed over.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
  int header_line = 0;     ///< counted from 1
  std::vector<int> lines;  ///< of the rows
  bool open_end = false;   ///< the last line has no line end: the file may be cut short within its last number

  /// "line N", of a row.
  std::string where(std::size_t row) const;
};

/// @param file  begins messages, as "'way.csv' "; may be empty.
/// @throws std::invalid_argument naming line and column: a row of another length, what is no finite number, a column
///   that is there twice.
Table parseTable(std::string_view content, const std::string& file);

/// A plan: columns `time` (`t`, `time_from_start`), JOINT, and JOINT with an ending /velocity, .velocity, _velocity or
/// _vel, and the same of acceleration, _acc. Velocities of some joints only are refused, as are accelerations.
Plan parseCsv(const KinematicTree& tree, std::string_view content);

}  // namespace fcl_artic::plans
