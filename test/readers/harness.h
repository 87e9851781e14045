// SPDX-License-Identifier: BSD-3-Clause
// Random files of all formats that are read. A writer's data, by its own arithmetic, are compared with a reader's.
// Faults of readers must be seen. Some files have their structure changed.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "writers.h"

namespace fcl_artic::test {

/// One thing that a file holds: a triangle, a joint, an allowed pair, a waypoint.
struct Item {
  std::string what;
  std::vector<double> numbers;
};
using Reading = std::vector<Item>;

struct RandomFile {
  std::string name, content;                ///< `name` has its ending
  std::map<std::string, std::string> more;  ///< files that it names
  Reading reading;                          ///< what it holds
  double tolerance = 0;                     ///< of the largest number, or of 1: what a reader's rounding may make of it
  bool turn = false;                        ///< of a mesh: what is up is to become z
};

struct FileFormat {
  std::string name;
  std::function<RandomFile(Random&)> write;
  /// Reads a file that stands in its folder. @throws std::exception where it is refused.
  std::function<Reading(const RandomFile&, const std::string& path)> read;
  /// Parts that a faulty reader would pass over: a name, and a regular expression whose last match is left out of the
  /// file.
  std::vector<std::pair<std::string, std::string>> faults = {};
  bool errors_name_the_file = true;
};

const std::vector<FileFormat>& fileFormats();
void addMeshFormats(std::vector<FileFormat>& formats);
void addRobotFormats(std::vector<FileFormat>& formats);
void addPlanFormats(std::vector<FileFormat>& formats);

struct Seen {
  int files = 0;  ///< in which the fault makes a difference to the file or to what it holds
  int seen = 0;
  bool of_file = false;  ///< whether the fault is of the file, not of what it holds
};

struct Findings {
  std::string wrong;  ///< about the first file that is not read as it was written; empty: none
  std::map<std::string, Seen> faults;
  int changed_read = 0, changed_refused = 0;  ///< files of changed structure
};

/// Writes and reads random files of a format.
Findings readRandomFiles(const FileFormat& format, int files, std::uint64_t seed, const std::string& folder);

/// In thousandths.
double randomNumber(Random& random, double lower, double upper);

}  // namespace fcl_artic::test
