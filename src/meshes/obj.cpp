// SPDX-License-Identifier: BSD-3-Clause
// Wavefront OBJ: vertices and faces.
#include <algorithm>
#include <charconv>
#include <iterator>

#include "meshes/readers.h"
#include "meshes/text.h"

namespace fcl_artic::meshes {
namespace {

/// The rest of a vertex's line: x y z; x y z and the weight 1; x y z and a colour.
Eigen::Vector3d readVertex(Lines& lines) {
  Eigen::Vector3d x;
  for (double& coordinate : x) coordinate = lines.number();
  double more[4] = {1, 0, 0, 0};
  std::size_t count = 0;
  for (; !lines.rest().empty(); ++count) {
    if (count == std::size(more)) lines.refuse("a vertex goes on after a weight or a colour: " + shown(lines.rest()));
    more[count] = lines.number();
  }
  if (count == 2) lines.refuse("a vertex has five numbers");
  // By the specification a weight is for curves, and viewers pass over it; some programs divide by it.
  if ((count == 1 || count == 4) && more[0] != 1) {
    lines.refuse("a vertex has a fourth number that is not 1: readers differ on what it means");
  }
  return x;
}

/// @throws std::runtime_error unless the word may name a vertex.
void requireNumbers(std::string_view word, const Lines& lines) {
  if (word.find_first_not_of("-0123456789/") != word.npos) lines.refuse(shown(word) + " names no vertex");
}

/// The vertex that a word such as "7", "7/1/3" or "-1" names, counted from 0.
/// @param before  vertices above the line, from which negative numbers count back.
std::size_t toIndex(std::string_view word, std::size_t before, std::size_t count, const Lines& lines) {
  const std::string_view digits = word.substr(0, word.find('/'));
  requireNumbers(word, lines);
  long long number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) {
    lines.refuse(shown(word) + " names no vertex");
  }
  if (number > 0 && static_cast<unsigned long long>(number) <= count) return static_cast<std::size_t>(number) - 1;
  if (number < 0 && number >= -static_cast<long long>(before)) return before - static_cast<std::size_t>(-number);
  lines.refuse("has a face with vertex " + std::to_string(number) + " of " +
               std::to_string(number < 0 ? before : count));
}

/// Lines that do not change the surface: normals, textures, materials, groups, and how it is shown.
constexpr std::string_view kUnused[] = {"vt",       "vn",         "vp",        "g",      "s",    "o",     "mg",
                                        "usemtl",   "mtllib",     "usemap",    "maplib", "lod",  "bevel", "c_interp",
                                        "d_interp", "shadow_obj", "trace_obj", "ctech",  "stech"};
constexpr std::string_view kFreeForm[] = {"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                          "parm",   "trim", "hole", "scrv", "sp",   "end",   "con",
                                          "bsp",    "bzp",  "cdc",  "cdp",  "res"};

bool isFace(std::string_view key) {
  return key == "f" || key == "fo";  // fo: of versions before 3.0
}

}  // namespace

TriangleSoup readObj(const Source& source) {
  const std::string_view text = withoutMark(source);
  TriangleSoup soup;
  std::uint64_t vertices = 0, faces = 0, found = 0;  // that a first line says, as FCL's samples have one
  bool first = true, says = false;
  // Vertices first: a face may name one that comes after it.
  for (Lines lines(text, source, '#', Lines::Continued::yes); lines.next();) {
    const std::string_view key = lines.word();
    says = says || (first && toCount(key, vertices));
    if (says && first) {
      faces = lines.count("faces");
      lines.end();
    } else if (key == "v") {
      soup.vertices.push_back(readVertex(lines));
    } else if (key == "p" || key == "l") {
      ++(key == "p" ? soup.points : soup.lines);
      for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) requireNumbers(word, lines);
    } else if (isOneOf(key, kFreeForm)) {
      lines.refuse("has a free-form curve or surface (" + shown(key) + "): save it with polygons");
    } else if (key == "call" || key == "csh") {
      lines.refuse(shown(key) + " refers to another file or program: put all in one file");
    } else if (!isFace(key) && !isOneOf(key, kUnused)) {
      lines.refuse(shown(key) + " begins a line of no kind that OBJ files have");
    } else if (!isFace(key) && lines.joined()) {
      // The line holds a name, such as a folder's: readers differ on whether the next line belongs to it.
      lines.refuse("a line of " + shown(key) + " ends in a backslash, which would take in the next line");
    }
    found += isFace(key);
    first = false;
  }
  if (says && (vertices != soup.vertices.size() || faces != found)) {
    source.refuse("its first line says " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
                  " faces, it has " + std::to_string(soup.vertices.size()) + " and " + std::to_string(found));
  }
  std::size_t before = 0;  // vertices above the line
  std::vector<std::size_t> corners;
  for (Lines lines(text, source, '#', Lines::Continued::yes); lines.next();) {
    const std::string_view key = lines.word();
    before += key == "v";
    if (!isFace(key)) continue;
    corners.clear();
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
      corners.push_back(toIndex(word, before, soup.vertices.size(), lines));
    }
    if (corners.empty()) lines.refuse("has a face without a corner");
    soup.addFace(corners.data(), corners.size(), source);
  }
  noteOpenEnd(source);
  return soup;
}

}  // namespace fcl_artic::meshes
