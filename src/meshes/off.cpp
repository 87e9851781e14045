// SPDX-License-Identifier: BSD-3-Clause
// OFF of Geomview, as text: a vertex, then a face, a line.
#include <algorithm>

#include "meshes/readers.h"
#include "meshes/text.h"

namespace fcl_artic::meshes {
namespace {

/// The values that a vertex's line holds beside its place.
struct OffHead {
  bool texture = false, colour = false, normal = false;
};

/// [ST][C][N]OFF. @return false for another word.
bool readKeyword(std::string_view word, OffHead& head) {
  if (word.size() < 3 || word.substr(word.size() - 3) != "OFF") return false;
  word.remove_suffix(3);
  const auto take = [&](std::string_view start) {
    const bool has = word.substr(0, start.size()) == start;
    if (has) word.remove_prefix(start.size());
    return has;
  };
  head.texture = take("ST");
  head.colour = take("C");
  head.normal = take("N");
  return word.empty();
}

std::size_t passNumbers(Lines& lines) {
  std::size_t count = 0;
  for (; !lines.rest().empty(); ++count) lines.number();
  return count;
}

}  // namespace

TriangleSoup readOff(const Source& source) {
  Lines lines(withoutMark(source), source, '#');
  const auto next = [&](const char* what) {
    if (!lines.next()) source.refuse(std::string("is cut short: it ends before its last ") + what);
  };
  next("line");
  OffHead head;
  const std::string_view first =
      lines.rest().substr(0, std::min(lines.rest().find_first_of(" \t"), lines.rest().size()));
  if (first.find_first_not_of("0123456789") != first.npos) {
    if (!readKeyword(lines.word(), head)) {
      source.refuse("begins with " + shown(first) +
                    ": OFF with ST, C or N before it is read, of 3 dimensions, as text");
    }
    if (lines.rest() == "BINARY") source.refuse("is a binary OFF: save it as text");
    if (lines.rest().empty()) next("line");
  }
  const std::uint64_t vertices = lines.count("vertices"), faces = lines.count("faces");
  if (!lines.rest().empty()) lines.count("edges");
  lines.end();

  TriangleSoup soup;
  for (std::uint64_t i = 0; i < vertices; ++i) {
    next("vertex");
    Eigen::Vector3d& x = soup.vertices.emplace_back();
    for (double& coordinate : x) coordinate = lines.number();
    const std::size_t more = passNumbers(lines), fixed = (head.normal ? 3 : 0) + (head.texture ? 2 : 0);
    // A colour has three or four numbers. Others could be the next vertex: Geomview looks at no line end.
    const bool good = head.colour ? more == fixed + 3 || more == fixed + 4 : more == fixed;
    if (!good) lines.refuse("a vertex has " + std::to_string(3 + more) + " numbers, which is not what the head says");
  }
  std::vector<std::size_t> corners;
  for (std::uint64_t i = 0; i < faces; ++i) {
    next("face");
    const std::uint64_t count = lines.count("corners");
    corners.clear();
    for (std::uint64_t k = 0; k < count; ++k) corners.push_back(lines.count("a vertex"));
    const std::size_t colour = passNumbers(lines);  // none, a number of a table, three or four
    if (colour > 4 || colour == 2) lines.refuse("goes on after a face's corners, and not with a colour");
    soup.addFace(corners.data(), corners.size(), source);
  }
  if (lines.next()) lines.refuse("goes on after its last face: " + shown(lines.rest()));
  noteOpenEnd(source);
  return soup;
}

}  // namespace fcl_artic::meshes
