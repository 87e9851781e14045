// SPDX-License-Identifier: BSD-3-Clause
#include "meshes/text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>

#include "text/units.h"

namespace fcl_artic::meshes {
namespace {

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view withoutSign(std::string_view word) {
  if (!word.empty() && (word[0] == '+' || word[0] == '-')) word.remove_prefix(1);
  return word;
}

/// digits [. digits] [e [sign] digits], with a digit before or after the point.
bool isDecimal(std::string_view word) {
  std::size_t at = 0;
  const auto passDigits = [&] {
    const std::size_t begin = at;
    while (at < word.size() && isDigit(word[at])) ++at;
    return at - begin;
  };
  std::size_t digits = passDigits();
  if (at < word.size() && word[at] == '.') {
    ++at;
    digits += passDigits();
  }
  if (digits == 0) return false;
  if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
    ++at;
    if (at < word.size() && (word[at] == '+' || word[at] == '-')) ++at;
    if (passDigits() == 0) return false;
  }
  return at == word.size();
}

/// Whether a decimal number is 1 or more: then its first digit that is not 0 stands before the point.
bool isOneOrMore(std::string_view word) {
  const std::size_t e = std::min(word.find_first_of("eE"), word.size());
  const std::string_view mantissa = word.substr(0, e);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t first = mantissa.find_first_not_of("0.");
  if (first == mantissa.npos) return false;
  const auto places =
      first < point ? static_cast<long long>(point - first) : -static_cast<long long>(first - point - 1);
  long long exponent = 0;
  if (e < word.size()) {
    std::string_view digits = word.substr(e + 1);
    const bool small = digits[0] == '-';
    digits = withoutSign(digits);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    constexpr long long kMax = std::numeric_limits<long long>::max() / 2;  // no file has that many digits
    if (error == std::errc::result_out_of_range || exponent > kMax) exponent = kMax;
    if (small) exponent = -exponent;
  }
  return places + exponent > 0;
}

}  // namespace

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool isLineEnd(char c) {
  return c == '\n' || c == '\r';
}
bool isSpace(char c) {
  return isBlank(c) || isLineEnd(c);
}

bool toNumber(std::string_view word, double& value) {
  const std::string_view digits = withoutSign(word);
  if (!isDecimal(digits)) return false;
  const bool negative = word[0] == '-';
  double size = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), size);
  // Outside of the range of doubles `size` is not set: the number is too large, or nearer to 0 than to any other
  // double.
  if (error == std::errc::result_out_of_range) {
    if (isOneOrMore(digits)) return false;
    size = 0;
  }
  value = negative ? -size : size;
  return true;
}

bool toCoordinate(std::string_view word, double& value) {
  if (toNumber(word, value)) return true;
  const std::string_view name = withoutSign(word);
  const auto is = [&](std::string_view other) {
    return std::equal(name.begin(), name.end(), other.begin(), other.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (is("nan")) {
    value = std::numeric_limits<double>::quiet_NaN();
  } else if (is("inf") || is("infinity")) {
    value = word[0] == '-' ? -kInfinity : kInfinity;
  } else {
    return false;
  }
  return true;
}

bool toCount(std::string_view word, std::uint64_t& count) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  return !word.empty() && error == std::errc() && end == word.data() + word.size() && count < (std::uint64_t{1} << 40);
}

std::string_view withoutMark(const Source& source) {
  const std::string_view start = source.content.substr(0, 2);
  if (start == "\xFE\xFF" || start == "\xFF\xFE") source.refuse("is a text of UTF-16: save it as UTF-8");
  return source.content.substr(source.content.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0);
}

void noteOpenEnd(const Source& source) {
  if (source.content.empty() || isLineEnd(source.content.back())) return;
  source.note("its last line has no line end: the file may be cut short");
}

void noteComment(const Source& source, std::string_view line) {
  std::string letters;
  for (const char c : line) {
    const char low = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    // Numbers stay whole words: a place has three of them.
    letters += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+' ? low : ' ';
  }
  Words words(letters);
  bool metres = false, units = false, place = false;
  std::size_t numbers = 0, others_than_0 = 0;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    double value = 0;
    numbers += toNumber(word, value);
    others_than_0 += value != 0;
    while (!word.empty() && !std::isalnum(static_cast<unsigned char>(word.back()))) word.remove_suffix(1);
    metres = metres || isOneOf(word, {"m", "meter", "meters", "metre", "metres"});
    units = units || word.substr(0, 4) == "unit" || text::isOtherLength(word);
    place = place || isOneOf(word, {"offset", "shift", "translation", "translate", "origin"});
  }
  if (units && !metres) source.note("says " + shown(line) + ": lengths are taken for metres, unless a scale says else");
  if (place && numbers >= 3 && others_than_0 > 0)
    source.note("says " + shown(line) + ", which is not applied: places are taken as they stand");
}

