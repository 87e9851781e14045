// SPDX-License-Identifier: BSD-3-Clause
//
// Plans of files against a robot and a scene.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fcl_artic/manager.h"
#include "mend.h"
#include "plans/carried.h"
#include "plans/motion.h"
#include "plans/plan.h"
#include "tool_line.h"

namespace fcl_artic::app {

/// A plan, and what is known of it so far.
struct CertifiedPlan {
  std::string file;                         ///< as it was named
  plans::Plan plan;                         ///< as the file says it
  std::optional<plans::PlanMotion> motion;  ///< that was asked about; none: see `error`
  std::string error;                        ///< why there is no answer; empty: there is one
  std::vector<std::string> notes;           ///< all there are, also of a plan that is wrong
  CertifiedResult result;
  std::optional<Clearance> clearance;  ///< where it was asked for
  std::optional<ToolLineAnswer> line;  ///< where it was asked for
  double us = 0;                       ///< time of the query, without reading and clearance

  std::optional<Mended> mended;              ///< a way around what the plan touches
  std::shared_ptr<CertifiedPlan> as_mended;  ///< the mended plan, certified as any other
  std::string not_mended;                    ///< why there is none

  /// "FILE" or "FILE PLAN".
  std::string title() const;
  /// Exit status of the plan as given: of the worse answer, about contacts or about the tool's line.
  int ownExitStatus() const;
  /// The same; that of the mended plan, where there is one.
  int exitStatus() const;
};

struct CertifyOptions {
  plans::MotionOptions motion;
  CertifiedRequest request;
  std::optional<ClearanceRequest> clearance;
  std::optional<ToolLine> line;
  std::vector<plans::Attached> attached;  ///< what the caller has said the robot carries
  int threads = 0;                        ///< 0: as many as the machine runs at once
};

/// The plans of files and folders (those of its files whose ending names a format, by name), in their order.
/// @param format  of all files; none: each by its ending.
/// @param columns  of CSV files.
/// @param[out] notes  gets a line for each folder that holds more than plans.
/// @return one for each plan; a file that can't be read is one with an error.
/// @throws std::invalid_argument for a folder without plans, and for a file whose ending names no format.
std::vector<CertifiedPlan> readPlans(const KinematicTree& tree, const std::vector<std::string>& paths,
                                     const std::optional<plans::Format>& format, const plans::ColumnOptions& columns,
                                     std::vector<std::string>& notes);

/// Makes the plan's motion and asks the manager.
void certify(const ArticulatedCollisionManager& manager, const CertifyOptions& options, CertifiedPlan& plan);
/// All of them, on several threads, with a progress bar.
void certify(const ArticulatedCollisionManager& manager, const CertifyOptions& options,
             std::vector<CertifiedPlan>& plans);

/// Two bodies by name, the lesser one first.
using NamePair = std::pair<std::string, std::string>;
/// Contacts and near pairs of a plan itself at its ends, which a detour may have too.
struct MendPairs {
  std::set<NamePair> ignored;  ///< pairs that touch at the start and are ignored
  std::set<NamePair> near;     ///< pairs that are nearer than the clearance, at the start or the goal
  bool empty() const { return ignored.empty() && near.empty(); }
  bool operator<(const MendPairs& other) const { return std::tie(ignored, near) < std::tie(other.ignored, other.near); }
};
/// A manager of the same world, set up, that leaves the ignored pairs out, and whose near pairs have the request's
/// margin as their own.
using ManagerForMending =
    std::function<std::shared_ptr<const ArticulatedCollisionManager>(const MendPairs& pairs, double margin)>;

/// Mends the plans that touch, and certifies the mended ones: not as they are in memory, but as writePlans() writes
/// them.
/// @param managerFor  null: detours keep the clearance from all, and no pair is ignored.
void mendAll(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const CertifyOptions& options,
             const MendOptions& mending, std::vector<CertifiedPlan>& plans, const ManagerForMending& managerFor = {});

}  // namespace fcl_artic::app
