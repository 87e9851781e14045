// SPDX-License-Identifier: BSD-3-Clause
// Wavefront OBJ. assimp's reader takes ".5" for a word, not a number, and with it leaves out coordinates or whole
// vertices in silence; it rounds to float, and keeps three vertices for each triangle.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <string_view>

#include "detail.h"
#include "triangle_soup.h"

namespace fcl_artic::detail {
namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// The lines of a file, one after another. A line that ends in a backslash goes on in the next one.
class Lines {
 public:
  Lines(std::string_view text, const std::string& where)
      : text_(text), where_(where), end_(text.find('\n') == text.npos ? '\r' : '\n') {}

  /// @return false at the end.
  bool next() {
    if (text_.empty()) return false;
    line_ = take();
    if (goesOn(line_)) {
      joined_.clear();
      std::string_view part = line_;
      for (; goesOn(part); part = take()) joined_.append(part.substr(0, part.find_last_of('\\'))).push_back(' ');
      line_ = joined_.append(part);
    }
    if (const auto comment = line_.find('#'); comment != line_.npos) line_ = line_.substr(0, comment);
    return true;
  }
  /// The next word of the line; empty at its end.
  std::string_view word() {
    while (!line_.empty() && isBlank(line_.front())) line_.remove_prefix(1);
    std::size_t length = 0;
    while (length < line_.size() && !isBlank(line_[length])) ++length;
    const std::string_view word = line_.substr(0, length);
    line_.remove_prefix(length);
    return word;
  }
  [[noreturn]] void refuse(const std::string& reason) const {
    fail(where_, "line " + std::to_string(number_) + ": " + reason);
  }

 private:
  std::string_view take() {
    const std::size_t end = std::min(text_.find(end_), text_.size());
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    return line;
  }
  /// A comment never does: one may end in a folder's name.
  bool goesOn(std::string_view line) const {
    while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
    return !line.empty() && line.back() == '\\' && !text_.empty() && line.find('#') == line.npos;
  }

  std::string_view text_, line_;
  const std::string& where_;
  const char end_;  ///< of a line; old ones end in a carriage return alone
  std::string joined_;
  std::size_t number_ = 0;
};

double toNumber(std::string_view word, const Lines& lines) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);  // from_chars takes no plus
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = !digits.empty() && end == digits.data() + digits.size();
  if (whole && error == std::errc::result_out_of_range) {  // the nearest double of 1e-400 is 0, of 1e400 none
    value = std::strtod(std::string(digits).c_str(), nullptr);
    if (std::abs(value) < 1) return value;
  }
  if (!whole || error != std::errc() || !std::isfinite(value)) {
    lines.refuse("'" + std::string(word) + "' is not a finite number");
  }
  return value;
}

/// The rest of a vertex's line: x y z, x y z w, or a colour after x y z.
Eigen::Vector3d readVertex(Lines& lines) {
  Eigen::Vector3d x;
  for (double& coordinate : x) coordinate = toNumber(lines.word(), lines);
  const std::string_view w = lines.word();
  if (w.empty() || !lines.word().empty()) return x;
  const double weight = toNumber(w, lines);
  if (weight == 0) lines.refuse("has a vertex of weight 0");
  return x / weight;
}

/// The vertex that a word such as "7", "7/1/3" or "-1" names, counted from 0.
/// @param before  vertices above the line, from which negative numbers count back.
std::size_t toIndex(std::string_view word, std::size_t before, std::size_t count, const Lines& lines) {
  const std::string_view digits = word.substr(0, word.find('/'));
  long long number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) {
    lines.refuse("'" + std::string(word) + "' names no vertex");
  }
  if (number > 0 && static_cast<unsigned long long>(number) <= count) return static_cast<std::size_t>(number) - 1;
  if (number < 0 && number >= -static_cast<long long>(before)) return before - static_cast<std::size_t>(-number);
  lines.refuse("has a face with vertex " + std::to_string(number) + " of " +
               std::to_string(number < 0 ? before : count));
}

/// What has no part in the surface: normals, textures, materials, groups, points and lines.
constexpr std::string_view kUnused[] = {"vt",     "vn",       "vp",       "g",          "s",        "o", "mg",
                                        "usemtl", "mtllib",   "usemap",   "maplib",     "l",        "p", "lod",
                                        "bevel",  "c_interp", "d_interp", "shadow_obj", "trace_obj"};

}  // namespace

TriangleSoup readObj(std::string_view content, const std::string& where, std::vector<std::string>* notes) {
  TriangleSoup soup;
  std::size_t unread = 0;
  // Vertices first: a face may name one that comes after it.
  for (Lines lines(content, where); lines.next();) {
    const std::string_view key = lines.word();
    if (key == "v") {
      soup.vertices.push_back(readVertex(lines));
    } else if (key == "curv" || key == "curv2" || key == "surf" || key == "cstype") {
      lines.refuse("has a free-form curve or surface: save it with polygons");
    } else if (!key.empty() && key != "f" &&
               std::find(std::begin(kUnused), std::end(kUnused), key) == std::end(kUnused)) {
      ++unread;
    }
  }
  std::size_t before = 0;  // vertices above the line
  std::vector<std::size_t> corners;
  for (Lines lines(content, where); lines.next();) {
    const std::string_view key = lines.word();
    before += key == "v";
    if (key != "f") continue;
    corners.clear();
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
      corners.push_back(toIndex(word, before, soup.vertices.size(), lines));
    }
    if (corners.empty()) lines.refuse("has a face without a corner");
    soup.addFace(corners.data(), corners.size(), where);
  }
  if (notes && unread > 0) {
    notes->push_back(where + ": " + std::to_string(unread) + (unread == 1 ? " line is" : " lines are") +
                     " none that OBJ files have and passed over");
  }
  return soup;
}

}  // namespace fcl_artic::detail
