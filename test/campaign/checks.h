// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine.h"
#include "oracle.h"

namespace campaign {

/// What can be wrong with an answer. Each is counted by itself and has to be 0.
enum class Fault {
  missed,         ///< a sampled contact, and the answer says that its pair (or the motion) is free
  late,           ///< t_lower after the first sampled contact
  false_contact,  ///< the gap stays above the distance tolerance all through the bracket
  unproven,       ///< `certain`, and no contact up to t_upper
  wide,           ///< `certain`, and the bracket wider than both tolerances and the rounding floor
  undecided,      ///< without a work budget
  fields,         ///< bracket out of order or out of [0, 1], unknown or unchecked pair, ids out of range, ...
  point,          ///< contact point away from one of the bodies, or from the named triangles
  normal,         ///< not unit, or the named pieces are not on their sides of it
  poses,          ///< link poses at t_lower differ from our own kinematics
  count
};
constexpr int kFaults = static_cast<int>(Fault::count);
const char* faultName(Fault fault);

struct Finding {
  Fault fault;
  std::string text;
};

/// Compares an answer with the sampled truth and with itself.
std::vector<Finding> examine(const Scene& scene, const Oracle& oracle, const Truth& truth, const Answer& answer);

/// Ways to spoil an answer, to show that the campaign sees it.
enum class Corruption { none, late, drop, invent, widen, point, normal, poses, certain, pair, count };
constexpr int kCorruptions = static_cast<int>(Corruption::count);
const char* corruptionName(Corruption corruption);
/// @throws std::invalid_argument for an unknown name
Corruption corruptionOf(const std::string& name);
/// Spoils the answer where the corruption applies to it; returns whether it did.
/// @param seed  `drop` and `invent` strike 1 % of the answers, by this
bool corrupt(Corruption corruption, std::uint64_t seed, const Scene& scene, Answer& answer);

}  // namespace campaign
