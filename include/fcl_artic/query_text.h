// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "fcl_artic/export.h"
#include "fcl_artic/manager.h"

namespace fcl_artic {

/// A query that was written as text by ArticulatedCollisionManager::writeQuery(): a manager of its own, after setup(),
/// with all that it checks, and the question.
struct FCL_ARTIC_EXPORT RecordedQuery {
  std::string library;          ///< Version of the library that wrote the text.
  std::string instruction_set;  ///< instructionSet() of the library that wrote the text.
  /// The robot and its scene. Objects are the manager's own.
  ArticulatedCollisionManager manager;
  std::optional<JointMotion> motion;          ///< The motion, if the query is about one.
  std::optional<JointTrajectory> trajectory;  ///< The trajectory, if the query is about one: one of the two is there.
  CertifiedRequest request;                   ///< The request; `progress` is empty.

  /// Asks the query again. The answer has the same bits as the first one, except for measured times, if
  /// instructionSet() and the rounding mode are the same.
  /// @throws as ArticulatedCollisionManager::continuousCollide().
  [[nodiscard]] CertifiedResult ask() const;
};

/// Reads a query from the text that ArticulatedCollisionManager::writeQuery() made of it. Pairs of links that the text
/// calls proven apart are proven again.
/// @throws std::invalid_argument for text that is no such query, with the way to the field that is missing, not known
///   or of another kind ("robot.joints[2].axis"), and for all that the manager refuses.
/// @throws std::runtime_error if the library was built without nlohmann-json.
FCL_ARTIC_EXPORT RecordedQuery readQuery(std::string_view text);

}  // namespace fcl_artic
