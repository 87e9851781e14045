// SPDX-License-Identifier: BSD-3-Clause
#include "plans/csv.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "kinematics/angles.h"
#include "plans/variables.h"

namespace fcl_artic::plans {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\"");
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(" \t\r\"") + 1 - begin);
}

constexpr char kBlanks = ' ';  ///< any number of blanks and tabs

/// The character that separates the columns of a line.
char separatorOf(std::string_view line) {
  for (const char separator : {';', ',', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return kBlanks;
}

std::vector<std::string_view> splitLine(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator == kBlanks) {
    for (std::size_t at = 0; (at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
      fields.push_back(trimmed(line.substr(at, end - at)));
      at = end;
    }
    return fields;
  }
  for (std::size_t at = 0;;) {
    const std::size_t end = line.find(separator, at);
    fields.push_back(trimmed(line.substr(at, end == std::string_view::npos ? end : end - at)));
    if (end == std::string_view::npos) return fields;
    at = end + 1;
  }
}

/// @param[out] degrees  whether it ends with deg; the value is in rad then.
std::optional<double> cellOf(std::string_view text, bool& degrees) {
  degrees = text.size() > 3 && text.substr(text.size() - 3) == "deg";
  if (degrees) text = trimmed(text.substr(0, text.size() - 3));
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars takes no plus
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return degrees ? value * kRadiansPerDegree : value;
}

double parseNumber(std::string_view text, const std::string& where, const std::string& column, std::size_t row,
                   bool& degrees) {
  const std::optional<double> value = cellOf(text, degrees);
  if (!value || !std::isfinite(*value)) {
    throw std::invalid_argument(
        fmt::format("{}, column '{}': '{}' is not a finite number (waypoint {})", where, column, text, row));
  }
  return *value;
}

bool isRowOfNumbers(const std::vector<std::string_view>& fields) {
  bool degrees = false;
  return std::all_of(fields.begin(), fields.end(), [&](std::string_view field) { return cellOf(field, degrees); });
}

/// The name without one of the endings; empty if it has none of them.
std::string without(const std::string& name, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) {
    if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0) {
      return name.substr(0, name.size() - ending.size());
    }
  }
  return {};
}

const std::vector<std::string> kVelocityEndings{"/velocity", ".velocity", "_velocity", "_vel"},
    kAccelerationEndings{"/acceleration", ".acceleration", "_acceleration", "_acc"};

enum class Quantity { time, position, velocity, acceleration, none };

/// The meaning that a column is taken to have.
struct Meaning {
  Quantity quantity = Quantity::none;
  std::string joint;
  bool counted = false;  ///< by its place or number among the joints, not by its name

  std::string text() const {
    switch (quantity) {
      case Quantity::time:
        return "time";
      case Quantity::velocity:
        return joint + "/velocity";
      case Quantity::acceleration:
        return joint + "/acceleration";
      case Quantity::position:
      case Quantity::none:
        break;
    }
    return joint;
  }
};

/// Columns of one quantity, by joint.
struct QuantityColumns {
  std::vector<std::string> joints;  ///< in the order of the file
  std::map<std::string, std::size_t> at;

  void add(const Meaning& meaning, std::size_t column, int line) {
    const auto [first, is_new] = at.emplace(meaning.joint, column);
    if (!is_new) {
      throw std::invalid_argument(
          fmt::format("line {}: two columns are '{}', {} and {}", line, meaning.text(), first->second, column));
    }
    joints.push_back(meaning.joint);
  }
};

