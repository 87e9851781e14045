// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// The proof of an answer, for whoever does not trust this library: `fcl_artic_verify`, a program that shares no code
/// with it, proves the same claim again from this and from the world's text
/// (ArticulatedCollisionManager::certificateWorld()). doc/CERTIFICATES.md says what is claimed, and how it is written.
///
/// The claim: until `t_lower` of the result, for the whole motion if it is free, all pairs of bodies that the request
/// asks about are apart by more than their margins.
struct FCL_ARTIC_EXPORT Certificate {
  std::string motion;   ///< The motion and what is claimed of it, as text; it names its world by hash.
  std::string proof;    ///< Hints for the verifier, in bytes; empty if none were found.
  std::string missing;  ///< Why there is no proof; empty if there is one.

  /// Whether there is a proof.
  explicit operator bool() const { return missing.empty(); }
  /// Returns both as one record of a certificate file, in bytes. Records are written one after the other.
  std::string record() const;
};

}  // namespace fcl_artic
