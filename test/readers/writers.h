// SPDX-License-Identifier: BSD-3-Clause
// Random mesh and point files of all variants that the readers claim, with what they hold by the writer's own
// arithmetic.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace fcl_artic::test {

using Random = std::mt19937_64;
using Place = std::array<double, 3>;

/// From 0 to `count` - 1.
int below(Random& random, int count);
bool coin(Random& random);
template <class T>
const T& oneOf(Random& random, const std::vector<T>& list) {
  return list[static_cast<std::size_t>(below(random, static_cast<int>(list.size())))];
}

struct WrittenFile {
  std::string name;                             ///< With its ending.
  std::string content;                          ///< The file's bytes.
  std::map<std::string, std::string> more;      ///< Files that it names.
  std::vector<std::array<Place, 3>> triangles;  ///< In the order of the file.
  std::size_t points = 0, lines = 0;            ///< Counts of a mesh file.
  std::vector<Place> cloud;                     ///< Points of a file of points.
  bool turn = false;                            ///< Whether what is up is to become z.
  /// Part of the largest coordinate by which the writer's and the reader's places may differ; 0: not at all.
  double tolerance = 0;
};

/// Formats, such as "stl"; those of points: "pcd", "xyz", "cloud.ply".
const std::vector<std::string>& writtenFormats();

/// A file of random triangles, quadrangles and what else the format has.
WrittenFile writeRandomFile(const std::string& format, Random& random);

}  // namespace fcl_artic::test
