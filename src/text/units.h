// SPDX-License-Identifier: BSD-3-Clause
// Words for units other than metre, radian and second, in what people write beside numbers.
#pragma once

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <string_view>

#include "text/utf8.h"

namespace fcl_artic::text {

/// Whether a word in small letters names a unit of length other than the metre.
inline bool isOtherLength(std::string_view word) {
  static constexpr std::string_view kWords[] = {"mm",   "millimeter", "millimeters", "millimetre", "millimetres",
                                                "cm",   "centimeter", "centimeters", "centimetre", "centimetres",
                                                "inch", "inches",     "foot",        "feet"};
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

/// Whether a word in small letters names a unit of time other than the second.
inline bool isOtherTime(std::string_view word) {
  static constexpr std::string_view kWords[] = {"ms",           "msec",        "msecs",        "millisecond",
                                                "milliseconds", "microsecond", "microseconds", "nanosecond",
                                                "nanoseconds",  "nsec",        "nsecs"};
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

/// Whether a word in small letters names a unit of angles other than the radian.
inline bool isOtherAngle(std::string_view word) {
  static constexpr std::string_view kWords[] = {"deg",  "degs",  "degree",      "degrees", "grad",
                                                "gons", "grads", "revolutions", "revs"};
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

/// Whether a word of the text, of letters only, is one of those.
template <class IsOne>
bool holdsWord(std::string_view text, const IsOne& is_one) {
  std::string word;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const auto c = static_cast<unsigned char>(i < text.size() ? text[i] : ' ');
    if (c < 0x80 && std::isalpha(c)) {
      word += static_cast<char>(std::tolower(c));
    } else {
      if (is_one(std::string_view(word))) return true;
      word.clear();
    }
  }
  return false;
}

/// Whether a text speaks of angles in another unit than radians, by a word or the sign of degrees, in UTF-8 or Latin-1.
inline bool speaksOfOtherAngles(std::string_view text) {
  return holdsWord(text, isOtherAngle) || text.find(isUtf8(text) ? "\xC2\xB0" : "\xB0") != text.npos;
}

/// Whether a text speaks of lengths or times in other units than metres and seconds.
inline bool speaksOfOtherLengthsOrTimes(std::string_view text) {
  return holdsWord(text, isOtherLength) || holdsWord(text, isOtherTime);
}

}  // namespace fcl_artic::text
