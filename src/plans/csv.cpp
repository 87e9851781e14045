// SPDX-License-Identifier: BSD-3-Clause
#include "plans/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "plans/variables.h"

namespace fcl_artic::plans {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(" \t\r\"") + 1 - begin);
}

std::vector<std::string_view> splitLine(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t at = 0;;) {
    const std::size_t end = line.find(',', at);
    fields.push_back(trimmed(line.substr(at, end == std::string_view::npos ? end : end - at)));
    if (end == std::string_view::npos) return fields;
    at = end + 1;
  }
}

double parseNumber(std::string_view text, const std::string& where, const std::string& column, std::size_t row) {
  const std::string whole(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars takes no plus
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw std::invalid_argument(
        fmt::format("{}, column '{}': '{}' is not a finite number (waypoint {})", where, column, whole, row));
  }
  return value;
}

/// The name without one of the endings; empty where it has none of them.
std::string without(const std::string& name, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) {
    if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0) {
      return name.substr(0, name.size() - ending.size());
    }
  }
  return {};
}

/// Columns of one quantity, by joint.
struct QuantityColumns {
  std::vector<std::string> joints;
  std::vector<std::size_t> at;

  void add(const std::string& joint, std::size_t column) {
    joints.push_back(joint);
    at.push_back(column);
  }
};

/// The columns in the order of `joints`.
Plan::Rows take(const Table& table, const QuantityColumns& columns, const std::vector<std::string>& joints,
                const std::string& what) {
  if (columns.at.empty()) return {};
  std::vector<std::size_t> order;
  for (const std::string& joint : joints) {
    const auto found = std::find(columns.joints.begin(), columns.joints.end(), joint);
    if (found == columns.joints.end()) {
      throw std::invalid_argument(fmt::format("line {}: joint '{}' has no column of its {}, which others have",
                                              table.header_line, joint, what));
    }
    order.push_back(columns.at[static_cast<std::size_t>(found - columns.joints.begin())]);
  }
  for (const std::string& joint : columns.joints) {
    if (std::find(joints.begin(), joints.end(), joint) != joints.end()) continue;
    throw std::invalid_argument(fmt::format("line {}: joint '{}' has a column of its {}, and none of its position",
                                            table.header_line, joint, what));
  }
  Plan::Rows rows;
  for (const std::vector<double>& row : table.rows) {
    std::vector<double>& out = rows.emplace_back();
    for (const std::size_t column : order) out.push_back(row[column]);
  }
  return rows;
}

}  // namespace

std::string Table::where(std::size_t row) const {
  return fmt::format("line {}", lines.at(row));
}

Table parseTable(std::string_view content, const std::string& file) {
  Table out;
  out.open_end = !content.empty() && content.back() != '\n';
  for (int number = 1; !content.empty(); ++number) {
    const std::size_t end = std::min(content.find('\n'), content.size());
    std::string_view line = content.substr(0, end);
    content.remove_prefix(std::min(end + 1, content.size()));
    if (number == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") line.remove_prefix(3);  // a byte order mark
    if (trimmed(line).empty() || trimmed(line)[0] == '#') continue;
    const std::string where = fmt::format("{}line {}", file, number);
    const std::vector<std::string_view> fields = splitLine(line);
    if (out.columns.empty()) {
      for (const std::string_view field : fields) {
        if (std::find(out.columns.begin(), out.columns.end(), field) != out.columns.end()) {
          throw std::invalid_argument(fmt::format("{}: column '{}' is there twice", where, field));
        }
        out.columns.emplace_back(field);
      }
      out.header_line = number;
      continue;
    }
    if (fields.size() != out.columns.size()) {
      throw std::invalid_argument(fmt::format("{} has {} columns, the first line names {} (waypoint {})", where,
                                              fields.size(), out.columns.size(), out.rows.size()));
    }
    const std::size_t number_of_row = out.rows.size();
    std::vector<double>& row = out.rows.emplace_back();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      row.push_back(parseNumber(fields[i], where, out.columns[i], number_of_row));
    }
    out.lines.push_back(number);
  }
  return out;
}

Plan parseCsv(const KinematicTree& tree, std::string_view content) {
  const Table table = parseTable(content, "");
  if (table.columns.empty()) throw std::invalid_argument("it is empty: no line names the columns");
  Plan plan;
  QuantityColumns positions, velocities, accelerations;
  std::vector<std::size_t> times;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const std::string& column = table.columns[i];
    const std::string v = without(column, {"/velocity", ".velocity", "_velocity", "_vel"}),
                      a = without(column, {"/acceleration", ".acceleration", "_acceleration", "_acc"});
    if (isVariable(tree, column)) {
      positions.add(column, i);
    } else if (column == "time" || column == "t" || column == "time_from_start") {
      times.push_back(i);
    } else if (!v.empty() && isVariable(tree, v)) {
      velocities.add(v, i);
    } else if (!a.empty() && isVariable(tree, a)) {
      accelerations.add(a, i);
    } else {
      variableOf(tree, column, fmt::format("line {}", table.header_line));
    }
  }
  if (times.size() > 1) {
    throw std::invalid_argument(fmt::format("line {}: two columns of times, '{}' and '{}'", table.header_line,
                                            table.columns[times[0]], table.columns[times[1]]));
  }
  plan.joints = positions.joints;
  plan.positions = take(table, positions, plan.joints, "position");
  plan.velocities = take(table, velocities, plan.joints, "velocity");
  plan.accelerations = take(table, accelerations, plan.joints, "acceleration");
  if (!times.empty()) {
    for (const std::vector<double>& row : table.rows) plan.times.push_back(row[times[0]]);
  }
  if (table.open_end) plan.notes.emplace_back("the last line has no line end: the file may be cut short");
  return plan;
}

}  // namespace fcl_artic::plans
