// SPDX-License-Identifier: BSD-3-Clause
// STL, binary and text.
#include <cstdint>
#include <cstring>

#include "meshes/readers.h"
#include "meshes/text.h"

namespace fcl_artic::meshes {
namespace {

// A binary STL holds 80 bytes of anything, a count, and for each triangle a normal, three corners and two bytes of
// anything. Its numbers are little-endian, as this machine's are.
constexpr std::size_t kStlHead = 84, kStlTriangle = 50, kStlNormal = 12;

std::uint32_t stlTriangles(std::string_view content) {
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, content.data() + kStlHead - sizeof triangles, sizeof triangles);
  return triangles;
}

std::uint64_t stlBytes(std::string_view content) {
  return kStlHead + kStlTriangle * std::uint64_t{stlTriangles(content)};
}

void addStlTriangle(TriangleSoup& soup) {
  const std::size_t n = soup.vertices.size();
  soup.triangles.emplace_back(n - 3, n - 2, n - 1);
}

TriangleSoup readBinaryStl(const Source& source) {
  const std::string_view content = source.content, head = content.substr(0, 80);
  noteComment(source, head.substr(0, head.find('\0')));  // as UNITS=mm
  const std::size_t count = stlTriangles(content);
  TriangleSoup soup;
  soup.vertices.reserve(3 * count);
  soup.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    float corners[9];
    std::memcpy(corners, content.data() + kStlHead + t * kStlTriangle + kStlNormal, sizeof corners);
    for (const float* x : {corners, corners + 3, corners + 6}) soup.vertices.emplace_back(x[0], x[1], x[2]);
    addStlTriangle(soup);
  }
  return soup;
}

bool isKeyword(std::string_view word, std::string_view keyword) {
  if (word.size() != keyword.size()) return false;
  for (std::size_t k = 0; k < word.size(); ++k) {
    if ((word[k] >= 'A' && word[k] <= 'Z' ? word[k] - 'A' + 'a' : word[k]) != keyword[k]) return false;
  }
  return true;
}

/// A solid's line holds its name, which may be any words. If facets follow on the same line, nothing shows where the
/// name ends.
void passName(Words& words, const Source& source) {
  Words name(words.line());
  std::string_view last;
  for (std::string_view word = name.next(); !word.empty(); last = word, word = name.next()) {
    const bool facet = isKeyword(last, "facet") && isKeyword(word, "normal");
    if (facet || isKeyword(word, "solid") || isKeyword(word, "endsolid")) {
      source.refuse("has " + shown(word) + " within the name of a solid: each solid, facet and end begins a line");
    }
  }
}

// solid NAME; facets; endsolid NAME: once or more. A facet: facet normal x y z  outer loop  3 times: vertex x y z
// endloop endfacet. Keywords in small or capital letters.
TriangleSoup readTextStl(const Source& source) {
  TriangleSoup soup;
  Words words(withoutMark(source));
  const auto expect = [&](const char* keyword) {
    if (!isKeyword(words.next(), keyword)) source.refuse("is cut short or broken within a facet");
  };
  bool open = false, any = false;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const bool begins = isKeyword(word, "solid"), ends = isKeyword(word, "endsolid");
    if (begins || ends) {
      if (open == begins) source.refuse(begins ? "has a solid within a solid" : "has an 'endsolid' after no solid");
      open = begins;
      any = true;
      passName(words, source);
      continue;
    }
    if (!any) source.refuse("is cut short or no STL");
    if (!isKeyword(word, "facet")) source.refuse("is cut short or broken between facets, at " + shown(word));
    if (!open) source.refuse("has a facet outside of its solids");
    expect("normal");
    for (int k = 0; k < 3; ++k) words.next();
    expect("outer");
    expect("loop");
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      Eigen::Vector3d& x = soup.vertices.emplace_back();
      for (double& coordinate : x) {
        const std::string_view number = words.next();
        if (!toNumber(number, coordinate)) source.refuse(shown(number) + " of a vertex is not a finite number");
      }
    }
    expect("endloop");
    expect("endfacet");
    addStlTriangle(soup);
  }
  if (!any) source.refuse("is cut short or no STL");
  if (open) source.refuse("is cut short: there is no 'endsolid'");
  return soup;
}

/// A text's length may happen to be the one that four bytes of its first line give as a binary file's.
bool isText(const Source& source) {
  try {
    readTextStl(source);
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

}  // namespace

TriangleSoup readStl(const Source& source) {
  const std::string_view content = source.content;
  const bool has_head = content.size() >= kStlHead;
  const bool says_text = isKeyword(Words(withoutMark(source)).next(), "solid");
  if (has_head && content.size() == stlBytes(content)) {
    if (says_text && isText(source)) source.refuse("can be read as text and as binary");
    return readBinaryStl(source);
  }
  if (has_head && !says_text) {
    source.refuse("is cut short or no STL: its head says " + std::to_string(stlTriangles(content)) +
                  " triangles, which are " + std::to_string(stlBytes(content)) + " bytes, it has " +
                  std::to_string(content.size()));
  }
  return readTextStl(source);
}

}  // namespace fcl_artic::meshes