/// The columns in the order of those of positions.
Plan::Rows take(const Table& table, const QuantityColumns& columns, const QuantityColumns& positions,
                const std::string& what) {
  if (columns.at.empty()) return {};
  std::vector<std::size_t> order;
  for (const std::string& joint : positions.joints) {
    const auto found = columns.at.find(joint);
    if (found == columns.at.end()) {
      throw std::invalid_argument(
          fmt::format("line {}: joint '{}' has no column of its {}, which others have (--skip leaves theirs out)",
                      table.header_line, joint, what));
    }
    order.push_back(found->second);
  }
  for (const std::string& joint : columns.joints) {
    if (positions.at.count(joint)) continue;
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

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// A name in the robot's own words.
std::optional<Meaning> exactMeaning(const KinematicTree& tree, const std::string& name) {
  if (isVariable(tree, name)) return Meaning{Quantity::position, name};
  if (name == "time" || name == "t" || name == "time_from_start") return Meaning{Quantity::time, {}};
  const std::string v = without(name, kVelocityEndings), a = without(name, kAccelerationEndings);
  if (!v.empty() && isVariable(tree, v)) return Meaning{Quantity::velocity, v};
  if (!a.empty() && isVariable(tree, a)) return Meaning{Quantity::acceleration, a};
  return std::nullopt;
}

/// The meaning of a path such as /joint_states/JOINT/position: the part before the last is a variable.
std::optional<Meaning> pathMeaning(const KinematicTree& tree, const std::string& name) {
  static const std::map<std::string, Quantity> kQuantities{{"position", Quantity::position},
                                                           {"positions", Quantity::position},
                                                           {"pos", Quantity::position},
                                                           {"velocity", Quantity::velocity},
                                                           {"velocities", Quantity::velocity},
                                                           {"vel", Quantity::velocity},
                                                           {"acceleration", Quantity::acceleration},
                                                           {"accelerations", Quantity::acceleration},
                                                           {"acc", Quantity::acceleration},
                                                           {"effort", Quantity::none},
                                                           {"torque", Quantity::none}};
  const std::size_t last = name.find_last_of("/.");
  if (last == std::string::npos) return std::nullopt;
  const auto quantity = kQuantities.find(lowered(name.substr(last + 1)));
  if (quantity == kQuantities.end()) return std::nullopt;
  // Names of variables may hold these signs too, so the longest end of the path that is such a name counts.
  const std::string path = name.substr(0, last);
  for (std::size_t at = 0;;) {
    if (isVariable(tree, path.substr(at))) return Meaning{quantity->second, path.substr(at)};
    at = path.find_first_of("/.", at);
    if (at == std::string::npos) return std::nullopt;
    ++at;
  }
}

bool isUsualTime(const std::string& name) {
  static const std::set<std::string> kNames{"time",     "t",       "timestamp", "__time", "time_s",
                                            "time [s]", "time(s)", "time (s)",  "secs",   "seconds"};
  return kNames.count(lowered(name)) > 0;
}

/// "actual_q_0" is {"actual_q", 0}; nothing without a number at the end.
std::optional<std::pair<std::string, int>> numberedName(const std::string& name) {
  std::string text = lowered(name);
  if (!text.empty() && (text.back() == ']' || text.back() == ')')) text.pop_back();
  std::size_t digits = 0;
  while (digits < text.size() && std::isdigit(static_cast<unsigned char>(text[text.size() - 1 - digits]))) ++digits;
  if (digits == 0 || digits == text.size() || digits > 3) return std::nullopt;
  const int number = std::stoi(text.substr(text.size() - digits));
  text.resize(text.size() - digits);
  while (!text.empty() && std::string("_-. [(").find(text.back()) != std::string::npos) text.pop_back();
  return std::make_pair(text, number);
}

/// Gives numbered columns their meanings: those that count from 0 or 1 on and are as many as the joints.
void addNumbered(const std::vector<std::string>& columns, const std::vector<std::string>& joints,
                 std::vector<std::optional<Meaning>>& meanings) {
  static const std::vector<std::pair<Quantity, std::vector<std::string>>> kFamilies{
      {Quantity::position, {"q", "j", "a", "axis", "joint", "theta", "pos", "position", "actual_q", "joint_position"}},
      {Quantity::velocity, {"qd", "dq", "vel", "velocity", "actual_qd", "joint_velocity"}},
      {Quantity::acceleration, {"qdd", "ddq", "acc", "acceleration", "actual_qdd", "joint_acceleration"}}};
  for (const auto& [quantity, names] : kFamilies) {
    for (const std::string& family : names) {
      std::map<int, std::size_t> found;
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto number = numberedName(columns[i]);
        if (!meanings[i] && number && number->first == family) found.emplace(number->second, i);
      }
      if (found.empty() || found.size() != joints.size()) continue;
      const int first = found.begin()->first;
      if (first > 1 || found.rbegin()->first != first + static_cast<int>(joints.size()) - 1) continue;
      for (const auto& [number, column] : found) {
        meanings[column] = Meaning{quantity, joints[static_cast<std::size_t>(number - first)], true};
      }
      break;
    }
  }
}

std::vector<std::string> jointsOf(const KinematicTree& tree, const ColumnOptions& options) {
  if (!options.joints.empty()) return options.joints;
  std::vector<std::string> all;
  for (int v = 0; v < tree.dof(); ++v) all.push_back(tree.variableName(v));
  return all;
}

bool rises(const Table& table, std::size_t column) {
  for (std::size_t k = 1; k < table.rows.size(); ++k) {
    if (!(table.rows[k][column] > table.rows[k - 1][column])) return false;
  }
  return true;
}

/// As the caller says it.
std::vector<std::optional<Meaning>> givenMeanings(const KinematicTree& tree, const Table& table,
                                                  const ColumnOptions& options) {
  const std::size_t width = table.degrees.size();
  // A first line with a number in it is no line of names: a waypoint would be lost.
  bool degrees = false;
  for (const std::string& name : table.columns) {
    if (!cellOf(name, degrees) || isVariable(tree, name)) continue;
    throw std::invalid_argument(
        fmt::format("line {} neither names columns nor is a row of numbers: it has '{}', and others that are none",
                    table.header_line, name));
  }
  if (options.columns.size() != width) {
    throw std::invalid_argument(
        fmt::format("line {} has {} columns, --columns names {}", table.header_line, width, options.columns.size()));
  }
  std::vector<std::optional<Meaning>> meanings;
  for (const std::string& name : options.columns) {
    std::optional<Meaning> meaning = exactMeaning(tree, name);
    if (!meaning && name != "-") variableOf(tree, name, "--columns");
    meanings.push_back(meaning ? *meaning : Meaning());
  }
  return meanings;
}

/// The meanings of columns without names.
std::vector<std::optional<Meaning>> meaningsByPlace(const KinematicTree& tree, const Table& table,
                                                    const ColumnOptions& options) {
  const std::vector<std::string> joints = jointsOf(tree, options);
  const std::size_t width = table.degrees.size();
  const bool timed = width == joints.size() + 1 && rises(table, 0);
  if (!timed && width != joints.size()) {
    throw std::invalid_argument(fmt::format(
        "line {0} names no columns, and its {1} numbers are neither the {2} joints {3} nor these after a time that "
        "rises: --columns says what each is, --state gives joints that stay",
        table.header_line, width, joints.size(), fmt::join(joints, ", ")));
  }
  std::vector<std::optional<Meaning>> meanings;
  if (timed) meanings.emplace_back(Meaning{Quantity::time, {}});
  for (const std::string& joint : joints) meanings.emplace_back(Meaning{Quantity::position, joint, true});
  return meanings;
}

std::vector<std::optional<Meaning>> meaningsByName(const KinematicTree& tree, const Table& table,
                                                   const ColumnOptions& options) {
  const std::vector<std::string>& columns = table.columns;
  const auto isNamed = [&](const std::string& name) {
    return std::find(columns.begin(), columns.end(), name) != columns.end();
  };
  for (const std::string& name : options.skip) {
    if (!isNamed(name))
      throw std::invalid_argument(fmt::format("--skip: line {} has no column '{}'", table.header_line, name));
  }
  if (!options.time.empty() && !isNamed(options.time)) {
    throw std::invalid_argument(fmt::format("--time: line {} has no column '{}'", table.header_line, options.time));
  }
  std::vector<std::optional<Meaning>> meanings(columns.size());
  bool timed = !options.time.empty();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (std::find(options.skip.begin(), options.skip.end(), columns[i]) != options.skip.end()) {
      meanings[i] = Meaning();
    } else if (!options.time.empty() && columns[i] == options.time) {
      meanings[i] = Meaning{Quantity::time, {}};
    } else if ((meanings[i] = exactMeaning(tree, columns[i]))) {
      if (meanings[i]->quantity == Quantity::time && !options.time.empty()) meanings[i] = Meaning();
      timed = timed || meanings[i]->quantity == Quantity::time;
    } else {
      meanings[i] = pathMeaning(tree, columns[i]);
    }
  }
  for (std::size_t i = 0; i < columns.size() && !timed; ++i) {
    if (meanings[i] || !isUsualTime(columns[i])) continue;
    meanings[i] = Meaning{Quantity::time, {}};
    timed = true;
  }
  addNumbered(columns, jointsOf(tree, options), meanings);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (meanings[i]) continue;
    try {
      variableOf(tree, columns[i], fmt::format("line {}", table.header_line));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(
          fmt::format("{}; --skip leaves a column out, --columns says what all of them are", error.what()));
    }
  }
  return meanings;
}

