// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plans/plan.h"

namespace fcl_artic::plans {

/// Numbers in columns, separated by commas, semicolons, tabs or blanks, whichever of these the first line has first. It
/// names the columns, unless it is a row of numbers itself. Empty lines and lines that begin with # are passed over. A
/// number may end with deg: it is in degrees, and is turned into rad.
struct Table {
  std::vector<std::string> columns;  ///< empty: they have no names
  char separator = ',';              ///< of the columns
  std::string comment;               ///< the last one before the first line, without #
  std::vector<bool> degrees;         ///< columns with such a number
  std::vector<std::vector<double>> rows;
  int header_line = 0;     ///< the first line, counted from 1
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
///
/// Other layouts that are usual are taken too, and a note says what was taken for what:
/// - `Time`, `timestamp`, `__time`;
/// - /joint_states/JOINT/position, as PlotJuggler has it;
/// - numbered columns, from 0 or 1 on, `q1`, `j0`, `joint_1`, `actual_q_0` and, of velocities, `qd1`, `actual_qd_0`,
///   as many as there are joints, in their order;
/// - names in a comment before the first row;
/// - no names, and as many columns as joints, or a column of times before them.
/// @param options  where all of this is not so.
Plan parseCsv(const KinematicTree& tree, std::string_view content, const ColumnOptions& options = {});

}  // namespace fcl_artic::plans
