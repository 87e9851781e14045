// SPDX-License-Identifier: BSD-3-Clause
#include "pair_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "files/files.h"

namespace fcl_artic::app {
namespace {

constexpr const char* kPairGroup = "Robot and scene";

std::string withoutBlanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

std::optional<std::pair<std::string, std::string>> twoBodies(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos) return std::nullopt;
  std::pair<std::string, std::string> names(withoutBlanks(text.substr(0, comma)),
                                            withoutBlanks(text.substr(comma + 1)));
  if (names.first.empty() || names.second.empty()) return std::nullopt;
  return names;
}

/// @param of_pair  whether it has to be one, or must not be; none: either.
PairSettings::Said readMargin(const std::string& where, const std::string& text, std::optional<bool> of_pair) {
  const char* const expected = !of_pair   ? "is not BODY=METRES or BODY,BODY=METRES"
                               : *of_pair ? "is not BODY,BODY=METRES"
                                          : "is not BODY=METRES";
  const auto refuse = [&] { throw std::invalid_argument(fmt::format("{}: '{}' {}", where, text, expected)); };
  PairSettings::Said said;
  said.where = where;
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) refuse();
  const std::string names = withoutBlanks(text.substr(0, equals)), number = withoutBlanks(text.substr(equals + 1));
  const char* const end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, said.margin);
  if (error != std::errc() || stop != end || !std::isfinite(said.margin)) refuse();
  if (said.margin < 0) throw std::invalid_argument(fmt::format("{}: '{}': a margin is at least 0", where, text));
  const bool pair = names.find(',') != std::string::npos;
  if (names.empty() || (of_pair && *of_pair != pair)) refuse();
  if (!pair) {
    said.a = names;
    return said;
  }
  const auto two = twoBodies(names);
  if (!two) refuse();
  std::tie(said.a, said.b) = std::minmax(two->first, two->second);
  return said;
}

std::vector<PairSettings::Said> readMarginsFile(const std::string& path) {
  std::vector<PairSettings::Said> out;
  std::istringstream in(files::read(path));
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string text = withoutBlanks(line.substr(0, line.find('#')));
    if (!text.empty()) out.push_back(readMargin(fmt::format("'{}' line {}", path, number), text, std::nullopt));
  }
  if (out.empty()) throw std::invalid_argument(fmt::format("--margins: '{}' has no line BODY=METRES", path));
  return out;
}

}  // namespace

void addPairOptions(CLI::App& verb, PairOptions& o) {
  verb.add_option("--margin-of", o.margins_of,
                  "A margin of a link's or obstacle's own, in m, in place of --margin; may be repeated")
      ->allow_extra_args(false)
      ->group(kPairGroup)
      ->type_name("BODY=METRES");
  verb.add_option("--margin-pair", o.pair_margins,
                  "A margin of a pair's own, in m, in place of all others: 0 where a base stands on its floor; may be "
                  "repeated")
      ->allow_extra_args(false)
      ->group(kPairGroup)
      ->type_name("BODY,BODY=METRES");
  verb.add_option("--margins", o.margins, "File of such margins: a line BODY=METRES or BODY,BODY=METRES each")
      ->check(CLI::ExistingFile)
      ->group(kPairGroup)
      ->type_name("FILE");
  verb.add_option("--allow", o.allowed,
                  "Two links or obstacles that may touch: they are not checked, and answers say so; may be repeated")
      ->allow_extra_args(false)
      ->group(kPairGroup)
      ->type_name("BODY,BODY");
  verb.add_option(
          "--disallow", o.disallowed,
          "Two links or obstacles that are checked though they are neighbours, an SRDF allows them, or they stand "
          "still against each other; may be repeated")
      ->allow_extra_args(false)
      ->group(kPairGroup)
      ->type_name("BODY,BODY");
}