/// The names in the last comment before rows without names, as NumPy's savetxt() writes them. There are none unless the
/// comment has as many words as there are columns, and one of them is a variable's name.
std::vector<std::string> namesInComment(const KinematicTree& tree, const Table& table) {
  std::vector<std::string> names;
  for (const std::string_view name : splitLine(table.comment, separatorOf(table.comment))) names.emplace_back(name);
  const bool named = std::any_of(names.begin(), names.end(), [&](const auto& name) { return isVariable(tree, name); });
  if (!named || names.size() != table.degrees.size()) names.clear();
  return names;
}

/// "time = Time, hinge = q1; left out: gripper": the columns whose names are not the robot's own.
std::string takenText(const KinematicTree& tree, const Table& table,
                      const std::vector<std::optional<Meaning>>& meanings) {
  std::string taken, left;
  bool other = table.columns.empty();
  for (std::size_t i = 0; i < meanings.size(); ++i) {
    const std::string name = table.columns.empty() ? fmt::format("column {}", i) : table.columns[i];
    if (meanings[i]->quantity == Quantity::none) {
      left += (left.empty() ? "" : ", ") + name;
      continue;
    }
    const auto exact = table.columns.empty() ? std::nullopt : exactMeaning(tree, name);
    other = other || !exact || exact->text() != meanings[i]->text();
    taken += fmt::format("{}{} = {}", taken.empty() ? "" : ", ", meanings[i]->text(), name);
  }
  std::string text = other ? "its columns are taken so: " + taken : "";
  if (!left.empty()) text += (text.empty() ? "left out of its columns: " : "; left out: ") + left;
  return text;
}

}  // namespace

