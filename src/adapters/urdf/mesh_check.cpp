// SPDX-License-Identifier: BSD-3-Clause
// assimp takes what is left of an STL, PLY or OFF file that was cut short for the whole of it, or goes down over it.
// What these formats say of their own length is looked at before.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string_view>

#include "detail.h"
#include "triangle_soup.h"

namespace fcl_artic::detail {
namespace {

bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

/// Words of a text, one after another.
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
  /// The rest of this line.
  std::string_view line() {
    const std::size_t begin = at_, end = std::min(text_.find('\n', at_), text_.size());
    at_ = std::min(end + 1, text_.size());
    return text_.substr(begin, end - begin);
  }
  bool atEnd() const { return at_ >= text_.size(); }
  std::string_view rest() const { return text_.substr(at_); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// @return false unless all of the word is a count that fits.
bool toCount(std::string_view word, std::uint64_t& count) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  return !word.empty() && error == std::errc() && end == word.data() + word.size() && count < (std::uint64_t{1} << 40);
}

void checkStl(std::string_view content, const std::string& where) {
  constexpr std::size_t kHead = 84, kTriangle = 50;
  if (content.size() >= kHead) {
    std::uint32_t triangles = 0;
    std::memcpy(&triangles, content.data() + 80, sizeof triangles);
    const std::uint64_t wanted = kHead + kTriangle * std::uint64_t{triangles};
    if (isBinaryStl(content)) return;
    if (!startsWith(content, "solid")) {
      fail(where, "is cut short or no STL: its head says " + std::to_string(triangles) + " triangles, which are " +
                      std::to_string(wanted) + " bytes, it has " + std::to_string(content.size()));
    }
  }
  Words words(content);
  if (words.next() != "solid") fail(where, "is cut short or no STL");
  words.line();
  bool closed = false;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    closed = word == "endsolid";
    if (word == "endsolid" || word == "solid") {
      words.line();
      continue;
    }
    if (word != "facet") fail(where, "is cut short or broken between facets");
    // facet normal x y z  outer loop  3 times: vertex x y z  endloop endfacet
    static constexpr const char* kFacet[] = {"normal", "", "", "",       "outer",   "loop",    "vertex",
                                             "",       "", "", "vertex", "",        "",        "",
                                             "vertex", "", "", "",       "endloop", "endfacet"};
    for (const char* expected : kFacet) {
      word = words.next();
      if (word.empty() || (*expected && word != expected)) fail(where, "is cut short or broken within a facet");
    }
  }
  if (!closed) fail(where, "is cut short: there is no 'endsolid'");
}

struct PlyProperty {
  std::size_t count_size = 0;  ///< of a list: bytes of its count
  std::size_t size = 0;        ///< bytes of a value
};
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

std::size_t plySize(std::string_view type) {
  static constexpr struct {
    const char* name;
    std::size_t size;
  } kTypes[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
                {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
                {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& t : kTypes) {
    if (type == t.name) return t.size;
  }
  return 0;
}

void checkPly(std::string_view content, const std::string& where) {
  Words words(content);
  const auto refuse = [&](const std::string& reason) { fail(where, reason); };
  if (words.next() != "ply") refuse("is no PLY");
  words.line();
  std::vector<PlyElement> elements;
  std::string format;
  for (;;) {
    if (words.atEnd()) refuse("is cut short or broken within its head");
    Words line(words.line());
    const std::string_view key = line.next();
    if (key == "end_header") break;
    if (key == "format") format = line.next();
    if (key == "element") {
      PlyElement& element = elements.emplace_back();
      element.name = line.next();
      if (!toCount(line.next(), element.count)) refuse("does not say how many '" + element.name + "' it has");
      // Of a strip assimp reads the first triangle.
      if (element.name == "tristrips" && element.count) refuse("has triangle strips: save it with faces");
    }
    if (key == "property") {
      if (elements.empty()) refuse("has a property of no element");
      PlyProperty property;
      std::string_view type = line.next();
      if (type == "list") {
        property.count_size = plySize(line.next());
        type = line.next();
        if (property.count_size == 0) refuse("has a property of an unknown type");
      }
      property.size = plySize(type);
      if (property.size == 0) refuse("has a property of an unknown type");
      elements.back().properties.push_back(property);
    }
  }
  const bool ascii = format == "ascii", big = format == "binary_big_endian";
  if (!ascii && !big && format != "binary_little_endian") refuse("is of an unknown format '" + format + "'");
  std::string_view bytes = words.rest();
  const auto cut = [&](const PlyElement& e, std::uint64_t i) {
    refuse("is cut short or broken: its head says " + std::to_string(e.count) + " of '" + e.name + "', number " +
           std::to_string(i) + " isn't there");
  };
  for (const PlyElement& e : elements) {
    if (e.properties.empty() && e.count > 0) refuse("has an element '" + e.name + "' without properties");
    for (std::uint64_t i = 0; i < e.count; ++i) {
      for (const PlyProperty& property : e.properties) {
        std::uint64_t values = 1;
        if (ascii) {
          if (property.count_size > 0 && !toCount(words.next(), values)) cut(e, i);
          for (std::uint64_t k = 0; k < values; ++k) {
            if (words.next().empty()) cut(e, i);
          }
          continue;
        }
        if (property.count_size > 0) {
          if (bytes.size() < property.count_size) cut(e, i);
          values = 0;
          for (std::size_t k = 0; k < property.count_size; ++k) {
            const std::size_t from = big ? k : property.count_size - 1 - k;
            values = values << 8 | static_cast<unsigned char>(bytes[from]);
          }
          bytes.remove_prefix(property.count_size);
        }
        if (bytes.size() / property.size < values) cut(e, i);
        bytes.remove_prefix(property.size * static_cast<std::size_t>(values));
      }
    }
  }
}

void checkOff(std::string_view content, const std::string& where) {
  Words words(content);
  const auto nextLine = [&](const char* what) {  // that is neither empty nor a comment
    while (!words.atEnd()) {
      const std::string_view line = words.line();
      const std::string_view first = Words(line).next();
      if (!first.empty() && first[0] != '#') return line;
    }
    fail(where, std::string("is cut short: it ends before its last ") + what);
  };
  Words head(nextLine("line"));
  std::string_view word = head.next();
  if (word.size() >= 3 && word.substr(word.size() - 3) == "OFF") {
    word = head.next();
    if (word.empty()) {
      head = Words(nextLine("line"));
      word = head.next();
    }
  }
  std::uint64_t vertices = 0, faces = 0;
  if (!toCount(word, vertices) || !toCount(head.next(), faces)) fail(where, "is no OFF, or does not say its size");
  for (std::uint64_t i = 0; i < vertices; ++i) {
    Words line(nextLine("vertex"));
    line.next(), line.next();
    if (line.next().empty()) fail(where, "is cut short or broken at vertex " + std::to_string(i));
  }
  for (std::uint64_t i = 0; i < faces; ++i) {
    Words line(nextLine("face"));
    std::uint64_t corners = 0;
    bool good = toCount(line.next(), corners);
    for (std::uint64_t k = 0; good && k < corners; ++k) {
      std::uint64_t index = 0;
      good = toCount(line.next(), index) && index < vertices;
    }
    if (!good) fail(where, "is cut short or broken at face " + std::to_string(i));
    // assimp leaves out others, in silence, and may go down over them.
    if (corners < 1 || corners > 9) {
      fail(where, "face " + std::to_string(i) + " has " + std::to_string(corners) +
                      " corners: 1 to 9 are read; cut it into triangles");
    }
  }
}

/// assimp takes a fan of triangles for a polygon, and cuts it elsewhere.
void checkCollada(std::string_view content, const std::string& where) {
  if (content.find("<trifans") != content.npos) fail(where, "has fans of triangles: save it with triangles");
}

}  // namespace

void requireWholeMesh(std::string_view content, const std::string& ending, const std::string& where) {
  if (ending == ".stl") return checkStl(content, where);
  if (ending == ".ply") return checkPly(content, where);
  if (ending == ".off") return checkOff(content, where);
  if (ending == ".dae") return checkCollada(content, where);
}

}  // namespace fcl_artic::detail