PairSettings readPairSettings(const PairOptions& o) {
  PairSettings out;
  if (!o.margins.empty()) out.margins = readMarginsFile(o.margins);
  for (const std::string& text : o.margins_of) out.margins.push_back(readMargin("--margin-of", text, false));
  for (const std::string& text : o.pair_margins) out.margins.push_back(readMargin("--margin-pair", text, true));
  std::map<std::pair<std::string, std::string>, std::string> seen;
  for (const PairSettings::Said& said : out.margins) {
    const auto [at, is_new] = seen.try_emplace({said.a, said.b}, said.where);
    if (is_new) continue;
    throw std::invalid_argument(fmt::format("{}: '{}'{} has a margin already, by {}", said.where, said.a,
                                            said.b.empty() ? "" : " with '" + said.b + "'", at->second));
  }
  const auto readPairs = [](const char* option, const std::vector<std::string>& texts,
                            std::vector<PairSettings::Said>& to) {
    for (const std::string& text : texts) {
      const auto two = twoBodies(text);
      if (!two) throw std::invalid_argument(fmt::format("{}: '{}' is not BODY,BODY", option, text));
      to.push_back({option, std::min(two->first, two->second), std::max(two->first, two->second), 0});
    }
  };
  readPairs("--allow", o.allowed, out.allowed);
  readPairs("--disallow", o.disallowed, out.disallowed);
  for (const PairSettings::Said& said : out.disallowed) {
    const bool both = std::any_of(out.allowed.begin(), out.allowed.end(),
                                  [&](const PairSettings::Said& one) { return one.a == said.a && one.b == said.b; });
    if (both) throw std::invalid_argument(fmt::format("--allow and --disallow are of one pair: {},{}", said.a, said.b));
  }
  return out;
}

void PairSettings::apply(const Scene& scene, ArticulatedCollisionManager& manager) const {
  const auto bodiesOf = [&](const std::string& name) {
    std::vector<std::string> names = scene.namesOf(name);
    if (names.empty()) names.push_back(name);  // a link's, or nothing's
    return names;
  };
  const auto set = [&](const Said& said, const auto& change) {
    try {
      for (const std::string& a : bodiesOf(said.a)) {
        for (const std::string& b : said.b.empty() ? std::vector<std::string>{""} : bodiesOf(said.b)) change(a, b);
      }
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("{}: {}", said.where, error.what()));
    }
  };
  for (const Said& said : margins) {
    set(said, [&](const std::string& a, const std::string& b) {
      b.empty() ? manager.setMargin(a, said.margin) : manager.setMargin(a, b, said.margin);
    });
  }
  for (const Said& said : allowed) {
    set(said, [&](const std::string& a, const std::string& b) { manager.allow(a, b); });
  }
  for (const Said& said : disallowed) {
    set(said, [&](const std::string& a, const std::string& b) { manager.disallow(a, b); });
  }
}

std::string PairSettings::text() const {
  std::vector<std::string> lines;
  for (const Said& said : margins) lines.push_back(fmt::format("margin {}\n{}\n{:a}", said.a, said.b, said.margin));
  for (const Said& said : allowed) lines.push_back(fmt::format("allow {}\n{}", said.a, said.b));
  for (const Said& said : disallowed) lines.push_back(fmt::format("disallow {}\n{}", said.a, said.b));
  std::sort(lines.begin(), lines.end());
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

std::string startHint(const CertifiedContact& c) {
  const double gap = (c.nearest1 - c.nearest2).norm();
  const std::string &a = c.body1.name, &b = c.body2.name;
  if (c.certain && gap > 0) {
    return fmt::format(
        "'{}' and '{}' begin {:.3g} m apart, which is within their margin: if they stand so, --margin-pair "
        "{},{}=0 gives them one of their own",
        a, b, gap, a, b);
  }
  return fmt::format(
      "'{}' and '{}' touch from the start: if they may, as a base and its floor, --allow {},{} leaves them "
      "out, and --ignore-initial-contact until they part; nothing is known of what comes after",
      a, b, a, b);
}

}  // namespace fcl_artic::app
