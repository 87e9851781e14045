// SPDX-License-Identifier: BSD-3-Clause
#include "meshes/readers.h"
#include "meshes/text.h"

namespace fcl_artic::meshes {
namespace {

/// The next column of a line, without blanks around it.
std::string_view takeColumn(std::string_view& line, char between) {
  const std::size_t end = between == ' ' ? line.find_first_of(" \t\v\f") : line.find(between);
  std::string_view column = line.substr(0, end);
  line.remove_prefix(end == line.npos ? line.size() : end + 1);
  const auto trim = [](std::string_view& text) {
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  };
  trim(column);
  trim(line);
  return column;
}

}  // namespace

Points readXyz(const Source& source) {
  Points points;
  char between = '\0';
  std::size_t columns = 0;
  for (Lines lines(withoutMark(source), source, '#'); lines.next();) {
    std::string_view line = lines.rest();
    if (points.empty()) between = line.find(';') != line.npos ? ';' : line.find(',') != line.npos ? ',' : ' ';
    Eigen::Vector3d& x = points.emplace_back();
    std::size_t count = 0;
    for (; !line.empty(); ++count) {
      const std::string_view column = takeColumn(line, between);
      double value = 0;
      if (!toCoordinate(column, value)) {
        if (count < 3) {
          lines.refuse("does not begin with three numbers between " +
                       std::string(between == ' '   ? "blanks"
                                   : between == ',' ? "commas"
                                                    : "semicolons") +
                       ": " + shown(column) +
                       (column.find(',') != column.npos || between == ',' ? " (decimals need a point)" : ""));
        }
        lines.refuse(shown(column) + " is not a number");
      }
      if (count < 3) x[static_cast<Eigen::Index>(count)] = value;
    }
    if (count < 3) lines.refuse("does not begin with three numbers");
    if (points.size() == 1) columns = count;
    if (count != columns) {
      lines.refuse("has " + std::to_string(count) + " columns, the first line has " + std::to_string(columns));
    }
  }
  if (columns > 3) source.note("of each point the first 3 numbers are read, of " + std::to_string(columns));
  noteOpenEnd(source);
  return points;
}

}  // namespace fcl_artic::meshes
