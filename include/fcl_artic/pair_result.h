// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/abi.h"
#include "fcl_artic/result.h"

namespace fcl_artic {

/// The answer for two moving objects: verdict and bracket (Bracket), contacts, poses, work. A query writes every field;
/// if it throws, the result is reset to its defaults.
struct CertifiedPairResult : Bracket {
  /// The first contact, if CertifiedPairRequest::max_contacts is not 0. Empty if the motion is free or undecided.
  std::vector<CertifiedContact> contacts;
  /// Poses of the objects in the world at t_lower, before which they are proven not to touch; at t = 1 if free.
  Eigen::Isometry3d tf1_at_lower = Eigen::Isometry3d::Identity(), tf2_at_lower = Eigen::Isometry3d::Identity();
  /// Poses of the objects in the world at t_upper; if `certain`, they touch there, or within the bracket before. At
  /// t = 1 if free.
  Eigen::Isometry3d tf1_at_upper = Eigen::Isometry3d::Identity(), tf2_at_upper = Eigen::Isometry3d::Identity();
  /// Whether the objects touch at t = 0 and that was ignored (CertifiedPairRequest::ignore_initial_contact).
  bool ignored_initial_contact = false;
  /// Whether, moreover, they are proven apart nowhere on the motion: `free` says nothing then.
  bool never_apart = false;
  /// The proof that the motion is free, or free until shortly before t_lower; null if the request did not ask for it
  /// (CertifiedPairRequest::certificate).
  std::shared_ptr<const Certificate> certificate;
  /// Work of the query. The counts of stage 2 are 0, report_us and total_us too.
  QueryStatistics statistics;

  /// The first of the contacts; null if there is none. It points into this result.
  const CertifiedContact* first() const& { return contacts.empty() ? nullptr : &contacts.front(); }
  /// Not available for a temporary result, whose contacts would be gone.
  const CertifiedContact* first() const&& = delete;
};

/// Returns what a free motion's answer does not cover, in the words of exceptionsOf(const CertifiedResult&).
FCL_ARTIC_EXPORT std::string exceptionsOf(const CertifiedPairResult& result);
/// Prints verdict and bracket on one line, without a line end, and what `free` does not speak of.
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const CertifiedPairResult& result);

}  // namespace fcl_artic