std::string Table::where(std::size_t row) const {
  return fmt::format("line {}", lines.at(row));
}

Table parseTable(std::string_view content, const std::string& file) {
  Table out;
  std::size_t width = 0;
  out.open_end = !content.empty() && content.back() != '\n';
  for (int number = 1; !content.empty(); ++number) {
    const std::size_t end = std::min(content.find('\n'), content.size());
    std::string_view line = content.substr(0, end);
    content.remove_prefix(std::min(end + 1, content.size()));
    if (number == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") line.remove_prefix(3);  // a byte order mark
    if (trimmed(line).empty()) continue;
    if (trimmed(line)[0] == '#') {
      if (out.header_line == 0) out.comment = trimmed(trimmed(line).substr(1));
      continue;
    }
    const std::string where = fmt::format("{}line {}", file, number);
    if (out.header_line == 0) out.separator = separatorOf(line);
    const std::vector<std::string_view> fields = splitLine(line, out.separator);
    if (out.header_line == 0) {
      out.header_line = number;
      width = fields.size();
      out.degrees.assign(width, false);
      if (!isRowOfNumbers(fields)) {
        std::set<std::string_view> names;
        for (const std::string_view field : fields) {
          if (!names.insert(field).second) {
            throw std::invalid_argument(fmt::format("{}: column '{}' is there twice", where, field));
          }
          out.columns.emplace_back(field);
        }
        continue;
      }
    }
    if (fields.size() != width) {
      throw std::invalid_argument(fmt::format("{} has {} columns, the first line {} {} (waypoint {})", where,
                                              fields.size(), out.columns.empty() ? "has" : "names", width,
                                              out.rows.size()));
    }
    const std::size_t number_of_row = out.rows.size();
    std::vector<double>& row = out.rows.emplace_back();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      bool degrees = false;
      row.push_back(parseNumber(fields[i], where, out.columns.empty() ? std::to_string(i) : out.columns[i],
                                number_of_row, degrees));
      if (degrees) out.degrees[i] = true;
    }
    out.lines.push_back(number);
  }
  return out;
}

