// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "fcl_artic/result.h"

namespace fcl_artic {

/// The answer for two moving objects: verdict and bracket (Bracket), contacts, poses, work. Always written in full.
struct CertifiedPairResult : Bracket {
  std::vector<CertifiedContact> contacts;
  /// Poses of both objects at t_lower, where they do not touch yet, and at t_upper, where, when certain, they do.
  Eigen::Isometry3d tf1_at_lower = Eigen::Isometry3d::Identity(), tf2_at_lower = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d tf1_at_upper = Eigen::Isometry3d::Identity(), tf2_at_upper = Eigen::Isometry3d::Identity();
  /// The objects touch at t = 0, and that was ignored (CertifiedPairRequest::ignore_initial_contact).
  bool ignored_initial_contact = false;
  QueryStatistics statistics;

  /// The first of the contacts; null where there is none.
  const CertifiedContact* first() const& { return contacts.empty() ? nullptr : &contacts.front(); }
  const CertifiedContact* first() const&& = delete;
};

}  // namespace fcl_artic
