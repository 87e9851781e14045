// SPDX-License-Identifier: BSD-3-Clause
// Lines, words and numbers of text files: one grammar for all formats.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>

#include "meshes/source.h"

namespace fcl_artic::meshes {

bool isBlank(char c);    ///< Within a line: space, tab, vertical tab, form feed.
bool isLineEnd(char c);  ///< Line feed or carriage return.
bool isSpace(char c);    ///< One of both.

template <class List = std::initializer_list<std::string_view>>
bool isOneOf(std::string_view word, const List& words) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// A decimal number, such as "-1.5e-3", ".5", "+1.", as the nearest double: 0 where it is too small for one.
/// @return false unless all of the word is one, and finite.
bool toNumber(std::string_view word, double& value);
/// The same, or "nan", "inf", "infinity" with a sign or without: coordinates of points that were not measured.
bool toCoordinate(std::string_view word, double& value);
/// A count: decimal digits. @return false unless all of the word is one, and below 2^40.
bool toCount(std::string_view word, std::uint64_t& count);

/// The text without a byte order mark of UTF-8. @throws std::runtime_error for marks of UTF-16.
std::string_view withoutMark(const Source& source);

/// Notes that a text does not end with a line: its last number may have lost digits.
void noteOpenEnd(const Source& source);
/// Notes a line that speaks of units other than metres, or of a shift by three numbers: nobody applies it.
void noteComment(const Source& source, std::string_view line);
/// Does so with all comments.
void noteComments(const Source& source);

/// The words of a text, over its line ends.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  /// Empty at the end.
  std::string_view next() {
    while (at_ < text_.size() && isSpace(text_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !isSpace(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  /// The rest of the line.
  std::string_view line() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !isLineEnd(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// The lines of a text file that are neither empty nor comments, one after another. Each ends in a line feed, a
/// carriage return, or both.
class Lines {
 public:
  /// Whether a line that ends in a backslash goes on in the next one. A comment never does: it may end in a folder's
  /// name.
  enum class Continued { no, yes };
  /// @param text  of the source, or a part of it. @param comment  begins one, up to the line's end, where it begins the
  ///   line or follows a blank; 0: nothing does.
  Lines(std::string_view text, const Source& source, char comment, Continued continued = Continued::no)
      : text_(text), source_(source), comment_(comment), continued_(continued) {}

  /// Goes to the next line. @return false at the end.
  bool next();
  /// The next word of the line; empty at its end.
  std::string_view word();
  /// The next word. @throws std::runtime_error unless it is a finite number.
  double number();
  /// The next word. @throws std::runtime_error unless it is a count. @param what  it counts, for the message.
  std::uint64_t count(const std::string& what);
  /// @throws std::runtime_error unless the line is at its end.
  void end();
  /// Whether the line went on in the next one.
  bool joined() const { return is_joined_; }
  /// The rest of the line.
  std::string_view rest() const { return line_; }
  /// @throws std::runtime_error naming file and line.
  [[noreturn]] void refuse(const std::string& reason) const;

 private:
  std::size_t commentOf(std::string_view line) const;  ///< Where it begins; npos where there is none.
  std::string_view take();
  bool goesOn(std::string_view line) const;

  std::string_view text_, line_;
  const Source& source_;
  const char comment_;
  const Continued continued_;
  std::string joined_;
  bool is_joined_ = false;
  std::size_t number_ = 0;
};

}  // namespace fcl_artic::meshes