Plan parseCsv(const KinematicTree& tree, std::string_view content, const ColumnOptions& options) {
  Table table = parseTable(content, "");
  if (table.header_line == 0) throw std::invalid_argument("it is empty: no line names the columns");
  const bool in_comment = table.columns.empty();
  if (in_comment && options.columns.empty()) table.columns = namesInComment(tree, table);
  const std::vector<std::optional<Meaning>> meanings = !options.columns.empty() ? givenMeanings(tree, table, options)
                                                       : table.columns.empty()  ? meaningsByPlace(tree, table, options)
                                                                                : meaningsByName(tree, table, options);
  Plan plan;
  QuantityColumns positions, velocities, accelerations;
  std::vector<std::size_t> times;
  for (std::size_t i = 0; i < meanings.size(); ++i) {
    const Meaning& meaning = *meanings[i];
    if (table.degrees[i] && meaning.quantity != Quantity::none) {
      const bool angle =
          meaning.quantity != Quantity::time && tree.isAngle(variableOf(tree, meaning.joint, "the plan"));
      if (!angle)
        throw std::invalid_argument(
            fmt::format("column {} ('{}') is no angle, and a value of it ends with deg", i, meaning.text()));
      plan.has_degrees = true;
    }
    switch (meaning.quantity) {
      case Quantity::time:
        times.push_back(i);
        break;
      case Quantity::position:
        positions.add(meaning, i, table.header_line);
        break;
      case Quantity::velocity:
        velocities.add(meaning, i, table.header_line);
        break;
      case Quantity::acceleration:
        accelerations.add(meaning, i, table.header_line);
        break;
      case Quantity::none:
        break;
    }
  }
  if (times.size() > 1) {
    const auto name = [&](std::size_t i) { return table.columns.empty() ? std::to_string(i) : table.columns[i]; };
    throw std::invalid_argument(
        fmt::format("line {}: two columns of times, '{}' and '{}'", table.header_line, name(times[0]), name(times[1])));
  }
  plan.joints = positions.joints;
  plan.joints_counted = std::any_of(meanings.begin(), meanings.end(), [](const auto& m) { return m->counted; });
  plan.positions = take(table, positions, positions, "position");
  plan.velocities = take(table, velocities, positions, "velocity");
  plan.accelerations = take(table, accelerations, positions, "acceleration");
  if (!times.empty()) {
    // Times above this are a clock's seconds since 1970: they leave few digits for a motion.
    constexpr double kClock = 1e8;
    const double first = table.rows.empty() ? 0 : table.rows[0][times[0]], begin = first >= kClock ? first : 0;
    for (const std::vector<double>& row : table.rows) plan.times.push_back(row[times[0]] - begin);
    if (begin > 0)
      plan.notes.push_back(fmt::format("times are a clock's: they are counted from the first, {:.6f} s", begin));
  }
  const std::string taken = takenText(tree, table, meanings);
  if (!taken.empty()) plan.notes.push_back(taken);
  plan.foreign = !taken.empty() || in_comment || table.separator != ',';
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const bool own = meanings[i]->quantity == Quantity::none || exactMeaning(tree, table.columns[i]);
    if (!own) keepUnits(table.columns[i], table.header_line, plan);
  }
  return plan;
}

}  // namespace fcl_artic::plans
