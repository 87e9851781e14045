// SPDX-License-Identifier: BSD-3-Clause
//
// Options about single bodies and pairs of them: margins of their own, and pairs that may touch.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fcl_artic/manager.h"
#include "fcl_artic/urdf/urdf.h"

namespace fcl_artic::app {

/// As they are typed. A body is a link, an obstacle or a carried object.
struct PairOptions {
  std::vector<std::string> margins_of;           ///< BODY=METRES
  std::vector<std::string> pair_margins;         ///< BODY,BODY=METRES
  std::string margins;                           ///< a file of lines as these two; empty: none
  std::vector<std::string> allowed, disallowed;  ///< BODY,BODY
};

/// Adds --margin-of, --margin-pair, --margins, --allow and --disallow, in the group "Robot and scene".
void addPairOptions(CLI::App& verb, PairOptions& options);

/// The same, read.
struct PairSettings {
  /// One option, or one line of a file, about a body or a pair.
  struct Said {
    std::string where;  ///< begins messages: the option as it was typed, or file and line
    std::string a, b;   ///< b empty: of all pairs of a
    double margin = 0;  ///< m
  };
  std::vector<Said> margins, allowed, disallowed;

  /// Sets them. The name of an object of several shapes stands for all of them.
  /// @param scene  that the manager has.
  /// @throws std::invalid_argument naming option and body: no such link or obstacle.
  void apply(const Scene& scene, ArticulatedCollisionManager& manager) const;
  /// The same text for the same settings: for hashes of what a run is about.
  std::string text() const;
};

/// @throws std::invalid_argument naming what was typed: it is not as above, a margin that is negative, two margins for
///   one body or pair; std::runtime_error naming the file.
PairSettings readPairSettings(const PairOptions& options);

/// Ways to allow a contact at the motion's begin: names the pair and the options, in one line.
std::string startHint(const CertifiedContact& contact);

}  // namespace fcl_artic::app
