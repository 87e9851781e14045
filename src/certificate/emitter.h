// SPDX-License-Identifier: BSD-3-Clause
//
// Writes proofs (doc/CERTIFICATES.md): finds the cuts and directions with which a verifier shows that a motion is free.
// Nothing rests on it: what it writes is proven again, or it fails there.
#pragma once

#include <cstdint>
#include <string>

#include "certificate/moving_world.h"

namespace fcl_artic::certificate {

/// Finds a proof for all pairs of the world over [0, motion.until].
/// @param work  most nodes that are tried.
/// @param[out] proof  nodes of all roots, in their order; as far as they go if there is none.
/// @return why there is none; empty if there is one.
std::string findProof(const World& world, const Motion& motion, std::uint64_t work, std::string& proof);

}  // namespace fcl_artic::certificate
