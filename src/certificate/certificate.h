// SPDX-License-Identifier: BSD-3-Clause
//
// Certificates of answers: what is claimed, as text, and its proof.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "certificate/moving_world.h"
#include "certificate/witness.h"
#include "fcl_artic/bracket.h"
#include "fcl_artic/certificate.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/request.h"
#include "motion/part_of_motion.h"

namespace fcl_artic::certificate {

/// The claim: motions one after the other, each over [0, 1], the last one up to its own `until`. Everything that they
/// share is the first one's.
struct Claim {
  std::vector<Motion> pieces;
  double duration = 1;             ///< of all of them, for people
  std::optional<Meeting> meeting;  ///< in the last one, after its `until`
};

/// A motion of the world's robot, beside the moving obstacles' own.
/// @param time  the part of the obstacles' time that it takes.
Motion motionOf(const World& world, const JointMotion& motion, const TimePart& time);

/// Most nodes that are tried before it is said that no proof was found: some seconds.
constexpr std::uint64_t kMaxNodes = 200000;

Certificate makeCertificate(const World& world, const Claim& claim, std::uint64_t work = kMaxNodes);

/// Has the motion claim what a query was asked and has answered: margins, and until when. That is to the end of a free
/// motion, else a tolerance before t_lower, where the gap may be 0.
inline void claimAnswer(const Tolerances& asked, const Bracket& answer, Motion& motion) {
  motion.margin = asked.margin;
  motion.added = asked.added_margin;
  motion.until = answer.isFree() ? 1 : std::max(0.0, answer.t_lower - asked.tolerance_time);
}

}  // namespace fcl_artic::certificate
