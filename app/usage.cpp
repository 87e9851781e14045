// SPDX-License-Identifier: BSD-3-Clause
#include "usage.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "text/nearest_name.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;

std::optional<double> numberOf(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The verb, or the verb of a verb, that was typed last.
const CLI::App& verbOf(const CLI::App& program) {
  const std::vector<CLI::App*> verbs = program.get_subcommands();
  return verbs.empty() ? program : verbOf(*verbs.front());
}

}  // namespace

std::string requireNotNegative(const std::string& text) {
  const auto value = numberOf(text);
  return value && *value >= 0 ? "" : "'" + text + "' is not a number of at least 0, without a unit";
}

std::string requirePositive(const std::string& text) {
  const auto value = numberOf(text);
  return value && *value > 0 ? "" : "'" + text + "' is not a number above 0, without a unit";
}

std::string requireInput(const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error)) return {};
  std::vector<std::string> names;
  const fs::path folder = fs::path(path).parent_path();
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end; at.increment(error)) {
    names.push_back(at->path().filename().string());
  }
  std::sort(names.begin(), names.end());  // the same answer whatever their order on the disk
  const std::string near = text::nearestName(fs::path(path).filename().string(), names);
  return fmt::format("'{}': no such file{}", path,
                     near.empty() ? "" : fmt::format("; did you mean '{}'?", (folder / near).string()));
}

std::string requirePng(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending.empty() || ending == ".png") return {};
  return fmt::format("'{}': pictures are written as PNG; call it '{}'", path,
                     fs::path(path).replace_extension(".png").string());
}

std::string usageError(const CLI::App& program, const CLI::ParseError& error) {
  // CLI11 first reports a missing verb or option, and doesn't name the word that it did not know.
  const CLI::App& verb = verbOf(program);
  std::vector<std::string> unknown = program.remaining(true);
  const auto dashed = std::find_if(unknown.begin(), unknown.end(), [](const auto& word) { return word[0] == '-'; });
  if (unknown.empty()) return error.what();
  const bool in_verb = verb.get_parent() != nullptr;
  const std::string word = in_verb && dashed != unknown.end() ? *dashed : unknown.front();
  std::vector<std::string> known;
  for (const CLI::App* other : verb.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(other->get_name());
  }
  const bool verbs = !known.empty();
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  const std::string name = word.substr(0, word.find('='));
  return fmt::format("'{}' is {} of {}{}", name,
                     word[0] == '-' ? "no option"
                     : verbs        ? "neither a verb nor an option"
                                    : "not an argument",
                     in_verb ? "'" + verb.get_name() + "'" : verb.get_name(), text::didYouMean(name, known));
}

}  // namespace fcl_artic::app
