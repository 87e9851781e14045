// SPDX-License-Identifier: BSD-3-Clause
#include "harness.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "changes.h"

namespace fcl_artic::test {
namespace {

std::string shown(const Item& item) {
  std::string out = item.what + ":";
  for (const double x : item.numbers) out += " " + std::to_string(x);
  return out;
}

/// The part that is not read as it was written; empty: none.
std::string differenceOf(const Reading& read, const Reading& written, double tolerance) {
  double size = 1;
  for (const Item& item : written) {
    for (const double x : item.numbers) size = std::max(size, std::abs(x));
  }
  for (std::size_t i = 0; i < std::max(read.size(), written.size()); ++i) {
    if (i >= read.size()) return "not read: " + shown(written[i]);
    if (i >= written.size()) return "not written: " + shown(read[i]);
    const Item &a = read[i], &b = written[i];
    bool same = a.what == b.what && a.numbers.size() == b.numbers.size();
    for (std::size_t k = 0; same && k < a.numbers.size(); ++k)
      same = std::abs(a.numbers[k] - b.numbers[k]) <= tolerance * size;
    if (!same) return "read as " + shown(a) + "\nwritten as " + shown(b);
  }
  return {};
}

/// Readings that a faulty reader would give.
const std::vector<std::pair<std::string, std::function<void(Reading&)>>>& faultsOfReadings() {
  static const std::vector<std::pair<std::string, std::function<void(Reading&)>>> all{
      {"drops the last one", [](Reading& r) { r.pop_back(); }},
      {"skips the first one", [](Reading& r) { r.erase(r.begin()); }},
      {"reads the last one twice", [](Reading& r) { r.push_back(r.back()); }},
      {"shifts an index",
       [](Reading& r) {
         for (std::size_t i = 0; i + 1 < r.size(); ++i) {
           if (r[i].numbers.size() == r[i + 1].numbers.size()) r[i].numbers = r[i + 1].numbers;
         }
       }},
      {"shifts columns",
       [](Reading& r) {
         std::vector<double>& n = r.back().numbers;
         if (!n.empty()) std::rotate(n.begin(), n.begin() + 1, n.end());
       }},
      {"forgets the last number",
       [](Reading& r) {
         if (!r.back().numbers.empty()) r.back().numbers.back() = 0;
       }},
      {"reads single precision", [](Reading& r) {
         for (Item& item : r) {
           for (double& x : item.numbers) x = static_cast<float>(x);
         }
       }}};
  return all;
}

bool same(const Reading& a, const Reading& b, double tolerance) {
  return differenceOf(a, b, 4 * tolerance).empty();
}

std::string withoutLast(const std::string& text, const std::string& pattern) {
  const std::regex of(pattern);
  std::ptrdiff_t at = -1, length = 0;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), of); match != std::sregex_iterator(); ++match) {
    at = match->position();
    length = match->length();
  }
  if (at < 0) return text;
  return text.substr(0, static_cast<std::size_t>(at)) + text.substr(static_cast<std::size_t>(at + length));
}

}  // namespace

Findings readRandomFiles(const FileFormat& format, int files, std::uint64_t seed, const std::string& folder) {
  Findings out;
  const auto put = [&](const std::string& name, const std::string& content) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  };
  for (int k = 0; k < files && out.wrong.empty(); ++k) {
    const std::uint64_t own_seed = seed + static_cast<std::uint64_t>(k);
    Random random(own_seed);
    const RandomFile file = format.write(random);
    for (const auto& [name, content] : file.more) put(name, content);
    const auto tell = [&](const std::string& what) {
      out.wrong =
          format.name + ", seed " + std::to_string(own_seed) + ": " + what + "\n" + file.content.substr(0, 4000);
    };
    Reading read;
    try {
      read = format.read(file, put(file.name, file.content));
      const std::string difference = differenceOf(read, file.reading, file.tolerance);
      if (!difference.empty()) tell(difference);
    } catch (const std::exception& error) {
      tell(std::string("refused: ") + error.what());
    }
    if (!out.wrong.empty()) return out;
    for (const auto& [name, spoil] : faultsOfReadings()) {
      Reading spoiled = read;
      if (!spoiled.empty()) spoil(spoiled);
      if (same(spoiled, read, file.tolerance)) continue;
      Seen& seen = out.faults[name];
      ++seen.files;
      seen.seen += !differenceOf(spoiled, file.reading, file.tolerance).empty();
    }
    for (const auto& [name, pattern] : format.faults) {
      RandomFile spoiled = file;
      spoiled.content = withoutLast(file.content, pattern);
      if (spoiled.content == file.content) continue;
      Seen& seen = out.faults[name];
      seen.of_file = true;
      ++seen.files;
      try {
        seen.seen +=
            !differenceOf(format.read(spoiled, put(file.name, spoiled.content)), file.reading, file.tolerance).empty();
      } catch (const std::exception&) {
        ++seen.seen;
      }
    }
    RandomFile changed = file;
    changed.content = changedFile(file.name, file.content, random);
    try {
      (void)format.read(changed, put(file.name, changed.content));
      ++out.changed_read;
    } catch (const std::out_of_range& error) {  // of an index that the reader has made
      tell(std::string("of changed structure: ") + error.what());
    } catch (const std::exception& error) {
      ++out.changed_refused;
      const std::string text = error.what();
      if (text.empty() || (format.errors_name_the_file && text.find(file.name) == text.npos))
        tell("an error does not name the file: " + text);
    }
  }
  return out;
}

const std::vector<FileFormat>& fileFormats() {
  static const std::vector<FileFormat> all = [] {
    std::vector<FileFormat> formats;
    addMeshFormats(formats);
    addRobotFormats(formats);
#ifdef FCL_ARTIC_PLAN_FILES
    addPlanFormats(formats);
#endif
    return formats;
  }();
  return all;
}

double randomNumber(Random& random, double lower, double upper) {
  const double x = lower + (upper - lower) * static_cast<double>(random() % 100001) / 100000;
  return std::round(x * 1000) / 1000;
}

}  // namespace fcl_artic::test
