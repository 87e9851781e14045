// SPDX-License-Identifier: BSD-3-Clause
#include "plans/ompl_path.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

namespace fcl_artic::plans {
namespace {

constexpr std::string_view kBlank = " \t\r";

/// States of joints, as OMPL's spaces print them. (A state of time or of whole numbers is no joint's value.)
constexpr std::string_view kStates[] = {"RealVectorState", "SO2State", "SO3State"};

/// Of "Geometric path with 3 states".
std::size_t statesOf(std::string_view head, int line) {
  const std::string_view start = "Geometric path with ", end = " states";
  std::size_t states = 0;
  const std::string_view digits = head.substr(std::min(start.size(), head.size()));
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), states);
  if (head.substr(0, start.size()) != start || error != std::errc() ||
      digits.substr(static_cast<std::size_t>(stop - digits.data())) != end) {
    throw std::invalid_argument(fmt::format("line {}: '{}' does not say how many states follow", line, head));
  }
  return states;
}

/// Numbers between blanks, appended.
void addNumbers(std::string_view text, int line, std::size_t waypoint, std::vector<double>& out) {
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlank, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlank, at), text.size());
    const std::string_view word = text.substr(at, end - at);
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size()) {
      throw std::invalid_argument(fmt::format("line {}: '{}' is not a number (waypoint {})", line, word, waypoint));
    }
    out.push_back(value);
    at = end;
  }
}

}  // namespace

Plan parseOmplPath(std::string_view content) {
  Plan plan;
  std::vector<double> row;
  int depth = 0;  // of compound states that are open
  std::optional<std::size_t> states;
  const auto end = [&] {
    if (depth > 0 || row.empty()) return;
    plan.positions.push_back(std::move(row));
    row.clear();
  };
  for (int number = 1; !content.empty(); ++number) {
    const std::size_t length = std::min(content.find('\n'), content.size());
    std::string_view line = content.substr(0, length);
    content.remove_prefix(std::min(length + 1, content.size()));
    const std::size_t begin = line.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) continue;
    line = line.substr(begin, line.find_last_not_of(kBlank) + 1 - begin);
    if (line.substr(0, 14) == "Geometric path") {
      if (states || !plan.positions.empty() || !row.empty())
        throw std::invalid_argument(fmt::format("line {}: a second path begins", number));
      states = statesOf(line, number);
      continue;
    }
    const std::size_t open = line.find('['), close = line.rfind(']');
    if (line == "]") {
      if (--depth < 0)
        throw std::invalid_argument(
            fmt::format("line {}: a bracket that nothing opens (waypoint {})", number, plan.positions.size()));
    } else if (line == "Compound state [") {
      ++depth;
    } else if (open != std::string_view::npos && close == line.size() - 1) {
      const std::string_view before = line.substr(0, open),
                             state = before.substr(0, before.find_last_not_of(kBlank) + 1);
      if (std::find(std::begin(kStates), std::end(kStates), state) == std::end(kStates)) {
        throw std::invalid_argument(
            fmt::format("line {}: '{}' is no state of joints: RealVectorState, SO2State and "
                        "SO3State are read (waypoint {})",
                        number, state, plan.positions.size()));
      }
      addNumbers(line.substr(open + 1, close - open - 1), number, plan.positions.size(), row);
    } else {
      addNumbers(line, number, plan.positions.size(), row);
    }
    end();
  }
  if (depth > 0 || !row.empty()) {
    throw std::invalid_argument(
        fmt::format("waypoint {}, the last state, has no end: the file is cut short", plan.positions.size()));
  }
  if (states && *states != plan.positions.size()) {
    throw std::invalid_argument(
        fmt::format("its first line says {} states, it has {}", *states, plan.positions.size()));
  }
  return plan;
}

}  // namespace fcl_artic::plans
