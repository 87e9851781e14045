// SPDX-License-Identifier: BSD-3-Clause
// Compares a world with the files that it was written from. The robot is made anew from the files, with none of the
// library's readers, and the world must be that robot: nothing in it may be left over.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "packages.h"
#include "statement.h"

namespace verify {

struct Comparison {
  std::vector<std::string> differences;  // none: the world is what the file says
  std::vector<std::string> notes;        // for people
  std::set<std::string> solids;          // those of Solids::names that were met
  std::vector<std::string> variables;    // of the robot's joints, in the file's order
};

/// Links and obstacles whose meshes are meant as solids.
struct Solids {
  bool all = false;
  std::set<std::string> names;
};

/// Frames, joints and collision geometry of a URDF.
/// @param base  x, y, z, roll, pitch, yaw of the root in the world; empty: it is not compared.
/// @throws BadInput: unreadable, or with something in it that is not compared.
Comparison compareWithUrdf(const World& world, const std::string& path, const Packages& packages,
                           const Solids& solids = {}, const std::vector<double>& base = {});
/// "x,y,z" or "x,y,z,roll,pitch,yaw" as six numbers; an angle may be "90deg". @throws BadInput
std::vector<double> readBase(const std::string& text);
/// Every pair that the world calls `allowed` or `neighbours` is one that the SRDF disables.
Comparison compareWithSrdf(const World& world, const std::string& path);
/// The obstacles of the world are those of the files, none more: STL and OBJ, one each, and URDF, all links with each
/// joint at 0. @param scale  of all lengths of the files. @throws BadInput
Comparison compareWithScenes(const World& world, const std::vector<std::string>& paths, const Packages& packages,
                             const Solids& solids = {}, double scale = 1);

/// The curve between two waypoints. `upsampled` takes positions alone: the one spline of cubics from rest to rest whose
/// velocity and acceleration do not jump. If there are velocities, it is as `automatic`.
enum class Interpolation { automatic, linear, cubic, quintic, upsampled };

/// Waypoints as a file or a user says them.
struct Plan {
  std::string title;                 // for people
  std::vector<std::string> columns;  // names
  std::vector<std::vector<double>> rows;
  std::vector<std::string> robot;                          // variables of its joints; none: all of the world's
  std::map<std::string, double> state;                     // values of variables without a column; of others 0
  Interpolation interpolation = Interpolation::automatic;  // by the columns that there are
};
/// Comma separated values, of which the first line names the columns. @throws BadInput
Plan readPlan(const std::string& path);
/// "NAME=VALUE" of some of the world's variables, or the values of all in `order`; an angle may be "90deg".
/// @throws BadInput
std::map<std::string, double> readConfiguration(const World& world, const std::vector<std::string>& order,
                                                const std::string& text);
constexpr const char* kFromTo = "--from, --to";  ///< the title of a plan that these options say
/// The straight way between two configurations, of which all that neither names stands still.
/// @param robot  variables of the robot's joints, in their order; none: all of the world's.
Plan planBetween(const World& world, const std::vector<std::string>& robot, const std::string& from,
                 const std::string& to);
/// The motion goes from waypoint to waypoint of the plan, as its interpolation says, and nothing else moves.
Comparison compareWithPlan(const World& world, const Motion& motion, const Plan& plan);

std::string readFile(const std::string& path);

}  // namespace verify
