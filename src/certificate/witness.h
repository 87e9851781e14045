// SPDX-License-Identifier: BSD-3-Clause
//
// The other half of a contact's certificate: that the two bodies do meet (doc/CERTIFICATES.md, "Contact").
#pragma once

#include <string>

#include "certificate/moving_world.h"

namespace fcl_artic::certificate {

/// A contact that an answer calls certain.
struct Meeting {
  int piece = 0;                ///< of the motion
  int a = -1, b = -1;           ///< bodies of the world
  std::int32_t leaf_a, leaf_b;  ///< pieces of their trees
  double t_upper;               ///< they meet at or before it, in the piece's time
  double tolerance;             ///< of time
};

/// The bytes that show it to a verifier, at t_upper or a little later; empty if none are found. Nothing rests on them:
/// they are proven or they fail.
std::string findWitness(MovingWorld& world, const Meeting& meeting);

}  // namespace fcl_artic::certificate
