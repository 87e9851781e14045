// SPDX-License-Identifier: BSD-3-Clause
//
// Plans as files hold them, whoever made them: one way of saying for all formats, and the readers.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "fcl_artic/kinematic_tree.h"

namespace fcl_artic::plans {

/// An object that a message says the robot carries.
struct Carried {
  std::string name;  ///< empty: the message has none
  std::string link;  ///< that carries it; empty: the message does not say
};

/// A plan as its file says it. Only what a format itself demands has been checked; toMotion() checks the rest.
/// Waypoints are counted from 0.
struct Plan {
  using Rows = std::vector<std::vector<double>>;  ///< one for each waypoint, of one value for each of `joints`

  std::string name;                 ///< within its file; empty: the only one
  std::vector<std::string> joints;  ///< names of variables (KinematicTree::variableName()); empty: all of the robot's
  bool joints_counted = false;      ///< the file numbers its columns: `joints` are those of ColumnOptions::joints
  bool foreign = false;             ///< a CSV file of another layout than writePlans() has
  bool part = false;                ///< of a message in several parts, which are carried out one after the other
  std::vector<double> times;        ///< s, one for each waypoint; empty: none are given
  Rows positions;                   ///< rad or m
  Rows velocities, accelerations;   ///< rad/s, m/s, and per s²; empty: none are given
  std::map<std::string, double> state;  ///< values of other joints all the time, as a message's start state has them
  std::vector<Carried> carried;         ///< what requireCarried() holds against what is attached
  bool has_degrees = false;             ///< values of the file end with deg; they are in rad here
  /// "line 3 says '# angles in degrees'": the first text beside the values that speaks of angles, and of lengths or
  /// times, in other units than rad, m and s. Nobody applies these; empty: there is none.
  std::string other_angles, other_units;
  std::vector<std::string> notes;  ///< what was accepted though unusual, one line each; notesOf() has all
  std::string error;               ///< what is wrong with this plan; empty: nothing was found
};

enum class Format {
  csv,    ///< a header of column names, a line for each waypoint
  json,   ///< a document: messages and plans as doc/manual/howto/certify.md has them
  jsonl,  ///< such a document a line
  yaml,   ///< such documents, as ROS prints messages
  ompl,   ///< OMPL's PathGeometric::printAsMatrix() or print()
  numpy   ///< .npy, .npz
};

/// The meaning of a CSV file's columns, where its first line does not say it in the robot's own names.
struct ColumnOptions {
  /// For each column, in their order: a variable, VARIABLE/velocity or /acceleration, `time`, or - for one that is
  /// left out. Empty: the file's first line, or what is usual, says it.
  std::vector<std::string> columns;
  std::vector<std::string> skip;    ///< columns that are left out, by the names of the first line
  std::string time;                 ///< the column of times, by the first line; empty: what is usual
  std::vector<std::string> joints;  ///< what numbered columns, or columns without names, are; empty: all variables
};

/// The format that a file's ending names. @throws std::invalid_argument naming the file and the endings that are known.
Format formatOf(const std::string& path);
/// The format that an option's value names: "csv", "json", "jsonl", "yaml", "ompl" or "numpy". @throws
/// std::invalid_argument.
Format formatNamed(const std::string& name);
/// Whether the file's ending names a format.
bool hasPlanEnding(const std::string& path);

/// Reads the plans of one file's content.
/// @param tree     the robot that they are for: it says what a pose in a message means (planar, floating joints).
/// @param content  the file's bytes.
/// @param columns  for CSV.
/// @return at least one plan; one that is wrong by itself says so (`error`), and the others are read all the same.
/// @throws std::invalid_argument, without the file's name: the content is not of the format, or holds no plan; a format
///   that this build does not read (YAML without yaml-cpp, NumPy's archives without zlib).
std::vector<Plan> parsePlans(const KinematicTree& tree, std::string_view content, Format format,
                             const ColumnOptions& columns = {});

/// Keeps what a text beside a plan's values says of other units (Plan::other_angles, other_units).
void keepUnits(std::string_view text, int line, Plan& plan);
/// All notes of a plan, one line each: its own, and of the units that its texts speak of.
/// @param degrees  whether the caller says that the plan's angles are in degrees.
std::vector<std::string> notesOf(const Plan& plan, bool degrees);

}  // namespace fcl_artic::plans
