// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// The proof of an answer, for whoever does not trust this library: `fcl_artic_verify`, a program that shares no code
/// with it, proves the same claim again. doc/CERTIFICATES.md says what is claimed, and how it is written.
///
/// The claim: up to a time, all pairs of bodies that the request asks about are apart by more than their margins. The
/// time is the motion's end if it is free; otherwise it is CertifiedPairRequest::tolerance_time before the result's
/// t_lower, for at t_lower itself the gap may be 0.
struct FCL_ARTIC_EXPORT Certificate {
  /// The world as text: what stands and moves, and what is checked. Null if there is no proof. The answers of one
  /// manager share it until the next setup().
  std::shared_ptr<const std::string> world;
  std::string motion;   ///< The motion and what is claimed of it, as text; it names its world by hash.
  std::string proof;    ///< Hints for the verifier, in bytes; empty if none were found.
  std::string missing;  ///< Why there is no proof; empty if there is one.

  /// Whether there is a proof.
  explicit operator bool() const { return missing.empty(); }
  /// Returns motion and proof as one record of a certificate file, in bytes. Records of one world are written one after
  /// the other.
  std::string record() const;
};

}  // namespace fcl_artic
