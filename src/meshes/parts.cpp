// SPDX-License-Identifier: BSD-3-Clause
#include "meshes/parts.h"

#include <algorithm>

namespace fcl_artic::meshes {

void Yield::add(std::size_t count) {
  made_ += count;
  if (made_ <= kMaxCopies + kMaxPerByte * bytes_) return;
  source_.refuse("unfolds to too much: it is of " + std::to_string(bytes_) + " bytes, and shows more than " +
                 std::to_string(kMaxCopies + kMaxPerByte * bytes_) +
                 " vertices and corners, as its nodes show the same meshes again and again; save it with each of them "
                 "once");
}

void addPart(const Part& part, const Eigen::Affine3d& M, const Source& source, Yield& yield, TriangleSoup& soup) {
  yield.add(part.vertices.size() + part.corners.size());
  const std::size_t first = soup.vertices.size();
  for (const Eigen::Vector3d& x : part.vertices) soup.vertices.push_back(M * x);
  const bool mirrored = M.linear().determinant() < 0;
  std::vector<std::size_t> corners;
  std::size_t begin = 0;
  for (const std::size_t end : part.ends) {
    corners.clear();
    for (std::size_t k = begin; k < end; ++k) corners.push_back(first + part.corners[k]);
    if (mirrored && !corners.empty()) std::reverse(corners.begin() + 1, corners.end());
    soup.addFace(corners.data(), corners.size(), source);
    begin = end;
  }
  soup.points += part.points;
  soup.lines += part.lines;
}

void noteUpAxis(char axis, bool said, const std::string& format, bool turned, const Source& source) {
  if (!source.notes) return;
  const std::string text =
      turned ? " is up: turned so that z is, and so for all " + format + " files (option collada_up_axis)"
             : " is up: taken as it stands, as RViz and MoveIt do, and so for all " + format +
                   " files (option collada_up_axis turns them)";
  for (const std::string& note : *source.notes) {
    if (note.find(text) != note.npos) return;
  }
  source.note((said ? "says that " : "does not say what is up: by the rules of its format ") + std::string(1, axis) +
              text);
}

Eigen::Matrix3d turnUp(char axis) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (axis == 'y') R << 1, 0, 0, 0, 0, -1, 0, 1, 0;   // x stays to the right
  if (axis == 'x') R << 0, -1, 0, 0, 0, -1, 1, 0, 0;  // y is to the left, z towards the viewer
  return R;
}

}  // namespace fcl_artic::meshes
