// SPDX-License-Identifier: BSD-3-Clause
#include "plans/plan.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "plans/csv.h"
#include "plans/document.h"
#include "plans/numpy.h"
#include "plans/ompl_path.h"
#include "text/one_line.h"
#include "text/units.h"

namespace fcl_artic::plans {
namespace {

const std::vector<std::pair<const char*, Format>> kEndings{
    {".csv", Format::csv},   {".json", Format::json}, {".jsonl", Format::jsonl}, {".ndjson", Format::jsonl},
    {".yaml", Format::yaml}, {".yml", Format::yaml},  {".path", Format::ompl},   {".txt", Format::ompl},
    {".npy", Format::numpy}, {".npz", Format::numpy}};

const std::vector<std::pair<const char*, Format>> kNames{{"csv", Format::csv},     {"json", Format::json},
                                                         {"jsonl", Format::jsonl}, {"yaml", Format::yaml},
                                                         {"ompl", Format::ompl},   {"numpy", Format::numpy}};

const std::pair<const char*, Format>* endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto found =
      std::find_if(kEndings.begin(), kEndings.end(), [&](const auto& known) { return ending == known.first; });
  return found == kEndings.end() ? nullptr : &*found;
}

std::vector<Plan> parseLines(const KinematicTree& tree, std::string_view content) {
  std::vector<Plan> out;
  for (int number = 1; !content.empty(); ++number) {
    const std::size_t end = std::min(content.find('\n'), content.size());
    const std::string_view line = content.substr(0, end);
    content.remove_prefix(std::min(end + 1, content.size()));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const std::string label = fmt::format("line {}", number);
    try {
      readDocument(tree, parseJson(line), label, out);
    } catch (const std::invalid_argument& error) {
      out.emplace_back().name = label;
      out.back().error = error.what();
    }
  }
  return out;
}

std::vector<Plan> parseStream(const KinematicTree& tree, std::string_view content) {
  std::vector<Plan> out;
  const std::vector<Json> documents = parseYaml(content);
  for (std::size_t i = 0; i < documents.size(); ++i) {
    if (documents[i].is_null()) continue;  // after the last ---
    readDocument(tree, documents[i], documents.size() > 1 ? fmt::format("document {}", i) : "", out);
  }
  return out;
}

/// Comments of CSV and YAML: from a # at a line's begin, or after a blank or a quote, on. (Within a text it may be
/// none.)
void keepUnitsOfComments(std::string_view content, std::vector<Plan>& plans) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF", kBefore = " \t\r\"";
  if (content.substr(0, kMark.size()) == kMark) content.remove_prefix(kMark.size());
  Plan found;
  for (int line = 1; !content.empty(); ++line) {
    const std::size_t end = std::min(content.find('\n'), content.size());
    const std::string_view text = content.substr(0, end);
    content.remove_prefix(std::min(end + 1, content.size()));
    std::size_t begin = text.find('#');
    while (begin != text.npos && begin > 0 && kBefore.find(text[begin - 1]) == text.npos)
      begin = text.find('#', begin + 1);
    if (begin == text.npos) continue;
    keepUnits(text.substr(begin), line, found);
  }
  for (Plan& plan : plans) {
    if (plan.other_angles.empty()) plan.other_angles = found.other_angles;
    if (plan.other_units.empty()) plan.other_units = found.other_units;
  }
}

}  // namespace

void keepUnits(std::string_view text, int line, Plan& plan) {
  const auto keep = [&](std::string& kept) {
    constexpr std::size_t kMax = 80;
    const std::string shown = text::oneLine(text.substr(0, text.find_last_not_of(" \t\r") + 1).substr(0, kMax));
    if (kept.empty()) kept = fmt::format("line {} says '{}'", line, shown);
  };
  if (text::speaksOfOtherAngles(text)) keep(plan.other_angles);
  if (text::speaksOfOtherLengthsOrTimes(text)) keep(plan.other_units);
}

std::vector<std::string> notesOf(const Plan& plan, bool degrees) {
  std::vector<std::string> notes = plan.notes;
  if (!degrees && !plan.other_angles.empty()) {
    notes.push_back(
        plan.other_angles +
        ": angles are taken in rad, unless a value itself ends with deg (certify --degrees takes all in degrees)");
  }
  if (!plan.other_units.empty()) notes.push_back(plan.other_units + ": lengths are taken in m, and times in s");
  return notes;
}

bool hasPlanEnding(const std::string& path) {
  return endingOf(path) != nullptr;
}

Format formatOf(const std::string& path) {
  if (const auto* ending = endingOf(path)) return ending->second;
  std::string known;
  for (const auto& ending : kEndings) known += std::string(known.empty() ? "" : ", ") + ending.first;
  throw std::invalid_argument(fmt::format("'{}': its ending is none of {}; --format says what it is", path, known));
}

Format formatNamed(const std::string& name) {
  for (const auto& format : kNames) {
    if (name == format.first) return format.second;
  }
  throw std::invalid_argument(fmt::format("'{}' is no format of plans", name));
}

std::vector<Plan> parsePlans(const KinematicTree& tree, std::string_view content, Format format,
                             const ColumnOptions& columns) {
  std::vector<Plan> out;
  switch (format) {
    case Format::csv:
      out.push_back(parseCsv(tree, content, columns));
      break;
    case Format::json:
      readDocument(tree, parseJson(content), "", out);
      break;
    case Format::jsonl:
      out = parseLines(tree, content);
      break;
    case Format::yaml:
      out = parseStream(tree, content);
      break;
    case Format::ompl:
      out.push_back(parseOmplPath(content));
      break;
    case Format::numpy:
      out = content.substr(0, 2) == "PK" ? parseArchive(content) : parseArray(content);
      break;
  }
  if (format == Format::csv || format == Format::yaml) keepUnitsOfComments(content, out);
  // A part of a file in these formats may look whole, though its last number has lost digits.
  const bool text = format == Format::csv || format == Format::yaml || format == Format::ompl;
  if (text && !content.empty() && std::string_view("\n]}").find(content.back()) == std::string_view::npos) {
    for (Plan& plan : out) plan.notes.emplace_back("the last line has no line end: the file may be cut short");
  }
  if (out.empty()) throw std::invalid_argument("there is no plan in it");
  return out;
}

}  // namespace fcl_artic::plans
