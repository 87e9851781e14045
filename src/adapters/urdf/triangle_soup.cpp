// SPDX-License-Identifier: BSD-3-Clause
#include "triangle_soup.h"

#include <cstdint>
#include <cstring>

#include "detail.h"
#include "polygon.h"

namespace fcl_artic::detail {
namespace {

// A binary STL: 80 bytes of anything, a count, and for each triangle a normal, three corners and two bytes of anything,
// all in floats of the little end, as this machine's are.
constexpr std::size_t kStlHead = 84, kStlTriangle = 50, kStlNormal = 12;

std::uint32_t stlTriangles(std::string_view content) {
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, content.data() + kStlHead - sizeof triangles, sizeof triangles);
  return triangles;
}

}  // namespace

void TriangleSoup::addFace(const std::size_t* corners, std::size_t count, const std::string& where) {
  if (count < 3) return;
  if (count == 3) {
    triangles.emplace_back(corners[0], corners[1], corners[2]);
    return;
  }
  std::vector<Eigen::Vector3d> x;
  x.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    x.push_back(vertices[corners[k]]);
    if (!x.back().allFinite()) fail(where, "vertex " + std::to_string(corners[k]) + " is not finite");
  }
  if (count > kMostCorners && !isConvexPolygon(x)) {
    fail(where, "has a face of " + std::to_string(count) + " corners that is not convex: cut it into triangles");
  }
  for (const auto& [a, b, c] : cutPolygon(x)) triangles.emplace_back(corners[a], corners[b], corners[c]);
}

bool isBinaryStl(std::string_view content) {
  return content.size() >= kStlHead && content.size() == kStlHead + kStlTriangle * std::uint64_t{stlTriangles(content)};
}

TriangleSoup readBinaryStl(std::string_view content) {
  const std::size_t count = stlTriangles(content);
  TriangleSoup soup;
  soup.vertices.reserve(3 * count);
  soup.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    float corners[9];
    std::memcpy(corners, content.data() + kStlHead + t * kStlTriangle + kStlNormal, sizeof corners);
    for (const float* x : {corners, corners + 3, corners + 6}) soup.vertices.emplace_back(x[0], x[1], x[2]);
    soup.triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
  }
  return soup;
}

}  // namespace fcl_artic::detail
