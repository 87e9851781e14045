// SPDX-License-Identifier: BSD-3-Clause
//
// The measurements of `bench robot`: random motions by what they meet, the time of each way of asking about them, and
// whether the answers contradict each other.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "random_motions.h"

namespace fcl_artic::app {

/// The ways of asking about a motion.
struct Questions {
  /// Answers with the manager's query in this mode.
  std::function<void(const MotionEnds&, ContactMode, CertifiedResult&)> collide;
  /// Finds the clearance of a free motion.
  std::function<void(const MotionEnds&)> clearance;
  /// Samples the motion as OMPL does over FCL, its start left out. Returns the time of a sample in contact, or nothing
  /// if there is none. Empty: FCL is not asked.
  std::function<std::optional<double>(const MotionEnds&)> sampleInContact;
};

/// Two answers about a motion that can't both be right.
struct Contradiction {
  MotionEnds motion;
  std::string text;
};

/// Random motions by the answer of ContactMode::first, as many of each kind as were wanted at most.
struct DrawnMotions {
  std::vector<MotionEnds> free;
  std::vector<MotionEnds> contact;   ///< that begin free
  std::vector<bool> proven;          ///< whether each of `contact` is certain
  std::vector<MotionEnds> touching;  ///< in contact, proven or not, at t = 0
  std::size_t drawn = 0, drawn_free = 0, drawn_contact = 0, drawn_touching = 0;
};

/// Draws motions until there are `wanted` free ones and `wanted` in contact, 20 * wanted in all at most, and asks about
/// each in both modes.
/// @param[out] contradictions  appended to.
/// @param progress  called with the share that is done.
DrawnMotions drawMotions(RandomMotions& random, std::size_t wanted, const Questions& questions,
                         std::vector<Contradiction>& contradictions, const std::function<void(double)>& progress);

/// Times of one way of asking about motions of one kind, µs.
struct TimedRow {
  std::string motions;     ///< "free", "contact" or "touching at the start"
  std::string question;    ///< "first", "any", "clearance" or "FCL, 1 %"
  std::vector<double> us;  ///< the least of all passes, by motion
  std::size_t missed = 0;  ///< of samples: proven contacts that none of them saw

  std::string name() const { return motions + ", " + question; }
  bool ours() const { return question == "first" || question == "any"; }
  double mean() const;  ///< 0 if there is no motion, as the others
  /// The time that this share of all motions does not exceed.
  double quantile(double share) const;
  double slowest() const { return quantile(1); }
};

/// Number of further passes over the motions, for the 99.9 % and the slowest of a row. One pass in which the machine
/// did something else must not look like a slow query.
constexpr int kPassesOfSlowest = 10;

/// Asks about all motions in all ways, `passes` times in turns, and holds the answers to what drawMotions() found.
/// @param[out] contradictions  appended to.
/// @param progress  called with the share that is done.
/// @param only  a row's name, for this one alone; empty: all.
/// @return a row for each kind of motions and way of asking, also for kinds without motions.
std::vector<TimedRow> timeMotions(const DrawnMotions& drawn, int passes, const Questions& questions,
                                  std::vector<Contradiction>& contradictions,
                                  const std::function<void(double)>& progress, const std::string& only = {});

}  // namespace fcl_artic::app
