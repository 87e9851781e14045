// SPDX-License-Identifier: BSD-3-Clause
// Names in messages: of those that exist, the one that a mistyped name most likely stands for.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_artic::text {

/// The fewest letters to add, take away, replace or swap with the next one that make `a` of `b`; capitals are as good
/// as small letters. (Optimal string alignment, by rows.)
inline std::size_t editDistance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last;
    last = row;
  }
  return last[b.size()];
}

/// The name that `typed` most likely stands for: one that differs in no more than a letter of each four. Else it is
/// the only one that holds all of `typed`, of three letters or more ("elbow" for "elbow_joint"). Empty where there is
/// none.
inline std::string nearestName(std::string_view typed, const std::vector<std::string>& names) {
  constexpr std::size_t kLettersPerSlip = 4, kShortestPart = 3;
  std::string nearest, around;
  std::size_t fewest = std::max<std::size_t>(1, typed.size() / kLettersPerSlip) + 1, holders = 0;
  if (typed.size() < 2) fewest = 1;  // of one letter all others are one away
  for (const std::string& name : names) {
    if (const std::size_t slips = editDistance(typed, name); slips < fewest) {
      fewest = slips;
      nearest = name;
    }
    if (typed.size() >= kShortestPart && name.find(typed) != std::string::npos) {
      ++holders;
      around = name;
    }
  }
  return !nearest.empty() || holders != 1 ? nearest : around;
}

/// "; did you mean 'NAME'?", to end a message with; empty where no name is near.
inline std::string didYouMean(std::string_view typed, const std::vector<std::string>& names) {
  const std::string nearest = nearestName(typed, names);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

}  // namespace fcl_artic::text