void noteComments(const Source& source) {
  for (std::string_view text = source.content; !text.empty();) {
    const std::string_view line = text.substr(0, std::min(text.find_first_of("\n\r"), text.size()));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::string_view key = Words(line).next();
    if (key.substr(0, 1) == "#" || isOneOf(key, {"comment", "obj_info", "solid"})) noteComment(source, line);
  }
}

bool Lines::next() {
  while (!text_.empty()) {
    line_ = take();
    is_joined_ = goesOn(line_);
    if (is_joined_) {
      joined_.clear();
      std::string_view part = line_;
      for (; goesOn(part); part = take()) joined_.append(part.substr(0, part.find_last_of('\\'))).push_back(' ');
      line_ = joined_.append(part);
    }
    line_ = line_.substr(0, commentOf(line_));
    while (!line_.empty() && isBlank(line_.front())) line_.remove_prefix(1);
    if (!line_.empty()) return true;
  }
  return false;
}

std::string_view Lines::word() {
  std::size_t length = 0;
  while (length < line_.size() && !isBlank(line_[length])) ++length;
  const std::string_view word = line_.substr(0, length);
  line_.remove_prefix(length);
  while (!line_.empty() && isBlank(line_.front())) line_.remove_prefix(1);
  return word;
}

double Lines::number() {
  const std::string_view text = word();
  double value = 0;
  if (!toNumber(text, value)) refuse(shown(text) + " is not a finite number");
  return value;
}

std::uint64_t Lines::count(const std::string& what) {
  const std::string_view text = word();
  std::uint64_t value = 0;
  if (!toCount(text, value)) refuse(shown(text) + " is no number of " + what);
  return value;
}

void Lines::end() {
  if (!line_.empty()) refuse("goes on where it should end: " + shown(line_));
}

void Lines::refuse(const std::string& reason) const {
  source_.refuse("line " + std::to_string(number_) + ": " + reason);
}

std::size_t Lines::commentOf(std::string_view line) const {
  // Within a word the sign begins no comment: some C libraries print 1.#INF and 1.#QNAN, which would become 1.
  std::size_t at = comment_ ? line.find(comment_) : line.npos;
  while (at != line.npos && at > 0 && !isBlank(line[at - 1])) at = line.find(comment_, at + 1);
  return at;
}

std::string_view Lines::take() {
  std::size_t end = 0;
  while (end < text_.size() && !isLineEnd(text_[end])) ++end;
  const std::string_view line = text_.substr(0, end);
  const bool both = text_.substr(end, 2) == "\r\n";
  text_.remove_prefix(std::min(end + (both ? 2 : 1), text_.size()));
  ++number_;
  return line;
}

bool Lines::goesOn(std::string_view line) const {
  if (continued_ == Continued::no) return false;
  while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
  return !line.empty() && line.back() == '\\' && !text_.empty() && commentOf(line) == line.npos;
}

}  // namespace fcl_artic::meshes
